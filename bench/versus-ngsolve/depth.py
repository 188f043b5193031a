#!/usr/bin/env python3
"""The ring electromagnet of finite depth, in three dimensions, by NGSolve.

    depth.py --depths 0 6 --currents 0.25 2 4
    depth.py --depths 0 6 12 --gap 5 --no-probe --linear --currents 1

Core, fluid and probe of the plane problem have the depth t; the wound sectors too, and end turns of 1.8 mm in front of
the core and behind it close the turns. The field is H = T - grad phi. T is a field with curl T = J: in the sectors
of the coil, T = psi / r about the axis of the ring with psi = K f(r) g(z), K = N I / 310 degrees; f grows with r^2
from 0 to 1 over 12..14 mm, is 1 across the core and falls to 0 with r^2 over 20..21.6 mm; g is 1 over the depth and falls
to 0 over the end turns. So J is uniform in both sectors, free of divergence everywhere, and Ampere's law holds
for any phi. phi makes the coenergy least: div B = 0. A quarter is computed: phi = 0 on x = 0, B_z = 0 on z = 0, and no
flux leaves the outer cylinder.
"""
import argparse
import math
import os
import sysconfig
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["PATH"] = sysconfig.get_path("scripts") + os.pathsep + os.environ["PATH"]  # NGSolve's compiler, ngscxx
import ngsolve as ng
from netgen.occ import Glue, OCCGeometry, WorkPlane, Z

import laws

TURNS = 770
INNER, OUTER = 2.0, 1.6  # thickness of the winding inside of the core and outside of it, mm
END = 1.8  # thickness of the end turns, mm
SLAB = 4.0  # thickness of the slab that stands for the plane, mm
BOX = 150.0


def extruded(face, low, high):
    return face.Move((0, 0, low)).Extrude((high - low) * Z)


def quarter(o):
    """Mesh of x > 0, z > 0."""
    half, far = o.depth / 2, o.depth / 2 if o.slab else o.depth / 2 + BOX
    ri, ro = o.inner, o.outer
    disc = lambda r: WorkPlane().Circle(0, 0, r).Face()
    rectangle = lambda x0, y0, x1, y1: WorkPlane().MoveTo(x0, y0).Rectangle(x1 - x0, y1 - y0).Face()
    right = rectangle(0, -200, 200, 200)
    cut = math.radians(25)
    wedge = WorkPlane().MoveTo(0, 0).LineTo(70 * math.sin(cut), 70 * math.cos(cut)).LineTo(0, 70).Close().Face()
    ring = lambda low, high: (disc(high) - disc(low)) * right
    iron = ring(ri, ro) - rectangle(-1, 0, o.gap / 2, 200)
    plan = {
        "core": iron - wedge,
        "tip": iron * wedge,
        "inner": ring(ri - INNER, ri) - wedge,
        "outer": ring(ro, ro + OUTER) - wedge,
    }
    fluid = rectangle(0, ri - 2, o.gap / 2 + 2, ro + 2) - iron - plan["inner"] - plan["outer"]
    if o.probe:
        plan["probe"] = rectangle(0, 15, 0.5, 19)
        fluid = fluid - plan["probe"]
    plan["fluid"] = fluid
    solids = []
    for name, face in plan.items():
        solid = extruded(face, 0, half)
        solid.solids.name = name
        solid.solids.maxh = {"core": o.core, "inner": o.coil, "outer": o.coil}.get(name, o.fine)
        solids.append(solid)
    if not o.slab:
        for low, high in ((ri - INNER, ri), (ri, ro), (ro, ro + OUTER)):
            solid = extruded(ring(low, high) - wedge, half, half + END)
            solid.solids.name = "end"
            solid.solids.maxh = o.coil
            solids.append(solid)
        near = extruded(rectangle(0, ri - 4, o.gap / 2 + 4, ro + 4), 0, half + 4)
        for s in solids:
            near = near - s
        near.solids.name = "air"
        near.solids.maxh = o.near
        solids.append(near)
    air = extruded(disc(BOX) * right, 0, far)
    for s in solids:
        air = air - s
    air.solids.name = "air"
    solids.append(air)
    shape = Glue(solids)
    for face in shape.faces:
        box = face.bounding_box
        if box[1].x < 1e-6:
            face.name = "middle"
    if o.edge:  # pole edges and the probe's, where the field is singular
        reach = math.sqrt(ro**2 - o.gap**2 / 4) + 1e-3
        for edge in shape.edges:
            box = edge.bounding_box
            if abs(box[0].x - o.gap / 2) < 1e-6 and abs(box[1].x - o.gap / 2) < 1e-6 and box[0].y > ri - 2 and box[1].y < reach and box[1].z < half + 1e-6:
                edge.maxh = o.edge
    return ng.Mesh(OCCGeometry(shape).GenerateMesh(maxh=40, grading=o.grading))


class Depth:
    """Equations of a quarter of the magnet."""

    def __init__(self, o):
        self.o = o
        self.mesh = mesh = quarter(o)
        mesh.Curve(o.order)
        self.space = ng.H1(mesh, order=o.order, dirichlet="middle")
        self.field = ng.GridFunction(self.space)
        self.solved = False
        self.amps = ng.Parameter(1.0)
        self.wide = ng.Parameter(1.0)  # relative permeability of the air, of the plane problem alone
        r = ng.sqrt(ng.x**2 + ng.y**2)
        ri, ro = o.inner, o.outer
        rise = (r**2 - (ri - INNER) ** 2) / (ri**2 - (ri - INNER) ** 2)
        fall = ((ro + OUTER) ** 2 - r**2) / ((ro + OUTER) ** 2 - ro**2)
        f = ng.IfPos(ri - r, rise, ng.IfPos(r - ro, fall, 1.0))
        half = o.depth / 2
        g = 1.0 if o.slab else ng.IfPos(ng.z - half, 1 - (ng.z - half) / END, 1.0)
        about = TURNS / math.radians(310) * f * g / r**2 * ng.CF((-ng.y, ng.x, 0))
        wound = {"core": about, "inner": about, "outer": about, "end": about}
        self.unit = mesh.MaterialCF(wound, default=ng.CF((0, 0, 0)))
        self.iron, self.mrf = laws.steel_of_strength(), laws.Carlson()
        u, _ = self.space.TnT()
        strength = self.amps * self.unit - ng.grad(u)
        square = ng.InnerProduct(strength, strength)
        size = ng.sqrt(square + 1e-20)
        steel_slope = float(self.iron.start[1])
        compiled = lambda w: w.Compile(True, wait=True)
        # with the permeabilities at zero field, then with the laws
        self.linear = self.equations(steel_slope / 2 * square, self.mrf.slope / 2 * square, square)
        if not o.linear:
            self.full = self.equations(compiled(self.iron.energy(size)), compiled(self.mrf.energy(size)), square)
        h = self.amps * self.unit - ng.grad(self.field)
        self.h = h
        size = ng.sqrt(ng.InnerProduct(h, h) + 1e-20)
        air = laws.MU_0 * h
        steel = float(self.iron.start[1]) * h if o.linear else self.iron.value(size) / size * h
        mrf = self.mrf.slope * h if o.linear else self.mrf.value(size) / size * h
        laws_of = {"core": steel, "tip": steel, "fluid": mrf, "probe": air}
        self.b = mesh.MaterialCF(laws_of, default=self.wide * air)

    def equations(self, steel, mrf, square):
        form = ng.BilinearForm(self.space, symmetric=True, condense=True)
        for region, density in ("air|inner|outer|end", self.wide * laws.MU_0 / 2 * square), ("probe", laws.MU_0 / 2 * square), ("core|tip", steel), ("fluid", mrf):
            form += ng.Variation(density * ng.dx(region))
        return form, None if self.o.direct else ng.Preconditioner(form, "bddc")

    def solve(self, amps):
        """The field of a current, from the last one's; returns Newton steps."""
        start = self.amps.Get()
        self.amps.Set(amps)
        self.field.vec.data *= amps / start
        if not self.solved or self.o.linear:
            self.solved = True
            done = self.newton(*self.linear)
        return done if self.o.linear else self.newton(*self.full)

    def newton(self, form, pre, close=1e-7):
        vec = self.field.vec
        residual, step, trial = vec.CreateVector(), vec.CreateVector(), vec.CreateVector()
        held = ng.Projector(self.space.FreeDofs(), True)
        trial[:] = 0.0
        form.Apply(trial, residual)
        source = ng.Norm((held * residual).Evaluate())
        energy, inner = form.Energy(vec), 0
        for steps in range(40):
            form.Apply(vec, residual)
            residual.data = held * residual
            if self.o.verbose:
                print("   ", steps, ng.Norm(residual) / source, energy, inner, flush=True)
            if ng.Norm(residual) < close * source:
                return steps
            form.AssembleLinearization(vec)
            residual.data += form.harmonic_extension_trans * residual
            if self.o.direct:
                solver = form.mat.Inverse(self.space.FreeDofs(True), inverse="sparsecholesky")
                step.data = solver * residual
            else:
                solver = ng.krylovspace.CGSolver(form.mat, pre.mat, tol=1e-6, maxiter=400)
                step.data = solver * residual
                inner += solver.iterations
            step.data += form.inner_solve * residual
            step.data += form.harmonic_extension * step
            part = 1.0
            while True:
                trial.data = vec - part * step
                now = form.Energy(trial)
                if now <= energy + 1e-12 * abs(energy) or part < 1e-3:
                    break
                part /= 2
            vec.data, energy = trial, now
        raise RuntimeError(f"{self.amps.Get()} A: no equilibrium after {steps} steps")

    def answers(self):
        """|B| at the centre, its mean over the probe where |z| < 2, both T, and flux linkage per depth, Wb/m."""
        o = self.o
        centre = math.hypot(*self.b(self.mesh(1e-7, (o.inner + o.outer) / 2, 1e-7)))
        n, top = 10, min(2.0, o.depth / 2)
        places = [(i + 0.5) / n for i in range(n)]
        total = sum(
            math.hypot(*self.b(self.mesh(0.5 * x, 15 + 4 * y, top * z))) for x in places[::2] for y in places for z in places
        )
        dx = ng.dx("core|inner|outer|end", bonus_intorder=2)
        linkage = 4 * ng.Integrate(ng.InnerProduct(self.b, self.unit) * dx, self.mesh) / o.depth * 1e-3
        return centre, 2 * total / n**3, linkage

    def checks(self):
        """The integral of H around the core at its middle radius, z = 0, over N I; and the part of the flux over x = 0, y > 0 that does not
        come back over y < 0."""
        n, total, r = 20000, 0.0, (self.o.inner + self.o.outer) / 2
        for i in range(n):
            a = -math.pi / 2 + math.pi * (i + 0.5) / n
            h = self.h(self.mesh(r * math.cos(a), r * math.sin(a), 1e-7))
            total += (-math.sin(a) * h[0] + math.cos(a) * h[1]) * r * math.pi / n
        flux = [ng.Integrate(s * ng.BoundaryFromVolumeCF(self.b)[0] * ng.ds("middle"), self.mesh) for s in (ng.IfPos(ng.y, 1, 0), 1)]
        return 2 * total / (TURNS * self.amps.Get()), flux[1] / flux[0]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--depths", type=float, nargs="*", default=[6, 12, 24, 48], help="mm; 0: the plane, a slab without ends, then also with the air of each of the other depths")
    p.add_argument("--air", type=float, nargs="*", default=[], help="depths whose air the plane gets, instead of --depths, mm")
    p.add_argument("--gap", type=float, default=10.0)
    p.add_argument("--currents", type=float, nargs="*", default=[0.25, 1, 1.5, 1.75, 2, 2.25, 2.5, 4])
    p.add_argument("--inner", type=float, default=14.0, help="inner radius of the core, mm")
    p.add_argument("--outer", type=float, default=20.0)
    p.add_argument("--no-probe", dest="probe", action="store_false")
    p.add_argument("--linear", action="store_true", help="steel and fluid with their permeability at zero field")
    p.add_argument("--order", type=int, default=3)
    p.add_argument("--fine", type=float, default=1.0)
    p.add_argument("--edge", type=float, default=0.0)
    p.add_argument("--core", type=float, default=2.0)
    p.add_argument("--coil", type=float, default=2.0)
    p.add_argument("--near", type=float, default=1.5)
    p.add_argument("--grading", type=float, default=0.35)
    p.add_argument("--direct", action="store_true")
    p.add_argument("--verbose", action="store_true")
    o = p.parse_args()
    ng.SetNumThreads(1)
    print(laws.COLUMNS)
    for depth in o.depths:
        o.slab, o.depth = depth == 0, depth or SLAB
        begun = time.perf_counter()
        magnet = Depth(o)
        print(f"# {magnet.mesh.ne} elements, prepared in {time.perf_counter() - begun:.0f} s", flush=True)
        deep = o.air or [depth for depth in o.depths if depth]
        for wide in [1.0] if depth else [1.0] + [laws.air(t, o.inner, o.outer) for t in deep]:
            magnet.wide.Set(wide)
            for amps in o.currents:
                begun = time.perf_counter()
                steps = magnet.solve(amps)
                cells = [f"{x:g}" for x in (depth, o.gap, o.inner, o.outer, o.probe, o.linear, wide, amps)]
                cells += [f"{x:.6g}" for x in magnet.answers()]
                cells += [f"{magnet.space.ndof}", f"{steps}", f"{time.perf_counter() - begun:.1f}"]
                print(",".join(cells + [f"{x:.5f}" for x in magnet.checks()]), flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""The reference's ring electromagnet (../shared/reference/display/README.md) in the plane, by NGSolve: time and error.

    plane.py                       # the settings of SETTINGS, a markdown table
    plane.py --setting 3 1 0.03    # order, scale of all sizes, size at the corners

The potential A makes the energy least: Newton's method with a line search, from current to current. Seconds are those of
assembly and solution of the 16 currents on one thread; meshing, compiling and the matrix' first analysis are apart. Errors
are the largest of the 16 currents, against the reference's table and against ring_A_fine.csv.
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
from netgen.occ import Glue, MoveTo, OCCGeometry, WorkPlane

import laws

TURNS = 770
BOX = 150.0
TIPS = [(s * 5.0, math.sqrt(r * r - 25.0)) for s in (-1, 1) for r in (14.0, 20.0)]
PROBE = [(s * 0.5, y) for s in (-1, 1) for y in (15.0, 19.0)]


def disc(radius):
    return WorkPlane().Circle(0, 0, radius).Face()


def sector(low, high):
    """The part of a ring at 115 to 425 degrees from +x."""
    cut = math.radians(25)
    far = 3 * high
    wedge = WorkPlane().MoveTo(0, 0).LineTo(far * math.sin(cut), far * math.cos(cut)).LineTo(
        -far * math.sin(cut), far * math.cos(cut)).Close().Face()
    return disc(high) - disc(low) - wedge


def ring(scale, corner):
    """Mesh of the magnet, coarser by `scale`, with elements of `corner` mm at the corners of pole and probe."""
    sizes = {name: scale * size for name, size in SIZES.items()}
    core = disc(20) - disc(14) - MoveTo(-5, 0).Rectangle(10, 30).Face()
    probe = MoveTo(-0.5, 15).Rectangle(1, 4).Face()
    inner, outer = sector(12, 14), sector(20, 21.6)
    fluid = MoveTo(-7, 12).Rectangle(14, 10).Face() - core - probe - inner - outer
    parts = {"core": core, "probe": probe, "fluid": fluid, "inner": inner, "outer": outer}
    box = disc(BOX)
    box.edges.name = "edge"
    air = box
    for part in parts.values():
        air = air - part
    parts["air"] = air
    for name, part in parts.items():
        part.faces.name = name
        part.faces.maxh = sizes[name]
    shape = Glue(list(parts.values()))
    for vertex in shape.vertices:
        at = (vertex.p.x, vertex.p.y)
        if any(math.dist(at, c) < 1e-6 for c in TIPS + PROBE):
            vertex.maxh = corner
    return ng.Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=sizes["air"], grading=GRADING))


# Greatest sizes at scale 1, mm.
SIZES = {"probe": 0.6, "fluid": 1.0, "core": 2.0, "inner": 2.0, "outer": 2.0, "air": 40.0}
# Order, scale, size at the corners of pole and probe, mm.
SETTINGS = [(2, 1.2, 0.1), (2, 0.6, 0.02), (3, 3.0, 0.2), (3, 2.0, 0.1), (3, 1.5, 0.05), (3, 1.0, 0.05), (3, 1.0, 0.03), (4, 2.0, 0.03)]
GRADING = 0.4


class Plane:
    """Equations of the ring over a mesh."""

    def __init__(self, mesh, order, inverse="sparsecholesky", more_points=0):
        mesh.Curve(order)
        self.mesh, self.inverse = mesh, inverse
        self.space = ng.H1(mesh, order=order, dirichlet="edge")
        self.condense = order > 2  # triangles of order 2 have nothing inside
        self.free = self.space.FreeDofs(self.condense)
        self.unknowns = sum(self.space.FreeDofs())
        u, v = self.space.TnT()
        square = ng.InnerProduct(ng.grad(u), ng.grad(u))
        b = ng.sqrt(square + 1e-24)
        self.form = ng.BilinearForm(self.space, symmetric=True, condense=self.condense)
        self.form += ng.Variation(square / (2 * laws.MU_0) * ng.dx("air|probe|inner|outer"))
        for region, law in (("core", laws.steel()), ("fluid", laws.fluid())):
            energy = law.energy(b).Compile(True, wait=True)
            self.form += ng.Variation(energy * ng.dx(region, bonus_intorder=more_points))
        inner, outer = laws.wound_areas()
        density = mesh.MaterialCF({"inner": TURNS / inner, "outer": -TURNS / outer}, default=0.0)
        # of one ampere; the same vector times the potential is the flux linkage
        self.source = ng.LinearForm(density * v * ng.dx("inner|outer")).Assemble().vec
        self.field = ng.GridFunction(self.space)
        self.held = ng.Projector(self.space.FreeDofs(), True)
        self.form.AssembleLinearization(self.field.vec)
        self.solver = self.form.mat.Inverse(self.free, inverse=inverse)

    def solve(self, amps, close=1e-8):
        """Newton's method until the residual is `close` of the sources; returns its steps."""
        vec = self.field.vec
        residual, step, trial = vec.CreateVector(), vec.CreateVector(), vec.CreateVector()
        energy = self.form.Energy(vec) - amps * ng.InnerProduct(self.source, vec)
        for steps in range(40):
            self.form.Apply(vec, residual)
            residual.data -= amps * self.source
            residual.data = self.held * residual
            if ng.Norm(residual) < close * amps * ng.Norm(self.source):
                return steps
            self.form.AssembleLinearization(vec)
            self.solver.Update()
            if self.condense:
                residual.data += self.form.harmonic_extension_trans * residual
                step.data = self.solver * residual
                step.data += self.form.inner_solve * residual
                step.data += self.form.harmonic_extension * step
            else:
                step.data = self.solver * residual
            part = 1.0
            while True:
                trial.data = vec - part * step
                now = self.form.Energy(trial) - amps * ng.InnerProduct(self.source, trial)
                if now <= energy + 1e-12 * abs(energy) or part < 1e-3:
                    break
                part /= 2
            vec.data, energy = trial, now
        raise RuntimeError(f"{amps} A: no equilibrium after {steps} steps")

    def centre(self):
        """|B| at the probe's centre, T."""
        return math.hypot(*ng.grad(self.field)(self.mesh(0.0, 17.0)))

    def linked(self):
        """Flux linkage, Wb per metre of depth."""
        return abs(ng.InnerProduct(self.source, self.field.vec)) * 1e-3

    def curve(self, currents):
        """Wall and CPU seconds, Newton steps, and the rows of current, |B| at the centre, flux linkage."""
        self.field.vec[:] = 0.0
        wall = cpu = steps = 0
        rows = []
        for amps in currents:
            begun = time.perf_counter(), time.process_time()
            steps += self.solve(amps)
            wall += time.perf_counter() - begun[0]
            cpu += time.process_time() - begun[1]
            rows.append((amps, self.centre(), self.linked()))
        return wall, cpu, steps, rows


def errors(rows, truth):
    """Largest relative errors at the centre and of the linkage."""
    return [max(abs(row[i] / true[i] - 1) for row, true in zip(rows, truth)) for i in (1, 2)]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--setting", nargs=3, type=float, metavar=("ORDER", "SCALE", "CORNER"))
    p.add_argument("--inverse", default="sparsecholesky", choices=["sparsecholesky", "umfpack"])
    p.add_argument("--repeat", type=int, default=1, help="the least seconds of so many curves count")
    p.add_argument("--rows", action="store_true", help="the curve instead of the table")
    o = p.parse_args()
    ng.SetNumThreads(1)
    truth, fine = laws.reference(), laws.fine()
    if not o.rows:
        print("| NGSolve | unknowns | Newton steps | mesh s | wall s | CPU s | centre, table | linkage, table | centre, fine | linkage, fine |")
        print("|---|---|---|---|---|---|---|---|---|---|")
    for order, scale, corner in [o.setting] if o.setting else SETTINGS:
        begun = time.process_time()
        mesh = ring(scale, corner)
        meshed = time.process_time() - begun
        plane = Plane(mesh, int(order), o.inverse)
        curves = [plane.curve([row[0] for row in truth]) for _ in range(o.repeat)]
        wall, cpu = (min(c[i] for c in curves) for i in (0, 1))
        steps, rows = curves[0][2:]
        if o.rows:
            print("\n".join(",".join(f"{x:.9g}" for x in row) for row in rows))
            continue
        cells = [f"order {order:g}, sizes x {scale:g}, corners {corner:g} mm", plane.unknowns, steps]
        cells += [f"{x:.2f}" for x in (meshed, wall, cpu)]
        cells += [f"{x:.1e}" for x in errors(rows, truth) + errors(rows, fine)]
        print("| " + " | ".join(map(str, cells)) + " |", flush=True)


if __name__ == "__main__":
    main()

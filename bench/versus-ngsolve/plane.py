#!/usr/bin/env python3
"""The reference's ring electromagnet (../shared/reference/display/README.md) in the plane, by NGSolve: time and error.

    plane.py                      # the settings of the table below
    plane.py --order 3 --scale 1  # one setting

The potential A is the least of the energy, by Newton's method with a line search, from current to current, starting
with the last current's field. Times are wall seconds of assembly and solution of the 16 currents on one thread;
meshing, compiling and the first assembly (which finds the matrix' graph) are apart.
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
from netgen.occ import Circle, Face, Glue, MoveTo, OCCGeometry, WorkPlane, X, Y

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


def ring(sizes, grading):
    """Mesh of the magnet; `sizes` are the greatest element sizes, mm, by region and at the corners."""
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
        for corners, size in ((TIPS, sizes["tip"]), (PROBE, sizes["corner"])):
            if any(math.dist(at, c) < 1e-6 for c in corners):
                vertex.maxh = size
    return OCCGeometry(shape, dim=2).GenerateMesh(maxh=sizes["air"], grading=grading)


# Sizes at scale 1, mm.
SIZES = {"probe": 0.6, "fluid": 1.0, "core": 2.0, "inner": 2.0, "outer": 2.0, "air": 40.0, "tip": 0.1, "corner": 0.1}


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
    p.add_argument("--order", type=int, default=3)
    p.add_argument("--scale", type=float, default=1.0)
    p.add_argument("--grading", type=float, default=0.3)
    p.add_argument("--inverse", default="sparsecholesky")
    p.add_argument("--points", type=int, default=0)
    p.add_argument("--set", nargs="*", default=[])
    o = p.parse_args()
    ng.SetNumThreads(1)
    sizes = dict(SIZES)
    for s in o.set:
        k, v = s.split("=")
        sizes[k] = float(v)
    sizes = {k: v * o.scale for k, v in sizes.items()}
    begun = time.perf_counter()
    mesh = ng.Mesh(ring(sizes, o.grading))
    meshed = time.perf_counter() - begun
    plane = Plane(mesh, o.order, o.inverse, o.points)
    truth = laws.reference()
    wall, cpu, n, rows = plane.curve([r[0] for r in truth])
    c, l = errors(rows, truth)
    print(f"order {o.order} scale {o.scale} {o.inverse} ne {mesh.ne} free {plane.unknowns} mesh {meshed:.2f}s curve {wall:.2f}s cpu {cpu:.2f} steps {n} centre {c:.1e} linked {l:.1e}")


if __name__ == "__main__":
    main()

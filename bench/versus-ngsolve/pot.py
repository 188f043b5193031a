"""The pot magnet of the references (pot_A) with its corners resolved, by NGSolve.

python pot.py SHARED [SIDE_MM]: SHARED is the folder of shared data, SIDE_MM the length of a side at the corners of
the steel. Prints one row a current: |B| at (r, z) = (3, 2.5), (8.5, 2.5), (12.5, 2.5), (8.5, 1) and |Bz| at (0.05, -8), T.
The unknown is A_phi itself, which is smooth at the axis.
"""

import sys
from pathlib import Path

import numpy as np
from netgen.geom2d import CSG2d, Rectangle
from netgen.meshing import MeshingParameters
from ngsolve import *

SetNumThreads(1)
MU_0 = 4e-4 * np.pi
IRON = 0.22
SATURATION = 1.91 * IRON**1.133
CORNERS = [(6, 0), (11, 0), (14, 0), (6, -16), (11, -16), (14, -20), (16, 0), (16, 5)]
POINTS = [(3, 2.5), (8.5, 2.5), (12.5, 2.5), (8.5, 1.0), (0.05, -8)]


def meshed(side_mm):
    def box(r0, z0, r1, z1, **more):
        return Rectangle(pmin=(r0, z0), pmax=(r1, z1), **more)

    core = box(0, -20, 14, -16) + box(0, -16, 6, 0) + box(11, -16, 14, 0)
    core.Mat("core").Maxh(0.8)
    coil = box(6.5, -15.5, 10.5, -0.5, mat="coil")
    coil.Maxh(1.0)
    fluid = box(0, 0, 16, 5, mat="fluid")
    fluid.Maxh(0.6)
    drawing = CSG2d()
    for part in (core, coil, fluid, box(0, -90, 90, 90, mat="air") - core - coil - fluid):
        drawing.Add(part)
    wanted = MeshingParameters(maxh=8, grading=0.25)
    for r, z in CORNERS:
        wanted.RestrictH(x=r, y=z, z=0, h=side_mm)
    return Mesh(drawing.GenerateSplineGeometry().GenerateMesh(mp=wanted))


def free_dofs(mesh, space):
    """All but those on the axis and on the box."""
    free = space.FreeDofs()
    near = 1e-6
    for side in mesh.Elements(BND):
        ends = [mesh[v].point for v in side.vertices]
        on_axis = all(p[0] < near for p in ends)
        on_box = all(p[0] > 90 - near for p in ends) or all(abs(p[1]) > 90 - near for p in ends)
        if on_axis or on_box:
            for dof in space.GetDofNrs(side):
                free.Clear(dof)
    return free


def steel(shared, b):
    """H (A/mm) and its slope over B, straight between the table's points."""
    rows = (shared / "data/bh_tables/1018_Steel.csv").read_text().splitlines()
    table = np.array([[float(x) for x in row.split(",")] for row in rows if row[:1].isdigit()])
    flux, field = table[:, 0], table[:, 1] / 1e3
    slopes = np.diff(field) / np.diff(flux)
    h, slope = field[-2] + slopes[-1] * (b - flux[-2]), CF(slopes[-1])
    for i in range(len(slopes) - 2, -1, -1):
        h = IfPos(b - flux[i + 1], h, field[i] + slopes[i] * (b - flux[i]))
        slope = IfPos(b - flux[i + 1], slope, CF(slopes[i]))
    return h.Compile(), slope.Compile()


def fluid(b):
    """The same of Carlson's fluid, inverted by Newton's method."""
    x = b / (1 + 10.97 * SATURATION)
    for _ in range(14):
        left = exp(-10.97 * x)
        x = x + (b - SATURATION * (1 - left) - x) / (1 + 10.97 * SATURATION * left)
    slope = 1 / (MU_0 * (1 + 10.97 * SATURATION * exp(-10.97 * x)))
    return (x / MU_0).Compile(), slope.Compile()


def main():
    shared = Path(sys.argv[1])
    mesh = meshed(float(sys.argv[2]) if len(sys.argv) > 2 else 0.02)
    space = H1(mesh, order=3)
    free = free_dofs(mesh, space)
    u, trial, test = GridFunction(space), space.TrialFunction(), space.TestFunction()

    def g(field, slope):
        return CF((slope[0] + field / x, slope[1]))

    now, change, way = g(u, grad(u)), g(trial, grad(trial)), g(test, grad(test))
    b = sqrt(InnerProduct(now, now) + 1e-30)
    laws = {"core": steel(shared, b), "fluid": fluid(b)}
    secant = mesh.MaterialCF({name: (h / b).Compile() for name, (h, _) in laws.items()}, default=1 / MU_0)
    turn = mesh.MaterialCF({name: ((s - h / b) / b**2).Compile() for name, (h, s) in laws.items()}, default=0)
    print("I_A," + ",".join(f"B_r{r}_z{z}" for r, z in POINTS))
    for ampere in [0.25, 0.5, 0.75, 1.0]:
        density = mesh.MaterialCF({"coil": 770 * ampere / 60}, default=0)
        stiffness = BilinearForm(
            (secant * InnerProduct(change, way) + turn * InnerProduct(now, change) * InnerProduct(now, way))
            * x * dx(bonus_intorder=2)
        )
        left = LinearForm((secant * InnerProduct(now, way) - density * test) * x * dx(bonus_intorder=2))
        for _ in range(40):
            stiffness.Assemble()
            left.Assemble()
            step = u.vec.CreateVector()
            step.data = stiffness.mat.Inverse(free, inverse="sparsecholesky") * left.vec
            u.vec.data -= step
            if Norm(step) < 1e-9 * Norm(u.vec):
                break
        flux = [np.array(now(mesh(r, z))) for r, z in POINTS]
        # g is (Bz, -Br).
        found = [np.hypot(*f) for f in flux[:-1]] + [abs(flux[-1][0])]
        print(f"{ampere}," + ",".join(f"{value:.6f}" for value in found), flush=True)


main()

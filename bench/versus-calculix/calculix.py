#!/usr/bin/env python3
"""CalculiX deck of a ball pressed into a block on a sliding base, and the forces of its run.

    calculix.py deck --refinement 1 > case.inp      # then: ccx case
    calculix.py forces case.dat                     # "depth_mm force_n" a line

Units mm, N, MPa. The block has the mesh of `lut_gen::fem::block::BlockMesh` with the sizes of
`Indentation` (same element: eight nodes, 2 x 2 points), so that both codes discretise alike.
What ccx 2.20 needs, beyond its manual: a hyperfoam of one term computes no stress, so the
term is written twice with half of mu; the first step alone re-bases penetrations at every
increment, so the motion is in the second; axisymmetric elements are a wedge of 2 degrees
with flat faces, so that forces are those of the ring times sin(2 deg) / 2 pi.
"""
import argparse
import math
import sys

WEDGE = 2.0 * math.pi / math.sin(math.radians(2.0))
# Part of the depth the first step moves; negligible, but not zero.
TOUCH = 1e-5
# The ball is a polygon up to this angle from its lowest point.
ARC_DEG = 88.0


def divide(length, refinement, size):
    """[0, length] in intervals that follow size(x), as lut_gen::fem::grading::graded does."""
    samples = 4000
    step = length / samples
    count = [0.0]
    for i in range(samples):
        count.append(count[-1] + step / size((i + 0.5) * step))
    n = max(1, math.ceil(count[-1] * refinement))
    out, at = [0.0], 0
    for k in range(1, n):
        target = count[-1] * k / n
        while count[at + 1] < target:
            at += 1
        out.append((at + (target - count[at]) / (count[at + 1] - count[at])) * step)
    return out + [length]


class Quads:
    """Eight-node quadrilaterals on a lattice; node numbers from 1."""

    def __init__(self):
        self.nodes, self.elements = [], []

    def add(self, columns, rows, place):
        """columns x rows elements; place(i, j) is the position of lattice point (i, j), both
        counted in half elements. Returns the number of each lattice point."""
        number = {}
        for i in range(2 * columns + 1):
            for j in range(2 * rows + 1):
                if i % 2 == 0 or j % 2 == 0:
                    self.nodes.append(place(i, j))
                    number[i, j] = len(self.nodes)
        ring = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
        for i in range(0, 2 * columns, 2):
            for j in range(0, 2 * rows, 2):
                self.elements.append([number[i + a, j + b] for a, b in ring])
        return number


def middle(x, k):
    return x[k // 2] if k % 2 == 0 else 0.5 * (x[k // 2] + x[k // 2 + 1])


def listed(values):
    values = list(map(str, values))
    return "\n".join(",".join(values[i:i + 8]) + "," for i in range(0, len(values), 8))


def material(p):
    """Name and cards of the foam's material."""
    if p.law == "ciarlet":
        return "CIARLET_EL", f"*MATERIAL, NAME=CIARLET_EL\n*USER MATERIAL, CONSTANTS=2\n{2.0 * p.mu_mpa:.10g},0."
    term = f"{0.5 * p.mu_mpa:.10g},{p.alpha:.10g}"
    return "FOAM", f"*MATERIAL, NAME=FOAM\n*HYPERFOAM, N=2\n{term},{term},0.,0."


def deck(p):
    ball, height = p.ball_mm, p.height_mm
    near = lambda x: 0.05 + 0.06 * min(x, 1.1) + 0.4 * max(x - 1.1, 0.0)
    r = [x * ball for x in divide(p.radius_mm / ball, p.refinement, near)]
    z = [height - x * ball for x in reversed(divide(height / ball, p.refinement, lambda x: 0.05 + 0.25 * x))]
    z[0] = 0.0
    columns, rows = len(r) - 1, len(z) - 1
    mesh = Quads()
    block = mesh.add(columns, rows, lambda i, j: (middle(r, i), middle(z, j)))
    block_nodes, block_elements = len(mesh.nodes), len(mesh.elements)
    # the ball: one layer of held elements, edges half as long as the block's finest
    arc = math.radians(ARC_DEG)
    edges = math.ceil(arc / (0.5 * 0.05 / p.refinement))

    def on_ball(i, j):
        angle, radius = arc * i / (2 * edges), ball * (1.0 - 0.1 * j / 2)
        return radius * math.sin(angle), height + ball - radius * math.cos(angle)

    tool = mesh.add(edges, 1, on_ball)
    touching = [(i + 1) * rows for i in range(columns) if r[i] < 1.6 * ball]

    def elements(name, first, last):
        lines = [",".join(map(str, [e + 1] + mesh.elements[e])) for e in range(first, last)]
        return f"*ELEMENT, TYPE=CAX8R, ELSET={name}\n" + "\n".join(lines)

    def faces(name, numbers, face):
        return f"*SURFACE, NAME={name}, TYPE=ELEMENT\n" + "\n".join(f"{e},S{face}" for e in numbers)

    def nodes(name, numbers):
        return f"*NSET, NSET={name}\n" + listed(numbers)

    def motion(part):
        return f"*BOUNDARY\nBALL,1,1\nBALL,2,2,{-part * p.depth_mm:.10g}"

    stops = [d / p.depth_mm for d in p.depths_mm]
    name, law = material(p)
    return "\n".join([
        f"** {columns} x {rows} elements, {2 * block_nodes} dofs of the block",
        "*NODE, NSET=ALL",
        "\n".join(f"{n},{x:.12g},{y:.12g}" for n, (x, y) in enumerate(mesh.nodes, 1)),
        elements("BLOCK", 0, block_elements),
        elements("TOOL", block_elements, len(mesh.elements)),
        nodes("BASE", [n for (i, j), n in block.items() if j == 0]),
        nodes("AXIS", [n for (i, j), n in block.items() if i == 0]),
        nodes("BALL", tool.values()),
        faces("TOP", touching, 3),
        faces("SPHERE", range(block_elements + 1, len(mesh.elements) + 1), 1),
        law,
        "*MATERIAL, NAME=RIGID\n*ELASTIC\n1000.,0.",
        f"*SOLID SECTION, ELSET=BLOCK, MATERIAL={name}\n*SOLID SECTION, ELSET=TOOL, MATERIAL=RIGID",
        f"*SURFACE INTERACTION, NAME=CONTACT\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{p.penalty:g},1e-3",
        "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE\nTOP,SPHERE",
        "*BOUNDARY\nBASE,2,2\nAXIS,1,1\nBALL,1,2",
        f"*TIME POINTS, NAME=STOPS\n{listed(f'{s:.8g}' for s in stops)}",
        "*STEP, NLGEOM, INC=100\n*STATIC, DIRECT\n1.,1.",
        motion(TOUCH),
        "*NODE PRINT, NSET=BASE, TOTALS=ONLY\nRF\n*END STEP",
        f"*STEP, NLGEOM, INC=20000\n*STATIC\n{p.first},1.,1e-7,{p.largest}",
        # part of the mean force a residual may have, and of the increment a correction
        f"*CONTROLS, PARAMETERS=FIELD\n{p.residual:g},{p.correction:g}",
        # iterations before divergence is judged, before a cut, at most; factors of the cuts
        "*CONTROLS, PARAMETERS=TIME INCREMENTATION\n8,12,9,40,20,4,,15,\n0.25,0.5,0.75,0.85,,,1.5,",
        motion(1.0),
        "*NODE PRINT, NSET=BASE, TOTALS=ONLY, TIME POINTS=STOPS\nRF\n*END STEP\n",
    ])


def forces(path, depth_mm):
    """Reaction of the base over depth, from the second step's totals in a .dat file."""
    lines = iter(open(path, encoding="ascii", errors="replace"))
    for line in lines:
        if "total force" in line and "BASE" in line:
            time = float(line.split("time")[1]) - 1.0
            value = next((v for v in lines if v.strip()), "")
            if time > 1e-9:
                yield time * depth_mm, float(value.split()[1]) * WEDGE


def main():
    top = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sub = top.add_subparsers(dest="command", required=True)
    d = sub.add_parser("deck")
    d.add_argument("--refinement", type=float, default=1.0, help="divides all element sizes")
    d.add_argument("--ball-mm", type=float, default=4.0)
    d.add_argument("--height-mm", type=float, default=12.7)
    d.add_argument("--radius-mm", type=float, default=25.0)
    d.add_argument("--mu-mpa", type=float, default=0.22)
    d.add_argument("--alpha", type=float, default=10.526)
    d.add_argument("--law", choices=["hyperfoam", "ciarlet"], default="hyperfoam",
                   help="ciarlet: ccx's own Ciarlet law with lambda = 0, the hyperfoam of alpha = 2 and nu = 0")
    d.add_argument("--penalty", type=float, default=1000.0, help="MPa/mm")
    d.add_argument("--first", type=float, default=0.01, help="first increment, part of the depth")
    d.add_argument("--largest", type=float, default=0.05, help="largest increment, part of the depth")
    d.add_argument("--residual", type=float, default=1e-3, help="residual that counts as equilibrium")
    d.add_argument("--correction", type=float, default=1e-2, help="correction that counts as converged")
    f = sub.add_parser("forces")
    f.add_argument("dat")
    for s in (d, f):
        s.add_argument("--depth-mm", type=float, default=4.0)
    p = top.parse_args()
    if p.command == "deck":
        p.depths_mm = [0.25 * k * p.depth_mm / 4.0 for k in range(1, 17)]
        sys.stdout.write(deck(p))
    else:
        for depth, force in forces(p.dat, p.depth_mm):
            print(f"{depth:.6g} {force:.6g}")


if __name__ == "__main__":
    main()

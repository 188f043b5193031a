#!/usr/bin/env python3
"""Flux density at the centre of the ring electromagnet with other gaps, by NGSolve in the plane: the rows of gap.csv.

    gap.py > gap.csv

A diagnosis is tried on them: it knows the ring with a gap of 10 mm.
"""
from netgen.occ import Glue, MoveTo, OCCGeometry
import math
import ngsolve as ng

import plane

GAPS = (9.2, 10.0, 10.8)
CURRENTS = (0.6, 1.2, 1.8, 2.4, 3.0, 3.6)


def ring(gap):
    """The ring of plane.py with another gap, its container two millimetres wider to either side."""
    half = gap / 2
    core = plane.disc(20) - plane.disc(14) - MoveTo(-half, 0).Rectangle(gap, 30).Face()
    probe = MoveTo(-0.5, 15).Rectangle(1, 4).Face()
    inner, outer = plane.sector(12, 14), plane.sector(20, 21.6)
    fluid = MoveTo(-half - 2, 12).Rectangle(gap + 4, 10).Face() - core - probe - inner - outer
    parts = {"core": core, "probe": probe, "fluid": fluid, "inner": inner, "outer": outer}
    box = plane.disc(plane.BOX)
    box.edges.name = "edge"
    air = box
    for part in parts.values():
        air = air - part
    parts["air"] = air
    for name, part in parts.items():
        part.faces.name = name
        part.faces.maxh = plane.SIZES[name]
    shape = Glue(list(parts.values()))
    tips = [(s * half, math.sqrt(r * r - half * half)) for s in (-1, 1) for r in (14.0, 20.0)]
    for vertex in shape.vertices:
        if any(math.dist((vertex.p.x, vertex.p.y), c) < 1e-6 for c in tips + plane.PROBE):
            vertex.maxh = 0.05
    return ng.Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=plane.SIZES["air"], grading=plane.GRADING))


def main():
    print("# The ring electromagnet of plane.py with other gaps, in the plane: NGSolve, order 3, corners of 0.05 mm (gap.py).")
    print("gap_mm,current_A,B_centre_T")
    for gap in GAPS:
        magnet = plane.Plane(ring(gap), 3)
        for amps in CURRENTS:
            magnet.solve(amps)
            print(f"{gap},{amps},{magnet.centre():.8f}", flush=True)


if __name__ == "__main__":
    main()

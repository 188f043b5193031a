#!/usr/bin/env python3
"""A row of plane.py's table from what the test of the ring electromagnet printed: `ours.py LOG`.

The test prints relative deviations from the reference's table to 1e-5, so these errors are rounded so.
CPU seconds are those of the test less those of its mesh and analysis.
"""
import re
import sys

import laws


def main():
    text = open(sys.argv[1], encoding="utf-8").read()
    unknowns, meshed = re.search(r"(\d+) unknowns, meshed and analysed in ([\d.]+) s", text).groups()
    wall = min(map(float, re.findall(r"curve in ([\d.]+) s", text)))
    cpu = min(float(user) + float(system) for user, system in re.findall(r"CPU ([\d.]+) ([\d.]+)", text))
    errors = [0.0] * 4
    steps = 0
    truth = {row[0]: row for row in laws.reference()}
    fine = {row[0]: row for row in laws.fine()}
    curve = text[: text.index("curve in")]
    for amps, made, deviations, linkage in re.findall(r"([\d.]+) A: (\d+) steps, (.*) linkage (\S+)", curve):
        steps += int(made)
        off = float(deviations.split()[0]), float(linkage)
        for i in (0, 1):
            ours = truth[float(amps)][1 + i] * (1 + off[i])
            errors[i] = max(errors[i], abs(off[i]))
            errors[2 + i] = max(errors[2 + i], abs(ours / fine[float(amps)][1 + i] - 1))
    cells = ["this project, order 2", unknowns, steps, meshed, f"{wall:.2f}", f"{cpu - float(meshed):.2f}"]
    print("| " + " | ".join(map(str, cells + [f"{e:.1e}" for e in errors])) + " |")


if __name__ == "__main__":
    main()

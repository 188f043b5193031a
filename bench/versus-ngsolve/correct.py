#!/usr/bin/env python3
"""Tables of depth.csv in markdown: |B| at the centre at finite depth over the plane's, and what the closed form gives.

The closed form is the plane problem with air of relative permeability `laws.air`, times `laws.bulge`: rows of depth.csv
with depth 0 and that permeability.
"""
from pathlib import Path

import laws

NAMES = laws.COLUMNS.split(",")


def main():
    rows = [dict(zip(NAMES, row)) for row in laws.table(Path(__file__).with_name("depth.csv"))]
    magnet = lambda row: tuple(row[n] for n in ("gap_mm", "inner_mm", "outer_mm", "probe", "linear", "current_A"))
    plane = {(magnet(row), row["wide"]): row for row in rows if row["depth_mm"] == 0}
    print("| gap | core, radii | laws | depth | current | B, plane | B, depth | factor | formula | error | probe | linkage | error |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    worst = {}
    for row in rows:
        depth = row["depth_mm"]
        if depth == 0:
            continue
        inner, outer = row["inner_mm"], row["outer_mm"]
        wide = laws.air(depth, inner, outer)
        flat = plane[magnet(row), 1.0]
        near = [p for (m, w), p in plane.items() if m == magnet(row) and abs(w - wide) < 1e-4 * wide]
        if not near:
            raise SystemExit(f"no plane with air of {wide:.6g} for {row}")
        b = {n: row[n] / flat[n] for n in ("B_centre_T", "B_probe_T", "lambda_Wb_per_m")}
        guess = near[0]["B_centre_T"] / flat["B_centre_T"] * laws.bulge(depth, row["gap_mm"])
        error = guess / b["B_centre_T"] - 1
        linkage = near[0]["lambda_Wb_per_m"] / row["lambda_Wb_per_m"] - 1
        kind = ("linear" if row["linear"] else "steel, fluid") + (", probe" if row["probe"] else "")
        worst.setdefault(kind, []).append(error)
        print(
            f"| {row['gap_mm']:g} | {inner:g}, {outer:g} | {kind} | {depth:g} | {row['current_A']:g} | {flat['B_centre_T']:.4f} "
            f"| {row['B_centre_T']:.4f} | {b['B_centre_T']:.3f} | {guess:.3f} | {100 * error:+.1f} % | {b['B_probe_T']:.3f} "
            f"| {b['lambda_Wb_per_m']:.3f} | {100 * linkage:+.1f} % |"
        )
    for kind, errors in worst.items():
        print(f"\n{kind}: errors of the factor from {100 * min(errors):+.1f} % to {100 * max(errors):+.1f} %.")


if __name__ == "__main__":
    main()

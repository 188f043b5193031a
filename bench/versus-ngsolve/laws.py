"""Energy density W of the steel's table and of the fluid's law over the flux density, A T/mm, for NGSolve.

Lengths are mm and potentials T mm throughout this folder. A law H(B) is a polynomial from zero plus one term
c (B - b)^n for every b that B has passed: straight lines (n = 1) or a cubic spline (n = 3). NGSolve compiles such
sums for whole vectors of points, which it does not do with its own splines; these took twice the time.
"""
import math
from pathlib import Path

import numpy as np
from ngsolve import IfPos, exp
from scipy.interpolate import PPoly, make_interp_spline

MU_0 = 4e-4 * math.pi  # T mm / A
SHARED = Path(__file__).resolve().parents[3] / "shared"


class Law:
    """H(B) from a spline of scipy that is zero at zero."""

    def __init__(self, spline):
        pieces = PPoly.from_spline(spline)
        self.strength = spline
        self.power = pieces.c.shape[0] - 1
        used = np.flatnonzero(np.diff(pieces.x) > 0)
        self.start = pieces.c[::-1, used[0]]  # of B^0, B^1, ..
        self.knots = pieces.x[used[1:]]
        self.jumps = np.diff(pieces.c[0, used])

    def value(self, b):
        """The law itself, a coefficient function."""
        h = sum(float(c) * b**n for n, c in enumerate(self.start) if n)
        for knot, jump in zip(self.knots, self.jumps):
            h = h + float(jump) * IfPos(b - float(knot), b - float(knot), 0.0) ** self.power
        return h

    def energy(self, b):
        """The integral of H from zero to b >= 0, a coefficient function."""
        w = sum(float(c) / (n + 1) * b ** (n + 1) for n, c in enumerate(self.start) if n)
        for knot, jump in zip(self.knots, self.jumps):
            past = IfPos(b - float(knot), b - float(knot), 0.0)
            w = w + float(jump) / (self.power + 1) * past ** (self.power + 1)
        return w


def steel(name="1018_Steel"):
    """A steel of the tables in ../shared/data/bh_tables: straight lines, the last slope continued."""
    b, h = np.array(table(SHARED / "data/bh_tables" / f"{name}.csv")).T
    return Law(make_interp_spline(b, h * 1e-3, k=1))


def fluid(phi=0.22):
    """Carlson's law B = 1.91 phi^1.133 (1 - exp(-10.97 mu_0 H)) + mu_0 H, turned round: a cubic spline, wrong by 2e-6 of H."""
    most, rate = 1.91 * phi**1.133, 10.97
    x = np.concatenate([0.8 * np.linspace(0, 1, 40) ** 1.5, 0.8 + 1.9 * np.linspace(0, 1, 8)[1:] ** 1.5])
    b = most * (1 - np.exp(-rate * x)) + x
    slopes = [(1, 1 / (MU_0 * (1 + most * rate)))], [(1, 1 / MU_0)]
    return Law(make_interp_spline(b, x / MU_0, k=3, bc_type=slopes))


def steel_of_strength(name="1018_Steel"):
    """The same table as B(H); `energy` is then the coenergy."""
    points = steel(name).strength
    return Law(make_interp_spline(points.c, points.t[1:-1], k=1))


class Carlson:
    """The fluid's law as B(H), in closed form."""

    def __init__(self, phi=0.22):
        self.most, self.rate = 1.91 * phi**1.133, 10.97 * MU_0
        self.slope = self.most * self.rate + MU_0

    def value(self, h):
        return self.most * (1 - exp(-self.rate * h)) + MU_0 * h

    def energy(self, h):
        return self.most * (h + (exp(-self.rate * h) - 1) / self.rate) + MU_0 / 2 * h**2


def wound_areas():
    """Areas of the inner and the outer sector of the coil, mm^2."""
    half = math.radians(310) / 2
    return half * (14.0**2 - 12.0**2), half * (21.6**2 - 20.0**2)


COLUMNS = (
    "depth_mm,gap_mm,inner_mm,outer_mm,probe,linear,wide,current_A,B_centre_T,B_probe_T,lambda_Wb_per_m,"
    "unknowns,newton,seconds,ampere,flux_lost"
)


def air(depth, inner, outer):
    """Relative permeability of the plane problem's air that stands for a core of a depth and two radii, mm."""
    return 1 + (0.75 * (inner + outer) / 2 + 2.0 * (outer - inner)) / depth


def bulge(depth, gap):
    """The field in the middle of a gap between poles of a depth over that of the plane with `air`."""
    return 1 - 0.45 * math.exp(-1.5 * math.pi * depth / gap)


def table(path):
    """Rows of numbers of a file with comments and one line of names."""
    lines = path.read_text().splitlines()
    return [[float(c) for c in line.split(",")] for line in lines if line[:1].isdigit()]


def reference():
    """The reference curve: rows of current, |B| at the centre, and flux linkage."""
    return [(row[0], row[1], row[13]) for row in table(SHARED / "reference/display/ring_A.csv")]


def fine():
    """The same curve by plane.py on a very fine mesh."""
    return table(Path(__file__).with_name("ring_A_fine.csv"))

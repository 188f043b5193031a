#!/usr/bin/env python3
"""The same thousand identifications in NumPy and SciPy, timed beside the Rust ones.

    identify.py FOLDER      # what `cargo run --release -p tests --example versus_python -- FOLDER` wrote

Units mm, N, MPa. Prints lines "name value". Preparation that happens once a table (arrays in the right order,
splines) is not timed, as the table is not either. The thesis' way calls griddata(.., 'cubic') three times a sample as its
Appendix D does, on the scattered 900 points; it is timed on some samples of one identification and scaled.
"""
import pathlib
import sys
import time

import numpy as np
from scipy.interpolate import RectBivariateSpline, griddata
from scipy.spatial.distance import cdist

# Samples on which the thesis' way is timed.
GRIDDATA_SAMPLES = 10


def fastest(times, run):
    """Result and least CPU time of some runs: other jobs only ever slow one down."""
    best = np.inf
    for _ in range(times):
        start = time.process_time()
        result = run()
        best = min(best, time.process_time() - start)
    return result, best


class Problem:
    """Table and measured curves, in float32 as the board has them."""

    def __init__(self, folder):
        def read(name):
            return np.fromfile(folder / f"{name}.f32", dtype="<f4")

        self.alpha, self.mu, self.depth = read("alpha"), read("mu"), read("depth")
        self.shape = read("shape").reshape(self.alpha.size, self.depth.size)
        self.measured = read("measured").reshape(-1, self.depth.size)
        self.noise_n = float(read("noise")[0])
        # exponent slow, modulus fast, as the table's columns
        self.columns = (self.shape[:, None, :] * self.mu[None, :, None]).reshape(-1, self.depth.size)
        self.columns = np.ascontiguousarray(self.columns)

    # Eq. 17: sum of absolute differences over the samples, for 900 columns.

    def variance_numpy(self):
        scratch = np.empty_like(self.columns)
        found = np.empty(len(self.measured), dtype=int)
        for i, force in enumerate(self.measured):
            np.subtract(self.columns, force, out=scratch)
            np.abs(scratch, out=scratch)
            found[i] = scratch.sum(axis=1).argmin()
        return found

    def variance_cdist(self):
        return cdist(self.measured, self.columns, "cityblock").argmin(axis=1)


class Kalman:
    """Thesis Eqs. 18 to 21 with projection onto the bounds (Appendix D); state (alpha, mu).

    Force and gradient come from one bicubic spline a depth, through the same 30 x 30 points as the thesis' griddata.
    """

    def __init__(self, problem, start):
        self.measured = problem.measured
        self.low = np.array([problem.alpha[0], problem.mu[0]], dtype=float)
        self.high = np.array([problem.alpha[-1], problem.mu[-1]], dtype=float)
        self.start = np.array(start, dtype=float)
        self.variance = problem.noise_n**2
        self.grids = [np.outer(problem.shape[:, k], problem.mu).astype(float) for k in range(problem.depth.size)]
        self.splines = [RectBivariateSpline(problem.alpha, problem.mu, g) for g in self.grids]
        self.points = np.stack(np.meshgrid(problem.alpha, problem.mu, indexing="ij"), axis=-1).reshape(-1, 2)
        steps = (problem.alpha[1] - problem.alpha[0], problem.mu[1] - problem.mu[0])
        self.gradients = [np.gradient(g, *steps) for g in self.grids]

    def covariance(self):
        return np.diag((self.high - self.low) ** 2)

    def update(self, x, p, force, modelled, gradient):
        gain = p @ gradient / (gradient @ p @ gradient + self.variance)
        p = p - np.outer(gain, gradient @ p)
        return np.clip(x + gain * (force - modelled), self.low, self.high), p

    def one(self, measured):
        x, p = self.start.copy(), self.covariance()
        for spline, force in zip(self.splines, measured):
            gradient = np.array([spline(*x, dx=1, grid=False), spline(*x, dy=1, grid=False)])
            x, p = self.update(x, p, force, spline(*x, grid=False), gradient)
        return x

    def one_by_one(self, count):
        return np.array([self.one(measured) for measured in self.measured[:count]])

    def all_at_once(self):
        """All identifications side by side, a sample at a time: fast, but no way to answer while one press goes on."""
        n = len(self.measured)
        x = np.tile(self.start, (n, 1))
        p = np.tile(self.covariance(), (n, 1, 1))
        for k, spline in enumerate(self.splines):
            a, m = x[:, 0], x[:, 1]
            gradient = np.stack([spline.ev(a, m, dx=1), spline.ev(a, m, dy=1)], axis=1)
            ph = np.einsum("nij,nj->ni", p, gradient)
            s = np.einsum("ni,ni->n", gradient, ph) + self.variance
            innovation = (self.measured[:, k] - spline.ev(a, m)) / s
            p -= ph[:, :, None] * ph[:, None, :] / s[:, None, None]
            x = np.clip(x + ph * innovation[:, None], self.low, self.high)
        return x

    def griddata(self, samples):
        """The thesis' way, from the middle of the press on: force and both gradients by griddata at every sample."""
        x, p = self.start.copy(), self.covariance()
        first = len(self.grids) // 2
        for k in range(first, first + samples):
            at = [griddata(self.points, values.ravel(), x[None, :], "cubic")[0]
                  for values in (self.grids[k], *self.gradients[k])]
            x, p = self.update(x, p, self.measured[0, k], at[0], np.array(at[1:]))
        return x


def main():
    folder = pathlib.Path(sys.argv[1])
    problem = Problem(folder)
    n = len(problem.measured)
    ours = np.loadtxt(folder / "columns.txt", dtype=int)
    for name, run in (("numpy", problem.variance_numpy), ("cdist", problem.variance_cdist)):
        found, seconds = fastest(3, run)
        print(f"variance_{name}_s {seconds:.4f}")
        print(f"variance_{name}_same {np.count_nonzero(found == ours)}")
    kalman = Kalman(problem, np.loadtxt(folder / "start.txt"))
    theirs = np.loadtxt(folder / "kalman.txt")
    few = 50
    _, seconds = fastest(3, lambda: kalman.one_by_one(few))
    print(f"kalman_one_by_one_s {seconds * n / few:.4f}")
    found, seconds = fastest(3, kalman.all_at_once)
    print(f"kalman_all_at_once_s {seconds:.4f}")
    off = np.sort(np.abs(found[:, 0] - np.loadtxt(folder / "truth.txt")))
    print(f"kalman_all_at_once_median {off[n // 2]:.3f}")
    print(f"kalman_all_at_once_most {off[n * 9 // 10]:.3f}")
    span = kalman.high - kalman.low
    print(f"kalman_median_difference {np.median(np.abs(found - theirs) / span):.2e}")
    print(f"kalman_same {np.count_nonzero((np.abs(found - theirs) / span).max(axis=1) < 0.01)}")
    _, seconds = fastest(1, lambda: kalman.griddata(GRIDDATA_SAMPLES))
    print(f"kalman_griddata_s {seconds * n * len(kalman.grids) / GRIDDATA_SAMPLES:.0f}")
    print(f"kalman_griddata_samples {GRIDDATA_SAMPLES}")


if __name__ == "__main__":
    main()

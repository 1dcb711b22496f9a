#!/usr/bin/env python3
"""Writes time_fit.json beside itself: robust non-negative fits solved to 50 digits (mpmath), 30 of them printed.

Minimised over c >= 0: half the sum over rows of b log(1 + r^2 / b), b = 0.01, r = (predicted - measured) / (measured + 0.3 ms); predicted is
shared + geometry + fill, or shared + max(geometry, fill). Floats find the active set (iteratively reweighted NNLS, from a convex loss);
Newton's method with the exact Hessian ends it in 50 digits; the signs of the gradient and the distance from kinks are checked.
Run: python3 tests/golden/make_time_fit.py   (needs numpy, scipy, mpmath)
"""
import json
import pathlib

import mpmath
import numpy as np
from scipy.optimize import nnls

mpmath.mp.dps = 50
SMALL_FRAME_MS, SCALE, CONVEX_SCALE = 0.3, 0.1, 0.2
STAGE_NAMES = ["shared", "geometry", "fill"]


class Case:
    def __init__(self, name, stages, features, milliseconds, combination="sum", ill_posed=False):
        self.name, self.stages, self.combination, self.ill_posed = name, np.array(stages), combination, ill_posed
        self.features, self.milliseconds = np.array(features, float), np.array(milliseconds, float)

    def seen(self, c):
        """The features that count at c: those of the hidden stage are 0."""
        if self.combination == "sum":
            return np.ones(self.features.shape, bool)
        geometry = self.features[:, self.stages == 1] @ c[self.stages == 1]
        fill = self.features[:, self.stages == 2] @ c[self.stages == 2]
        assert np.min(np.abs(geometry - fill) / (geometry + fill)) > 1e-9, "the solution lies in a kink"
        hidden = np.where(geometry < fill, 1, 2)
        return self.stages[None, :] != hidden[:, None]


def float_solution(case):
    """Reweighted NNLS: first under the convex loss, then under Cauchy's."""
    weight = 1.0 / (case.milliseconds + SMALL_FRAME_MS)
    x, y = case.features * weight[:, None], case.milliseconds * weight
    unit = 1.0 / np.sqrt(np.mean(x * x, axis=0))
    members = [max(1, np.count_nonzero(case.stages == s)) for s in case.stages]
    c = 0.5 * unit / np.array(members)
    for loss, steps in (("convex", 50), ("cauchy", 2000)):
        for _ in range(steps):
            seen = x * case.seen(c)
            t = (seen @ c - y) ** 2
            slope = 1 / np.sqrt(1 + t / CONVEX_SCALE**2) if loss == "convex" else 1 / (1 + t / SCALE**2)
            root = np.sqrt(slope)
            c = nnls(root[:, None] * seen * unit, root * y, maxiter=10000)[0] * unit
    return c


def gradient_and_hessian(case, c, mask):
    b, n = mpmath.mpf(1) / 100, len(c)  # the square of the double 0.1 differs in the 17th digit
    gradient, hessian, objective = mpmath.zeros(n, 1), mpmath.zeros(n, n), mpmath.mpf(0)
    for features, seen, ms in zip(case.features, mask, case.milliseconds):
        y = mpmath.mpf(float(ms))
        weight = 1 / (y + mpmath.mpf(SMALL_FRAME_MS))
        x = [mpmath.mpf(float(f)) * weight if s else mpmath.mpf(0) for f, s in zip(features, seen)]
        r = sum(xj * cj for xj, cj in zip(x, c)) - y * weight
        t = r * r / b
        objective += b * mpmath.log1p(t) / 2
        slope, curvature = 1 / (1 + t), (1 - t) / (1 + t) ** 2
        for j in range(n):
            gradient[j] += slope * r * x[j]
            for k in range(n):
                hessian[j, k] += curvature * x[j] * x[k]
    return gradient, hessian, objective


def exact_solution(case):
    start = float_solution(case)
    x = case.features / (case.milliseconds + SMALL_FRAME_MS)[:, None]
    share = start * np.sqrt(np.mean(x * x, axis=0))
    free = [j for j in range(len(start)) if share[j] > (1e-9 if not case.ill_posed else 1e-6)]
    c = [mpmath.mpf(float(start[j])) if j in free else mpmath.mpf(0) for j in range(len(start))]
    mask = case.seen(np.array([float(v) for v in c]))
    for _ in range(60):
        gradient, hessian, _ = gradient_and_hessian(case, c, mask)
        part = mpmath.matrix([[hessian[j, k] for k in free] for j in free])
        step = mpmath.lu_solve(part, -mpmath.matrix([gradient[j] for j in free]))
        for k, j in enumerate(free):
            c[j] += step[k]
        if max(abs(step[k] / c[j]) for k, j in enumerate(free)) < mpmath.mpf(10) ** -38:
            break
    else:
        raise AssertionError(f"{case.name}: Newton's method did not converge")
    gradient, hessian, objective = gradient_and_hessian(case, c, mask)
    assert np.array_equal(mask, case.seen(np.array([float(v) for v in c]))), case.name
    assert all(c[j] > 0 for j in free), case.name
    assert all(gradient[j] > 0 for j in range(len(c)) if j not in free), f"{case.name}: a bound is not active"
    part = mpmath.matrix([[hessian[j, k] for k in free] for j in free])
    mpmath.cholesky(part)  # a minimum
    return c, free, objective


def problem(seed, rows, scales, costs, noise, combination="sum", outliers=0.0, negative=None, sizes=1.0):
    """A constant shared term and terms of geometry and fill by turns; milliseconds rounded to 12 digits."""
    rng = np.random.default_rng(seed)
    n = len(scales)
    stages = [0] + [1 + (j + 1) % 2 for j in range(1, n)]
    size = 10 ** rng.uniform(-sizes, 0, rows)
    features = np.ones((rows, n))
    for j in range(1, n):
        features[:, j] = [float(f"{v:.9g}") for v in size * scales[j] * rng.uniform(0, 1, rows)]
    c = np.array(costs, float)
    parts = [features[:, np.array(stages) == s] @ c[np.array(stages) == s] for s in range(3)]
    ms = parts[0] + (parts[1] + parts[2] if combination == "sum" else np.maximum(parts[1], parts[2]))
    if negative is not None:
        ms = np.maximum(0.05, ms - 1.5 * features[:, negative] * c[negative])
    ms = ms * np.exp(noise * rng.standard_normal(rows))
    slow = rng.uniform(0, 1, rows) < outliers
    ms = np.where(slow, 10 * ms, ms)
    return stages, features, np.array([float(f"{v:.12g}") for v in ms])


def near_collinear(seed, gap, noise):
    """Column 2 is column 1 but for a share `gap`."""
    rng = np.random.default_rng(seed)
    rows = 40
    a, d, e = rng.uniform(0.1, 1, rows), rng.uniform(0.1, 1, rows), rng.uniform(-1, 1, rows)
    features = np.stack([np.ones(rows), a, a * (1 + gap * e), d], axis=1)
    ms = features @ np.array([0.3, 2.0, 3.0, 1.0]) * np.exp(noise * rng.standard_normal(rows))
    return [0, 1, 1, 2], features, ms


def cases():
    ones = [1.0] * 6
    yield Case("exact times", *problem(1, 40, ones, [0.5, 2, 1, 3, 0.7, 1.5], 0.0))
    yield Case("3 % noise", *problem(2, 60, ones, [0.5, 2, 1, 3, 0.7, 1.5], 0.03))
    yield Case("15 % noise", *problem(3, 60, ones[:4], [0.5, 2, 1, 3], 0.15))
    yield Case("20 % outliers at 10x", *problem(4, 60, ones[:5], [0.5, 2, 1, 3, 2], 0.02, outliers=0.2))
    scales = [1, 1e9, 1e-9, 1e5, 1e-4]
    yield Case("scales 1e-9 to 1e9", *problem(5, 60, scales, [0.3, 2e-9, 3e9, 1e-5, 2e4], 0.03))
    yield Case("one term wants to be negative", *problem(6, 60, ones[:5], [3, 2, 1, 3, 1], 0.02, negative=2))
    yield Case("terms that cost nothing", *problem(7, 50, ones, [0.5, 2, 0, 3, 0, 1], 0.05))
    yield Case("four decades of frame size", *problem(8, 80, [1, 1e4, 1e4, 1e4], [0.05, 2e-1, 1e-1, 3e-1], 0.05, sizes=4))
    yield Case("one term", *problem(9, 30, ones[:1], [2.0], 0.1))
    yield Case("as many rows as terms", *problem(10, 4, ones[:4], [0.5, 2, 1, 3], 0.0))
    exact_max = problem(11, 60, ones[:5], [0.3, 2, 2, 3, 3], 0.0, combination="max")
    yield Case("longer stage, exact", *exact_max, combination="max")
    yield Case("longer stage, 2 % noise", *problem(14, 60, ones[:5], [0.3, 2, 2, 3, 3], 0.02, combination="max"), combination="max")
    bounded = problem(20, 60, ones[:5], [1, 2, 2, 3, 1], 0.02, combination="max", outliers=0.1, negative=4)
    yield Case("longer stage, outliers and a bound", *bounded, combination="max")
    yield Case("collinear to 1e-7, 3 % noise: a bound decides", *near_collinear(14, 1e-7, 0.03))
    for seed, gap in ((31, 1e-7), (32, 1e-9), (33, 1e-11), (34, 1e-12)):
        yield Case(f"collinear to {gap:g}, exact times", *near_collinear(seed, gap, 0.0), ill_posed=True)


def main():
    written = []
    for case in cases():
        c, free, objective = exact_solution(case)
        print(case.name, [float(v) for v in c])
        written.append({
            "name": case.name, "combination": case.combination, "ill_posed": case.ill_posed,
            "stages": [STAGE_NAMES[s] for s in case.stages], "features": [float(v) for v in case.features.ravel()],
            "milliseconds": [float(v) for v in case.milliseconds],
            "milliseconds_per_unit": [mpmath.nstr(v, 30) for v in c], "objective": mpmath.nstr(objective, 30),
            "predicted_ms": [mpmath.nstr(sum(mpmath.mpf(float(f)) * v for f, v, s in zip(row, c, seen) if s), 30)
                             for row, seen in zip(case.features, case.seen(np.array([float(v) for v in c])))]})
    file = pathlib.Path(__file__).with_name("time_fit.json")
    lines = ",\n".join(json.dumps(entry) for entry in written)
    file.write_text('{"description": "robust non-negative fits, 50-digit reference; see make_time_fit.py", "cases": [\n' + lines + "\n]}\n")


main()

"""Writes tests/data/lar/surface.csv and expected.csv: a force surface and its LAR-compatible statistics, by NumPy and SciPy.

Usage: python3 lar.py ../data/lar

An implementation of the section "LAR-compatible statistics" that shares no code with src/numerics/lar.rs: fits by SciPy's MINPACK
and NumPy's SVD-based lstsq, leverages by NumPy's QR, quantiles by SciPy. The surface is
    F* = c0 (exp(-c1 e) - 1) + P exp(-c2 e^2)
with relative contraction e and relative pressure P, both from 0 to 1, at 257 rows with heavy-tailed errors.
"""

import pathlib
import sys

import numpy as np
from scipy import optimize, stats

TUNING = 4.685
TINY = np.sqrt(np.finfo(float).eps)
TRUE = np.array([0.25, 3.0, 1.1])
START = np.array([0.2, 2.0, 1.0])


def model(c, e, p):
    return c[0] * (np.exp(-c[1] * e) - 1) + p * np.exp(-c[2] * e**2)


def jacobian(c, e, p):
    decay = np.exp(-c[1] * e)
    return np.column_stack([decay - 1, -c[0] * e * decay, -p * e**2 * np.exp(-c[2] * e**2)])


def solve(start, weights, e, p, y):
    root = np.sqrt(weights)
    fit = optimize.least_squares(
        lambda c: root * (model(c, e, p) - y),
        start,
        jac=lambda c: root[:, None] * jacobian(c, e, p),
        method="lm",
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
    )
    c = fit.x
    for _ in range(10):
        c = c + np.linalg.lstsq(root[:, None] * jacobian(c, e, p), root * (y - model(c, e, p)), rcond=None)[0]
    return c


def weight(kind, u):
    if kind == "lar":
        return 1 / np.maximum(TINY, np.abs(u))
    return np.where(np.abs(u) < 1, (1 - u**2) ** 2, 0)


def sigma_of(r, p, y):
    return max(np.median(np.sort(np.abs(r))[p - 1 :]) / 0.6745, 1e-6 * np.std(y, ddof=1))


def statistics(kind, e, pressure, y):
    n, p = len(y), len(TRUE)
    ordinary = c = solve(START, np.ones(n), e, pressure, y)
    q, _ = np.linalg.qr(jacobian(c, e, pressure))
    h = np.minimum(0.9999, np.sum(q**2, axis=1))
    r = y - model(c, e, pressure)
    s_ols = np.sqrt(r @ r / (n - p))
    adjusted = r / np.sqrt(1 - h)
    passes = 0
    while True:
        before = c
        c = solve(c, weight(kind, adjusted / (TUNING * sigma_of(adjusted, p, y))), e, pressure, y)
        adjusted = r = y - model(c, e, pressure)
        passes += 1
        if np.all(np.abs(c - before) < 1e-6 * np.maximum(np.abs(c), np.abs(before))):
            break
    sigma = sigma_of(r, p, y)
    u = r / (TUNING * sigma)
    phi = lambda v: v * weight(kind, v)
    m1 = np.mean((phi(u + 1e-4) - phi(u - 1e-4)) / 2e-4)
    m2 = np.sum((1 - h) * phi(u) ** 2) / (n - p)
    factor = 1 + p / n * (1 - m1) / m1
    s_rob = factor * np.sqrt(m2) * sigma * TUNING / m1
    s = max(s_rob, np.sqrt((s_ols**2 * p**2 + s_rob**2 * n) / (p**2 + n)))
    sse = (n - p) * s**2
    r2 = 1 - sse / np.sum((y - y.mean()) ** 2)
    j = jacobian(c, e, pressure)
    error = s * np.sqrt(np.diag(np.linalg.inv(j.T @ j)))
    t = stats.t.ppf(0.975, n - p)
    found = {"s_ols": s_ols, "sigma": sigma, "s_rob": s_rob, "rmse": s, "sse": sse, "r2": r2}
    found["adjusted_r2"] = 1 - (1 - r2) * (n - 1) / (n - p)
    found["passes"] = passes
    for k in range(p):
        found[f"ordinary{k}"] = ordinary[k]
        found[f"c{k}"] = c[k]
        found[f"lower{k}"] = c[k] - t * error[k]
        found[f"upper{k}"] = c[k] + t * error[k]
    return found


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(20240607)
    e = np.round(random.uniform(0, 1, 257), 4)
    pressure = np.round(random.uniform(0, 1, 257), 4)
    y = np.round(model(TRUE, e, pressure) + 0.015 * random.standard_t(2.5, 257), 6)
    rows = [f"{a!r},{b!r},{c!r}" for a, b, c in zip(e.tolist(), pressure.tolist(), y.tolist())]
    head = "# Made by tests/scripts/lar.py: relative contraction, relative pressure, relative force.\n"
    (folder / "surface.csv").write_text(head + "\n".join(rows) + "\n")
    lines = ["# Made by tests/scripts/lar.py: weighting, statistic, value."]
    for kind in ("lar", "bisquare"):
        lines += [f"{kind},{name},{float(v)!r}" for name, v in statistics(kind, e, pressure, y).items()]
    (folder / "expected.csv").write_text("\n".join(lines) + "\n")


main()

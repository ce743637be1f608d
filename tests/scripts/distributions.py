"""Writes tests/data/distributions.csv: values of the distributions, by SciPy (1.17.1), to test src/numerics/distributions.rs.

Usage: python3 distributions.py > ../data/distributions.csv
"""

import math

from scipy import special, stats

X = [-37.0, -12.5, -6.0, -3.2, -1.0, -0.3, -1e-5, 0.0, 1e-3, 0.7, 1.96, 4.4, 8.0]
P = [1e-300, 1e-30, 1e-10, 1e-4, 0.01, 0.025, 0.2, 0.4999, 0.5, 0.55, 0.9, 0.975, 0.9999]
T = [-1e4, -40.0, -7.5, -2.0, -0.6, -1e-4, 0.0, 0.02, 1.0, 2.5, 12.0]
FREEDOM = [0.5, 1.0, 2.0, 3.0, 4.5, 10.0, 30.0, 254.0, 1e4, 1e6]
CHI = [1e-3, 0.1, 1.0, 3.84, 20.0, 150.0, 900.0]
F = [1e-3, 0.2, 1.0, 2.7, 9.0, 80.0]


def show(kind, value, *arguments):
    # Tails below the normal range of f64 are not tested.
    if value == 0.0 and kind.endswith(("tail", "cdf")):
        return
    print(",".join([kind, *(repr(float(a)) for a in (*arguments, value))]))


def main():
    print("# Made by tests/scripts/distributions.py with SciPy: kind, arguments, value.")
    for x in X:
        show("normal_cdf", special.ndtr(x), x)
    for p in P:
        show("normal_quantile", special.ndtri(p), p)
    for freedom in FREEDOM:
        for t in T:
            show("student_t_cdf", stats.t.cdf(t, freedom), t, freedom)
        for p in P:
            value = stats.t.ppf(p, freedom)
            if math.isfinite(value) and abs(value) < 1e100:
                show("student_t_quantile", value, p, freedom)
        for x in CHI:
            show("chi_square_upper_tail", stats.chi2.sf(x, freedom), x, freedom)
        for other in FREEDOM:
            for f in F:
                show("f_upper_tail", stats.f.sf(f, freedom, other), f, freedom, other)


main()

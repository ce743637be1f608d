"""Holds bpa_model.py to golden_vectors.csv, as arrays and point by point: prints the number of points and the largest difference, as a multiple of
what is allowed (1e-9 of the value, or 1e-9 in its unit)."""

import sys

import numpy as np

sys.path.insert(0, sys.argv[1])
from bpa_model import bpa_domain, bpa_force, bpa_force_gradient  # noqa: E402

table = np.genfromtxt(sys.argv[1] + "/golden_vectors.csv", delimiter=",", names=True)
arguments = [table[name] for name in table.dtype.names[:4]]


def worst(found, expected):
    both = np.isnan(found) & np.isnan(expected)
    share = np.abs(found - expected) / (1e-9 * np.maximum(1.0, np.abs(expected)))
    share = np.where(both, 0.0, np.where(np.isnan(share), np.inf, share))
    return share.max()


def answers(*state):
    return bpa_force(*state), *bpa_force_gradient(*state), bpa_domain(*state)


as_arrays = answers(*arguments)
one_by_one = [np.array(x) for x in zip(*(answers(*state) for state in zip(*arguments)))]
found = 0.0
for way in (as_arrays, one_by_one):
    for values, name in zip(way, table.dtype.names[4:]):
        found = max(found, worst(np.asarray(values, dtype=float), table[name]))
print(len(table), f"{found:.3g}")

"""A plain pandas and SciPy script that does a part of the main job, to compare times with: logs, plateaus, one fit, four plots, no PDF.

    time python3 tests/scripts/baseline_pandas.py ../shared/rig
"""

import pathlib
import sys
import tomllib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from scipy.optimize import curve_fit


def plateaus(log, width=0.02, rate=60.0):
    bins = (log.t // width).astype(int)
    medians = log.groupby(bins).median()
    moving = (medians.p.diff(2).abs() / (2 * width)).fillna(0) > rate
    runs = (moving != moving.shift()).cumsum()
    steady = medians[~moving]
    groups = steady.groupby(runs[~moving])
    last = groups.tail(12).groupby(runs[~moving])
    return last.mean()[groups.size() > 15]


rows = []
for path in sorted(pathlib.Path(sys.argv[1]).glob("isometric-*mm-20*/**/session.toml")):
    session = tomllib.loads(path.read_text())
    specimen, columns = session["specimen"], session["columns"]
    zero = 0.0
    for entry in session["log"]:
        log = pd.read_csv(path.parent / entry["file"], header=None).iloc[:, :3].set_axis(["f", "p", "t"], axis=1)
        for name, key in (("f", "force"), ("p", "pressure")):
            log[name] = log[name] * columns[key].get("gain", 1) + columns[key].get("offset", 0)
        if entry.get("role") == "zero":
            zero = log.f.median()
            continue
        found = plateaus(log)
        rest = specimen["rest_length_mm"]
        eps = (rest - session["setup"]["length_mm"]) / (rest - specimen["contracted_length_mm"])
        rows.append(found.assign(f=found.f - zero, eps=eps, rest=rest / 1000, d=specimen["diameter_mm"]))
rows = pd.concat(rows)
ten = rows[(rows.d == 10) & (rows.p < 800)]


def force(x, b1, b2, c0, c1, c2):
    rest, eps, p = x
    surface = c0 * (np.exp(-c1 * eps) - 1) + p / 620 * np.exp(-c2 * eps**2)
    return np.maximum(0, surface) * b1 * np.arctan(b2 * (rest - 0.0075))


fit, _ = curve_fit(force, (ten.rest, ten.eps, ten.p), ten.f, p0=[303.5, 19.03, 0.568, 4.25, 0.56])
predicted = force((ten.rest, ten.eps, ten.p), *fit)
print(len(rows), "plateaus;", fit, "RMSE", np.sqrt(np.mean((ten.f - predicted) ** 2)))
for k, (x, y) in enumerate([(ten.p, ten.f), (ten.eps, ten.f), (predicted, ten.f), (predicted, ten.f - predicted)]):
    plt.figure()
    plt.plot(x, y, ".")
    plt.savefig(f"/tmp/baseline-{k}.png", dpi=150)

"""Turns the published force maps of Martens and Boblan into two sessions of points below raw/.

The maps are facts printed in the appendix of A. Martens and I. Boblan, Actuators 6 (2017). Run from the root of the repository:

    python3 tests/scripts/martens_sessions.py

The free length at 620 kPa is not in the paper. It is where the straight line through the last two lengths that still pull at the
pressure next to 620 kPa meets zero force.
"""

import csv
import pathlib

MAPS = [
    ("dmsp-10-250", "src/mechanics/models/data/martens_a2_dmsp10_250.csv", 10, 250, "A2"),
    ("dmsp-20-300", "src/mechanics/models/data/martens_a1_dmsp20_300.csv", 20, 300, "A1"),
]

SESSION = """schema = "bpa-session/1"
id = "martens2017-{name}"
kind = "isometric"
sampling = "points"
campaign = "martens-boblan-2017"
date = "2017-11"
notes = "published force map, Table {table} of the appendix of Martens and Boblan, Actuators 6 (2017); l_620 is not in the paper: zero of the line through the last two lengths that pull at {pressure:g} kPa"

[specimen]
id = "martens-{name}"
diameter_mm = {diameter}
rest_length_mm = {rest}
contracted_length_mm = {contracted:.1f}

[columns]
length = {{ name = "length_m", unit = "m" }}
pressure = {{ name = "pressure_kpa", unit = "kPa" }}
force = {{ name = "force_n", unit = "N" }}

[[log]]
file = "points.csv"
"""


def free_length(rows):
    pressure = min({p for _, p, _ in rows}, key=lambda p: abs(p - 620))
    pulling = sorted((l, f) for l, p, f in rows if p == pressure and f > 0)
    (l1, f1), (l2, f2) = pulling[:2]
    return pressure, 1000 * (l1 - f1 * (l2 - l1) / (f2 - f1))


for name, source, diameter, rest, table in MAPS:
    with open(source, newline="") as file:
        rows = [tuple(map(float, r)) for r in csv.reader(file) if r and r[0][0].isdigit()]
    pressure, contracted = free_length(rows)
    folder = pathlib.Path("raw/martens-boblan-2017") / name
    folder.mkdir(parents=True, exist_ok=True)
    folder.joinpath("points.csv").write_text(pathlib.Path(source).read_text())
    folder.joinpath("session.toml").write_text(
        SESSION.format(name=name, table=table, diameter=diameter, rest=rest, contracted=contracted, pressure=pressure)
    )
    print(name, len(rows), "points, l_620", round(contracted, 1), "mm")

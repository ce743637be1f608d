"""Turns the load cell's readings of the biomimetic knee into sessions of torque below raw/.

    python3 tests/scripts/knee_load_cell_sessions.py

tests/data/knee_load_cell holds what the measurers of the knee paper's Figures 12 and 13 read, as their laboratory's files have it: the force in
the load cell, its direction in the tibia's frame, and where it pulls on the tibia as distance and direction from the linkage's joint theta1;
lengths and arms measured by hand. Torque about the knee is the moment of that force about the instantaneous centre, which moves in the tibia
with the knee angle (its knots are read from src/mechanics/knee/data/biomimetic.toml). What was not recorded is said in the notes of each session.

The file calls all loads newtons. Those of the extensor are taken as pounds-force: by lengths and arms that were measured by hand the law of the
knee paper gives 3.7 to 5.4 times the torque of newtons at eight of nine angles (median 4.2), and 0.94 times that of pounds-force; for the 20 mm flexor, of
which lengths and arms were measured as well, newtons agree (median 1.06).
"""

import csv
import math
import pathlib
import tomllib

from scipy.interpolate import CubicSpline

DATA = pathlib.Path("tests/data/knee_load_cell")
ASSUMED_KPA = 620  # P_max of the knee paper, where no pressure was recorded
POUND_FORCE_N = 4.4482216152605
IN_POUNDS = {"ExtBio10_52"}
CONTRACTION = 0.166  # free contraction of the 10 mm actuators, where l_620 was not recorded

# Test in loads.csv: session, specimen, mm, l_rest, l_620, tendon, measurements by hand.
SESSIONS = {
    "ExtBio10_52": ("extbio10-518", "bio10-l518", 10, 518, None, 0, "extensor_10mm_by_hand.csv"),
    "FlxBio10_42": ("flxbio10-415", "bio10-l415", 10, 415, None, 12, None),
    "FlxBio20_42_longtibia": ("flxbio20-423-long", "bio20-l423", 20, 423, 322, None, "flexor_20mm_by_hand.csv"),
    "FlxBio20_42_shorttibia": ("flxbio20-423-short", "bio20-l423", 20, 423, 322, None, "flexor_20mm_by_hand.csv"),
}

TOML = """schema = "bpa-session/1"
id = "{id}"
kind = "knee-torque"
sampling = "points"
campaign = "knee-load-cell"
notes = "{notes}"

[specimen]
id = "{specimen}"
diameter_mm = {diameter}
rest_length_mm = {rest}
contracted_length_mm = {contracted:g}

[joint]
knee = "biomimetic"
muscle = "{muscle}"
{tendon}
[columns]
angle = {{ name = "angle_deg", unit = "deg" }}
torque = {{ name = "torque_nm", unit = "N.m" }}
pressure = {{ name = "pressure_kpa", unit = "kPa" }}
{by_hand}
[[log]]
file = "points.csv"
"""
BY_HAND = """muscle_length = { name = "muscle_length_m", unit = "m" }
moment_arm = { name = "moment_arm_m", unit = "m" }
"""


def centre():
    """The instantaneous centre in the tibia's frame at theta1, by knee angle in rad."""
    joint = tomllib.loads(pathlib.Path("src/mechanics/knee/data/biomimetic.toml").read_text())["joint"]
    spline = lambda column: CubicSpline(joint["angle_rad"], joint[column], bc_type="not-a-knot")
    return spline("tibia_x_m"), spline("tibia_y_m")


def torque(reading, centre):
    """Size of the moment about the instantaneous centre, N.m."""
    angle = math.radians(float(reading["knee_angle_deg"]))
    distance = float(reading["reaction_point_dist_from_theta1_m"])
    direction = math.radians(float(reading["reaction_point_angle_deg"]))
    pull = math.radians(float(reading["load_cell_angle_deg"]))
    x = distance * math.cos(direction) - centre[0](angle)
    y = distance * math.sin(direction) - centre[1](angle)
    unit = POUND_FORCE_N if reading["test_id"] in IN_POUNDS else 1.0
    return abs(unit * float(reading["load_n"]) * (x * math.sin(pull) - y * math.cos(pull)))


def by_hand(file, reading):
    """Length and arm at the reading's angle and, where it was recorded, pressure; empty where there are none."""
    if file is None:
        return []
    with open(DATA / file, newline="") as lines:
        rows = list(csv.DictReader(lines))
    angle, pressure = float(reading["knee_angle_deg"]), reading["pressure_kpa"]
    # The laboratory's files tell equal angles apart by thousandths of a degree, and have 7.7 for 7.
    near = [r for r in rows if abs(float(r["angle_deg"]) - angle) < 0.8]
    same = [r for r in near if not pressure or float(r["pressure_kpa"]) == float(pressure)]
    best = min(same or near, key=lambda r: abs(float(r["angle_deg"]) - angle))
    return [best["muscle_length_m"], best["moment_arm_m"]]


def main():
    with open(DATA / "loads.csv", newline="") as lines:
        loads = list(csv.DictReader(lines))
    at = centre()
    for test, (name, specimen, diameter, rest, contracted, tendon, hand) in SESSIONS.items():
        readings = [r for r in loads if r["test_id"] == test]
        muscle = readings[0]["muscle_role"]
        said = ["torque from the load cell, by tests/scripts/knee_load_cell_sessions.py"]
        if test in IN_POUNDS:
            said.append("loads, called newtons, taken as pounds-force, with which alone length and arm by hand agree")
        if not readings[0]["pressure_kpa"]:
            said.append(f"pressure not recorded, P_max = {ASSUMED_KPA} kPa assumed")
        if contracted is None:
            contracted = round(rest * (1 - CONTRACTION))
            said.append("l_620 not recorded, 16.6 % of l_rest assumed")
        if tendon is None:
            said.append("tendon not recorded")
        folder = pathlib.Path("raw/knee-load-cell") / name
        folder.mkdir(parents=True, exist_ok=True)
        text = TOML.format(
            id="knee-load-cell-" + name,
            notes="; ".join(said),
            specimen=specimen,
            diameter=diameter,
            rest=rest,
            contracted=contracted,
            muscle=muscle,
            tendon="" if tendon is None else f"tendon_mm = {tendon}\n",
            by_hand=BY_HAND if hand else "",
        )
        folder.joinpath("session.toml").write_text(text)
        sign = -1 if muscle == "flexor" else 1
        load = "load_lbf" if test in IN_POUNDS else "load_n"
        header = f"angle_deg,{load},load_cell_angle_deg,torque_nm,pressure_kpa" + (",muscle_length_m,moment_arm_m" if hand else "")
        lines = [header]
        for r in readings:
            values = [
                f"{round(float(r['knee_angle_deg']), 1):g}",
                r["load_n"],
                r["load_cell_angle_deg"],
                f"{sign * torque(r, at):.4f}",
                r["pressure_kpa"] or str(ASSUMED_KPA),
            ]
            lines.append(",".join(values + by_hand(hand, r)))
        folder.joinpath("points.csv").write_text("\n".join(lines) + "\n")
        print(name, len(readings), "readings")


main()

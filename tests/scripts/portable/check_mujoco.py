"""Holds the MuJoCo callback to golden_vectors.csv, and runs the example: prints the number of points, the largest difference as a multiple of what is
allowed (1e-9 N or 1e-9 of the force), then the steps of the example, its smallest and largest force in N, and how far the muscle's force is from
the weight of the load at its end, as a share of it."""

import csv
import math
import sys

sys.path.insert(0, sys.argv[1])
import bpa_mujoco  # noqa: E402
import mujoco  # noqa: E402

model = mujoco.MjModel.from_xml_path(sys.argv[1] + "/bpa_example.xml")
data = mujoco.MjData(model)
model.actuator_ctrllimited[0] = 0
bpa_mujoco.install()
points, worst = 0, 0.0
with open(sys.argv[1] + "/golden_vectors.csv", newline="") as file:
    for row in csv.DictReader(file):
        rest, contracted, length, pressure, force = (float(row[name]) for name in list(row)[:5])
        # A tendon has a length, and a simulation holds no NaN.
        if math.isnan(force) or length <= 0.0 or math.isnan(length) or math.isnan(pressure):
            continue
        model.actuator_user[0][:2] = rest, contracted
        data.qpos[0] = -model.body("load").pos[2] - length
        data.ctrl[0] = pressure
        mujoco.mj_forward(model, data)
        assert abs(data.actuator_length[0] - length) < 1e-12
        worst = max(worst, abs(-data.actuator_force[0] - force) / (1e-9 * max(1.0, force)))
        points += 1
mujoco.set_mjcb_act_bias(None)

rows = bpa_mujoco.run()
forces = [row[3] for row in rows]
weight = model.body("load").mass[0] * 9.81
print(points, f"{worst:.3g}", len(rows), f"{min(forces):.6g} {max(forces):.6g} {abs(forces[-1] / weight - 1.0):.3g}")

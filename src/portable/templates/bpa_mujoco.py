@HEADER@
"""The muscle in MuJoCo: an actuator with biastype="user" whose control is the gauge pressure in kPa.

actuator_user holds the resting length and the free length at 620 kPa, in m; the length of the tendon is that of the muscle. MuJoCo counts a
force as positive where it lengthens the tendon, so the tension goes in with a minus sign. `python bpa_mujoco.py` runs bpa_example.xml.
"""

import pathlib

import mujoco

from bpa_model import PRESSURE_KPA, bpa_domain, bpa_force


def bias(model, data, actuator):
    """The force of an actuator, N: what mjcb_act_bias is to return."""
    rest_length_m, contracted_length_m = model.actuator_user[actuator][:2]
    length_m, pressure_kpa = data.actuator_length[actuator], data.ctrl[actuator]
    return -bpa_force(rest_length_m, contracted_length_m, length_m, pressure_kpa)


def install():
    """Makes every actuator with biastype="user" a muscle, for all models of this process."""
    mujoco.set_mjcb_act_bias(bias)


def run(seconds=2.0, fill_s=0.5):
    """Lifts the load of the example: pressure rises to the largest of the box within `fill_s`. One row a step: time, pressure, length, force, inside."""
    model = mujoco.MjModel.from_xml_path(str(pathlib.Path(__file__).with_name("bpa_example.xml")))
    data = mujoco.MjData(model)
    install()
    rows = []
    try:
        while data.time < seconds:
            data.ctrl[0] = PRESSURE_KPA[1] * min(data.time / fill_s, 1.0)
            mujoco.mj_step(model, data)
            # What the step has moved is seen by the force of the next one: here both are of one state.
            mujoco.mj_forward(model, data)
            state = (*model.actuator_user[0][:2], data.actuator_length[0], data.ctrl[0])
            rows.append((data.time, data.ctrl[0], data.actuator_length[0], -data.actuator_force[0], bpa_domain(*state)))
    finally:
        mujoco.set_mjcb_act_bias(None)
    return rows


if __name__ == "__main__":
    steps = run()
    print("time_s,pressure_kpa,length_m,force_n,inside")
    for time_s, pressure_kpa, length_m, force_n, inside in steps[:: max(1, len(steps) // 20)] + steps[-1:]:
        print(f"{time_s:.3f},{pressure_kpa:.1f},{length_m:.5f},{force_n:.3f},{int(inside)}")

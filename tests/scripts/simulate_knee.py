"""Writes raw/simulated-knee: a campaign of torque that no rig has seen, in the form of the real ones.

    python3 tests/scripts/simulate_knee.py raw/simulated-knee

Apart from the program: own kinematics (the linkage is solved by bisection of its angle, torque by a difference of the work), and a frame that
yields as no operator of the program does, by 6 mm (1 - exp(-F/150 N)). Fittings are 33 mm long, forces are those of the force paper's
law times a strength of each actuator. What is measured by hand is rounded and scattered as tape measures are.
"""

import math
import random
import sys
from pathlib import Path

FITTING = 0.033  # m, one end
YIELD, YIELD_FORCE = 0.006, 150.0  # m, N
LAWS = {  # b1 N, b2 1/m, l_0 m, c0, c1, c2
    10: (303.5, 19.03, 0.0075, 0.5682, 4.254, 0.5597),
    20: (922.4, 15.37, 0.013, 0.2579, 6.477, 1.321),
}
PIN = (0.0045, -0.3958)
# Four-bar linkage: pins of the femur, pins of the tibia, links.
FEMUR_PINS = ((0.027891, -0.410941), (0.010199, -0.395676))
TIBIA_PINS = ((0.0, 0.0), (0.03979, 0.000992))
LINKS = (0.046751, 0.051683)

OWN_LEG = """# A laboratory's own leg: the description of the program's manual, src/mechanics/knee/description/mod.rs. Simulated.
[joint]
kind = "pinned"
range_deg = [-110, 10]
centre_m = [0.0, -0.41]

[[route]]
name = "flexor"
point = [
  { femur_m = [-0.06, 0.09, 0.02] },
  { femur_m = [-0.055, -0.36, 0.02], from_deg = -15 },
  { tibia_m = [-0.045, -0.05, 0.02] },
]
"""


def force(diameter, rest, contracted, length, pressure, strength):
    b1, b2, l0, c0, c1, c2 = LAWS[diameter]
    e = (rest - length) / (rest - contracted)
    star = c0 * (math.exp(-c1 * e) - 1.0) + pressure / 620.0 * math.exp(-c2 * e * e)
    return strength * max(0.0, star) * b1 * math.atan(b2 * (rest - l0))


def turn(point, angle):
    x, y, z = point
    c, s = math.cos(angle), math.sin(angle)
    return (c * x - s * y, s * x + c * y, z)


def pinned(centre):
    def place(point, angle):
        x, y, z = turn(point, angle)
        return (centre[0] + x, centre[1] + y, z)

    return place


def linkage(point, angle):
    """The tibia's origin goes around the first femoral pin; where on that circle, the second link decides."""
    (ax, ay), (bx, by) = FEMUR_PINS
    cx, cy, _ = turn((*TIBIA_PINS[0], 0.0), angle)
    dx, dy, _ = turn((*TIBIA_PINS[1], 0.0), angle)

    def origin(phi):
        return (ax + LINKS[0] * math.cos(phi) - cx, ay + LINKS[0] * math.sin(phi) - cy)

    def miss(phi):
        x, y = origin(phi)
        return math.hypot(x + dx - bx, y + dy - by) - LINKS[1]

    # The branch through the straight leg: the origin lies behind and below the pin.
    start = math.atan2(-0.4428 - ay, -0.0063 - ax)
    best = None
    grid = sorted(start - 1.6 + 3.2 * k / 400 for k in range(401))
    for low, high in zip(grid, grid[1:]):
        if miss(low) * miss(high) <= 0.0:
            a, b = low, high
            for _ in range(80):
                m = 0.5 * (a + b)
                if miss(a) * miss(m) <= 0.0:
                    b = m
                else:
                    a = m
            if best is None or abs(a - start) < abs(best - start):
                best = a
    ox, oy = origin(best)
    x, y, z = turn(point, angle)
    return (ox + x, oy + y, z)


ROUTES = {
    "pinned flexor": (
        pinned(PIN),
        [("femur", (-0.075, 0.1, 0.0328)), ("tibia", (-0.05011, -0.045, 0.0326))],
    ),
    "pinned extensor": (
        pinned(PIN),
        [
            ("femur", (0.03, -0.05, 0.0)),
            ("femur", (0.065, -0.35, 0.0), None, 27),
            ("femur", (0.04244, -0.40847, 0.0), None, -23),
            ("femur", (0.02818, -0.42157, 0.0), None, -53),
            ("tibia", (0.0425, -0.07591, 0.0)),
        ],
    ),
    "biomimetic flexor 10": (
        linkage,
        [("femur", (-0.05, 0.035, 0.0328)), ("tibia", (-0.01146, 0.00113, 0.027))],
    ),
    "biomimetic flexor 20": (
        linkage,
        [("femur", (-0.05, 0.035, 0.05)), ("tibia", (-0.01224, -0.00887, 0.02787))],
    ),
    "biomimetic extensor 10": (
        linkage,
        [
            ("femur", (0.04, 0.035, 0.0)),
            ("femur", (0.0759, -0.27476, 0.0)),
            ("femur", (0.05982, -0.37427, 0.0), None, -9.19),
            ("femur", (0.03955, -0.42183, 0.0), None, -69.8),
            ("tibia", (0.05871, 0.025, 0.0)),
            ("tibia", (0.05871, 0.01228, 0.0)),
            ("tibia", (0.054, -0.00612, 0.0)),
            ("tibia", (0.03604, -0.02844, 0.0)),
        ],
    ),
    "own flexor": (
        pinned((0.0, -0.41)),
        [
            ("femur", (-0.06, 0.09, 0.02)),
            ("femur", (-0.055, -0.36, 0.02), -15, None),
            ("tibia", (-0.045, -0.05, 0.02)),
        ],
    ),
}


def path(route, degrees):
    place, points = ROUTES[route]
    angle = math.radians(degrees)
    at = []
    for body, point, *limits in points:
        first, below = limits or (None, None)
        if (first is None or degrees >= first) and (below is None or degrees < below):
            at.append(point if body == "femur" else place(point, angle))
    return sum(math.dist(a, b) for a, b in zip(at, at[1:]))


def arm(route, degrees):
    step = 0.02
    rise = path(route, degrees + step) - path(route, degrees - step)
    return -rise / math.radians(2 * step)


def balance(route, degrees, a, pressure):
    """Length and force of the actuator: the frame gives way until both sides pull alike."""

    def at(f):
        given = YIELD * (1.0 - math.exp(-f / YIELD_FORCE))
        length = path(route, degrees) - 2 * FITTING - a["tendon"] - given
        return length, force(a["d"], a["true_rest"], a["l620"], length, pressure, a["strength"])

    low, high = 0.0, 5000.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        if at(middle)[1] > middle:
            low = middle
        else:
            high = middle
    return at(low)


def actuator(d, rest, l620, strength, tendon=0.0, true_rest=None):
    true = (true_rest or rest) / 1000
    return dict(
        d=d, rest=rest, l620_mm=l620, l620=l620 / 1000, strength=strength, tendon=tendon / 1000, true_rest=true
    )


SESSIONS = [
    # folder, route, specimen, actuator, angles from, to, count, pressures, joint, extra lines
    ("flxpin10-485-t1", "pinned flexor", "skn10-l485", actuator(10, 485, 398, 1.01), -66, 10, 15, [606], {}),
    ("flxpin10-485-t2", "pinned flexor", "skn10-l485", actuator(10, 485, 398, 1.01), -70, 4, 13, [606], {}),
    ("flxpin10-485-t3", "pinned flexor", "skn10-l485", actuator(10, 485, 398, 1.01), -60, -6, 11, [612], {}),
    (
        "flxpin10-485-t4",
        "pinned flexor",
        "skn10-l485",
        actuator(10, 485, 398, 1.01, true_rest=472),
        -68,
        -20,
        9,
        [612],
        {"exclude": "resting length uncertain"},
    ),
    ("flxpin10-457-t1", "pinned flexor", "skn10-l457", actuator(10, 457, 380, 0.98), -98, -28, 13, [605], {}),
    ("extpin10-457-t1", "pinned extensor", "skn10-l457", actuator(10, 457, 380, 0.98), -84, 20, 14, [604], {}),
    ("flxbio10-415ten", "biomimetic flexor 10", "skn10-l415", actuator(10, 415, 349, 1.0, 12), -80, -4, 11, [604], {}),
    ("extbio10-518", "biomimetic extensor 10", "skn10-l518", actuator(10, 518, 432, 1.02), -118, -4, 12, [610], {}),
    ("flxbio20-423", "biomimetic flexor 20", "skn20-l423", actuator(20, 423, 322, 0.99), -110, -6, 18, [275, 485, 615], {}),
    ("flxown10-485", "own flexor", "skn10-l485", actuator(10, 485, 398, 1.01), -64, 6, 10, [606], {}),
]


def half(x):
    return f"{round(2 * x) / 2:g}"


def points(number, session):
    _, route, _, a, first, last, count, pressures, _ = session
    dice = random.Random(1000 + number)
    lines = ["angle_deg,torque_nm,muscle_length_mm,moment_arm_mm,pressure_kpa"]
    for k in range(count):
        # There and back, as people do it.
        share = k / (count - 1)
        degrees = round(2 * (first + (last - first) * share + dice.gauss(0, 1.0))) / 2
        degrees = min(max(degrees, min(first, last)), max(first, last))
        # The more flexed, the less is left to pull: high pressures belong there.
        pressure = pressures[::-1][min(int(share * len(pressures)), len(pressures) - 1)] + dice.gauss(0, 0.8)
        length, f = balance(route, degrees, a, pressure)
        torque = f * arm(route, degrees + dice.gauss(0, 0.4)) + dice.gauss(0, 0.15)
        by_hand = (1000 * length + dice.gauss(0, 2.5), abs(1000 * arm(route, degrees)) + dice.gauss(0, 2.5))
        lines.append(f"{degrees:g},{torque:.4f},{half(by_hand[0])},{half(by_hand[1])},{pressure:.1f}")
    return "\n".join(lines) + "\n"


def text(session):
    folder, route, specimen, a, *_, extra = session
    knee, muscle = route.split()[:2]
    lines = [
        'schema = "bpa-session/1"',
        f'id = "sim-{folder}"',
        'kind = "knee-torque"',
        'sampling = "points"',
        'campaign = "simulated-knee"',
        'notes = "simulated by tests/scripts/simulate_knee.py"',
    ]
    lines += [f'{key} = "{value}"' for key, value in extra.items()]
    lines += [
        "",
        "[specimen]",
        f'id = "{specimen}"',
        f"diameter_mm = {a['d']}",
        f"rest_length_mm = {a['rest']}",
        f"contracted_length_mm = {a['l620_mm']}",
        "",
        "[joint]",
    ]
    if knee == "own":
        lines += ['knee = "described"', 'file = "leg.toml"']
    else:
        lines.append(f'knee = "{knee}"')
    lines += [f'muscle = "{muscle}"', f"tendon_mm = {1000 * a['tendon']:g}", "", "[columns]"]
    units = dict(angle="deg", torque="N.m", muscle_length="mm", moment_arm="mm", pressure="kPa")
    ends = dict(angle="deg", torque="nm", muscle_length="mm", moment_arm="mm", pressure="kpa")
    lines += [f'{q} = {{ name = "{q}_{ends[q]}", unit = "{unit}" }}' for q, unit in units.items()]
    lines += ["", "[[log]]", 'file = "points.csv"']
    return "\n".join(lines) + "\n"


def main():
    out = Path(sys.argv[1])
    for number, session in enumerate(SESSIONS):
        folder = out / session[0]
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "session.toml").write_text(text(session), newline="\n")
        (folder / "points.csv").write_text(points(number, session), newline="\n")
        if session[1].startswith("own"):
            (folder / "leg.toml").write_text(OWN_LEG, newline="\n")


if __name__ == "__main__":
    main()

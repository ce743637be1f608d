"""Fits L0, D0 and H0 of Martens and Boblan's model to the authors' own measured maps, for both readings of delta.

The paper prints theta0 = 28.6 deg + delta with delta = -0.1 (10 mm) and -0.073 (20 mm) and no usable unit. This script shows that
radians reproduce the claimed accuracy with the nominal geometry and degrees do not, and prints the geometries that
src/mechanics/models/martens_geometry.rs and src/mechanics/models/martens2017.rs carry. Run from the root of the crate: python3 tests/scripts/fit_martens_geometry.py
Needs numpy and scipy. A miss is the largest |model - map| over the map's largest force, with negative forces set to zero.
"""

import numpy as np
from scipy.optimize import least_squares

ACTUATORS = {
    10: dict(file="martens_a2_dmsp10_250.csv", c=(74.085e6, -689.20e6, 1.837e9, -848.79e6), delta=-0.1, rest=0.250),
    20: dict(file="martens_a1_dmsp20_300.csv", c=(93.232e6, -715.29e6, 1.5483e9, -502.95e6), delta=-0.073, rest=0.300),
}


def force(c, theta, geometry, length, pressure_pa):
    rest, diameter0, wall = geometry
    thread = rest / np.cos(theta)
    turns = rest * np.tan(theta) / (np.pi * diameter0)
    root = np.sqrt(thread**2 - length**2)
    diameter = root / (turns * np.pi)
    diameter_slope = -length / (turns * np.pi * root)
    volume_slope = (thread**2 - 3 * length**2) / (4 * np.pi * turns**2)
    modulus = c[0] + c[1] * length + c[2] * length**2 + c[3] * length**3
    axial = modulus * (length - rest) / rest * wall * np.pi * diameter
    hoop = modulus * (diameter - diameter0) / diameter0 * wall * length * np.pi
    return np.maximum(-pressure_pa * volume_slope + hoop * diameter_slope - axial, 0.0)


def main():
    for diameter, actuator in ACTUATORS.items():
        length, pressure, measured = np.loadtxt("src/mechanics/models/data/" + actuator["file"], delimiter=",", skiprows=1).T
        largest = measured.max()
        readings = {
            "degrees": np.radians(28.6 + actuator["delta"]),
            "radians": np.radians(28.6) + actuator["delta"],
        }
        for unit, theta in readings.items():
            def residual(geometry):
                return (force(actuator["c"], theta, geometry, length, pressure * 1e3) - measured) / largest

            def show(name, geometry, rows=slice(None)):
                r = residual(geometry)[rows]
                sizes = ", ".join(f"{1e3 * x:.2f}" for x in geometry)
                print(f"{diameter} mm, delta in {unit}, {name}: L0, D0, H0 = {sizes} mm; miss {abs(r).max():.4f}, RMS {np.sqrt((r * r).mean()):.4f}")

            wall = 0.002 if unit == "degrees" else 0.0018
            nominal = np.array([actuator["rest"], diameter * 1e-3, wall])
            show("nominal", nominal)
            show("nominal, without the lowest pressure", nominal, pressure > pressure.min())
            alone = least_squares(lambda x: residual(nominal * np.array([1, 1, x[0]])), [1], xtol=1e-14, ftol=1e-14)
            show("H0 alone fitted", nominal * np.array([1, 1, alone.x[0]]))
            # The scaled variables start at the nominal sizes, in two steps: D0 and H0 first, for L0 hardly moves.
            first = least_squares(lambda x: residual(nominal * np.array([1, *x])), [1.2, 1.2], xtol=1e-14, ftol=1e-14)
            fit = least_squares(lambda x: residual(nominal * x), [1, *first.x], xtol=1e-14, ftol=1e-14)
            show("fitted", nominal * fit.x)
            show("fitted, rounded to 0.01 mm", np.round(nominal * fit.x, 5))


if __name__ == "__main__":
    main()

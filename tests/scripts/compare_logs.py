#!/usr/bin/env python3
"""Draws logs of a real and of a simulated session under each other, so that a person can judge whether they differ.

    python3 scripts/compare_logs.py PICTURE SESSION/LOG [SESSION/LOG ...]

Each row of the picture is one log: all of it, the first steps, three filling steps, the first venting steps, the end, and the share of
each sampling interval. Needs numpy and matplotlib.
"""

import sys
import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np


def read_log(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time in s, pressure in kPa and force in N, as the session's `session.toml` declares the columns."""
    session = tomllib.loads((path.parent / "session.toml").read_text())
    raw = np.genfromtxt(path, delimiter=",")

    def column(name: str) -> np.ndarray:
        spec = session["columns"][name]
        return raw[:, spec["index"]] * spec.get("gain", 1.0) + spec.get("offset", 0.0)

    return column("time"), column("pressure"), column("force")


def venting_start(time: np.ndarray, pressure: np.ndarray) -> float:
    """The step in which the pressure falls most, s."""
    levels = [np.median(pressure[(time >= t + 0.3) & (time < t + 0.5)]) for t in np.arange(0, time[-1] - 0.5, 0.5)]
    return 0.5 * (int(np.argmin(np.diff(levels))) + 1)


def draw(axes, time, pressure, force, start, end, style):
    """Pressure (blue, left) and force (red, right) from `start` to `end`, s."""
    inside = (time >= start) & (time < end)
    axes.plot(time[inside], pressure[inside], style, lw=0.5, ms=2)
    right = axes.twinx()
    right.plot(time[inside], force[inside], style, lw=0.5, ms=2, color="red")


def main() -> None:
    """Draws the logs named on the command line."""
    picture, *logs = sys.argv[1:]
    figure, grid = plt.subplots(len(logs), 6, figsize=(36, 5 * len(logs)), squeeze=False)
    for axes, name in zip(grid, logs):
        time, pressure, force = read_log(Path(name))
        vent = venting_start(time, pressure)
        draw(axes[0], time, pressure, force, 0, time[-1], "-")
        draw(axes[1], time, pressure, force, 0, 0.65, ".-")
        draw(axes[2], time, pressure, force, 1.95, 3.4, ".-")
        draw(axes[3], time, pressure, force, vent - 0.1, vent + 1.2, ".-")
        draw(axes[4], time, pressure, force, time[-1] - 1, time[-1], ".-")
        intervals = np.round(1000 * np.diff(time))
        axes[5].bar(range(6), [np.mean(intervals == k) for k in range(6)])
        axes[5].set_xlabel("sampling interval (ms)")
        axes[0].set_title(name)
    figure.tight_layout()
    figure.savefig(picture, dpi=50)


if __name__ == "__main__":
    main()

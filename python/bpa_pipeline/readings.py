"""Data frames into sessions of the raw format (docs/sessions.md, sampling "points")."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, Mapping

import numpy as np
import pandas as pd

from .errors import ReadingsError

LENGTHS = ("rest_length", "contracted_length", "length")
# No actuator is so long: 1 m read as 1000 m, or 100 cm.
LONGEST_M = 10.0
PHASES = ("pressurizing", "depressurizing")
# Columns of derived/rows.parquet that a run makes itself.
MADE_BY_A_RUN = {
    "campaign", "kind", "role", "log", "simulated", "row", "last_row", "n_samples", "sd_force_n", "zero_force_n",
    "zero_pressure_kpa", "rest_length_sd_m", "contracted_length_sd_m", "length_sd_m", "muscle_length_sd_m", "moment_arm_sd_m",
    "contraction", "contraction_rel", "pressure_rel",
}  # fmt: skip
TAKEN = {"specimen", "session", "date", "phase", "run", "diameter_mm", "pressure_kpa", "force_n", "time_s", "temperature_c"}


def renamed(frame: pd.DataFrame, columns: Mapping[str, str] | None) -> pd.DataFrame:
    """The frame with columns by the names of the bridge: `columns` maps own names to them."""
    if not isinstance(frame, pd.DataFrame):
        raise ReadingsError(f"a pandas DataFrame is expected, with a reading a row; found {type(frame).__name__}: pandas.DataFrame(...) makes one")
    missing = [name for name in columns or {} if name not in frame]
    if missing:
        raise ReadingsError(f"columns= names {', '.join(missing)}, which the frame does not have: it has {', '.join(map(str, frame))}")
    frame = frame.rename(columns=dict(columns or {}))
    twice = sorted(set(frame.columns[frame.columns.duplicated()]))
    if twice:
        raise ReadingsError(f"two columns are called {', '.join(map(str, twice))}")
    return frame


def _other_unit(frame: pd.DataFrame, quantity: str) -> str:
    others = [str(name) for name in frame if re.fullmatch(rf"{quantity}(_[a-z]+)?", str(name), re.IGNORECASE)]
    return f"; {', '.join(others)} is not in that unit: convert it" if others else ""


def numbers(frame: pd.DataFrame, quantity: str, unit: str) -> pd.Series:
    """A column of numbers by its name with its unit. Raises `ReadingsError` where it is not there or has words."""
    name = f"{quantity}_{unit}"
    if name not in frame:
        raise ReadingsError(f"there is no column {name}{_other_unit(frame, quantity)}")
    try:
        return pd.to_numeric(frame[name]).astype(float)
    except (ValueError, TypeError) as error:
        raise ReadingsError(f"column {name} has cells that are no numbers: {error}") from error


def metres(frame: pd.DataFrame, quantity: str) -> pd.Series:
    """A length in m, from the column in m or in mm."""
    both = [f"{quantity}_{unit}" for unit in ("m", "mm") if f"{quantity}_{unit}" in frame]
    if len(both) == 2:
        raise ReadingsError(f"there are both {both[0]} and {both[1]}: keep one")
    if not both:
        raise ReadingsError(f"there is no column {quantity}_m or {quantity}_mm{_other_unit(frame, quantity)}")
    lengths = numbers(frame, quantity, "m") if both[0].endswith("_m") else numbers(frame, quantity, "mm") / 1000
    if lengths.max() > LONGEST_M:
        raise ReadingsError(f"column {both[0]} reaches {frame[both[0]].max():g}: that is longer than any actuator, so the unit is probably another one")
    return lengths


def states(frame: pd.DataFrame, columns: Mapping[str, str] | None = None) -> pd.DataFrame:
    """Three lengths in m and the pressure in kPa, with the index of the frame."""
    frame = renamed(frame, columns)
    found = {f"{quantity}_m": metres(frame, quantity) for quantity in LENGTHS}
    return pd.DataFrame({**found, "pressure_kpa": numbers(frame, "pressure", "kpa")}, index=frame.index)


def _toml(value: Any) -> str:
    """A value as TOML: strings of JSON are basic strings of TOML."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return json.dumps(str(value), ensure_ascii=False)


def configuration(options: Mapping[str, Mapping[str, Any]] | None) -> str:
    """`pipeline.toml` with the options given: `{"fit": {"loss": "huber"}}`."""
    lines = ['[paths]', 'raw = ["raw"]', 'derived = "derived"', 'reports = "reports"']
    for table, values in (options or {}).items():
        if table == "paths" or not isinstance(values, Mapping):
            raise ReadingsError('options= has tables of pipeline.toml other than paths, as in {"fit": {"loss": "huber"}}')
        lines += ["", f"[{table}]", *(f"{key} = {_toml(value)}" for key, value in values.items())]
    return "\n".join(lines) + "\n"


def _one(rows: pd.DataFrame, column: str, what: str) -> Any:
    values = rows[column].unique()
    if len(values) > 1:
        raise ReadingsError(f"{what} has {len(values)} values of {column}: {', '.join(map(str, values[:4]))}")
    return values[0]


def _millimetres(length_m: float) -> float:
    return round(float(length_m) * 1000, 9)


def tidy(frame: pd.DataFrame, columns: Mapping[str, str] | None, diameter_mm: int | None) -> tuple[pd.DataFrame, list[str]]:
    """The readings with columns of one name and unit each, without rows that lack a number; and what was left out, in words.

    Columns of the frame beyond those that the bridge knows are under their own names.
    """
    frame = renamed(frame, columns).reset_index(drop=True)
    frame.columns = frame.columns.map(str)
    if "specimen" not in frame:
        raise ReadingsError("there is no column specimen: which muscle a reading is of")
    if diameter_mm is None and "diameter_mm" not in frame:
        raise ReadingsError("there is no column diameter_mm: add it, or give diameter_mm=10")
    rows = states(frame)
    rows["force_n"] = numbers(frame, "force", "n")
    rows["diameter_mm"] = numbers(frame, "diameter", "mm") if "diameter_mm" in frame else float(diameter_mm or 0)
    for name in ("time_s", "temperature_c"):
        if name in frame:
            rows[name] = numbers(frame, *name.rsplit("_", 1))
    needed = [name for name in rows if name not in ("time_s", "temperature_c")]
    usable = np.isfinite(rows[needed]).all(axis=1) & frame["specimen"].notna()
    messages = []
    if "excluded" in frame:
        excluded = frame["excluded"].fillna(0).astype(bool)
        usable &= ~excluded
        if excluded.any():
            messages.append(f"{int(excluded.sum())} of {len(rows)} rows left out: excluded")
    for name in needed:
        lacking = int((~np.isfinite(rows[name])).sum())
        if lacking:
            messages.append(f"{lacking} of {len(rows)} rows left out: {name} is no finite number")
    if frame["specimen"].isna().any():
        messages.append(f"{int(frame['specimen'].isna().sum())} of {len(rows)} rows left out: no specimen")

    pressure, force = rows.loc[usable, "pressure_kpa"], rows.loc[usable, "force_n"]
    if len(pressure) and not 20 <= pressure.max() <= 1500:
        messages.append(f"pressure_kpa reaches {pressure.max():g}: kPa of gauge pressure are expected, and bar, psi, Pa or MPa look like this")
    if len(force) and (force < 0).mean() > 0.5:
        messages.append("most forces are negative: tension is positive")

    rows["specimen"] = frame["specimen"].astype(str)
    if "date" in frame:
        dates = frame["date"]
        rows["date"] = dates.dt.strftime("%Y-%m-%d") if pd.api.types.is_datetime64_any_dtype(dates) else dates
        rows["date"] = rows["date"].astype(object).where(rows["date"].notna(), None)
    if "session" in frame:
        if frame.loc[usable, "session"].isna().any():
            raise ReadingsError("column session has empty cells")
        rows["session"] = frame["session"].astype(str)
    elif "date" in frame:
        rows["session"] = rows["specimen"] + ["" if date is None else f"-{date}" for date in rows["date"]]
    else:
        rows["session"] = rows["specimen"]
    if "phase" in frame:
        wrong = sorted(set(map(str, frame.loc[usable, "phase"].dropna().unique())) - set(PHASES))
        if wrong:
            raise ReadingsError(f"column phase has {', '.join(wrong[:4])}; it may have {' and '.join(PHASES)}")
        rows["phase"] = frame["phase"]
    if "run" in frame:
        rows["run"] = frame["run"]

    known = TAKEN | {"excluded"} | {f"{quantity}_{unit}" for quantity in LENGTHS for unit in ("m", "mm")}
    made = [name for name in frame if name in MADE_BY_A_RUN or re.fullmatch(r"predicted_.*_n", name)]
    if made:
        messages.append(f"columns that a run makes itself were not taken over: {', '.join(made)}")
    for name in frame:
        if name not in known and name not in made:
            rows[name] = frame[name]
    rows = rows[usable].reset_index(drop=True)
    if rows.empty:
        raise ReadingsError("; ".join(["there is no row with all numbers", *messages]))
    for specimen, part in rows.groupby("specimen", sort=False):
        for column in ("rest_length_m", "contracted_length_m", "diameter_mm"):
            _one(part, column, f"specimen {specimen}")
    return rows, messages


def write_sessions(rows: pd.DataFrame, campaign: str, raw: Path) -> None:
    """One folder a session below `raw`, with one log a run."""
    fixed = {"rest_length_m", "contracted_length_m", "diameter_mm", "specimen", "session", "date", "run"}
    for number, (session, part) in enumerate(rows.groupby("session", sort=False)):
        what = f"session {session}"
        specimen = _one(part, "specimen", what)
        date = _one(part, "date", what) if "date" in part else None
        folder = raw / f"{number:04d}-{re.sub('[^A-Za-z0-9_-]+', '-', str(session))[:60]}"
        folder.mkdir(parents=True)
        head = ['schema = "bpa-session/1"', f"id = {_toml(session)}", 'kind = "isometric"', 'sampling = "points"', f"campaign = {_toml(campaign)}"]
        if date is not None:
            head.append(f"date = {_toml(date)}")
        first = part.iloc[0]
        head += [
            "",
            "[specimen]",
            f"id = {_toml(specimen)}",
            f"diameter_mm = {first['diameter_mm']:g}",
            f"rest_length_mm = {_toml(_millimetres(first['rest_length_m']))}",
            f"contracted_length_mm = {_toml(_millimetres(first['contracted_length_m']))}",
            "",
            "[columns]",
            'length = { name = "length_m", unit = "m" }',
            'pressure = { name = "pressure_kpa", unit = "kPa" }',
            'force = { name = "force_n", unit = "N" }',
        ]
        written = ["length_m", "pressure_kpa", "force_n"]
        for name in part:
            if name in fixed or name in written or part[name].isna().all():
                continue
            quoted = _toml(name)
            if name == "phase":
                values = ", ".join(f"{_toml(value)} = {_toml(value)}" for value in PHASES)
                head.append(f'phase = {{ name = "phase", values = {{ {values} }} }}')
            elif name == "time_s":
                head.append('time = { name = "time_s", unit = "s" }')
            elif name == "temperature_c":
                head.append('temperature = { name = "temperature_c", unit = "C" }')
            elif pd.api.types.is_numeric_dtype(part[name]):
                head.append(f"{quoted} = {{ name = {quoted} }}")
            else:
                head.append(f"{quoted} = {{ name = {quoted}, text = true }}")
            written.append(name)
        runs = part.groupby("run", sort=False, dropna=False) if "run" in part else [(None, part)]
        for k, (run, log) in enumerate(runs, start=1):
            head += ["", "[[log]]", f'file = "points{k}.csv"']
            if run is not None and pd.notna(run) and float(run).is_integer():
                head.append(f"run = {int(run)}")
            log[written].to_csv(folder / f"points{k}.csv", index=False)
        (folder / "session.toml").write_text("\n".join(head) + "\n", encoding="utf-8")

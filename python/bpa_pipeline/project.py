"""A project on disk: its run, and what the commands say of it."""

from __future__ import annotations

import importlib.util
import json
import os
import tempfile
import warnings
from pathlib import Path
from types import ModuleType
from typing import Any, Mapping, Sequence

import pandas as pd

from .errors import PipelineError, PipelineWarning, ReadingsError
from .findings import Findings
from .program import call, call_json, find_program
from .readings import states

MOST_INTERVALS = 500


def load_model(folder: Path) -> ModuleType:
    """The module `bpa_model` of a folder that `pipeline export model` wrote."""
    spec = importlib.util.spec_from_file_location("bpa_model", folder / "bpa_model.py")
    if spec is None or spec.loader is None:
        raise PipelineError(f"{folder} has no bpa_model.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def exported(program: Path, arguments: list[str], folder: Path) -> ModuleType:
    """The model that `pipeline export model` makes with these arguments in a project."""
    with tempfile.TemporaryDirectory() as out:
        call_json(program, ["export", "model", *arguments, "--out", out, "--replace"], folder)
        return load_model(Path(out))


def evaluated(model: ModuleType, at: pd.DataFrame) -> pd.DataFrame:
    """`force_n` and `inside` of states, by an exported model."""
    arguments = [at[name].to_numpy() for name in ("rest_length_m", "contracted_length_m", "length_m", "pressure_kpa")]
    return pd.DataFrame({"force_n": model.bpa_force(*arguments), "inside": model.bpa_domain(*arguments).astype(bool)}, index=at.index)


class Project:
    """A folder with `pipeline.toml`, or with `raw`, `derived` and `reports`. `messages` are those of the last `run`."""

    def __init__(self, path: str | os.PathLike[str], program: str | os.PathLike[str] | None = None) -> None:
        self.path = Path(path).resolve()
        if not self.path.is_dir():
            raise PipelineError(f"{self.path} is no folder")
        self.program = find_program(program)
        self.messages: list[str] = []

    def _json(self, *arguments: str, accept: tuple[int, ...] = (0,)) -> Any:
        return call_json(self.program, arguments, self.path, accept)[0]

    def note(self, messages: list[str]) -> None:
        """Keeps messages, and warns of them."""
        self.messages += messages
        for message in messages:
            warnings.warn(message, PipelineWarning, stacklevel=3)

    def run(self) -> dict[str, Any]:
        """`pipeline run --json`. What was left out is in `messages`, and warned of."""
        outcome, said = call_json(self.program, ["run"], self.path, accept=(0, 5))
        self.messages = []
        self.note([line for line in said.splitlines() if line.strip()])
        for kind in ("rejected_sessions", "rejected_logs", "failed", "left_out"):
            if outcome.get(kind):
                self.note([f"{kind}: {json.dumps(outcome[kind], ensure_ascii=False)}"])
        return outcome

    def summary(self) -> dict[str, Any]:
        """`pipeline summary --json`: what the last run found."""
        return self._json("summary")

    def _findings(self) -> list[dict[str, Any]]:
        path = self.path / self._paths()["reports"] / "findings.json"
        if not path.is_file():
            raise PipelineError(f"{path} is not there: run the project first")
        return json.loads(path.read_text(encoding="utf-8"))["campaigns"]

    def findings(self, campaign: str, diameter_mm: int | None = None) -> Findings:
        """The findings of one campaign; of one with several diameters, or parts, say which diameter."""
        entries = self._findings()
        found = [e for e in entries if e["campaign"] == campaign and diameter_mm in (None, e["diameter_mm"])]
        if len(found) != 1:
            there = ", ".join(f"{e['campaign']} ({e['diameter_mm']} mm)" for e in entries)
            raise PipelineError(f"{len(found)} findings of a campaign {campaign}; there are {there or 'none'}")
        text = call(self.program, ["summary", campaign], self.path)[0]
        return Findings(found[0], text, list(self.messages))

    def _paths(self) -> dict[str, str]:
        """Where results are: `[paths]` of pipeline.toml where Python can read TOML (3.11), else the defaults."""
        paths = {"derived": "derived", "reports": "reports"}
        config = self.path / "pipeline.toml"
        if config.is_file():
            try:
                import tomllib
            except ImportError:
                return paths
            own = tomllib.loads(config.read_text(encoding="utf-8")).get("paths", {})
            paths.update({key: own[key] for key in paths if key in own})
        return paths

    def table(self, name: str) -> pd.DataFrame:
        """A table of `reports/tables`, by its name without ".csv"."""
        path = self.path / self._paths()["reports"] / "tables" / f"{name}.csv"
        if not path.is_file():
            there = ", ".join(sorted(p.stem for p in path.parent.glob("*.csv")))
            raise PipelineError(f"there is no table {name}; there are {there or 'none: run the project first'}")
        return pd.read_csv(path)

    def rows(self) -> pd.DataFrame:
        """`derived/rows.parquet`: every reading, with what each model expects of it. Needs pyarrow (or fastparquet)."""
        path = self.path / self._paths()["derived"] / "rows.parquet"
        if not path.is_file():
            raise PipelineError(f"{path} is not there: run the project first")
        return pd.read_parquet(path)

    def model(
        self,
        campaign: str,
        diameter_mm: int | None = None,
        *,
        least_squares: bool = False,
        alias: Sequence[str] = (),
    ) -> ModuleType:
        """The mixed model of a campaign as a NumPy module with `bpa_force`, `bpa_force_gradient` and `bpa_domain` (docs/model.md).

        `least_squares` takes the plain fit instead. `alias` says which effect it is where the readings cannot tell one of the actuator from one of
        the rig.
        """
        diameter = [] if diameter_mm is None else ["--diameter", f"{diameter_mm:g}"]
        plain = ["--least-squares"] if least_squares else []
        named = [f"--alias={effect}" for effect in alias]
        return exported(self.program, ["--campaign", campaign, *diameter, *plain, *named], self.path)

    def predict_state(
        self,
        *,
        campaign: str | None = None,
        diameter_mm: float,
        rest_length_m: float,
        contracted_length_m: float,
        length_m: float,
        pressure_kpa: float,
    ) -> dict[str, Any]:
        """`pipeline predict --json` of one state: the law with its interval, other models, what was measured."""
        lengths = {"--rest-length": rest_length_m, "--contracted-length": contracted_length_m, "--length": length_m}
        arguments = [f"{option}={float(value)!r}m" for option, value in lengths.items()]
        arguments += [f"--diameter={diameter_mm:g}", f"--pressure={float(pressure_kpa)!r}kPa"]
        return self._json("predict", *arguments, *([f"--campaign={campaign}"] if campaign else []))

    def predict(
        self,
        frame: pd.DataFrame,
        *,
        campaign: str,
        diameter_mm: float | None = None,
        columns: Mapping[str, str] | None = None,
        intervals: bool = False,
        least_squares: bool = False,
        alias: Sequence[str] = (),
    ) -> pd.DataFrame:
        """The force of every state of a frame, with its index: `force_n` and `inside`, by arrays of `model`.

        `intervals=True` adds `low_n` and `high_n` (NaN where there is none, and outside of the box), by one call of `pipeline predict` a row: 500
        rows at most. Where there is an interval, `force_n` is that of the call too: it has the smooth misfit beside the law, which arrays lack.
        `least_squares` takes the plain fit, which has no interval.
        """
        if intervals and least_squares:
            raise ReadingsError("intervals are those of the mixed model: leave out least_squares")
        at = states(frame, columns)
        own = diameter_mm is None and "diameter_mm" in frame
        diameters = pd.Series(frame["diameter_mm"] if own else diameter_mm, index=at.index, dtype=float)
        if intervals and len(at) > MOST_INTERVALS:
            raise ReadingsError(f"intervals of {len(at)} rows: each is a call of the program, {MOST_INTERVALS} are the most")
        if own and diameters.isna().any():
            raise ReadingsError("column diameter_mm has empty cells")
        answer = pd.DataFrame({"force_n": float("nan"), "inside": False}, index=at.index)
        for diameter in diameters.unique():
            which = ((diameters == diameter) | (diameters.isna() & pd.isna(diameter))).to_numpy()
            model = self.model(campaign, None if pd.isna(diameter) else diameter, least_squares=least_squares, alias=alias)
            answer.loc[which, ["force_n", "inside"]] = evaluated(model, at[which]).to_numpy()
            diameters[which] = float(model.DIAMETER_MM)
        answer = answer.astype({"force_n": float, "inside": bool})
        if intervals:
            nothing, said = float("nan"), []
            for state, diameter in zip(at.to_dict("records"), diameters):
                one = self.predict_state(campaign=campaign, diameter_mm=diameter, **state)["answer"]
                interval = one["interval"] or {"low_n": nothing, "high_n": nothing}
                said.append((one["force_n"], interval["low_n"], interval["high_n"]))
            said = pd.DataFrame(said, index=at.index, columns=["force_n", "low_n", "high_n"], dtype=float)
            # Outside of the box the exported force is bounded, and the program's interval is about another one.
            has_interval = answer["inside"] & said["low_n"].notna()
            answer["force_n"] = said["force_n"].where(has_interval, answer["force_n"])
            answer[["low_n", "high_n"]] = said[["low_n", "high_n"]].where(has_interval)
        return answer

    def check_session(self, folder: str | os.PathLike[str]) -> dict[str, Any]:
        """`pipeline check-session --json`: what stands out in a session."""
        return self._json("check-session", os.fspath(Path(folder).resolve()), accept=(0, 1))

    def plan(self, plan: str | os.PathLike[str]) -> dict[str, Any]:
        """`pipeline plan --json` of a plan, the path of a TOML file: half a minute to a few."""
        return self._json("plan", os.fspath(Path(plan).resolve()))

    def diff(self, a: str, b: str) -> dict[str, Any]:
        """`pipeline diff --json` of two campaigns of this project, or folders (relative to it) of projects."""
        return self._json("diff", a, b, accept=(0, 1))

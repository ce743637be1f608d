"""`fit`, `predict` and `diagnose`."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from pathlib import Path
from typing import Any, Mapping

import pandas as pd

from .errors import PipelineError, ReadingsError
from .findings import Findings
from .program import find_program
from .project import Project, evaluated, exported
from .readings import configuration, renamed, states, tidy, write_sessions

MARK = "# Written by bpa_pipeline: raw/ is written anew by every fit into this project.\n"


class Fit:
    """The results of a run on one frame of readings. `project` has the rest."""

    def __init__(self, project: Project, campaign: str, outcome: dict[str, Any], holder: Any) -> None:
        self.project = project
        self.campaign = campaign
        #: What `pipeline run --json` said.
        self.outcome = outcome
        self._holder = holder

    def __repr__(self) -> str:
        fitted = ", ".join(f"{row.coefficient}={row.value:.4g}" for row in self.coefficients.itertuples())
        return f"<Fit of {self.campaign} in {self.project.path}: {fitted or 'no coefficients'}>"

    @property
    def messages(self) -> list[str]:
        """Rows and sessions left out, and what the program warned of."""
        return self.project.messages

    def _table(self, name: str) -> pd.DataFrame:
        table = self.project.table(name)
        return table[table["campaign"] == self.campaign].reset_index(drop=True) if "campaign" in table else table

    @property
    def coefficients(self) -> pd.DataFrame:
        """`coefficients.csv`: the new model's, a row each, with intervals and published values."""
        table = self._table("coefficients")
        return table[table["model"] == "new"].reset_index(drop=True)

    @property
    def intervals(self) -> pd.DataFrame:
        """`intervals.csv`: the intervals of every method."""
        return self._table("intervals")

    @property
    def comparison(self) -> pd.DataFrame:
        """`model_comparison.csv`: errors of every model and split."""
        return self._table("model_comparison")

    @property
    def predictions(self) -> pd.DataFrame:
        """Every reading with what each model expects of it (`predicted_..._n`). Needs pyarrow (or fastparquet)."""
        return self.project.rows()

    @property
    def fits(self) -> list[dict[str, Any]]:
        """`derived/fits.json` as it is: ranges, scatter, equations, notes."""
        return json.loads((self.project.path / "derived" / "fits.json").read_text(encoding="utf-8"))

    def findings(self, diameter_mm: int | None = None) -> Findings:
        """What the residual search found; of several diameters say which."""
        return self.project.findings(self.campaign, diameter_mm)

    def predict(self, frame: pd.DataFrame, **options: Any) -> pd.DataFrame:
        """Forces of states by this fit: see `Project.predict`."""
        return self.project.predict(frame, campaign=self.campaign, **options)

    def predict_state(self, **state: float) -> dict[str, Any]:
        """One state with its interval: see `Project.predict_state`."""
        return self.project.predict_state(campaign=self.campaign, **state)


def _folder(project: str | os.PathLike[str] | None) -> tuple[Path, Any]:
    """A folder for a project, and what keeps a temporary one."""
    if project is None:
        holder = tempfile.TemporaryDirectory(prefix="bpa-")
        return Path(holder.name), holder
    path = Path(project)
    config = path / "pipeline.toml"
    ours = config.is_file() and config.read_text(encoding="utf-8").startswith(MARK)
    if path.exists() and not ours and any(path.iterdir()):
        raise PipelineError(f"{path} has other files: project= is a new or empty folder, or one that an earlier fit made")
    path.mkdir(parents=True, exist_ok=True)
    if ours and (path / "raw").is_dir():
        shutil.rmtree(path / "raw")
    return path, None


def fit(
    readings: pd.DataFrame,
    *,
    campaign: str = "readings",
    diameter_mm: int | None = None,
    columns: Mapping[str, str] | None = None,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    project: str | os.PathLike[str] | None = None,
    program: str | os.PathLike[str] | None = None,
) -> Fit:
    """Fits the models to steady readings, a row each, and searches their residual.

    Columns: `specimen`, `rest_length_m`, `contracted_length_m`, `length_m` (each also `_mm`), `pressure_kpa` (gauge), `force_n` (tension
    positive) and `diameter_mm`, here or as the argument; optional `session`, `run`, `date`, `phase`, `time_s`, `temperature_c`. Any other
    column is carried through, and the search looks whether it explains something. Without `session` each specimen (and date) is one.

    `columns` maps own names to these; `options` has tables of pipeline.toml (`pipeline config` prints them); `project` keeps the project,
    else it is temporary and goes with the `Fit`. Raises `ReadingsError` for a frame that cannot be used, `PipelineError` for the program's.
    """
    found = find_program(program)
    rows, messages = tidy(readings, columns, diameter_mm)
    config = MARK + configuration(options)
    path, holder = _folder(project)
    (path / "pipeline.toml").write_text(config, encoding="utf-8")
    write_sessions(rows, campaign, path / "raw")
    work = Project(path, found)
    outcome = work.run()
    work.note(messages)
    done = Fit(work, campaign, outcome, holder)
    if done.coefficients.empty:
        work.note([f"no coefficients were fitted: too few readings ({len(rows)}) or specimens ({rows['specimen'].nunique()})"])
    return done


def diagnose(readings: pd.DataFrame, **arguments: Any) -> Findings:
    """What the residual search finds in readings of one diameter: arguments as for `fit`."""
    frame = renamed(readings, arguments.get("columns"))
    if "diameter_mm" in frame and frame["diameter_mm"].dropna().nunique() > 1:
        raise ReadingsError("readings of several diameters are searched each by itself: give those of one")
    return fit(readings, **arguments).findings()


def predict(
    frame: pd.DataFrame,
    *,
    diameter_mm: int = 10,
    published: str = "new",
    columns: Mapping[str, str] | None = None,
    program: str | os.PathLike[str] | None = None,
) -> pd.DataFrame:
    """Forces of states by published coefficients ("new" or "knee_paper"): `force_n` and `inside`. They have no interval.

    By a fit of your own: `Fit.predict`, or `Project.predict`.
    """
    at = states(frame, columns)
    with tempfile.TemporaryDirectory() as folder:
        model = exported(find_program(program), ["--published", published, "--diameter", f"{diameter_mm:g}"], Path(folder))
    return evaluated(model, at)

"""Installs the Python bridge (python/) into a clean virtual environment and holds it to the program.

    python3 tests/scripts/python_bridge.py target/release/pipeline

Run from the root of the repository, with pip and PyPI; tests/it/documents.rs does so (kind `outside`).
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
import warnings
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def outside(program):
    """A virtual environment with nothing but the bridge and what it asks for, and this script in it."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
        # A copy, so that the build leaves nothing in the repository.
        shutil.copytree(ROOT / "python", folder / "source", ignore=shutil.ignore_patterns("build", "*.egg-info"))
        python = folder / "venv" / ("Scripts" if os.name == "nt" else "bin") / "python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", f"{folder / 'source'}[parquet]"], check=True)
        here = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PIPELINE")}
        work = folder / "work"
        work.mkdir()
        subprocess.run([python, Path(__file__).resolve(), "--inside", program], cwd=work, env=here, check=True)


def refused(kind, words, call):
    """Checks that the call raises this class, with these words in its message."""
    try:
        call()
    except kind as error:
        said = str(error)
        assert all(word in said for word in words), f"{said!r} lacks one of {words}"
        return error
    raise AssertionError(f"nothing was raised; {kind.__name__} with {words} was to be")


def simulated(program):
    """The readings of a simulated campaign on a frame that yields, as somebody would read them: a table a log, put together."""
    import pandas as pd

    truth = ROOT / "truths" / "closed-loop-10mm.toml"
    subprocess.run([program, "simulate", truth, "--out", "simulated", "--truth-out", "truth.json"], check=True, capture_output=True)
    parts = []
    for path in sorted(Path("simulated").rglob("session.toml")):
        session = tomllib.loads(path.read_text())
        specimen = session["specimen"]
        fixed = {name: specimen[name] for name in ("diameter_mm", "rest_length_mm", "contracted_length_mm")}
        for log in session["log"]:
            part = pd.read_csv(path.parent / log["file"]).assign(**fixed, length_mm=session["setup"]["length_mm"], run=log["run"])
            parts.append(part.assign(session=session["id"], specimen=specimen["id"], date=session["date"]))
    frame = pd.concat(parts, ignore_index=True)
    return frame.assign(phase=frame.phase.map({1: "pressurizing", 2: "depressurizing"}))


def inside(program):
    """The tests, where the bridge is installed."""
    import bpa_pipeline as bridge
    import numpy as np
    import pandas as pd

    assert ROOT not in Path(bridge.__file__).resolve().parents, "this is the bridge of the repository, not the one installed"
    lengths = ["rest_length_m", "contracted_length_m", "length_m"]
    state = [*lengths, "pressure_kpa"]

    # A run of the command on the shipped logs over time.
    base = Path("base")
    shutil.copytree(ROOT / "raw" / "simulated-10mm", base / "raw")
    subprocess.run([program, "run"], cwd=base, check=True, capture_output=True)
    command = bridge.Project(base, program)
    rows = command.rows()
    rows = rows[rows.excluded == 0]
    readings = rows[["specimen", "session", "run", "date", "phase", "diameter_mm", *state, "force_n", "time_s"]]

    # The command's plateaus, given as a frame, have the coefficients of the command.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fit = bridge.fit(readings, campaign="frame", project="kept", program=program)
    published = command.table("coefficients").query("model == 'new'")
    assert list(fit.coefficients.coefficient) == list(published.coefficient) and len(published) > 10
    apart = np.abs(fit.coefficients.value.to_numpy() / published.value.to_numpy() - 1).max()
    assert apart < 1e-9, f"coefficients are {apart} apart"
    print(f"coefficients of {len(readings)} readings: {apart:.1e} apart from those of the logs")
    assert not fit.messages and not fit.intervals.empty and "loso" in set(fit.comparison.split)
    assert (fit.predictions.force_n.sort_values().to_numpy() == readings.force_n.sort_values().to_numpy()).all()

    # Arrays are what the command says state by state, and what the run wrote.
    forces = fit.predict(readings, least_squares=True)
    assert (forces.index == readings.index).all() and forces.inside.all()
    expected = command.rows().loc[readings.index].predicted_new_n
    assert np.abs(forces.force_n - expected).max() < 1e-6
    pulling = readings[forces.force_n > 20]
    assert len(pulling) > 100
    worst = 0.0
    for index, row in pulling.sample(12, random_state=1).iterrows():
        said = fit.predict_state(diameter_mm=10, **row[state])["answer"]
        plain = next(o for o in said["others"] if o["model"] == "new_least_squares")
        worst = max(worst, abs(plain["force_n"] / forces.force_n[index] - 1))
        assert said["interval"]["low_n"] < said["force_n"] < said["interval"]["high_n"]
    assert worst < 1e-9, worst
    print(f"12 states: {worst:.1e} apart from pipeline predict")
    # The mixed model as a function lacks the smooth misfit, which is next to nothing where the law is right.
    mixed = fit.predict(pulling)
    apart = np.abs(mixed.force_n / fit.predict(pulling, intervals=True).force_n - 1).max()
    print(f"the function of the mixed model: at most {apart:.1e} apart from pipeline predict")
    assert apart < 0.01
    refused(bridge.ReadingsError, ["least_squares"], lambda: fit.predict(pulling, intervals=True, least_squares=True))
    some = fit.predict(pulling.head(3), intervals=True)
    assert (some.low_n < some.force_n).all() and (some.force_n < some.high_n).all()
    refused(bridge.ReadingsError, ["500"], lambda: fit.predict(pd.concat([pulling] * 3), intervals=True))
    many = pd.concat([readings] * 12)
    begun = time.monotonic()
    assert len(fit.predict(many)) == len(many) > 10_000
    print(f"{len(many)} states: {time.monotonic() - begun:.2f} s")
    beyond = readings.head(2).assign(pressure_kpa=[300.0, 900.0])
    assert list(fit.predict(beyond).inside) == [True, False]
    assert list(fit.predict(beyond, intervals=True).low_n.isna()) == [False, True]
    in_mm = pulling[["pressure_kpa"]].assign(**{name.replace("_m", "_mm"): pulling[name] * 1000 for name in lengths})
    assert np.allclose(fit.predict(in_mm).force_n, mixed.force_n, rtol=1e-9)
    of_paper = bridge.predict(pulling, diameter_mm=10, program=program)
    within = of_paper.index[of_paper.inside]  # beyond the box an exported model is bounded
    assert len(within) > 100
    assert np.abs(of_paper.force_n - command.rows().predicted_new_published_n)[within].max() < 1e-9

    # A column that does nothing, and the same column once it does: a gain that nothing else in the frame goes with.
    drawn = np.random.default_rng(4).uniform(20, 80, readings.session.nunique())
    humidity = readings.session.map(dict(zip(readings.session.unique(), drawn)))
    nothing = bridge.diagnose(readings.assign(humidity=humidity), campaign="nothing", program=program)
    assert nothing.verdict == "none" and nothing.effects.empty and nothing.unexplained.empty, nothing.raw["effects"]
    assert "no effect detected" in nothing.text and not nothing.detection_limits.empty and not nothing.budget.empty
    share = 0.002
    moved = readings.assign(humidity=humidity, force_n=readings.force_n * (1 + share * (humidity - humidity.mean())))
    found = bridge.diagnose(moved, campaign="moved", program=program)
    assert found.verdict == "unexplained" and list(found.unexplained.column) == ["humidity"], (found, found.unexplained)
    cause = found.unexplained.iloc[0]
    (low, at_low), (high, at_high) = cause.curve[0], cause.curve[-1]
    slope = (at_high - at_low) / (high - low)
    print(f"a gain of {share} a unit of a column was put in, {slope:.6f} found, p {cause.p_familywise}")
    assert cause["shape"] == "gain" and cause.p_familywise < 0.05 and abs(slope / share - 1) < 0.05
    assert "depends on humidity" in found.text
    assert found.raw["after"]["rmse_heldout"] < found.raw["before"]["rmse_heldout"]

    # A frame that yields by 6 um/N, which nothing in the readings says.
    compliance = bridge.diagnose(simulated(program), program=program)
    assert compliance.verdict == "effect_found" and list(compliance.effects.id) == ["series_compliance"], compliance
    size = compliance.sizes.iloc[0]
    print(f"6 um/N were put in, {size.value:.2f} found, {size.ci_low:.2f} to {size.ci_high:.2f} {size.unit}")
    assert size.unit == "um/N" and size.ci_low < 6.0 < size.ci_high and size.ci_high - size.ci_low < 1.0 and size.p_familywise < 0.05

    # Refusals name what is wrong.
    def trial(frame, **more):
        return lambda: bridge.fit(frame, campaign="trial", program=program, **more)

    wrong = bridge.ReadingsError
    refused(wrong, ["DataFrame", "list"], lambda: bridge.fit([dict(readings.iloc[0])], program=program))
    refused(wrong, ["there is no column force_n"], trial(readings.drop(columns="force_n")))
    refused(wrong, ["length_m or length_mm"], trial(readings.drop(columns="length_m")))
    refused(wrong, ["length_m reaches", "unit"], trial(readings.assign(length_m=1000 * readings.length_m)))
    refused(wrong, ["no column specimen"], trial(readings.drop(columns="specimen")))
    refused(wrong, ["no column diameter_mm"], trial(readings.drop(columns="diameter_mm")))
    refused(wrong, ["pressure_kpa", "pressure_psi", "convert"], trial(readings.rename(columns={"pressure_kpa": "pressure_psi"})))
    refused(wrong, ["both length_m and length_mm"], trial(readings.assign(length_mm=1.0)))
    refused(wrong, ["Kraft"], trial(readings, columns={"Kraft": "force_n"}))
    refused(wrong, ["no numbers"], trial(readings.assign(force_n="strong")))
    refused(wrong, ["phase", "filling"], trial(readings.assign(phase="filling")))
    two = readings.copy()
    two.loc[two.index[0], "rest_length_m"] += 0.001
    refused(wrong, [f"specimen {two.specimen.iloc[0]}", "2 values of rest_length_m"], trial(two))
    refused(wrong, ["2 values of specimen"], trial(readings.iloc[[0, -1]].assign(session="one")))
    in_pa = readings.assign(pressure_kpa=1000 * readings.pressure_kpa)
    refused(bridge.PipelineError, ["left out", "a pressure outside the possible range"], trial(in_pa))
    few = trial(readings.head(1))()
    assert few.coefficients.empty and any("too few readings (1)" in m for m in few.messages), few.messages
    assert "no coefficients" in repr(few)
    refused(bridge.PipelineError, ["nowhere", "cargo install", "PIPELINE"], lambda: bridge.fit(readings, program="/nowhere/pipeline"))
    error = refused(bridge.PipelineError, ["lost"], trial(readings, options={"fit": {"lost": 1}}))
    assert error.code == 2, error.code
    error = refused(bridge.PipelineError, ["nobody"], lambda: fit.project.predict(readings, campaign="nobody"))
    assert error.code == 2, error.code
    Path("full").mkdir()
    Path("full/mine.txt").write_text("mine")
    refused(bridge.PipelineError, ["other files"], trial(readings, project="full"))
    assert Path("full/mine.txt").read_text() == "mine"

    # Rows without a number are counted, and change nothing else.
    holes = pd.concat([readings, readings.head(3).assign(force_n=np.nan), readings.head(2).assign(pressure_kpa=np.inf)])
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        again = bridge.fit(holes, campaign="frame", project="kept", program=program)
    assert any("3 of 848 rows left out: force_n" in m for m in again.messages), again.messages
    assert any("2 of 848 rows left out: pressure_kpa" in m for m in again.messages), again.messages
    assert [str(w.message) for w in warned if issubclass(w.category, bridge.PipelineWarning)] == again.messages
    assert again.coefficients.equals(fit.coefficients)
    wild = pd.concat([readings.assign(excluded=0), readings.head(4).assign(force_n=1e4, excluded=1)])
    with warnings.catch_warnings(record=True):
        warnings.simplefilter("always")
        kept_out = bridge.fit(wild, campaign="frame", project="kept", program=program)
    assert any("4 of 847 rows left out: excluded" in m for m in kept_out.messages), kept_out.messages
    assert kept_out.coefficients.equals(fit.coefficients)

    for odd, words in ((readings.assign(pressure_kpa=readings.pressure_kpa / 100), "bar"), (readings.assign(force_n=-readings.force_n), "tension")):
        with warnings.catch_warnings(record=True):
            warnings.simplefilter("always")
            assert any(words in m for m in bridge.fit(odd, campaign="odd", program=program).messages), words

    # One specimen has coefficients, and no interval for a muscle that was not measured.
    alone = readings[readings.specimen == "sim10-l257"]
    one = bridge.fit(alone, campaign="one", program=program)
    assert one.findings().raw["design"]["held_out_by"] == "none"
    answer = one.predict_state(diameter_mm=10, **alone.iloc[0][state])
    assert answer["answer"]["interval"] is None and answer["no_interval_because"]
    assert one.predict(alone.head(2), intervals=True).low_n.isna().all()

    # Own names of columns, no session, the other commands, and the command line.
    german = readings.drop(columns=["session", "run", "phase", "time_s"]).rename(columns={"force_n": "Kraft (N)"})
    by_specimen = bridge.fit(german, columns={"Kraft (N)": "force_n"}, program=program)
    assert by_specimen.outcome["sessions"] == readings.specimen.nunique()
    assert fit.project.summary()["answers"][0]["campaign"] == "frame"
    assert command.diff("simulated-10mm", "../kept:frame") and command.check_session(base / "raw" / "sim10-l182")
    refused(bridge.PipelineError, ["there is no table nothing", "coefficients"], lambda: command.table("nothing"))
    readings.to_csv("readings.csv", index=False)

    def line(*arguments):
        return subprocess.run([sys.executable, "-m", "bpa_pipeline", *arguments, "--program", program], capture_output=True, text=True)

    csv = line("fit", "readings.csv", "--campaign", "frame", "--project", "line")
    assert csv.returncode == 0, csv.stderr
    Path("coefficients.csv").write_text(csv.stdout)
    assert np.allclose(pd.read_csv("coefficients.csv").value, fit.coefficients.value, rtol=1e-9)
    csv = line("predict", "readings.csv", "--campaign", "frame", "--project", "line")
    assert csv.returncode == 0 and csv.stdout.count("\n") == len(readings) + 1, csv.stderr
    answer = line("diagnose", "readings.csv", "--campaign", "frame")
    assert json.loads(answer.stdout)["verdict"] == "none", answer.stderr
    answer = line("diagnose", "missing.csv")
    assert answer.returncode == 2 and answer.stderr.startswith("error: "), answer.stderr


if __name__ == "__main__":
    if sys.argv[1] == "--inside":
        inside(sys.argv[2])
    else:
        outside(os.path.abspath(sys.argv[1]))

"""`python -m bpa_pipeline fit|predict|diagnose FILE.csv`: the bridge on CSV files."""

from __future__ import annotations

import argparse
import json
import sys

import pandas as pd

from . import PipelineError, Project, ReadingsError, fit, predict

EXAMPLE = """Examples:
  python -m bpa_pipeline fit readings.csv --diameter 10 --project my-fit > coefficients.csv
  python -m bpa_pipeline diagnose readings.csv --diameter 10 > findings.json
  python -m bpa_pipeline predict states.csv --project my-fit > forces.csv
  python -m bpa_pipeline predict states.csv --diameter 10 > published.csv

readings.csv has the columns specimen, rest_length_mm, contracted_length_mm, length_mm, pressure_kpa, force_n and others that are carried
through; states.csv the three lengths and the pressure. Lengths may also be in m (_m). Exit codes: 0 done, 2 refused.
"""


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = argparse.ArgumentParser(
        prog="python -m bpa_pipeline",
        description="Fit, predict and diagnose braided pneumatic actuators on CSV files.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = top.add_subparsers(dest="command", required=True)
    for name, what in (
        ("fit", "print the fitted coefficients as CSV"),
        ("diagnose", "print the findings as JSON (bpa-findings/2, one campaign)"),
        ("predict", "print the states with force_n and inside as CSV; by published coefficients where no project is named"),
    ):
        command = commands.add_parser(name, help=what, description=what)
        command.add_argument("file", help="readings or states, CSV")
        command.add_argument("--diameter", type=int, metavar="MM", help="nominal diameter, where no column has it")
        command.add_argument("--campaign", default="readings", help="its name [default: readings]")
        command.add_argument("--project", metavar="DIR", help="the project to keep, or to predict by")
        command.add_argument("--program", metavar="FILE", help="the program pipeline [default: PIPELINE, else the path]")
        if name == "predict":
            command.add_argument("--intervals", action="store_true", help="with the 95%% interval; 500 rows at most, needs --project")
    return top


def main(arguments: list[str] | None = None) -> int:
    """Does what the command line says; the exit code."""
    asked = parser().parse_args(arguments)
    try:
        frame = pd.read_csv(asked.file)
        if asked.command == "predict":
            if asked.project:
                project = Project(asked.project, asked.program)
                forces = project.predict(frame, campaign=asked.campaign, diameter_mm=asked.diameter, intervals=asked.intervals)
            elif asked.intervals:
                raise ReadingsError("published coefficients have no interval: --project names a fit")
            elif asked.diameter is None:
                raise ReadingsError("--diameter is needed for published coefficients")
            else:
                forces = predict(frame, diameter_mm=asked.diameter, program=asked.program)
            frame.assign(**forces).to_csv(sys.stdout, index=False)
            return 0
        done = fit(frame, campaign=asked.campaign, diameter_mm=asked.diameter, project=asked.project, program=asked.program)
        if asked.command == "fit":
            done.coefficients.to_csv(sys.stdout, index=False)
        else:
            json.dump(done.findings().raw, sys.stdout, indent=2)
            print()
        return 0
    except (PipelineError, ReadingsError, OSError, pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())

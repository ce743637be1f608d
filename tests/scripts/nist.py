"""Carries the 27 nonlinear regression problems of the NIST Statistical Reference Datasets into tests/data/nist/*.csv.

Usage: python3 nist.py <folder of the .dat files> <folder for the .csv files>

The digits of every number are kept as they stand in the source; only the layout changes. One record a line, its kind first:
    parameter,<name>,<start 1>,<start 2>,<certified value>,<certified standard deviation>
    residual_sum_of_squares,<certified>
    residual_standard_deviation,<certified>
    degrees_of_freedom,<n - p>
    observation,<response>,<predictor>[,<predictor>]
Source: NIST/ITL StRD, https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml, public domain (work of the US government).
"""

import pathlib
import re
import sys

PARAMETER = re.compile(r"^\s*(b\d+)\s*=\s*(\S+)\s+(\S+)\s+(\S+)\s+(\S+)\s*$")
FIELDS = {
    "residual_sum_of_squares": r"^Residual Sum of Squares:\s+(\S+)",
    "residual_standard_deviation": r"^Residual Standard Deviation:\s+(\S+)",
    "degrees_of_freedom": r"^Degrees of Freedom:\s+(\S+)",
}


def convert(text: str, name: str) -> str:
    records = []
    lines = text.splitlines()
    for line in lines:
        if match := PARAMETER.match(line):
            records.append(["parameter", *match.groups()])
    for kind, pattern in FIELDS.items():
        records.append([kind, re.search(pattern, text, re.MULTILINE).group(1)])
    count = int(re.search(r"^Number of Observations:\s+(\d+)", text, re.MULTILINE).group(1))
    first = max(i for i, line in enumerate(lines) if line.startswith("Data:")) + 1
    rows = [line.split() for line in lines[first:] if line.strip()]
    assert len(rows) == count, (name, len(rows), count)
    records += [["observation", *row] for row in rows]
    header = [
        f"# {name}: nonlinear regression problem of the NIST/ITL Statistical Reference Datasets (StRD), public domain.",
        f"# https://www.itl.nist.gov/div898/strd/nls/data/{name.lower()}.shtml; converted by tests/scripts/nist.py.",
    ]
    return "\n".join(header + [",".join(record) for record in records]) + "\n"


def main() -> None:
    source, target = map(pathlib.Path, sys.argv[1:3])
    target.mkdir(parents=True, exist_ok=True)
    for path in sorted(source.glob("*.dat")):
        (target / f"{path.stem}.csv").write_text(convert(path.read_text(), path.stem))


main()

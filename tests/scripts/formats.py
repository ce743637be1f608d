"""Writes one small log in every raw format into tests/data/formats: the same content, so that the tidy data must be the same.

Usage: python3 formats.py <folder>      (needs numpy, pandas, pyarrow, scipy, openpyxl, h5py)

points.csv is the log that the others copy: eleven steady readings, a column of words, a cell without number, one empty.
"""

import gzip
import pathlib
import sys

import h5py
import numpy as np
import openpyxl
import pandas
import scipy.io

COLUMNS = ["length_mm", "pressure_kpa", "force_n", "humidity", "bench"]
NAN = float("nan")
ROWS = [
    (182.0, 620.0, 388.25, 40.5, "A"),
    (182.0, 400.5, 230.125, 41.0, "B"),
    (174.62, 620.0, 280.0, 40.0, "A"),
    (174.62, 500.0, 200.75, 39.5, "B"),
    (174.62, 300.0, NAN, 39.5, "A"),
    (167.25, 620.0, 140.0, 42.0, "A"),
    (167.25, 500.0, 90.0625, 42.5, "B"),
    (167.25, 400.0, 31.5, 40.25, "A"),
    (160.0, 620.0, 50.0, 41.75, "B"),
    (160.0, 610.0, 45.5, NAN, "A"),
    (160.0, 600.0, 40.1, 40.0, "B"),
]


def as_text(separator: str, point: str) -> str:
    def cell(value):
        if isinstance(value, str):
            return value
        return "" if np.isnan(value) else repr(value).replace(".", point)

    lines = [separator.join(COLUMNS)]
    lines += [separator.join(cell(v) for v in row) for row in ROWS]
    return "\n".join(lines) + "\n"


def write_text(folder: pathlib.Path) -> None:
    texts = {
        "points.csv": as_text(",", "."),
        "semicolon.csv": as_text(";", ","),
        "tab.txt": as_text("\t", "."),
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
        with open(folder / f"{name}.gz", "wb") as raw:
            with gzip.GzipFile(filename="", fileobj=raw, mode="wb", mtime=0) as packed:
                packed.write(text.encode())


def write_workbook(folder: pathlib.Path) -> None:
    book = openpyxl.Workbook()
    notes = book.active
    notes.title = "Notes"
    notes["A1"] = "The log is in the sheet Run 8."
    sheet = book.create_sheet("Run 8")
    sheet.append(COLUMNS)
    for row in ROWS:
        sheet.append([None if isinstance(v, float) and np.isnan(v) else v for v in row])
    book.save(folder / "workbook.xlsx")


def columns() -> dict:
    values = {name: np.array([row[k] for row in ROWS]) for k, name in enumerate(COLUMNS[:-1])}
    values["bench"] = np.array([row[-1] for row in ROWS], dtype=object)
    return values


def write_matlab(folder: pathlib.Path) -> None:
    scipy.io.savemat(folder / "vectors.mat", columns())
    packed = {"log": columns(), "note": "words beside the log", "rate_hz": 1000}
    scipy.io.savemat(folder / "structure.mat", packed, do_compression=True)
    matrix = np.array([row[:3] for row in ROWS])
    scipy.io.savemat(folder / "matrix.mat", {"data": matrix}, do_compression=True)
    for name, compression in [("v73.mat", None), ("v73-compressed.mat", "gzip")]:
        path = folder / name
        with h5py.File(path, "w", userblock_size=512) as file:
            for name, values in list(columns().items())[:-1]:
                dataset = file.create_dataset(name, data=values[None, :], compression=compression, track_times=False)
                dataset.attrs["MATLAB_class"] = np.bytes_("double")
        header = b"MATLAB 7.3 MAT-file, written by tests/scripts/formats.py HDF5 schema 1.00 ."
        with open(path, "r+b") as raw:
            raw.write(header.ljust(116) + b"\0" * 8 + b"\x00\x02IM")


def main() -> None:
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder)
    write_workbook(folder)
    write_matlab(folder)
    frame = pandas.DataFrame(ROWS, columns=COLUMNS)
    frame.to_parquet(folder / "frame.parquet", index=False)


if __name__ == "__main__":
    main()

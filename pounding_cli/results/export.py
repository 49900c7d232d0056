"""Results in the formats of other programs: CSV, Parquet, Excel, netCDF; units and meanings go with them."""

from __future__ import annotations

import importlib
import io
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from pounding_cli.errors import InputError
from pounding_cli.outputs import check_output
from pounding_cli.results.file import has_seal, write_file
from pounding_cli.results.results import ResultTables
from pounding_cli.texts import escape_formulas

FORMATS = {"csv": ".csv", "parquet": ".parquet", "excel": ".xlsx", "netcdf": ".nc"}
"""Format -> suffix of its files."""

MOST_ROWS = 1_048_575
"""Rows of an Excel sheet below its heading."""

_NEEDS = {"parquet": "pyarrow", "excel": "openpyxl"}


def export(
    results: ResultTables, output: Path | None = None, form: str | None = None, tables: Sequence[str] = ()
) -> list[Path]:
    """Write tables of a results file for other programs; returns the files written.

    Parameters
    ----------
    results : what to export
    output : a folder (csv, parquet: one file a table, and columns.csv), or one file whose suffix says the format;
        beside the results file unless given
    form : a key of FORMATS; that of the output's suffix, else "csv", unless given
    tables : of `results.tables`; all unless given.  netCDF takes the whole file

    CSV and Parquet hold one table a file, Excel one a sheet.  Numbers are SI with all digits; units and meanings
    stand in columns.csv, the sheet `columns`, the Parquet fields' metadata, or netCDF attributes.

    Raises
    ------
    InputError : formats that contradict each other, a package that is not installed, a place that cannot be
        written, more rows than an Excel sheet takes
    """
    named = {suffix: name for name, suffix in FORMATS.items()}.get(output.suffix.lower()) if output else None
    if form is None and named is None and output and output.suffix and not output.is_dir():
        hint = f"end it in {', '.join(FORMATS.values())}, name a folder without a dot, or give --format"
        raise InputError(f"{output} is the name of no format", hint)
    form = form or named or "csv"
    if named not in (None, form):
        raise InputError(f"{output} is not a name for {form}", f"end it in {FORMATS[form]}, or name a folder")
    try:
        importlib.import_module(_NEEDS.get(form, "io"))
    except ImportError:
        what = f"{form} needs the package {_NEEDS[form]}, which is not installed"
        raise InputError(what, f"pip install {_NEEDS[form]}") from None
    is_folder = form in ("csv", "parquet") and named is None
    stem = results.path.with_suffix("")
    chosen = tuple(dict.fromkeys(tables)) or results.tables
    path = output or Path(f"{stem}-{form}" if is_folder else f"{stem}{FORMATS[form]}")
    if form == "netcdf":
        if tables:
            raise InputError("netCDF takes the whole file, no single tables", "leave the tables out")
        check_output(path, [results.path], lambda _, head: head.startswith((b"\x89HDF", b"CDF")) and not has_seal(path))
        return [write_file(path, results.arrays.to_bytes())]
    frames = {name: results.table(name) for name in chosen}
    known = [(table, name, results.column(table, name)) for table, frame in frames.items() for name in map(str, frame)]
    rows = [(table, name, column.unit.si, column.text) for table, name, column in known]
    columns = pd.DataFrame(rows, columns=["table", "column", "unit", "meaning"])
    if form == "excel":
        check_output(path, [results.path])
        study = pd.DataFrame({results.title: results.study_text.splitlines()})
        return [write_file(path, _excel(frames | {"columns": columns, "study": study}))]
    if not is_folder and len(chosen) > 1:
        hint = f"name the table, e.g. `storey`, or a folder in place of {path.name}"
        raise InputError(f"{path} takes one table, not {len(chosen)}", hint)
    files = {path / f"{name}{FORMATS[form]}": name for name in chosen} if is_folder else {path: chosen[0]}
    if is_folder:
        files[path / "columns.csv"] = "columns"
        frames["columns"] = columns
    for file, name in files.items():
        check_output(file, [results.path], partial(_is_table, frames[name]))
    return [
        write_file(file, _csv(frames[name]) if file.suffix.lower() == ".csv" else _parquet(results, name, frames[name]))
        for file, name in files.items()
    ]


def _is_table(frame: pd.DataFrame, path: Path, head: bytes) -> bool:
    """Return whether a file is an older export: a table with most of the columns."""
    if path.suffix.lower() == ".parquet":
        return head.startswith(b"PAR1")
    there = set(head.split(b"\n", 1)[0].decode(errors="replace").strip().split(","))
    return 2 * len(there & set(map(str, frame))) > len(frame.columns)


def _csv(frame: pd.DataFrame) -> bytes:
    return escape_formulas(frame).to_csv(index=False, lineterminator="\n").encode()


def _parquet(results: ResultTables, name: str, frame: pd.DataFrame) -> bytes:
    """With units and meanings of the columns, title and study."""
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.Table.from_pandas(frame, preserve_index=False)
    known = [(field, results.column(name, field.name)) for field in table.schema]
    fields = [field.with_metadata({"units": column.unit.si, "long_name": column.text}) for field, column in known]
    about = {"title": results.title, "study": results.study_text}
    sink = io.BytesIO()
    parquet.write_table(table.cast(pyarrow.schema(fields, {**(table.schema.metadata or {}), **about})), sink)
    return sink.getvalue()


def _excel(frames: Mapping[str, pd.DataFrame]) -> bytes:
    for name, frame in frames.items():
        if len(frame) > MOST_ROWS:
            hint = "export to Parquet or CSV, or name smaller tables"
            raise InputError(f"the table {name} has {len(frame)} rows, a sheet takes {MOST_ROWS}", hint)
    sink = io.BytesIO()
    with pd.ExcelWriter(sink, engine="openpyxl") as book:
        for name, frame in frames.items():
            escape_formulas(frame).to_excel(book, sheet_name=name, index=False, freeze_panes=(1, 0))
    return sink.getvalue()

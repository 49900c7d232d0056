"""Results in the formats of other programs: CSV, Parquet, Excel, netCDF; units and meanings go with them."""

from __future__ import annotations

import importlib
import io
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from pounding_cli.errors import InputError, Problem
from pounding_cli.outputs import check_output
from pounding_cli.results.file import has_seal
from pounding_cli.results.netcdf import content
from pounding_cli.results.results import Results
from pounding_cli.texts import cells

if TYPE_CHECKING:
    import pandas as pd

FORMATS = {"csv": ".csv", "parquet": ".parquet", "excel": ".xlsx", "netcdf": ".nc"}
"""Format -> suffix of its files."""

_NEEDS = {"parquet": ("pyarrow",), "excel": ("openpyxl",), "netcdf": ("xarray", "h5netcdf")}
_MOST_ROWS = 1_048_575
"""Rows of an Excel sheet below its heading."""


class _Writer(Protocol):
    """Writes one table to a file."""

    def __call__(self, path: Path, name: str) -> None: ...


def export(
    results: Results, output: Path | None = None, form: str | None = None, tables: Sequence[str] = ()
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
    suffix = output.suffix.lower() if output is not None else ""
    named = {end: name for name, end in FORMATS.items()}.get(suffix)
    if form is not None and named is not None and form != named:
        raise InputError(Problem(f"{output} is not a name for {form}", f"end it in {FORMATS[form]}, or name a folder"))
    form = form or named or "csv"
    _require(form)
    path = output or _beside(results.path, form)
    if form == "netcdf":
        if tables:
            raise InputError(Problem("netCDF takes the whole file, no single tables", "leave the tables out"))
        check_output(path, [results.path], _is_netcdf)
        return [_written(path, lambda hidden: _netcdf(results, hidden))]
    chosen = tuple(dict.fromkeys(tables)) or results.tables
    frames = {name: results.table(name) for name in chosen}
    if form == "excel":
        check_output(path, [results.path])
        return [_written(path, lambda hidden: _excel(results, frames, hidden))]
    write = (_csv if form == "csv" else _parquet)(results, frames)
    if named is not None:
        if len(chosen) > 1:
            hint = f"name the table, e.g. `storey`, or a folder in place of {path.name}"
            raise InputError(Problem(f"{path} takes one table, not {len(chosen)}", hint))
        check_output(path, [results.path], partial(_is_table, form, frames))
        return [_written(path, partial(write, name=chosen[0]))]
    for name in (*chosen, "columns"):
        end = ".csv" if name == "columns" else FORMATS[form]
        check_output(path / f"{name}{end}", [results.path], partial(_is_table, end[1:], frames))
    files = [_written(path / f"{name}{FORMATS[form]}", partial(write, name=name)) for name in chosen]
    listed = dictionary(results, frames)
    return [*files, _written(path / "columns.csv", lambda hidden: cells(listed).to_csv(hidden, index=False))]


def _is_netcdf(path: Path, head: bytes) -> bool:
    return head.startswith((b"\x89HDF", b"CDF")) and not has_seal(path)


def _is_table(form: str, frames: dict[str, pd.DataFrame], path: Path, head: bytes) -> bool:
    """Whether a file is an older export: a table with most columns of one of ours."""
    if form == "parquet":
        return head.startswith(b"PAR1")
    there = set(head.split(b"\n", 1)[0].decode(errors="replace").strip().split(","))
    wanted = [{"table", "column", "unit", "meaning"}, *(set(map(str, frame.columns)) for frame in frames.values())]
    return any(2 * len(there & columns) > len(columns) for columns in wanted)


def dictionary(results: Results, frames: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """Table, column, unit, meaning: one row for every column of every table."""
    import pandas as pd

    rows = []
    for table, frame in frames.items():
        for name in frame.columns:
            column = results.column(table, name)
            rows.append((table, name, column.unit.si, column.text))
    return pd.DataFrame(rows, columns=["table", "column", "unit", "meaning"])


def _beside(path: Path, form: str) -> Path:
    return path.with_name(f"{path.stem}-{form}") if form in ("csv", "parquet") else path.with_suffix(FORMATS[form])


def _require(form: str) -> None:
    for package in _NEEDS.get(form, ()):
        try:
            importlib.import_module(package)
        except ImportError:
            hint = f"pip install {' '.join(_NEEDS[form])}"
            raise InputError(Problem(f"{form} needs the package {package}, which is not installed", hint)) from None


def _written(path: Path, write: Callable[[Path], None]) -> Path:
    """Write a file beside its place, then put it there."""
    hidden = path.with_name(f".{path.stem}.part{path.suffix}")
    with _refusing(path):
        try:
            write(hidden)
            hidden.replace(path)
        finally:
            hidden.unlink(missing_ok=True)
    return path


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        hint = "name another place with -o"
        raise InputError(Problem(f"cannot be written: {error.strerror or error}", hint, str(path))) from None


def _csv(results: Results, frames: dict[str, pd.DataFrame]) -> _Writer:
    def write(path: Path, name: str) -> None:
        cells(frames[name]).to_csv(path, index=False, lineterminator="\n")

    return write


def _parquet(results: Results, frames: dict[str, pd.DataFrame]) -> _Writer:
    import pyarrow
    from pyarrow import parquet

    def write(path: Path, name: str) -> None:
        table = pyarrow.Table.from_pandas(frames[name], preserve_index=False)
        fields = []
        for field in table.schema:
            column = results.column(name, field.name)
            fields.append(field.with_metadata({"units": column.unit.si, "long_name": column.text}))
        about = {"title": results.title, "study": results.study_text}
        schema = pyarrow.schema(fields, {**(table.schema.metadata or {}), **about})
        parquet.write_table(table.cast(schema), path)

    return write


def _excel(results: Results, frames: dict[str, pd.DataFrame], path: Path) -> None:
    import pandas as pd

    for name, frame in frames.items():
        if len(frame) > _MOST_ROWS:
            hint = "export to Parquet or CSV, or name smaller tables"
            raise InputError(Problem(f"the table {name} has {len(frame)} rows, a sheet takes {_MOST_ROWS}", hint))
    study = pd.DataFrame({results.title: results.study_text.splitlines()})
    content = io.BytesIO()  # a zip file that cannot be written to its end is told again and again
    with pd.ExcelWriter(content, engine="openpyxl") as book:
        for name, frame in {**frames, "columns": dictionary(results, frames), "study": study}.items():
            frame.to_excel(book, sheet_name=name, index=False, freeze_panes=(1, 0))
            for row in book.sheets[name].iter_rows():
                for cell in row:
                    if cell.data_type == "f":  # a text that begins with "=" is a text, not a formula
                        cell.data_type = "s"
    path.write_bytes(content.getvalue())


def _netcdf(results: Results, path: Path) -> None:
    path.write_bytes(content({"/": results.data.load()}))

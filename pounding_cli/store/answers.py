"""Tables that a workflow adds to a results file: columns of equal length, each with unit and meaning."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import h5py
import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.store.structure import refused, strings
from pounding_cli.store.swept import describe_unit, written

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.study.plan import Axis

GROUP = "answer"
"""Group of the results file that holds them, one group for each table."""

MEANING = 2
"""Raised whenever tables of a workflow say something else of the same scenes: their files are then written again."""

CHUNK = 4096
"""Rows of a compressed piece."""

_AT_ONCE = 1 << 16
"""Numbers of a column that are read together."""

Read = Callable[[str], np.ndarray]
"""read(variable of `variables`) -> its values over the study, shape (swept axes, dimensions of the variable)."""


@dataclass(frozen=True, eq=False)
class Column:
    """One column.

    name : of the column
    data : numbers in SI units, or texts; shape (rows,)
    text : what it means
    unit : SI unit, "1" for a pure number, "" for a text
    shown : unit that people read it in; SI unless given
    """

    name: str
    data: np.ndarray
    text: str
    unit: str = ""
    shown: Unit | None = None


@dataclass(frozen=True)
class Table:
    """A table.

    name : of the table
    blocks : its rows, some at a time so that a table of any length takes little memory; every block has the same
        columns, each of one length
    """

    name: str
    blocks: Iterable[Sequence[Column]]


def place_columns(axes: Sequence[Axis], places: Sequence[tuple[int, ...]]) -> list[Column]:
    """The columns that say at which point of the sweep a row stands, one for each swept key.

    axes : of the sweep
    places : of every row its index on every axis
    """
    columns = []
    for number, axis in enumerate(axes):
        points = axis.values  # noqa: PD011
        for key, name in enumerate(axis.names):
            values = [points[place[number]][key] for place in places]
            is_text = any(isinstance(value, str) for value in values)
            found = np.array([str(v) for v in values], dtype=object) if is_text else np.array(values, float)
            unit = axis.unit(key)
            columns.append(Column(name, found, f"swept: {name}", "" if is_text else unit.si, unit))
    return columns


def write_tables(file: h5py.File, tables: Iterable[Table]) -> None:
    """Write tables into a results file: a dataset a column, by its number; of texts the codes, and each text once."""
    for table in tables:
        group = file.create_group(f"{GROUP}/{table.name}")
        known: dict[int, dict[str, int]] = {}
        rows = 0
        for block in table.blocks:
            if not rows:
                group.attrs["columns"] = json.dumps([column.name for column in block])
            for number, column in enumerate(block):
                data = column.data
                if data.dtype == object:
                    data = _codes(data, known.setdefault(number, {}))
                if str(number) not in group:
                    _create(group, number, column, data.dtype)
                dataset = group[str(number)]
                dataset.resize(rows + data.size, axis=0)
                dataset[rows:] = data
            rows += block[0].data.size if block else 0
        for number, texts in known.items():
            group.create_dataset(_texts(number), data=np.array(list(texts), object), dtype=h5py.string_dtype())


def _create(group: h5py.Group, number: int, column: Column, kind: np.dtype) -> None:
    dataset = group.create_dataset(
        str(number), (0,), kind, maxshape=(None,), chunks=(CHUNK,), compression="gzip", shuffle=True
    )
    dataset.attrs["long_name"] = column.text
    if column.unit:
        dataset.attrs["units"] = column.unit
    if column.shown is not None:
        describe_unit(dataset, column.shown)


def _codes(texts: np.ndarray, known: dict[str, int]) -> np.ndarray:
    """The number of every text among all known so far, to which new ones are added."""
    return np.array([known.setdefault(text, len(known)) for text in texts.tolist()], np.int32)


def _texts(number: int) -> str:
    return f"{number} texts"


def table_names(file: h5py.File) -> tuple[str, ...]:
    """The tables that a workflow added to a file."""
    return tuple(file[GROUP]) if GROUP in file else ()


class Answer(NamedTuple):
    """A table read back.

    frame : its columns, in SI units
    units : of some columns, the unit that people read them in
    meanings : of every column, unit (SI) and meaning
    """

    frame: pd.DataFrame
    units: dict[str, Unit]
    meanings: dict[str, tuple[str, str]]


def largest(file: h5py.File, name: str, column: str) -> float:
    """The largest number of a column, read some at a time; NaN where it has none."""
    group = file[f"{GROUP}/{name}"]
    dataset = group[str(json.loads(str(group.attrs["columns"])).index(column))]
    found = np.nan
    for begin in range(0, dataset.shape[0], _AT_ONCE):
        found = np.fmax(found, np.fmax.reduce(dataset[begin : begin + _AT_ONCE]))
    return float(found)


def read_table(file: h5py.File, name: str, rows: int | None = None) -> Answer:
    """A table of a results file; its first rows alone where `rows` says how many.

    Raises
    ------
    InputError : its columns do not fit together
    """
    import pandas as pd  # here, so that `pound run` on a finished study need not load it

    group, place = file[f"{GROUP}/{name}"], f"{GROUP}/{name}"
    names = json.loads(str(group.attrs.get("columns", "[]")))
    sound = isinstance(names, list) and all(isinstance(each, str) for each in names) and len(set(names)) == len(names)
    numbers = [str(number) for number in range(len(names))]
    texts = {_texts(number) for number in range(len(names))} & set(group)
    if not sound or set(group) != {*numbers, *texts}:
        raise refused(place, "does not hold the columns it names")
    data: dict[str, np.ndarray] = {}
    shown: dict[str, Unit] = {}
    meanings: dict[str, tuple[str, str]] = {}
    for number, column in enumerate(names):
        dataset = group[str(number)]
        if len(dataset.shape or (0, 0)) != 1 or dataset.shape != group["0"].shape:
            raise refused(f"{place}/{number}", "is not a column of its table")
        data[column] = dataset[:rows]
        if _texts(number) in texts:
            known, codes = strings(group[_texts(number)]), data[column]
            if known.ndim != 1 or codes.dtype.kind != "i" or not ((codes >= 0) & (codes < known.size)).all():
                raise refused(f"{place}/{number}", "is not a column of texts")
            data[column] = known[codes]
        meanings[column] = str(dataset.attrs.get("units", "")), str(dataset.attrs.get("long_name", ""))
        if "unit_factor" in dataset.attrs:
            shown[column] = written(dataset)
    return Answer(pd.DataFrame(data), shown, meanings)

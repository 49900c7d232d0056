"""Exports, read back with the readers of their formats: every number, unit and text is there."""

from __future__ import annotations

import csv
import sys

import h5py
import numpy as np
import openpyxl
import pandas as pd
import pytest
import xarray
from pyarrow import parquet

from pounding_cli.errors import InputError
from pounding_cli.store import open_results, write_results
from pounding_cli.store.columns import TABLES, meaning
from pounding_cli.store.export import export
from tests.helpers.plans import Axis, FakeStudy, known, small_plan


@pytest.fixture
def results(tmp_path):
    plan = small_plan(
        axes=(Axis(("impact.damping_ratio",), ((0.1,), (0.2,))),),
        study=FakeStudy(text="title: two\n=1+1  # no formula\n"),
    )
    path = tmp_path / "two.h5"
    write_results(path, plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    return open_results(path)


def same(frame: pd.DataFrame, other: pd.DataFrame, rtol: float = 0.0) -> None:
    """Equal to the last bit unless `rtol` says otherwise; a missing text and an empty one are the same."""
    assert list(frame.columns) == list(other.columns)
    for name in frame.columns:
        if pd.api.types.is_numeric_dtype(frame[name]):
            np.testing.assert_allclose(other[name].astype(float), frame[name], rtol, atol=0, err_msg=name)
        else:
            assert other[name].astype(object).fillna("").astype(str).tolist() == frame[name].astype(str).tolist(), name


def test_csv_has_every_table_and_says_what_the_columns_are(results, tmp_path):
    files = export(results)
    assert [path.name for path in files] == [f"{name}.csv" for name in (*TABLES, "columns")]
    assert {path.parent for path in files} == {tmp_path / "two-csv"}
    for name, path in zip(TABLES, files, strict=False):
        same(results.table(name), pd.read_csv(path))
    with files[-1].open() as stream:
        rows = list(csv.DictReader(stream))
    assert [row["column"] for row in rows if row["table"] == "storey"] == list(results.storey().columns)
    said = {(row["table"], row["column"]): (row["unit"], row["meaning"]) for row in rows}
    assert said["storey", "V"] == ("N", "largest storey shear, without damping force")
    assert said["records", "pga"] == ("m/s2", "peak ground acceleration as used")
    assert said["storey", "impact.damping_ratio"][1].startswith("swept")


def test_every_column_has_a_meaning_and_the_unit_of_the_file(results):
    with h5py.File(results.path) as file:
        for table in TABLES:
            for column in results.table(table).columns:
                unit, text = meaning(table, str(column))
                assert text, (table, column)
                for name in (column, f"record_{column}"):
                    if name in file and name not in results.axes:
                        assert file[name].attrs.get("units", "") == unit, (table, column)


def test_the_floor_of_a_link_is_that_of_the_left_building():
    assert meaning("link", "floor") == ("1", "floor of the link in the left building")
    assert meaning("floor", "floor")[1].startswith("floor, from 1")


def test_nothing_half_written_is_left(results, tmp_path, monkeypatch):
    def full(self, path, **_):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pd.DataFrame, "to_csv", full)
    with pytest.raises(InputError, match="cannot be written: No space left on device"):
        export(results, tmp_path / "a.csv", tables=["storey"])
    assert [path.name for path in tmp_path.iterdir()] == ["two.h5"]


def test_parquet_keeps_types_and_units(results, tmp_path):
    files = export(results, tmp_path / "out", "parquet", ["storey", "scene"])
    assert [path.name for path in files] == ["storey.parquet", "scene.parquet", "columns.csv"]
    same(results.storey(), pd.read_parquet(files[0]))
    same(results.scene(), pd.read_parquet(files[1]))
    schema = parquet.read_schema(files[0])
    assert schema.field("drift").metadata == {b"units": b"m", b"long_name": b"largest storey drift"}
    assert schema.metadata[b"study"].decode() == results.study_text
    assert str(schema.field("storey").type) == "int64"


def test_excel_has_a_sheet_a_table(results, tmp_path):
    (path,) = export(results, tmp_path / "two.xlsx")
    book = openpyxl.load_workbook(path)
    assert book.sheetnames == [*TABLES, "columns", "study"]
    for name in TABLES:
        same(results.table(name), pd.read_excel(path, sheet_name=name), rtol=1e-15)  # sheets hold 16 digits
    assert [cell.value for cell in book["study"]["A"]] == [results.title, "title: two", "=1+1  # no formula"]
    assert book["study"]["A3"].data_type == "s"


def test_netcdf_holds_the_whole_file(results, tmp_path):
    (path,) = export(results, form="netcdf")
    assert path == tmp_path / "two.nc"
    with (
        xarray.open_dataset(path, engine="h5netcdf") as copy,
        xarray.open_dataset(results.path, engine="h5netcdf") as data,
    ):
        xarray.testing.assert_identical(copy.drop_attrs(deep=False), data.drop_attrs(deep=False))
        assert copy["V"].attrs["units"] == "N"
        assert copy.attrs["study"] == results.study_text
        assert '"accuracy"' in copy.attrs["resolved"]
        assert copy.attrs["software_pounding_cli"] == results.attrs["software_pounding_cli"]
        assert copy["V"].dims == ("impact.damping_ratio", "case", "analysis", "record", "building", "storey")


def test_one_table_in_one_file(results, tmp_path):
    (path,) = export(results, tmp_path / "deep" / "floors.csv", tables=["floor"])
    same(results.floor(), pd.read_csv(path))
    assert [p.name for p in path.parent.iterdir()] == ["floors.csv"]


@pytest.mark.parametrize(
    ("output", "form", "tables", "message", "hint"),
    [
        ("a.csv", None, (), "a.csv takes one table, not 10", "a folder"),
        ("a.parquet", None, ("storey", "floor"), "takes one table, not 2", "name the table"),
        ("a.csv", "excel", (), "a.csv is not a name for excel", "end it in .xlsx"),
        ("a.nc", None, ("storey",), "no single tables", "leave the tables out"),
        ("two.h5/x", None, (), "cannot be written", "another place"),
    ],
)
def test_what_cannot_be_written_is_refused(results, tmp_path, output, form, tables, message, hint):
    with pytest.raises(InputError) as refused:
        export(results, tmp_path / output, form, tables)
    (problem,) = refused.value.problems
    assert message in problem.message
    assert hint in problem.hint
    assert [path.name for path in tmp_path.iterdir()] == ["two.h5"]


def test_a_missing_package_is_named(results, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(InputError, match="parquet needs the package pyarrow") as refused:
        export(results, form="parquet")
    assert refused.value.problems[0].hint == "pip install pyarrow"


def test_more_rows_than_a_sheet_takes_are_refused(results, tmp_path, monkeypatch):
    monkeypatch.setattr("pounding_cli.store.export._MOST_ROWS", 10)
    with pytest.raises(InputError, match="the table storey has 80 rows, a sheet takes 10"):
        export(results, tmp_path / "two.xlsx", tables=["storey"])
    assert not (tmp_path / "two.xlsx").exists()

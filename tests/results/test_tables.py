"""The one table type: numbers stay numbers until a cell is drawn."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from pounding_cli.numbers import Unit, format_number
from pounding_cli.results.file import _arrays_of_table, read_table, write_results
from pounding_cli.tables import Column, Table, build_table

CM = Unit("cm", 0.01, "m")
GAP = Column("gap", "required gap", CM, "required", digits=3, low="gap_low", high="gap_high")
ROW = {"gap": 0.0512, "gap_low": 0.04, "gap_high": 0.0731, "error": 0.002, "enough": True, "motions": 5}


@pytest.mark.parametrize(
    ("column", "changed", "cell"),
    [
        (GAP, {}, "5.12 (4.00 to 7.31)"),
        (GAP, {"gap_low": math.nan}, "5.12"),
        (GAP, {"gap": math.nan}, "–"),
        (Column("gap", otherwise=lambda row: f"{row['motions']} passed"), {"gap": math.inf}, "5 passed"),
        (Column("gap", unit=CM, digits=2, error="error"), {}, "5.1 ± 0.20"),
        (Column("gap", unit=CM, digits=2, error="error"), {"error": 0.0}, "5.1"),
        (Column("enough"), {}, "yes"),
        (Column("enough"), {"enough": np.False_}, "no"),
        (Column("motions"), {}, "5"),
        (Column("motions", digits=0), {"motions": 5.0}, "5"),
        (Column("motions", digits=0), {"motions": math.nan}, "–"),
        (Column("gap", unit=CM, digits=1, below=lambda row: f"of {row['motions']}"), {}, "5\nof 5"),
        (Column("gap", write=lambda row: f"{row['motions']} of 7"), {}, "5 of 7"),
        (Column("gap"), {"gap": "none"}, "none"),
    ],
)  # fmt: skip
def test_a_number_becomes_a_cell(column, changed, cell):
    """Fails where a unit, an interval, an error or the reason for no number is lost."""
    assert column.cell({**ROW, **changed}) == cell


def test_a_sentence_names_the_unit_and_no_unit_where_there_is_no_number():
    assert GAP.format_with_unit(ROW) == "5.12 (4.00 to 7.31) cm"
    assert GAP.format_with_unit({**ROW, "gap": math.nan}) == "–"


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (1.23456, 4, "1.235"), (123456.0, 3, "123456"), (1234567.0, 3, "1.23×10⁶"), (0.00012, 2, "1.2×10⁻⁴"),
        (-0.5, 2, "−0.50"), (0.0, 4, "0"), (math.nan, 4, "–"), (math.inf, 4, "–"),
    ],
)  # fmt: skip
def test_one_format_of_numbers(value, digits, text):
    assert format_number(value, digits) == text


def test_a_view_shows_what_varies_and_keeps_numbers():
    """Fails where a view turns numbers into texts, or shows a column that is the same in all rows."""
    frame = pd.DataFrame({"case": ["a", "a"], "analysis": ["elastic", "inelastic"], "gap": [0.05, math.nan]})
    frame = frame.assign(gap_low=math.nan, gap_high=math.nan)
    table = Table("gap", frame, [Column("case"), Column("analysis"), GAP])
    view = table.view("gap", varying=("case", "analysis"))
    assert [column.name for column in view.columns] == ["analysis", "gap"]
    assert view.are_right_aligned() == [False, True]
    assert view.frame["gap"].dtype == float
    assert view.cells() == [["elastic", "5.00"], ["inelastic", "–"]]


def test_a_column_that_nobody_declared_is_refused():
    with pytest.raises(KeyError, match="other"):
        build_table("gap", pd.DataFrame({"other": [1.0]}), [GAP])


def test_a_table_comes_back_from_its_file(tmp_path):
    """Fails where a file loses units, digits, or which columns are the interval of another."""
    frame = pd.DataFrame([{**ROW, "gap": value} for value in (0.05, 0.07)])
    columns = [GAP, Column("gap_low", unit=CM), Column("gap_high", unit=CM), Column("motions")]
    table = Table("gap", frame, columns, "Required gaps")
    write_results(tmp_path / "r.h5", _arrays_of_table(table), [table])
    read = read_table(tmp_path / "r.h5", "gap")
    assert read.caption == table.caption
    assert read.cells() == table.cells()
    assert read.column("gap") == GAP


def test_words_of_a_table_in_a_file_move_no_cursor(tmp_path):
    """Fails where a caption, a label or a meaning from a file reaches a terminal as it is."""
    table = Table("gap", pd.DataFrame([ROW]), [Column("gap", "a\x1b[2Jb", CM, "c\x1b[2Jd")], "e\x1b[2Jf")
    write_results(tmp_path / "r.h5", _arrays_of_table(table), [table])
    read = read_table(tmp_path / "r.h5", "gap")
    assert "\x1b" not in read.caption + read.column("gap").text + read.column("gap").label
    assert read.caption.startswith("e")

"""Tables in a terminal: no line is longer than it, no cell is cut, and what is left out is named."""

from __future__ import annotations

import random
import re

import numpy as np
import pandas as pd
import pytest

from pounding_cli.numbers import Unit
from pounding_cli.tables import Column, Table

WORDS = (
    "touching",
    "infill_1_100",
    "floor",
    "μ/μ₀",
    "penetration",
    "0.257",
    "cm",
    "stiff,",
    "elcentro",
    "5",
    "—",
    "über",
)


def random_table(seed: int) -> Table:
    """A table of numbers, intervals and texts of one or two lines, some of its columns optional."""
    draw = random.Random(seed)
    count, rows = draw.randint(2, 9), draw.randint(1, 6)
    frame, columns = {}, []
    for place in range(count):
        name = f"column {place}"
        is_number = place > 0 and draw.random() < 0.5
        if is_number:
            frame[name] = [draw.uniform(-1, 1) * 10 ** draw.randint(-6, 7) for _ in range(rows)]
        else:
            words = draw.randint(1, 8 if place else 2)
            frame[name] = [" ".join(draw.choices(WORDS, k=words)) for _ in range(rows)]
        below = (lambda row: "floor 5, parkfield") if draw.random() < 0.3 else None
        unit = Unit("cm", 0.01, "m") if is_number else Unit()
        columns.append(Column(name, "", unit, draw.choice(("", "drift", "largest drift of all")), below=below))
    first_optional = draw.randint(1, count)
    columns = [
        Column(c.name, c.text, c.unit, c.label, below=c.below, optional=place >= first_optional)
        for place, c in enumerate(columns)
    ]
    return Table("", pd.DataFrame(frame), columns, "A caption of some words")


def words_of(text: str) -> list[str]:
    return re.findall(r"[^\s;]+", text)


@pytest.mark.parametrize("width", [40, 60, 80, 100, 120, 200])
def test_no_line_is_longer_than_the_terminal_and_no_cell_is_cut(width):
    for seed in range(120):
        table = random_table(seed)
        text = table.to_text(width)
        assert max(map(len, text.splitlines())) <= width, (seed, text)
        assert "…" not in text
        left_out = text.replace("\n", " ").partition("Left out for lack of room: ")[2]
        printed = words_of(text.replace(",", ""))
        for column, cells in zip(table.columns, zip(*table.cells(), strict=True), strict=True):
            if column.head in left_out and column.optional:
                continue
            for cell in cells:
                missing = [word for word in words_of(cell.replace(",", "")) if word not in printed]
                assert not missing, (seed, column.head, missing, text)


def test_optional_columns_are_left_out_from_the_right_and_named():
    names = ["case", "a number", "another number", "third number"]
    frame = pd.DataFrame([["touching", 1.0, 2.0, 3.0]], columns=names)
    columns = [Column(name, optional=number > 1) for number, name in enumerate(names)]
    table = Table("", frame, columns)
    assert "Left out" not in table.to_text(80)
    narrow = table.to_text(44)
    assert "Left out for lack of room: third number" in narrow
    assert "another number" in narrow.splitlines()[1]
    narrower = " ".join(table.to_text(28).split())
    assert "Left out for lack of room: another number, third number" in narrower


def test_where_the_columns_that_stay_have_no_room_every_row_is_a_block():
    frame = pd.DataFrame([["touching", "elastic", 1.5, 0.25], ["gap", "elastic", np.nan, 0.5]])
    frame.columns = ["case", "analysis", "ratio", "a drift with a long heading"]
    text = Table("", frame, [Column(str(name)) for name in frame]).to_text(45)
    assert text.splitlines() == [
        "", "case touching, analysis elastic",
        "  ratio                        1.500", "  a drift with a long heading  0.2500",
        "", "case gap, analysis elastic", "  ratio                        –", "  a drift with a long heading  0.5000",
    ]  # fmt: skip


def test_without_a_terminal_nothing_is_left_out_or_wrapped():
    frame = pd.DataFrame({f"column {place}": ["some words of a cell"] for place in range(20)})
    text = Table("", frame, [Column(str(name), optional=True) for name in frame]).to_text(None)
    (line,) = [line for line in text.splitlines() if "some words" in line]
    assert line.count("some words of a cell") == 20


@pytest.mark.parametrize(
    ("column", "row", "cell"),
    [
        (Column("x"), {"x": 1.23456}, "1.235"),
        (Column("x", digits=0), {"x": 3.0}, "3"),
        (Column("x", unit=Unit("cm", 0.01, "m"), digits=3), {"x": 0.0512}, "5.12"),
        (Column("x", low="a", high="b"), {"x": 2.0, "a": 1.0, "b": 3.0}, "2.000 (1.000 to 3.000)"),
        (Column("x", low="a", high="b"), {"x": 2.0, "a": np.nan, "b": np.nan}, "2.000"),
        (Column("x"), {"x": np.nan}, "–"),
        (Column("x", otherwise=lambda row: "too few"), {"x": np.nan}, "too few"),
        (Column("x", below=lambda row: "storey 3"), {"x": 1.0}, "1.000\nstorey 3"),
    ],
)
def test_a_cell_is_the_number_its_interval_or_why_there_is_none(column, row, cell):
    assert column.cell(row) == cell

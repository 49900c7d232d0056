"""`pound show`: every table in every form, filtered; what is refused."""

from __future__ import annotations

import csv
import io

import pytest

import pounding_cli
from pounding_cli.cli.results import _table_to_print
from pounding_cli.numbers import format_number
from pounding_cli.questions.reports import build_report

from .conftest import TWO

SWEPT = "sweep: {cases.gap.gap: [5 mm, 6 mm], impact.restitution: [0.4, 0.6]}\n"
TABLES = ("storey", "floor", "link", "scene", "accuracy", "summary", "records", "buildings")


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """Results of a sweep."""
    folder = tmp_path_factory.mktemp("show")
    (folder / "two.yaml").write_text(TWO + SWEPT)
    pounding_cli.run(folder / "two.yaml", folder / "r.h5", engine="serial")
    return folder / "r.h5"


@pytest.fixture
def shown(file, pound):
    return lambda *arguments: pound("show", file, *arguments)


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def rows_of(text: str) -> list[str]:
    """The rows of a printed table, below its rule."""
    lines = text.splitlines()
    return [line for line in lines[lines.index(rule_of(text)) + 1 :] if line.startswith(" ")]


def rule_of(text: str) -> str:
    return next(line for line in text.splitlines() if line.strip("─ ") == "" and "─" in line)


def head_of(text: str) -> str:
    """The headings of a printed table, above its rule."""
    lines = text.splitlines()
    return lines[lines.index(rule_of(text)) - 1]


@pytest.mark.parametrize("table", TABLES)
def test_every_table_in_every_form(file, shown, table):
    """CSV has all columns, rows and digits, in SI."""
    results = pounding_cli.open_results(file)
    frame = results.buildings if table == "buildings" else results.table(table)
    found = rows(shown(table, "--format", "csv")[1])
    assert list(found[0]) == list(frame.columns)
    assert len(found) == len(frame)
    if table == "storey":
        assert [float(row["V"]) for row in found] == list(frame["V"])
    code, out, err = shown(table)
    assert code == 0
    assert len(rows_of(out)) == len(frame)
    assert err == "" or "--format csv" in err


def test_a_table_for_the_eye_is_in_the_units_of_the_study(shown):
    """Fails if a gap is shown in m, an acceleration in m/s2, or what the study does not write in N and m."""
    head = head_of(shown("link", "--where", "gap=6 mm")[1])
    assert "cases.gap.gap [mm]" in head
    assert "gap [cm]" in head
    assert "acceleration [g]" in shown("floor")[1]
    storey = shown("storey", "--where", "storey=2")[1]
    exact = rows(shown("storey", "--where", "storey=2", "--format", "csv")[1])
    for column, unit, factor in (("V", "kN", 1e3), ("drift0", "mm", 1e-3), ("drift_ratio", "%", 0.01)):
        head = f"{column} [{unit}]"
        assert head in head_of(storey)
        ends = head_of(storey).index(head) + len(head)
        numbers = [float(line[:ends].split()[-1]) for line in rows_of(storey)]
        assert numbers == pytest.approx([float(row[column]) / factor for row in exact], rel=1e-3)
    for table, heads in {
        "link": ("peak_force [kN]", "impulse [kN s]", "contact_time [ms]", "max_closing [cm]"),
        "buildings": ("mass [t]", "height [m]", "stiffness [MN/m]", "yield_shear [kN]", "separation [mm]"),
        "scene": ("seconds [ms]", "energy_residual "),
    }.items():
        head = head_of(shown(table)[1]) + " "
        for wanted in heads:
            assert wanted in head
    assert {row["gap"] for row in rows(shown("link", "--case", "gap", "--format", "csv")[1])} == {"0.005", "0.006"}


def test_some_columns_stand_in_csv_alone(shown):
    _, narrow, told = shown("summary")
    aside = told.strip().split(": ")[1].split(", ")
    assert "V_ratio_std" in aside
    assert set(aside) <= set(rows(shown("summary", "--format", "csv")[1])[0])
    assert not [name for name in aside if f" {name} " in head_of(narrow)]
    assert shown()[1] == narrow


@pytest.mark.parametrize(
    ("arguments", "column", "left"),
    [
        ("storey --case gap --analysis elastic --record taft --building soft", "building", {"soft"}),
        ("scene --record elcentro --record taft --case gap", "case", {"gap"}),
        ("storey --where cases.gap.gap=6mm --where restitution=0.4", "cases.gap.gap", {"0.006"}),
        ("storey --where gap=0.006 --where gap=5mm --where storey=2", "storey", {"2"}),
        ("floor --where floor=1", "floor", {"1"}),
        ("link --where floor=2", "link", {"stiff|soft floor 2"}),
        ("link --where gap=0.5cm", "gap", {"0.005"}),
        ("storey --where case=gap --case touching --where building=soft", "case", {"gap", "touching"}),
        ("buildings --where period=300ms", "building", {"stiff"}),
        ("buildings --where yield_shear=539.36575", "storey", {"1"}),
    ],
)
def test_filters(shown, arguments, column, left):
    table, *options = arguments.split()
    found = rows(shown(table, "--format", "csv", *options)[1])
    every = rows(shown(table, "--format", "csv")[1])
    assert {row[column] for row in found} == left
    assert 0 < len(found) < len(every)
    assert all(row in every for row in found)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("storey --case gip", ["'gip'", "touching, gap"]),
        ("summary --record taft", ["record", "leave the option out"]),
        ("stories", ["'storey'"]),
        ("storey --format cvs", ["'csv'"]),
        ("storey --where gap", ["no value"]),
        ("records --where gap=5mm", ["no column gap"]),
        ("storey --where gab=1cm", ["gab", "cases.gap.gap, impact.restitution"]),
        ("storey --where gap=3cm", ["5 mm, 6 mm"]),
        ("storey --where gap=2s", ["5 mm, 6 mm"]),
        ("storey --where storey=9", ["9", "1, 2, 3"]),
        ("storey --where floor=1", ["no column floor"]),
        ("link --where link=roof", ["'roof'", "stiff|soft floor 1"]),
    ],
)
def test_what_is_not_there_is_refused_with_what_is(shown, arguments, words):
    code, out, err = shown(*arguments.split())
    assert (code, out) == (2, "")
    for word in words:
        assert word in err


@pytest.mark.parametrize("width", [80, 120, 200])
def test_run_and_every_table_fit_the_terminal(file, width):
    """No line is longer than the terminal; columns that have no room are named."""
    results = pounding_cli.open_results(file)
    summary = "\n".join(build_report(results).summary.iter_lines(width)).splitlines()
    assert max(map(len, summary)) <= width
    assert not any("…" in line for line in summary)
    for name in results.tables:
        frame = results.table(name)
        if frame.empty:
            continue
        text = _table_to_print(results, name, frame).to_text(width, max_rows=len(frame))
        assert max(map(len, text.splitlines())) <= width, name
        printed = " ".join(text.split())
        assert all(str(column) in printed for column in frame.columns), name


def test_accelerations_of_floors_that_strike_are_explained(shown):
    note = "depend on the contact stiffness, which is unknown"
    assert note in shown("floor")[1]
    assert note in shown("link")[1]
    assert note not in shown("storey")[1]


def test_a_notebook_has_the_numbers_of_the_terminal(file):
    results = pounding_cli.open_results(file)
    largest = results.summary().groupby(["case", "building", "analysis"], sort=False)["V_ratio_mean"].max()
    html = results._repr_html_()
    for value in largest:
        assert f"<td>{format_number(value)}</td>" in html

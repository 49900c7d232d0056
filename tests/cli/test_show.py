"""`pound show`: every table in every form, filtered; what is refused."""

from __future__ import annotations

import csv
import io
import json
import re
import sys

import pytest

from pounding_cli.cli import show
from pounding_cli.store.columns import TABLES
from tests.helpers.two_buildings import STUDY, known

SOLVE = known


@pytest.fixture
def shown(folder, pound):
    """`pound show r.h5 ...` after a run."""
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    return lambda *arguments: pound("show", "r.h5", *arguments)


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_storey_csv_has_the_columns_of_the_manual_and_all_digits(shown):
    code, out, _ = shown("storey", "--format", "csv")
    assert code == 0
    assert out.splitlines()[0].startswith("case,analysis,record,building,storey,V,V0,V_ratio,mu,mu0,mu_ratio,drift")
    table = rows(out)
    assert len(table) == 2 * 2 * 2 * 5
    assert {row["V_ratio"] for row in table} == {"1.25", "2.0"}
    import pounding_cli

    exact = pounding_cli.open_results("r.h5").storey()
    assert [float(row["V"]) for row in table] == list(exact.V)


def test_a_table_for_the_eye_is_in_the_units_of_the_study_and_csv_in_si(shown, folder, pound):
    """Fails if a gap is shown in m, an acceleration in m/s2, or CSV in anything but SI."""
    _, table, _ = shown("link", "--case", "gap")
    head, row = table.splitlines()[1:3]
    assert "gap [cm]" in head
    assert "max_closing [cm]" in head
    assert row.split()[head.replace(" [", "[").split().index("gap[cm]") + 2] == "1"  # "A|B floor 1" has three words
    assert {row["gap"] for row in rows(shown("link", "--case", "gap", "--format", "csv")[1])} == {"0.01"}
    assert "pga [g]" in shown("records")[1]
    assert "acceleration [g]" in shown("floor")[1]
    (folder / "two.yaml").write_text(STUDY.replace("0 cm", "0 mm").replace("1 cm", "10 mm"))
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    assert "gap [mm]" in shown("link")[1]


def test_the_tables_are_those_of_a_results_file():
    assert show.TABLES[: len(TABLES)] == TABLES


def test_swept_axes_come_first(folder, pound):
    sweep = "sweep: {cases.gap.gap: [1 cm, 2 cm], impact.restitution: [0.4, 0.6]}\n"
    (folder / "two.yaml").write_text(STUDY + sweep)
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    _, out, _ = pound("show", "r.h5", "storey", "--format", "csv")
    assert out.startswith("cases.gap.gap,impact.restitution,case,")
    assert {row["cases.gap.gap"] for row in rows(out)} == {"0.01", "0.02"}


@pytest.mark.parametrize("form", ["table", "csv", "json"])
@pytest.mark.parametrize("table", [name for name in TABLES if name != "struck"])  # no slab strikes columns here
def test_every_table_in_every_form(shown, table, form):
    code, out, err = shown(table, "--format", form)
    assert code == 0
    assert err == "" or (
        form == "table" and re.match(r"1 more column with --wide: \w+\n|(?!1 )\d+ more columns with --wide: ", err)
    )
    import pounding_cli

    results = pounding_cli.open_results("r.h5")
    frame = results.buildings if table == "buildings" else getattr(results, table)()
    if form == "csv":
        assert list(rows(out)[0]) == list(frame.columns)
        assert len(rows(out)) == len(frame)
    elif form == "json":
        found = json.loads(out)
        assert list(found[0]) == list(frame.columns)
        assert len(found) == len(frame)
    else:
        assert len(out.splitlines()) == 2 + len(frame)
        assert len(out.splitlines()[1]) < 200  # one line of a wide screen at most


def test_wide_shows_what_is_kept_aside(shown):
    _, narrow, told = shown("summary")
    aside = told.strip().split(": ")[1].split(", ")
    _, wide, nothing = shown("summary", "--wide")
    assert nothing == ""
    assert "V_ratio_std" in aside
    assert "V_ratio_mean" not in aside
    for name in aside:
        assert f" {name} " not in narrow.splitlines()[1]
        assert f" {name} " in f"{wide.splitlines()[1]} "


def test_summary_is_what_is_shown_unless_told_otherwise(shown):
    assert shown() == shown("summary")


def test_filters(shown):
    wanted = {"case": "gap", "analysis": "elastic", "record": "weak", "building": "soft"}
    options = [word for name, value in wanted.items() for word in (f"--{name}", value)]
    _, out, _ = shown("storey", "--format", "csv", *options)
    assert [(row["case"], row["building"], row["storey"]) for row in rows(out)] == [
        ("gap", "soft", "1"),
        ("gap", "soft", "2"),
    ]
    _, out, _ = shown("scene", "--format", "csv", "--record", "weak", "--record", "strong", "--case", "gap")
    assert len(rows(out)) == 4


def test_accuracy_is_told_scene_by_scene(folder, pound, shown):
    (folder / "two.yaml").write_text(STUDY + "estimate: none\naccuracy: 1e-5\n")
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    _, out, _ = shown("accuracy", "--case", "gap", "--format", "csv")
    head = "case,analysis,record,status,method,accuracy,time_step,error_estimate,sensitivity,estimated"
    assert out.splitlines()[0] == head + ",energy_residual,steps,events,orders,seconds"
    assert [tuple(row[name] for name in ("analysis", "record")) for row in rows(out)] == [
        ("elastic", "weak"), ("elastic", "strong"), ("inelastic", "weak"), ("inelastic", "strong"),
    ]  # fmt: skip
    for row in rows(out):
        assert (row["method"], row["accuracy"], row["steps"], row["seconds"]) == ("taylor", "1e-05", "1", "0.0001")
        assert row["error_estimate"] == ""  # not asked for
    _, out, _ = shown("accuracy")
    assert "seconds [s]" in out


def test_units_stand_over_the_columns_and_missing_numbers_are_dashes(folder, pound, shown):
    (folder / "two.yaml").write_text(STUDY + "estimate: none\n")
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    _, out, _ = shown("storey")
    assert "V [N]" in out
    assert "drift [m]" in out
    _, out, _ = shown("scene", "--format", "json")
    first = json.loads(out)[0]
    assert first["sensitivity"] is None
    assert first["flags"] == []
    assert json.loads(out)[-1]["flags"] == ["a sentence to know"]


@pytest.mark.parametrize(
    ("arguments", "message", "hint"),
    [
        (["storey", "--case", "gip"], "there is no case 'gip'", "touching, gap"),
        (["summary", "--record", "weak"], "the table summary has no column record", "leave the option out"),
        (["stories"], "'stories' is not one of", "Did you mean 'storey'?"),
        (["storey", "--format", "cvs"], "'cvs' is not one of", "Did you mean 'csv'?"),
    ],
)
def test_what_is_not_there_is_refused_with_what_is(shown, arguments, message, hint):
    code, out, err = shown(*arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert hint in err


def test_a_missing_file_is_refused(folder, pound):
    code, _, err = pound("show", "nothing.h5")
    assert code == 2
    assert "there is no such results file" in err
    assert "pound run" in err


def test_help_loads_nothing_heavy(folder, pound):
    heavy = ("numba", "scipy", "pandas", "matplotlib")
    import subprocess

    script = (
        "import sys; from pounding_cli.cli import run, show; "
        f"print([name for name in {heavy!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    code, out, _ = pound("run", "--help")
    assert code == 0
    assert "pound run configs/fig6.yaml" in out


@pytest.fixture
def swept(folder, pound):
    """`pound show r.h5 ...` after a run over gaps and restitutions."""
    sweep = "sweep: {cases.gap.gap: [1 cm, 2 cm], impact.restitution: [0.4, 0.6]}\n"
    (folder / "two.yaml").write_text(STUDY + sweep)
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    return lambda *arguments: pound("show", "r.h5", *arguments)


def test_points_storeys_floors_and_links_are_chosen(swept):
    _, out, _ = swept("storey", "--format", "csv", "--at", "cases.gap.gap=2 cm", "--at", "restitution=0.4")
    assert {(row["cases.gap.gap"], row["impact.restitution"]) for row in rows(out)} == {("0.02", "0.4")}
    _, out, _ = swept("storey", "--format", "csv", "--at", "gap=20 mm", "--at", "gap=0.01", "--storey", "2")
    assert {(row["cases.gap.gap"], row["storey"]) for row in rows(out)} == {("0.01", "2"), ("0.02", "2")}
    _, out, _ = swept("floor", "--format", "csv", "--floor", "1")
    assert {row["floor"] for row in rows(out)} == {"1"}
    link = next(csv.DictReader(io.StringIO(swept("link", "--format", "csv")[1])))["link"]
    _, out, _ = swept("link", "--format", "csv", "--link", link)
    assert {row["link"] for row in rows(out)} == {link}


def test_swept_values_are_shown_in_the_unit_of_the_study(swept):
    _, out, _ = swept("storey", "--at", "gap=2 cm", "--storey", "1")
    assert "cases.gap.gap [cm]" in out
    assert [line.split()[0] for line in out.splitlines()[2:]] == ["2"] * len(out.splitlines()[2:])


@pytest.mark.parametrize(
    ("arguments", "message", "hint"),
    [
        (["storey", "--at", "gap"], "--at gap: no value", "--at 'cases.gap.gap=5 cm'"),
        (["storey", "--at", "gab=1 cm"], "gab is no swept key", "cases.gap.gap, impact.restitution"),
        (["storey", "--at", "gap=3 cm"], "cases.gap.gap does not take this value", "1 cm, 2 cm"),
        (["storey", "--at", "gap=2 s"], "cases.gap.gap does not take this value", "1 cm, 2 cm"),
        (["storey", "--storey", "9"], "there is no storey 9", "1, 2, 3"),
        (["storey", "--floor", "1"], "the table storey has no column floor", "leave the option out"),
        (["link", "--link", "roof"], "there is no link 'roof'", "stiff|soft floor 1"),
    ],
)
def test_places_that_are_not_there_are_refused_with_those_that_are(swept, arguments, message, hint):
    code, out, err = swept(*arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert hint in err


def test_a_case_without_links_says_so(folder, pound):
    apart = STUDY.replace("cases:\n", "cases:\n  apart: {link: none}\n")
    (folder / "two.yaml").write_text(apart)
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    code, _, err = pound("show", "r.h5", "link", "--case", "apart")
    assert code == 2
    assert "apart has no links" in err
    assert "touching" in err or "gap" in err

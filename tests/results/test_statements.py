"""Statements of a study: what they name, what their numbers are, and which verdict follows."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

import pounding_cli as pound
from pounding_cli.errors import InputError
from pounding_cli.questions.sensitivity.question import Sensitivity
from pounding_cli.questions.side_by_side import collect_statements, compare_statements
from pounding_cli.questions.statements import (
    ERROR,
    FAILS,
    HOLDS,
    PARTLY,
    SENSITIVITY,
    UNDECIDED,
    UNKNOWN,
    EvaluatedComparison,
    format_value,
    judge,
    list_verdicts,
    view_verdicts,
)
from pounding_cli.study.expressions.comparison import parse_comparison
from pounding_cli.study.expressions.expression import QUANTITIES, Scope
from pounding_cli.study.expressions.statements import Statement

STUDY: dict[str, Any] = {
    "title": "Statements",
    "records": {"use": ["elcentro", "taft"], "duration": "3 s"},
    "buildings": {
        "stiff": {"storeys": 3, "period": "0.3 s", "mass": "200 t"},
        "soft": {"like": "stiff", "storeys": 2, "period": "0.5 s"},
    },
    "group": ["soft", "stiff", "soft"],
    "cases": {
        "touching": {"link": "pounding", "gap": "0 cm"},
        "near": {
            "gap": "5 mm",
            "links": [
                {"link": "connector", "floors": [2], "stiffness": "1/5 mean storey of stiff"},
                {"link": "pounding", "floors": "rest"},
            ],
        },
    },
    "sweep": {"impact.restitution": [0.4, 0.6]},
    "analyses": ["elastic", "inelastic"],
}

SCOPE = Scope(("soft-1", "stiff", "soft-2"), ("touching", "near"), ("elastic", "inelastic"), ("taft",), ("pounding",))


def solve(folder, *statements: dict[str, Any], **changes: Any) -> pound.Results:
    """Return the results of the study with statements; what is solved is reused."""
    study = {**STUDY, "statements": [{"says": "something", **each} for each in statements], **changes}
    return pound.run(
        {key: value for key, value in study.items() if value is not None}, folder / "r.h5", engine="serial"
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("POUND_RECORDS", raising=False)
        patch.setenv("POUND_HOME", str(tmp_path_factory.mktemp("home")))
        yield tmp_path_factory.mktemp("statements")


@pytest.fixture(scope="module")
def results(folder) -> pound.Results:
    return solve(folder, {"holds": "mu > 0"})


def mean_of_motions(frame: pd.DataFrame, column: str) -> pd.Series:
    """The mean over the motions, storey by storey or link by link."""
    keys = [key for key in ("building", "storey", "floor", "link") if key in frame]
    return frame.groupby(keys, observed=True)[column].mean()


def ratios_by_building(results: pound.Results, building: str) -> pd.Series:
    """V/V0 of a building, the mean over the motions, storey by storey."""
    return mean_of_motions(results.storey().query(STOREYS), "V_ratio").loc[building]


STOREYS = "case == 'near' and analysis == 'elastic' and `impact.restitution` == 0.6"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("mean V_ratio in near elastic stiff [impact.restitution = 0.6]",
         lambda r: mean_of_motions(r.storey().query(STOREYS), "V_ratio").loc["stiff"].mean()),
        ("V_ratio in near elastic soft-2 storey 2 [impact.restitution = 0.6]",
         lambda r: mean_of_motions(r.storey().query(STOREYS), "V_ratio").loc["soft-2", 2]),
        ("largest mean V_ratio in near elastic [impact.restitution = 0.6]",
         lambda r: max(ratios_by_building(r, name).mean() for name in ("soft-1", "stiff", "soft-2"))),
        ("smallest largest V_ratio in near elastic softer buildings [impact.restitution = 0.6]",
         lambda r: min(ratios_by_building(r, name).max() for name in ("soft-1", "soft-2"))),
        ("mean acceleration in near elastic stiffest building [impact.restitution = 0.6]",
         lambda r: mean_of_motions(r.floor().query(STOREYS), "acceleration").loc["stiff"].mean()),
        ("peak_force in near elastic connector links taft [impact.restitution = 0.6]",
         lambda r: r.link().query(f"{STOREYS} and record == 'taft' and kind == 'connector'")["peak_force"].max()),
        ("smallest max_closing in near elastic pounding links taft [impact.restitution = 0.6]",
         lambda r: r.link().query(f"{STOREYS} and record == 'taft' and kind == 'pounding'")["max_closing"].min()),
        ("gap in near connector links [impact.restitution = 0.6]", lambda r: 0.005),
        ("period in stiff", lambda r: 0.3),
        ("smallest period in softer buildings", lambda r: 0.5),
        ("scale in taft", lambda r: r.records().set_index("record")["scale"]["taft"]),
        ("energy_links in near elastic taft [impact.restitution = 0.6]",
         lambda r: r.scene().query(f"{STOREYS} and record == 'taft'")["energy_links"].iloc[0]),
    ],
)  # fmt: skip
def test_a_number_is_that_of_the_tables(folder, results, text, expected):
    """Fails if a place, a point of the sweep or a reduction takes another row."""
    found = solve(folder, {"holds": f"{text} > {text} * 0.5"}).table("statements")
    assert found["number"].tolist() == pytest.approx([expected(results)], rel=1e-12)
    assert found["margin"].tolist() == pytest.approx([expected(results) / 2], rel=1e-12)


def test_an_energy_is_compared_with_one_in_joules(folder, results):
    lost = results.scene().query(f"{STOREYS} and record == 'taft'")["energy_links"].iloc[0]
    text = "energy_links in near elastic taft [impact.restitution = 0.6] > 1 kJ"
    frame = solve(folder, {"holds": text}).table("statements")
    assert frame["margin"].tolist() == pytest.approx([lost - 1000.0])


def test_what_a_statement_leaves_open_has_a_row_each(folder):
    """Point, case and analysis; a mean of motions has one row."""
    frame = solve(folder, {"holds": "drift in stiff > 0 cm"}).table("statements")
    assert len(frame) == 2 * 2 * 2
    assert set(frame["case"]) == {"touching", "near"}
    assert set(frame["analysis"]) == {"elastic", "inelastic"}
    assert set(frame["impact.restitution"]) == {0.4, 0.6}
    pinned = solve(folder, {"holds": "drift in touching elastic stiff > 0 cm"}).table("statements")
    assert pinned["case"].tolist() == ["", ""]
    of_building = solve(folder, {"holds": "period in stiff > 0.2 s"}).table("statements")
    assert of_building["impact.restitution"].isna().tolist() == [True]


def test_a_statement_at_a_point_is_tested_there(folder):
    """As with the point in brackets; one that names another point keeps that."""
    holds = "drift in near elastic stiff / drift in near elastic stiff [impact.restitution = 0.4] > 0"
    (row,) = solve(folder, {"holds": holds, "at": {"impact.restitution": "0.6"}}).table("statements").to_dict("records")
    drifts = [
        solve(folder, {"holds": f"drift in near elastic stiff [impact.restitution = {value}] > 0 m"}).table(
            "statements"
        )
        for value in (0.6, 0.4)
    ]
    assert row["number"] == drifts[0]["number"].item() / drifts[1]["number"].item() != 1.0
    with pytest.raises(InputError, match=r"the sweep has no point with impact\.restitution = 0\.5"):
        solve(folder, {"holds": holds, "at": {"impact.restitution": "0.5"}})


def test_each_motion_is_counted(folder, results):
    drifts = results.storey().query("case == 'near' and analysis == 'elastic' and building == 'stiff'")
    drifts = drifts[drifts["impact.restitution"] == 0.6].groupby("record", observed=True)["drift"].max()
    bound = drifts.mean()  # between the two
    text = f"drift in near elastic stiff [impact.restitution = 0.6] < {bound * 1000} mm"
    (row,) = solve(folder, {"holds": text, "over_motions": "each"}).table("statements").to_dict("records")
    assert (row["met"], row["motions"], row["outcome"]) == (1, 2, FAILS)
    assert row["number"] == pytest.approx(drifts.max())  # of the worst
    (verdict,) = list_verdicts(pd.DataFrame([row]))
    assert str(verdict) == f"{FAILS} (1 of 2 motions)"


@pytest.mark.parametrize(
    ("holds", "outcomes", "verdict"),
    [
        (["drift > 0 cm"], {HOLDS}, HOLDS),
        (["drift < 0 cm"], {FAILS}, FAILS),
        (["drift > 0 cm", "drift < 0 cm"], {HOLDS, FAILS}, PARTLY),
        (["0 < mu / mu < 2"], {HOLDS}, HOLDS),
        (["2 > mu / mu > 0"], {HOLDS}, HOLDS),
        (["1.5 < mu / mu < 2"], {FAILS}, FAILS),
        (["mu / mu <= 1"], {HOLDS}, HOLDS),
        (["sqrt(0 - mu) > 1"], {UNKNOWN}, UNKNOWN),
        (["mu / (mu - mu) > 1"], {UNKNOWN}, UNKNOWN),
        (["0 < mu / mu <= 1"], {HOLDS}, HOLDS),
        (["1 < mu / mu <= 1"], {FAILS}, FAILS),
        (["gap in near <= 5 mm", "gap in near >= 5 mm"], {HOLDS}, HOLDS),
        (["gap in near < 5 mm"], {FAILS}, FAILS),
        (["gap in near + 0.1 + 0.2 <= 0.305 m"], {HOLDS}, HOLDS),  # but for the rounding of the sum
        (["drift > 0 cm", "sqrt(0 - mu) > 1"], {HOLDS, UNKNOWN}, PARTLY),
        (["drift < 0 cm", "sqrt(0 - mu) > 1"], {FAILS, UNKNOWN}, FAILS),
    ],
)
def test_the_verdict_follows_from_the_outcomes(folder, holds, outcomes, verdict):
    frame = solve(folder, {"holds": holds}, estimate="none").table("statements")
    assert set(frame["outcome"]) == outcomes
    (found,) = list_verdicts(frame)
    assert found.word == verdict


def test_floors_that_never_strike_do_not_strike(folder):
    """Fails if a number without an error lies within its error; nothing turns it."""
    cases = {"far": {"link": "pounding", "gap": "3 m"}}
    frame = solve(folder, {"holds": "impacts > 0"}, cases=cases).table("statements")
    assert set(zip(frame["outcome"], frame["turns"], strict=True)) == {(FAILS, "")}


def test_a_number_that_a_case_does_not_have_is_left_out(folder):
    """A case without links has no contacts, nor has one whose links obey another law; alone it is not tested."""
    cases = {"touching": STUDY["cases"]["touching"], "alone": {"link": "none", "gap": "1 m"}}
    statement = {"holds": "impacts in elastic [impact.restitution = 0.6] > 0"}
    frame = solve(folder, statement, cases=cases, estimate="none").table("statements")
    assert (frame["case"].tolist(), frame["outcome"].tolist()) == (["touching"], [HOLDS])
    statement = {"holds": "impacts in alone elastic > 0"}
    frame = solve(folder, statement, cases=cases, estimate="none").table("statements")
    assert [verdict.word for verdict in list_verdicts(frame)] == [UNKNOWN]


@pytest.mark.parametrize(("failed", "outcome", "motions"), [([False, False], HOLDS, 1), ([False, True], UNKNOWN, 2)])
def test_a_time_history_that_failed_is_not_left_out(failed, outcome, motions):
    """Under the second of two motions there is no number; only where its time history ended does it not count."""
    comparison = parse_comparison("mu > 4", SCOPE)
    statement = Statement("a", "it yields", "", "", (comparison,), None, "each")
    margins = np.array([1.0, np.nan])
    parts = (margins + 4, np.full(2, 4.0))
    held = np.array([1.0, np.nan])
    tested = EvaluatedComparison(
        statement, comparison, parts, held, np.array(failed), margins, 0 * margins, 0 * margins
    )
    row = judge(tested, ())
    assert (row["outcome"], row["motions"]) == (outcome, motions)


def test_a_bound_within_the_numerical_error_decides_nothing(folder, results):
    """A bound closer to the number than its error, one further away, one that a small change of the motion turns."""
    (row,) = (
        solve(folder, {"holds": "drift in near elastic stiff taft [impact.restitution = 0.6] > 0 m"})
        .table("statements")
        .to_dict("records")
    )
    number, error, sensitivity = row["number"], row["error"], row["sensitivity"]
    assert 0 < error < sensitivity
    for offset, outcome, turns in (
        (0.5 * error, UNDECIDED, ERROR),
        (-0.5 * error, UNDECIDED, ERROR),
        (0.5 * sensitivity, HOLDS, SENSITIVITY),
        (-0.5 * sensitivity, FAILS, SENSITIVITY),
        (2 * sensitivity, HOLDS, ""),
    ):
        text = f"drift in near elastic stiff taft [impact.restitution = 0.6] > {float(number - offset)!r} m"
        (found,) = solve(folder, {"holds": text}).table("statements").to_dict("records")
        assert (found["outcome"], found["turns"]) == (outcome, turns), offset
        assert found["margin"] == pytest.approx(offset, rel=1e-3)


def test_a_printed_number_is_met_within_what_is_allowed(folder, results):
    rows = results.storey().query(f"{STOREYS} and building == 'stiff' and record == 'taft'")
    drift = rows["drift"].max()
    number = "drift in near elastic stiff taft [impact.restitution = 0.6]"
    for printed, within, outcome in (
        (1.009 * drift, "1 %", HOLDS), (1.012 * drift, "1 %", FAILS), (0.989 * drift, "1 %", FAILS),
        (drift + 0.9e-4, "0.1 mm", HOLDS), (drift + 1.1e-4, "0.1 mm", FAILS),
    ):  # fmt: skip
        statement = {"number": number, "is": f"{100 * float(printed)!r} cm", "within": within}
        (row,) = solve(folder, statement, estimate="none").table("statements").to_dict("records")
        assert (row["outcome"], row["printed"]) == (outcome, pytest.approx(printed))
    assert view_verdicts(solve(folder, statement)).cells()[0][1:3] == [
        format_value(drift, "m", "cm"), format_value(printed, "m", "cm")
    ]  # fmt: skip


def test_a_drift_in_percent_is_that_over_the_storey_height(folder, results):
    """Fails if a drift is read in metres, or over the height of the building."""
    rows = results.storey().query(f"{STOREYS} and building == 'stiff' and record == 'taft'")
    ratio = rows["drift"].max() / 3.0  # storeys are 3 m high unless the study writes their height
    number = "drift in near elastic stiff taft [impact.restitution = 0.6]"
    for statement, outcome in (
        ({"number": number, "is": f"{100.9 * ratio:.9f} %", "within": "1 %"}, HOLDS),
        ({"number": number, "is": f"{101.2 * ratio:.9f} %", "within": "1 %"}, FAILS),
        ({"holds": f"{number} > {99 * ratio:.9f} %"}, HOLDS),
        ({"holds": f"{number} > {101 * ratio:.9f} %"}, FAILS),
    ):
        (row,) = solve(folder, statement, estimate="none").table("statements").to_dict("records")
        assert (row["outcome"], row["number"]) == (outcome, pytest.approx(ratio))


def test_a_study_that_is_changed_has_another_verdict(folder):
    """Fails if the verdict does not come from the run."""
    statement = {"holds": "impacts in touching elastic > 0"}
    for gap, verdict in (("0 cm", HOLDS), ("3 m", FAILS)):
        cases = {"touching": {"link": "pounding", "gap": gap}}
        frame = solve(folder, statement, estimate="none", cases=cases).table("statements")
        assert [each.word for each in list_verdicts(frame)] == [verdict]


# Instants

KEPT = {
    "sweep": None,
    "group": ["stiff", "soft"],
    "cases": {"near": {"link": "pounding", "gap": "2 mm", "floors": [2]}},
    "analyses": ["elastic"],
    "records": {"use": ["elcentro"], "duration": "3 s"},
    "keep": {"histories": {"every": "1 ms"}},
    "estimate": "none",
}


def find_meetings(history) -> np.ndarray:
    """The samples at which the floors have met [s]."""
    depth = history.closing[:, 0] - 0.002
    return history.time[1:][(depth[:-1] < 0) & (depth[1:] >= 0)]


def find_most(history, values: np.ndarray, part: np.ndarray) -> float:
    """The time at which values are largest in a part of the history [s]."""
    return history.time[part][values[part].argmax()]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("displacement in soft floor 2 [1.5 s]", lambda h: np.interp(1.5, h.time, h.displacement[:, 1, 1])),
        ("time [contact 1]", lambda h: find_meetings(h)[0]),
        ("time [contact -1]", lambda h: find_meetings(h)[-1]),
        ("time [2 ms after contact 1] - time [contact 1]", lambda h: 0.002),
        ("time [contact 1] - time [3 ms before contact 1]", lambda h: 0.003),
        ("time [largest closing]", lambda h: h.time[h.closing[:, 0].argmax()]),
        (
            "time [largest link_force before 5 ms after contact 1]",
            lambda h: find_most(h, h.link_force[:, 0], h.time <= find_meetings(h)[0] + 0.005),
        ),
        (
            "time [largest closing after contact -1]",
            lambda h: find_most(h, h.closing[:, 0], h.time >= find_meetings(h)[-1]),
        ),
        (
            "time in stiff floor 2 [largest displacement after smallest displacement]",
            lambda h: find_most(h, h.displacement[:, 0, 1], h.time >= h.time[h.displacement[:, 0, 1].argmin()]),
        ),
        ("closing [largest closing]", lambda h: h.closing[:, 0].max()),
        ("link_force [largest closing]", lambda h: h.link_force[h.closing[:, 0].argmax(), 0]),
        ("0 - displacement in stiff floor 1 [smallest displacement]", lambda h: -h.displacement[:, 0, 0].min()),
        ("velocity in stiff floor 2 [1 s] / velocity in stiff floor 2 [1 s]", lambda h: 1.0),
    ],
)
def test_a_number_at_an_instant_is_that_of_the_history(folder, text, expected):
    results = solve(folder, {"holds": f"{text} > {text} / 2"}, **KEPT)
    found = results.table("statements")["number"].tolist()
    assert found == pytest.approx([expected(results.history())], rel=2e-3)


def test_an_instant_that_does_not_come_is_not_tested(folder):
    frame = solve(folder, {"holds": "time [contact 500] > 1 s"}, **KEPT).table("statements")
    assert frame["outcome"].tolist() == [UNKNOWN]


def test_a_case_without_links_has_no_instant_of_the_largest_closing(folder):
    """It is not the start of the history."""
    kept = KEPT | {"cases": KEPT["cases"] | {"apart": {"link": "none"}}}
    frame = solve(folder, {"holds": "time [largest closing] < 1 ms"}, **kept).table("statements")
    assert dict(zip(frame["case"], frame["outcome"], strict=True)) == {"near": FAILS}


def test_the_error_of_a_number_at_an_instant_is_not_known(folder):
    """It is no 0, which would be that of a number without an error."""
    (row,) = solve(folder, {"holds": "time [contact 1] > 1 ms"}, **KEPT).table("statements").to_dict("records")
    assert row["outcome"] == HOLDS
    assert math.isnan(row["error"])
    assert math.isnan(row["sensitivity"])


@pytest.mark.filterwarnings("error")
def test_floors_that_nothing_links_never_meet(folder):
    cases = {**KEPT["cases"], "alone": {"link": "none", "gap": "1 m"}}
    changes = {**KEPT, "cases": cases}
    frame = solve(folder, {"holds": "time in alone [contact 1] > 1 ms"}, **changes).table("statements")
    assert frame["outcome"].tolist() == [UNKNOWN]


def test_a_time_may_be_that_of_a_floor(folder):
    results = solve(folder, {"holds": "time in soft floor 1 [largest displacement] > 0 s"}, **KEPT)
    history = results.history()
    expected = history.time[history.displacement[:, 1, 0].argmax()]
    assert results.table("statements")["number"].tolist() == pytest.approx([expected])


# What is refused


@pytest.mark.parametrize(
    ("text", "message", "hint"),
    [
        ("mu", "is not compared", "`mu > 4`"),
        ("4 < 5", "it takes nothing from the tables", "`mu`"),
        ("1 < mu < 2 < 3", "more than one number", "`mu > 4`"),
        ("1 < mu > 0", "more than one number", "`mu > 4`"),
        ("mu in touchin > 1", "no building, case, analysis or motion 'touchin'", "did you mean 'touching'?"),
        ("mu in touching near > 1", "'near' is a second case", "write one case"),
        ("mu in pounding links > 1", "mu belongs to no link", "leave the links out"),
        ("impacts in stiff > 1", "impacts belongs to links", "`impacts`"),
        ("drift > 2", "the value has no unit", "`drift > 2 cm`"),
        ("drift > mu", "compares numbers in [-] and [m]", "one unit"),
        ("closing > 1 cm", "closing is a number of an instant", "`closing [1.1 s]`"),
        ("drift0 [1 s] > 1 cm", "no quantity over time 'drift0'", "drift"),
        ("closing [soon] > 1 cm", "[soon] is not an instant", "`[1.1 s]`"),
        ("closing [3 kN] > 1 cm", "'3 kN' is not a time", "`[1.1 s]`"),
        ("mu [impact.stiffness = 3] > 1", "'impact.stiffness' is not swept", "none is defined"),
        ("largest mean mu in stiff > 1", "of the buildings, then of their storeys", "one of the two"),
        ("mu = 3", "is not compared", "`mu > 4`"),
        ("time [contact 1] in near > 1 s", "places stand behind one `in`, before brackets", "[1.1 s]"),
        ("mu in stiff in near > 1", "places stand behind one `in`", "[1.1 s]"),
        ("period in storey 2 > 1 s", "period belongs to a building, not to a storey", "leave 'storey 2' out"),
        ("pga in storey 2 > 1 g", "pga belongs to a motion", "leave the storey out"),
        ("events in stiff > 1", "events belongs to a time history", "leave the building out"),
        ("mean pga > 1 g", "pga is one number of a motion", "over_motions"),
        ("mu in stiff softer buildings > 1", "'softer buildings' is a second building", "one building"),
        ("mu in softer buildings stiff > 1", "'stiff' is a second building", "one building"),
        ("mu in softer buildings stiffest building > 1", "is a second building", "one building"),
        ("impacts in pounding links pounding links > 1", "is a second law of links", "one law"),
        ("mean drift in stiff [1 s] > 1 cm", "'mean' is not of a number at an instant", "leave 'mean' out"),
        ("drift in stiffest building [1 s] > 1 cm", "has no numbers of an instant", "name of the building"),
        ("drift in line 1 of stiff [1 s] > 1 cm", "histories of frame lines", "leave the line out"),
        ("sway in stiff storey 2 [1 s] > 1 cm", "sway belongs to a building", "leave 'storey 2' out"),
        ("closing in stiff [1 s] > 1 cm", "closing belongs to links", "leave the building out"),
        ("closing in pounding links [1 s] > 1 cm", "closing is of all links of a case", "leave the links out"),
        ("mu > 4" + " " * 500, "506 characters are not a comparison", "`mu > 4`"),
    ],
)
def test_a_comparison_that_is_refused(text, message, hint):
    with pytest.raises(InputError) as refused:
        parse_comparison(text, SCOPE)
    assert message in refused.value.issues[0].message
    assert hint in refused.value.issues[0].hint


@pytest.mark.parametrize("name", QUANTITIES)
def test_what_a_refusal_says_to_write_is_understood(name):
    """Fails if a unit of a table is none that people may write."""
    with pytest.raises(InputError) as refused:
        parse_comparison(f"{name} > 1 Pa", SCOPE)
    parse_comparison(refused.value.issues[0].hint.split("`")[1], SCOPE)


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ({"holds": "mu > 4", "number": "mu"}, "a statement takes `holds`, or `number`, `is` and `within`"),
        ({}, "a statement takes `holds`, or `number`, `is` and `within`"),
        ({"number": "mu", "is": "4"}, "a number lacks `within`"),
        ({"number": "drift", "is": "4", "within": "1 %"}, "'4' has no unit"),
        ({"number": "mu", "is": "4", "within": "1 cm"}, "expected a plain number"),
        ({"holds": "mu [impact.restitution = 0.5] > 4"}, "the sweep has no point with impact.restitution = 0.5"),
        ({"holds": "mu in stiff storey 4 > 4"}, "the highest is 3"),
        ({"holds": ["mu > 4", "mu in stiff storey 4 > 4"]}, "statements.0.holds.1: "),
        ({"number": "mu", "is": "4", "within": "-1 %"}, "'-1 %' lies below 0"),
        ({"holds": "time [contact 1] > 1 s"}, "the study keeps no histories"),
    ],
)
def test_a_statement_that_is_refused(folder, statement, message):
    with pytest.raises(InputError) as refused:
        solve(folder, statement)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("kept", "named"),
    [
        ({"cases": ["touching"]}, "near"),
        ({"analyses": ["elastic"]}, "inelastic"),
        ({"records": ["elcentro"]}, "taft"),
    ],
)
def test_an_instant_of_a_history_that_is_not_kept_is_refused(folder, kept, named):
    """Those that a comparison leaves open are not tested; another one is."""
    keep = {"histories": {**kept, "every": "10 ms"}}
    (other,) = next(iter(kept.values()))
    with pytest.raises(InputError, match=f"rests on a history of {named}, which is not kept"):
        solve(folder, {"holds": f"drift in stiff {named} [1 s] < 1 m"}, keep=keep, estimate="none")
    frame = solve(folder, {"holds": f"drift in stiff {other} [1 s] < 1 m"}, keep=keep, estimate="none")
    assert HOLDS in set(frame.table("statements")["outcome"])


def test_two_statements_of_one_name_are_refused(folder):
    with pytest.raises(InputError, match="two statements are called 'a'"):
        solve(folder, {"holds": "mu > 4", "name": "a"}, {"holds": "mu > 5", "name": "a"})


# Statements of another file


def test_statements_of_another_study_are_taken_from_its_file(tmp_path):
    """They are tested anew where that file is changed; it must be there, and have some."""
    base = "records: {use: [elcentro], duration: 2 s}\nestimate: none\n"
    base += "buildings: {A: {storeys: 1, period: 0.3 s}, B: {storeys: 1, period: 0.5 s}}\n"
    base += "group: [A, B]\ncases: {near: {link: pounding, gap: 1 mm}}\n"
    (tmp_path / "own.yaml").write_text(base + "statements: base.yaml\n")
    for holds, verdict in (("impacts > 0", HOLDS), ("impacts < 0", FAILS)):
        (tmp_path / "base.yaml").write_text(base + f"statements: [{{says: they strike, holds: {holds}}}]\n")
        results = pound.run(tmp_path / "own.yaml", tmp_path / "own.h5", engine="serial")
        assert [each.word for each in list_verdicts(results.table("statements"))] == [verdict]
    (tmp_path / "base.yaml").write_text(base)
    with pytest.raises(InputError, match=r"base.yaml has no list of statements"):
        pound.run(tmp_path / "own.yaml", tmp_path / "own.h5", engine="serial")
    (tmp_path / "base.yaml").unlink()
    with pytest.raises(InputError, match=r"base.yaml"):
        pound.run(tmp_path / "own.yaml", tmp_path / "own.h5", engine="serial")


# What is shown


def test_the_comparison_has_a_column_a_place_and_missed_numbers_bold(folder):
    results = solve(folder, {"name": "slow", "holds": "drift in touching elastic stiff < 1 mm"}, estimate="none")
    statements = collect_statements({"a": results})
    lines = list(compare_statements(statements))
    assert "| statement | a: impact.restitution = 0.4 | a: impact.restitution = 0.6 |" in lines
    assert f"| slow | {FAILS} | {FAILS} |" in lines
    numbers = statements["number"].tolist()
    cells = " | ".join(f"**{format_value(number, 'm', 'mm')}**" for number in numbers)
    assert f"| slow: drift in touching elastic stiff < 1 mm | {cells} |" in lines
    assert not math.isnan(numbers[0])


def test_a_sensitivity_refuses_instants():
    """It keeps no histories; fails if the refusal asks to keep them, which it refuses too."""
    study = {**STUDY, "sweep": None, "sensitivity": {"statements": "all", "samples": 8}}
    study["uncertain"] = {"impact.restitution": {"uniform": {"from": 0.4, "to": 0.65}}, "motion": "any"}
    study["statements"] = [{"says": "a", "holds": "time [contact 1] > 1 s"}]
    study = {key: value for key, value in study.items() if value is not None}
    with pytest.raises(InputError, match=r"`pound sensitivity` keeps no histories"):
        Sensitivity(pound.load_study(study))


def test_a_motion_of_the_catalogue_that_the_study_does_not_use_is_not_tested(folder):
    """So that statements outlive another choice of motions; a name that nobody knows is refused."""
    statement = {"holds": ["scale in elcentro > 0", "scale in parkfield > 0"]}
    (verdict,) = list_verdicts(solve(folder, statement, estimate="none").table("statements"))
    assert [row["outcome"] for row in verdict.rows] == [HOLDS, UNKNOWN]
    with pytest.raises(InputError, match="no building, case, analysis or motion 'parkfeld' in the study"):
        solve(folder, {"holds": "scale in parkfeld > 0"})


def test_verdicts_fit_a_terminal_of_80_columns(folder):
    """As one table, in which every statement stands beside its verdict."""
    names = ("a-name-of-twenty-six-chars", "b")
    holds = [f"drift in {case} elastic stiff < 1 mm" for case in ("touching", "near")]
    statements = [{"name": name, "holds": holds, "over_motions": "each"} for name in names]
    lines = view_verdicts(solve(folder, *statements, estimate="none")).to_text(80).splitlines()
    assert max(map(len, lines)) <= 80
    for name in names:
        assert any(name in line and FAILS in line for line in lines), name


def test_the_number_shown_is_that_of_the_smallest_margin(folder):
    """Of an upper limit that is the largest."""
    results = solve(folder, {"holds": "drift in stiff < 1 m"}, estimate="none")
    frame = results.table("statements")
    ((_, number, *_),) = view_verdicts(results).cells()
    assert number == format_value(frame["number"].max(), "m", "m")
    assert frame["number"].max() > frame["number"].min()


def test_a_count_has_no_error_by_shares(folder):
    """A number of contacts that is the bound itself decides, though every peak has a numerical error."""
    where = "in touching elastic elcentro [impact.restitution = 0.6]"
    (row,) = solve(folder, {"holds": f"impacts {where} > 0"}).table("statements").to_dict("records")
    (same,) = solve(folder, {"holds": f"impacts {where} >= {row['number']:.0f}"}).table("statements").to_dict("records")
    assert (same["outcome"], same["error"], same["margin"]) == (HOLDS, 0.0, 0.0)


@pytest.mark.parametrize(
    ("margins", "errors", "sensitivities", "outcome", "turns"),
    [
        ([1.0, 2.0], [0.1, 0.1], [0.5, 0.5], HOLDS, ""),
        ([1.0, 2.0], [0.1, 3.0], [0.5, 0.5], UNDECIDED, ERROR),  # not that of the smallest margin
        ([1.0, 2.0], [0.1, 0.1], [0.5, 3.0], HOLDS, SENSITIVITY),
        ([-1.0, 2.0], [0.1, 3.0], [0.5, 0.5], FAILS, ""),  # one motion misses it, whatever the other does
        ([-1.0, -2.0], [0.1, 0.1], [3.0, 0.5], FAILS, ""),
        ([-1.0, -2.0], [0.1, 0.1], [3.0, 3.0], FAILS, SENSITIVITY),
        ([-1.0, 2.0], [3.0, 0.1], [0.5, 0.5], UNDECIDED, ERROR),
        ([1.0, 2.0], [np.nan, np.nan], [np.nan, np.nan], HOLDS, ""),
        ([1.0, np.nan], [0.1, 0.1], [0.5, 0.5], UNKNOWN, ""),
    ],
)
def test_what_several_motions_decide(margins, errors, sensitivities, outcome, turns):
    comparison = parse_comparison("mu > 4", SCOPE)
    statement = Statement("a", "it yields", "", "", (comparison,), None, "each")
    found, error, sensitivity = map(np.array, (margins, errors, sensitivities))
    held = np.where(np.isnan(found), np.nan, found > 0)
    parts = (found + 4, np.full(2, 4.0))
    failed = np.isnan(found)
    row = judge(EvaluatedComparison(statement, comparison, parts, held, failed, found, error, sensitivity), ())
    assert (row["outcome"], row["turns"]) == (outcome, turns)

"""What a reader of `pound fragility` sees: sentences, tables, notes, and the data in the axes of figures."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner
from matplotlib.colors import to_hex

import pounding_cli as pound
from pounding_cli.cli.main import cli
from pounding_cli.questions.fragility import figures, words
from pounding_cli.results.results import ResultTables
from pounding_cli.tables import Table

G = 9.80665
ALONE = "alone"
POUNDING = "with pounding"
GREY = "#777777"

STUDY: dict[str, Any] = {
    "title": "Two small buildings",
    "records": {
        "use": ["elcentro", "taft", "eureka", "olympia", "parkfield"],
        "duration": "4 s",
        "scale": {"pga": "1 g"},
    },
    "buildings": {"stiff": {"storeys": 2, "period": "0.36 s"}, "soft": {"like": "stiff", "period": "0.6 s"}},
    "group": ["stiff", "soft"],
    "cases": {"near": {"link": "pounding", "gap": "1 cm"}},
    "analyses": ["inelastic"],
    "estimate": "none",
    "sweep": {"records.scale.pga": {"from": "0.02 g", "to": "1.2 g", "step": "0.02 g"}},
}
HAZARD = {"0.05 g": 0.02, "0.3 g": "1/475", "1 g": 1e-4}


def solve(folder: Path, hazard: Any = HAZARD, records: int = 5, **section: Any) -> pound.Results:
    """Return the answer of the study, with other keys of its section `fragility`."""
    motions = STUDY["records"] | {"use": STUDY["records"]["use"][:records]}
    asked = {"limits": ["mu > 3", "contact"]} | ({"hazard": hazard} if hazard else {}) | section
    study = STUDY | {"records": motions, "fragility": asked}
    return pound.run(study, folder / "f.h5", workflow="fragility", engine="serial")


@pytest.fixture(scope="module")
def ida(tmp_path_factory: pytest.TempPathFactory) -> pound.Results:
    return solve(tmp_path_factory.mktemp("ida"))


def with_rows(results: pound.Results, name: str, rows: list[dict[str, Any]]) -> ResultTables:
    """Return the results with these rows in one of their tables; columns that rows do not have are empty."""
    answers = {each: results.answer(each) for each in results.answers}
    old = answers[name]
    columns = [column.name for column in old.columns]
    counts = {"motions", "histories", "failed", "undecided", "undecided_motions"}
    frame = pd.DataFrame(rows).reindex(columns=columns)
    frame = frame.fillna({column: 0 for column in counts & set(columns)})
    answers[name] = Table(name, frame, old.columns, old.caption)
    return ResultTables(results.path, results.arrays, answers.values())


# Sentences

PLACE = {"case": "near", "analysis": "inelastic", "limit": "mu > 3", "building": "soft", "motions": 5}


def fitted(median: float, low: float = np.nan, high: float = np.nan, **further: Any) -> dict[str, Any]:
    """Return the columns of a fitted curve; intensities in g."""
    ends = {"median_low": low * G, "median_high": high * G}
    return {"outcome": "fitted", "median": median * G, "low": median * G, "high": median * G, **ends, **further}


def unfitted(outcome: str, low: float = 0.0, high: float = np.inf, **further: Any) -> dict[str, Any]:
    """Return the columns of a curve without a median; intensities in g."""
    return {"outcome": outcome, "low": low * G, "high": high * G, **further}


def ratio(value: float, low: float = np.nan, high: float = np.nan) -> dict[str, float]:
    return {"ratio": value, "ratio_low": low, "ratio_high": high}


FEW = {"motions": 4}
UNDECIDED = {"undecided_motions": 3, "motions": 4}
SENTENCES = {
    "a weaker motion is enough": (
        fitted(0.38),
        fitted(0.31) | ratio(0.816, 0.7, 0.95),
        "with pounding a motion 0.816 times as strong is enough (90 % interval 0.700 to 0.950; median capacity 0.310 g "
        "in place of 0.380 g).",
    ),
    "it takes a stronger motion": (
        fitted(0.31),
        fitted(0.38) | ratio(1.226, 1.053, 1.43),
        "with pounding it takes a motion 1.23 times as strong (90 % interval 1.05 to 1.43; median capacity 0.380 g "
        "in place of 0.310 g).",
    ),
    "an upper end that is not known": (
        fitted(0.31),
        fitted(0.38) | ratio(1.226, 1.053, np.inf),
        "with pounding it takes a motion 1.23 times as strong (90 % interval above 1.05; median capacity 0.380 g "
        "in place of 0.310 g).",
    ),
    "not significant, below": (
        fitted(0.38),
        fitted(0.31) | ratio(0.816, 0.6, 1.05),
        "the difference is not significant with 5 motions (median capacity 0.310 g with pounding, 0.380 g alone; "
        "factor 0.816, 90 % interval 0.600 to 1.05).",
    ),
    "not significant, above": (
        fitted(0.31),
        fitted(0.38) | ratio(1.226, 0.952, 1.67),
        "the difference is not significant with 5 motions (median capacity 0.380 g with pounding, 0.310 g alone; "
        "factor 1.23, 90 % interval 0.952 to 1.67).",
    ),
    "few motions": (
        fitted(0.38) | FEW,
        fitted(0.31) | ratio(0.816) | FEW,
        "the difference is not significant with 4 motions (median capacity 0.310 g with pounding, 0.380 g alone; "
        "factor 0.816, no interval from fewer than 5 motions).",
    ),
    "no difference": (
        fitted(0.31),
        fitted(0.31) | ratio(1.0, 1.0, 1.0),
        "pounding makes no difference in three digits (median capacity 0.310 g).",
    ),
    "never passed alone": (
        unfitted("never passed", low=2.0),
        fitted(0.5, 0.4, 0.6),
        "with pounding median capacity 0.500 g (90 % interval 0.400 to 0.600 g); alone never passed (median capacity "
        "above 2.00 g).",
    ),
    "never passed with pounding": (
        fitted(0.5, 0.4, 0.6),
        unfitted("never passed", low=2.0),
        "with pounding never passed (median capacity above 2.00 g); alone median capacity 0.500 g (90 % interval 0.400 "
        "to 0.600 g).",
    ),
    "undecided with pounding": (
        unfitted("always passed", high=0.1),
        unfitted("undecided", 0.3, 0.7) | UNDECIDED,
        "with pounding undecided in 3 of 4 motions (median capacity 0.300 to 0.700 g); alone always passed (median "
        "capacity below 0.100 g).",
    ),
    "undecided alone": (
        unfitted("undecided", 0.3, 0.7) | UNDECIDED,
        unfitted("always passed", high=0.1),
        "with pounding always passed (median capacity below 0.100 g); alone undecided in 3 of 4 motions (median "
        "capacity 0.300 to 0.700 g).",
    ),
    "alike without a curve": (
        unfitted("no trend"),
        unfitted("no trend"),
        "no trend: stronger motions do not pass more often, alone and with pounding.",
    ),
    "with pounding only": (
        None,
        fitted(0.12, 0.1, 0.2),
        "median capacity 0.120 g (90 % interval 0.100 to 0.200 g).",
    ),
}


@pytest.mark.parametrize("name", SENTENCES)
def test_a_sentence_has_its_direction_and_its_numbers(ida, name):
    """Fails if "stronger" stands for "weaker", or the number of one state for that of the other."""
    alone, pounding, expected = SENTENCES[name]
    rows = [PLACE | {"state": ALONE} | alone] if alone else []
    results = with_rows(ida, "fragility", [*rows, PLACE | {"state": POUNDING} | pounding])
    results.answers = ("fragility",)
    assert words.list_sentences(results) == [
        f"soft, ductility above 3: {expected}",
        "Intensity measure: peak ground acceleration.",
    ]


RATE_SENTENCES = {
    "more often": (
        {"rate": 0.004},
        {"rate": 0.008, "rate_ratio": 2.0, "rate_ratio_low": 1.5, "rate_ratio_high": 2.5},
        "Annual rate 0.00800 (once in 125 years) with pounding, 0.00400 (once in 250 years) alone: 2.00 times as often "
        "(90 % interval 1.50 to 2.50).",
    ),
    "less often": (
        {"rate": 0.008},
        {"rate": 0.004, "rate_ratio": 0.5, "rate_ratio_low": 0.4, "rate_ratio_high": 0.667},
        "Annual rate 0.00400 (once in 250 years) with pounding, 0.00800 (once in 125 years) alone: 0.500 times as "
        "often (90 % interval 0.400 to 0.667).",
    ),
    "not significant": (
        {"rate": 0.004},
        {"rate": 0.008, "rate_ratio": 2.0, "rate_ratio_low": 0.9, "rate_ratio_high": 2.5},
        "Annual rate 0.00800 (once in 125 years) with pounding, 0.00400 (once in 250 years) alone: a difference that "
        "is not significant with 5 motions.",
    ),
    "with pounding only": (None, {"rate": 0.01}, "Annual rate 0.0100 (once in 100 years) with pounding."),
    "no curve alone": ({}, {"rate": 0.01}, "Annual rate 0.0100 (once in 100 years) with pounding."),
    "no curve with pounding": ({"rate": 0.01}, {}, "Annual rate 0.0100 (once in 100 years) alone."),
}


@pytest.mark.parametrize("name", RATE_SENTENCES)
def test_a_rate_has_its_direction_and_its_numbers(ida, name):
    alone, pounding, expected = RATE_SENTENCES[name]
    curves = [PLACE | {"state": ALONE} | fitted(0.3)] if alone is not None else []
    curves.append(PLACE | {"state": POUNDING} | fitted(0.3) | ratio(1.0, 1.0, 1.0))
    rates = [PLACE | {"state": ALONE} | alone] if alone is not None else []
    rates.append(PLACE | {"state": POUNDING} | pounding)
    results = with_rows(with_rows(ida, "fragility", curves), "fragility_rates", rates)
    assert words.list_sentences(results)[0].endswith(f". {expected}")


@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        ("mu > 4", "ductility above 4"),
        ("mu in soft > 4", "ductility above 4"),
        ("mu in soft storey 2 > 4", "ductility of storey 2 above 4"),
        ("drift > 2 %", "interstorey drift above 2 % of the storey height"),
        ("drift_ratio in soft > 0.02", "interstorey drift above 2 % of the storey height"),
        ("drift in soft > 6 cm", "interstorey drift above 6 cm"),
        ("drift > 2 in", "interstorey drift above 2 in"),
        ("mu in line 1 of soft > 3", "ductility of line 1 above 3"),
        (
            "drift in line 2 of soft storey 2 > 1 %",
            "interstorey drift of line 2 in storey 2 above 1 % of the storey height",
        ),
        ("edge_drift in soft > 2 %", "interstorey drift of either edge above 2 % of the storey height"),
        ("twist in soft floor 2 > 0.01 rad", "rotation of floor 2 above 0.01 rad"),
        ("acceleration in soft floor 2 > 1 g", "acceleration of floor 2 above 1 g"),
        ("acceleration > 1 g", "floor acceleration above 1 g"),
        ("shear_demand > 1", "shear demand of columns above 1"),
        ("contact", "contact"),
        ("collapse in soft", "collapse"),
    ],
)
def test_a_limit_in_words(limit, expected):
    assert words.describe_limit(limit, ("stiff", "soft")) == expected


def test_limits_of_lines_and_edges_are_those_of_the_results(tmp_path):
    """Fails if a limit takes another line, edge, storey or building, or the centre of mass for an edge."""
    plan = {"width": "16 m", "depth": "12 m", "eccentricity": "10 %", "frequency_ratio": 1.1}
    soft = STUDY["buildings"]["soft"] | {"plan": plan}
    limits = {
        "mu in line 1 of soft > 3": ("line_mu", 3.0, 0),
        "mu in line 2 of soft > 3": ("line_mu", 3.0, 1),
        "edge_drift in soft storey 1 > 1 cm": ("edge_drift", 0.01, None),
        "drift in soft storey 1 > 1 cm": ("drift", 0.01, None),
        "twist in soft > 0.001 rad": ("twist", 0.001, None),
    }
    study = STUDY | {
        "buildings": STUDY["buildings"] | {"soft": soft},
        "records": STUDY["records"] | {"use": ["taft", "elcentro"]},
        "sweep": {"records.scale.pga": ["0.2 g", "0.5 g"]},
        "fragility": {"limits": list(limits), "method": "cloud"},
    }
    results = pound.run(study, tmp_path / "f.h5", workflow="fragility", engine="serial")
    motions = results.table("fragility_motions")
    different = set()
    for limit, (name, value, line) in limits.items():
        rows = motions[motions["limit"] == limit]
        for state, suffix in ((POUNDING, ""), (ALONE, "0")):
            peaks = results.arrays[f"{name}{suffix}"].values[:, 0, 0, :, 1]  # intensities, motions, storeys (, lines)
            peaks = peaks if line is None else peaks[..., line]
            peaks = peaks[..., 0] if "storey 1" in limit else peaks.max(axis=2)
            demands = rows[rows["state"] == state]["demand"].to_numpy()
            np.testing.assert_allclose(np.sort(demands), np.sort(peaks.ravel()) / value, rtol=1e-12)
            different.add(round(float(peaks[0, 0] / value), 6))
    assert len(different) > len(limits)
    sentences = words.list_sentences(results)
    assert any("soft, interstorey drift of storey 1 at the centre of mass above 1 cm" in each for each in sentences)


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        ("mu in line 3 of soft > 3", "soft has lines 1 to 2"),
        ("mu in line 1 of stiff > 3", "stiff has no plan"),
    ],
)
def test_limits_of_lines_that_are_not_there_are_refused(tmp_path, limit, message):
    plan = {"width": "16 m", "depth": "12 m", "eccentricity": "10 %", "frequency_ratio": 1.1}
    soft = STUDY["buildings"]["soft"] | {"plan": plan}
    study = STUDY | {"buildings": STUDY["buildings"] | {"soft": soft}, "fragility": {"limits": [limit]}}
    with pytest.raises(pound.InputError, match=message):
        pound.run(study, tmp_path / "f.h5", workflow="fragility", engine="serial")


def test_case_analysis_and_point_stand_in_a_sentence_where_they_vary(ida):
    curves = [
        PLACE | {"state": POUNDING, "case": case, "analysis": analysis} | fitted(0.1)
        for case in ("near", "far")
        for analysis in ("elastic", "inelastic")
    ]
    results = with_rows(ida, "fragility", curves)
    results.answers = ("fragility",)
    assert words.list_sentences(results)[1].startswith("soft, ductility above 3, case near, inelastic storeys: median")
    assert words.list_sentences(results)[2].startswith("soft, ductility above 3, case far, elastic storeys: median")


def test_of_many_curves_the_table_tells_the_rest(ida):
    curves = [PLACE | {"state": POUNDING, "limit": f"mu > {number}"} | fitted(0.1) for number in range(1, 31)]
    results = with_rows(ida, "fragility", curves)
    results.answers = ("fragility",)
    sentences = words.list_sentences(results)
    assert len(sentences) == 24 + 2
    assert sentences[-2] == "The table has 6 more limits and buildings."


# Tables


@pytest.mark.parametrize("width", [80, 120, 200])
def test_tables_fit_the_terminal(ida, width):
    """Fails if a line is wider than the terminal, a cell is cut, or an interval is on two lines."""
    curves = [
        PLACE | {"state": ALONE} | unfitted("undecided", 0.3, 0.7) | UNDECIDED,
        PLACE | {"state": POUNDING} | fitted(0.1234, 0.1114, 0.2345) | ratio(0.8161, 0.7112, 0.9514),
    ]
    results = with_rows(ida, "fragility", curves)
    for table in [*words.list_tables(ida), *words.list_tables(results)]:
        text = table.to_text(width)
        assert max(map(len, text.splitlines())) <= width
        assert "…" not in text
        intervals = len(re.findall(r"\(\S+ to \S+\)", text))
        columns = [column for column in table.columns if column.low and column.head not in _left_out(text)]
        frame = table.frame
        assert intervals == sum(int((frame[c.name].notna() & frame[c.low].notna()).sum()) for c in columns) > 0
    medians = words.list_tables(results)[0].to_text(width)
    assert "undecided in 3 of 4" in " ".join(medians.split())
    assert "0.123 (0.111 to 0.234)" in medians
    assert "0.816 (0.711 to 0.951)" in medians or "ratio to alone" in _left_out(medians)
    assert ("spread" in _left_out(medians)) == (width == 80)


def _left_out(text: str) -> str:
    """Return what the line below a table says of columns that are left out; "" without one."""
    return " ".join(text.split()).partition("Left out")[2]


def test_the_tables_hold_the_two_states_in_rows(ida):
    """Every table tells alone from with pounding by its column `state`; the pair in contact has no building alone."""
    for name in ("fragility", "fragility_motions", "fragility_curves", "fragility_rates", "fragility_contributions"):
        frame = ida.table(name)
        assert not [column for column in frame.columns if str(column).endswith("0")]
        states = frame.groupby("limit")["state"].unique()
        assert list(states["mu > 3"]) == [ALONE, POUNDING]
        assert list(states["contact"]) == [POUNDING]
    curves = ida.table("fragility")
    alone = curves["state"] == ALONE
    assert curves.loc[alone, "ratio"].isna().all()
    medians = curves[curves["limit"] == "mu > 3"].pivot_table("median", "building", "state")
    ratios = curves[~alone & (curves["limit"] == "mu > 3")].set_index("building")["ratio"]
    np.testing.assert_allclose(ratios, (medians[POUNDING] / medians[ALONE])[ratios.index], rtol=1e-12)


def test_shown_tables_have_an_interval_in_one_cell(ida):
    """Fails if `pound show` prints the ends of an interval a second time, or CSV leaves them out."""
    shown = CliRunner().invoke(cli, ["show", str(ida.path), "fragility"]).output
    assert "median_low" not in shown
    row = ida.table("fragility").iloc[0]
    median, low = (f"{row[name] / G:#.4g}" for name in ("median", "median_low"))
    assert f"{median} ({low} to " in shown
    csv = CliRunner().invoke(cli, ["show", str(ida.path), "fragility", "--format", "csv"]).output
    assert {"median", "median_low", "median_high", "ratio_low", "ratio_high"} <= set(csv.splitlines()[0].split(","))


# Notes


@pytest.mark.parametrize(
    ("note", "raising", "other"),
    [
        ("No interval for fewer than 5 motions: 4 motions", {"records": 4}, {"records": 5}),
        ("In brackets: 90 % interval of 1000 bootstrap draws", {"records": 5}, {"records": 4}),
        ("of a rate comes from intensities beyond the last one", {"hazard": {"0.01 g": 0.1, "0.02 g": 0.09}}, {}),
    ],
)
def test_a_note_stands_where_it_is_due_and_nowhere_else(ida, tmp_path, note, raising, other):
    (tmp_path / "other").mkdir()
    assert any(note in each for each in words.list_notes(solve(tmp_path, **raising)))
    assert not any(note in each for each in words.list_notes(solve(tmp_path / "other", **other) if other else ida))


def test_failed_and_undecided_time_histories_are_counted_in_notes(ida):
    rows = [
        PLACE | {"state": state, "undecided": 2, "undecided_motions": 1} | fitted(0.3) for state in (ALONE, POUNDING)
    ]
    results = with_rows(ida, "fragility", rows)
    results.attrs["scenes_failed"] = 3
    told = " ".join(words.list_notes(results))
    assert "3 time histories failed: counted neither as holding nor as passing." in told
    assert "4 time histories ended with a collapse before the limit was passed" in told
    assert "2 motions are undecided" in told
    without = " ".join(words.list_notes(ida))
    assert not re.search("failed|collapse|undecided", without)


# Figures


def panels_of(figure: Any) -> dict[str, Any]:
    """Return the axes of a figure by their title."""
    return {ax.get_title(loc="left"): ax for ax in figure.axes}


def lines_of(ax: Any) -> dict[str, Any]:
    """Return the labelled lines of a panel."""
    return {line.get_label(): line for line in ax.lines if not str(line.get_label()).startswith("_")}


def markers_of(ax: Any, color: str) -> np.ndarray:
    """Return x and y of the markers of one colour, shape (n, 2); empty without any."""
    lines = [line for line in ax.lines if line.get_linestyle() == "None" and to_hex(line.get_color()) == color.lower()]
    return np.concatenate([line.get_xydata() for line in lines]) if lines else np.zeros((0, 2))


def rows_of(results: pound.Results, name: str, limit: str, building: str, state: str) -> pd.DataFrame:
    frame = results.table(name)
    return frame[(frame["limit"] == limit) & (frame["building"] == building) & (frame["state"] == state)]


def test_the_figure_of_curves_shows_the_tables(ida):
    """Fails if the intensity is in another unit, a state or a building stands for the other, or the ends of a band are
    swapped or those of another curve."""
    (picture, _) = figures.list_figures(ida)
    figure = picture.draw()
    panels = panels_of(figure)
    assert list(panels) == ["stiff, mu > 3", "soft, mu > 3", "stiff|soft, contact"]
    for title, ax in panels.items():
        building, limit = title.split(", ")
        assert ax.get_xlabel() == "peak ground acceleration [g]"
        lines = lines_of(ax)
        states = (
            {"alone": ALONE, "with pounding: near": POUNDING}
            if limit == "mu > 3"
            else {"with pounding: near": POUNDING}
        )
        assert list(lines) == list(states)
        assert len(ax.collections) == len(states)
        for (label, state), band in zip(states.items(), ax.collections, strict=True):
            line = lines[label]
            color = to_hex(line.get_color())
            assert (color == GREY) == (state == ALONE)
            points = rows_of(ida, "fragility_curves", limit, building, state)
            x = points["intensity"].to_numpy() / G
            np.testing.assert_allclose(line.get_xdata(), x, rtol=1e-12)
            np.testing.assert_allclose(line.get_ydata(), points["probability"], rtol=1e-12)
            assert to_hex(band.get_facecolor()[0]) == color
            outline = {tuple(each) for each in np.round(band.get_paths()[0].vertices, 9)}
            for end in ("probability_low", "probability_high"):
                assert outline >= {tuple(each) for each in np.round(np.column_stack([x, points[end]]), 9)}
            motions = rows_of(ida, "fragility_motions", limit, building, state)
            passed = np.sort(motions["passed"].to_numpy()) / G
            assert np.isfinite(passed).all()
            markers = markers_of(ax, color)
            assert sorted(markers[:, 0]) == pytest.approx(sorted(set(passed[passed <= ax.get_xlim()[1]])))
            for x_marker, share in markers:
                assert share == pytest.approx((passed <= x_marker + 1e-9).mean())
    assert "Bands: 90 % of 1000 bootstrap draws" in figure.get_label()


def test_the_markers_of_stripes_are_the_shares_that_pass(tmp_path):
    results = solve(tmp_path, hazard=None, method="stripes", limits=["mu > 3"])
    (picture,) = figures.list_figures(results)
    for title, ax in panels_of(picture.draw()).items():
        building = title.split(", ")[0]
        for line in lines_of(ax).values():
            state = ALONE if line.get_label() == ALONE else POUNDING
            motions = rows_of(results, "fragility_motions", "mu > 3", building, state)
            shares = motions.groupby("intensity")["demand"].agg(lambda demand: (demand > 1).mean())
            markers = markers_of(ax, to_hex(line.get_color()))
            assert len(markers) > 3
            for x, share in markers:
                nearest = int(np.argmin(np.abs(shares.index.to_numpy() / G - x)))
                assert shares.index[nearest] / G == pytest.approx(x)
                assert shares.iloc[nearest] == pytest.approx(share)


def test_a_curve_that_there_is_none_of_is_written_in_its_panel(ida):
    """Fails if the reason stands in the panel of another building, or in the colour of the other state."""
    rows = ida.table("fragility").to_dict("records")
    for row in rows:
        if (row["building"], row["state"]) == ("soft", ALONE):
            row |= {"median": np.nan} | unfitted("never passed", low=1.2)
    results = with_rows(ida, "fragility", rows)
    panels = panels_of(figures.list_figures(results)[0].draw())
    texts = {title: [(text.get_text(), to_hex(text.get_color())) for text in ax.texts] for title, ax in panels.items()}
    assert texts == {
        "stiff, mu > 3": [],
        "soft, mu > 3": [("alone: never passed: above 1.20", GREY)],
        "stiff|soft, contact": [],
    }


def test_the_figure_of_rates_shows_the_contributions(ida):
    (_, picture) = figures.list_figures(ida)
    panels = panels_of(picture.draw())
    assert list(panels) == ["stiff, mu > 3", "soft, mu > 3", "stiff|soft, contact"]
    for title, ax in panels.items():
        building, limit = title.split(", ")
        assert (ax.get_xlabel(), ax.get_xscale()) == ("peak ground acceleration [g]", "log")
        lines = lines_of(ax)
        assert list(lines) == (["alone", "with pounding: near"] if limit == "mu > 3" else ["with pounding: near"])
        for label, line in lines.items():
            state = ALONE if label == "alone" else POUNDING
            assert (to_hex(line.get_color()) == GREY) == (state == ALONE)
            parts = rows_of(ida, "fragility_contributions", limit, building, state)
            x = np.sqrt(parts["from"] * parts["to"]) / G
            np.testing.assert_allclose(line.get_xdata(), x, rtol=1e-12)
            np.testing.assert_allclose(
                line.get_ydata(), parts["rate"] / np.log(parts["to"] / parts["from"]), rtol=1e-12
            )

"""Results of buildings whose floors twist: frame lines, edges, contact by place, in tables, sentences, expressions,
histories and files."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import pounding_cli as pound
from pounding_cli.cli.results import _iter_changes
from pounding_cli.errors import InputError
from pounding_cli.questions.expressions import evaluate_error, evaluate_expression, find_twist_problem
from pounding_cli.questions.run.ranking import rank_cases
from pounding_cli.questions.run.words import list_notes, list_sentences, list_tables
from pounding_cli.report.evidence import find_nominal
from pounding_cli.results.arrays import ResultArrays
from pounding_cli.results.compare import compare
from pounding_cli.results.export import export
from pounding_cli.results.pelicun import demands
from pounding_cli.results.plausible import implausible_results
from pounding_cli.results.results import ResultTables
from pounding_cli.study.expressions.comparison import parse_comparison
from pounding_cli.study.expressions.expression import Scope, parse_expression
from pounding_cli.study.expressions.limits import parse_limit

STUDY = """\
title: End of a row
records: {use: [elcentro, taft], duration: 3 s}
buildings:
  corner:
    mass: [200 t, 150 t]
    height: 3 m
    plan:
      width: 20 m
      depth: 10 m
      torsional_stiffness: [2 GN m, 1.2 GN m]
      lines:
        - {y: -10 m, stiffness: [110 kN/mm, 70 kN/mm], yield_shear: [420 kN, 260 kN]}
        - {y: 4 m, stiffness: [60 kN/mm, 45 kN/mm], yield_shear: [210 kN, 140 kN]}
      across:
        - {x: -6 m, stiffness: [3 kN/mm, 2 kN/mm], yield_shear: [9 kN, 6 kN]}
        - {x: 6 m, stiffness: [3 kN/mm, 2 kN/mm], yield_shear: [9 kN, 6 kN]}
  soft: {storeys: 2, period: 0.5 s}
group: [corner, soft]
cases: {touching: {link: pounding, gap: 5 mm}, apart: {link: pounding, gap: 90 cm}}
sweep: {impact.restitution: [0.5, 0.8]}
keep: {histories: {cases: [touching], analyses: [elastic], records: [taft], where: {impact.restitution: 0.8}}}
accuracy: 1e-8
residual_drift: true
"""
BALANCED = """\
records: {use: [taft], duration: 3 s}
buildings:
  even: {storeys: 2, period: 0.4 s, plan: {width: 20 m, depth: 10 m, eccentricity: 0 %, frequency_ratio: 1.1}}
  soft: {storeys: 2, period: 0.5 s}
group: [even, soft]
cases: {touching: {link: pounding, gap: 5 mm}}
analyses: [inelastic]
residual_drift: true
"""
BUILDINGS = ("corner", "soft")
ROW = ["impact.restitution", "case", "analysis", "record", "building", "storey"]


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> ResultTables:
    path = tmp_path_factory.mktemp("twist") / "twist.yaml"
    path.write_text(STUDY)
    return pound.run(path, path.with_suffix(".h5"), engine="serial")


@pytest.fixture(scope="module")
def corner(results) -> pd.DataFrame:
    """The rows of storeys of the building that twists."""
    storey = results.storey()
    return storey[storey["building"] == "corner"].reset_index(drop=True)


def test_storeys_are_those_of_their_lines(results, corner):
    """Fails if lines are mixed up with storeys, or a storey has the demand of another line."""
    line = results.line()
    assert len(line) == 4 * len(corner)
    assert line.query("line > 2")["x"].tolist() == [-6.0, 6.0] * len(corner)
    line = line[line["street"].notna()]
    by_storey = line.groupby(ROW, sort=False)
    for name in ("mu", "mu0"):
        assert corner[name].to_numpy() == pytest.approx(by_storey[name].max().to_numpy(), rel=1e-12)
    assert (corner["V"].to_numpy() <= by_storey["V"].sum().to_numpy() * (1 + 1e-9)).all()
    elastic = line[line["analysis"] == "elastic"]
    assert elastic["V"].to_numpy() == pytest.approx((elastic["stiffness"] * elastic["drift"]).to_numpy(), rel=1e-6)
    assert line["drift_ratio"].to_numpy() == pytest.approx(line["drift"].to_numpy() / 3.0)
    assert line["V_ratio"].to_numpy() == pytest.approx((line["V"] / line["V0"]).to_numpy())


def test_edges_of_the_plan(results, corner):
    """The first line stands at the low edge, the high one follows from drift and twist over time."""
    first = results.line("drift", "drift0", "street").query("line == 1")
    assert (first["street"] == -10.0).all()
    assert corner["edge_drift_low"].to_numpy() == pytest.approx(first["drift"].to_numpy(), rel=1e-6)
    assert corner["edge_drift_low0"].to_numpy() == pytest.approx(first["drift0"].to_numpy(), rel=1e-6)
    larger = np.maximum(corner["edge_drift_low"], corner["edge_drift_high"])
    assert corner["edge_drift"].to_numpy() == pytest.approx(larger.to_numpy())
    assert corner["edge_drift_ratio"].to_numpy() == pytest.approx(larger.to_numpy() / 3.0)
    history = results.history()
    turn = np.diff(history.twist[:, 0], axis=1, prepend=0.0)
    at_high_edge = np.abs(history.drift[:, 0] - 10.0 * turn).max(axis=0)
    row = corner.query(
        "case == 'touching' and analysis == 'elastic' and record == 'taft' and `impact.restitution` == 0.8"
    )
    assert at_high_edge == pytest.approx(row["edge_drift_high"].to_numpy(), rel=5e-3)
    other = results.storey().query("building == 'soft'")
    assert np.array_equal(other["edge_drift"], other["drift"])
    assert results.floor().query("building == 'soft'")["twist"].isna().all()


def test_lines_over_time(results):
    """The elastic shear of a line is its stiffness times its drift, at any time, and lines add up to the storey."""
    history = results.history()
    line = results.line("stiffness").drop_duplicates(["storey", "line"])
    stiffness = line["stiffness"].to_numpy().reshape(2, 4)
    assert history.line_shear[:, 0] == pytest.approx(stiffness * history.line_drift[:, 0], rel=1e-5, abs=1.0)
    assert history.line_shear[:, 0, :, :2].sum(axis=-1) == pytest.approx(history.shear[:, 0], rel=1e-5, abs=1.0)
    assert list(history.frame("line_drift").columns) == [("corner", n, i) for n in (1, 2) for i in (1, 2, 3, 4)]
    assert history.frame("twist").columns.tolist() == [("corner", 1), ("corner", 2)]
    largest = history.largest().loc["line_shear"]
    assert largest.index.str.match(r"corner, storey 1, line \d").all()


def test_means_of_ratios_of_lines(results):
    line = results.line()
    means = results.values("line_V_ratio_mean")
    assert means.shape == (2, 2, 2, 2, 2, 4)
    rows = line.query("case == 'touching' and analysis == 'inelastic' and storey == 2 and line == 2")
    by_hand = rows.groupby("impact.restitution")["V_ratio"].mean().to_numpy()
    assert means[:, 0, 1, 0, 1, 1] == pytest.approx(by_hand)
    assert np.isfinite(results.values("line_mu_ratio_mean_error")[:, 0, 1, 0]).all()


STRUCK = """\
records: {use: [taft], duration: 3 s}
buildings:
  low: {storeys: 2, period: 0.25 s, height: 3 m, slab: 20 cm, columns: 20 %}
  high: {storeys: 2, period: 0.60 s, height: 4 m, slab: 20 cm, columns: 25 %}
group: [low, high]
cases: {touching: {link: pounding, gap: 5 mm}}
analyses: [elastic]
"""


def test_struck_columns_by_place(tmp_path):
    """Columns of one storey are struck at both ends of the edge; a study without a plan has no such column."""
    plan = "plan: {width: 20 m, depth: 10 m, shift: 1 m, eccentricity: 10 %, frequency_ratio: 1.1}"
    tables = []
    for name, text in (("twisting", STRUCK.replace("columns: 25 %", f"columns: 25 %, {plan}")), ("plain", STRUCK)):
        path = tmp_path / f"{name}.yaml"
        path.write_text(text)
        tables.append(pound.run(path, path.with_suffix(".h5"), engine="serial").struck())
    twisting, plain = tables
    assert twisting.groupby(["building", "storey"])["street"].apply(list).tolist() == [[-9.0, 11.0]] * 3
    assert [*twisting.columns].index("street") == [*twisting.columns].index("at") + 1
    assert [*plain.columns] == [name for name in twisting.columns if name != "street"]


def test_contact_by_place(results):
    """Both ends of the edge that the floors share; soft has no plan and ends where corner does."""
    link = results.link().query("case == 'touching' and `impact.restitution` == 0.8 and record == 'taft'")
    assert link.query("analysis == 'elastic'")["street"].tolist() == [-10.0, 10.0] * 2
    table = next(each for each in list_tables(results) if each.caption.startswith("Contact by place"))
    row = table.frame.query("case == 'touching' and analysis == 'elastic' and street == 10").iloc[0]
    nominal = results.link().query(
        "case == 'touching' and `impact.restitution` == 0.5 and analysis == 'elastic' and street == 10"
    )
    assert row["peak_force"] == nominal["peak_force"].max() > 0
    assert row["contacts"] == nominal.groupby("record")["impacts"].sum().mean() > 0


def test_links_at_one_place_by_kind(tmp_path):
    """A damper has a row of its own where floors strike too, and no contacts. Fails if its force counts as a blow."""
    path = tmp_path / "damped.yaml"
    links = "[pounding, {link: damper, damping_coefficient: 2 MN s/m, floors: 2, places: 10 m}]"
    study = STUDY.replace("{link: pounding, gap: 5 mm}", f"{{gap: 5 mm, links: {links}}}").split("sweep:")[0]
    path.write_text(f"{study}analyses: [elastic]\nestimate: none\n")
    found = pound.run(path, path.with_suffix(".h5"), engine="serial")
    table = next(each for each in list_tables(found) if each.caption.startswith("Contact by place"))
    rows = table.frame.query("case == 'touching'").set_index(["kind", "street"])
    assert list(rows.index) == [("pounding", -10.0), ("pounding", 10.0), ("damper", 10.0)]
    assert np.isnan(rows.loc[("damper", 10.0), "contacts"])
    assert rows["is_blow"].tolist() == [True, True, False]
    link = found.link().query("case == 'touching' and kind == 'damper'")
    assert rows.loc[("damper", 10.0), "peak_force"] == link["peak_force"].max()
    assert rows["kind_below"].tolist() == ["pounding", "pounding", "damper"]


def test_a_run_names_the_line(results):
    """The number of a sentence is the mean ratio of the line that it names."""
    sentences = list_sentences(results)
    means = results.values("line_V_ratio_mean")[0, 0, 0, 0, :, :2]  # those across the row have no sentence
    storey, line = np.unravel_index(np.argmax(means), means.shape)
    rise = f"by up to {float(f'{100 * (means.max() - 1):.2g}'):g} % (storey {storey + 1}, mean of 2 motions"
    assert any(f"raises the elastic shears of line {line + 1} of corner {rise}" in each for each in sentences)
    assert any("leaves those of all its lines along the row as they are alone" in each for each in sentences)
    assert any("of the lines along the row of corner rise most at impact.restitution" in each for each in sentences)
    assert any("where floors twist" in each for each in list_notes(results))
    worst = rank_cases(find_nominal(results))[0].worst[-1]
    assert worst.value == pytest.approx(means.max())
    assert worst.place == f"corner, line {line + 1}, storey {storey + 1}"


def test_the_tables_of_a_run(results, corner):
    """Frame lines and edges are the means of the tables; the peaks say which line and which edge."""
    peaks, _, lines, edges, places = list_tables(results)
    line = results.line().query(
        "`impact.restitution` == 0.5 and case == 'touching' and analysis == 'inelastic' and line == 2"
    )
    mean = line.groupby("storey")[["V", "V_ratio", "mu", "drift_ratio"]].mean().max()
    row = lines.frame.query("case == 'touching' and analysis == 'inelastic' and line == 2").iloc[0]
    for name in mean.index:
        assert row[name] == pytest.approx(mean[name]), name
    here = corner.query("`impact.restitution` == 0.5 and case == 'touching' and analysis == 'inelastic'")
    high = here.groupby("storey")["edge_drift_high"].mean().max() / 3.0
    assert edges.frame.query("case == 'touching' and analysis == 'inelastic'")[
        "edge_drift_high"
    ].item() == pytest.approx(high)
    cells = {column.name: column.cell for column in peaks.columns}
    inelastic = peaks.frame.query("case == 'touching' and analysis == 'inelastic'").iloc[0]
    largest = results.storey().query("case == 'touching' and analysis == 'inelastic'")["edge_drift_ratio"].max()
    assert inelastic["drift"] == pytest.approx(largest)
    link = results.link().query("case == 'touching' and analysis == 'inelastic'")
    closest = link.loc[link["max_closing"].idxmax(), "street"]
    assert f", gap 5 mm, at {closest:g} m along the street".replace("-", "−") in cells["closing"](inelastic.to_dict())
    assert "line" in cells["ratio"](inelastic.to_dict())
    for table in (lines, edges, places):
        text = table.to_text(80)
        assert max(map(len, text.splitlines())) <= 80


@pytest.fixture(scope="module")
def balanced(tmp_path_factory) -> ResultTables:
    path = tmp_path_factory.mktemp("balanced") / "balanced.yaml"
    path.write_text(BALANCED)
    return pound.run(path, path.with_suffix(".h5"), engine="serial")


def test_floors_that_do_not_twist(balanced):
    """Lines have the drift of their storey and their part of its shear; nothing else is said of them."""
    storey = balanced.storey().query("building == 'even'")
    for number in (1, 2):
        line = balanced.line().query(f"line == {number}")
        share = line["stiffness"].to_numpy() / balanced.buildings.query("building == 'even'")["stiffness"].to_numpy()
        assert line["V"].to_numpy() == pytest.approx(storey["V"].to_numpy() * share)
        for name in ("mu", "mu0", "drift", "drift0", "residual_drift"):
            assert np.array_equal(line[name], storey[name]), name
    assert np.array_equal(storey["edge_drift_high"], storey["drift"])
    assert (balanced.floor().query("building == 'even'")["twist"] == 0).all()
    assert len(list_tables(balanced)) == 2
    assert not any("line" in str(each) for each in [*list_sentences(balanced), *list_notes(balanced)])


# Expressions and limits


@pytest.mark.parametrize(
    ("text", "query", "column"),
    [
        ("mu in line 2 of corner", "line == 2", "mu"),
        ("V in line 1 of corner storey 2", "line == 1 and storey == 2", "V"),
        ("V_ratio in line 1 of corner storey 2", "line == 1 and storey == 2", "V_ratio"),
        ("drift_ratio in line 2 of corner", "line == 2", "drift_ratio"),
        ("edge_drift in corner storey 1", "building == 'corner' and storey == 1", "edge_drift"),
        ("edge_drift_ratio", "storey > 0", "edge_drift_ratio"),
        ("twist", "floor > 0", "twist"),
        ("twist0 in corner floor 2", "building == 'corner' and floor == 2", "twist0"),
    ],
)
def test_an_expression_is_the_number_of_the_tables(results, text, query, column):
    expression = parse_expression(text, Scope(BUILDINGS))
    values = {name: array.values for name, array in results.arrays.data.items() if "analysis" in array.dims}
    found = evaluate_expression(expression, values, "largest")
    table = "line" if " line " in text else "floor" if "twist" in text else "storey"
    frame = results.table(table).query(f"case == 'touching' and analysis == 'inelastic' and {query}")
    assert found[:, 0, 1] == pytest.approx(frame.groupby("impact.restitution")[column].max().to_numpy())
    assert (evaluate_error(expression, values, "largest")[:, 0, 1] < 1e-4 * found[:, 0, 1]).all()


@pytest.mark.parametrize(
    ("parse", "text", "message", "hint"),
    [
        (parse_expression, "mu in line 1", "line 1 of which building?", "`mu in line 1 of corner`"),
        (parse_expression, "mu in line 1 of sof", "no building 'sof'", "did you mean 'soft'?"),
        (parse_expression, "mu in corner line 1", "stands before its building", "`mu in line 1 of corner`"),
        (parse_expression, "line_mu in corner", "belongs to a frame line", "`mu in line 1 of corner`"),
        (parse_expression, "twist in line 1 of corner", "frame lines have no twist", "V, V0, V_ratio, mu"),
        (parse_expression, "mu in line 0 of corner", "there is no line 0", "`line 1`"),
        (parse_comparison, "twist in corner > 0.01", "the value has no unit", "> 0.01 rad`"),
        (parse_comparison, "mu < 8 in line 1 of corner", "stands behind the value", "`mu in line 1 of corner < 8`"),
        (parse_comparison, "edge_drift > 2", "the value has no unit", "`edge_drift > 2 cm` or `edge_drift > 2 %`"),
        (parse_limit, "mu > 3 in line 1 of corner", "stands behind the value", "`mu in line 1 of corner > 3`"),
    ],
)
def test_an_expression_that_is_refused(parse, text, message, hint):
    with pytest.raises(InputError) as refused:
        parse(text, Scope(BUILDINGS))
    assert message in refused.value.issues[0].message
    assert hint in refused.value.issues[0].hint


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("mu > 3 in soft", "mu in soft > 3"),
        ("mu > 3 in line 1 of corner storey 2", "mu in line 1 of corner storey 2 > 3"),
        ("mu in soft > 3 in storey 2", "mu in soft storey 2 > 3"),
        ("drift > 2 % in line 1 of corner", "drift in line 1 of corner > 2 %"),
        ("edge_drift > 2 in in soft", "edge_drift in soft > 2 in"),
        ("acceleration > 1 g in corner floor 2", "acceleration in corner floor 2 > 1 g"),
        ("3 in soft < mu", "3 < mu in soft"),
    ],
)
def test_a_place_behind_its_value_is_refused_with_the_line_that_works(text, written):
    scope = Scope(BUILDINGS)
    for parse in (parse_comparison, parse_limit) if ">" in text else (parse_comparison,):
        with pytest.raises(InputError, match="the place stands behind the value") as refused:
            parse(text, scope)
        assert refused.value.issues[0].hint == f"write `{written}`"
        assert parse(written, scope).text == written


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("drift in soft > 2 %", "drift_ratio in soft"),
        ("1 % < drift < 2 %", "drift_ratio"),
        ("edge_drift in corner storey 1 > 2 %", "edge_drift_ratio in corner storey 1"),
        ("drift in line 2 of corner > 2 %", "drift_ratio in line 2 of corner"),
        ("max(drift in soft, drift in corner) > 2 %", "max(drift_ratio in soft, drift_ratio in corner)"),
    ],
)
def test_a_drift_in_percent_is_that_over_the_storey_height(results, text, name):
    values = {key: array.values for key, array in results.arrays.data.items() if "analysis" in array.dims}
    statement = parse_comparison(text, Scope(BUILDINGS))
    found = evaluate_expression(statement.first, values, "largest")
    expected = evaluate_expression(parse_expression(name, Scope(BUILDINGS)), values, "largest")
    np.testing.assert_array_equal(found, expected)
    assert np.isfinite(found).all()
    assert statement.scale == 0.02
    assert statement.text == text


@pytest.mark.parametrize("text", ["drift0 > 2 %", "drift - drift0 > 2 %", "drift [1 s] > 2 %", "displacement > 2 %"])
def test_other_lengths_are_not_compared_with_a_part_of_the_height(text):
    with pytest.raises(InputError, match="is no value: expected"):
        parse_comparison(text, Scope(BUILDINGS))


def test_a_ratio_of_two_drifts_is_a_number():
    """Fails if it is taken over the heights of the storeys."""
    quantities = parse_comparison("drift in soft / drift in corner > 110 %", Scope(BUILDINGS)).quantities
    assert {each.name for each in quantities} == {"drift"}


@pytest.mark.parametrize(
    ("text", "message", "hint"),
    [
        ("mu in line 3 of corner", "corner has lines 1 to 2", "line 1 of corner"),
        ("mu in line 1 of soft", "soft has no plan", "name a building with one: corner"),
        ("twist in soft", "soft has no plan", "corner"),
        ("edge_drift", None, ""),
        ("twist in corner", None, ""),
    ],
)
def test_a_line_that_is_not_there(text, message, hint):
    (part,) = parse_expression(text, Scope(BUILDINGS)).quantities
    problem = find_twist_problem(part, [2, 0], BUILDINGS)
    if message is None:
        assert problem is None
        assert "no building of the study has a plan" in find_twist_problem(part, [0, 0], BUILDINGS)[0]
    else:
        assert message in problem[0]
        assert hint in problem[1]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("mu in line 2 of corner > 3", ("mu", 3.0, False, 0, 0, 2)),
        ("drift in line 1 of corner storey 2 > 2 %", ("drift", 0.02, True, 0, 2, 1)),
        ("drift_ratio in line 1 of corner > 0.02", ("drift", 0.02, True, 0, 0, 1)),
        ("edge_drift in soft > 2 %", ("edge_drift", 0.02, True, 1, 0, 0)),
        ("edge_drift_ratio > 2 %", ("edge_drift", 0.02, True, None, 0, 0)),
        ("edge_drift in soft storey 2 > 6 cm", ("edge_drift", 0.06, False, 1, 2, 0)),
        ("twist in corner floor 2 > 0.01 rad", ("twist", 0.01, False, 0, 2, 0)),
        ("mu in line > 3", ("mu", 3.0, False, 2, 0, 0)),
        ("largest mu in storey 2 > 3", ("mu", 3.0, False, None, 2, 0)),
        ("shear_demand in soft storey 2 > 3", ("shear_demand", 3.0, False, 1, 2, 0)),
        ("collapse in soft", ("collapse", 0.0, False, 1, 0, 0)),
        ("slight damage in line", ("slight damage", 0.0, False, 2, 0, 0)),
    ],
)
def test_limits_of_floors_that_twist(text, expected):
    limit = parse_limit(text, Scope((*BUILDINGS, "line")))
    assert (limit.quantity, limit.value, limit.of_height, limit.building, limit.level, limit.line) == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mu in line 1 > 3", "line 1 of which building?"),
        ("mu in line 1 corner > 3", "line 1 of which building?"),
        ("acceleration in line 1 of corner > 1 g", "frame lines have no acceleration"),
        ("twist in corner storey 2 > 0.01 rad", "twist belongs to a floor"),
        ("twist > 1 cm", "expected rad"),
    ],
)
def test_limits_that_are_refused(text, message):
    with pytest.raises(InputError, match=re.escape(message)):
        parse_limit(text, Scope(BUILDINGS))


@pytest.mark.parametrize("text", ["shear_demand in soft > 3", "impacts in storey 1 > 3"])
def test_links_have_no_storeys_in_statements(text):
    with pytest.raises(InputError, match="belongs to links, not to a building"):
        parse_comparison(text, Scope(BUILDINGS))


# Files


def test_other_programs_get_lines(results, tmp_path):
    export(results, tmp_path / "csv", tables=["line"])
    line = pd.read_csv(tmp_path / "csv" / "line.csv")
    assert list(line) == list(results.line().columns)
    assert line["V"].to_numpy() == pytest.approx(results.line()["V"].to_numpy())
    meaning = pd.read_csv(tmp_path / "csv" / "columns.csv").set_index("column")
    assert meaning.loc["V", "unit"] == "N"
    assert "frame line" in meaning.loc["V", "meaning"]
    rows = results.storey().query("case == 'touching' and analysis == 'inelastic' and building == 'corner'")
    table, left_out = demands(results, rows)
    assert left_out == 0
    first = rows[rows["storey"] == 1]
    assert table["PID-1-1"].iloc[1:].astype(float).to_numpy() == pytest.approx(first["edge_drift_ratio"].to_numpy())
    residual = results.line("residual_drift").query(
        "line < 3 and case == 'touching' and analysis == 'inelastic' and storey == 1"
    )
    largest = residual.assign(size=residual["residual_drift"].abs()).groupby(ROW[:4], sort=False)["size"].max()
    assert table["RID-1-1"].iloc[1:].astype(float).to_numpy() == pytest.approx(largest.to_numpy() / 3.0)


def change(results: ResultTables, name: str, place: tuple, factor: float) -> ResultTables:
    """Return the results with another value at a place of a variable."""
    array = results.arrays[name]
    values = array.values.copy()
    values[place] *= factor
    data = {**results.arrays.data, name: replace(array, data=values)}
    return ResultTables(results.path, ResultArrays(data, results.arrays.coordinates, results.arrays.attrs))


def test_a_twist_that_is_rounding(results):
    """Fails if a table has such a rotation as a number."""
    tiny = results
    for number in range(2):
        for motion in range(2):
            tiny = change(tiny, "twist", (0, 1, 0, motion, 0, number), 1e-14)
    edges = list_tables(tiny)[3].frame
    assert edges.query("case == 'apart' and analysis == 'elastic'")["twist"].tolist() == [0.0]


def told(results) -> list[str]:
    return [each.message for each in implausible_results(results)]


def test_a_drift_of_an_edge_that_is_hardly_plausible(results):
    """Fails if the drift at the centre of mass is taken for the largest one."""
    assert not [each for each in implausible_results(results) if each.code == "drift"]
    sentences = told(change(results, "edge_drift_ratio", (0, 0, 1, 0, 0, 1), 50.0))
    (sentence,) = [each for each in sentences if "interstorey drift" in each]
    assert sentence.startswith("Hardly plausible: an interstorey drift at an edge of the plan of")
    assert "corner, storey 2" in sentence


def test_a_ductility_of_a_line_that_is_hardly_plausible(results):
    """Fails if the demand of the building alone is that of another line."""
    place = (0, 0, 1, 1, 0, 1)
    raised = change(change(results, "mu", place, 50.0), "line_mu", (*place, 0), 50.0 * 50.0)
    alone = raised.values("line_mu0")[(*place, 0)]
    assert alone != pytest.approx(raised.values("mu0")[place], rel=1e-3)
    (sentence,) = [each for each in told(raised) if "a ductility" in each]
    assert f"(corner, storey 2, line 1, taft, touching, inelastic, impact.restitution = 0.5; {alone:.3g} al" in sentence


def test_motions_without_numbers_are_left_out_of_tables_of_lines(results):
    table = list_tables(change(results, "drift", (0, 0, 1, 0, 0), np.nan))[2]
    assert "mean of those of 2 motions that have numbers" in table.caption
    row = table.frame.query("case == 'touching' and analysis == 'inelastic' and line == 2").iloc[0]
    line = results.line().query("`impact.restitution` == 0.5 and case == 'touching' and analysis == 'inelastic'")
    assert row["V"] == line.query("line == 2 and record == 'taft'")["V"].max()


def test_lines_at_other_places_are_named(results):
    """Fails if lines of one number are compared without a word though they stand elsewhere in the plan, or a plan that
    is shifted counts as another one."""
    shifted = change(results, "line_street", (0, 0), 0.9)  # from -10 and 4 m to -9 and 5 m
    shifted = change(shifted, "line_street", (0, 1), 1.25)
    moved = change(results, "line_street", (0, 1), 1.5)
    assert compare(results, shifted).other_lines == []
    assert compare(results, moved).other_lines == ["corner"]
    assert any("Frame lines of corner are compared" in each for each in _iter_changes(compare(results, moved), False))


def test_a_changed_line_is_found(results):
    other = change(results, "line_mu", (1, 0, 1, 1, 0, 1, 1), 1.001)
    assert compare(results, results).has_same_numbers
    (found,) = compare(results, other).changes.to_dict("records")
    assert (found["table"], found["column"]) == ("line", "line_mu")
    assert found["place"].endswith("touching, inelastic, taft, corner, storey 2, line 2")

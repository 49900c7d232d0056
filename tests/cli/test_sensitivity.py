"""What `pound sensitivity` says and draws: numbers and directions of its sentences, the data in its axes, its notes."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import numpy as np
import pytest

import pounding_cli as pound
from pounding_cli.questions.expression_words import describe_output, find_output_unit
from pounding_cli.questions.reports import build_report
from pounding_cli.results.results import ResultTables
from pounding_cli.study.display import key_words
from pounding_cli.tables import Table

UNCERTAIN = {
    "impact.restitution": {"uniform": {"from": 0.4, "to": 0.65}},
    "buildings.B.period": {"uniform": {"from": "0.4 s", "to": "0.6 s"}},
}


def build_study(**changes) -> dict:
    study = {
        "title": "Two small buildings",
        "records": {"use": ["elcentro", "taft"], "duration": "3 s"},
        "buildings": {"A": {"storeys": 2, "period": "0.3 s"}, "B": {"like": "A", "storeys": 1, "period": "0.5 s"}},
        "group": ["A", "B"],
        "cases": {"near": {"link": "pounding", "gap": "3 mm"}},
        "analyses": ["inelastic"],
        "estimate": "none",
        "uncertain": UNCERTAIN,
        "sensitivity": {"outputs": ["max_closing", "largest acceleration in A"], "samples": 4, "draws": 100},
    }
    return study | changes


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("sensitivity")


def ask(folder, **changes) -> ResultTables:
    """Return the results of a study; time histories of those before are reused."""
    return pound.run(build_study(**changes), folder / "r.h5", workflow="sensitivity", engine="serial")


@pytest.fixture(scope="module")
def results(folder) -> ResultTables:
    section = {
        "outputs": ["max_closing", "largest acceleration in A"],
        "probabilities": ["mu in A > 4", "mu in A < 4", "mu in B > 4", "drift in A > 5 mm", "impacts > 0"],
    }
    return ask(folder, sensitivity=section | {"samples": 4, "draws": 100})


def change(results: ResultTables, name: str, edit) -> ResultTables:
    """Return results with another table `name`; edit(frame) -> frame."""
    tables = {each: results.answer(each) for each in results.answers}
    old = tables[name]
    tables[name] = Table(name, edit(old.frame.copy()), old.columns, old.caption)
    return ResultTables(results.path, results.arrays, tables.values())


NUMBERS = {
    "impact.restitution": {
        "first": 0.1, "first_low": 0.05, "first_high": 0.3, "total": 0.2, "total_low": 0.15, "total_high": 0.4,
        "at_low": 0.008, "at_low_error": 0.0005, "at_high": 0.015, "at_high_error": 0.001,
    },
    "buildings.B.period": {
        "first": 0.6, "first_low": 0.55, "first_high": 0.8, "total": 0.7, "total_low": 0.65, "total_high": 0.9,
        "at_low": 0.012, "at_low_error": 0.0002, "at_high": 0.007, "at_high_error": 0.0003,
    },
}  # fmt: skip


def with_numbers(results: ResultTables, numbers: dict, mean: float = 0.01) -> ResultTables:
    """Return results whose largest closing has these indices [m]."""

    def edit(frame):
        for key, values in numbers.items():
            row = (frame["key"] == key) & (frame["output"] == "max_closing")
            frame.loc[row, list(values)] = list(values.values())
            frame.loc[row, ["mean", "outcome"]] = [mean, "found"]
        return frame

    return change(results, "sensitivity", edit)


def first_sentence(results: ResultTables) -> str:
    return build_report(results).answer.sentences[0]


def test_a_share_that_may_be_anything_is_not_told_as_a_number(results):
    """18.5 with an interval of 0 to 53.6 is no share of the variance."""
    unknown = NUMBERS["buildings.B.period"] | {"total": 18.5, "total_low": 0.0, "total_high": 53.6}
    said = first_sentence(with_numbers(results, NUMBERS | {"buildings.B.period": unknown}))
    assert "explains 1850 %" not in said
    assert "how much of the variance it explains cannot be told from 16 samples" in said


def test_the_first_sentence_names_the_most_influential_key_and_its_direction(results):
    """Fails if the least influential key is named, if rises is said for falls, or if its share is that of another."""
    place = "largest closing (case near, inelastic, mean of 2 motions): "
    said = first_sentence(with_numbers(results, NUMBERS))
    assert said.startswith(
        f"{place}most influential: buildings.B.period, which explains 70 % (65 to 90 %) of the variance, interactions "
        "included; the mean falls from 12.0 ± 0.20 mm at its low end to 7.00 ± 0.30 mm at its high end. Mean "
    )
    swapped = dict(zip(NUMBERS, reversed(NUMBERS.values()), strict=True))
    said = first_sentence(with_numbers(results, swapped))
    assert said.startswith(f"{place}most influential: impact.restitution, which explains 70 % (65 to 90 %)")
    period = NUMBERS["buildings.B.period"]
    turned = {
        "at_low": "at_high",
        "at_high": "at_low",
        "at_low_error": "at_high_error",
        "at_high_error": "at_low_error",
    }
    mirrored = {name: period[turned.get(name, name)] for name in period}
    said = first_sentence(with_numbers(results, NUMBERS | {"buildings.B.period": mirrored}))
    assert "the mean rises from 7.00 ± 0.30 mm at its low end to 12.0 ± 0.20 mm at its high end" in said


def test_a_difference_within_its_errors_has_no_direction(results):
    period = NUMBERS["buildings.B.period"] | {"at_low": 0.0101, "at_high": 0.01}
    said = first_sentence(with_numbers(results, NUMBERS | {"buildings.B.period": period}))
    assert (
        "the mean does not change significantly from its low end (10.1 ± 0.20 mm) to its high end (10.0 ± 0.30 mm)"
        in (said)
    )


@pytest.mark.parametrize(("low", "is_significant"), [(0.39, False), (0.41, True)])
def test_keys_whose_intervals_overlap_are_not_told_apart(results, low, is_significant):
    period = NUMBERS["buildings.B.period"] | {"total_low": low}
    said = first_sentence(with_numbers(results, NUMBERS | {"buildings.B.period": period}))
    assert ("(not significantly more than impact.restitution with 16 samples)" not in said) == is_significant


def test_the_distribution_is_that_of_the_output(results):
    """Fails if percentiles are swapped, or those of another output."""

    def edit(frame):
        row = frame["output"] == "max_closing"
        values = {"mean": 0.02, "mean_low": 0.019, "mean_high": 0.022, "percentile_5": 0.011, "percentile_95": 0.035}
        frame.loc[row, list(values)] = list(values.values())
        return frame

    said = first_sentence(change(results, "sensitivity_outputs", edit))
    assert said.endswith(" Mean 20.0 (19.0 to 22.0) mm; 90 % of the samples lie between 11.0 mm and 35.0 mm.")


def test_effects_of_morris_are_told_with_their_unit(folder):
    asked = {"outputs": ["max_closing"], "samples": 4, "draws": 100, "method": "morris"}
    results = ask(folder, sensitivity=asked)
    values = {"mu_star": [0.002, 0.001], "mu_star_low": [0.0015, 0.0005], "mu_star_high": [0.0025, 0.0012]}
    for order in (1, -1):
        turned = {name: each[::order] for name, each in values.items()}
        said = first_sentence(change(results, "sensitivity", lambda frame, new=turned: frame.assign(**new)))
        key = list(UNCERTAIN)[::order][0]
        effect = "which changes it by 2.00 (1.50 to 2.50) mm on average over its range."
        assert f"most influential: {key}, {effect}" in said
    drawn = change(results, "sensitivity", lambda frame: frame.assign(**values, sigma=[0.0004, 0.0003]))
    (ax,) = build_report(drawn).figures()[0].draw().axes
    assert ax.get_xlabel() == "change of the output over the range of the key [mm]"
    assert ax.get_title(loc="left").replace("\n", " ") == "largest closing (case near, inelastic, mean of 2 motions)"
    assert list(whiskers(ax, "mean effect").values()) == [pytest.approx([0.5, 1, 1.2]), pytest.approx([1.5, 2, 2.5])]
    (marks,) = [line for line in ax.lines if line.get_label() == "deviation"]
    assert marks.get_xdata() == pytest.approx([0.3, 0.4])


# Statements


def set_probabilities(results: ResultTables, values: list[float]) -> ResultTables:
    columns = {"probability": values, "probability_low": [v / 2 for v in values], "probability_high": values}
    return change(results, "sensitivity_probabilities", lambda frame: frame.assign(**columns))


def test_many_statements_are_summed_up(results):
    """Fails if the least likely one is called the most likely, or those that fail are counted."""
    values = [0.9, 0.1, 0.6, 0.2, 0.7]
    said = build_report(set_probabilities(results, values)).answer.sentences[-1]
    where = "case near, inelastic"
    assert said == (
        "Of 5 statements 3 hold with a probability above 50 %; most likely: μ in A > 4, "
        f"{where}, 0.900 (0.450 to 0.900); least likely: μ in A < 4, {where}, 0.100 (0.0500 to 0.100)."
    )
    said = build_report(set_probabilities(results, [1 - value for value in values])).answer.sentences[-1]
    assert said.startswith("Of 5 statements 2 hold with a probability above 50 %; most likely: μ in A < 4, ")
    assert f"least likely: μ in A > 4, {where}, 0.100 " in said


def test_each_of_few_statements_has_a_sentence(results):
    few = change(results, "sensitivity_probabilities", lambda frame: frame.head(2))
    few = set_probabilities(few, [0.75, 0.25])
    named = {"most_influential": ["buildings.B.period", ""]}
    *_, first, second = build_report(
        change(few, "sensitivity_probabilities", lambda frame: frame.assign(**named))
    ).answer.sentences
    place = "(case near, inelastic, mean of 2 motions)"
    assert first == (
        f"μ in A > 4 {place} holds with a probability of 0.750 (0.375 to 0.750); most influential: buildings.B.period."
    )
    assert second == f"μ in A < 4 {place} holds with a probability of 0.250 (0.125 to 0.250)."


# Figures and tables


def whiskers(ax, label: str) -> dict[float, list[float]]:
    """Return by height the low end, number and high end of the points of a label."""
    (container,) = [each for each in ax.containers if each.get_label() == label]
    points, _, (bars,) = container.lines
    ends = [np.sort(segment[:, 0]) for segment in bars.get_segments()]
    return {
        float(y): [low, float(x), high]
        for x, y, (low, high) in zip(points.get_xdata(), points.get_ydata(), ends, strict=True)
    }


def test_the_figure_shows_ends_and_indices_of_every_key(results):
    """Fails if bars or whiskers are swapped, if keys stand in another order, or if numbers in m stand on one in mm."""
    drawn = with_numbers(results, NUMBERS)
    tornado, indices, *_ = build_report(drawn).figures()[0].draw().axes
    assert tornado.get_title(loc="left") == "largest closing (case near, inelastic, mean of 2 motions)"
    labels = [label.get_text().split("\n")[-1] for label in tornado.get_yticklabels()]
    assert labels == ["impact.restitution", "buildings.B.period"]  # from below: the most influential on top
    assert tornado.get_xlabel() == "mean output [mm]"
    bars = {each.get_label(): each for each in tornado.containers if hasattr(each, "patches")}
    for end, values in (("low", [8, 12]), ("high", [15, 7])):
        patches = bars[f"key at its {end} end"].patches
        assert [patch.get_x() for patch in patches] == pytest.approx([10, 10])
        assert [patch.get_x() + patch.get_width() for patch in patches] == pytest.approx(values)
        assert [patch.get_y() + patch.get_height() / 2 for patch in patches] == [0, 1]
    errors = [each.lines[2][0].get_segments() for each in tornado.containers if hasattr(each, "has_xerr")]
    widths = [[np.ptp(segment[:, 0]) / 2 for segment in segments] for segments in errors]
    assert widths == [pytest.approx([0.5, 0.2]), pytest.approx([1.0, 0.3])]
    assert list(whiskers(indices, "total index").values()) == [
        pytest.approx([0.15, 0.2, 0.4]), pytest.approx([0.65, 0.7, 0.9])
    ]  # fmt: skip
    assert list(whiskers(indices, "first order").values()) == [
        pytest.approx([0.05, 0.1, 0.3]), pytest.approx([0.55, 0.6, 0.8])
    ]  # fmt: skip
    assert indices.get_xlabel() == "part of the variance"


def test_the_table_of_an_output_is_in_its_unit(results):
    table = build_report(with_numbers(results, NUMBERS)).answer.tables[1]
    assert table.caption == "Influence on largest closing (case near, inelastic, mean of 2 motions)"
    assert table.heads() == ["key", "first order", "total", "at its low end [mm]", "at its high end [mm]"]
    assert table.cells()[0] == [
        "buildings.B.period", "0.600 (0.550 to 0.800)", "0.700 (0.650 to 0.900)", "12.0 ± 0.20", "7.00 ± 0.30",
    ]  # fmt: skip


@pytest.mark.parametrize("width", [80, 120, 200])
def test_tables_and_sentences_fit_the_terminal(results, width):
    lines = list(build_report(with_numbers(results, NUMBERS)).summary.iter_lines(width))
    text = "\n".join(lines)
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    assert re.search(r"buildings\.B\.period .*0\.700 \(0\.650 to 0\.900\)", text)
    assert ("Left out " in text) >= (width == 80)


# Notes


CONTACT = "depend on the contact stiffness, which is unknown"
FAR = {"cases": {"near": {"link": "pounding", "gap": "5 m"}}}
ONE = {"records": {"use": ["elcentro"], "duration": "3 s"}}


def section(*outputs: str, **further) -> dict:
    return {"sensitivity": {"outputs": list(outputs), "samples": 4, "draws": 100} | further}


NOTES = [
    ("mean of 2 motions, storey by storey", {}, ONE),
    ("the largest of 2 motions, storey by storey", section("mu", over_motions="largest"), section("mu")),
    ("Each sample rests on one motion", {"uncertain": UNCERTAIN | {"motion": "any"}}, {}),
    ("of 2 motions drawn with replacement", {"uncertain": UNCERTAIN | {"motion": "bootstrap"}}, {}),
    ("of 16 samples have no value: a run failed or the quantity is undefined",
     section("sqrt(0 - mu)"), section("mu")),
    (CONTACT, section("acceleration in A"), section("mu")),
    (CONTACT, section("peak_force"), section("peak_force") | FAR),
    (CONTACT, section("acceleration in A"), section("acceleration in A") | {
        "uncertain": UNCERTAIN | {"impact.stiffness": {"uniform": {
            "from": "5 x stiffest storey", "to": "50 x stiffest storey"}}}}),
    ("Tables and figures show 6 of 7 outputs", section(*(f"{n} * mu" for n in range(1, 8))),
     section(*(f"{n} * mu" for n in range(1, 7)))),
    ("Shown at buildings.A.period = 0.3 s; other points of the sweep",
     {"sweep": {"buildings.A.period": ["0.25 s", "0.3 s"]}}, {}),
    ("In brackets: 95 % interval", {}, section("mu0 - mu0", method="morris")),
]  # fmt: skip


@pytest.mark.parametrize(("words", "raising", "other"), NOTES, ids=[f"{n}" for n in range(len(NOTES))])
def test_notes_stand_where_they_belong(folder, words, raising, other):
    notes = [build_report(ask(folder, **each)).answer.notes for each in (raising, other)]
    assert [any(words in note for note in each) for each in notes] == [True, False]


def test_numbers_of_contact_say_that_they_depend_on_its_stiffness(folder):
    words = "depends on the contact stiffness"
    asked = section("acceleration in A", "mu", probabilities=["acceleration > 1 g", "mu > 4"])
    report = build_report(ask(folder, **asked))
    said = {re.split(r" \(", each)[0]: words in each for each in report.answer.sentences}
    assert said == {"acceleration in A": True, "μ": False, "acceleration > 1 g": True, "μ > 4": False}
    cells = report.answer.tables[0].to_text(120)
    assert cells.count(words) == 1
    assert [words in table.caption for table in report.answer.tables[1:]] == [True, False]
    report = build_report(ask(folder, **asked, **FAR))
    assert words not in " ".join([*report.answer.sentences, *(table.to_text(120) for table in report.answer.tables)])


def test_a_refused_output_says_how_many_samples_have_no_value(folder):
    said = first_sentence(ask(folder, **section("sqrt(0 - mu)")))
    assert said == "sqrt(0 - μ) (case near, inelastic, mean of 2 motions): no index: 16 of 16 samples have no value."


def test_statements_of_the_study_have_probabilities(folder):
    """One that always holds, one that never does, and one that holds in part."""
    statements = [
        {"says": "it moves", "name": "always", "holds": "drift > 0 cm"},
        {"says": "it does not", "name": "never", "holds": "drift < 0 cm"},
        {"says": "both", "name": "both", "holds": ["drift > 0 cm", "drift < 0 cm"]},
    ]
    changes = {"statements": statements, "sensitivity": {"statements": "all", "samples": 4, "draws": 100}}
    results = ask(folder, **changes)
    probabilities = results.table("sensitivity_probabilities").set_index("statement")["probability"].to_dict()
    assert probabilities == {"always": 1.0, "never": 0.0, "both": 0.0, "both, at least in part": 1.0}
    assert build_report(results).answer.sentences[0].startswith("always (all cases) holds with a probability of 1.00")


def test_keys_of_a_plan_are_named_in_words(folder):
    """Fails if the eccentricity of a plan changes nothing, or is named by its dotted key alone."""
    plan = {"width": "12 m", "depth": "12 m", "eccentricity": "5 %", "frequency_ratio": 1.1, "accidental": "0 %"}
    changes = {
        "buildings": {
            "corner": {"storeys": 1, "period": "0.3 s", "plan": plan},
            "B": {"storeys": 1, "period": "0.5 s"},
        },
        "group": ["corner", "B"],
        "uncertain": {
            "buildings.corner.plan.eccentricity": {"uniform": {"from": "0 %", "to": "20 %"}},
            "buildings.corner.plan.accidental": {"choice": ["-0.1 %", "0.1 %"]},
        },
        "sensitivity": {"outputs": ["edge_drift in corner"], "method": "morris", "samples": 4, "draws": 100},
        "records": {"use": ["taft"], "duration": "3 s"},
    }
    sentence = first_sentence(ask(folder, **changes))
    assert "most influential: eccentricity of corner, which changes it by " in sentence


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        ("impact.restitution", "restitution"), ("tail", "tail"), ("cases.near.gap", "gap of near"),
        ("buildings.A.stiffness.0", "stiffness of storey 1 of A"),
        ("buildings.A.plan.centre_of_mass", "centre of mass of A"),
        ("buildings.A.plan.lines.1.y", "place of line 2 of A"),
        ("buildings.A.plan.lines.0.stiffness.2", "stiffness of storey 3 of line 1 of A"),
        ("cases.near.places", "place of near"), ("cases.near.links.1.places.0", "place 1 of link 2 of near"),
        ("cases.near.links.1.stiffness", "stiffness of near"),
    ],
)  # fmt: skip
def test_keys_in_words(key, expected):
    assert key_words(key) == expected


# Expressions in words and units


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("largest V_ratio in stiff", "largest V/V₀ in stiff"), ("max(mu in A, mu0)", "max(μ in A, μ₀)"),
        ("largest max_closing", "largest closing"), ("smallest max_closing", "smallest largest closing"),
        ("acceleration in floor 2", "acceleration in floor 2"), ("impacts > 0", "contacts > 0"),
        ("largest mu in drift", "largest μ in drift"),
    ],
)  # fmt: skip
def test_quantities_have_the_words_of_the_field(text, words):
    """Fails if a building that is called as a quantity loses its name."""
    assert describe_output(text) == words


@pytest.mark.parametrize(
    ("text", "si", "name", "factor"),
    [
        ("max_closing", "m", "mm", 1e-3), ("largest acceleration in A", "m/s2", "g", 9.80665),
        ("largest drift in A + largest drift in B", "m", "mm", 1e-3), ("mu in A", "", "", 1.0),
        ("acceleration in drift", "m/s2", "g", 9.80665), ("peak_force", "N", "kN", 1e3),
    ],
)  # fmt: skip
def test_outputs_are_shown_in_the_unit_of_their_quantities(results, text, si, name, factor):
    unit = find_output_unit(results, text, si)
    assert (unit.name, unit.factor) == (name, factor)


@pytest.mark.parametrize("name", ["sensitivity", "optimise"])
def test_no_xarray_and_no_matplotlib_for_an_answer(folder, name):
    """Of solving a study, and printing sentences and tables."""
    over = {"impact.restitution": {"choice": [0.4, 0.65]}}
    study = build_study(optimise={"least": "mu", "over": over})
    code = (
        "import json, sys\nimport pounding_cli as pound\nfrom pounding_cli.api.running import run_study\n"
        "from pounding_cli.questions import load_question\n"
        "from pathlib import Path\nfrom pounding_cli.questions.reports import build_report\n"
        "question = load_question(sys.argv[2]).ask(pound.load_study(json.loads(sys.argv[1])))\n"
        "build_report(run_study(question, Path(sys.argv[3]), engine='serial').results).print()\n"
        "print([name for name in ('xarray', 'matplotlib') if name in sys.modules])"
    )
    command = [sys.executable, "-c", code, json.dumps(study), name, str(folder / f"{name}.h5")]
    out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert out.startswith("Two small buildings\n")
    assert out.endswith("[]\n")

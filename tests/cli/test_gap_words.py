"""What a reader of `pound gap` sees: direction and number of its sentences, its notes, the data in its figure, and its
tables on narrow terminals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex

import pounding_cli
from pounding_cli.questions.gap.cases import judge_gaps
from pounding_cli.questions.gap.figures import list_figures
from pounding_cli.questions.gap.sentences import list_sentences
from pounding_cli.questions.gap.words import list_notes, list_tables
from pounding_cli.questions.reports import build_report
from pounding_cli.results.results import ResultTables

STUDY = """\
title: Two small buildings
records: {use: [elcentro, taft, parkfield], duration: 2 s}
buildings:
  A: {storeys: 3, period: 0.3 s}
  B: {like: A, storeys: 2, period: 0.5 s}
group: [A, B]
cases:
  near: {link: pounding, gap: 5 cm}
"""


@pytest.fixture(scope="module")
def solve(tmp_path_factory):
    """Solves a study once: text -> its results."""
    folder = tmp_path_factory.mktemp("words")
    solved: dict[str, ResultTables] = {}

    def solve_once(text: str) -> ResultTables:
        if text not in solved:
            path = folder / f"study{len(solved)}.yaml"
            path.write_text(text)
            solved[text] = pounding_cli.run(path, path.with_suffix(".h5"), workflow="gap", engine="serial")
        return solved[text]

    return solve_once


def with_frames(results: ResultTables, **frames: pd.DataFrame) -> ResultTables:
    """The same results with other rows in some of their tables."""
    tables = [results.answer(name) for name in results.answers]
    tables = [replace(table, frame=frames.get(table.name, table.frame)) for table in tables]
    return ResultTables(results.path, results.arrays, tables)


def retell(
    results: ResultTables,
    needs: dict,
    gaps: dict | None = None,
    codes: float = 1.0,
    worth: tuple[tuple[int, float], ...] = ((0, np.nan), (0, np.nan)),
) -> ResultTables:
    """The same results, of which the motions require something else.

    needs : (analysis, floor) -> mean and largest [cm], and motions unless there are 3
    gaps : gap [cm] -> analysis -> floor and verdict, of the case `near`
    codes : width that the UBC asks for [cm]
    worth : motions that close it and their annual rate [%], of elastic buildings and of yielding ones
    """
    gap = results.table("gap")
    is_exact = gap["rule"] == "exact"
    for (analysis, floor), (mean, largest, *motions) in needs.items():
        rows = is_exact & (gap["analysis"] == analysis) & (gap["floor"] == floor)
        gap.loc[rows, ["mean", "largest"]] = mean / 100, largest / 100
        gap.loc[rows, "motions"] = motions[0] if motions else 3
    told = {analysis for analysis, _ in needs}
    gap.loc[is_exact & ~gap["analysis"].isin(told), ["mean", "largest"]] = np.nan
    gap.loc[gap["rule"] == "UBC-1991", ["mean", "largest"]] = codes / 100
    cases = results.table("gap_cases")
    template = cases[cases["rule"] == "exact"].iloc[0].to_dict()
    rows = [
        template
        | {"analysis": analysis, "floor": floor, "right_floor": floor, "gap": width / 100, "enough": enough}
        | {"required": needs[analysis, floor][1] / 100}
        for width, verdicts in (gaps or {}).items()
        for analysis, (floor, enough) in verdicts.items()
    ]
    frame = pd.DataFrame(rows, columns=cases.columns).sort_values("analysis", kind="stable")
    gap_codes = results.table("gap_codes")
    gap_codes["closed"] = [closed for closed, _ in worth]
    gap_codes["rate"] = [rate / 100 for _, rate in worth]
    return with_frames(results, gap=gap, gap_cases=frame.astype(cases.dtypes.to_dict()), gap_codes=gap_codes)


BOTH = {("elastic", 2): (10.3, 17.1), ("inelastic", 2): (5.1, 8.55), ("elastic", 1): (4, 7), ("inelastic", 1): (2, 3)}
NEED = "elastic buildings need 17.1 cm (largest of 3 motions; mean 10.3 cm), yielding ones 8.55 cm."
SWAPPED = {
    ("elastic", 2): (5.1, 8.55),
    ("inelastic", 2): (10.3, 17.1),
    ("elastic", 1): (2, 3),
    ("inelastic", 1): (4, 7),
}
SWAPPED_NEED = "elastic buildings need 8.55 cm (largest of 3 motions; mean 5.10 cm), yielding ones 17.1 cm."


def verdicts(elastic: str, inelastic: str) -> dict:
    return {"elastic": (2, elastic), "inelastic": (2, inelastic)}


@pytest.mark.parametrize(
    ("needs", "gaps", "sentence"),
    [
        (BOTH, {5: verdicts("no", "no")}, f"5 cm is not enough: {NEED}"),
        (BOTH, {20: verdicts("yes", "yes")}, f"20 cm is enough: {NEED}"),
        (
            BOTH,
            {10: verdicts("no", "yes")},
            f"10 cm is enough for yielding buildings but not enough for elastic ones: {NEED}",
        ),
        (
            SWAPPED,
            {10: verdicts("yes", "no")},
            f"10 cm is enough for elastic buildings but not enough for yielding ones: {SWAPPED_NEED}",
        ),
        (BOTH, {20: verdicts("unknown", "unknown")}, f"20 cm is not known to be enough: {NEED}"),
        (
            BOTH,
            {10: verdicts("no", "unknown")},
            f"10 cm is not known to be enough for yielding buildings and not enough for elastic ones: {NEED}",
        ),
        (
            BOTH,
            {20: verdicts("unknown", "yes")},
            f"20 cm is enough for yielding buildings but not known to be enough for elastic ones: {NEED}",
        ),
        (
            BOTH,
            {20: verdicts("yes", "yes"), 5: verdicts("no", "no"), 10: verdicts("no", "yes")},
            "20 cm is enough, 10 cm is enough for yielding buildings but not enough for elastic ones, 5 cm is not "
            f"enough: {NEED}",
        ),
        (BOTH, {5: verdicts("no", "no"), 4: verdicts("no", "no")}, f"4 cm and 5 cm are not enough: {NEED}"),
        (
            BOTH,
            {width: verdicts("yes", "yes") for width in (21, 20, 23, 22)},
            f"20 cm to 23 cm (4 gaps) are enough: {NEED}",
        ),
        (BOTH, None, "A | B need 17.1 cm as elastic buildings (largest of 3 motions; mean 10.3 cm), 8.55 cm as "
                     "yielding ones."),
        (SWAPPED, None, "A | B need 8.55 cm as elastic buildings (largest of 3 motions; mean 5.10 cm), 17.1 cm as "
                        "yielding ones."),
        ({key: BOTH[key] for key in BOTH if key[0] == "elastic"}, {5: {"elastic": (2, "no")}},
         "5 cm is not enough: elastic buildings need 17.1 cm (largest of 3 motions; mean 10.3 cm)."),
        ({key: BOTH[key] for key in BOTH if key[0] == "inelastic"}, {9: {"inelastic": (2, "yes")}},
         "9 cm is enough: yielding buildings need 8.55 cm (largest of 3 motions; mean 5.10 cm)."),
        # one motion asks for more at a floor whose mean is not the widest
        (BOTH | {("elastic", 1): (4, 18)}, {5: {"elastic": (1, "no"), "inelastic": (2, "no")}},
         "5 cm is not enough: elastic buildings need 18.0 cm (largest of 3 motions, at floor 1; mean there 4.00 cm), "
         "yielding ones 8.55 cm (largest of 3 motions; mean 5.10 cm)."),
        (BOTH | {("elastic", 1): (4, 18)}, None,
         "A | B need 18.0 cm as elastic buildings (largest of 3 motions, at floor 1; mean there 4.00 cm), 8.55 cm as "
         "yielding ones (largest of 3 motions; mean 5.10 cm)."),
        # as many digits as tell a width from the gap
        (BOTH | {("elastic", 2): (4, 5.0004)}, {5: verdicts("no", "no")},
         "5 cm is not enough: elastic buildings need 5.0004 cm (largest of 3 motions; mean 4.00 cm), yielding ones "
         "8.55 cm."),
        (BOTH | {("elastic", 2): (4, 4.9996)}, {5: verdicts("yes", "no")},
         "5 cm is enough for elastic buildings but not enough for yielding ones: elastic buildings need 5.00 cm "
         "(largest of 3 motions; mean 4.00 cm), yielding ones 8.55 cm."),
        (BOTH | {("elastic", 2): (4, 5)}, {5: verdicts("no", "no")},
         "5 cm is not enough: elastic buildings need 5.00 cm (within the numerical error of the gap; largest of 3 "
         "motions; mean 4.00 cm), yielding ones 8.55 cm."),
        (BOTH | {("elastic", 2): (10.3, 17.1, 2)}, {5: verdicts("no", "no")},
         "5 cm is not enough: elastic buildings need 17.1 cm (largest of 2 motions; mean 10.3 cm; 1 more run failed), "
         "yielding ones 8.55 cm (largest of 3 motions; mean 5.10 cm)."),
        (BOTH | {("elastic", 2): (17.1, 17.1, 1)}, {5: {"elastic": (2, "no")}},
         "5 cm is not enough: elastic buildings need 17.1 cm (largest of 1 motion; mean 17.1 cm; 2 more runs failed)."),
    ],
)  # fmt: skip
def test_the_first_sentence_is_the_answer(solve, needs, gaps, sentence):
    """Built from results that are mirror images: direction, number and what they rest on."""
    first = list_sentences(retell(solve(STUDY), needs, gaps))[0]
    assert first.startswith(sentence)


@pytest.mark.parametrize(
    ("codes", "comparison"),
    [
        (20.0, "20.0 cm, no less than these motions require"),
        (17.1, "17.1 cm, no less than these motions require"),
        (10.0, "10.0 cm, less than elastic buildings need, no less than yielding ones do"),
        (5.0, "5.00 cm, less than these motions require"),
    ],
)
def test_codes_are_compared_with_what_the_motions_require(solve, codes, comparison):
    results = solve(STUDY)
    assert f"Codes: UBC-1991 {comparison}." in list_sentences(retell(results, BOTH, codes=codes))[0]
    if codes == 10.0:
        swapped = list_sentences(retell(results, SWAPPED, codes=codes))[0]
        assert "less than yielding buildings need, no less than elastic ones do" in swapped


NONE = (0, np.nan)


@pytest.mark.parametrize(
    ("worth", "said"),
    [
        ((NONE, NONE), ""),
        (((2, np.nan), NONE), " (2 of 3 motions close it elastic, none of 3 yielding)"),
        ((NONE, (1, np.nan)), " (none of 3 motions close it elastic, 1 of 3 yielding)"),
        (
            ((2, 0.12), (1, 0.05)),
            " (2 of 3 motions close it elastic, 1 of 3 yielding; contact 0.12 % a year elastic, 0.050 % yielding)",
        ),
        (((0, 0.05), (0, 0.12)), " (contact 0.050 % a year elastic, 0.12 % yielding)"),
    ],
)
def test_a_gap_of_a_code_says_what_it_is_worth(solve, worth, said):
    """Elastic buildings first. Fails if the analyses are swapped, or if a rate is told that is not known."""
    told = retell(solve(STUDY), BOTH, codes=10.0, worth=worth)
    comparison = "less than elastic buildings need, no less than yielding ones do"
    assert f"Codes: UBC-1991 10.0 cm, {comparison}{said}." in list_sentences(told)[0]
    tables = {name: told.table(name) for name in ("gap", "gap_codes")}
    twice = {
        name: pd.concat([frame, frame[frame["rule"] == "UBC-1991"].assign(rule="E.030")])
        for name, frame in tables.items()
    }
    twice["gap_codes"]["rate"] += np.where(twice["gap_codes"]["rule"] == "E.030", 0.0102, 0)
    first = list_sentences(with_frames(told, **twice))[0]
    several = said.replace(" it ", " them ")
    for rate, further in (("0.12", "1.1"), ("0.050", "1.1")):
        several = several.replace(f"{rate} %", f"{rate} to {further} %")
    assert f"Codes: UBC-1991 10.0 cm and E.030 10.0 cm, {comparison}{several}." in first


def test_codes_that_say_nothing_are_named_with_their_keys(solve):
    """Once and shortly; one that `codes` names before those that nothing asks for."""
    asked = STUDY.replace("period: 0.3 s", "period: 0.3 s, yield: {base_shear: 0.1 W, Cd: 5, Ie: 1}")
    notes = list_notes(solve(asked + "gap: {codes: [TBDY 2018, NBC 202], ntc2008: {ag: 0.2 g}}\n"))
    assert "TBDY 2018 is left out: it needs `R` and `Ie` in `yield` of two neighbours." in notes
    assert "NTC 2008 estimates the displacement of A, B by the height: there is no `mu_d` in `yield`." in notes
    (further,) = (note for note in notes if note.startswith("Further codes"))
    assert further.endswith(
        "need: GB 50011-2010 (`gap.gb50011`), EN 1998-1 (`qd` in `yield`), NTC 2018 (`gap.ntc2018`), "
        "E.030 (`gap.codes`)."
    )


def test_codes_that_say_nothing_of_one_pair_are_named_with_it(solve):
    """A third building of unknown strength. Fails if a code that one pair has counts as one of all pairs; and if the
    table of codes has the pairs in another order than the row."""
    text = STUDY.replace("B: {like: A, ", "Z: {storeys: 2, period: 0.4 s, yield_shear: never}\n  B: {like: A, ")
    text = text.replace("group: [A, B]", "group: [Z, B, A]").replace(
        "period: 0.3 s", "period: 0.3 s, yield: {base_shear: 0.1 W, Cd: 5, Ie: 1, mu_d: 2}"
    )
    results = solve(text + "gap: {codes: [NBC 202], ntc2018: {ag: 0.2 g}}\n")
    notes = list_notes(results)
    assert "Not evaluated for Z | B, as a building lacks the keys: ASCE 7-16 (`Cd` and `Ie` in `yield`)." in notes
    assert "NTC 2018 estimates the displacement of Z by the height: there is no `mu_d` in `yield`." in notes
    (codes,) = (table for table in list_tables(results) if table.caption.startswith("Gaps of codes"))
    place = codes.heads().index("between")
    assert list(dict.fromkeys(row[place] for row in codes.cells())) == ["Z | B", "B | A"]


def test_probabilities_beyond_what_a_fit_knows_have_no_number(solve):
    """Rows of CODES_TABLE, as the terminal and the page show them."""
    results = solve(STUDY)
    codes = results.table("gap_codes")
    names = ["probability", "probability_low", "probability_high"]
    codes[names] = [(1e-9, 1e-12, 0.02), (0.9974, 0.5, 1.0)]
    tables = {table.caption.partition(",")[0]: table for table in list_tables(with_frames(results, gap_codes=codes))}
    shown = tables["Gaps of codes"]
    place = shown.heads().index("contact [%]")
    assert [row[place] for row in shown.cells()] == ["<0.01 (<0.01 to 2.0)", "99.74 (50 to >99.99)"]
    assert "rate [%/year]" not in shown.heads()


def test_the_first_sentence_has_the_numbers_of_the_tables(solve):
    """Without anything made up: the largest over all floors and motions, and whether the gap is enough."""
    results = solve(STUDY.replace("5 cm", "1 mm"))
    gap, cases = results.table("gap"), results.table("gap_cases")
    widths = gap[gap["rule"] == "exact"].groupby("analysis")["largest"].max()
    closings = results.link().groupby("analysis")["max_closing"].max()
    assert widths.to_dict() == pytest.approx(closings.to_dict())
    first = list_sentences(results)[0]
    assert set(cases.loc[cases["rule"] == "exact", "enough"]) == {"no"}
    assert first.startswith(
        f"1 mm is not enough: elastic buildings need {1000 * widths['elastic']:.3g} mm (largest of 3"
    )
    assert f"yielding ones {1000 * widths['inelastic']:.3g} mm" in first


# More than two buildings, and walls

THREE = STUDY.replace("group: [A, B]", "group: [A, B, A]").replace("use: [elcentro, taft, parkfield]", "use: [taft]")


@pytest.mark.parametrize("open_pair", [("A-1", "B"), ("B", "A-2")])
def test_a_gap_beside_one_that_closes_does_not_hold(solve, open_pair):
    """Fails if the pairs are mixed up, or if the gap of one side is called enough without a condition."""
    results = solve(THREE)
    cases = results.table("gap_cases")
    is_open = (cases["left"] == open_pair[0]) & (cases["right"] == open_pair[1])
    cases["enough"] = np.where(is_open, "yes", "no")
    said = list_sentences(with_frames(results, gap_cases=cases))
    open_words, closed_words = "Between A-1 and B", "Between B and A-2"
    if open_pair[0] == "B":
        open_words, closed_words = closed_words, open_words
    (sentence,) = (each for each in said if each.startswith(open_words))
    (other,) = (each for each in said if each.startswith(closed_words))
    assert sentence.startswith(f"{open_words} 5 cm is enough: ")
    assert other.startswith(f"{closed_words} 5 cm is not enough: ")
    condition = f"That {' and '.join(open_pair)} do not touch holds only while {closed_words[8:]} do not touch"
    assert condition in sentence
    assert "holds only while" not in other
    cases["enough"] = "yes"
    assert "holds only while" not in " ".join(list_sentences(with_frames(results, gap_cases=cases)))


def test_one_building_beside_a_wall(solve):
    text = STUDY.replace("  B: {like: A, storeys: 2, period: 0.5 s}", "  B: {wall: fixed}")
    first = list_sentences(solve(text))[0]
    assert "the elastic building needs " in first
    assert ", the yielding one " in first
    assert "cm for the elastic building, " in list_sentences(solve(text))[1]
    assert "ones" not in first.partition(". ")[0]


# Sweeps, several cases, rates


def test_the_point_and_the_range_of_a_sweep(solve):
    """Fails if the answer is of another point, or the ends of the range are swapped."""
    results = solve(STUDY + "sweep: {buildings.B.period: [0.4 s, 0.5 s, 0.7 s]}\n")
    gap = results.table("gap")
    widths = gap[(gap["rule"] == "exact")].groupby(["analysis", "buildings.B.period"])["largest"].max() * 100
    said = list_sentences(results)
    assert said[0].startswith("At buildings.B.period = 0.5 s: 5 cm is ")
    assert f"need {widths['elastic', 0.5]:.3g} cm" in said[0]
    for analysis in ("elastic", "inelastic"):
        low, high = widths[analysis].min(), widths[analysis].max()
        ends = [
            f"{each:.3g} cm (buildings.B.period = {widths[analysis].eq(each).idxmax():g} s)" for each in (low, high)
        ]
        assert " to ".join(ends) in said[-1]


def test_cases_are_named_where_there_are_several(solve):
    text = STUDY + "  wide: {link: pounding, gap: 100 cm}\n  same: {link: pounding, gap: 5 cm}\n"
    first = list_sentences(with_verdicts(solve(text), {"near": "no", "wide": "yes", "same": "no"}))[0]
    assert first.startswith("100 cm (wide) is enough, 5 cm (near and same) are not enough: ")
    swept = solve(text + "sweep: {cases.near.gap: [1 cm, 2 cm, 3 cm, 4 cm]}\n")
    first = list_sentences(with_verdicts(swept, {"near": "no", "wide": "yes", "same": "no"}))[0]
    assert first.startswith("100 cm (wide) is enough, 1 cm to 4 cm (near, 4 gaps) and 5 cm (same) are not enough: ")
    first = list_sentences(with_verdicts(solve(text), {"near": "yes", "wide": "no", "same": "yes"}))[0]
    assert first.startswith("5 cm (near and same) are enough, 100 cm (wide) is not enough: ")


def with_verdicts(results: ResultTables, verdicts: dict[str, str]) -> ResultTables:
    """The same results with the same verdict in all rows of a case."""
    cases = results.table("gap_cases")
    return with_frames(results, gap_cases=cases.assign(enough=cases["case"].map(verdicts)))


def test_a_case_with_several_gaps_says_where_its_gap_governs(solve):
    links = "{gap: 5 cm, links: [{link: pounding, floors: rest}, {link: pounding, floors: 1, gap: 1 mm}]}"
    results = solve(STUDY.replace("{link: pounding, gap: 5 cm}", links))
    cases = results.table("gap_cases")
    row = cases[(cases["rule"] == "exact") & (cases["analysis"] == "elastic")].iloc[0]
    assert row["floor"] == 1
    assert f"near ({100 * row['gap']:g} cm at floor 1) is not enough: " in list_sentences(results)[0]
    pairs = "{links: [{link: pounding, gap: 3 cm, pair: 1}, {link: pounding, gap: 4 cm, pair: 2}]}"
    said = list_sentences(solve(THREE.replace("{link: pounding, gap: 5 cm}", pairs)))
    assert said[0].startswith("Between A-1 and B 3 cm is ")
    assert said[1].startswith("Between B and A-2 4 cm is ")


@pytest.mark.parametrize("swapped", [False, True])
def test_the_gap_for_a_rate_comes_first(solve, swapped):
    text = STUDY.replace("duration: 2 s", "duration: 2 s, scale: {pga: 0.3 g}")
    text = text.replace("use: [elcentro, taft, parkfield]", "use: [elcentro, taft, parkfield, eureka, olympia]")
    results = with_frames(solve(text + "gap: {hazard: {k0: 1e-4, k: 2.5}, rate: 1/475}\n"))
    rate = results.table("gap_rate")
    widths = [(0.12, 0.1, 0.2), (0.05, 0.04, 0.07)]
    rate[["gap", "gap_low", "gap_high"]] = widths[::-1] if swapped else widths
    first = list_sentences(with_frames(results, gap_rate=rate))[0]
    elastic, yielding = "12.0 (10.0 to 20.0) cm", "5.00 (4.00 to 7.00) cm"
    if swapped:
        elastic, yielding = yielding, elastic
    expected = "So that the buildings touch once in 475 years (9.99 % in 50 years), they need "
    assert first == f"{expected}{elastic} as elastic buildings, {yielding} as yielding ones."
    rate["gap"] = np.nan
    assert list_sentences(with_frames(results, gap_rate=rate))[0].startswith("No gap is known with which ")
    basis = "rests on 1 intensity of 5 motions: closings are taken in proportion to it, which is right for elastic"
    assert basis in " ".join(list_notes(results))
    results.answers = tuple(name for name in results.answers if name != "gap_rate")
    assert f"The rates of contact {basis.replace('rests', 'rest')}" in " ".join(list_notes(results))


def test_the_gap_for_a_rate_says_at_which_point_it_holds(solve):
    """Without the intensity, over which it is taken. Fails if it stands there as that of the whole sweep."""
    text = STUDY.replace("duration: 2 s", "duration: 1 s, scale: {pga: 0.3 g}") + "analyses: [elastic]\n"
    text += "gap: {hazard: {k0: 1e-4, k: 2.5}, rate: 1/475}\n"
    results = solve(f"{text}sweep: {{buildings.B.period: [0.4 s, 0.6 s], records.scale.pga: [0.2 g, 0.3 g]}}\n")
    sentences = list_sentences(results)
    assert sentences[0].startswith("At buildings.B.period = 0.4 s: so that the buildings touch once in 475 years")
    point = "At buildings.B.period = 0.4 s, records.scale.pga = 0.3 g"
    assert any(each.startswith(f"{point}: a probability of contact of 10 %") for each in sentences)


# Runs that failed


def fail(results: ResultTables, analyses: dict[str, int]) -> ResultTables:
    """The same results, with so many failed runs of the last motions in some analyses."""
    array = results.arrays["status"]
    values = array.values.copy()
    for analysis, count in analyses.items():
        values[..., 0, results.names("analysis").index(analysis), 3 - count :] = "collapsed"
    arrays = replace(results.arrays, data={**results.arrays.data, "status": replace(array, data=values)})
    return ResultTables(results.path, arrays, [results.answer(name) for name in results.answers])


def test_failed_runs_are_told(solve):
    results = solve(STUDY)
    needs = BOTH | {("elastic", 2): (10.3, 17.1, 1)}
    some = fail(retell(results, needs, {20: verdicts("unknown", "yes")}), {"elastic": 2})
    first = list_sentences(some)[0]
    assert "elastic buildings need 17.1 cm (largest of 1 motion; mean 10.3 cm; 2 more runs failed)" in first
    assert "2 of 6 runs failed (2 collapsed) and are left out." in list_notes(some)
    assert not any("failed" in line for line in [*list_sentences(results), *list_notes(results)])


@pytest.mark.parametrize(("failed", "other"), [("elastic", "inelastic"), ("inelastic", "elastic")])
def test_an_analysis_all_of_whose_runs_failed_is_told(solve, failed, other):
    needs = {key: BOTH[key] for key in BOTH if key[0] == other}
    results = fail(retell(solve(STUDY), needs, {5: {other: (2, "no")}}), {failed: 3})
    words = {"elastic": "elastic", "inelastic": "yielding"}
    said = list_sentences(results)
    assert said[0].startswith(f"5 cm is not enough: {words[other]} buildings need ")
    assert f"All runs of {words[failed]} buildings failed; their gaps were not checked." in said


def test_where_all_runs_failed_the_first_sentence_says_so(solve):
    results = retell(solve(STUDY), {}, {})
    failed = fail(results, {"elastic": 3, "inelastic": 3})
    assert list_sentences(failed) == ["All runs failed (6 collapsed); the gaps were not checked."]
    codes = fail(solve(STUDY), {"elastic": 3, "inelastic": 3})
    gap = codes.table("gap")
    codes = with_frames(codes, gap=gap[gap["rule"] == "UBC-1991"])
    said = "All runs failed (6 collapsed); the gaps were compared with the rules of codes only."
    assert list_sentences(codes) == [said]
    assert list_notes(codes) == []


# Notes


def test_notes_stand_where_they_belong(solve):
    """Each is raised by one study and not by another."""
    plain = " ".join(list_notes(solve(STUDY)))
    rough = " ".join(list_notes(solve(STUDY + "estimate: none\n")))
    filled = " ".join(list_notes(solve(STUDY + "  filled: {link: infill, gap: 3 cm}\n")))
    three = " ".join(list_notes(solve(THREE)))
    many = " ".join(list_notes(solve(STUDY.replace("parkfield]", "parkfield, eureka, olympia]"))))
    assert "Numerical error: at most " in plain
    assert "not estimated" not in plain
    assert "The numerical error was not estimated (estimate: none)." in rough
    assert "Numerical error" not in rough
    assert "No confidence interval: it needs at least 5 motions, and there are 3 motions." in plain
    assert "In brackets: 90 % confidence interval." in many
    assert "No confidence" not in many
    assert "Not compared: filled." in filled
    assert "Not compared" not in plain
    assert "Where the gap on one side is not enough, the answer for the other side does not hold." in three
    assert "the other side" not in plain


def test_the_error_told_is_the_largest(solve):
    results = solve(STUDY)
    gap = results.table("gap")
    gap["error"] = 1e-9
    gap.loc[(gap["rule"] == "exact") & (gap["floor"] == 1), "error"] = 2.5e-6
    assert "Numerical error: at most 2.5×10⁻⁴ cm." in list_notes(with_frames(results, gap=gap))


# The gap that stays open


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_governing_floors_lack_most_or_have_least_to_spare(order):
    """Two floors with gaps of 5 and 3 cm, two motions. Fails if the largest part of a gap that stays open is taken for
    the least, a mean for the largest, or one floor for all."""
    value = np.array([[0.010, 0.030], [0.025, 0.015]])[list(order)]
    gap = np.array([0.05, 0.03])[list(order)]
    verdict = judge_gaps(value, np.zeros((2, 2)), gap)
    assert (order[verdict.floors], verdict.required, verdict.enough) == (1, 0.025, "yes")
    assert (verdict.enough_for, verdict.motions) == (2, 2)
    verdict = judge_gaps(value + 0.01, np.zeros((2, 2)), gap)
    assert (order[verdict.floors], verdict.required, verdict.enough) == (1, 0.035, "no")
    assert (verdict.enough_for, verdict.motions) == (1, 2)
    error = np.zeros((2, 2))
    error[order.index(0), 1] = 0.0201  # at the floor that does not govern
    assert judge_gaps(value, error, gap).enough == "no"
    value[:, 0] = np.nan
    unknown = judge_gaps(value, np.zeros((2, 2)), gap)
    assert (unknown.enough, unknown.enough_for, unknown.motions) == ("unknown", 1, 1)
    assert judge_gaps(value * np.nan, np.zeros((2, 2)), gap) is None


def test_what_stays_open_is_the_least_of_all_floors(tmp_path):
    """As the floors that come closest leave it, which the question finds too."""
    text = STUDY.replace("[elcentro, taft, parkfield]", "[taft]").replace("5 cm", "20 cm") + "analyses: [elastic]\n"
    (tmp_path / "s.yaml").write_text(text)
    results = pounding_cli.run(tmp_path / "s.yaml", tmp_path / "run.h5", engine="serial")
    closings = results.link()["max_closing"]
    assert closings.max() > 1.5 * closings.min()
    (scene,) = results.scene().to_dict("records")
    assert scene["dropped_links"].split("\n")[-1] == "A | B"
    said = f"the gap never closes, {200 - 1000 * closings.max():.3g} mm of it stay open"
    assert scene["dropped_reasons"].split("\n")[-1] == said


# The figure


FLOOR_KEYS = ["floor", "right_floor", "columns"]
HAZARD = STUDY.replace("duration: 2 s", "duration: 2 s, scale: {pga: 0.3 g}").replace(
    "use: [elcentro, taft, parkfield]", "use: [elcentro, taft, parkfield, eureka, olympia]"
)
HAZARD += "gap: {hazard: {k0: 1e-4, k: 2.5}, codes: [NBC 202]}\n"
FLOORS = """\
title: Storeys of unequal height
records: {use: [elcentro, taft, parkfield, eureka, olympia], duration: 2 s}
buildings:
  low: {storeys: 2, period: 0.5 s, height: [4 m, 3 m], columns: 20 %, slab: 20 cm}
  high: {storeys: 3, period: 0.3 s, height: 3 m, columns: 20 %, slab: 20 cm, yield: {base_shear: 0.1 W, Cd: 5, Ie: 1}}
group: [low, high, low]
cases: {near: {link: pounding, gap: 3 cm}}
"""


@pytest.mark.parametrize("text", [STUDY, FLOORS])
def test_the_figure_draws_the_tables_in_the_unit_of_the_study(solve, text):
    """Fails if closings in m stand on an axis in cm, or those of another pair, analysis or rule; if the height is that
    of another floor."""
    results = solve(text)
    (picture,) = list_figures(results)
    figure = picture.draw()
    gap, link = results.table("gap"), results.link()
    if "left_at" in link:
        link["columns"] = np.select([link["left_at"] < 1, link["right_at"] < 1], ["left", "right"], "")
    else:
        link["columns"] = ""
    panels = gap.drop_duplicates(["left", "right", "analysis"])[["left", "right", "analysis"]].to_dict("records")
    assert len(figure.axes) == len(panels)
    for ax, panel in zip(figure.axes, panels, strict=True):
        left, right, analysis = panel.values()
        assert ax.get_title(loc="left") == f"{left} | {right}, {analysis}"
        assert ax.get_xlabel() == "gap [cm]"
        rows = gap[(gap[list(panel)] == list(panel.values())).all(axis=1)].sort_values("height")
        lines = {line.get_label(): line for line in ax.get_lines() if not line.get_label().startswith("_")}
        for rule, of_rule in rows.groupby("rule"):
            line = lines.pop("exact, mean" if rule == "exact" else rule)
            np.testing.assert_allclose(line.get_xdata(), 100 * of_rule["mean"])
            np.testing.assert_allclose(line.get_ydata(), of_rule["height"])
        exact = rows[rows["rule"] == "exact"]
        contact = lines.pop("exact, contact 10 %")
        np.testing.assert_allclose(contact.get_xdata(), 100 * exact["contact_10"])
        np.testing.assert_allclose(contact.get_ydata(), exact["height"])
        assert not lines
        here = link[(link[list(panel)] == list(panel.values())).all(axis=1)].merge(exact[[*FLOOR_KEYS, "height"]])
        grey = [line for line in ax.get_lines() if to_hex(line.get_color()) == to_hex("0.75")]
        assert len(grey) == len(results.names("record"))
        drawn = sorted(tuple(zip(line.get_ydata(), line.get_xdata(), strict=True)) for line in grey)
        expected = sorted(
            tuple(zip(closings["height"], 100 * closings["max_closing"], strict=True))
            for _, closings in here.sort_values("height").groupby("record")
        )
        np.testing.assert_allclose(drawn, expected)
        most = np.max([line.get_xdata() for line in grey], axis=0)
        np.testing.assert_allclose(most, 100 * exact["largest"])  # of the same floors
        assert ax.get_xlim()[0] == 0
        assert ax.get_xlim()[1] >= 100 * rows["largest"].max()
        _check_band(ax, exact)
    names = [each.get_text() for each in figure.legends[0].get_texts()]
    assert names[0] == "exact, mean"
    assert set(names) == {"exact, mean", "exact, contact 10 %"} | set(gap["rule"]) - {"exact"}


def _check_band(ax, exact: pd.DataFrame) -> None:
    """The band of confidence lies between the ends of the interval, or there is none of few motions."""
    if exact["contact_10_low"].isna().all():
        return
    (band,) = ax.collections
    corners = band.get_paths()[0].vertices
    for low, high, height in zip(exact["contact_10_low"], exact["contact_10_high"], exact["height"], strict=True):
        at_height = corners[np.isclose(corners[:, 1], height), 0]
        assert (at_height.min(), at_height.max()) == pytest.approx((100 * low, 100 * high))


def test_the_figure_is_of_the_point_that_the_sentence_names(solve):
    results = solve(STUDY + "sweep: {buildings.B.period: [0.4 s, 0.5 s, 0.7 s]}\n")
    (picture,) = list_figures(results)
    figure = picture.draw()
    gap = results.table("gap")
    here = gap[(gap["buildings.B.period"] == 0.5) & (gap["rule"] == "exact") & (gap["analysis"] == "elastic")]
    (line,) = (each for each in figure.axes[0].get_lines() if each.get_label() == "exact, mean")
    np.testing.assert_allclose(line.get_xdata(), 100 * here.sort_values("height")["mean"])
    assert figure.get_label().startswith("At buildings.B.period = 0.5 s. ")


def test_no_figure_where_nothing_is_known(solve):
    assert list_figures(retell(solve(STUDY), {}, {})) == []


# Tables


@pytest.mark.parametrize("width", [80, 120, 200])
@pytest.mark.parametrize("text", [STUDY, FLOORS, THREE, HAZARD])
def test_tables_fit_the_terminal(solve, text, width):
    lines = list(build_report(solve(text)).summary.iter_lines(width))
    lines = "\n".join(lines).splitlines()
    assert max(map(len, lines)) <= width
    assert "…" not in "".join(lines)


def test_captions_say_what_is_the_same_in_all_rows(solve):
    pair = {table.caption.partition(":")[0]: table for table in list_tables(solve(STUDY))}
    gap = pair["Required gap at the floors whose mean over the motions is the widest"]
    assert gap.caption.endswith(": A | B, floor 2")
    assert [column.head for column in gap.columns][:4] == ["analysis", "rule", "mean [cm]", "largest [cm]"]
    cases = pair["Gaps of the cases and required gaps, both at the governing floors"]
    assert cases.caption.endswith(": case near, A | B")
    line = pair["Distance to a property line, at the floors whose mean over the motions is the largest"]
    assert line.caption.endswith("largest")
    single = STUDY.replace("storeys: 3", "storeys: 2") + "analyses: [elastic]\n"
    assert list_tables(solve(single))[-1].caption.endswith("largest: floor 2, elastic")
    three = {table.caption.partition(":")[0]: table for table in list_tables(solve(THREE))}
    assert "between" in [column.head for column in three[gap.caption.partition(":")[0]].columns]


def test_cells_are_those_of_the_frames(solve):
    """Two decimals of the same row: the mean in cm, the count of motions for which the gap is enough."""
    results = solve(FLOORS)
    tables = {table.caption.partition(":")[0]: table for table in list_tables(results)}
    gap = tables["Required gap at the floors whose mean over the motions is the widest"]
    for cells, row in zip(gap.cells(), gap.frame.to_dict("records"), strict=True):
        by_head = dict(zip(gap.heads(), cells, strict=True))
        assert by_head["between"] == f"{row['left']} | {row['right']}"
        assert float(by_head["mean [cm]"]) == pytest.approx(100 * row["mean"], rel=1e-3)
        assert float(by_head["largest [cm]"]) == pytest.approx(100 * row["largest"], rel=1e-3)
        contact = by_head["contact 10 % [cm]"]
        if row["rule"] == "exact":
            numbers = [float(each) for each in contact.replace("(", "").replace(")", "").replace("to ", "").split()]
            expected = [100 * row[f"contact_10{end}"] for end in ("", "_low", "_high")]
            assert numbers == pytest.approx(expected, rel=1e-2)
    units = {
        name: results.column("gap", name).unit.name for name in ("mean", "std", "contact_10_low", "error", "height")
    }
    assert units == dict.fromkeys(("mean", "std", "contact_10_low", "error"), "cm") | {"height": "m"}
    exact = results.table("gap")
    exact = exact[exact["rule"] == "exact"]
    widest = exact.groupby(["left", "right", "analysis"])["mean"].max()
    shown = gap.frame[gap.frame["rule"] == "exact"].groupby(["left", "right", "analysis"])["mean"].max()
    assert shown.to_dict() == widest.to_dict()
    cases = tables["Gaps of the cases and required gaps, both at the governing floors"]
    for cells, row in zip(cases.cells(), cases.frame.to_dict("records"), strict=True):
        by_head = dict(zip(cases.heads(), cells, strict=True))
        assert by_head["enough"] == row["enough"]
        assert by_head["for motions"] == (f"{row['enough_for']} of {row['motions']}" if row["motions"] else "–")


def test_no_xarray_and_no_matplotlib_for_an_answer(solve, tmp_path):
    """Of what this question itself imports to answer, and to print sentences and tables."""
    import subprocess
    import sys

    code = (
        "import sys\nfrom pathlib import Path\nfrom pounding_cli.questions import load_question\n"
        "from pounding_cli.results.results import ResultTables\nresults = ResultTables(Path(sys.argv[1]))\n"
        "question = load_question('gap')\nimport pounding_cli.questions.gap.question\n"
        "question.sentences(results), question.shown_tables(results), question.notes(results)\n"
        "print([name for name in ('xarray', 'matplotlib', 'scipy.stats') if name in sys.modules])"
    )
    path = str(Path(solve(STUDY).path).resolve())
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"

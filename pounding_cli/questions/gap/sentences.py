"""The answer of `pound gap` in sentences: are the gaps of the cases enough, and what do the buildings need?"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pounding_cli.numbers import Unit, format_number, pluralize
from pounding_cli.questions.gap.evidence import (
    CaseEntry,
    GapEvidence,
    Need,
    describe_facing_place,
    select_exact,
    select_widest,
)
from pounding_cli.questions.gap.neighbour_words import describe_neighbour_spread, describe_neighbours
from pounding_cli.questions.gap.tables import CASES_TABLE, EXACT, GAP_TABLE, NO, RATE_TABLE, UNKNOWN, YES
from pounding_cli.questions.gap.written_gaps import read_written_gaps
from pounding_cli.questions.hazard import YEARS
from pounding_cli.tables import Column, Row

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

KINDS = {"elastic": "elastic", "inelastic": "yielding"}
"""Analysis -> what buildings are in it."""

MAX_DIGITS = 9
"""Significant digits of a required gap that is told apart from a gap close to it."""

MAX_GAPS = 3
"""Gaps of one case that are listed; of more the ends are told."""


def list_sentences(results: ResultTables) -> list[str]:
    """Return the answer: the rate that is asked for, then of every pair of neighbours what the motions require."""
    frame = results.answer(GAP_TABLE).frame
    if select_exact(frame).empty:
        return [_describe_failure(results)]
    evidence = GapEvidence(results)
    point = f"At {evidence.shown.label}: " if evidence.shown.label else ""
    sentences = [describe_neighbours(evidence, pair) for pair in evidence.pairs]
    sentences += [describe_neighbour_spread(evidence, pair) for pair in evidence.pairs]
    if RATE_TABLE in results.answers:
        sentences += [_describe_rate(evidence, pair) for pair in evidence.pairs]
    failed = [_describe_failed_analysis(evidence, analysis) for analysis in evidence.analyses]
    for pair in evidence.pairs:
        needs = evidence.find_needs(pair)
        if needs:
            parts = [*_describe_answer(evidence, pair, needs), *_describe_codes(evidence, pair, needs)]
            sentences.append(point + " ".join(parts))
    sentences += [f"{point}{sentence}" for sentence in failed if sentence]
    sentences += [_describe_contact(evidence, pair) for pair in evidence.pairs]
    sentences += [_describe_sweep(evidence, pair) for pair in evidence.pairs]
    return [sentence for sentence in sentences if sentence]


# Runs that failed


def _describe_failure(results: ResultTables) -> str:
    """Return why there is no answer."""
    counts = results.scene()["status"].value_counts()
    outcomes = ", ".join(f"{count} {status}" for status, count in counts.items())
    cases = results.answer(CASES_TABLE).frame
    if len(cases):
        consequence = "the gaps were compared with the rules of codes only"
    elif _compares_cases(results):
        consequence = "the gaps were not checked"
    else:
        consequence = "the required gaps are not known"
    return f"All runs failed ({outcomes}); {consequence}."


def _compares_cases(results: ResultTables) -> bool:
    """Return whether the study has a case with a gap."""
    return any(read_written_gaps(results).values())


def _describe_failed_analysis(evidence: GapEvidence, analysis: str) -> str:
    """Return that all runs of an analysis failed, or all of some pairs that nothing links to the others; "" else."""
    pairs = evidence.list_failed_pairs(analysis)
    if not pairs:
        return ""
    has_others = any(analysis in evidence.find_needs(pair) for pair in evidence.pairs)
    where = f"Between {_join([' | '.join(pair) for pair in pairs])} all" if has_others else "All"
    return f"{where} runs of {KINDS[analysis]} buildings failed; their gaps were not checked."


# Are the gaps enough?


def _describe_answer(evidence: GapEvidence, pair: tuple[str, str], needs: Mapping[str, Need]) -> Iterator[str]:
    """Yield sentences on what two neighbours need, and whether the gaps of the cases are enough.

    needs : by analysis, at the floors where one motion requires most
    """
    entries = evidence.list_entries(pair)
    if not entries:
        yield f"{' | '.join(pair)} need {_join_needs(evidence, needs, _describe_kind)}."
        return
    where = f"Between {' and '.join(pair)} " if len(evidence.pairs) > 1 else ""
    names_cases = evidence.cases["case"].nunique() > 1
    for alike in _group_entries(entries, _required_gaps):
        verdicts = []
        for same in sorted(_group_entries(alike, _verdicts), key=lambda group: _rank(group[0])):
            subject = _describe_gaps(same, evidence.unit, names_cases)
            verdicts.append(f"{subject} {_describe_verdict(same)}")
        gaps = {analysis: [entry.needs[analysis].gap for entry in alike] for analysis in alike[0].needs}
        reasons = _join_needs(evidence, alike[0].needs, lambda *need: _describe_subject(evidence, pair, *need), gaps)
        yield f"{where}{', '.join(verdicts)}: {reasons}."
    yield from _describe_neighbours(evidence, pair, entries)


def _group_entries(entries: Iterable[CaseEntry], key: Any) -> list[list[CaseEntry]]:
    groups: dict[Any, list[CaseEntry]] = {}
    for entry in entries:
        groups.setdefault(key(entry), []).append(entry)
    return list(groups.values())


def _required_gaps(entry: CaseEntry) -> tuple[Any, ...]:
    return tuple((analysis, need.required, need.floors) for analysis, need in entry.needs.items())


def _verdicts(entry: CaseEntry) -> tuple[str, ...]:
    return tuple(need.enough for need in entry.needs.values())


def _rank(entry: CaseEntry) -> tuple[bool, bool]:
    """Return what sorts gaps that are enough before those that are not."""
    verdicts = _verdicts(entry)
    return set(verdicts) != {YES}, set(verdicts) == {NO}


def _describe_gaps(entries: Sequence[CaseEntry], unit: Unit, names_cases: bool) -> str:
    """Return the gaps of some cases: "5 cm (near)", "5 mm to 40 mm (8 gaps)", "top (15 mm at floor 2)"."""
    uneven = [f"{entry.case} ({_describe_uneven_gap(entry, unit)})" for entry in entries if not entry.is_uniform]
    cases_by_gaps: dict[tuple[str, ...], list[str]] = {}
    for of_case in _group_entries([entry for entry in entries if entry.is_uniform], lambda entry: entry.case):
        gaps = sorted({next(iter(entry.needs.values())).gap for entry in of_case})
        cases_by_gaps.setdefault(tuple(map(unit.text, gaps)), []).append(of_case[0].case)
    parts = []
    for texts, cases in cases_by_gaps.items():
        details = [_join(cases)] if names_cases else []
        if len(texts) > MAX_GAPS:
            details.append(f"{len(texts)} gaps")
        gap = _join(texts) if len(texts) <= MAX_GAPS else f"{texts[0]} to {texts[-1]}"
        parts.append(f"{gap} ({', '.join(details)})" if details else gap)
    return _join([*parts, *uneven])


def _describe_uneven_gap(entry: CaseEntry, unit: Unit) -> str:
    """Return the gap of a case at its governing floors, by analysis where it differs."""
    places = [f"{unit.text(need.gap)} at {need.floors}" for need in entry.needs.values()]
    return " and ".join(dict.fromkeys(places))


def _join(texts: Sequence[str]) -> str:
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"


def _describe_verdict(entries: Sequence[CaseEntry]) -> str:
    """Return whether gaps are enough, behind their names: "is not enough"."""
    is_several = len(entries) > 1
    verb = "are" if is_several else "is"
    needs = entries[0].needs
    phrases = {YES: f"{verb} enough", NO: f"{verb} not enough", UNKNOWN: f"{verb} not known to be enough"}
    kinds: dict[str, list[str]] = {}
    for analysis, need in needs.items():
        kinds.setdefault(need.enough, []).append(KINDS[analysis])
    if len(kinds) == 1:
        return phrases[next(iter(kinds))]
    ordered = [verdict for verdict in (YES, UNKNOWN, NO) if verdict in kinds]
    first, second = ordered
    last = phrases[second].removeprefix(f"{verb} ")
    link = "but" if first == YES else "and"
    return f"{phrases[first]} for {kinds[first][0]} buildings {link} {last} for {kinds[second][0]} ones"


def _describe_neighbours(
    evidence: GapEvidence, pair: tuple[str, str], entries: Sequence[CaseEntry]
) -> Iterator[str]:  # fmt: skip
    """Yield where the answer does not hold: gaps that are enough beside a building that its other neighbour strikes."""
    enough = {
        (entry.case, analysis) for entry in entries for analysis, need in entry.needs.items() if need.enough == YES
    }
    for other in evidence.pairs:
        if other == pair or not set(other) & set(pair):
            continue
        striking = {
            entry.case
            for entry in evidence.list_entries(other)
            for analysis, need in entry.needs.items()
            if need.enough != YES and (entry.case, analysis) in enough
        }
        if striking:
            cases = f" in {_join(sorted(striking))}" if evidence.cases["case"].nunique() > 1 else ""
            yield (
                f"That {' and '.join(pair)} do not touch{cases} holds only while {' and '.join(other)} do not touch, "
                "between which the gap is not enough."
            )


# What the buildings need


def _join_needs(
    evidence: GapEvidence,
    needs: Mapping[str, Need],
    describe: Any,
    gaps: Mapping[str, Sequence[float]] | None = None,
) -> str:
    """Return what two neighbours need, analysis by analysis.

    describe : analysis, width with its unit, whether it comes first -> words
    gaps : by analysis the gaps that the widths are compared with [m]
    """
    words: list[str] = []
    previous: Need | None = None
    for analysis, need in needs.items():
        width = _format_width(need.required, evidence.unit, (gaps or {}).get(analysis, ()))
        basis = _describe_basis(need, previous, evidence.unit)
        words.append(describe(analysis, width, not words) + (f" ({basis})" if basis else ""))
        previous = need
    return ", ".join(words)


def _describe_kind(analysis: str, width: str, is_first: bool) -> str:
    return f"{width} as {KINDS[analysis]} {'buildings' if is_first else 'ones'}"


def _describe_subject(evidence: GapEvidence, pair: tuple[str, str], analysis: str, width: str, is_first: bool) -> str:
    if evidence.has_wall(pair):
        return f"the {KINDS[analysis]} {'building needs' if is_first else 'one'} {width}"
    return f"{KINDS[analysis]} {'buildings need' if is_first else 'ones'} {width}"


def _describe_basis(need: Need, previous: Need | None, unit: Unit) -> str:
    """Return which motions and floors a width rests on; "" where the need before says so.

    previous : the need before
    """
    floors = "" if need.is_widest and not need.twists else f", at {need.floors}"
    is_same = previous is not None and (previous.motions, previous.is_widest and need.is_widest) == (need.motions, True)
    if previous is not None and (need.twists or previous.twists):
        is_same = is_same and need.floors == previous.floors
    mean = f"mean{'' if need.is_widest else ' there'} {unit_text(need.mean, unit)}"
    within = "within the numerical error of the gap; " if need.enough == NO and need.required <= need.gap else ""
    if is_same:
        return within.removesuffix("; ")
    if need.motions == 1 and not need.failed:
        return f"{within}1 motion{floors}"
    motions = f"largest of {pluralize(need.motions, 'motion')}"
    failed = f"; {pluralize(need.failed, 'more run')} failed" if need.failed else ""
    return f"{within}{motions}{floors}; {mean}{failed}"


def unit_text(value: float, unit: Unit) -> str:
    """Return a width for a sentence, in the unit of the study: "17.1 cm"."""
    return f"{format_number(value / unit.factor, 3)} {unit.name}"


def _format_width(width: float, unit: Unit, gaps: Sequence[float]) -> str:
    """Return a width with as many digits as tell it from the gaps that it is compared with."""
    for digits in range(3, MAX_DIGITS):
        rounded = float(f"{width / unit.factor:.{digits}g}")
        if all((rounded <= unit.number(gap)) == (width <= gap) for gap in gaps):
            break
    else:
        digits = MAX_DIGITS
    return f"{format_number(width / unit.factor, digits)} {unit.name}"


def _describe_codes(evidence: GapEvidence, pair: tuple[str, str], needs: Mapping[str, Need]) -> Iterator[str]:
    """Yield in a sentence what codes ask for, beside what the motions require, and what their gaps are worth."""
    groups: dict[tuple[str, str], list[tuple[str, Mapping[str, Row]]]] = {}
    for rule, gap in evidence.iter_code_gaps(pair):
        worth = evidence.find_worth(pair, rule)
        alike = (_compare_with_needs(gap, needs), _count_closing(worth))
        groups.setdefault(alike, []).append((f"{rule} {unit_text(gap, evidence.unit)}", worth))
    parts = []
    for (comparison, counts), rules in groups.items():
        closing = counts.replace(" it", " them", 1) if len(rules) > 1 else counts
        worth_parts = [part for part in (closing, _describe_code_rates([worth for _, worth in rules])) if part]
        worth_text = f" ({'; '.join(worth_parts)})" if worth_parts else ""
        parts.append(f"{_join([gap for gap, _ in rules])}, {comparison}{worth_text}")
    if parts:
        yield f"Codes: {'; '.join(parts)}."


def _count_closing(worth: Mapping[str, Row]) -> str:
    """Return how many motions close the gap of a code: "3 of 5 motions close it elastic, none of 5 yielding"; "" where
    none does.

    worth : row of CODES_TABLE by analysis
    """
    if not any(row["closed"] for row in worth.values()):
        return ""
    counts: list[str] = []
    for analysis, row in worth.items():
        motions = f"{row['closed'] or 'none'} of {row['motions']}"
        if not counts:
            motions += " motion closes it" if row["motions"] == 1 else " motions close it"
        counts.append(f"{motions} {KINDS[analysis]}" if len(worth) > 1 else motions)
    return ", ".join(counts)


def _describe_code_rates(worths: Sequence[Mapping[str, Row]]) -> str:
    """Return how often a year pairs with the gaps of some codes touch: "contact 0.12 % a year elastic, 0.050 to 0.060 %
    yielding"; "" where no rate is known.

    worths : rows of CODES_TABLE by analysis, of every code
    """
    parts: list[str] = []
    for analysis in worths[0]:
        rates = [worth[analysis]["rate"] for worth in worths]
        if not all(math.isfinite(rate) for rate in rates):
            return ""
        ends = dict.fromkeys(format_number(100 * rate, 2) for rate in (min(rates), max(rates)))
        kind = f" {KINDS[analysis]}" if len(worths[0]) > 1 else ""
        parts.append(f"{' to '.join(ends)} %{'' if parts else ' a year'}{kind}")
    return f"contact {', '.join(parts)}" if parts else ""


def _compare_with_needs(gap: float, needs: Mapping[str, Need]) -> str:
    """Return whether a gap is less than what two neighbours need in each analysis."""
    short = [KINDS[analysis] for analysis, need in needs.items() if gap < need.required]
    wide = [KINDS[analysis] for analysis, need in needs.items() if gap >= need.required]
    if not short:
        return "no less than these motions require"
    if not wide:
        return "less than these motions require"
    return f"less than {short[0]} buildings need, no less than {wide[0]} ones do"


def _describe_contact(evidence: GapEvidence, pair: tuple[str, str]) -> str:
    """Return the gap for the first probability of contact, at the floors whose mean is the widest; "" without one."""
    table = evidence.results.answer(GAP_TABLE)
    column = next(column for column in table.columns if column.name.startswith("contact_"))
    rows = select_widest(evidence.select_pair(evidence.gaps, pair), ["left", "right"])
    rows = rows[(rows["rule"] == EXACT) & rows[column.name].notna()]
    if rows.empty:
        return ""
    floors = " or ".join(dict.fromkeys(describe_facing_place(row) for row in rows.to_dict("records")))
    widths: list[str] = []
    article = "the " if evidence.has_wall(pair) else ""
    for row in rows.drop_duplicates("analysis").to_dict("records"):
        noun = ("one" if widths else "building") + ("" if evidence.has_wall(pair) else "s")
        widths.append(f"{column.format_with_unit(row)} for {article}{KINDS[row['analysis']]} {noun}")
    where = f" between {' and '.join(pair)}" if len(evidence.pairs) > 1 else ""
    share = column.name.removeprefix("contact_")
    sentence = f"A probability of contact of {share} % at {floors}{where} needs {', '.join(widths)}."
    return _add_point(evidence.shown.label, sentence)


def _add_point(point: str, sentence: str) -> str:
    """Return a sentence with the point of the sweep that it holds at before it; "" of a study without a sweep."""
    return f"At {point}: {sentence[0].lower()}{sentence[1:]}" if point else sentence


def _describe_rate(evidence: GapEvidence, pair: tuple[str, str]) -> str:
    """Return the gap for the annual rate of contact that the study asks for."""
    table = evidence.results.answer(RATE_TABLE)
    rows = evidence.select_pair(evidence.shown.rows_here(table.frame), pair).to_dict("records")
    if not rows:
        return ""
    point = evidence.shown.format_point(table.frame)  # without the intensity
    column: Column = table.column("gap")
    known = [row for row in rows if math.isfinite(row["gap"])]
    where = f"{' and '.join(pair)} touch" if len(evidence.pairs) > 1 else "the buildings touch"
    often = describe_rate(rows[0])
    if not known:
        return _add_point(point, f"No gap is known with which {where} {often}.")
    widths = [
        f"{column.format_with_unit(row)} as {KINDS[row['analysis']]} {'ones' if number else 'buildings'}"
        for number, row in enumerate(known)
    ]
    return _add_point(point, f"So that {where} {often}, they need {', '.join(widths)}.")


def describe_rate(row: Row) -> str:
    """Return an annual rate in words: "once in 2475 years (2 % in 50 years)"."""
    probability = f"{format_number(100 * row['probability'], 3)} % in {YEARS:g} years"
    return f"once in {1 / row['rate']:.4g} years ({probability})"


def _describe_sweep(evidence: GapEvidence, pair: tuple[str, str]) -> str:
    """Return between which values the required gap lies over the sweep; "" where nothing is swept."""
    frame = evidence.results.answer(GAP_TABLE).frame
    keys = [key for key in evidence.results.axes if key in frame]
    exact = select_exact(evidence.select_pair(frame, pair))
    ranges: list[str] = []
    for analysis in evidence.analyses:
        rows = exact[exact["analysis"] == analysis]
        if rows.empty or not keys or len(rows[keys].drop_duplicates()) < 2:
            continue
        largest = rows.loc[rows.groupby(keys, sort=False)["largest"].idxmax()].sort_values("largest")
        ends = largest.iloc[[0, -1]].to_dict("records")
        low, high = (
            f"{unit_text(end['largest'], evidence.unit)} ({_describe_point(evidence, keys, end)})" for end in ends
        )
        subject = f"{KINDS[analysis]} {'ones' if ranges else 'buildings need'}"
        ranges.append(f"{subject} {low} to {high}")
    where = f" {' | '.join(pair)}:" if len(evidence.pairs) > 1 else ""
    return f"Over the sweep{where or ','} {'; '.join(ranges)}, the largest of the motions." if ranges else ""


def _describe_point(evidence: GapEvidence, keys: Sequence[str], row: Mapping[Any, Any]) -> str:
    return ", ".join(f"{key} = {evidence.results.value_label(key, row[key])}" for key in keys)

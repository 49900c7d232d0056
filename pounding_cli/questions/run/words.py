"""The sentences of a run: how pounding changes the response of every building, and how far the numbers go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.errors import Issue
from pounding_cli.laws.apart import Apart
from pounding_cli.model.scene import Analysis
from pounding_cli.numbers import Unit, join_limited, pluralize
from pounding_cli.questions.neighbours import note_median_buildings
from pounding_cli.questions.run.ranking import describe_ranking
from pounding_cli.questions.run.tables import BEYOND_MARK, PEAKS, build_means_table, build_peaks_table
from pounding_cli.questions.run.twist import (
    CONTACT_MARK,
    does_twist,
    does_twist_anywhere,
    format_length,
    has_lines_across,
    keep_lines_along,
    line_values,
    list_twist_tables,
)
from pounding_cli.questions.statements import STATEMENTS, view_verdicts
from pounding_cli.report.background import describe_accuracy, list_advice
from pounding_cli.report.evidence import MARK, Evidence, describe_motions, find_nominal, list_acting_keys
from pounding_cli.results.columns import CONTACT_STIFFNESS_UNKNOWN
from pounding_cli.results.flags import failed_scenes, flag_groups_of, is_void
from pounding_cli.results.plausible import MAX_DUCTILITY
from pounding_cli.solver.response import DONE, OUTCOMES

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables
    from pounding_cli.tables import Table

MIN_CHANGE = 0.005
"""Change of a response from which a sentence gives a number [-]."""

MAX_TOLD_CASES = 4
"""Cases that a sentence names; of more it names the first and gives the range of the others."""


@dataclass(frozen=True)
class ComparedResponse:
    """A response by which a building with pounding is compared with the same building alone.

    ratio : variable of results
    noun : in a sentence
    """

    analysis: str
    ratio: str
    noun: str


ELASTIC_SHEARS = ComparedResponse(Analysis.ELASTIC, "V_ratio", "elastic storey shears")
DUCTILITIES = ComparedResponse(Analysis.INELASTIC, "mu_ratio", "ductility demands")
INELASTIC_SHEARS = ComparedResponse(Analysis.INELASTIC, "V_ratio", "inelastic storey shears")


@dataclass(frozen=True)
class ResponseChange:
    """The change of a response of one building in one case, over its storeys, as ratios to the building alone.

    highest, storey : largest mean over the motions, and its storey
    lowest : smallest mean over the motions of any storey
    peak, peak_storey, peak_motion : largest ratio of a single motion, and where
    motions : number of motions that the means are of
    is_apart : whether no link of the case acts under any motion
    line, peak_line : where floors twist, the frame lines from 1 of the largest mean and of the largest ratio, and the
        ratios are those of frame lines; 0 of others
    has_lines_across : whether the building has frame lines across the row too, which the ratios leave out
    """

    case: str
    highest: float
    storey: int
    lowest: float
    peak: float
    peak_storey: int
    peak_motion: str
    motions: int
    is_apart: bool
    line: int = 0
    peak_line: int = 0
    has_lines_across: bool = False

    @property
    def is_rise(self) -> bool:
        """True where pounding raises the response of some storey."""
        return self.highest > 1 + MIN_CHANGE

    @property
    def is_fall(self) -> bool:
        """True where pounding lowers the response of some storey and raises that of none."""
        return not self.is_rise and self.lowest < 1 - MIN_CHANGE

    @property
    def size(self) -> str:
        """The largest change in words: "18 %", "2.4-fold"."""
        return _format_rise(self.highest) if self.is_rise else _format_percent(1 - self.lowest)

    @property
    def amount(self) -> str:
        """The largest change behind a verb: "by up to 18 %", "up to 2.4-fold"."""
        return f"up to {self.size}" if self.size.endswith("fold") else f"by up to {self.size}"


def list_sentences(results: ResultTables) -> list[str]:
    """Return the answer in sentences: what pounding does to every building, at one point of a sweep."""
    evidence = find_nominal(results)
    statuses = evidence.values("status")
    if not np.isin(statuses, OUTCOMES).any():
        return ["All time histories failed: there is no result to show."]
    sentences = [*_describe_failures(results), *_describe_collapses(evidence)]
    approach = _describe_open_gaps(evidence)
    if approach:
        sentences.append(approach)
    else:
        sentences += filter(None, [describe_ranking(evidence)])
        for building in [
            evidence.main_building,
            *(each for each in evidence.buildings_without_walls if each != evidence.main_building),
        ]:
            sentences += _describe_building(evidence, building)
    sentences += _describe_meaningless(evidence)
    if evidence.label and sentences:
        sentences[0] = f"At {evidence.label}: {sentences[0]}"
    sentences = [_capitalise_case(sentence) for sentence in sentences]
    return [*sentences, *_describe_sweep(results, evidence)]


def list_tables(results: ResultTables) -> list[Table]:
    """Return the tables that a terminal prints."""
    tables = [view_verdicts(results)] if STATEMENTS in results.answers else []
    tables.append(build_peaks_table(results))
    if not np.isfinite(results.values("V_ratio")).any():
        return tables
    evidence = find_nominal(results)
    return [*tables, build_means_table(evidence), *list_twist_tables(evidence)]


def list_notes(results: ResultTables) -> list[Issue | str]:
    """Return how far the numbers go, and what a reader should know of them."""
    evidence = find_nominal(results)
    scene = results.scene()
    accuracy = f"{describe_accuracy(scene, results.units)} {describe_motions(evidence.records)}"
    notes: list[Issue | str] = [accuracy, *_explain_table(results)]
    if median := note_median_buildings(results):
        notes.append(median)
    if len(evidence.cases) > len(evidence.plotted_cases):
        notes.append(f"Figures show {len(evidence.plotted_cases)} of the {len(evidence.cases)} cases.")
    notes += [group.to_issue(MARK) for group in flag_groups_of(scene, results.units)]
    advice = list_advice(results)  # warnings are printed before a run
    if len(results.struck_links()):
        for each in advice:
            if each.code == "stiffness" and each.code not in results.accepted:
                notes.append(replace(each, message=f"{CONTACT_MARK} {each.message}"))
                break
        else:
            notes.append(f"{CONTACT_MARK} {CONTACT_STIFFNESS_UNKNOWN}")
    return [*notes, *(each for each in advice if each.code != "stiffness")]


# How buildings respond


def find_changes(evidence: Evidence, building: str, response: ComparedResponse) -> list[ResponseChange]:
    """Return the changes of a response of a building in every case that has them, the largest rise first.

    Of many cases it has those that the study draws (`report: {plot: ...}`).
    """
    cases = evidence.plotted_cases if len(evidence.cases) > MAX_TOLD_CASES else evidence.cases
    changes = []
    for case in cases:
        place = {"case": case, "analysis": response.analysis, "building": building}
        if does_twist(evidence, building):
            ratios = line_values(evidence, f"line_{response.ratio}", **place)
            means = line_values(evidence, f"line_{response.ratio}_mean", **place)
        else:
            ratios = evidence.values(response.ratio, **place)
            means = evidence.values(f"{response.ratio}_mean", **place)
        is_meaningless = _count_meaningless(evidence, case, response.analysis) == len(ratios)
        if not _has_links(evidence, case) or is_meaningless or not np.isfinite(means).any():
            continue
        motion, *peak_place = (int(each) for each in np.unravel_index(int(np.nanargmax(ratios)), ratios.shape))
        mean_place = [int(each) for each in np.unravel_index(int(np.nanargmax(means)), means.shape)]
        changes.append(
            ResponseChange(
                case=evidence.mark_case(case),
                highest=float(np.nanmax(means)),
                storey=mean_place[0] + 1,
                lowest=float(np.nanmin(means)),
                peak=float(np.nanmax(ratios)),
                peak_storey=peak_place[0] + 1,
                peak_motion=evidence.names("record")[motion],
                motions=int(np.isfinite(ratios.reshape(len(ratios), -1)).any(axis=1).sum()),
                is_apart=not _acts(evidence, case, response.analysis),
                line=mean_place[1] + 1 if mean_place[1:] else 0,
                peak_line=peak_place[1] + 1 if peak_place[1:] else 0,
                has_lines_across=has_lines_across(evidence, building),
            )
        )
    return sorted(changes, key=lambda change: -change.highest)


def _describe_building(evidence: Evidence, building: str) -> list[str]:
    """Return a sentence an analysis on what pounding does to a building."""
    responses = []
    if Analysis.ELASTIC in evidence.analyses:
        responses.append(ELASTIC_SHEARS)
    if Analysis.INELASTIC in evidence.analyses:
        place = {"analysis": Analysis.INELASTIC, "building": building}
        yields = np.isfinite(evidence.values("mu_ratio", **place)).any()
        responses.append(DUCTILITIES if yields else INELASTIC_SHEARS)
    sentences = []
    for response in responses:
        changes = find_changes(evidence, building, response)
        if changes:
            sentences.append(describe_changes(changes, building, response.noun, len(evidence.names("record"))))
    return sentences


def describe_changes(changes: Sequence[ResponseChange], building: str, noun: str, motions: int) -> str:
    """Return in a sentence how a response of a building changes in some cases, the largest rise first.

    noun : the response
    motions : number of motions of the study
    """
    rises = [change for change in changes if change.is_rise]
    falls = sorted((change for change in changes if change.is_fall), key=lambda change: change.lowest)
    unchanged = [change for change in changes if not (change.is_rise or change.is_fall)]
    clauses = []
    subject = f"the {noun} of {building}"
    afterwards = "them"
    named_line = 0
    if any(change.line for change in changes):  # floors twist
        noun = noun.replace("storey shears", "shears")
        all_lines = _name_lines(any(change.has_lines_across for change in changes))
        subject = f"the {noun} of the {all_lines} of {building}"
        lines = {change.line for change in rises}
        if len(lines) == 1:
            named_line = lines.pop()
            subject = f"the {noun} of line {named_line} of {building}"
            afterwards = f"those of all its {all_lines}"
    for verb, group in (("raises", rises), ("lowers", falls)):
        if group:
            clauses.append(_describe_group(verb, group, subject, motions, named_line))
            subject = afterwards
    if unchanged:
        clauses.append(_describe_unchanged(unchanged, subject))
    return f"{'; '.join(clauses)}."


def _name_lines(has_across: bool) -> str:
    """Return the frame lines that ratios are of in words; those across the row have no sentence.

    has_across : whether the building has lines across the row too
    """
    return "lines along the row" if has_across else "lines"


def _describe_group(verb: str, group: Sequence[ResponseChange], subject: str, motions: int, named_line: int) -> str:
    """Return a clause on the cases that raise or lower a response.

    named_line : frame line that the subject names, 0 where it names none
    """
    first, *others = group
    clause = f"case {first.case} {verb} {subject} {first.amount} ({_describe_details(first, motions, named_line)})"
    if len(others) < MAX_TOLD_CASES:
        return ", ".join([clause, *(f"{change.case} {change.amount}" for change in others)])
    most = others[0]
    least = others[-1]
    return f"{clause}, {len(others)} others by {least.size} ({least.case}) to {most.size} ({most.case})"


def _describe_details(change: ResponseChange, motions: int, named_line: int) -> str:
    """Return where a change is largest, and the largest rise of a single motion."""
    storey = _format_place(change.line, change.storey, named_line) if change.is_rise else ""
    if motions == 1:
        return storey or _describe_highest(change)
    known = str(motions) if change.motions == motions else f"{change.motions} of {motions}"
    mean = f"mean of {known} motions" if change.motions > 1 else f"{change.peak_motion} alone of {motions} motions"
    is_elsewhere = (change.peak_line, change.peak_storey) != (change.line, change.storey) or not change.is_rise
    place = [_format_place(change.peak_line, change.peak_storey, named_line)] if is_elsewhere else []
    if change.peak > 1 + MIN_CHANGE:
        word = "largest" if change.is_rise else "but largest rise"
        peak = ", ".join([f"{word} {_format_rise(change.peak)}", *place, change.peak_motion])
    else:
        peak = "no motion raises them"
    if change.motions == 1:
        return ", ".join(filter(None, (storey, mean)))
    return f"{', '.join(filter(None, (storey, mean)))}; {peak}"


def _describe_highest(change: ResponseChange) -> str:
    """Return by how little a case lowers a response at least."""
    least = 1 - change.highest
    line = "such line" if change.has_lines_across else "line"
    part = f"storey of every {line}" if change.line else "storey"
    if least > MIN_CHANGE:
        return f"by {_format_percent(least)} or more in every {part}"
    return f"no {line} rises" if change.line else "no storey rises"


def _format_place(line: int, storey: int, named_line: int) -> str:
    """Return a storey in words, with its frame line where floors twist and the sentence names another one or none."""
    return f"storey {storey}" if line == named_line else f"line {line}, storey {storey}"


def _describe_unchanged(group: Sequence[ResponseChange], subject: str) -> str:
    apart = [change.case for change in group if change.is_apart]
    small = [change.case for change in group if not change.is_apart]
    clauses = []
    if small:
        verb = "changes" if len(small) == 1 else "change"
        clauses.append(f"{_join_cases(small)} {verb} {subject} by less than {_format_percent(MIN_CHANGE)}")
        subject = "them"
    if apart:
        verb = "leaves" if len(apart) == 1 else "leave"
        clauses.append(f"{_join_cases(apart)} {verb} {subject} as they are alone (no contact)")
    return "; ".join(clauses)


def _join_cases(names: Sequence[str]) -> str:
    if len(names) == 1:
        return f"case {names[0]}"
    return f"cases {join_limited(names[:-1], 200)} and {names[-1]}"


def _capitalise_case(sentence: str) -> str:
    """Return a sentence with a capital where it begins with the word case, and not with a name of the study."""
    return sentence[0].upper() + sentence[1:] if sentence.startswith(("case ", "cases ")) else sentence


def _format_percent(part: float) -> str:
    return f"{float(f'{100 * part:.2g}'):g} %"


def _format_rise(ratio: float) -> str:
    """Return a rise in percent, "18 %"; one beyond a doubling as "2.4-fold"."""
    return _format_percent(ratio - 1) if ratio <= 2 else f"{float(f'{ratio:.2g}'):g}-fold"


def _count_meaningless(evidence: Evidence, case: str, analysis: str) -> int:
    """Return under how many motions the numbers of a case mean nothing."""
    flags = evidence.values("flags", case=case, analysis=analysis)
    return sum(map(is_void, flags.tolist()))


def _describe_meaningless(evidence: Evidence) -> list[str]:
    """Return a sentence for every case and analysis whose numbers mean nothing under some motions."""
    sentences = []
    for group in evidence.flag_groups:
        if group.meaningless:
            under = "its motion" if group.of == 1 else f"{group.count} of {group.of} motions"
            sentences.append(
                f"{MARK} Case {group.case}, {group.analysis}: the numbers mean nothing under {under}, as {group.flag}."
            )
    return sentences


# Gaps, collapses, failures, sweeps


def _has_links(evidence: Evidence, case: str) -> bool:
    """Return whether a case has links that may carry a force."""
    if "kind" not in evidence.results.arrays:
        return False
    return any(kind not in ("", Apart.name) for kind in evidence.values("kind", case=case).tolist())


def _acts(evidence: Evidence, case: str, analysis: str) -> bool:
    """Return whether a link of a case carries a force under some motion."""
    if "impacts" not in evidence.results.arrays:
        return False
    place = {"case": case, "analysis": analysis}
    force = evidence.values("peak_force", **place)
    return bool((np.nan_to_num(force) > 0).any())


def _describe_open_gaps(evidence: Evidence) -> str:
    """Return that no link acts anywhere, with the closest approach of two floors; "" where one does."""
    results = evidence.results
    if any(_acts(evidence, case, analysis) for case in evidence.cases for analysis in evidence.analyses):
        return ""
    if len(evidence.group) == 1 or "gap" not in results.arrays:
        return "Every building stands alone: the study has no links, so there is no pounding."
    if not (evidence.values("status") == DONE).any():
        return ""
    left_open = evidence.values("gap")[:, None, None, :] - evidence.values("max_closing")
    if not np.isfinite(left_open).any():
        return "No link carries a force: every building responds as it does alone."
    case, analysis, motion, link = np.unravel_index(int(np.nanargmin(left_open)), left_open.shape)
    unit = results.units.get("gap") or Unit("mm", 1e-3, "m")
    closing = float(evidence.values("max_closing")[case, analysis, motion, link])
    gap = float(evidence.values("gap")[case, link])
    where = [f"case {evidence.cases[case]}", evidence.names("link")[link]]
    places = evidence.values("street")[case] if "street" in results.arrays else np.zeros(0)
    if len(set(places[np.isfinite(places)].tolist())) > 1:
        where.append(f"{format_length(float(places[link]))} along the street")
    where += [evidence.names("record")[motion]] if len(evidence.names("record")) > 1 else []
    return (
        "The floors never touch: every building responds as it does alone. The closest approach closes "
        f"{unit.text(closing, 3)} of a gap of {unit.text(gap)} ({', '.join(where)})."
    )


def _describe_collapses(evidence: Evidence) -> list[str]:
    """Return a sentence for every building and analysis on the motions under which it collapses, alone and by case."""
    arrays = evidence.results.arrays
    if "collapsed" not in arrays:
        return []
    motions = len(evidence.names("record"))
    sentences = []
    for analysis in evidence.analyses:
        for building in evidence.buildings_without_walls:
            place = {"analysis": analysis, "building": building}
            counts = {
                case: int((evidence.values("collapsed", case=case, **place) > 0).sum()) for case in evidence.cases
            }
            alone = evidence.values("collapsed0", **place) > 0
            alone_count = int(alone.any(axis=0).sum())
            if not (any(counts.values()) or alone_count):
                continue
            parts = [f"{count} in case {case}" for case, count in counts.items()]
            of = pluralize(motions, "motion")
            sentences.append(
                f"{building} collapses ({analysis}; of {of}) under {', '.join(parts)}, and under {alone_count} alone; "
                "these are left out of ratios."
            )
    return sentences


def _describe_failures(results: ResultTables) -> list[str]:
    scene = results.scene()
    failed = len(failed_scenes(scene))
    if not failed:
        return []
    return [f"{failed} of {pluralize(len(scene), 'row')} failed and {'is' if failed == 1 else 'are'} left out."]


def _describe_sweep(results: ResultTables, evidence: Evidence) -> list[str]:
    """Return where in a sweep pounding raises the responses of the main building most; nothing where it raises none."""
    if not results.axes or all(len(values) == 1 for values in results.axes.values()):
        return []
    sentences = []
    for response in (ELASTIC_SHEARS, DUCTILITIES):
        if response.analysis not in evidence.analyses:
            continue
        by_line = does_twist_anywhere(results, evidence.main_building)
        name = f"{'line_' * by_line}{response.ratio}_mean"
        array = results.arrays[name]
        values = keep_lines_along(results, name) if by_line else array.values
        analysis = array.dims.index("analysis")
        building = array.dims.index("building")
        means = values.take([evidence.analyses.index(response.analysis)], analysis)
        means = means.take([evidence.group.index(evidence.main_building)], building)
        if not np.isfinite(means).any():
            continue
        place = dict(zip(array.dims, np.unravel_index(int(np.nanargmax(means)), means.shape), strict=True))
        ratio = float(np.nanmax(means))
        noun = response.noun
        if by_line:
            all_lines = _name_lines(has_lines_across(evidence, evidence.main_building))
            noun = f"{noun.replace('storey shears', 'shears')} of the {all_lines}"
        if ratio <= 1 + MIN_CHANGE:
            sentences.append(f"Nowhere in the sweep do the {noun} of {evidence.main_building} rise.")
            continue
        case = evidence.cases[place["case"]]
        point = {key: results.axes[key][place[keys[0]]] for keys in results.swept for key in keys if keys[0] in place}
        acting = list_acting_keys(results, case)
        words = [f"{key} = {results.value_label(key, value)}" for key, value in point.items() if key in acting]
        amount = f"by up to {_format_rise(ratio)}" if ratio <= 2 else f"up to {_format_rise(ratio)}"
        motions = len(evidence.names("record"))
        mean = f", mean of {motions} motions" if motions > 1 else ""
        where = f"at {', '.join(words)}" if words else f"in case {case}, which the sweep does not change"
        line = int(place["line"]) + 1 if by_line else 0
        details = f"{_format_place(line, int(place['storey']) + 1, 0)}{mean}"
        sentences.append(
            f"Over the sweep the {noun} of {evidence.main_building} rise most {where}: {amount} "
            f"({f'case {case}, {details}' if words else details})."
        )
    return sentences


# Notes


def _explain_table(results: ResultTables) -> list[str]:
    """Return what the words and marks of the table of peaks mean, as far as it has them."""
    analyses = results.names("analysis")
    ductility = results.values("mu")[..., [name == Analysis.INELASTIC for name in analyses], :, :, :]
    has_ductility = bool(np.isfinite(ductility).any())
    ratios = {(True, True): "μ/μ₀ (V/V₀)", (True, False): "μ/μ₀", (False, True): "V/V₀"}
    ratio = ratios.get((Analysis.INELASTIC in analyses, Analysis.ELASTIC in analyses), "")
    words = ["μ: ductility demand"] if has_ductility else []
    words.append(f"{ratio}: ratio to the same building alone")
    words.append("alone: the same storey of the same building alone, under the same motion")
    words.append("drift in % of the storey height")
    if any(does_twist_anywhere(results, name) for name in results.names("building")):
        words.append(
            "where floors twist, μ and ratios are those of frame lines, and drift is that of an edge of the plan; V/V₀ "
            "and μ/μ₀ of storeys are of the sum of their lines and of the line that governs"
        )
    if "gap" in results.arrays:
        words.append(
            "gap: largest closing of two floors; floors in contact press into each other by the penetration, which the "
            "contact stiffness governs"
        )
    notes = [f"{PEAKS}: {'; '.join(words)}."]
    if has_ductility and np.nanmax(ductility) > MAX_DUCTILITY:
        notes.append(
            f"{BEYOND_MARK} A ductility above {MAX_DUCTILITY:g} is far beyond the range of the storey law: read it as "
            "failure of the storey, not as a number."
        )
    return notes

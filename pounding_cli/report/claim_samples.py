"""The paper's claims over the samples of `pound sensitivity`: how likely each holds, and which key decides it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy.stats import binomtest

from pounding_cli.report.claims import CLAIMS, Claim, Verdict, verdict
from pounding_cli.report.evidence import Evidence
from pounding_cli.results.tables import Filled, Table, column, place_columns
from pounding_cli.solver.response import DONE
from pounding_cli.workflows.indices import FOUND, independent_samples, indices
from pounding_cli.workflows.sensitivity import Series, sample_columns, stacked, texts
from pounding_cli.workflows.sensitivity_question import Question

if TYPE_CHECKING:
    from pounding_cli.study import Plan

ODDS, THRESHOLDS, VERDICTS = "sensitivity_claims", "sensitivity_thresholds", "sensitivity_verdicts"
"""Names of the tables."""

OUTCOMES = {"holds": Verdict.HOLDS, "partly": Verdict.PARTLY, "fails": Verdict.FAILS}
"""Columns of the table of claims."""

SCORES = {Verdict.HOLDS: 1.0, Verdict.PARTLY: 0.5, Verdict.FAILS: 0.0}
"""Verdicts as the number whose indices say what decides a claim."""

_STOREY, _FLOOR = ("V_ratio", "mu_ratio"), ("acceleration", "acceleration_ratio")
_LINK = ("impacts", "max_closing")


@dataclass(frozen=True, eq=False)
class Judged:
    """A claim over all samples, at one point of the other swept axes.

    point : number on every other swept axis
    verdicts : "" of a sample with a scene that failed, shape (samples,)
    numbers, passed : of every number with a threshold, by its words: NaN where there is none; 1 where it meets its
        threshold, 0 where it does not, NaN where there is no number; shape (samples,) each
    units : of the numbers
    """

    point: tuple[int, ...]
    claim: Claim
    verdicts: np.ndarray
    numbers: Mapping[str, np.ndarray]
    passed: Mapping[str, np.ndarray]
    units: Mapping[str, str]

    @property
    def series(self) -> Series:
        """SCORES of the verdicts; NaN where the claim could not be judged."""
        values = np.full(self.verdicts.shape, np.nan)
        for each, score in SCORES.items():
            values[self.verdicts == each] = score
        return Series(self.point, "", "", f"claim {self.claim.key}", "", values)


def claim_tables(plan: Plan, data: xr.Dataset, question: Question) -> tuple[list[Series], list[Table]]:
    """The verdicts of the claims that a question asks for, as numbers, and their tables."""
    judged = list(judge_samples(plan, data, question))
    tables = {
        ODDS: _odds_columns(plan, question, judged),
        THRESHOLDS: _threshold_columns(plan, question, judged),
        VERDICTS: stacked(_verdict_columns(plan, question, judged)),
    }
    return [each.series for each in judged], [Table.of(name, columns) for name, columns in tables.items()]


def judge_samples(plan: Plan, data: xr.Dataset, question: Question) -> Iterator[Judged]:
    """The claims of a question, judged at every sample; samples that come to the same values and motions once."""
    source = _Samples(plan, data, question)
    asked = [claim for claim in CLAIMS if claim.key in question.claims]
    pairs, back = np.unique(np.stack([question.place, question.motion_set]), axis=1, return_inverse=True)
    for point in np.ndindex(*(len(axis.values) for axis in plan.axes[:-1])):
        mine = [_Gathered(claim, pairs.shape[1]) for claim in asked]
        for row, (place, motions) in enumerate(pairs.T.tolist()):
            evidence = source.evidence((*point, place), motions)
            if evidence is None:
                continue
            for each in mine:
                each.judge(row, evidence)
        for each in mine:
            yield each.judged(point, back)


class _Gathered:
    """What a claim says of sample after sample, as numbers: the judgements of all samples would take much memory."""

    def __init__(self, claim: Claim, samples: int) -> None:
        self._claim, self._samples = claim, samples
        self._verdicts = np.full(samples, "", dtype=object)
        self._numbers: dict[str, np.ndarray] = {}
        self._passed: dict[str, np.ndarray] = {}
        self._units: dict[str, str] = {}  # of the numbers that counted for a verdict

    def judge(self, sample: int, evidence: Evidence) -> None:
        findings = self._claim.find(evidence)
        self._verdicts[sample] = str(verdict(findings))
        for finding in findings:
            if finding.words not in self._numbers:
                for columns in (self._numbers, self._passed):
                    columns[finding.words] = np.full(self._samples, np.nan)
            self._numbers[finding.words][sample] = finding.number
            if finding.passed is not None:
                self._passed[finding.words][sample] = finding.passed
                self._units[finding.words] = finding.unit

    def judged(self, point: tuple[int, ...], back: np.ndarray) -> Judged:
        """`back` : of every sample its row here."""
        numbers, passed = (
            {words: columns[words][back] for words in self._units} for columns in (self._numbers, self._passed)
        )
        return Judged(point, self._claim, self._verdicts[back], numbers, passed, self._units)


class _Samples:
    """The evidence at every sample, from the variables of the results file."""

    def __init__(self, plan: Plan, data: xr.Dataset, question: Question) -> None:
        self.plan, self.question = plan, question
        self.data = {name: data[name].values for name in (*_STOREY, *_FLOOR, "drift", "drift0")}
        self.done = data["status"].values == DONE
        self.has_links = bool(plan.links.places)
        if self.has_links:
            self.data |= {name: data[name].values for name in _LINK}
            self.facts = {name: data[name].values for name in ("kind", "gap")}
            self.ends = {name: data[f"link_{name}"].values for name in ("left", "right", "floor")}
        count = len(plan.records) if question.drawn is None else question.drawn.shape[1]
        self.levels = self.data["V_ratio"].shape[-1]
        self.motions = [f"motion {number}" for number in range(1, count + 1)]
        """Those of a sample: one that is drawn twice has two numbers."""
        self.frames = {
            "storey": self._index(building=plan.buildings, storey=range(1, self.levels + 1)),
            "floor": self._index(building=plan.buildings, floor=range(1, self.levels + 1)),
            "scene": self._index(),
        }

    def _index(self, **more: Sequence[Any]) -> pd.DataFrame:
        """Every combination of case, analysis, motion and what else there is, as columns."""
        plan = self.plan
        levels = {"case": plan.cases, "analysis": plan.analyses, "record": self.motions, **more}
        return (
            pd.MultiIndex.from_product(list(levels.values()), names=list(levels)).to_frame(index=False).astype(object)
        )

    def evidence(self, point: tuple[int, ...], motions: int) -> Evidence | None:
        """What the claims rest on at a point with a set of motions (`Question.drawn`); None where a scene failed."""
        drawn = self.question.drawn
        chosen = slice(None) if drawn is None else drawn[motions]
        values = {name: array[point][:, :, chosen] for name, array in self.data.items()}
        alone_failed = np.isfinite(values["drift"]) & np.isnan(values["drift0"])
        if not self.done[point][:, :, chosen].all() or alone_failed.any():
            return None
        study = self.plan.study
        used = study.motions(point)
        records = [
            {"record": name, "source": each.use.source, "scale": each.use.scale, "arias": each.use.arias}
            for name, each in used.items()
        ]
        separations = study.separations(point).tolist()
        buildings = [
            {"building": name, "period": float(study.building(point, place).periods[0]), "separation": separation}
            for place, (name, separation) in enumerate(zip(self.plan.buildings, separations, strict=True))
        ]
        return _SampleEvidence(
            title=study.title,
            resolved={"claims": study.model.claims},
            point={},
            storey=self.frames["storey"].assign(**{name: values[name].ravel() for name in _STOREY}),
            floor=self.frames["floor"].assign(**{name: values[name].ravel() for name in _FLOOR}),
            link=self._links(point, values),
            scene=self.frames["scene"],
            records=pd.DataFrame(records),
            buildings=pd.DataFrame(buildings),
            arrays=values,
        )

    def _links(self, point: tuple[int, ...], values: Mapping[str, np.ndarray]) -> pd.DataFrame:
        if not self.has_links:
            columns = ("case", "analysis", "record", "left", "right", "floor", "kind", "gap", *_LINK)
            return pd.DataFrame({name: [] for name in columns})
        shape = values["impacts"].shape
        ends = {name: np.broadcast_to(array, shape).ravel() for name, array in self.ends.items()}
        facts = {
            name: np.broadcast_to(array[point][:, None, None, :], shape).ravel() for name, array in self.facts.items()
        }
        scenes = self.frames["scene"].loc[np.repeat(self.frames["scene"].index, shape[-1])].reset_index(drop=True)
        frame = scenes.assign(**ends, **facts, **{name: values[name].ravel() for name in _LINK})
        return frame[frame["kind"] != ""].reset_index(drop=True)


@dataclass(frozen=True, eq=False)
class _SampleEvidence(Evidence):
    """Evidence whose means are taken of arrays: there are thousands of samples.

    arrays : variables of the results file, shape (cases, analyses, motions, buildings, levels)
    """

    arrays: Mapping[str, np.ndarray] = None  # type: ignore[assignment]  # a dataclass wants one, after those that have

    @cached_property
    def _means(self) -> dict[str, dict[tuple[str, str, str], pd.Series]]:
        found = {}
        for ratio in ("V_ratio", "mu_ratio", "acceleration_ratio"):
            level = pd.RangeIndex(1, self.arrays[ratio].shape[-1] + 1)
            is_number = np.isfinite(self.arrays[ratio])
            sums = np.where(is_number, self.arrays[ratio], 0.0).sum(axis=2)
            means = np.where(is_number.any(axis=2), sums / np.maximum(is_number.sum(axis=2), 1), np.nan)
            found[ratio] = {place: pd.Series(means[at], level).dropna() for at, place in self._named(means.shape[:-1])}
        return found

    @cached_property
    def _places(self) -> dict[tuple[str, str, str], pd.Series]:
        whole = self.arrays["acceleration"].swapaxes(2, 3)
        floors = range(1, whole.shape[-1] + 1)
        index = pd.MultiIndex.from_product([range(whole.shape[3]), floors], names=["record", "floor"])
        return {place: pd.Series(whole[at].ravel(), index).dropna() for at, place in self._named(whole.shape[:3])}

    def _named(self, shape: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], tuple[str, str, str]]]:
        for at in np.ndindex(shape):
            yield at, (self.cases[at[0]], self.analyses[at[1]], self.group[at[2]])


def _share(count: int, of: int, confidence: float) -> tuple[float, float, float]:
    """A probability with its exact (Clopper-Pearson) interval."""
    if not of:
        return np.nan, np.nan, np.nan
    low, high = binomtest(count, of).proportion_ci(confidence, method="exact")
    return count / of, float(low), float(high)


def _decides(question: Question, y: np.ndarray) -> tuple[str, float, float, float]:
    """The key that decides a number most, and how much, with the interval; "" where none can be named."""
    outcome, numbers = indices(question, y)
    if outcome != FOUND:
        return "", np.nan, np.nan, np.nan
    name = "total" if "total" in numbers[0] else "mu_star"
    most = max(range(len(numbers)), key=lambda factor: numbers[factor][name])
    found = numbers[most]
    if found[name] <= 0:
        return "", np.nan, np.nan, np.nan
    return question.factors[most].key, found[name], found[f"{name}_low"], found[f"{name}_high"]


def _decided_columns(found: Sequence[tuple[str, float, float, float]], question: Question, what: str) -> list[Filled]:
    measure = "total index" if question.spec.method == "sobol" else "mean elementary effect"
    interval = f"end of its {question.spec.confidence:.4g} bootstrap interval"
    return [
        column("decided_by", texts([each[0] for each in found]), f"key that decides {what} most; empty: none"),
        column("share", np.array([each[1] for each in found]), f"its {measure}", "1"),
        column("share_low", np.array([each[2] for each in found]), f"low {interval}", "1"),
        column("share_high", np.array([each[3] for each in found]), f"high {interval}", "1"),
    ]


def _odds_columns(plan: Plan, question: Question, judged: Sequence[Judged]) -> list[Filled]:
    some, confidence = independent_samples(question), question.spec.confidence
    known = [each.verdicts[some][np.isin(each.verdicts[some], list(OUTCOMES.values()))] for each in judged]
    columns = [
        *place_columns(plan.axes[:-1], [each.point for each in judged]),
        column("claim", texts([each.claim.key for each in judged]), "statement of the paper"),
        column("samples", np.array([verdicts.size for verdicts in known]), "independent samples with a verdict", "1"),
        column("failed", np.array([int((each.verdicts == "").sum()) for each in judged]), "samples that failed", "1"),
    ]
    for name, outcome in OUTCOMES.items():
        shares = [_share(int((verdicts == outcome).sum()), verdicts.size, confidence) for verdicts in known]
        words = f"probability of the verdict '{outcome}'"
        interval = f"end of its {confidence:.4g} interval (Clopper-Pearson)"
        for number, end in enumerate(("", "_low", "_high")):
            said = f"{end[1:]} {interval}: {words}" if end else words
            columns.append(column(f"{name}{end}", np.array([share[number] for share in shares]), said, "1"))
    decided = [_decides(question, each.series.values) for each in judged]
    return [*columns, *_decided_columns(decided, question, "its verdict")]


def _threshold_columns(plan: Plan, question: Question, judged: Sequence[Judged]) -> list[Filled]:
    some, confidence = independent_samples(question), question.spec.confidence
    rows = [(each, words) for each in judged for words in each.passed]
    numbers = [each.numbers[words] for each, words in rows]
    passed = [each.passed[words][some] for each, words in rows]
    shares = [_share(int(np.nansum(y)), int(np.isfinite(y).sum()), confidence) for y in passed]
    columns = [
        *place_columns(plan.axes[:-1], [each.point for each, _ in rows]),
        column("claim", texts([each.claim.key for each, _ in rows]), "statement of the paper"),
        column("number", texts([words for _, words in rows]), "a number of it that has a threshold"),
        column("unit", texts([each.units[words] for each, words in rows]), "unit of the number; - of a ratio"),
        column("met", np.array([share[0] for share in shares]), "probability that it meets its threshold", "1"),
        column("met_low", np.array([share[1] for share in shares]), "low end of the interval", "1"),
        column("met_high", np.array([share[2] for share in shares]), "high end of the interval", "1"),
    ]
    for part in (5, 50, 95):
        found = [np.percentile(y[some], part) if np.isfinite(y[some]).all() else np.nan for y in numbers]
        columns.append(column(f"percentile_{part}", np.array(found), f"percentile {part} of the number"))
    return [*columns, *_decided_columns([_decides(question, y) for y in numbers], question, "the number")]


def _verdict_columns(plan: Plan, question: Question, judged: Sequence[Judged]) -> Iterator[list[Filled]]:
    """All samples with their verdicts; a block for each point of the other axes."""
    for point in dict.fromkeys(each.point for each in judged):
        mine = [each for each in judged if each.point == point]
        said = [column(f"claim {each.claim.key}", each.verdicts, "verdict; empty: a scene failed") for each in mine]
        yield [*sample_columns(plan, question, point), *said]

"""How a statement of the paper is judged: numbers found against a stated threshold, and their verdict."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from pounding_cli.report.evidence import Evidence
from pounding_cli.study.claim_names import CLAIMS


class Verdict(StrEnum):
    """What the findings say about a statement."""

    HOLDS = "holds"
    PARTLY = "holds partly"
    FAILS = "does not hold"
    UNTESTED = "not tested here"


@dataclass(frozen=True)
class Finding:
    """One number found, in words, and whether it meets its threshold.

    words : what the number is
    number : the number; NaN where the results have none
    unit : "-" (ratio), "%" or "cm", the unit of `number`
    passed : None where the number is for information only, or could not be found
    """

    words: str
    number: float
    unit: str = "-"
    passed: bool | None = None

    @property
    def text(self) -> str:
        """The number with its unit; a dash where there is none."""
        if math.isnan(self.number):
            return "–"
        if self.unit == "-":
            return _plain(self.number, 3)
        return f"{_plain(self.number, 1 if self.unit == 'cm' or abs(self.number) < 10 else 0)} {self.unit}"


def _plain(number: float, digits: int) -> str:
    """The number with so many digits; a zero has no sign."""
    text = f"{number:.{digits}f}"
    return text.removeprefix("-") if float(text) == 0 else text


def found(words: str, number: float, test: Callable[[float], bool], unit: str = "-") -> Finding:
    """A finding that counts for the verdict, unless its number is NaN."""
    number = float(number)
    return Finding(words, number, unit, None if math.isnan(number) else bool(test(number)))


@dataclass(frozen=True)
class Claim:
    """One statement of the paper.

    key : short name, in tables
    paper : the paper's words
    rule : the thresholds, in words
    find : the numbers at one point of the sweep
    """

    key: str
    paper: str
    rule: str
    find: Callable[[Evidence], Sequence[Finding]]

    @property
    def figures(self) -> tuple[str, ...]:
        """The figures it is about, "fig6" and "fig7"."""
        return CLAIMS[self.key]

    def judge(self, evidence: Evidence) -> Judgement:
        """Find the numbers and give the verdict."""
        return Judgement(self, tuple(self.find(evidence)))


@dataclass(frozen=True)
class Judgement:
    """A claim, the numbers found and the verdict: all thresholds met, some, none, or nothing to test."""

    claim: Claim
    findings: tuple[Finding, ...]

    @property
    def verdict(self) -> Verdict:
        """Holds where every threshold is met, does not hold where none is, holds partly in between."""
        passed = [finding.passed for finding in self.findings if finding.passed is not None]
        if not passed:
            return Verdict.UNTESTED
        if all(passed):
            return Verdict.HOLDS
        return Verdict.PARTLY if any(passed) else Verdict.FAILS

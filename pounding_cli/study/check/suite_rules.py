"""Compare the motions of a study with what the code of their target spectrum asks of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pounding_cli.errors import Issue
from pounding_cli.model.building import Building
from pounding_cli.model.wall import Wall
from pounding_cli.numbers import pluralize
from pounding_cli.records import CODES
from pounding_cli.records.code_spectra import RANGE_START_FACTOR, SuiteRules
from pounding_cli.records.motion import SPECTRUM_DAMPING
from pounding_cli.study.check.values import AS_MEANT
from pounding_cli.study.check.view import View
from pounding_cli.study.construct.group import Group
from pounding_cli.study.construct.motions import Suite
from pounding_cli.study.schema.records import CodeTargetSpec, RecordsSpec, SpectrumSpec
from pounding_cli.units import GRAVITY

_RELATIVE_TOLERANCE = 1e-9


def check_suite(view: View) -> Iterator[Issue]:
    """Yield what the code of the target asks of the motions and the study does not do."""
    for issue in _find_suite_issues(view.records, view.suite, view.group):
        yield replace(issue, hint=f"{issue.hint}; otherwise leave it, {AS_MEANT}")


def _find_suite_issues(spec: RecordsSpec, suite: Suite, group: Group) -> Iterator[Issue]:
    """Yield what the code of the target asks for and what to write."""
    scale = spec.scale
    if not isinstance(scale, SpectrumSpec) or not isinstance(scale.target, CodeTargetSpec):
        return
    rules = CODES[scale.target.name].suite
    if rules is None:
        return
    if len(suite.uses) < rules.min_motions:
        message = f"{pluralize(len(suite.uses), 'motion')}: {rules.count_clause}, asks for {rules.min_motions} at least"
        yield Issue(("records", "use"), message, "name more motions", code="suite")
    yield from _find_range_issues(scale, rules, group)
    yield from _find_part_issues(scale, rules)
    if rules.peak_clause and suite.target is not None:
        yield from _find_peak_issues(suite, rules)


def _find_range_issues(scale: SpectrumSpec, rules: SuiteRules, group: Group) -> Iterator[Issue]:
    """Yield the ends of the range of periods that leave out periods of the buildings, as far as these are known."""
    periods = [float(each.periods[0]) for each in group.buildings if _has_known_period(each)]
    if not periods:
        return
    first = RANGE_START_FACTOR * min(periods)
    last = rules.range_end_factor * max(periods)
    if scale.low > first * (1 + _RELATIVE_TOLERANCE):
        whose = f"{RANGE_START_FACTOR:g} times the shortest period of the buildings, {min(periods):.4g} s"
        message = f"the range begins at {scale.low:.4g} s; {rules.range_clause}, asks for {first:.4g} s, {whose}"
        yield Issue(("records", "scale", "from"), message, f"write `from: {_round_down(first):g} s`", code="suite")
    if scale.high < last * (1 - _RELATIVE_TOLERANCE):
        whose = f"{rules.range_end_factor:g} times the longest period of the buildings, {max(periods):.4g} s"
        whose += rules.range_note
        message = f"the range ends at {scale.high:.4g} s; {rules.range_clause}, asks for {last:.4g} s, {whose}"
        yield Issue(("records", "scale", "to"), message, f"write `to: {-_round_down(-last):g} s`", code="suite")


def _has_known_period(building: Building) -> bool:
    """Return whether the first period of a building is the one it has in the scenes: no wall, no moving base."""
    return not isinstance(building, Wall) and building.foundation is None


def _round_down(period: float) -> float:
    """Return a period rounded down to a hundredth of a second, the least part that a study needs."""
    return float(np.floor(round(100 * period, 6)) / 100)


def _find_part_issues(scale: SpectrumSpec, rules: SuiteRules) -> Iterator[Issue]:
    """Yield that the mean spectrum may fall below the part of the target that the code allows."""
    path = ("records", "scale", "at_least")
    part = f"{100 * rules.part:g} %"
    asked = f"{rules.part_clause}, asks for {part} of the 5 % damped target in the whole range"
    if scale.at_least is None:
        message = f"the mean spectrum may fall below the target anywhere; {asked}"
        yield Issue(path, message, f"write `at_least: {part}`", code="suite")
    elif scale.at_least < rules.part:
        message = f"the mean spectrum may fall to {100 * scale.at_least:g} % of the target; {asked}"
        yield Issue(path, message, f"write `at_least: {part}`", code="suite")
    elif scale.damping != SPECTRUM_DAMPING:
        message = f"the spectra have {100 * scale.damping:g} % damping; {asked}"
        yield Issue(
            ("records", "scale", "damping"), message, "leave `damping` out, or write `damping: 5 %`", code="suite"
        )


def _find_peak_issues(suite: Suite, rules: SuiteRules) -> Iterator[Issue]:
    """Yield that the mean of the peaks of the motions is below the target at the period 0."""
    assert suite.target is not None
    mean = float(np.mean([use.pga for use in suite.uses.values()]))
    wanted = suite.target.values[0]
    if mean < wanted * (1 - _RELATIVE_TOLERANCE):
        peaks = f"the mean peak of the motions is {mean / GRAVITY:.3g} g"
        message = f"{peaks}; {rules.peak_clause}, asks for ag S, {wanted / GRAVITY:.3g} g, at least"
        hint = f"use other motions, or a larger `at_least`: all factors would have to grow by {wanted / mean - 1:.1%}"
        yield Issue(("records", "scale", "target"), message, hint, code="suite")

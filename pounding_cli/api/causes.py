"""Find why time histories of a plan are new: the changed keys and motions of its study that made them so.

A time history is new because of a key if it is another one with the key as it was before. Every changed key is changed
back by itself, and the digests of the plan that follows are compared with those in the cache.

A list of the changed keys would say as much where one key is changed. With several it leaves open which one to take
back: of `configs/fig6.yaml` with four keys changed, 72 of 80 time histories are new, but `records.duration` has a part
in 16 of them and `cases.gap.gap` in 10. The answer takes 0.02 s for one key and 0.07 s for four.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.numbers import count_histories, join_limited
from pounding_cli.results.changes import ABSENT, EarlierStudy, KeyChange, iter_key_changes
from pounding_cli.results.responses import solution_key
from pounding_cli.study.text.file import Map, parse, with_value, without_value

if TYPE_CHECKING:
    from pounding_cli.batch.cache import Cache
    from pounding_cli.study import Plan, Study

MAX_SECONDS = 2.0
"""Time after which no further key is changed back [s]; those that are left count together."""

MAX_NAMED = 4
"""Changed keys that are named together."""

_IDLE_SECTIONS = {"title", "report", "statements", "keep"}
"""Sections that no time history follows from."""


@dataclass(frozen=True)
class Cause:
    """Why some time histories are new.

    reasons : the keys with their values before and now, or motions; several where only all of them together make these
        time histories new
    count : number of these
    subjects : what they are of, "case gap" or "soft alone", with how many each
    """

    reasons: tuple[str, ...]
    count: int
    subjects: dict[str, int]

    def __str__(self) -> str:
        return f"{self.subject}: {count_histories(self.count)}{format_subjects(self.subjects)}"

    @property
    def subject(self) -> str:
        """The reasons in words."""
        left = len(self.reasons) - MAX_NAMED
        names = list(self.reasons[:MAX_NAMED]) + [f"{left} more keys"] * (left > 0)
        return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def format_subjects(subjects: dict[str, int]) -> str:
    """Return in words what time histories are of: " of case gap" or ": 4 of case gap, 8 of soft alone"."""
    if len(subjects) == 1:
        return f" of {next(iter(subjects))}"
    return f": {join_limited([f'{count} of {subject}' for subject, count in subjects.items()], 200)}"


def count_subjects(plan: Plan, numbers: np.ndarray) -> dict[str, int]:
    """Return what some time histories of a plan are of, with how many each.

    One that several cases share counts for the first of them.
    """
    rows, columns = plan.first
    cases = np.unravel_index(rows[numbers], plan.shape)[-3]
    counts = Counter(zip(columns[numbers].tolist(), cases.tolist(), strict=True))
    subjects = Counter[str]()
    for (column, case), count in sorted(counts.items()):
        subjects[f"{plan.buildings[column - 1]} alone" if column else f"case {plan.cases[case]}"] += count
    return dict(subjects)


@dataclass(frozen=True, eq=False)
class _Reversal:
    """A study with some changed keys as they were before.

    reasons : these keys in words
    key : how its time histories are solved
    digests : of all its time histories
    counterparts : digest of the time history that stands in the place of each one of the plan; None where there is none
    is_known : whether this one is in the cache
    """

    reasons: tuple[str, ...]
    key: str
    digests: set[bytes]
    counterparts: Sequence[bytes | None]
    is_known: Callable[[bytes], bool]

    def changes(self, digest: bytes, key: str) -> bool:
        """Return whether a time history is another one with these keys as they were."""
        return key != self.key or digest not in self.digests

    def explains(self, number: int) -> bool:
        """Return whether nothing but these keys makes a time history new: it was solved as it would be without them."""
        before = self.counterparts[number]
        return before is None or self.is_known(before)


@dataclass
class CauseFinder:
    """Finds the causes of new time histories of a plan.

    plan : of the study
    plan_of : study -> the plan of the same question; raises InputError where the study asks what has no answer
    before : the study of an earlier run
    cache : of the time histories that are solved
    """

    plan: Plan
    plan_of: Callable[[Study], Plan]
    before: EarlierStudy
    cache: Cache
    _begin: float = field(default_factory=time.perf_counter)

    def find_causes(self, missing: np.ndarray) -> tuple[list[Cause], np.ndarray]:
        """Return the causes, those of most time histories first, and the numbers of those that have none.

        missing : numbers of the time histories that are not solved
        """
        tree = parse(self.plan.study.text, self.plan.study.file)
        changes = [
            change for change in iter_key_changes(self.before.tree, tree) if change.path[0] not in _IDLE_SECTIONS
        ]
        reversals = list(self._iter_reversals(tree, changes))
        motions = self._find_changed_motions(tree, changes)
        key = solution_key(self.plan)
        rows, _ = self.plan.first
        records = np.unravel_index(rows, self.plan.shape)[-1]
        numbers_by_cause: dict[tuple[str, ...], list[int]] = {}
        unexplained = []
        for number in missing.tolist():
            digest = self.plan.digests[number].tobytes()
            changing = [each for each in reversals if each.changes(digest, key)]
            alone = next((each for each in changing if each.explains(number)), None)
            motion = self.plan.records[records[number]]
            if alone is not None:
                cause = alone.reasons
            else:
                cause = tuple(dict.fromkeys(reason for each in changing for reason in each.reasons))
                cause += (f"motion {motion}, other samples",) * (motion in motions)
            if cause:
                numbers_by_cause.setdefault(cause, []).append(number)
            else:
                unexplained.append(number)
        causes = [
            Cause(reasons, len(numbers), count_subjects(self.plan, np.array(numbers)))
            for reasons, numbers in numbers_by_cause.items()
        ]
        causes.sort(key=lambda cause: -cause.count)
        return causes, np.array(unexplained, int)

    def _iter_reversals(self, tree: Map, changes: Sequence[KeyChange]) -> Iterator[_Reversal]:
        """Yield the study with each changed key as it was.

        A key that cannot be changed back by itself, as the study is refused then, is changed back with the others of
        its mapping. Those that cannot either, and those for which no time is left, are changed back together.
        """
        together: list[KeyChange] = []
        seen: set[tuple[str, ...]] = set()
        for place, change in enumerate(changes):
            if place and time.perf_counter() - self._begin > MAX_SECONDS:
                together += [each for each in changes[place:] if each not in together]
                break
            mapping = change.path[:-1]
            reversal = self._reverse(tree, [change])
            if reversal is None and mapping not in seen:
                seen.add(mapping)
                reversal = self._reverse(tree, [each for each in changes if each.path[:-1] == mapping])
            elif reversal is None:
                continue
            if reversal is None:
                together += [each for each in changes if each.path[:-1] == mapping and each not in together]
            else:
                yield reversal
        if together:
            yield self._reverse(tree, together) or self._reverse_blindly(together)

    def _reverse(self, tree: Map, changes: Sequence[KeyChange]) -> _Reversal | None:
        """Return the study with some keys as they were; None where it is refused."""
        try:
            plan = self.plan_of(self.plan.study.with_tree(reverse_changes(tree, changes)))
        except (InputError, KeyError):
            return None
        counterparts = list_counterparts(self.plan, plan)
        key = solution_key(plan)
        digests_before = list({digest for digest in counterparts if digest is not None})
        known = {digest for digest, keys in self.cache.find_keys(digests_before).items() if key in keys}
        digests = {digest.tobytes() for digest in plan.digests}
        return _Reversal(tuple(map(str, changes)), key, digests, counterparts, known.__contains__)

    def _reverse_blindly(self, changes: Sequence[KeyChange]) -> _Reversal:
        """Return keys of which nobody can say what they change."""
        counterparts = [b""] * len(self.plan)
        return _Reversal(tuple(map(str, changes)), "", set(), counterparts, lambda _: False)

    def _find_changed_motions(self, tree: Map, changes: Sequence[KeyChange]) -> set[str]:
        """Return the motions whose samples differ from those of the earlier run, with all keys as they were."""
        try:
            study = self.plan.study
            if changes:
                study = study.with_tree(reverse_changes(tree, changes))
            uses = study.motion_uses(study.first_point)
        except (InputError, KeyError):
            return set()
        return {name for name, use in uses.items() if self.before.motions.get(name, use.digest) != use.digest}


def reverse_changes(tree: Map, changes: Sequence[KeyChange]) -> Map:
    """Return the tree of a study with some keys as they were before."""
    earlier: Any = tree
    for change in changes:
        if change.before is ABSENT:
            earlier = without_value(earlier, change.path)
        else:
            earlier = with_value(earlier, change.path, change.before, tree.mark)
    return earlier


def list_counterparts(plan: Plan, other: Plan) -> list[bytes | None]:
    """Return of every time history of a plan the digest of the one in its place in another plan; None where none is.

    The place is the point of the sweep, the case, the analysis, the motion, and the building that stands alone.
    """
    counterparts: list[bytes | None] = [None] * len(plan)
    if [axis.names for axis in plan.axes] != [axis.names for axis in other.axes]:
        return counterparts
    rows, columns = plan.first
    index = (*np.unravel_index(rows, plan.shape), columns)
    names: list[tuple[Sequence[Any], Sequence[Any]]] = [
        *((axis.values, theirs.values) for axis, theirs in zip(plan.axes, other.axes, strict=True)),
        (plan.cases, other.cases),
        (plan.analyses, other.analyses),
        (plan.records, other.records),
        (("", *plan.buildings), ("", *other.buildings)),
    ]
    places = [_find_places(ours, theirs)[each] for (ours, theirs), each in zip(names, index, strict=True)]
    is_there = np.all([each >= 0 for each in places], axis=0)
    for number in np.flatnonzero(is_there).tolist():
        scene = int(other.numbers[tuple(int(each[number]) for each in places)])
        if scene >= 0:
            counterparts[number] = other.digests[scene].tobytes()
    return counterparts


def _find_places(names: Sequence[Any], others: Sequence[Any]) -> np.ndarray:
    """Return the place of every name among others; -1 where it is not there."""
    places = {name: place for place, name in enumerate(others)}
    return np.array([places.get(name, -1) for name in names])

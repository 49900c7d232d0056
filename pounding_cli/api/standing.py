"""Report how far a study is solved, and what a run of it would still have to do."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.batch.cache import Cache, cache_path
from pounding_cli.batch.forecast import RunDuration, estimate_duration, measure_rates
from pounding_cli.errors import InputError
from pounding_cli.numbers import join_limited
from pounding_cli.results.changes import changed_keys, read_resolved
from pounding_cli.results.file import read_attributes
from pounding_cli.results.responses import Responses, solution_key

if TYPE_CHECKING:
    from pounding_cli.questions.question import StudyQuestion
    from pounding_cli.study import Plan

MAX_NAMED_KEYS = 4
"""Changed keys that are named."""


def compute_content_key(question: StudyQuestion) -> str:
    """Return the SHA-256 of all that results follow from: the study, its scenes, the solver."""
    plan = question.plan
    study = plan.study
    kept = (plan.kept, plan.every)
    resolved = json.dumps(study.to_plain_data(), default=str, sort_keys=True)
    text = repr((solution_key(plan), question.name, study.title, study.text, resolved, kept))
    return hashlib.sha256(text.encode() + plan.digests.tobytes() + plan.numbers.tobytes()).hexdigest()


def find_current(output: Path, content: str) -> int | None:
    """Return the number of time histories of a results file that holds this content already, all of them solved.

    None where the file is missing, cannot be read, holds something else, or lacks some.
    """
    try:
        attributes = read_attributes(output)
        is_same = attributes["content"] == content and int(attributes["scenes_failed"]) == 0
        return int(attributes["scenes"]) if is_same else None
    except (InputError, KeyError):
        return None


@dataclass(frozen=True)
class Standing:
    """Progress of the time histories of a question.

    is_current : whether the results file holds the answer to the study as it is
    total : time histories of the whole question; about so many where their number depends on results
    solved : those of them that the cache holds, as far as they are known beforehand
    reasons : why others are not solved
    duration : of solving the others
    """

    is_current: bool
    total: int
    solved: int
    reasons: tuple[str, ...]
    duration: RunDuration

    @property
    def missing(self) -> int:
        """Time histories that are to be solved."""
        return max(self.total - self.solved, 0)


def find_standing(question: StudyQuestion, output: Path) -> Standing:
    """Return how far a question is solved whose results are at `output`; nothing is solved, compiled or written.

    Raises InputError: another run is using these results.
    """
    plan = question.plan
    count = find_current(output, compute_content_key(question))
    if count is not None:
        return Standing(True, count, count, (), RunDuration(0.0, ()))
    every = np.arange(len(plan))
    solved = Responses(plan)
    path = cache_path(output)
    with contextlib.closing(Cache(path, read_only=True)) as cache:
        digests = {digest.tobytes(): number for number, digest in enumerate(plan.digests)}
        for rows in cache.iter_rows(solution_key(plan), list(digests)):
            solved.add({digests[digest]: row for digest, row in rows.items()})
        ended = solved.has_result[:-1]
        others = cache.count_by_key([plan.digests[number].tobytes() for number in every[~solved.is_known[:-1]]])
        reasons = tuple(_iter_reasons(plan, solved, others, output, cache.was_damaged))
    rates = measure_rates(plan, every[ended], solved.values["seconds"])
    total = max(question.expected_count, len(plan) if question.extent == "has" else 0)
    missing = every[~ended]
    left = max(total - int(ended.sum()), 0)
    duration = estimate_duration(plan, missing if missing.size else every, left, rates)
    return Standing(False, total, int(ended.sum()), reasons, duration)


def _iter_reasons(
    plan: Plan, solved: Responses, others: dict[str, int], output: Path, was_damaged: bool
) -> Iterator[str]:  # fmt: skip
    """Yield why time histories of a plan are not in the cache, with how many.

    others : by the key of another way to solve them, how many of the missing ones are there
    """
    failed = int((solved.is_known & ~solved.has_result)[:-1].sum())
    if failed:
        yield f"{failed} failed in an earlier run"
    rest = len(plan) - int(solved.is_known[:-1].sum())
    by_difference = Counter[str]()
    for key, number in others.items():
        by_difference[_difference(key, solution_key(plan))] += number
    for difference, number in by_difference.items():
        yield f"{min(number, rest)} solved {difference}"
    rest -= min(sum(others.values()), rest)
    if not rest:
        return
    path = cache_path(output)
    before = read_resolved(output)
    if was_damaged:
        yield f"{rest} not known: {path} is damaged"
    elif not path.exists() and before is None:
        yield f"{rest} never run: {output} does not exist"
    elif not path.exists():
        yield f"{rest} not known: {path}, the cache of {output}, does not exist"
    elif before is None:
        yield f"{rest} not reached: the run before was stopped, or the study was changed since"
    else:
        keys = [
            key for key, *_ in changed_keys(before, json.loads(json.dumps(plan.study.to_plain_data(), default=str)))
        ]
        names = join_limited(keys[:MAX_NAMED_KEYS]) + (
            f" and {len(keys) - MAX_NAMED_KEYS} more" if len(keys) > MAX_NAMED_KEYS else ""
        )
        since = f"since {output} was written"
        yield f"{rest} new or changed {since}: {names}" if keys else f"{rest} changed {since}: motions, not the study"


def _difference(key: str, wanted: str) -> str:
    """Return what differs between two keys of how scenes are solved: "with accuracy 1e-06"."""
    solver, *ways = key.split(" | ")
    solver_wanted, *ways_wanted = wanted.split(" | ")
    if solver != solver_wanted:
        return "by another version of the program"
    return f"with {', '.join(way for way, other in zip(ways, ways_wanted, strict=False) if way != other)}"

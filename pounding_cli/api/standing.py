"""Report how far a study is solved, and what a run of it would still have to do."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.api.causes import Cause, CauseFinder, count_subjects
from pounding_cli.api.studies import default_output, load_study
from pounding_cli.batch.cache import Cache, cache_path
from pounding_cli.batch.forecast import RunDuration, estimate_duration, measure_rates
from pounding_cli.errors import InputError
from pounding_cli.questions import load_question
from pounding_cli.results.changes import read_earlier_study
from pounding_cli.results.file import FORMAT_VERSION, read_attributes
from pounding_cli.results.responses import Responses, solution_key

if TYPE_CHECKING:
    from pounding_cli.questions.question import StudyQuestion
    from pounding_cli.study import Plan, Study

OTHER_VERSION = "another version of the program"
"""The reason for which time histories that another solver solved are solved again."""


def compute_content_key(question: StudyQuestion) -> str:
    """Return the SHA-256 of all that results follow from: the study, its scenes, the solver."""
    plan = question.plan
    study = plan.study
    kept = (plan.kept, plan.every)
    resolved = json.dumps(study.to_plain_data(), default=str, sort_keys=True)
    text = repr((solution_key(plan), question.name, study.title, study.text, resolved, kept, question.content))
    return hashlib.sha256(text.encode() + plan.digests.tobytes() + plan.numbers.tobytes()).hexdigest()


def find_current(output: Path, content: str) -> int | None:
    """Return the number of time histories of a results file that holds this content already, all of them solved.

    None where the file is missing, cannot be read, holds something else, or lacks some.
    """
    try:
        return count_current(read_attributes(output), content)
    except InputError:
        return None


def count_current(attributes: Mapping[str, Any], content: str) -> int | None:
    """Return the number of time histories of results that hold this content, all of them solved; None of others.

    attributes : of the results file; none where there is no file
    """
    is_same = int(attributes.get("format_version", 0)) == FORMAT_VERSION and attributes.get("content") == content
    return int(attributes["scenes"]) if is_same and int(attributes["scenes_failed"]) == 0 else None


@dataclass(frozen=True)
class Standing:
    """Progress of the time histories of a question.

    is_current : whether the results file holds the answer to the study as it is
    total : time histories of the whole question; about so many where their number depends on results
    solved : those of them that the cache holds, as far as they are known beforehand
    reused : what these are of, "case gap" or "soft alone", with how many each
    causes : changes of the study, its motions or the program that make others new
    since : the results file that these are changes from; None of a first run
    reasons : why others are not solved, in words
    duration : of solving the others
    """

    is_current: bool
    total: int
    solved: int
    reused: Mapping[str, int]
    causes: tuple[Cause, ...]
    since: Path | None
    reasons: tuple[str, ...]
    duration: RunDuration

    @property
    def missing(self) -> int:
        """Time histories that are to be solved."""
        return max(self.total - self.solved, 0)


def find_unchanged_output(question: StudyQuestion) -> Path | None:
    """Return the default results file of a study without the values that are changed in it; None where none is.

    A run with changed values takes from the cache beside it what they leave as it is.
    """
    study = question.study
    return default_output(study.path, question.name) if study.changes else None


def explain_run(
    study: Study | str | Path | Mapping[str, Any], output: str | Path | None = None, workflow: str = "run"
) -> Standing:
    """Return what a run would solve anew and why, and what it reuses, as `pound check` lists it.

    Nothing is solved, compiled or written.

    Parameters
    ----------
    study : a loaded study, the path of its file, or a dict as `load_study` takes
    output : the results file, beside which solved time histories are kept; as that of `run` unless given
    workflow : what is asked, as the command of that name

    Raises
    ------
    InputError : the study is refused, or another run is using these results
    """
    loaded = load_study(study) if isinstance(study, Mapping | str | Path) else study
    path = Path(output) if output is not None else default_output(loaded.path, workflow, loaded.changes)
    return find_standing(load_question(workflow).ask(loaded), path)


def find_standing(question: StudyQuestion, output: Path) -> Standing:
    """Return how far a question is solved whose results are at `output`; nothing is solved, compiled or written.

    Raises InputError: another run is using these results.
    """
    plan = question.plan
    count = find_current(output, compute_content_key(question))
    if count is not None:
        return Standing(True, count, count, {}, (), output, (), RunDuration(0.0, ()))
    every = np.arange(len(plan))
    solved = Responses(plan)
    unchanged = find_unchanged_output(question)
    shared = None if unchanged is None else cache_path(unchanged)
    with contextlib.closing(Cache(cache_path(output), read_only=True, shared=shared)) as cache:
        digests = {digest.tobytes(): number for number, digest in enumerate(plan.digests)}
        for rows in cache.iter_rows(solution_key(plan), list(digests)):
            solved.add({digests[digest]: row for digest, row in rows.items()})
        _add_scenes_of_known_parts(plan, solved, cache)
        explained = _explain_missing(question, every[~solved.is_known[:-1]], output, unchanged, cache)
    ended = solved.has_result[:-1]
    failed = int((solved.is_known & ~solved.has_result)[:-1].sum())
    reasons = (*([f"{failed} failed in an earlier run"] if failed else []), *explained.reasons)
    rates = measure_rates(plan, every[ended], solved.values["seconds"])
    total = max(question.expected_count, len(plan) if question.extent == "has" else 0)
    missing = every[~ended]
    left = max(total - int(ended.sum()), 0)
    duration = estimate_duration(plan, missing if missing.size else every, left, rates)
    reused = count_subjects(plan, every[ended])
    return Standing(
        False, total, int(ended.sum()), reused, explained.causes, explained.since, reasons, duration
    )  # fmt: skip


def _add_scenes_of_known_parts(plan: Plan, solved: Responses, cache: Cache) -> None:
    """Add scenes that nothing has to be solved for, since a cache has all parts into which they are divided."""
    numbers = np.flatnonzero(plan.divided & ~solved.is_known[:-1])
    if not numbers.size or not solved.is_known.any():
        return
    from pounding_cli.batch.parts import DividedScenes  # here: it imports what solves scenes

    solved.add(DividedScenes(plan, numbers).load(cache, plan))


@dataclass(frozen=True)
class _Explanation:
    """Why time histories are not in the cache; as the attributes of a `Standing`."""

    causes: tuple[Cause, ...]
    since: Path | None
    reasons: tuple[str, ...]


def _explain_missing(
    question: StudyQuestion, missing: np.ndarray, output: Path, unchanged: Path | None, cache: Cache
) -> _Explanation:
    """Return why time histories of a question are not in the cache.

    missing : their numbers
    unchanged : default results file of the study without changed values; None where none is changed
    """
    plan = question.plan
    if not missing.size:
        return _Explanation((), None, ())
    causes: list[Cause] = []
    keys = cache.find_keys([plan.digests[number].tobytes() for number in missing.tolist()])
    version, *_ = solution_key(plan).split(" | ")
    is_of_other = np.array([_is_of_other_version(keys, plan, number, version) for number in missing.tolist()])
    if is_of_other.any():
        of_other = missing[is_of_other]
        causes.append(Cause((OTHER_VERSION,), len(of_other), count_subjects(plan, of_other)))
        missing = missing[~is_of_other]
    earlier = read_earlier_study(output)
    if earlier is None and unchanged is not None and not output.exists():
        earlier = read_earlier_study(unchanged)
    has_cache = cache_path(earlier.path).exists() if earlier is not None else False
    if earlier is not None and has_cache and not cache.was_damaged and missing.size:

        def plan_of(study: Study) -> Plan:
            return load_question(question.name).ask(study).plan

        found, missing = CauseFinder(plan, plan_of, earlier, cache).find_causes(missing)
        causes += found
    since = None if earlier is None else earlier.path
    rest = [plan.digests[number].tobytes() for number in missing.tolist()]
    reasons = tuple(_iter_reasons(rest, keys, solution_key(plan), output, since, cache.was_damaged))
    return _Explanation(tuple(causes), since, reasons)


def _is_of_other_version(keys: Mapping[bytes, set[str]], plan: Plan, number: int, version: str) -> bool:
    """Return whether a time history was solved by another version of the solver alone.

    keys : of how time histories were solved, by digest
    """
    of_history = keys.get(plan.digests[number].tobytes(), set())
    return bool(of_history) and not any(key.startswith(f"{version} | ") for key in of_history)


def _iter_reasons(
    missing: list[bytes],
    keys: Mapping[bytes, Iterable[str]],
    wanted: str,
    output: Path,
    since: Path | None,
    was_damaged: bool,
) -> Iterator[str]:
    """Yield why time histories are not in the cache that no change makes new, with how many.

    missing : their digests
    keys : of how such were solved otherwise, by digest
    wanted : key of how they are to be solved
    since : results file whose study is known
    """
    by_difference = Counter(_difference(min(keys[digest]), wanted) for digest in missing if digest in keys)
    yield from (f"{count} solved {difference}" for difference, count in by_difference.items())
    rest = sum(digest not in keys for digest in missing)
    path = cache_path(output)
    if not rest:
        return
    if was_damaged:
        yield f"{rest} not known: {path} is damaged"
    elif not path.exists() and not output.exists() and since is None:
        yield f"{rest} never run: {output} does not exist"
    elif not path.exists() and output.exists():
        yield f"{rest} not known: {path}, the cache of {output}, does not exist"
    else:
        yield f"{rest} not reached: the run before was stopped, or the study was changed since"


def _difference(key: str, wanted: str) -> str:
    """Return what differs between two keys of how scenes are solved: "with accuracy 1e-06"."""
    _, *ways = key.split(" | ")
    _, *ways_wanted = wanted.split(" | ")
    return f"with {', '.join(way for way, other in zip(ways, ways_wanted, strict=False) if way != other)}"

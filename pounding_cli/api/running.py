"""Running a study: solve what its results still lack, answer what is asked, write one file."""

from __future__ import annotations

import contextlib
import json
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pounding_cli.api.standing import compute_content_key, count_current, find_unchanged_output
from pounding_cli.batch.cache import Cache, cache_path
from pounding_cli.batch.parts import list_parts
from pounding_cli.batch.pool import open_pool
from pounding_cli.batch.progress import Progress
from pounding_cli.batch.solve import Solver
from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import count_histories
from pounding_cli.outputs import check_output
from pounding_cli.report.summary import Summary, program_digest, read_summary
from pounding_cli.results.file import FORMAT_VERSION, is_results, read_attributes, write_results
from pounding_cli.results.histories import iter_kept_histories
from pounding_cli.results.responses import solution_key, solver_version
from pounding_cli.results.results import ResultTables

if TYPE_CHECKING:
    from pounding_cli.questions.question import StudyQuestion
    from pounding_cli.study import Plan, Study


class Failure(NamedTuple):
    """A scene without a result: where it stands in the study, what happened, what to do about it."""

    place: str
    status: str
    advice: str


@dataclass(frozen=True)
class RunOutcome:
    """Counts of scenes, each scene once: done now, failed, reused from a former run.

    path : the results file
    divided, parts : scenes among those done now that were put together from parts, and the parts solved for them
    failures : the scenes that failed, in the order of the study
    engine, workers : how the scenes were solved
    content : SHA-256 of all that the results follow from
    solver_seconds : time inside the solver now, all workers together [s]
    wall_seconds : from start to file [s]
    results : what was written; None of results that were current
    """

    path: Path
    content: str
    done: int
    failed: int
    reused: int
    failures: tuple[Failure, ...]
    engine: str
    workers: int
    solver_seconds: float
    wall_seconds: float
    results: ResultTables | None = None
    divided: int = 0
    parts: int = 0


def run_study(
    question: StudyQuestion,
    output: Path,
    *,
    progress: Progress | None = None,
    workers: int | None = None,
    engine: str = "threads",
    scheduler: str | None = None,
    replace: bool = False,
) -> RunOutcome:
    """Solve what the cache beside `output` lacks and write the results file; further parameters as those of `api.run`.

    A scene that fails is reported in the outcome and in the file, and the others go on. Stopped by Ctrl-C, what is
    solved is kept, and the next call goes on from there.

    Raises
    ------
    InputError : the study or the output is refused; another run uses it; no such engine; the disk is full
    KeyboardInterrupt : stopped
    """
    begin = time.perf_counter()
    question.check_changes()
    reporter = progress or Progress()
    study = question.study
    workers_of = open_pool(engine, workers, scheduler)
    with contextlib.ExitStack() as stack:
        stack.callback(workers_of.close)
        content = compute_content_key(question)
        earlier = _check_output(output, study, question.name, replace)
        if (scenes := count_current(earlier, content)) is not None:
            return RunOutcome(output, content, 0, 0, scenes, (), "none", 1, 0.0, time.perf_counter() - begin)
        unchanged = find_unchanged_output(question)
        shared = None if unchanged is None else cache_path(unchanged)
        cache = stack.enter_context(contextlib.closing(Cache(cache_path(output), shared=shared)))
        if cache.was_damaged:
            reporter.write_note(f"{cache.path} was damaged: its time histories are solved again")
        if cache.delete_other_versions(f"solver {solver_version()} "):
            reporter.write_note(
                f"{cache.path} was made by another version of the solver: all time histories are solved again"
            )
        solver = stack.enter_context(contextlib.closing(Solver(cache, workers_of, reporter)))
        if question.extent != "has":
            reporter.expected_count = question.expected_count
        try:
            answer = question.answer(solver)
        except KeyboardInterrupt:
            reporter.write_note(f"{count_histories(solver.solved_count)} solved now and kept in {cache.path}")
            raise
        plan = answer.plan
        kept = iter_kept_histories(plan, answer.arrays, reporter.write_note, cache)
        histories = (history for _, history in kept)
        attributes = {
            "workflow": question.name,
            "content": content,
            "study_file": _place_of(study, output),
            "answers": json.dumps([table.name for table in answer.tables]),
            "scenes_solved_last": solver.solved_count,
            "scenes_reused_last": solver.reused_count,
            "wall_seconds_last": time.perf_counter() - begin,
            "engine": solver.engine,
            "workers": solver.workers,
        }
        arrays = answer.arrays.with_attrs(attributes)
        write_results(output, arrays, answer.tables, histories)
        if replace:
            cache.delete_others(solution_key(plan), [*(digest.tobytes() for digest in plan.digests), *list_parts(plan)])
    return RunOutcome(
        output, content, solver.solved_count - len(solver.failures), len(solver.failures), solver.reused_count,
        tuple(_failures(plan, solver)), solver.engine, solver.workers, solver.seconds, time.perf_counter() - begin,
        ResultTables(output, arrays, answer.tables), solver.divided_count, solver.part_count,
    )  # fmt: skip


def summarize(outcome: RunOutcome) -> Summary:
    """Return what a terminal prints of results: as it was kept beside them, otherwise from the file.

    Reading the file takes longer than all else that a run of a study does whose results are current.
    """
    path = cache_path(outcome.path)
    key = f"{outcome.content} {program_digest()}"
    if not (outcome.done or outcome.failed):  # nothing was solved since
        with contextlib.suppress(InputError), contextlib.closing(Cache(path, read_only=True)) as cache:
            summary = read_summary(cache.find_summary(key) or "")
            if summary is not None:
                return summary
    from pounding_cli.questions.reports import build_report

    results = ResultTables(outcome.path) if outcome.results is None else outcome.results
    summary = build_report(results).summary
    if path.exists():
        with contextlib.suppress(InputError), contextlib.closing(Cache(path)) as cache:
            cache.store_summary(key, summary.to_json())
    return summary


def _check_output(path: Path, study: Study, workflow: str, replace: bool) -> dict[str, Any]:
    """Make sure that the results of a study can be written at `path`, before anything is computed; makes the folder.

    Returns the attributes of the results that stand there; none with `replace`.

    Results of the same study are replaced: those that came from the same file, whatever it says by now; or from a file
    that is no longer there, with the same title. A study that is Python data is known by its title.

    Raises
    ------
    InputError : as `outputs.check_output`; results of another study, another command or a newer program; damaged
        results that do not tell their study; not with `replace`
    """
    check_output(path, [study.path], lambda place, _: is_results(place))
    if replace or not path.exists() or not path.stat().st_size:
        return {}
    try:
        attributes = read_attributes(path, version=None)
    except InputError:
        obstacle = "damaged results whose study cannot be read"
    else:
        place, command = (
            str(attributes.get("study_file", "")),
            attributes.get("workflow", attributes.get("kind", "run")),
        )
        study_file = path.parent / place.replace("\0", "")
        if place and os.path.exists(study_file):
            is_same = study_file.resolve() == study.path.resolve()
        else:  # files of older programs do not say where they come from
            is_same = attributes.get("title") == study.title and (
                "study_file" not in attributes or bool(place) != study.from_data
            )
        if int(attributes.get("format_version", 0)) > FORMAT_VERSION:
            obstacle = f"results of a newer program, of format version {attributes['format_version']}"
        elif is_same:
            obstacle = "" if command == workflow else f"results of `pound {command}`"
        else:
            obstacle = f"another study: '{attributes.get('title')}'" + (f" ({place})" if place else "")
    if obstacle:
        hint = "name another file with -o, or use --replace to delete it (in Python: replace=True)"
        raise InputError(Issue((), f"the output holds {obstacle}", hint, file=str(path)))
    return attributes


def _place_of(study: Study, results: Path) -> str:
    """Return the path of a study's file from the folder of its results; "" for a study that is Python data.

    Such a path still fits where a project is moved, copied or sent.
    """
    if study.from_data:
        return ""
    try:
        return os.path.relpath(study.path.resolve(), results.parent.resolve())
    except ValueError:  # another drive
        return str(study.path.resolve())


def _failures(plan: Plan, solver: Solver) -> Iterator[Failure]:
    """Every failed scene once, named by the first place in the study where it stands."""
    rows, columns = plan.first
    for number, digest in enumerate(plan.digests) if solver.failures else ():
        if (reason := solver.failures.get(digest.tobytes())) is not None:
            row = plan.row(int(rows[number]))
            swept = [f"{name} = {value}" for name, value in plan.display_values(row.point).items()]
            subject = f"{plan.buildings[columns[number] - 1]} alone" if columns[number] else row.case
            yield Failure(", ".join((*swept, subject, row.analysis, row.record)), *reason)

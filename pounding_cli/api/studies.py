"""Load a study, run it, open its results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pounding_cli.api.results import Results
    from pounding_cli.batch.progress import Progress
    from pounding_cli.study import Study
    from pounding_cli.study.vary.changes import Change


def load_study(
    source: str | Path | Mapping[str, Any], changes: Mapping[str, Any] | Sequence[Change] = ()
) -> Study:  # fmt: skip
    """Read and check a study: a file, or a dict with the keys and units of one.

    Parameters
    ----------
    source : path of the file, or the dict
    changes : values in place of those there, by dotted key as a sweep has it, `{"cases.near.gap": "4 cm"}`; they are
        checked as if they stood in the study, whose text (`Study.text`) has them, and its results have a name of their
        own unless one is given

    Raises
    ------
    InputError : with every problem found, each with line and column, or in a dict and in changes with its key
    """
    from pounding_cli.questions import study_model
    from pounding_cli.study import load_study_file, study_of
    from pounding_cli.study.data import list_changes

    changed = list_changes(changes) if isinstance(changes, Mapping) else changes
    if isinstance(source, Mapping):
        return study_of(source, study_model(), changed)
    return load_study_file(Path(source), study_model(), changed)


def run(
    study: Study | str | Path | Mapping[str, Any],
    output: str | Path | None = None,
    *,
    workers: int | None = None,
    engine: str = "threads",
    scheduler: str | None = None,
    progress: Progress | None = None,
    replace: bool = False,
    workflow: str = "run",
) -> Results:
    """Run a study, reusing scenes solved before, and open its results.

    Parameters
    ----------
    study : a loaded study, the path of its file, or a dict as `load_study` takes
    output : the results file; `results/<study stem>.h5` unless given, with the values that were changed in its name
    workers : scenes side by side; the cores of this machine unless given
    engine : "threads", "processes", "serial" or "dask": the same rows from each
    scheduler : address of a Dask scheduler, for the dask engine; a cluster on this machine unless given
    progress : as in `pounding_cli.batch.progress`; nothing is shown unless given
    replace : replace results of another study too, and forget scenes and histories that this study does not have
    workflow : what is asked, as the command of that name: "run", or "gap" (how wide must the gap be?), whose answer is
        `Results.table("gap")`

    Raises
    ------
    InputError : the study or the output is refused, or there is no such workflow

    Scenes that fail have a status other than "done" in `Results.scene()`, and NaN in the other tables; so do scenes in
    which a storey collapses ("collapsed"), which are no failures.
    """
    from pounding_cli.api.running import run_study
    from pounding_cli.questions import load_question

    loaded = load_study(study) if isinstance(study, Mapping | str | Path) else study
    path = Path(output) if output is not None else default_output(loaded.path, workflow, loaded.changes)
    run_study(
        load_question(workflow).ask(loaded),
        path,
        progress=progress,
        workers=workers,
        engine=engine,
        scheduler=scheduler,
        replace=replace,
    )
    return open_results(path)


def open_results(path: str | Path) -> Results:
    """The tables of a results file.

    Raises
    ------
    InputError : no such file, not a results file, or one of another format version
    """
    from pounding_cli.api.results import Results

    return Results(Path(path))


def default_output(study: Path, workflow: str = "run", changes: Sequence[Change] = ()) -> Path:
    """Return the default results file: `results/<study stem>.h5` in the current directory.

    Behind the stem stand the name of the question, where one is asked, and the values that are changed.
    """
    return Path("results") / f"{format_stem(study, '' if workflow == 'run' else workflow, changes)}.h5"


def format_stem(study: Path, question: str = "", changes: Sequence[Change] = ()) -> str:
    """Return the name of the results of a study without its ending: `two-gap-cases.near.gap=4-cm`."""
    from pounding_cli.study.vary.changes import name_changes

    return "-".join(filter(None, (study.stem, question, name_changes(changes))))

"""Load a study, run it, open its results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pounding_cli.api.results import Results
    from pounding_cli.batch.progress import Progress
    from pounding_cli.study import Study


def load_study(source: str | Path | Mapping[str, Any]) -> Study:
    """Read and check a study: a file, or a dict with the keys and units of one.

    Raises
    ------
    InputError : with every problem found, each with line and column, or in a dict with its key
    """
    from pounding_cli.questions import study_model
    from pounding_cli.study import load_study_file, study_of

    if isinstance(source, Mapping):
        return study_of(source, study_model())
    return load_study_file(Path(source), study_model())


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
    output : the results file; `results/<study stem>.h5` unless given
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
    from pounding_cli.api.running import ask_question, run_study

    loaded = load_study(study) if isinstance(study, Mapping | str | Path) else study
    path = Path(output) if output is not None else default_output(Path(loaded.path), workflow)
    run_study(
        ask_question(workflow, loaded),
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


def default_output(study: Path, workflow: str = "run") -> Path:
    """Return the default results file: `results/<study stem>.h5` in the current directory, with the name of the
    question behind the stem where one is asked."""
    return Path("results") / (f"{study.stem}.h5" if workflow == "run" else f"{study.stem}-{workflow}.h5")

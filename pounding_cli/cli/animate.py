"""`pound animate`: a scene over time as a film."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli.places import at_option, key_and_value
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    import numpy as np

    from pounding_cli.report.picture import Picture
    from pounding_cli.solve.histories import History


@click.command("animate", short_help="Show a scene over time as a film.")
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.h5|STUDY")
@click.option("--case", help="Case of the study.")
@click.option("--analysis", help="elastic or inelastic.")
@click.option("--record", help="Motion.")
@at_option
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="x.gif, x.mp4, or x.png for one picture; a GIF named like the scene unless given.",
)
@click.option("--scale", default="auto", show_default=True, metavar="FACTOR", help="Of displacements and gaps.")
@click.option("--slow", default=4.0, show_default=True, metavar="FACTOR", help="How many times slower than real time.")
@click.option("--from", "begin", metavar="TIME", help="Where to begin, e.g. 2 s; at the start unless given.")
@click.option("--to", "end", metavar="TIME", help="Where to stop; at the end unless given.")
@click.option("--rate", type=click.IntRange(1, 60), default=25, show_default=True, help="Frames a second.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing.")
def command(
    file: Path,
    case: str | None,
    analysis: str | None,
    record: str | None,
    at: tuple[str, ...],
    output: Path | None,
    scale: str,
    slow: float,
    begin: str | None,
    end: str | None,
    rate: int,
    quiet: bool,
) -> None:
    """Show a scene as a film: its floors at a displacement scale, links that flash as they push, the ground below.

    FILE.h5 must keep the scene's history (`keep: histories` in the study). Given a STUDY instead, the one scene is
    run for it, whatever the study keeps. --case, --analysis, --record and --at choose the scene; those not needed
    for that may be left out.
    Displacements and gaps are drawn at one scale, so that floors touch in the film when they touch in the scene.

    \b
    Example:
      pound animate results/fig6.h5 --case touching --analysis inelastic --record elcentro -o touching.mp4
      pound animate configs/quickstart.yaml --case gap --analysis elastic --from 2 s --to 4 s --slow 8
    """
    from pounding_cli.errors import InputError, Problem
    from pounding_cli.report.animation import Film, fitting_scale, frames
    from pounding_cli.report.film import check_film, write_film
    from pounding_cli.texts import file_name

    wanted = {"case": case, "analysis": analysis, "record": record}
    place = {name: value for name, value in wanted.items() if value is not None} | _swept(at)
    if output is not None:
        check_film(output, [file])
    if not slow > 0:
        raise InputError(Problem(f"--slow {slow:g}: it must be above zero", "write e.g. --slow 4; 1 is real time"))
    read = _from_study if file.suffix.lower() in (".yaml", ".yml") else _from_results
    history, picture, name = read(file, place)
    path = output or Path(f"{file_name(name)}.gif")
    check_film(path, [file])
    last = float(history.time[-1])
    first, stop = _time("--from", begin, 0.0), _time("--to", end, last)
    if not 0 <= first < stop <= last + 1e-9:
        hint = f"the history lasts from 0 to {last:g} s: write times within it, --from below --to"
        raise InputError(Problem(f"--from {first:g} s --to {stop:g} s: no such part", hint))
    film = Film(first, stop, slow, rate, _scale(scale) or fitting_scale(history, picture))
    write_film(path, _shown(frames(history, picture, film), film.times.size, quiet), rate)
    if not quiet:
        many = f"{counted(film.times.size, 'frame')}, {film.times.size / rate:.3g} s"
        click.echo(f"{path}: {f'picture at {first:g} s' if path.suffix.lower() == '.png' else many}; {film.words}")


def _from_results(file: Path, place: dict[str, Any]) -> tuple[History, Picture, str]:
    """The history kept, its picture, and a name for the film."""
    from pounding_cli.errors import InputError, Problem
    from pounding_cli.report.picture import picture_of_results
    from pounding_cli.store import open_results

    results = open_results(file)
    try:
        kept = results.kept(**place)
    except InputError as refused:
        hint = "or name the study instead of its results: pound animate STUDY.yaml runs the one scene"
        problems = [Problem(p.message, f"{p.hint}\n    {hint}", p.file) for p in refused.problems]
        raise InputError(problems) from None
    history = results.history(**{name: kept[name] for name in (*results.axes, "case", "analysis", "record")})
    name = "-".join((file.stem, kept["case"], kept["analysis"], kept["record"]))
    return history, picture_of_results(results, kept, history), name


def _from_study(file: Path, place: dict[str, Any]) -> tuple[History, Picture, str]:
    """The history of one scene of a study, run now."""
    from pounding_cli.errors import InputError, Problem
    from pounding_cli.report.picture import in_words, picture_of_scene
    from pounding_cli.solve.histories import history
    from pounding_cli.study import expand, load_study
    from pounding_cli.study.keep import meant_rows

    plan = expand(load_study(file))
    rows = meant_rows(plan, place)
    if len(rows) != 1:
        said = [", ".join((*(f"{k} = {v}" for k, v in plan.shown(row).items()), row.case, row.analysis, row.record))
                for row, _ in (rows or meant_rows(plan, {}))]  # fmt: skip
        listed = "; ".join(said[:12]) + (f"; ... {len(said)} in all" if len(said) > 12 else "")
        what = f"{len(rows)} scenes are meant" if rows else "no scene of the study is meant"
        raise InputError(Problem(what, f"say one with --case, --analysis, --record, --at: {listed}", str(file)))
    ((row, _),) = rows
    scene = plan.scenes[row.scene]
    named = {"case": row.case, "analysis": row.analysis, "record": row.record}
    words = in_words(plan.shown(row), named, scene.motion.source)
    picture = picture_of_scene(scene, plan.study.title, words, plan.study.unit("acceleration"))
    return history(scene, plan.accuracy, plan.every), picture, "-".join((file.stem, row.case, row.analysis, row.record))


def _shown(frames: Iterable[np.ndarray], count: int, quiet: bool) -> Iterator[np.ndarray]:
    """The frames, with a progress bar on a terminal."""
    import sys

    if quiet or not sys.stderr.isatty():
        yield from frames
        return
    with click.progressbar(frames, length=count, label="frames", file=sys.stderr) as bar:
        yield from bar


def _swept(texts: tuple[str, ...]) -> dict[str, Any]:
    """Values of swept keys, in SI where they are quantities."""
    from pounding_cli.study.keep import amount

    pairs = dict(map(key_and_value, texts))
    return {key: value if (number := amount(value)) is None else number for key, value in pairs.items()}


def _time(option: str, text: str | None, default: float) -> float:
    """A time in seconds."""
    from pydantic_core import PydanticCustomError

    from pounding_cli.errors import InputError, Problem
    from pounding_cli.study.units import TIME, limited

    if text is None:
        return default
    try:
        return float(limited(TIME, example="2 s", open_low=False).read(text))
    except PydanticCustomError as refused:
        said = refused.context or {}
        raise InputError(Problem(f"{option}: {said.get('message', refused)}", said.get("hint", ""))) from None


def _scale(text: str) -> float | None:
    """The scale asked for; None for auto."""
    from pounding_cli.errors import InputError, Problem

    if text == "auto":
        return None
    try:
        scale = float(text)
    except ValueError:
        scale = 0.0
    if not 0 < scale < float("inf"):
        raise InputError(Problem(f"--scale {text} is no scale", "write auto, or a number above zero, e.g. --scale 20"))
    return scale

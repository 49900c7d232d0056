"""Arguments and options that several commands take, and what several commands print."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.errors import InputError, Issue

if TYPE_CHECKING:
    from pounding_cli.api.results import Results
    from pounding_cli.study.vary.changes import Change

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

FILE = click.Path(path_type=Path)

CHANGES_HELP = "KEY=VALUE puts a value in place of that of STUDY, such as cases.gap.gap='4 cm' (docs/how-to/change.md)."
"""A sentence of the help of commands that take a study."""


def _parse_changes(ctx: click.Context, param: click.Parameter, arguments: tuple[str, ...]) -> tuple[Change, ...]:
    """Return the changes of a study that arguments make.  Raises `InputError`."""
    if not arguments:
        return ()
    from pounding_cli.study.vary.changes import parse_changes

    return parse_changes(arguments)


changes_argument: Decorator = click.argument("changes", nargs=-1, metavar="[KEY=VALUE]...", callback=_parse_changes)
quiet_option: Decorator = click.option("-q", "--quiet", is_flag=True, help="Print only what failed.")


def together(*options: Decorator) -> Decorator:
    """Several options as one decorator, in the order of the help."""
    return lambda command: reduce(lambda found, option: option(found), reversed(options), command)


study_argument: Decorator = together(click.argument("study", type=FILE), changes_argument)


def output_option(default: str, text: str = "Results file.") -> Decorator:
    """`-o FILE.h5`."""
    return click.option("-o", "--output", type=FILE, metavar="FILE.h5", help=f"{text} Default: {default}.")


def open_file(path: Path) -> Results:
    """The results in a file.  Raises `InputError`, also where a study is given in their place."""
    from pounding_cli.api.studies import open_results

    if path.suffix in (".yaml", ".yml") and path.is_file():
        hint = f"solve it, `pound run {path}`, and name the results file"
        raise InputError(Issue((), "this is a study, not a results file", hint, file=str(path)))
    return open_results(path)


def seconds(text: str) -> float:
    """A time as a study writes it, in s: the type of an option."""
    from pydantic_core import PydanticCustomError

    from pounding_cli.study.schema.quantity import TIME

    try:
        return float(TIME.read(text))
    except PydanticCustomError as refused:
        said = refused.context or {}
        raise click.BadParameter(f"{said.get('message', refused)}; {said.get('hint', '')}") from None


def print_failures(failures: Iterable[tuple[str, str, str]]) -> None:
    """Print of every failure its place, what happened, and what to do about it."""
    for place, status, advice in failures:
        click.echo(f"failed: {place}: {status}" + (f"\n    {advice}" if advice else ""), err=True)


cell_options = together(
    click.option(
        "--separator", type=click.Choice((",", ";", "tab", "blank")),
        help="What parts the cells of a text file. Default: the sign on the most lines.",
    ),
    click.option("--decimal", type=click.Choice((".", ",")), help="Decimal sign. Default: a point."),
    click.option(
        "--thousands", type=click.Choice((",", ".", "'", " ")), help="Sign between thousands, if any."
    ),
)  # fmt: skip
"""Options that declare how the cells of a table of text are written."""

"""The `pound` command: finds each subcommand by name and imports it only when it is called."""

from __future__ import annotations

import errno
import importlib
import os
import re
import sys
from typing import TYPE_CHECKING, Any, NoReturn

import click

from pounding_cli import __version__
from pounding_cli.cli import streams
from pounding_cli.errors import InputError
from pounding_cli.workflows import TITLES

if TYPE_CHECKING:
    from collections.abc import Iterable


def _asking(*names: str) -> dict[str, tuple[str, str]]:
    """The commands of workflows; without names all."""
    places = {"run": "run", "optimise": "optimise"}
    return {
        name: (f"pounding_cli.cli.{places.get(name, f'answering:{name}')}", TITLES[name]) for name in names or TITLES
    }


COMMANDS = {
    "init": ("pounding_cli.cli.init", "Write a commented study to start from."),
    "check": ("pounding_cli.cli.check", "Validate a study; show what a run would solve and leave out."),
    **_asking("run"),
    "show": ("pounding_cli.cli.show", "Print a table of a results file."),
    "report": ("pounding_cli.cli.report", "Write figures, tables, claims and a page of results files."),
    **_asking(),
    "export": ("pounding_cli.cli.export", "Write tables as CSV, Parquet, Excel or netCDF."),
    "compare": ("pounding_cli.cli.compare", "Show what changed between two results files."),
    "cite": ("pounding_cli.cli.cite", "List the references of what a study used."),
    "schema": ("pounding_cli.cli.schema", "Print the JSON Schema of study files, for editors."),
    "records": ("pounding_cli.cli.records", "List, show and import ground motions."),
    "connector": (
        "pounding_cli.cli.points:connector",
        "Solve two connected oscillators in closed form (Figs 4 and 5).",
    ),
    "accuracy": ("pounding_cli.cli.accuracy", "Measure error and time of every method on a study."),
    "wall": ("pounding_cli.cli.points:wall", "Solve an impact on a bumper wall (Fig. 8)."),
}
"""Every command with its module and the line `pound --help` shows, in the order of a user's day."""

REFUSED, FAULT, STOPPED, NOBODY_READS = 2, 70, 130, 141
"""Exit codes: refused input; an internal error (EX_SOFTWARE); Ctrl-C and SIGPIPE, as shells count them."""

FIRST = ("init", "check", "run", "show", "report")
"""What a newcomer needs, in the order of use."""


class NobodyReads(Exception):
    """The reader of standard output has gone, as `head` does; click would end that with exit code 1."""


class LazyGroup(click.Group):
    """A group whose subcommands live in modules of their own, imported on use: `pound --help` stays fast."""

    def make_context(self, *arguments: Any, **more: Any) -> click.Context:
        """As click's; this prints the help."""
        try:
            return super().make_context(*arguments, **more)
        except BrokenPipeError as error:
            raise NobodyReads from error

    def invoke(self, ctx: click.Context) -> Any:
        """As click's."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError as error:
            raise NobodyReads from error

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module, _, name = COMMANDS[cmd_name][0].partition(":")
        return getattr(importlib.import_module(module), name or "command")

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click's, but an unknown command is answered with the nearest one, or with what takes such a file."""
        name = args[0]
        if name not in COMMANDS and not name.startswith("-") and not ctx.resilient_parsing:
            ctx.fail(f"there is no command '{name}'.{_meant(name)}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        sections = {"First steps": FIRST, "More": tuple(name for name in COMMANDS if name not in FIRST)}
        for title, names in sections.items():
            with formatter.section(title):
                formatter.write_dl([(name, COMMANDS[name][1]) for name in names])


def _meant(word: str) -> str:
    """What the user may have meant by an unknown command."""
    for suffixes, name in (((".yaml", ".yml"), "run"), ((".h5", ".hdf5"), "show")):
        if word.lower().endswith(suffixes):
            return f" Did you mean `pound {name} {word}`?"
    if word == "plan":
        return " `pound check` shows what a study will solve, leave out and take."
    near = _nearest(word, COMMANDS)
    return f" Did you mean `pound {near[0]}`?" if near else " `pound --help` lists them."


def _meant_choice(error: click.ClickException) -> str:
    """What the user may have meant by a word that is not among an argument's or option's choices; a line or ""."""
    kind = getattr(getattr(error, "param", None), "type", None)
    given = re.match(r"'(.+?)' is not one of", error.message)
    if not isinstance(kind, click.Choice) or given is None:
        return ""
    near = _nearest(given[1], [str(choice) for choice in kind.choices])
    return f"Did you mean '{near[0]}'?\n" if near else ""


def _nearest(word: str, among: Iterable[str]) -> list[str]:
    """The word among those that is most like the given one, in a list; an empty list where none is."""
    import difflib  # here, as whatever is needed for an error only: `pound --help` stays fast

    return difflib.get_close_matches(word.lower(), among, n=1, cutoff=0.5)


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="pound")
@click.option("--debug", is_flag=True, help="Show the traceback of an internal error, for a report.")
def cli(debug: bool) -> None:
    """Batch studies of earthquake pounding between adjacent buildings.

    \b
    Example:
      pound init my-study
      pound run my-study.yaml
      pound report results/my-study.h5

    \b
    Exit codes: 0 done; 1 some scenes failed, or results differ (compare);
    2 the input or the output was refused; 70 an internal error;
    130 stopped by Ctrl-C; 141 the program that read the output has closed.
    """


def main() -> None:
    """Run `pound`; whatever happens ends with a sentence and an exit code, a traceback is shown to who asks for it."""
    streams.prepare()
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # looking for some reads a file of every package
    try:
        code = cli(standalone_mode=False)
        sys.stdout.flush()
    except InputError as refused:
        for problem in refused.problems:
            click.echo(f"error: {problem}", err=True)
        _end(REFUSED)
    except click.ClickException as error:
        error.show()
        click.echo(_meant_choice(error), err=True, nl=False)
        _end(REFUSED)
    except (click.Abort, KeyboardInterrupt) as stop:
        if isinstance(stop.__cause__, EOFError):  # click takes one for Ctrl-D; nothing here asks a question
            _end(_unforeseen(stop.__cause__))
        click.echo("stopped; run the same command again to resume.", err=True)
        _end(STOPPED)
    except (NobodyReads, BrokenPipeError):
        _end(NOBODY_READS)
    except Exception as error:
        _end(_unforeseen(error))
    _end(code if isinstance(code, int) else 0)


def _end(code: int) -> NoReturn:
    streams.silence()
    sys.exit(code)


def _unforeseen(error: Exception) -> int:
    """Print an internal error: one line with the command to report it, or its traceback. Returns the exit code."""
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
        click.echo(f"error: there is no space left on the disk ({error.filename or 'while writing'})", err=True)
        return REFUSED
    first = (str(error).splitlines() or [""])[0]
    what = f"internal error: {type(error).__name__}: {first[:300]}"
    import shlex
    import traceback

    if "--debug" in sys.argv[1:2]:
        traceback.print_exception(error)
        click.echo(f"{what}\n    please report it with this traceback and the study file", err=True)
    else:
        command = shlex.join(["pound", "--debug", *sys.argv[1:]])
        click.echo(f"{what}\n    please report it with the study file and what this command shows: {command}", err=True)
    return FAULT

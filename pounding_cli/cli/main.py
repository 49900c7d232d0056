"""The `pound` command: finds each subcommand by name and imports it only when it is called."""

from __future__ import annotations

import difflib
import importlib
import re
import sys

import click

from pounding_cli import __version__
from pounding_cli.errors import InputError

COMMANDS = {
    "init": ("pounding_cli.cli.init", "Write a commented study to start from."),
    "check": ("pounding_cli.cli.check", "Validate a study file only."),
    "run": ("pounding_cli.cli.run", "Run what a study still lacks and print its summary."),
    "show": ("pounding_cli.cli.show", "Print a table of a results file."),
    "report": ("pounding_cli.cli.report", "Draw the figures and write the tables and the claims."),
    "animate": ("pounding_cli.cli.animate", "Show a scene over time as a film."),
    "plan": ("pounding_cli.cli.plan", "Show what would run and what would not, before running."),
    "export": ("pounding_cli.cli.export", "Write tables as CSV, Parquet, Excel or netCDF."),
    "compare": ("pounding_cli.cli.compare", "Say what changed between two results files."),
    "cite": ("pounding_cli.cli.cite", "List the references of what a study used."),
    "schema": ("pounding_cli.cli.schema", "Print the JSON Schema of study files, for editors."),
    "records": ("pounding_cli.cli.records", "List, show, import and synthesize ground motions."),
    "connector": ("pounding_cli.cli.connector", "Two connected oscillators in closed form (Figs 4 and 5)."),
    "accuracy": ("pounding_cli.cli.accuracy", "Error against time of every method; the cheapest for a wanted error."),
    "wall": ("pounding_cli.cli.wall", "The bumper wall of Fig. 8."),
}
"""Every command with its module and the line `pound --help` shows, in the order of a user's day."""

FIRST = ("init", "check", "run", "show", "report")
"""What a newcomer needs, in the order of use."""


class LazyGroup(click.Group):
    """A group whose subcommands live in modules of their own, imported on use: `pound --help` stays fast."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module = importlib.import_module(COMMANDS[cmd_name][0])
        return module.command

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
    near = difflib.get_close_matches(word.lower(), COMMANDS, n=1, cutoff=0.5)
    return f" Did you mean `pound {near[0]}`?" if near else " `pound --help` lists them."


def _meant_choice(error: click.ClickException) -> str:
    """What the user may have meant by a word that is not among an argument's or option's choices; a line or ""."""
    kind = getattr(getattr(error, "param", None), "type", None)
    given = re.match(r"'(.+?)' is not one of", error.message)
    if not isinstance(kind, click.Choice) or given is None:
        return ""
    near = difflib.get_close_matches(given[1].lower(), [str(choice) for choice in kind.choices], n=1, cutoff=0.5)
    return f"Did you mean '{near[0]}'?\n" if near else ""


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="pound")
def cli() -> None:
    """Batch studies of earthquake pounding between adjacent buildings.

    \b
    Example:
      pound init my-study
      pound run my-study.yaml
      pound report results/my-study.h5
    """


def main() -> None:
    """Run `pound`; a refused input ends with its list of problems and exit code 2, never with a traceback."""
    try:
        code = cli(standalone_mode=False)
    except InputError as refused:
        for problem in refused.problems:
            click.echo(f"error: {problem}", err=True)
        sys.exit(2)
    except click.ClickException as error:
        error.show()
        click.echo(_meant_choice(error), err=True, nl=False)
        sys.exit(2)
    except (click.Abort, KeyboardInterrupt):
        click.echo("stopped; run the same command again to go on.", err=True)
        sys.exit(130)
    sys.exit(code if isinstance(code, int) else 0)

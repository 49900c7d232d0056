"""The `pound` command: finds each subcommand by name and imports it only when it is called."""

from __future__ import annotations

import importlib
import sys

import click

from pounding_cli import __version__
from pounding_cli.errors import InputError

COMMANDS = {
    "run": ("pounding_cli.cli.run", "Run what a study still lacks and print its summary."),
    "report": ("pounding_cli.cli.report", "Draw the figures and write the tables and the claims."),
    "plan": ("pounding_cli.cli.plan", "Show what would run and what would not, before running."),
    "check": ("pounding_cli.cli.check", "Validate a study file only."),
    "show": ("pounding_cli.cli.show", "Print a table of a results file."),
    "schema": ("pounding_cli.cli.schema", "Print the JSON Schema of study files, for editors."),
    "records": ("pounding_cli.cli.records", "List, show, import and synthesize ground motions."),
    "connector": ("pounding_cli.cli.connector", "Two connected oscillators in closed form (Figs 4 and 5)."),
    "accuracy": ("pounding_cli.cli.accuracy", "Error against time of every method; the cheapest for a wanted error."),
    "wall": ("pounding_cli.cli.wall", "The bumper wall of Fig. 8."),
}


class LazyGroup(click.Group):
    """A group whose subcommands live in modules of their own, imported on use: `pound --help` stays fast."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module = importlib.import_module(COMMANDS[cmd_name][0])
        return module.command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="pound")
def cli() -> None:
    """Batch studies of earthquake pounding between adjacent buildings."""


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
        sys.exit(2)
    except (click.Abort, KeyboardInterrupt):
        click.echo("stopped; run the same command again to go on.", err=True)
        sys.exit(130)
    sys.exit(code if isinstance(code, int) else 0)

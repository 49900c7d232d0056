"""The `pound` command: finds each subcommand by name and imports it only when it is called."""

from __future__ import annotations

import difflib
import errno
import importlib
import io
import keyword
import os
import sys
from contextlib import suppress

import click

from pounding_cli import __version__
from pounding_cli.errors import InputError
from pounding_cli.paper import TITLES as POINT_TITLES
from pounding_cli.questions import TITLES
from pounding_cli.signals import take_signals

_QUESTIONS = {name: ("solve", title) for name, title in TITLES.items()}

COMMANDS = {
    "init": ("study", "Write a commented study to start from."),
    "import": ("imports", "Write a study from tables of a frame program or from pushover curves."),
    "check": ("study", "Validate a study; show what is solved, and how long the rest takes."),
    "run": _QUESTIONS.pop("run"),
    "show": ("results", "Print a table of a results file."),
    "report": ("results", "Write figures, tables and a page of results files."),
    **_QUESTIONS,
    "screen": ("screen", TITLES["screen"]),
    "export": ("results", "Write tables as CSV, Parquet, Excel or netCDF."),
    "compare": ("results", "Show what changed between two results files."),
    "explain": ("notes", "Explain a warning or a note by its code."),
    "cite": ("study", "List the references of what a study used."),
    "schema": ("study", "Print the JSON Schema of study files, for editors."),
    "records": ("records", "List, show and import ground motions."),
    "connector": ("paper", POINT_TITLES["connector"]),
    "accuracy": ("accuracy", "Measure error and time of every method on a study."),
    "wall": ("paper", POINT_TITLES["wall"]),
}
"""Every command with its module and the line `pound --help` shows, in the order of a user's day."""

REFUSED = 2
"""Exit code of refused input."""

FAULT = 70
"""Exit code of an internal error (EX_SOFTWARE)."""

STOPPED = 130
"""Exit code of Ctrl-C, as shells count it."""

GRACE = 1.0
"""Time that a command has to end by itself after Ctrl-C [s]; what no other thread can stop is cut off then."""

NOBODY_READS = 141
"""Exit code of SIGPIPE, as shells count it."""


_LINEAR_ALGEBRA = ("OPENBLAS", "OMP", "MKL", "NUMEXPR", "VECLIB_MAXIMUM")
# Each takes one thread: scenes are solved side by side, and their matrices are small; threads cost a fifth of a start.

AFTER_STOP = "stopped; run the same command again to resume."
"""What a command says at its end after Ctrl-C."""


class LazyGroup(click.Group):
    """A group whose subcommands live in modules of their own, imported on use: `pound --help` stays fast."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            near = difflib.get_close_matches(cmd_name, COMMANDS, 1)
            if near and not ctx.resilient_parsing:  # not while a shell completes a line
                ctx.fail(f"No such command '{cmd_name}'. Did you mean '{near[0]}'?")
            return None
        module = importlib.import_module(f"pounding_cli.cli.{COMMANDS[cmd_name][0]}")
        attribute = f"{cmd_name}_" if keyword.iskeyword(cmd_name) else cmd_name
        command = getattr(module, attribute, None) or module.build_question_command(cmd_name)
        command.short_help = COMMANDS[cmd_name][1]
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


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
    Exit codes: 0 done; 1 some time histories failed, or results differ (compare);
    2 the input or the output was refused; 70 an internal error;
    130 stopped by Ctrl-C or SIGTERM; 141 the program that read the output has closed.
    """


def main() -> None:
    """Run `pound`; whatever happens ends with a sentence and an exit code, a traceback is shown to who asks for it."""
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:  # closed; a file opened next would take its number
            setattr(sys, name, open(os.devnull, "r" if name == "stdin" else "w"))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="replace")
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # looking for some reads a file of every package
    for library in _LINEAR_ALGEBRA:
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    with take_signals(GRACE, _end):
        code = _run()
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):  # nobody reads it any more: what cannot be written is dropped
            with suppress(OSError, ValueError), open(os.devnull, "w") as nowhere:
                os.dup2(nowhere.fileno(), stream.fileno())
    sys.exit(code)


def _end() -> None:
    """End the process as one that was stopped: what is on the disk is complete whenever that happens."""
    with suppress(OSError):
        os.write(2, f"{AFTER_STOP}\n".encode())
    os._exit(STOPPED)


def _run() -> int:
    """The exit code of the command."""
    try:
        found = cli(standalone_mode=False)
        sys.stdout.flush()
        return found if isinstance(found, int) else 0
    except InputError as refused:
        for problem in refused.issues:
            click.echo(f"error: {problem}", err=True)
        return REFUSED
    except click.ClickException as error:
        error.show()
        return REFUSED
    except (click.Abort, KeyboardInterrupt) as stop:
        if isinstance(stop.__cause__, EOFError):  # click takes one for Ctrl-D; nothing here asks a question
            return _unforeseen(stop.__cause__)
        click.echo(AFTER_STOP, err=True)
        return STOPPED
    except BrokenPipeError:
        return NOBODY_READS
    except SystemExit as ended:  # click ends with 1 where nobody reads what it writes, and with 0 behind a completion
        return NOBODY_READS if ended.code else 0
    except Exception as error:
        return _unforeseen(error)


def _unforeseen(error: Exception) -> int:
    """Print an internal error: one line with the command to report it, or its traceback. Returns the exit code."""
    import shlex
    import traceback

    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
        click.echo(f"error: there is no space left on the disk ({error.filename or 'while writing'})", err=True)
        return REFUSED
    first = (str(error).splitlines() or [""])[0]
    click.echo(f"internal error: {type(error).__name__}: {first[:300]}", err=True)
    if "--debug" in sys.argv[1:2]:
        traceback.print_exception(error)
        click.echo("    please report it with this traceback and the study file", err=True)
    else:
        command = shlex.join(["pound", "--debug", *sys.argv[1:]])
        click.echo(f"    please report it with the study file and what this command shows: {command}", err=True)
    return FAULT

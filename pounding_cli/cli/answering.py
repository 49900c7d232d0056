"""What all commands share that answer a question of a study: options, the way to the answer, tables in print."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli import streams
from pounding_cli.cli.solving import Solving, output_option, solve_study, solving_options, time_text
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome

FEW_POINTS = 4
"""Points of a sweep that are printed; the table of the answer holds all."""

Tell = Callable[[Path, "Outcome"], None]
"""tell(results file, outcome) -> None; prints the answer."""


def answer_command(name: str) -> Callable[[Tell], click.Command]:
    """Decorator: makes the command of a workflow from the function that prints its answer, whose docstring is the
    help."""

    def made(tell: Tell) -> click.Command:
        @click.command(name, short_help=WORKFLOWS[name].title, help=tell.__doc__)
        @click.argument("study", type=click.Path(path_type=Path))
        @output_option("results/<study>.h5" if WORKFLOWS[name].marks else f"results/<study>-{name}.h5")
        @solving_options
        @click.pass_context
        def command(ctx: click.Context, study: Path, output: Path | None, **options: Any) -> None:
            solve_study(ctx, name, study, output, Solving(**options), tell)

        return command

    return made


def print_table(heads: Sequence[str], rows: Sequence[Sequence[str]], words: int) -> None:
    """A table; `words` : how many columns of text come first."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for number, heading in enumerate(heads):
        table.add_column(heading, justify="left" if number < words else "right", no_wrap=number < words)
    for row in rows:
        table.add_row(*row)
    streams.echo_table(table)


def print_outcome(outcome: Outcome, scenes: str) -> None:
    """What it took; `scenes` : which scenes, e.g. "5 motions; scenes"."""
    side = f", {outcome.workers} side by side" if outcome.workers > 1 else ""
    click.echo(
        f"{scenes}: {outcome.done} solved, {outcome.reused} reused, {outcome.failed} failed{side}; "
        f"solver {time_text(outcome.solver_seconds)}, in all {time_text(outcome.wall_seconds)}"
    )
    click.echo(f"Results: {outcome.path}")

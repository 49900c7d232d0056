"""`pound gap`: how wide the gap must be."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli import streams
from pounding_cli.cli.solving import Solving, output_option, solve_study, solving_options, time_text
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome

FEW_POINTS = 4
"""Points of a sweep that are printed; the table `gap` holds all."""


@click.command("gap", short_help="How wide must the gap be?")
@click.argument("study", type=click.Path(path_type=Path))
@output_option("results/<study>-gap.h5")
@solving_options
@click.pass_context
def command(ctx: click.Context, study: Path, output: Path | None, **options: Any) -> None:
    """How wide the gap of STUDY must be, so that its buildings do not touch.

    Each building moves alone under every motion; the largest closing of two floors that face each other is the width
    that this motion requires. Statistics over the motions, the width for a wanted probability of contact, and beside
    them the rules ABS, SRSS, DDC and those of codes. What is asked stands under `gap:` of the study; without it, mean,
    largest, 84th percentile and 10 % probability of contact.

    The links of the cases and keys swept in `cases` and `impact` mean nothing here.
    After Ctrl-C, a crash or a full disk the same command continues from what was solved.

    \b
    Example:
      pound gap study.yaml
      pound show results/study-gap.h5 gap
      pound report results/study-gap.h5
    """
    solve_study(ctx, "gap", study, output, Solving(**options), _summary)


def _summary(path: Path, outcome: Outcome) -> None:
    """Required widths at the pair of floors that needs most, one table for each pair of buildings."""
    from rich import box
    from rich.table import Table

    from pounding_cli.report.gap_text import error_sentence, governing, headings, numbers, pair_heading
    from pounding_cli.store import open_results
    from pounding_cli.store.gap import CONFIDENCE

    results = open_results(path)
    answer = results.answer("gap")
    click.echo(results.title)
    parts = governing(answer.frame, list(results.axes))
    for point, left, right, rows in parts[:FEW_POINTS]:
        click.echo(pair_heading(results, point, left, right, rows))
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for number, heading in enumerate(headings(answer)):
            table.add_column(heading, justify="left" if number < 2 else "right", no_wrap=number < 2)
        for row in numbers(answer, rows):
            table.add_row(*row)
        streams.echo_table(table)
    if len(parts) > FEW_POINTS:
        click.echo(f"{len(parts) - FEW_POINTS} further pairs and points of the sweep: pound show {path} gap")
    click.echo(f"In brackets: {CONFIDENCE:.0%} confidence. {error_sentence(answer, answer.frame)}")
    side = f", {outcome.workers} side by side" if outcome.workers > 1 else ""
    motions = results.records()["record"].nunique()
    click.echo(
        f"{counted(motions, 'motion')}; buildings alone: {outcome.done} solved, "
        f"{outcome.reused} reused, {outcome.failed} failed{side}; solver {time_text(outcome.solver_seconds)}, in all "
        f"{time_text(outcome.wall_seconds)}"
    )
    click.echo(f"Results: {path}")

"""`pound gap`: how wide the gap must be."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli.answering import FEW_POINTS, answer_command, print_outcome, print_table
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome


HEAD = 20_000
"""Rows of the table that are read for what is printed: many times those of the few points that are."""


@answer_command("gap")
def command(path: Path, outcome: Outcome) -> None:
    """Compute how wide the gap of STUDY must be, so that its buildings do not touch.

    Each building moves alone under every motion. The largest closing of two floors that face each other is the gap
    that this motion requires. The command prints statistics over the motions, the gap for a given probability of
    contact, and the gaps by the rules ABS, SRSS, DDC and those of codes. The section `gap:` of the study selects them;
    the default is mean, largest, 84th percentile and 10 % probability of contact.

    The command ignores the links of the cases and swept keys of `cases` and `impact`.
    After Ctrl-C, a crash or a full disk, run the same command again to resume.

    \b
    Example:
      pound gap study.yaml
      pound show results/study-gap.h5 gap
      pound report results/study-gap.h5
    """
    from pounding_cli.report.gap_text import error_sentence, governing, headings, numbers, pair_heading
    from pounding_cli.store import open_results
    from pounding_cli.store.gap import CONFIDENCE

    results = open_results(path)
    answer = results.answer_head("gap", HEAD)  # of a long sweep the table takes more memory than the run
    click.echo(results.title)
    parts = governing(answer.frame, list(results.axes))
    points = math.prod(len(values) for values in results.axes.values())
    count = points * (len(results.resolved["places"]) - 1)
    for point, left, right, rows in parts[:FEW_POINTS]:
        click.echo(pair_heading(results, point, left, right, rows))
        print_table(headings(answer), numbers(answer, rows), words=2)
    if count > FEW_POINTS:
        click.echo(f"{count - FEW_POINTS} further pairs and points of the sweep: pound show {path} gap")
    error = results.largest_in_answer("gap", "error")
    click.echo(f"In brackets: {CONFIDENCE:.0%} confidence. {error_sentence(answer, error)}")
    motions = results.records()["record"].nunique()
    print_outcome(outcome, f"{counted(motions, 'motion')}; buildings alone")

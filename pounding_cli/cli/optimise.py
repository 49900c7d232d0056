"""`pound optimise`: what is best."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli.answering import answer_command, print_outcome, print_table
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome


@answer_command("optimise")
def command(path: Path, outcome: Outcome) -> None:
    """Minimise or maximise a number over chosen keys of STUDY.

    The section `optimise:` of the study has the number as an expression over the tables (`least:` or `most:`), and the
    keys with their ranges (`over:`). Differential evolution and the simplex method find the optimum. The command then
    solves points around it, to show how far each key may be from its best value.

    After Ctrl-C, a crash or a full disk, run the same command again to resume.
    Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

    \b
    Example:
      pound optimise study.yaml
      pound show results/study-optimise.h5 optimise
      pound report results/study-optimise.h5
    """
    from pounding_cli.report.optimise_text import cells, heads, notes, optimum_of, sentences
    from pounding_cli.store import open_results

    results = open_results(path)
    found = optimum_of(results)
    click.echo(results.title)
    for sentence in sentences(found):
        click.echo(sentence)
    if found.is_found:
        print_table(heads(found), cells(found), words=1)
    for note in notes(found):
        click.echo(note)
    print_outcome(outcome, f"{counted(found.points, 'point')}; scenes")

"""`pound sensitivity`: what matters."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli.answering import FEW_POINTS, answer_command, print_outcome, print_table
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome


@answer_command("sensitivity")
def command(path: Path, outcome: Outcome) -> None:
    """Compute how much each uncertain key of STUDY contributes to the variance of its results.

    The section `uncertain:` has the keys with their distributions; `motion: any` varies the motion too. The section
    `sensitivity:` has the outputs, e.g. `outputs: [largest mu in soft]`, or `claims: all` for the probability of the
    paper's statements. Quasi-random samples are solved like a sweep. Sobol indices give the part of the variance that
    each key explains; Morris indices screen many keys at low cost.

    A failed scene is solved again with a hundred times finer accuracy. If it fails again, its outputs get no index.
    After Ctrl-C, a crash or a full disk, run the same command again to resume.
    Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

    \b
    Example:
      pound sensitivity study.yaml
      pound show results/study-sensitivity.h5 sensitivity
      pound report results/study-sensitivity.h5
    """
    from pounding_cli.report import claim_odds
    from pounding_cli.report.claim_samples import ODDS
    from pounding_cli.report.sensitivity_text import cells, heads, notes, parts, split_claims, spread_sentence
    from pounding_cli.store import open_results
    from pounding_cli.store.sensitivity import INDICES, OUTPUTS

    results = open_results(path)
    answer = results.answer(INDICES)
    among = [key for key in results.axes if key in answer.frame]
    click.echo(results.title)
    if claim_odds.asks_claims(results):
        odds = results.answer(ODDS).frame
        points = list(odds.groupby(among, sort=False)) if among else [((), odds)]
        for place, rows in points[:FEW_POINTS]:
            if among:
                click.echo(", ".join(f"{k} = {results.units[k].text(v)}" for k, v in zip(among, place, strict=True)))
            print_table(claim_odds.HEADS, claim_odds.rows(rows), words=1)
        if len(points) > FEW_POINTS:
            click.echo(f"{len(points) - FEW_POINTS} further points: pound show {path} {ODDS}")
    found = list(parts(results, split_claims(answer.frame)[1], among))
    for part in found[:FEW_POINTS]:
        click.echo(f"{part.output}{f' [{part.unit}]' if part.unit else ''}{f', {part.words}' if part.words else ''}")
        if part.outcome == "found":
            print_table(heads(answer), cells(answer, part), words=1)
        else:
            click.echo(f"  {part.outcome}")
    if len(found) > FEW_POINTS:
        click.echo(f"{len(found) - FEW_POINTS} further outputs, cases and points: pound show {path} {INDICES}")
    if OUTPUTS in results.answers:
        for row in results.answer(OUTPUTS).frame.to_dict("records")[:FEW_POINTS]:
            click.echo(spread_sentence(row))
    if claim_odds.asks_claims(results):
        for note in claim_odds.notes(results, results.answer(ODDS).frame)[: claim_odds.GENERAL_NOTES]:
            click.echo(note)
    for note in notes(results):
        click.echo(note)
    samples = counted(int(answer.frame["samples"].iloc[0]), "sample")
    print_outcome(outcome, f"{samples}; scenes")

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
    from pounding_cli.store import Results
    from pounding_cli.store.answers import Answer


FEW_GAPS = 3
"""Gaps of the cases that are printed for a pair of neighbours."""

HEAD = 20_000
"""Rows of the table that are read for what is printed: many times those of the few points that are."""


@answer_command("gap")
def command(path: Path, outcome: Outcome) -> None:
    """Compute how wide the gap of STUDY must be, so that its buildings do not touch.

    Each building moves alone under every motion. The largest closing of two floors that face each other is the gap
    that this motion requires. The command prints statistics over the motions, the gap for a given probability of
    contact, and the gaps by the rules ABS, SRSS, DDC and those of codes. The section `gap:` of the study selects them;
    the default is mean, largest, 84th percentile and 10 % probability of contact.

    It then says for each case whether its gap is enough, by each rule and for how many motions, and how far each
    building moves to either side, which is its distance to a property line. The buildings move alone: links do not
    change what is required.

    After Ctrl-C, a crash or a full disk, run the same command again to resume.

    \b
    Example:
      pound gap study.yaml
      pound show results/study-gap.h5 gap_cases
      pound show results/study-gap.h5 property_line
      pound report results/study-gap.h5
    """
    from pounding_cli.report import gap_text as said
    from pounding_cli.store import open_results
    from pounding_cli.store.gap import CASES, LINE

    results = open_results(path)
    # of a long sweep the tables take more memory than the run
    answer, cases, line = (results.answer_head(name, HEAD) for name in ("gap", CASES, LINE))
    click.echo(results.title)
    parts = said.governing(answer.frame, list(results.axes))
    points = math.prod(len(values) for values in results.axes.values())
    count = points * (len(results.resolved["places"]) - 1)
    for point, left, right, rows in parts[:FEW_POINTS]:
        click.echo(said.pair_heading(results, point, left, right, rows))
        print_table(said.headings(answer), said.numbers(answer, rows), words=2)
        own, gaps = said.cases_at(cases.frame, point, left, right, FEW_GAPS)
        if gaps:
            click.echo(f"Gaps of the cases, {left} | {right}")
            print_table(said.case_headings(cases), said.case_rows(cases, own), words=3)
            for sentence in said.case_sentences(cases, own):
                click.echo(sentence)
        if gaps > FEW_GAPS:
            click.echo(f"{counted(gaps - FEW_GAPS, 'further gap')} of cases: pound show {path} {CASES}")
    if count > FEW_POINTS:
        click.echo(f"{count - FEW_POINTS} further pairs and points of the sweep: pound show {path} gap")
    _print_line(results, path, line)
    error = results.largest_in_answer("gap", "error")
    notes = [said.interval_sentence(answer.frame), said.error_sentence(answer, error)]
    notes = [" ".join(filter(None, notes)), *said.case_notes(results, cases.frame), *said.code_notes(results)]
    for note in notes:
        click.echo(note)
    motions = results.records()["record"].nunique()
    print_outcome(outcome, f"{counted(motions, 'motion')}; buildings alone")


def _print_line(results: Results, path: Path, line: Answer) -> None:
    """Distances to a property line, at the first point of the sweep."""
    from pounding_cli.report.gap_text import line_headings, line_rows
    from pounding_cli.store.gap import LINE

    frame, label = line.frame, results.point_label((0,) * len(results.swept))
    for key, values in results.axes.items():
        frame = frame[frame[key] == values[0]]
    names = list(dict.fromkeys(frame["building"]))
    shown = frame[frame["building"].isin(names[:FEW_POINTS])]
    click.echo("Distance to a property line, at the floors that move most" + (f", {label}" if label else ""))
    print_table(line_headings(line), line_rows(line, shown), words=5)
    if label or len(names) > FEW_POINTS:
        click.echo(f"all floors, buildings and points of the sweep: pound show {path} {LINE}")

"""`pound fragility`: how likely a limit is passed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli.answering import FEW_POINTS, answer_command, print_outcome, print_table
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome


@answer_command("fragility")
def command(path: Path, outcome: Outcome) -> None:
    """Compute how likely the limits of STUDY are passed over an intensity, for each building alone and with pounding.

    The section `fragility:` of the study has the limits (`mu > 4`, `drift > 2 %`, `acceleration > 1 g`,
    `shear_demand > 1`, `contact`, `collapse`), the section `sweep:` the intensities (`records.scale.pga`, `.sa`, `.pgv`
    or `records.scale`). By default each motion is scaled until it passes, and only the intensities needed for this are
    solved. The curves are lognormal, fitted by maximum likelihood, with bootstrap intervals over the motions.

    After Ctrl-C, a crash or a full disk, run the same command again to resume.
    Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

    \b
    Example:
      pound fragility study.yaml
      pound show results/study-fragility.h5 fragility
      pound report results/study-fragility.h5
    """
    from pounding_cli.report.fragility_text import asked_of, notes, table
    from pounding_cli.store import open_results
    from pounding_cli.store.fragility import CURVES

    results = open_results(path)
    answer, asked = results.answer(CURVES), asked_of(results)
    frame = answer.frame
    keys = [key for key in results.axes if key in frame]
    click.echo(results.title)
    click.echo(f"Intensity: {asked.measure}")
    parts = list(frame.groupby(keys, sort=False)) if keys else [((), frame)]
    for point, rows in parts[:FEW_POINTS]:
        if keys:
            values = point if isinstance(point, tuple) else (point,)
            click.echo(", ".join(f"{k} = {results.value_label(k, v)}" for k, v in zip(keys, values, strict=True)))
        print_table(*table(answer, rows))
    if len(parts) > FEW_POINTS:
        click.echo(f"{len(parts) - FEW_POINTS} further points of the sweep: pound show {path} {CURVES}")
    for note in notes(asked, frame):
        click.echo(note)
    motions = results.records()["record"].nunique()
    print_outcome(outcome, f"{counted(motions, 'motion')}; scenes")

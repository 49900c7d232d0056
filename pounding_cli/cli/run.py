"""`pound run`: run a study, reusing scenes solved before, and print its summary."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from pounding_cli.cli.answering import print_answer
from pounding_cli.cli.solving import Solving, output_option, solve_study, solving_options


@click.command("run", short_help="Run a study and print its summary.")
@click.argument("study", type=click.Path(path_type=Path))
@output_option("results/<study>.h5")
@solving_options
@click.pass_context
def command(ctx: click.Context, study: Path, output: Path | None, **options: Any) -> None:
    """Run STUDY, write one results file and print a summary.

    The command reuses scenes of earlier runs, also after changes of the study, and prints their number. It refuses a
    file with the results of another study unless --replace is given. After Ctrl-C, a crash or a full disk, run the
    same command again to resume. Exit code 0: all scenes done; 1: some failed (they are listed);
    2: the study or the output was refused.

    \b
    Example:
      pound run configs/fig6.yaml
      pound run configs/fig6.yaml -o results/fig6.h5 --workers 4
      pound run sweep.yaml --engine dask --scheduler tcp://node:8786
    """
    solve_study(ctx, "run", study, output, Solving(**options), print_answer)

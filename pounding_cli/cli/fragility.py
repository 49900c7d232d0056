"""`pound fragility`: how likely a limit is passed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli.solving import Solving, output_option, solve_study, solving_options

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome


@click.command("fragility", short_help="How likely is a limit passed?")
@click.argument("study", type=click.Path(path_type=Path))
@output_option("results/<study>-fragility.h5")
@solving_options
@click.pass_context
def command(ctx: click.Context, study: Path, output: Path | None, **options: Any) -> None:
    """How likely a limit is passed."""
    solve_study(ctx, "fragility", study, output, Solving(**options), _summary)


def _summary(path: Path, outcome: Outcome) -> None:
    from pounding_cli.store import open_results

    click.echo(open_results(path).table("fragility").T.to_string())
    click.echo(str(outcome))

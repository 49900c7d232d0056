"""The command that asks of a table of neighbours: `pound screen`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from pounding_cli.cli.options import FILE, cell_options, output_option
from pounding_cli.cli.solve import answer_question, print_taken, solving_options
from pounding_cli.errors import InputError, Issue

MAX_WARNINGS = 10
"""Warnings of pairs that are printed."""


@click.command()
@click.argument("table", type=FILE, metavar="STREET.csv")
@output_option("results/STREET-screen.h5")
@click.option(
    "--hazard",
    default="",
    metavar="CURVE",
    help="Hazard curve of rows without one, as a study has it: '{0.1 g: 0.02, 0.4 g: 1/475}', or a file.",
)
@click.option(
    "--return-period",
    type=click.FloatRange(1, 1e7),
    default=475.0,
    show_default=True,
    metavar="YEARS",
    help="Return period of `pga` in rows without one.",
)
@click.option(
    "--slope",
    type=click.FloatRange(0.5, 10),
    default=3.0,
    show_default=True,
    metavar="K",
    help="Exponent of the hazard curve of rows that give one acceleration (EN 1998-1, 2.1).",
)
@click.option(
    "--zone",
    default="",
    metavar="ZONE",
    help="Seismic zone of the UBC, by which years become design levels: 4, 3, 2B, 2A, 1 or 0.",
)
@click.option(
    "--motions",
    default="",
    metavar="NAMES",
    help="Motions of the catalogue or files, separated by commas. Default: the five of the catalogue.",
)
@click.option(
    "--duration", default="10 s", show_default=True, help="How much of each motion is used; `whole`: all of it."
)
@click.option(
    "--levels",
    default="",
    metavar="PGAS",
    help="Peak accelerations to which motions are scaled. Default: 0.1 g, 0.3 g, 0.8 g.",
)
@click.option(
    "--neighbours",
    type=click.IntRange(2, 1000),
    default=20,
    show_default=True,
    help="Number of buildings that each neighbour may be.",
)
@cell_options
@click.option(
    "--pair", metavar="NAME", help="Print the study of one pair, for `pound gap` and `pound run`, and solve nothing."
)
@solving_options
@click.pass_context
def screen(
    ctx: click.Context, table: Path, output: Path | None, hazard: str, return_period: float, slope: float, zone: str,
    motions: str, duration: str, levels: str, neighbours: int, pair: str | None, separator: str | None,
    decimal: str | None, thousands: str | None, **how: Any,
) -> None:  # fmt: skip
    """Rank the pairs of neighbours of STREET.csv by how often they strike, and say what decides.

    A row is a pair: types of HAZUS, design levels or years, storeys, gap, and the shaking of the site
    (docs/how-to/screen.md has the headings). Time histories of earlier runs are reused. After Ctrl-C, a crash or a full
    disk, run the same command again to resume. Exit code 0: all done; 1: some failed; 2: the table was refused.

    \b
    Example:
      pound screen street.csv --hazard '{0.1 g: 0.02, 0.4 g: 1/475}'
      pound screen street.csv --pair "3 | 5" > pair.yaml
    """
    from pounding_cli.api.studies import default_output
    from pounding_cli.batch.progress import JsonLines
    from pounding_cli.questions.screen.question import Screen
    from pounding_cli.questions.screen.street import Settings
    from pounding_cli.questions.screen.street_table import read_street

    defaults = Settings()
    settings = Settings(
        motions=_split_list(motions) or defaults.motions,
        duration=duration,
        levels=_split_list(levels) or defaults.levels,
        neighbours=neighbours,
        hazard=hazard,
        zone=zone,
        return_period=return_period,
        slope=slope,
        separator=separator or "",
        decimal=decimal or "",
        thousands=thousands or "",
    )
    street = read_street(table, settings)
    if pair is not None:
        named = [each for each in street.pairs if each.name == pair]
        if not named:
            from pounding_cli.study.text.file import nearest

            names = [each.name for each in street.pairs]
            hint = nearest(pair, names) or f"write one of: {', '.join(names[:10])}"
            raise InputError(Issue((), f"--pair {pair}: there is no such pair", hint, file=str(table)))
        click.echo(street.format_study(named[0]), nl=False)
        return
    warnings = street.find_warnings()
    shown = [str(warning) for warning in warnings[:MAX_WARNINGS]]
    if len(warnings) > MAX_WARNINGS:
        shown.append(f"and {len(warnings) - MAX_WARNINGS} more in other rows")
    for warning in shown:
        if how["log_json"]:
            JsonLines().write_event("warning", text=warning)
        elif not how["quiet"]:
            click.echo(f"warning: {warning}", err=True)
    print_taken(street.list_taken(), how["quiet"], JsonLines() if how["log_json"] else None)
    path = output or default_output(table, "screen")
    if not answer_question(Screen(street), path, **how):
        ctx.exit(1)


def _split_list(text: str) -> tuple[str, ...]:
    """Return the parts of an option between its commas."""
    return tuple(part.strip() for part in text.split(",") if part.strip())

"""`pound compare`: what changed between two results files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.results.compare import Comparison

FEW = 12
"""Lines of one kind shown unless all are asked for."""


@click.command("compare")
@click.argument("first", type=click.Path(path_type=Path), metavar="A.h5")
@click.argument("second", type=click.Path(path_type=Path), metavar="B.h5")
@click.option("--numbers", is_flag=True, help="Compare only scenes and their numbers for the exit code, not the study.")
@click.option("--all", "everything", is_flag=True, help="List every changed number and scene.")
@click.pass_context
def command(ctx: click.Context, first: Path, second: Path, numbers: bool, everything: bool) -> None:
    """Show what changed from A.h5 to B.h5: study, versions, scenes, and numbers beyond their errors.

    A number counts as changed if it differs by more than the sum of the errors that both files estimate for its scene.
    Exit code 0: the files agree; 1: they differ in study, scenes or numbers; 2: a file was refused. The command
    reports differences of wording, comments, versions and times, but they do not change the exit code.

    \b
    Example:
      pound compare results/old.h5 results/new.h5
      pound compare before.h5 after.h5 --numbers && echo "no number moved"
    """
    from pounding_cli.api.studies import open_results
    from pounding_cli.results.compare import compare

    found = compare(open_results(first), open_results(second))
    for line in _told(found, everything):
        click.echo(line)
    if not (found.same_numbers if numbers else found.same):
        ctx.exit(1)


def _told(found: Comparison, everything: bool) -> list[str]:
    few = None if everything else FEW
    said = [_study(found)]
    said += _some([f"  {line}" for line in found.lines], few)
    said += _some([f"  {key}: {_value(one)} -> {_value(other)}" for key, one, other in found.keys], few)
    said.append(f"Versions: {'differ' if found.software else 'the same'}.")
    said += [f"  {name}: {one} -> {other}" for name, one, other in found.software]
    said.append(
        f"Scenes: {len(found.removed)} removed, {len(found.added)} added, {len(found.outcomes)} with another outcome."
    )
    said += _some([f"  - {place}" for place in found.removed], few)
    said += _some([f"  + {place}" for place in found.added], few)
    said += _some([f"  {place}: {one} -> {other}" for place, one, other in found.outcomes], few)
    count = len(found.changes)
    differ = "differs" if count == 1 else "differ"
    said.append(f"Numbers: {count} of {found.compared} {differ} beyond the errors of both files.")
    if found.unestimated:
        what = counted(found.unestimated, "scene carries", "scenes carry")
        said.append(f"  {what} no error estimate: the accuracy asked or rounding is used instead.")
    return said + _numbers(found, everything)


def _study(found: Comparison) -> str:
    if found.keys:
        return f"Study: differs in {counted(len(found.keys), 'key')}."
    return "Study: the same, with different wording." if found.lines else "Study: the same."


def _numbers(found: Comparison, everything: bool) -> list[str]:
    """Every changed number, or of each column how many and the worst."""
    from pounding_cli.results.tables import column_of

    said = []
    for (table, column), rows in found.changes.groupby(["table", "column"], sort=False):
        unit = column_of(str(column), str(table)).unit.name
        head = f"  {table} {column}: {len(rows)} differ" if not everything else f"  {table} {column}:"
        said.append(head + ("" if everything else ", most:"))
        for row in rows.itertuples() if everything else rows.head(1).itertuples():
            said.append(
                f"    {row.place}: {row.before:.6g} -> {row.after:.6g} {unit}".rstrip()
                + f", by {row.difference:.1e}; carried {row.carried:.1e}"
            )
    return said


def _some(lines: list[str], few: int | None) -> list[str]:
    if few is None or len(lines) <= few:
        return lines
    return [*lines[:few], f"  ... {len(lines) - few} more: --all lists them"]


def _value(value: object) -> str:
    return "nothing" if value is None else str(value)

"""`pound show`: print a table of a results file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli.places import at_option, points_at
from pounding_cli.numbers import counted
from pounding_cli.texts import cells
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.store import Results

TABLES = (
    *("storey", "floor", "link", "struck", "scene", "flagged", "accuracy", "summary", "records", "buildings"),
    *(table for workflow in WORKFLOWS.values() for table in workflow.shows),
)
_NOTHING = {"link": "no links", "struck": "no columns that a slab strikes", "flagged": "no flags"}
"""What a case without rows in a table has none of."""
_SENTENCES = ("effects", "dropped", "flags")
_ASIDE = {
    "summary": ("_error", "_sensitivity", "_std", "_min"),
    "scene": ("advice", "effects", "dropped", "_input", "_kinetic", "_stored", "_damping", "_hysteresis", "_links"),
    "records": ("digest",),
}
"""Endings of the columns left out of the printed table unless --wide is given, by table."""


@click.command("show", short_help="Print a table of a results file.")
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.h5")
@click.argument("table", type=click.Choice(TABLES), required=False, metavar="[TABLE]")
@click.option(
    "--format",
    "form",
    type=click.Choice(("table", "csv", "json")),
    default="table",
    show_default=True,
    help="table: aligned columns in the units of the study; csv, json: all digits in SI.",
)
@click.option("--wide", is_flag=True, help="Every column, including those that summary, scene and records leave out.")
@click.option("--case", multiple=True, help="Only this case; may be given more than once.")
@click.option("--analysis", multiple=True, help="Only this analysis.")
@click.option("--record", multiple=True, help="Only this record.")
@click.option("--building", multiple=True, help="Only this building.")
@click.option("--storey", multiple=True, type=int, help="Only this storey, from 1 at the ground.")
@click.option("--floor", multiple=True, type=int, help="Only this floor, from 1 at the ground.")
@click.option("--link", multiple=True, help="Only this link, as the table link names it.")
@at_option
def command(
    file: Path,
    table: str | None,
    form: str,
    wide: bool,
    case: tuple[str, ...],
    analysis: tuple[str, ...],
    record: tuple[str, ...],
    building: tuple[str, ...],
    storey: tuple[int, ...],
    floor: tuple[int, ...],
    link: tuple[str, ...],
    at: tuple[str, ...],
) -> None:
    """Print TABLE of a results file: storey, floor, link, struck, scene, flagged, accuracy, summary, records or
    buildings, or the answer of the command that wrote the file, which is the default.

    summary has means over the records, struck the columns that slabs strike, accuracy the error and the cost of every
    scene. docs/results.md describes all columns.

    \b
    Example:
      pound show results/fig6.h5
      pound show results/fig6.h5 storey --format csv --case touching --building stiff
      pound show results/fig6.h5 accuracy --record elcentro
      pound show results/sweep.h5 storey --storey 3 --at "cases.gap.gap=5 cm"
    """
    from pounding_cli.store import open_results

    results = open_results(file)
    table = table or (results.answers[0] if results.answers else "summary")
    frame = results.table(table)
    named: dict[str, tuple[Any, ...]] = {
        "case": case, "analysis": analysis, "record": record, "building": building,
        "storey": storey, "floor": floor, "link": link,
    }  # fmt: skip
    named |= _points(results, at)
    frame = _filtered(results, frame, {name: values for name, values in named.items() if values}, table)
    if form == "csv":
        click.echo(cells(_one_line(frame)).to_csv(index=False, lineterminator="\n"), nl=False)
    elif form == "json":
        click.echo(_json(frame))
    else:
        endings = _ASIDE.get(table, ())
        if "records_collapsed" in frame and not frame["records_collapsed"].any():
            endings += ("_collapsed",)
        aside = [] if wide else [name for name in frame.columns if str(name).endswith(endings)]
        click.echo(results.title)
        click.echo(_columns(results, table, _one_line(frame.drop(columns=aside))))
        if aside:
            click.echo(f"{counted(len(aside), 'more column')} with --wide: {', '.join(map(str, aside))}", err=True)


def _points(results: Results, texts: tuple[str, ...]) -> dict[str, tuple[Any, ...]]:
    """Values asked for by swept key; several of one key are alternatives."""
    found: dict[str, tuple[Any, ...]] = {}
    for text in texts:
        for key, value in points_at(results, [text]).items():
            found[key] = (*found.get(key, ()), value)
    return found


def _filtered(results: Results, frame: pd.DataFrame, wanted: dict[str, tuple[Any, ...]], table: str) -> pd.DataFrame:
    """The rows asked for; a name that is not there is refused with those that are."""
    from pounding_cli.errors import InputError, Problem

    problems = []
    rows = frame
    for name, values in wanted.items():
        if name not in frame.columns:
            message = f"--{name}: the table {table} has no column {name}"
            if name in results.axes:
                message = f"--at {name}: it changes nothing in the table {table}"
            problems.append(Problem(message, "leave the option out, or choose another table"))
            continue
        there = list(dict.fromkeys(frame[name]))
        listed = ", ".join(map(str, sorted(there) if name in ("storey", "floor") else there))
        for value in values:
            if value in there or name in results.axes:
                continue
            if name == "case" and value in set(results.scene()["case"]):
                hint = f"cases with rows there: {listed}" if there else "choose another table"
                problems.append(Problem(f"--case: {value} has {_NOTHING.get(table, 'no rows')}", hint))
                continue
            hint = f"write one of: {listed}" if there else f"the table {table} is empty"
            problems.append(Problem(f"--{name}: there is no {name} {value!r}", hint))
        rows = rows[rows[name].isin(values)]
    if problems:
        raise InputError(problems)
    return rows


def _one_line(frame: pd.DataFrame) -> pd.DataFrame:
    """Cells of several sentences on one line each, so that one row is one line."""
    changed = {name: frame[name].str.replace("\n", "; ") for name in (*_SENTENCES, "advice") if name in frame.columns}
    return frame.assign(**changed)


def _json(frame: pd.DataFrame) -> str:
    """Rows as JSON objects with all digits; null where there is no number, lists of sentences."""
    rows = frame.astype(object).where(frame.notna(), None).to_dict("records")
    for row in rows:
        row.update({name: row[name].splitlines() for name in _SENTENCES if name in row})
    return json.dumps(rows, indent=1, default=float)


def _columns(results: Results, table: str, frame: pd.DataFrame) -> str:
    """Columns under their names with units, swept keys in those of the study, numbers to four digits."""
    import pandas as pd

    if frame.empty:
        return "no rows"
    shown = results.units | (results.answer(table).units if table in results.answers else {})
    for key, unit in shown.items():
        if key in frame.columns and pd.api.types.is_numeric_dtype(frame[key]):
            frame = frame.assign(**{key: [unit.number(value) for value in frame[key]]})
    units = {str(name): results.meaning(table, str(name))[0] for name in frame}
    units |= {key: unit.name for key, unit in shown.items()}
    headings = {name: f"{name} [{unit}]" for name, unit in units.items() if unit not in ("", "1")}
    return frame.rename(columns=headings).to_string(index=False, float_format=lambda value: f"{value:.4g}", na_rep="-")

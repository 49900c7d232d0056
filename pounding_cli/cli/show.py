"""`pound show`: print a table of a results file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from pounding_cli.cli.places import key_and_value, meant
from pounding_cli.numbers import counted, listed
from pounding_cli.results.tables import ANSWERS
from pounding_cli.texts import cells

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.results.results import Results

TABLES = (
    *("storey", "floor", "link", "struck", "base", "scene", "flagged", "accuracy", "summary", "records", "buildings"),
    *(table for tables in ANSWERS.values() for table in tables),
)
_NOTHING = {
    "link": "no links",
    "struck": "no columns that a slab strikes",
    "base": "no base that moves",
    "flagged": "no flags",
}
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
@click.option(
    "--where",
    multiple=True,
    metavar="KEY=VALUE",
    help="Only rows with this value in a column or of a swept key; several of one key are alternatives.",
)
def command(
    file: Path,
    table: str | None,
    form: str,
    wide: bool,
    case: tuple[str, ...],
    analysis: tuple[str, ...],
    record: tuple[str, ...],
    building: tuple[str, ...],
    where: tuple[str, ...],
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
      pound show results/sweep.h5 storey --where storey=3 --where "cases.gap.gap=5 cm"
    """
    from pounding_cli.api.studies import open_results

    results = open_results(file)
    table = table or (results.answers[0] if results.answers else "summary")
    frame = results.table(table)
    short = {"case": case, "analysis": analysis, "record": record, "building": building}
    wanted = [Where(f"--{key} {value}", key, value) for key, values in short.items() for value in values]
    wanted += [Where(f"--where {text}", *key_and_value(text, "--where")) for text in where]
    frame = _filtered(results, frame, wanted, table)
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


class Where(NamedTuple):
    """A value that rows must have.

    said : the option as it was given
    key, value : its two sides
    """

    said: str
    key: str
    value: str


def _filtered(results: Results, frame: pd.DataFrame, wanted: list[Where], table: str) -> pd.DataFrame:
    """The rows asked for; a key or value that is not there is refused with those that are."""
    from pounding_cli.errors import InputError, Problem

    problems = []
    chosen: dict[str, list[Any]] = {}
    for each in wanted:
        key = _column(results, frame, each.key)
        if key not in frame.columns:
            message = f"{each.said}: the table {table} has no column {each.key}"
            if key in results.axes:
                message = f"{each.said}: it changes nothing in the table {table}"
            hint = f"leave the option out, or write one of: {listed(map(str, frame.columns))}"
            problems.append(Problem(message, hint))
            continue
        unit = results.column(table, key).unit
        there = list(dict.fromkeys(frame[key]))
        values = meant(results.axes.get(key, there), each.value, unit)
        chosen.setdefault(key, []).extend(values)
        if values:
            continue
        shown = listed(unit.text(value) for value in results.axes.get(key, there))
        message = f"{each.said}: there is no {key} {each.value!r}"
        hint = f"write one of: {shown}" if there else f"the table {table} is empty"
        if key == "case" and each.value in set(results.scene()["case"]):
            message = f"{each.said}: {each.value} has {_NOTHING.get(table, 'no rows')}"
            hint = f"cases with rows there: {shown}" if there else "choose another table"
        problems.append(Problem(message, hint))
    if problems:
        raise InputError(problems)
    for key, values in chosen.items():
        frame = frame[frame[key].isin(values)]
    return frame


def _column(results: Results, frame: pd.DataFrame, given: str) -> str:
    """The column meant: by its name, or where a swept key ends in what is given, that key."""
    swept = [key for key in results.axes if key.endswith(f".{given}")]
    return given if given in frame.columns or len(swept) != 1 else swept[0]


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
    units = {name: results.column(table, name).unit for name in map(str, frame)}
    for name, unit in units.items():
        if unit.factor != 1 and pd.api.types.is_numeric_dtype(frame[name]):
            frame = frame.assign(**{name: [unit.number(value) for value in frame[name]]})
    headings = {name: unit.label(name) for name, unit in units.items()}
    return frame.rename(columns=headings).to_string(index=False, float_format=lambda value: f"{value:.4g}", na_rep="-")

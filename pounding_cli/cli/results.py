"""The commands that read results files: `pound show`, `report`, `export`, `compare`."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Sequence
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit, counted, listed
from pounding_cli.results.tables import ANSWERS

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.results.compare import Comparison
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
_FEW = 12
"""Lines of one kind that `pound compare` shows unless all are asked for."""

FILE = click.Path(path_type=Path)


def rows_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Which rows are meant: one argument a key, and `where`, each a tuple of texts."""
    text = "Only rows with this value in a column or of a swept key; several of one key are alternatives."
    command = click.option("--where", multiple=True, metavar="KEY=VALUE", help=text)(command)
    for name in ("building", "record", "analysis", "case"):
        more = "; may be given more than once" if name == "case" else ""
        command = click.option(f"--{name}", multiple=True, help=f"Only this {name}{more}.")(command)
    return command


def _wanted(case: Any, analysis: Any, record: Any, building: Any, where: Any) -> list[tuple[str, str, str]]:
    """The option as it was given, key and value of every condition.  Raises `InputError` for one without value."""
    short = {"case": case, "analysis": analysis, "record": record, "building": building}
    wanted = [(f"--{key} {value}", key, value) for key, values in short.items() for value in values]
    for text in where:
        key, _, value = (part.strip() for part in text.partition("="))
        if not (key and value):
            raise InputError(Problem(f"--where {text}: no value", "write e.g. --where 'cases.gap.gap=5 cm'"))
        wanted.append((f"--where {text}", key, value))
    return wanted


def _meant(values: Iterable[Any], text: str, unit: Unit) -> list[Any]:
    """Those of the values that a text means; a number may be with its unit, in SI or in the unit of the study."""
    from pydantic_core import PydanticCustomError

    from pounding_cli.study.quantity import Quantity

    numbers: list[float] = []
    with suppress(PydanticCustomError, ValueError):
        numbers.append(float(Quantity("value", unit.si, "").read(text)))
        numbers.append(float(text) * unit.factor)

    def is_meant(value: Any) -> bool:
        if str(value) == text:
            return True
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return is_number and any(math.isclose(value, each, rel_tol=1e-6, abs_tol=1e-12) for each in numbers)

    return [value for value in values if is_meant(value)]


def _swept(results: Results, given: str) -> list[str]:
    """The swept keys that a key may mean: of that name, or those that end in it."""
    return [given] if given in results.axes else [key for key in results.axes if key.endswith(f".{given}")]


# show


@click.command()
@click.argument("file", type=FILE, metavar="FILE.h5")
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
@rows_options
def show(file: Path, table: str | None, form: str, wide: bool, **rows: Any) -> None:
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
    from pounding_cli.texts import cells

    results = open_results(file)
    table = table or (results.answers[0] if results.answers else "summary")
    frame = _filtered(results, results.table(table), _wanted(**rows), table)
    sentences = [name for name in (*_SENTENCES, "advice") if name in frame.columns]
    one_line = frame.assign(**{name: frame[name].str.replace("\n", "; ") for name in sentences})
    if form == "csv":
        click.echo(cells(one_line).to_csv(index=False, lineterminator="\n"), nl=False)
    elif form == "json":
        click.echo(_json(frame))
    else:
        endings = _ASIDE.get(table, ())
        if "records_collapsed" in frame and not frame["records_collapsed"].any():
            endings += ("_collapsed",)
        aside = [] if wide else [name for name in frame.columns if str(name).endswith(endings)]
        click.echo(results.title)
        click.echo(_columns(results, table, one_line.drop(columns=aside)))
        if aside:
            click.echo(f"{counted(len(aside), 'more column')} with --wide: {', '.join(map(str, aside))}", err=True)


def _filtered(
    results: Results, frame: pd.DataFrame, wanted: Sequence[tuple[str, str, str]], table: str
) -> pd.DataFrame:
    """The rows asked for; a key or value that is not there is refused with those that are."""
    problems, chosen = [], dict[str, list[Any]]()
    for said, given, value in wanted:
        swept = _swept(results, given)
        key = given if given in frame.columns or len(swept) != 1 else swept[0]
        if key not in frame.columns:
            message = f"{said}: the table {table} has no column {given}"
            if key in results.axes:
                message = f"{said}: it changes nothing in the table {table}"
            hint = f"leave the option out, or write one of: {listed(map(str, frame.columns))}"
            problems.append(Problem(message, hint))
            continue
        unit = results.column(table, key).unit
        there = results.axes.get(key, list(dict.fromkeys(frame[key])))
        values = _meant(there, value, unit)
        chosen.setdefault(key, []).extend(values)
        if values:
            continue
        shown = listed(unit.text(value) for value in there)
        message, hint = f"{said}: there is no {key} {value!r}", f"write one of: {shown}"
        if not len(there):
            hint = f"the table {table} is empty"
        if key == "case" and value in set(results.scene()["case"]):
            message = f"{said}: {value} has {_NOTHING.get(table, 'no rows')}"
            hint = f"cases with rows there: {shown}" if len(there) else "choose another table"
        problems.append(Problem(message, hint))
    if problems:
        raise InputError(problems)
    for key, values in chosen.items():
        frame = frame[frame[key].isin(values)]
    return frame


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


# report


@click.command()
@click.argument("files", nargs=-1, required=True, type=FILE, metavar="FILE.h5...")
@click.option("-o", "--output", type=FILE, metavar="DIR", help="Folder. Default: the name of the results file.")
@click.option(
    "--format",
    "formats",
    multiple=True,
    type=click.Choice(("png", "svg", "pdf")),
    help="Format of the figures; may be given more than once. Default: all three.",
)
@click.option(
    "--figures-for-paper",
    is_flag=True,
    help="Draw figures without titles and captions, as SVG and PDF; captions.md has the captions. No page.",
)
@click.option("--no-figures", is_flag=True, help="Write tables and claims only (much faster).")
@click.option("--no-page", is_flag=True, help="Do not write report.html.")
@click.option("--quantity", "quantities", multiple=True, metavar="NAME", help="Quantity to draw over the sweep: drift.")
@rows_options
@click.option("-q", "--quiet", is_flag=True, help="Print nothing.")
def report(
    files: tuple[Path, ...],
    output: Path | None,
    formats: tuple[str, ...],
    figures_for_paper: bool,
    no_figures: bool,
    no_page: bool,
    quantities: tuple[str, ...],
    quiet: bool,
    **rows: Any,
) -> None:
    """Draw the figures of results files, write their tables as CSV, and evaluate the paper's claims.

    The command accepts files of all commands that write results.

    The report is written to DIR, by default a folder next to the results file with its name: report.html (everything
    in one page, to open in a browser or to send), the figures, tables/. With several files, each has its own folder in
    DIR, and comparison.md compares their claims.

    A sweep is drawn as curves (one swept key) or maps (two swept keys). With more keys, the two with most values are
    drawn; --where fixes a key. By default the figures show the largest V/V0 (elastic) and mu/mu0 (inelastic) of every
    building, at the worst storey or link, as a mean over the motions; --quantity accepts any column of the tables
    storey, floor, link and scene, --where also storey, floor or link, --case and --building also `worst`.

    \b
    Example:
      pound report results/fig6.h5 -o report
      pound report results/fig6.h5 results/fig7.h5 --no-figures
      pound report results/fig6.h5 -o paper --figures-for-paper
      pound report results/sweep.h5 --quantity mu_ratio --case touching --building soft --where storey=3
    """
    from pounding_cli.api.studies import open_results
    from pounding_cli.report import report as of
    from pounding_cli.report.claims import compare_claims, verdicts
    from pounding_cli.report.style import FORMATS, for_paper
    from pounding_cli.report.sweep import Asked

    if figures_for_paper and no_figures:
        hint = "leave one of them out"
        raise InputError(Problem("--figures-for-paper and --no-figures contradict each other", hint))
    usual = tuple(name for name in FORMATS if name != "png") if figures_for_paper else FORMATS
    chosen = () if no_figures else formats or usual
    opened, asked, wanted = {path: open_results(path) for path in files}, {}, _wanted(**rows)
    for path, results in opened.items():
        fixed, at = _fixed(results, wanted)
        asked[path] = Asked(quantities, fixed, at)
    folders = _folders(files, output)
    for path, results in opened.items():
        with for_paper() if figures_for_paper else nullcontext():
            written = of(results, asked=asked[path]).save(folders[path], chosen, not (no_page or figures_for_paper))
        if not quiet:
            click.echo(f"{written[-1]}: {counted(len(written), 'file')}")
            for key, verdict in verdicts(results).items():
                click.echo(f"  {key:22} {verdict}")
    if len(opened) > 1:
        folder = output or Path("comparison")
        page, _ = compare_claims({folders[path].name: results for path, results in opened.items()}, folder)
        if not quiet:
            click.echo(str(page))


def _fixed(results: Results, wanted: Sequence[tuple[str, str, str]]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The places that are fixed in figures over the sweep, and the swept keys that are, as in the tables.

    Raises `InputError` for a key that is neither, one that is fixed twice, and a value that it does not take.
    """
    places, at, problems = dict[str, Any](), dict[str, Any](), list[Problem]()
    for said, given, value in wanted:
        keys = _swept(results, given)
        if given in ("case", "analysis", "record", "building", "storey", "floor", "link"):
            fixed, key = places, given
            values: list[Any] = [value]
            if given in ("storey", "floor"):
                values = [int(value)] if value.isdecimal() else []
            hint = f"write --where {given}=1"
        elif len(keys) == 1:
            fixed, key = at, keys[0]
            values = _meant(results.axes[key], value, results.units[key])
            hint = f"write one of: {', '.join(results.units[key].text(each) for each in results.axes[key])}"
        else:
            swept = ", ".join(keys or results.axes) or "nothing is swept in this file; leave it out"
            what = f"{given} is {'more than one' if keys else 'no'} swept key"
            problems.append(Problem(f"{said}: {what}", f"write one of: {swept}, storey, floor, link"))
            continue
        if key in fixed:
            problems.append(Problem(f"{said}: {key} is given twice", "give one value"))
        elif not values:
            problems.append(Problem(f"{said}: {key} does not take this value", hint))
        else:
            fixed[key] = values[0]
    if problems:
        raise InputError(problems)
    return places, at


def _folders(files: tuple[Path, ...], output: Path | None) -> dict[Path, Path]:
    """Where each report goes; files of one name are told apart by a number."""
    if output is not None and len(files) == 1:
        return {files[0]: output}
    folders: dict[Path, Path] = {}
    for path in files:
        base = output / path.stem if output is not None else path.with_suffix("")
        folder, number = base, 2
        while folder in folders.values():
            folder, number = base.with_name(f"{base.name}-{number}"), number + 1
        folders[path] = folder
    return folders


# export, compare


@click.command()
@click.argument("file", type=FILE, metavar="FILE.h5")
@click.argument("tables", nargs=-1, type=click.Choice(TABLES), metavar="[TABLE]...")
@click.option("-o", "--output", type=FILE, metavar="PATH", help="A folder, or a file whose extension gives the format.")
@click.option(
    "--format",
    "form",
    type=click.Choice(("csv", "parquet", "excel", "netcdf")),
    help="Format, if PATH does not give it. Default: csv.",
)
def export(file: Path, tables: tuple[str, ...], output: Path | None, form: str | None) -> None:
    """Write tables of a results file for other programs, in SI with all digits: all tables, or those named.

    CSV and Parquet have one file per table in a folder, with columns.csv, which describes every column, or a single
    file for one table. Excel has one sheet per table. netCDF has the whole file, for programs such as xarray and
    ncview. Tables: storey, floor, link, scene, flagged, accuracy, summary, records, buildings.

    \b
    Example:
      pound export results/fig6.h5
      pound export results/fig6.h5 -o fig6.xlsx
      pound export results/fig6.h5 storey -o storey.parquet
      pound export results/fig6.h5 --format netcdf
    """
    from pounding_cli.api.studies import open_results
    from pounding_cli.results.export import export as written

    for path in written(open_results(file), output, form, tables):
        click.echo(f"wrote {path}")


@click.command()
@click.argument("first", type=FILE, metavar="A.h5")
@click.argument("second", type=FILE, metavar="B.h5")
@click.option("--numbers", is_flag=True, help="Compare only scenes and their numbers for the exit code, not the study.")
@click.option("--all", "everything", is_flag=True, help="List every changed number and scene.")
@click.pass_context
def compare(ctx: click.Context, first: Path, second: Path, numbers: bool, everything: bool) -> None:
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
    from pounding_cli.results.compare import compare as compared

    found = compared(open_results(first), open_results(second))
    for line in _told(found, everything):
        click.echo(line)
    if not (found.same_numbers if numbers else found.same):
        ctx.exit(1)


def _told(found: Comparison, everything: bool) -> list[str]:
    """What changed, line by line."""
    from pounding_cli.results.tables import column_of

    def some(lines: Sequence[str]) -> list[str]:
        if everything or len(lines) <= _FEW:
            return list(lines)
        return [*lines[:_FEW], f"  ... {len(lines) - _FEW} more: --all lists them"]

    said = ["Study: the same, with different wording." if found.lines else "Study: the same."]
    if found.keys:
        said = [f"Study: differs in {counted(len(found.keys), 'key')}."]
    said += some([f"  {line}" for line in found.lines])
    shown = [(key, *("nothing" if each is None else str(each) for each in values)) for key, *values in found.keys]
    said += some([f"  {key}: {one} -> {other}" for key, one, other in shown])
    said.append(f"Versions: {'differ' if found.software else 'the same'}.")
    said += [f"  {name}: {one} -> {other}" for name, one, other in found.software]
    said.append(
        f"Scenes: {len(found.removed)} removed, {len(found.added)} added, {len(found.outcomes)} with another outcome."
    )
    said += some([f"  - {place}" for place in found.removed])
    said += some([f"  + {place}" for place in found.added])
    said += some([f"  {place}: {one} -> {other}" for place, one, other in found.outcomes])
    differ = "differs" if len(found.changes) == 1 else "differ"
    said.append(f"Numbers: {len(found.changes)} of {found.compared} {differ} beyond the errors of both files.")
    if found.unestimated:
        what = counted(found.unestimated, "scene carries", "scenes carry")
        said.append(f"  {what} no error estimate: the accuracy asked or rounding is used instead.")
    for (table, column), rows in found.changes.groupby(["table", "column"], sort=False):
        unit = column_of(str(column), str(table)).unit.name
        said.append(f"  {table} {column}:" if everything else f"  {table} {column}: {len(rows)} differ, most:")
        for row in rows.itertuples() if everything else rows.head(1).itertuples():
            change = f"{row.before:.6g} -> {row.after:.6g} {unit}".rstrip()
            said.append(f"    {row.place}: {change}, by {row.difference:.1e}; carried {row.carried:.1e}")
    return said

"""The commands that read results files: `pound show`, `report`, `export`, `compare`."""

from __future__ import annotations

import difflib
import math
import shutil
import sys
import textwrap
from collections.abc import Collection, Iterator, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli.options import FILE, open_file, quiet_option, together
from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import Unit, join_limited, pluralize
from pounding_cli.report.summary import PARAGRAPH_WIDTH
from pounding_cli.variables import COORDINATE_VARIABLES

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.report.sweep import SweepChoice
    from pounding_cli.results.compare import Comparison
    from pounding_cli.results.results import ResultTables
    from pounding_cli.tables import Table

_FEW = 12
"""Lines of one kind that `pound compare` shows without --all."""
_PLACES = ("case", "analysis", "record", "building", "storey", "floor", "line", "link")
"""What figures over a sweep may fix besides swept keys."""


def _complete_table(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Return the names of tables that begin with some letters, for a shell."""
    return [name for name in _table_names() if name.startswith(incomplete)]


def _table_names() -> list[str]:
    """Return the names of all tables that results files may have."""
    from pounding_cli.questions import load_questions
    from pounding_cli.results.columns import TABLES

    return [*TABLES, *(table for question in load_questions() for table in question.tables)]


def _check_tables(results: ResultTables, names: Sequence[str]) -> None:
    """Raise `InputError` for a table that a results file does not have, with the command that writes it."""
    from pounding_cli.questions import load_questions

    for name in names:
        if name in results.tables:
            continue
        command = next((question.name for question in load_questions() if name in question.tables), "")
        similar = difflib.get_close_matches(name, results.tables, 1)
        meant = f"did you mean '{similar[0]}'? " if similar else ""
        hint = f"write it with: pound {command} STUDY" if command else f"{meant}it has: {', '.join(results.tables)}"
        raise InputError(Issue((), f"has no table {name}", hint, file=str(results.path)))


rows_options = together(
    click.option("--case", multiple=True, help="Only this case; may be given more than once."),
    click.option("--analysis", multiple=True, help="Only this analysis."),
    click.option("--record", multiple=True, help="Only this record."),
    click.option("--building", multiple=True, help="Only this building."),
    click.option(
        "--where", multiple=True, metavar="KEY=VALUE",
        help="Only rows with this value in a column or of a swept key; several of one key are alternatives.",
    ),
)  # fmt: skip
"""Options that choose rows; arguments of `_parse_conditions`."""


def _parse_conditions(where: Sequence[str], **short: Sequence[str]) -> list[tuple[str, str]]:
    """Return key and value of every condition.  Raises `InputError` for one without value."""
    conditions = [(key, value) for key, values in short.items() for value in values]
    for text in where:
        key, _, value = (part.strip() for part in text.partition("="))
        if not (key and value):
            raise InputError(f"--where {text}: no value", "write e.g. --where 'cases.gap.gap=5 cm'")
        conditions.append((key, value))
    return conditions


def _find_key(given: str, known: Collection[str], place: str) -> str:
    """Return the known key that is given in full or, of a swept key, without its beginning.

    place : name of the table, or of the sweep, in messages

    Raises InputError: there is no such key, or more than one.
    """
    if given in known:
        return given
    ends = [key for key in known if key.endswith(f".{given}")]
    if len(ends) == 1:
        return ends[0]
    hint = f"leave the option out, or write one of: {join_limited(ends or known)}"
    raise InputError(f"{place} has {'several columns' if ends else 'no column'} {given}", hint)


def _find_values(values: Sequence[Any], text: str, unit: Unit, key: str) -> list[Any]:
    """Return those of some values that a text stands for; a number may have a unit, or be in SI or the study's unit.

    key : of the values, in messages

    Raises InputError: none of the values is equal to it.
    """
    from pydantic_core import PydanticCustomError

    from pounding_cli.study.schema.quantity import Quantity

    numbers: list[float] = []
    with suppress(PydanticCustomError, ValueError):
        numbers.append(float(Quantity("value", unit.si, "").read(text)))
        numbers.append(float(text) * unit.factor)

    def is_equal(value: Any) -> bool:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        close = is_number and any(math.isclose(value, each, rel_tol=1e-6, abs_tol=1e-12) for each in numbers)
        return close or str(value) == text

    equal = [value for value in values if is_equal(value)]
    if not equal:
        hint = f"write one of: {join_limited(map(unit.text, values))}"
        raise InputError(f"{key} does not take the value {text!r}", hint)
    return equal


@click.command()
@click.argument("file", type=FILE, metavar="FILE.h5")
@click.argument("table", required=False, metavar="[TABLE]", shell_complete=_complete_table)
@click.option(
    "--format", "form", type=click.Choice(("table", "csv")), default="table", show_default=True,
    help="table: aligned columns in the units of the study, or kN and mm; csv: every column, all digits in SI.",
)  # fmt: skip
@click.option("--study", "wants_study", is_flag=True, help="Print the study as it was run, as a file that runs again.")
@rows_options
def show(file: Path, table: str | None, form: str, wants_study: bool, **rows: Any) -> None:  # fmt: skip
    """Print TABLE of a results file: storey, floor, line, link, struck, base, scene, flagged, accuracy, summary,
    records or buildings, or the answer of the command that wrote the file, which is the default (docs/results.md).

    \b
    Example:
      pound show results/fig6.h5 storey --format csv --case touching --building stiff
      pound show results/sweep.h5 storey --where storey=3 --where "cases.gap.gap=5 cm"
      pound show results/sweep.h5 --study > again.yaml
    """
    from pounding_cli.results.responses import TEXTS
    from pounding_cli.texts import escape_formulas

    results = open_file(file)
    if wants_study:
        if table:
            raise InputError(f"{table} and --study contradict each other", "leave one of them out")
        click.echo(results.study_text, nl=False)
        return
    table = table or (results.answers[0] if results.answers else "summary")
    _check_tables(results, [table])
    frame = _select_rows(results, results.table(table), _parse_conditions(**rows), table)
    lines = [name for name in TEXTS if name in frame.columns]
    frame = frame.assign(**{name: frame[name].str.replace("\n", "; ") for name in lines})
    if form == "csv":
        click.echo(escape_formulas(frame).to_csv(index=False, lineterminator="\n"), nl=False)
        return
    columns = [results.column(table, str(name)) for name in frame.columns]
    csv_alone = [column.name for column in columns if column.optional]
    ends = {end for column in columns for end in (column.low, column.high) if end}  # in the cells of their columns
    shown = _table_to_print(results, table, frame, [*csv_alone, *ends])
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
    click.echo(f"{results.title}\n{shown.to_text(width, max_rows=len(frame)) if len(frame) else 'no rows'}".rstrip())
    if (note := _note_on_contact(results, frame)) and len(frame):
        click.echo("\n".join(textwrap.wrap(note, width or PARAGRAPH_WIDTH)))
    if csv_alone:
        more = pluralize(len(csv_alone), "more column")
        click.echo(f"{more} with --format csv: {', '.join(csv_alone)}", err=True)


def _table_to_print(results: ResultTables, name: str, frame: pd.DataFrame, hidden: Sequence[str] = ()) -> Table:
    """Return rows of a table for a terminal, which leaves out columns at the right where it is too narrow.

    Columns before the first number say where a row stands, and are always printed.

    hidden : columns that are not printed
    """
    from pounding_cli.tables import Table

    names = [str(each) for each in frame.columns if each not in hidden]
    columns = [replace(results.column(name, each), label=each) for each in names]  # the names that --where takes
    places = {*results.axes, *COORDINATE_VARIABLES, "place"}
    first = next((number for number, column in enumerate(columns) if column.name not in places), len(columns))
    kept = columns[: first + 1]
    return Table(name, frame, [*kept, *(replace(column, optional=True) for column in columns[first + 1 :])])


def _note_on_contact(results: ResultTables, frame: pd.DataFrame) -> str:
    """Return a note where a table has accelerations or forces of floors that strike; "" where it has none."""
    from pounding_cli.results.columns import CONTACT_STIFFNESS_UNKNOWN

    names = [str(name) for name in frame.columns]
    has_numbers = any(name.startswith(("acceleration", "peak_force")) for name in names)
    return CONTACT_STIFFNESS_UNKNOWN if has_numbers and len(results.struck_links()) else ""


def _select_rows(
    results: ResultTables, frame: pd.DataFrame, wanted: Sequence[tuple[str, str]], table: str
) -> pd.DataFrame:
    """Return the rows that meet all conditions.

    Raises InputError: a key or value that is not there, with those that are.
    """
    chosen = dict[str, list[Any]]()
    for given, text in wanted:
        key = _find_key(given, list(map(str, frame.columns)), f"the table {table}")
        there = results.axes.get(key, list(dict.fromkeys(frame[key])))
        chosen.setdefault(key, []).extend(_find_values(there, text, results.column(table, key).unit, key))
    for key, values in chosen.items():
        frame = frame[frame[key].isin(values)]
    return frame


@click.command()
@click.argument("files", nargs=-1, required=True, type=FILE, metavar="FILE.h5...")
@click.option("-o", "--output", type=FILE, metavar="DIR", help="Folder. Default: the name of the results file.")
@click.option(
    "--format", "formats", multiple=True, type=click.Choice(("png", "svg", "pdf")),
    help="Format of the figures; may be given more than once. Default: png and svg.",
)  # fmt: skip
@click.option(
    "--figures-for-paper", "paper", is_flag=True,
    help="Draw figures without titles and captions, as SVG and PDF; captions.md has the captions. No page.",
)  # fmt: skip
@click.option("--no-figures", is_flag=True, help="Write tables and the page without figures (much faster).")
@click.option("--quantity", "quantities", multiple=True, metavar="NAME", help="Quantity to draw over the sweep: drift.")
@rows_options
@quiet_option
def report(
    files: tuple[Path, ...], output: Path | None, formats: tuple[str, ...], paper: bool, no_figures: bool,
    quantities: tuple[str, ...], quiet: bool, **rows: Any,
) -> None:  # fmt: skip
    """Write the page of results files (report.html), their figures and tables, and tell which statements hold.

    Several files have a folder each, and comparison.md compares their answers (docs/page.md, docs/how-to/sweep.md).

    \b
    Example:
      pound report results/fig6.h5 results/fig7.h5 --no-figures
      pound report results/sweep.h5 --quantity mu_ratio --case touching --building soft --where storey=3
    """
    from pounding_cli.questions.reports import build_report, find_no_sweep
    from pounding_cli.questions.statements import STATEMENTS, list_verdicts
    from pounding_cli.report.style import OF_PAPERS, PAPER, drawing_for

    choices = _list_choices(quantities, rows)
    _refuse_contradictions(paper, no_figures, formats, choices)
    saved_formats = () if no_figures else formats or (OF_PAPERS if paper else None)
    opened = [(folder, open_file(path)) for folder, path in zip(_list_folders(files, output), files, strict=True)]
    reasons = {path: find_no_sweep(results) for path, (_, results) in zip(files, opened, strict=True)}
    without_sweep = {path: reason for path, reason in reasons.items() if reason}
    if choices and len(without_sweep) == len(files):
        message = f"{choices[0]} chooses what figures over a sweep show, and {next(iter(without_sweep.values()))}"
        hint = "leave it out; -o, --format, --figures-for-paper, --no-figures and --quiet apply to every file"
        raise InputError(Issue((), message, hint, file=str(files[0])))
    reports = []
    for path, (_, results) in zip(files, opened, strict=True):
        choice = None
        if choices and path not in without_sweep:
            choice = _build_choice(results, quantities, _parse_conditions(**rows))
        reports.append(build_report(results, choice))
    for each in reports:
        each.sections  # noqa: B018  # a bad choice is refused before anything is written
    for (folder, results), each in zip(opened, reports, strict=True):
        with drawing_for(PAPER) if paper else nullcontext():
            saved = each.save(folder, saved_formats, not paper)
        if not quiet:
            click.echo(f"{saved[-1]}: {pluralize(len(saved), 'file')}")
            verdicts = list_verdicts(results.answer(STATEMENTS).frame) if STATEMENTS in results.answers else []
            width = max((len(verdict.label) for verdict in verdicts), default=0)
            for verdict in verdicts:
                click.echo(f"  {verdict.label:{width}}  {verdict}")
    if choices:
        for path, reason in without_sweep.items():
            click.echo(f"{path}: {reason}, so {choices[0]} does not apply to it", err=True)
    if len(opened) > 1:
        from pounding_cli.questions.side_by_side import write_comparison

        named = {folder.name: results for folder, results in opened}
        page, *_ = write_comparison(named, reports, output or Path("comparison"))
        if not quiet:
            click.echo(str(page))


def _list_choices(quantities: tuple[str, ...], rows: dict[str, Sequence[str]]) -> list[str]:
    """List the options, as they were given, that choose what figures over a sweep show."""
    choices = [f"--quantity {name}" for name in quantities]
    return choices + [f"--{name} {value}" for name, values in rows.items() for value in values]


def _refuse_contradictions(paper: bool, no_figures: bool, formats: Sequence[str], choices: Sequence[str]) -> None:
    """Raise `InputError` where an option says how figures look and another leaves them out."""
    of_figures = ["--figures-for-paper"] * paper + [f"--format {name}" for name in formats] + list(choices)
    if no_figures and of_figures:
        message = f"{of_figures[0]} and --no-figures contradict each other"
        raise InputError(message, "leave one of them out")


def _build_choice(
    results: ResultTables, quantities: tuple[str, ...], conditions: Sequence[tuple[str, str]]
) -> SweepChoice:
    """Return the figures over the sweep that are drawn.  Raises `InputError` for a key or a value that is not there."""
    from pounding_cli.report.sweep import SweepChoice

    places = dict[str, Any]()
    at = dict[str, Any]()
    for given, text in conditions:
        key = _find_key(given, [*_PLACES, *results.axes], "the sweep")
        if key in places or key in at:
            raise InputError(f"{key} is given twice", "write one value: a figure has one")
        if key in results.axes:
            at[key] = _find_values(results.axes[key], text, results.units[key], key)[0]
        else:
            places[key] = text
    return SweepChoice(quantities, places, at)


def _list_folders(files: Sequence[Path], output: Path | None) -> list[Path]:
    """Return the folder of each report; those of files of one name differ by a number."""
    if output is not None and len(files) == 1:
        return [output]
    bases = [output / path.stem if output is not None else path.with_suffix("") for path in files]
    counts = [bases[:place].count(base) + 1 for place, base in enumerate(bases)]
    return [base if n == 1 else base.with_name(f"{base.name}-{n}") for base, n in zip(bases, counts, strict=True)]


@click.command()
@click.argument("file", type=FILE, metavar="FILE.h5")
@click.argument("tables", nargs=-1, metavar="[TABLE]...", shell_complete=_complete_table)
@click.option("-o", "--output", type=FILE, metavar="PATH", help="A folder, or a file whose extension gives the format.")
@click.option(
    "--format", "form", type=click.Choice(("csv", "parquet", "excel", "netcdf")),
    help="Format, if PATH does not give it. Default: csv.",
)  # fmt: skip
@click.option("--pelicun", is_flag=True, help="Write the demands of one building for Pelicun, as CSV.")
@rows_options
def export(
    file: Path, tables: tuple[str, ...], output: Path | None, form: str | None, pelicun: bool, **rows: Any
) -> None:  # fmt: skip
    """Write tables of a results file for other programs, in SI with all digits: all tables, or those named
    (docs/how-to/other-programs.md; docs/how-to/rate.md for --pelicun, which takes --where and the like).

    \b
    Example:
      pound export results/fig6.h5 -o fig6.xlsx
      pound export results/fig6.h5 storey -o storey.parquet
      pound export results/fig6.h5 --pelicun --case gap --building soft --analysis inelastic
    """
    from pounding_cli.results.export import export as written

    wanted = _parse_conditions(**rows)
    if pelicun:
        _export_demands(open_file(file), output, wanted)
        return
    if wanted:
        raise InputError(f"{'='.join(wanted[0])}: tables are exported whole", "leave it out, or --pelicun")
    results = open_file(file)
    _check_tables(results, tables)
    for path in written(results, output, form, tables):
        click.echo(f"wrote {path}")


def _export_demands(results: ResultTables, output: Path | None, wanted: Sequence[tuple[str, str]]) -> None:
    """Write the demands of the chosen rows, and say what is left out."""
    from pounding_cli.outputs import check_output
    from pounding_cli.results.pelicun import demands, describe_left_out

    table, left_out = demands(results, _select_rows(results, results.storey(), wanted, "storey"))
    path = output or results.path.with_name(f"{results.path.stem}-demands.csv")
    check_output(path, [results.path], lambda _, head: b"PID-" in head)
    table.to_csv(path)
    click.echo(f"wrote {path}")
    if left_out:
        click.echo(describe_left_out(left_out, left_out + len(table) - 1), err=True)


@click.command()
@click.argument("first", type=FILE, metavar="A.h5")
@click.argument("second", type=FILE, metavar="B.h5")
@click.option(
    "--numbers", is_flag=True, help="Compare only time histories and their numbers for the exit code, not the study."
)
@click.option("--all", "everything", is_flag=True, help="List every changed number and row.")
@click.pass_context
def compare(ctx: click.Context, first: Path, second: Path, numbers: bool, everything: bool) -> None:
    """Show what changed from A.h5 to B.h5: study, versions, rows, and numbers beyond the errors of both files
    (docs/how-to/compare.md). Exit code 0: the files agree; 1: they differ; 2: a file was refused.

    \b
    Example:
      pound compare before.h5 after.h5 --numbers && echo "no number moved"
    """
    from pounding_cli.results.compare import compare as compare_results

    comparison = compare_results(open_file(first), open_file(second))
    click.echo("\n".join(_iter_changes(comparison, everything)))
    if not (comparison.has_same_numbers if numbers else comparison.is_same):
        ctx.exit(1)


def _iter_changes(comparison: Comparison, everything: bool) -> Iterator[str]:
    """Yield the differences of two files, line by line.

    everything : True lists all of them
    """
    yield from _iter_study_changes(comparison, everything)
    changes = comparison.changes
    differ = "differs" if len(changes) == 1 else "differ"
    yield f"Numbers: {len(changes)} of {comparison.compared} {differ} beyond the errors of both files."
    if comparison.unestimated:
        rows = pluralize(comparison.unestimated, "row carries", "rows carry")
        yield f"  {rows} no error estimate: the accuracy asked or rounding is used instead."
    if comparison.other_lines:
        names = join_limited(comparison.other_lines)
        yield f"  Frame lines of {names} are compared by number, but stand at other places of the plan."
    yield from _iter_number_changes(changes, everything)


def _iter_study_changes(comparison: Comparison, everything: bool) -> Iterator[str]:
    """Yield the differences of study, versions and rows, line by line."""
    keys = []
    for key, old, new in comparison.keys:
        values = ["nothing" if value is None else str(value) for value in (old, new)]
        keys.append(f"{key}: {' -> '.join(values)}")
    if keys:
        study = f"differs in {pluralize(len(keys), 'key')}"
    else:
        study = "the same, with different wording" if comparison.lines else "the same"
    versions = [f"{name}: {old} -> {new}" for name, old, new in comparison.software]
    rows = [f"- {place}" for place in comparison.removed]
    rows += [f"+ {place}" for place in comparison.added]
    rows += [f"{place}: {old} -> {new}" for place, old, new in comparison.outcomes]
    counts = (
        f"{len(comparison.removed)} removed, {len(comparison.added)} added, "
        f"{len(comparison.outcomes)} with another outcome"
    )
    for head, lines in (
        (f"Study: {study}.", [*comparison.lines, *keys]),
        (f"Versions: {'differ' if versions else 'the same'}.", versions),
        (f"Rows: {counts}.", rows),
    ):
        few = len(lines) if everything else _FEW
        yield from (head, *(f"  {line}" for line in lines[:few]))
        if len(lines) > few:
            yield f"  ... {len(lines) - few} more: --all lists them"


def _iter_number_changes(changes: pd.DataFrame, everything: bool) -> Iterator[str]:
    """Yield the numbers that changed, column by column; of each the largest change unless all are listed. Behind them
    stand the numbers that only one of the files has."""
    from pounding_cli.results.columns import column_of

    is_in_one = changes["before"].isna() | changes["after"].isna()
    for (table, column), rows in changes[~is_in_one].groupby(["table", "column"], sort=False):
        unit = column_of(str(column), table=str(table)).unit
        name = f"{table} {_name_in_table(str(table), str(column))}"
        count = f"{len(rows)} {'differs' if len(rows) == 1 else 'differ'}, most:"
        yield f"  {name}:" if everything else f"  {name}: {count}"
        for row in (rows if everything else rows.head(1)).itertuples():
            change = f"{unit.text(row.before)} -> {unit.text(row.after)}"
            yield f"    {row.place}: {change}, by {row.difference:.1e}; carried {row.carried:.1e}"
    for side, other in (("first", "after"), ("second", "before")):
        alone = changes[is_in_one & changes[other].isna()]
        for (table, column), rows in alone.groupby(["table", "column"], sort=False):
            name = f"{table} {_name_in_table(str(table), str(column))}"
            places = "".join(f"\n    {place}" for place in rows["place"]) if everything else f" {rows['place'].iloc[0]}"
            such_as = ":" if everything or len(rows) == 1 else ", such as"
            yield f"  {name}: {len(rows)} only in the {side} file{such_as}{places}"


def _name_in_table(table: str, column: str) -> str:
    """Return the name of a variable as a column of its table: `V` of `line_V` in the table of frame lines."""
    return column.removeprefix("line_") if table == "line" else column

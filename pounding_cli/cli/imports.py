"""`pound import`: a building from the tables of a frame program, or from pushover curves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli.options import FILE, cell_options, seconds, together
from pounding_cli.errors import InputError, Issue
from pounding_cli.texts import escape_controls

if TYPE_CHECKING:
    from pounding_cli.imports.building import Choices, ImportedBuilding
    from pounding_cli.imports.declared import TableDeclaration
    from pounding_cli.imports.pushover import Fit
    from pounding_cli.imports.writing import PlanSize


def _parse_length(ctx: click.Context, param: click.Parameter, text: str | None) -> float | None:
    """Return a length as a study writes it [m].  Raises `click.BadParameter`."""
    if text is None:
        return None
    from pydantic_core import PydanticCustomError

    from pounding_cli.study.schema.quantity import LENGTH

    try:
        return float(LENGTH.read(text))
    except PydanticCustomError as refused:
        context = refused.context or {}
        raise click.BadParameter(f"{context.get('message', refused)}; {context.get('hint', '')}") from None


@click.group("import")
def import_() -> None:
    """Write a study from what a frame program holds (docs/how-to/import.md): tables of storeys, or pushover curves.

    Nothing is guessed: the command says which table and column it takes for what, and refuses what is missing.
    """


_naming_options = together(
    click.option("--name", metavar="NAME", help="Name of the building. Default: that of the file."),
    click.option("-o", "--output", type=FILE, metavar="STUDY.yaml", help="The study. Default: NAME.yaml."),
    click.option("--force", is_flag=True, help="Replace a study that was imported before."),
)

_table_options = together(
    click.option("--case", default="", metavar="CASE", help="Load case, if the tables have several."),
    click.option("--step", default="", metavar="STEP", help="Step of the load case, if it has several, e.g. Max."),
    click.option(
        "--direction", type=click.Choice(("X", "Y"), case_sensitive=False), default="X", show_default=True,
        help="Direction of the row in the model.",
    ),
    click.option("--tower", default="", metavar="TOWER", help="Tower, if the model has several."),
    click.option("--units", metavar="UNITS", help="Force and length of the tables, 'kN, m', if they name none."),
    click.option("--order", type=click.Choice(("up", "down")), help="Order of the rows, if the tables do not show it."),
    click.option("--period", type=seconds, metavar="TIME", help="Period of the model, if no table has it."),
    click.option("--mode", type=int, metavar="N", help="Mode whose period counts. Default: the first along the row."),
    click.option("--match-period", is_flag=True, help="Scale the stiffnesses to the period of the model."),
    click.option("--width", callback=_parse_length, metavar="LENGTH", help="Width of the floors across the row."),
    click.option("--depth", callback=_parse_length, metavar="LENGTH", help="Depth of the floors along the row."),
    click.option(
        "--frequency-ratio", type=float, metavar="R",
        help="First frequency of the twist over that along the row; with --width and --depth the floors twist.",
    ),
)  # fmt: skip


_column_options = together(
    click.option(
        "--column", multiple=True, metavar="QUANTITY=COLUMN",
        help="Column of a quantity, by its number or heading: stiffness=4, 'mass=Weight/9.81'.",
    ),
    click.option("--columns", type=FILE, metavar="FILE.yaml", help="The same in a file, `mass: Weight/9.81` a line."),
)  # fmt: skip


def _import_tables(tables: Path, command: str, **options: Any) -> None:
    """Write the study of a building from its tables, and say how its period compares."""
    from pounding_cli.imports.storeys import read_building
    from pounding_cli.imports.tables import read_tables

    declared = _build_declaration(options)
    found = read_tables(tables, declared)
    building = read_building(found, _build_choices(options))
    declared.refuse_unused()
    _finish(building, found.list_digests(), tables, command, options)


@import_.command(short_help="Tables of ETABS, a workbook or CSV files.")
@click.argument("tables", type=FILE)
@_table_options
@cell_options
@_naming_options
def etabs(tables: Path, **options: Any) -> None:
    """Import a building from TABLES of ETABS: an Excel workbook, or a folder of CSV files.

    Needed are Story Definitions (or Story Data), Mass Summary by Story and Story Stiffness of a lateral load case;
    Modal Periods And Frequencies, Modal Participating Mass Ratios and Centers Of Mass And Rigidity are read where they
    are there. Names are compared without blanks and capitals.

    \b
    Example:
      pound import etabs tower.xlsx --case EQX
      pound import etabs tower-tables/ --direction Y --match-period -o tower.yaml
    """
    _import_tables(tables, "pound import etabs", **options)


@import_.command(short_help="One table of storeys, of any program.")
@click.argument("tables", metavar="TABLE", type=FILE)
@_column_options
@_table_options
@cell_options
@_naming_options
def table(tables: Path, **options: Any) -> None:
    """Import a building from a TABLE of its storeys, CSV or Excel: storey, height, mass, stiffness, and yield shear.

    Units stand behind the headings, as in `height [m]`, or in a row below them. A heading that is not the name of what
    its column holds is declared by --column.

    \b
    Example:
      pound import table storeys.csv --period 1.2s
      pound import table export.csv --column 'stiffness=4 [kN/mm]' --column 'mass=Weight/9.81'
    """
    _import_tables(tables, "pound import table", **options)


@import_.command(short_help="Curves of storey shear over drift.")
@click.argument("curves", type=FILE)
@click.option("--storeys", type=FILE, metavar="TABLES", help="Heights and masses, if CURVES does not have them.")
@click.option(
    "--figure", type=FILE, metavar="FILE", help="Picture of the fits, .svg, .png or .pdf. Default: NAME-fits.svg."
)
@_column_options
@_table_options
@cell_options
@_naming_options
def pushover(curves: Path, storeys: Path | None, figure: Path | None, **options: Any) -> None:
    """Import a building from pushover CURVES: the shear of every storey over its drift, a row for each storey and step.

    Stiffness, yield shear and hardening follow from two lines of equal area, which a picture shows for every storey.
    Heights and masses come from --storeys: tables of ETABS, or a table with storey, height and mass.

    \b
    Example:
      pound import pushover curves.csv --storeys storeys.csv
    """
    from pounding_cli.imports.pushover import apply_curves, draw_fits, read_curves
    from pounding_cli.imports.storeys import read_building, warn_three_decimals
    from pounding_cli.imports.tables import read_tables
    from pounding_cli.outputs import check_output
    from pounding_cli.report.style import FIGURE_FORMATS, drawn_as

    choices = _build_choices(options)
    declared = _build_declaration(options)
    found = read_tables(curves, declared)
    read, notes = read_curves(found, choices)
    others = found if storeys is None else read_tables(storeys, declared)
    building = read_building(others, choices, needs_stiffness=False)
    declared.refuse_unused()
    fits = apply_curves(building, read, str(curves), bool(choices.tower))
    building.notes += notes
    if storeys is not None:
        warn_three_decimals(found, building)
    name = _choose_name(options["name"], curves)
    picture = figure or _choose_output(options["output"], name).with_name(f"{name}-fits.svg")
    suffix = picture.suffix.lower().lstrip(".")
    if suffix not in FIGURE_FORMATS:
        hint = f"end the name with one of .{', .'.join(FIGURE_FORMATS)}"
        raise InputError(Issue((), f"cannot draw a '{picture.suffix}' file", hint, file=str(picture)))
    check_output(picture, [curves], option="--figure")
    digests = found.list_digests() + ([] if storeys is None else others.list_digests())
    _finish(building, digests, curves, "pound import pushover", options)
    picture.write_bytes(drawn_as(draw_fits(read, fits, f"{name}: pushover curves and their two lines"), suffix))
    click.echo(f"drawn: {picture}\n\n{_format_fits(fits)}")


def _format_fits(fits: dict[str, Fit]) -> str:
    """Return the lines of a table of the two lines of every storey."""
    head = f"{'storey':<14}{'stiffness':>17}{'yield shear':>14}{'hardening':>11}{'mean error':>12}{'largest':>9}"
    lines = [head]
    for storey, fit in fits.items():
        numbers = f"{fit.stiffness / 1e6:>11.4g} kN/mm{fit.yield_shear / 1e3:>11.5g} kN{fit.hardening:>11.4f}"
        errors = f"{100 * fit.mean_error:>10.2f} %{100 * fit.max_error:>7.1f} %"
        lines.append(f"{escape_controls(storey):<14}{numbers}{errors}")
    return "\n".join(lines)


def _build_declaration(options: dict[str, Any]) -> TableDeclaration:
    """Return what the options declare of the tables.  Raises `InputError`."""
    from pounding_cli.imports.declared import TableDeclaration, parse_sources
    from pounding_cli.imports.units import parse_system

    return TableDeclaration(
        direction=options["direction"].upper(),
        system={} if options["units"] is None else parse_system(options["units"]),
        sources=parse_sources(options.get("column", ()), options.get("columns")),
        **{name: options[name] or "" for name in ("separator", "decimal", "thousands")},
    )


def _build_choices(options: dict[str, Any]) -> Choices:
    """Return what the options say of the tables."""
    from pounding_cli.imports.building import Choices

    names = ("case", "step", "tower", "mode", "period")
    direction = options["direction"].upper()
    return Choices(direction=direction, order=options["order"] or "", **{name: options[name] for name in names})


def _build_plan(building: ImportedBuilding, options: dict[str, Any]) -> PlanSize | None:
    """Return the size of the plan; None where no option gives it.

    Raises
    ------
    InputError : only some of its options are given, or no table has the eccentricity
    """
    from pounding_cli.imports.writing import PlanSize

    names = {"--width": "width", "--depth": "depth", "--frequency-ratio": "frequency_ratio"}
    missing = [option for option, name in names.items() if options[name] is None]
    if len(missing) == len(names):
        return None
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        message = f"a plan needs --width, --depth and --frequency-ratio; {' and '.join(missing)} {verb} missing"
        raise InputError(message, "no table has them: give them, or leave all three out")
    if building.eccentricity is None:
        message = "--width, --depth and --frequency-ratio have no effect: no table has the eccentricity"
        raise InputError(message, "export the table 'Centers Of Mass And Rigidity', or leave them out")
    return PlanSize(options["width"], options["depth"], options["frequency_ratio"])


def _choose_name(name: str | None, source: Path) -> str:
    """Return the name of the building."""
    from pounding_cli.imports.writing import clean_name

    return clean_name(name if name is not None else source.resolve().stem)


def _choose_output(output: Path | None, name: str) -> Path:
    """Return the path of the study.  Raises `InputError`: it does not end in .yaml."""
    path = output or Path(f"{name}.yaml")
    if path.suffix not in (".yaml", ".yml"):
        raise InputError(Issue((), "this is not the name of a study", "end it in .yaml", file=str(path)))
    return path


def _finish(
    building: ImportedBuilding, digests: list[tuple[str, str]], source: Path, command: str, options: dict[str, Any]
) -> None:
    """Write the study, check it, and print what was taken and how the periods compare."""
    import yaml

    from pounding_cli.api.studies import load_study
    from pounding_cli.imports.writing import format_study
    from pounding_cli.numbers import pluralize
    from pounding_cli.outputs import check_output

    name = _choose_name(options["name"], source)
    path = _choose_output(options["output"], name)
    plan = _build_plan(building, options)
    said = _describe_periods(building, options["match_period"])
    if options["units"] is not None:
        building.notes.append(f"columns without a unit: force and length by --units '{options['units']}'")
    building.notes += _list_declared(options)
    text = format_study(name, building, command, digests, plan)
    writes_over: Callable[[Path, bytes], bool] = lambda _, head: (  # noqa: E731
        options["force"] and head.startswith(b"# Written by `pound import")
    )
    check_output(path, [source] if source.is_file() else [], writes_over)
    study = load_study(yaml.safe_load(text))
    path.write_text(text, encoding="utf-8")
    names = escape_controls(", ".join(building.names))
    click.echo(f"wrote {path}: {pluralize(len(building.names), 'storey')}, from the ground up {names}")
    for note in building.notes:
        click.echo(f"  {escape_controls(note)}")
    click.echo(said)
    for warning in [*building.warnings, *study.warnings]:
        click.echo(f"warning: {escape_controls(str(warning))}", err=True)
    click.echo(f"Next, write the neighbour, the gap and your motions into it, and: pound check {path}")


def _list_declared(options: dict[str, Any]) -> list[str]:
    """Return the options that declare cells and columns, as a note."""
    said = [f"--column '{text}'" for text in options.get("column", ())]
    if options.get("columns") is not None:
        said.append(f"--columns {options['columns']}")
    said += [f"--{name} '{options[name]}'" for name in ("separator", "decimal", "thousands") if options[name]]
    return [f"declared: {', '.join(said)}"] if said else []


def _describe_periods(building: ImportedBuilding, matches: bool) -> str:
    """Return a sentence about the periods of stick and model; scale the stiffnesses where that is wanted.

    Raises
    ------
    InputError : the stiffnesses are to be scaled, and the period of the model is not known
    """
    from pounding_cli.imports.building import MAX_PERIOD_DIFFERENCE

    stick = building.stick_period
    if matches:
        building.match_period()
    if building.model_period is None:
        return f"period: the first one of the stick is {stick:.4g} s; no table has that of the model to compare"
    difference = stick / building.model_period - 1.0
    is_far = not 0.5 < 1.0 + difference < 2.0
    words = f"{abs(100 * difference):.2g} % {'longer' if difference > 0 else 'shorter'}"
    if is_far:
        words = f"{1.0 + difference:.3g} times as long"
    if abs(difference) < 5e-4:
        words = "the same within 0.05 %"
    sentence = (
        f"period: the first one of the stick is {stick:.4g} s, that of the model {building.model_period:.4g} s "
        f"({building.mode_words}): {words}"
    )
    if matches:
        return f"{sentence}; scaled to that of the model"
    if is_far:
        building.warnings.append(
            f"the period of the stick is {1.0 + difference:.3g} times that of the model: check the units of masses and "
            "stiffnesses, and whether the load case pushes along the row"
        )
    elif abs(difference) > MAX_PERIOD_DIFFERENCE:
        building.warnings.append(
            f"the periods of stick and model differ by {abs(100 * difference):.2g} %: the storeys do not deform in "
            "shear alone, or the load case does not follow the first mode; --match-period scales the stiffnesses"
        )
    return sentence

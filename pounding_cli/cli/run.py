"""`pound run`: run a study, reusing scenes solved before, and print its summary."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli import streams
from pounding_cli.cli.solving import Solving, output_option, solve_study, solving_options, time_text
from pounding_cli.numbers import counted, listed

if TYPE_CHECKING:
    import numpy as np

    from pounding_cli.batch import Outcome
    from pounding_cli.store import Overview
    from pounding_cli.store.largest import Largest
    from pounding_cli.store.overview import Trust

FEW_POINTS = 8
"""Points of a sweep that are printed one by one; of more, the range is."""

MEANINGLESS = "!"
"""Stands beside every number that means nothing, because a scene behind it left the range of its model."""


@click.command("run", short_help="Run a study and print its summary.")
@click.argument("study", type=click.Path(path_type=Path))
@output_option("results/<study>.h5")
@click.option("--all-effects", is_flag=True, help="Simulate also effects that cannot change the results; slower.")
@solving_options
@click.pass_context
def command(ctx: click.Context, study: Path, output: Path | None, all_effects: bool, **options: Any) -> None:
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
    solve_study(ctx, "run", study, output, Solving(**options), _summary, all_effects=all_effects)


def _summary(path: Path, outcome: Outcome) -> None:
    from pounding_cli.store import overview

    _print(overview(path), outcome)


def _print(found: Overview, outcome: Outcome) -> None:
    """The summary: mean ratios, motions, flags, counts, times."""
    from rich import box
    from rich.table import Table

    click.echo(f"{found.title}\n")
    _print_largest(found)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("case", no_wrap=True)
    table.add_column("building", no_wrap=True)
    for analysis, ratio in found.ratios.items():
        table.add_column(f"{analysis}\n{ratio} at roof", justify="right")
        table.add_column("\nlargest (storey)", justify="right")
        if found.trust.assessed:
            table.add_column("\n± numerical", justify="right")
            table.add_column("\nsensitivity", justify="right")
    for case in dict.fromkeys(line.case for line in found.lines):
        lines = [line for line in found.lines if line.case == case]
        for place, building in enumerate(found.buildings):
            cells = []
            for line in lines:
                cells += [
                    _number(line.roof[place], line.meaningless),
                    _number(line.largest[place], line.meaningless, line.at[place]),
                ]
                if found.trust.assessed:
                    cells += [_worth(line.error[place], ".0e"), _worth(line.sensitivity[place], ".2g")]
            marked = f"{case} {MEANINGLESS}" if any(line.meaningless.any() for line in lines) else case
            table.add_row("" if place else marked, building, *cells, end_section=len(found.points) > 1)
    streams.echo_table(table)
    count = len(found.points)
    many = f" at {count} points of the sweep" if count > 1 else ""
    for number, point in enumerate(found.points if 1 < count <= FEW_POINTS else (), start=1):
        click.echo(f"Line {number}, {point}")
    motions = "; ".join(f"{source}: {listed(names)}" for source, names in found.motions.items())
    click.echo(f"Means over {counted(found.records, 'motion')}{many}.\nMotions, {motions}")
    _print_trust(found.trust)
    for sentence in found.unknown:
        click.echo(sentence)
    for group in found.flags:
        click.echo(f"{f'Meaningless ({MEANINGLESS})' if group.meaningless else 'Note'}: {group}")
    if found.open_gaps:
        which = counted(found.open_gaps, "scene has a gap that never closes", "scenes have a gap that never closes")
        click.echo(f"{which}: of scenes that differ in such gaps alone, one was simulated.")
    side = f", {outcome.workers} side by side" if outcome.workers > 1 else ""
    worthless = f", {counted(found.meaningless, 'row')} meaningless ({MEANINGLESS})" if found.meaningless else ""
    click.echo(
        f"Scenes: {outcome.done} solved, {outcome.reused} reused, {outcome.failed} failed{worthless}{side}; "
        f"solver {time_text(outcome.solver_seconds)}, in all {time_text(outcome.wall_seconds)}"
    )
    click.echo(f"Results: {outcome.path}")


def _print_largest(found: Overview) -> None:
    """The largest values of every case and analysis, each with building, storey, motion and point of the sweep."""
    from rich import box
    from rich.table import Table

    ratios = [name for name in ("mu_ratio", "V_ratio") if any(each.quantity == name for each in found.largest)]
    columns = {
        "mu": ("mu",),
        "\n".join(_RATIOS[name] + (" (elastic)" if name != ratios[0] else "") for name in ratios): tuple(ratios),
        "drift": ("drift_ratio",),
        "struck columns\nover strength": ("shear_demand",),
    }
    known = {each.quantity for each in found.largest}
    columns = {head: names for head, names in columns.items() if not known.isdisjoint(names)}
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title="Largest of all scenes, and where", title_justify="left")
    for head in ("case", "analysis", *columns):
        table.add_column(head)
    rows: dict[tuple[str, str], dict[str, str]] = {}
    for each in found.largest:
        rows.setdefault((each.case, each.analysis), {})[each.quantity] = _largest(each, found)
    last = ""
    for (case, analysis), cells in rows.items():
        shown = (next((cells[name] for name in names if name in cells), "") for names in columns.values())
        table.add_row("" if case == last else case, analysis, *shown)
        last = case
    streams.echo_table(table)
    if "drift_ratio" in known:
        assumed = f"; {listed(found.assumed_heights)}: 3 m, as the study writes no height"
        click.echo(f"Drift: in % of the storey height{assumed if found.assumed_heights else ''}.\n")


_RATIOS = {"mu_ratio": "mu/mu0", "V_ratio": "V/V0"}


def _largest(each: Largest, found: Overview) -> str:
    """The number, and where it stands."""
    if each.value != each.value:
        return "-"
    number = f"{each.value:.3f}" if each.quantity in _RATIOS else f"{each.value:.3g}"
    number = f"{100 * each.value:.2f} %" if each.quantity == "drift_ratio" else number
    place = f"{each.building} storey {each.storey}" + (f", {each.record}" if found.records > 1 else "")
    point = f"\n{found.points[each.point]}" if len(found.points) > 1 else ""
    return f"{number}{f' {MEANINGLESS}' if each.meaningless else ''}\n{place}{point}"


def _print_trust(trust: Trust) -> None:
    """The error and the sensitivity of the numbers above, in words."""
    if trust.residual == trust.residual:
        click.echo(f"The energy balance closes to {trust.residual:.0e} of the input in every scene.")
    if not trust.assessed:
        click.echo("Errors and sensitivities were not estimated (estimate: none).")
        return
    of = "all" if trust.assessed == trust.scenes else f"{trust.assessed} of {trust.scenes}"
    click.echo(
        f"No peak has a numerical error above {trust.error:.0e} ({of} scenes assessed) or a sensitivity above "
        f"{trust.sensitivity:.2g} ({trust.where}).\nSensitivity 4: a motion that grows gradually by 1 % changes a "
        "peak by 4 %."
    )


def _worth(value: float, form: str) -> str:
    return f"{value:{form}}" if value == value else "-"


def _number(values: np.ndarray, meaningless: np.ndarray, at: np.ndarray | None = None) -> str:
    """One number a point of the sweep, or its range where there are many; those that mean nothing are marked."""
    if len(values) > FEW_POINTS:
        known = values[values == values]
        mark = f" {MEANINGLESS}" if meaningless.any() else ""
        return f"{known.min():.3f} to {known.max():.3f}{mark}" if known.size else "-"
    return "\n".join(
        (f"{value:.3f}" + (f" ({storey})" if at is not None else "") if value == value else "-")
        + (f" {MEANINGLESS}" if worthless else "")
        for value, storey, worthless in zip(values, values if at is None else at, meaningless, strict=True)
    )

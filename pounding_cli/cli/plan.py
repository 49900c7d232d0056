"""`pound plan`: what a study would run and what not, before it runs."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from pounding_cli.study import Plan


@click.command("plan")
@click.argument("study", type=click.Path(path_type=Path))
def command(study: Path) -> None:
    """Show what STUDY would run: scenes, baselines shared, links by kind, effects kept and dropped, motions.

    Nothing is computed or written.

    Example: pound plan configs/fig6.yaml
    """
    from pounding_cli.study import expand, load_study

    read = load_study(study)
    for warning in read.warnings:
        click.echo(f"warning: {warning}", err=True)
    for line in _lines(expand(read)):
        click.echo(line)


def _lines(plan: Plan) -> list[str]:
    from pounding_cli.study.schema import ADAPTIVE

    baselines = {digest for row in plan.rows for digest in row.baselines}
    linked = {row.scene for row in plan.rows} - baselines
    wanted = sum(len(row.baselines) for row in plan.rows)
    setting = "accuracy" if plan.method in ADAPTIVE else "time step [s]"
    lines = [
        plan.study.title,
        f"group      {' | '.join(plan.buildings)}",
        f"rows       {len(plan.rows)}: {_counted(plan)}",
        f"scenes     {len(plan.scenes)}: {len(linked)} of the group, {len(baselines)} of buildings alone",
        f"shared     {wanted} baselines asked for, {len(baselines)} run; "
        f"{len(plan.rows) - len({row.scene for row in plan.rows})} rows repeat another's scene",
        f"method     {plan.method}, {setting} {plan.accuracy:g}",
    ]
    for axis in plan.axes:
        shown = [", ".join(str(value) for value in values) for values in axis.values]
        listed = "; ".join(shown[:8]) + (f"; ... {len(shown)} in all" if len(shown) > 8 else "")
        lines.append(f"sweep      {', '.join(axis.names)}: {listed}")
    lines.append("cases")
    lines += [f"  {case:<16} {_links(plan, case)}" for case in plan.cases]
    lines.append("effects    (in scenes of the group)")
    lines += _effects(plan, linked)
    lines.append("motions    (as used)")
    lines += [
        f"  {use.name:<16} {use.source}, first {use.window:g} s x {use.scale:.3f}: "
        f"peak {use.pga:.2f} m/s2, Arias {use.arias:.3f} m/s"
        for use in plan.motions
    ]
    return lines


def _counted(plan: Plan) -> str:
    parts = [f"{len(axis.values)} x {', '.join(axis.names)}" for axis in plan.axes]
    for names, word in ((plan.cases, "cases"), (plan.analyses, "analyses"), (plan.records, "records")):
        parts.append(f"{len(names)} {word}")
    return ", ".join(parts)


def _effects(plan: Plan, linked: set[str]) -> list[str]:
    """In how many scenes each effect is simulated, and why it is dropped in the others."""
    from pounding_cli.model.effects import effects_of

    kept: Counter[str] = Counter()
    dropped: Counter[str] = Counter()
    for digest in plan.scenes:
        if digest in linked:
            effects = effects_of(plan.scenes[digest])
            kept.update(effects.kept)
            dropped.update(effects.dropped)
    names = dict.fromkeys((*kept, *(text.split(": ", 1)[0] for text in dropped)))
    lines = []
    for name in names:
        reasons = [
            f"dropped in {count}: {text.split(': ', 1)[1]}"
            for text, count in dropped.items()
            if text.split(": ", 1)[0] == name
        ]
        parts = [f"kept in {kept[name]}"] * bool(kept[name]) + reasons
        lines.append(f"  {name:<30} {'; '.join(parts)}")
    return lines


def _links(plan: Plan, case: str) -> str:
    """The links of a case at the first point of the sweep, in words."""
    row = next(row for row in plan.rows if row.case == case)
    links = plan.scenes[row.scene].links
    if not links:
        return "no links: runs as buildings alone"
    groups = Counter((str(link.kind), link.gap, link.stiffness) for link in links)
    return "; ".join(
        f"{count} x {kind}, gap {gap * 100:g} cm, {stiffness / 1e6:.4g} MN/m"
        for (kind, gap, stiffness), count in groups.items()
    )

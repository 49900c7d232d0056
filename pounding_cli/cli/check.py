"""`pound check`: whether a study is valid, and what a run of it would solve, leave out and take."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli import streams
from pounding_cli.cli.solving import time_text
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.batch.forecast import Forecast
    from pounding_cli.laws.law import LinkLaw
    from pounding_cli.numbers import Unit
    from pounding_cli.study import Axis, Plan, Study


@click.command("check", short_help="Validate a study; show what a run would solve and leave out.")
@click.argument("study", type=click.Path(path_type=Path))
def command(study: Path) -> None:
    """Validate STUDY and show what a run would solve, what it would leave out and about how long it would take.

    The command reports every problem as file:line:column, what is wrong and what to write instead. It accepts studies
    of all commands, including their sections (`gap:`, `fragility:`, `sensitivity:`, `optimise:`), whose questions it
    lists with the scenes that they begin with.

    Behind the line "OK" it lists the scenes with their expected time, for which it runs one scene of each kind, links,
    effects simulated and left out with the reason, and motions. Nothing is written.
    Exit code 0: the study is valid; 2: it was refused.

    Example: pound check configs/fig6.yaml
    """
    from pounding_cli.points import QUESTIONS, load
    from pounding_cli.reading import shortened
    from pounding_cli.study import expand, load_study
    from pounding_cli.study.file import kind_of_file
    from pounding_cli.workflows import TITLES, workflow_of

    name = shortened(study)
    kind = kind_of_file(study)
    if kind in QUESTIONS:
        sweep = load(study, kind)
        for warning in sweep.warnings:
            streams.echo_warning(warning)
        click.echo(f"OK: {name}: a study of `pound {kind}`, {counted(len(sweep.points), 'point')} to compute")
        return
    read = load_study(study)
    asked = [workflow_of(each) for each in TITLES if each != "run" and read.root.get(each) is not None]
    for workflow in asked:
        workflow.check(read)
    plan = expand(read)
    plans = {workflow.name: workflow.plan(read) for workflow in asked}
    for warning in read.warnings:
        streams.echo_warning(warning)
    click.echo(f"OK: {name}: {_size(plan)}")
    from pounding_cli.solver import solve  # here, so that a study that is refused need not wait for numba

    solve.say = lambda text: click.echo(text, err=True)
    for line in [*_lines(plan), *_questions(read, plans)]:
        click.echo(line)


def _size(plan: Plan) -> str:
    """The rows of a study and its scenes."""
    factors = [
        counted(len(plan.cases), "case"),
        counted(len(plan.analyses), "analysis", "analyses"),
        counted(len(plan.records), "record"),
        *([counted(math.prod(plan.shape[:-3]), "sweep point")] if plan.axes else []),
    ]
    rows = counted(math.prod(plan.shape), "row")
    return f"{' x '.join(factors)} = {rows} from {counted(len(plan), 'scene')}"


def _questions(study: Study, plans: dict[str, Plan]) -> list[str]:
    """What the sections of a study ask, with the scenes that each question begins with, and their time.

    plans : command -> what is known before anything is solved
    """
    from pounding_cli.batch.forecast import START, forecast
    from pounding_cli.workflows import workflow_of

    lines = []
    for name, plan in plans.items():
        workflow = workflow_of(name)
        more = "; more depend on the results" if workflow.goes_on(study) else ""
        first = workflow.first(plan)
        time = time_text(START + forecast(plan, first).total)
        lines.append(f"  pound {name:<12} {'begins with' if more else 'has'} {counted(len(first), 'scene')}, "
                     f"about {time} on one core{more}")  # fmt: skip
    return ["questions  (the lines above are those of `pound run`)", *lines] if lines else []


def _lines(plan: Plan) -> list[str]:
    from pounding_cli.batch.forecast import ALONE, START, forecast
    from pounding_cli.workflows import workflow_of

    found = forecast(plan, workflow_of("run").first(plan))
    rows = math.prod(plan.shape)
    step = "" if plan.time_step is None else f"time step {plan.study.unit('time step').text(plan.time_step)}"
    setting = step or f"accuracy {plan.accuracy:g}"
    lines = [
        plan.study.title,
        f"group      {' | '.join(plan.buildings)}",
        *_sweep(plan.axes),
        f"method     {plan.method}, {setting}",
        f"scenes     {len(plan)}, on one core about {time_text(START + found.total)} with estimate: {plan.estimate}",
        f"           timed by {counted(found.timed, 'scene')} of them",
    ]
    if found.looked_at < 1:
        lines.append(f"           effects judged by one scene in {1 / found.looked_at:.0f}")
    for what, count in sorted(found.scenes.items()):
        lines.append(f"  run      {count:6d} {what}, about {time_text(found.seconds[what])}")
    lines.append(
        f"  shared   {counted(rows * len(plan.buildings), 'baseline')} asked for, {found.scenes[ALONE]} run; "
        f"{counted(max(0, rows - (len(plan) - found.scenes[ALONE])), 'row repeats', 'rows repeat')} another's scene"
    )
    if plan.time_step is None:
        lines.append("  not run         scenes whose gaps are wider than ones that turn out never to close")
    lines += _meetings(plan)
    lines.append("cases")
    units = plan.study.unit("gap"), plan.study.unit("link stiffness")
    lines += [f"  {case:<16} {_links(plan, place, *units)}" for place, case in enumerate(plan.cases)]
    lines.append("effects    (in scenes of the group)")
    lines += _effects(found)
    lines.append("motions    (as used)")
    unit = plan.study.unit("acceleration")
    uses = [used.use for used in plan.study.motions((0,) * len(plan.axes)).values()]
    lines += [
        f"  {use.name:<16} {use.source}, first {use.window:g} s x {use.scale:.3f}: "
        f"peak {unit.text(use.pga, 3)}, Arias {use.arias:.3f} m/s"
        for use in uses
    ]
    if (match := plan.study.spectrum_match()) is not None:
        lines.append(f"  {match.words}")
    return lines


def _sweep(axes: Sequence[Axis]) -> list[str]:
    """The swept keys with their values, one axis a line."""
    lines = []
    for axis in axes:
        shown = [", ".join(axis.shown(place)) for place in range(len(axis.values))]
        listed = "; ".join(shown[:8]) + (f"; ... {len(shown)} in all" if len(shown) > 8 else "")
        lines.append(f"sweep      {', '.join(axis.names)}: {listed}")
    return lines


def _meetings(plan: Plan) -> list[str]:
    """Where neighbours can strike each other, at the first point of the sweep."""
    from pounding_cli.study.build import meetings_in_words

    first = (0,) * len(plan.axes)
    group = [plan.study.building(first, place) for place in range(len(plan.buildings))]
    swept = " (at the first point of the sweep)" if any(plan.study.touching("buildings")) else ""
    return [f"meetings{swept}", *(f"  {line}" for line in meetings_in_words(group))]


def _effects(found: Forecast) -> list[str]:
    """In how many scenes each effect is simulated, and why it is left out in the others; those that no scene has and
    nobody expects in one sentence."""
    from pounding_cli.model.effects import EXPECTED, others

    names = dict.fromkeys((*found.kept, *(text.split(": ", 1)[0] for text in found.dropped)))
    lines = []
    told = [name for name in names if name in found.kept or name in EXPECTED]
    for name in told:
        reasons = [
            f"left out in {round(count)}: {text.split(': ', 1)[1]}"
            for text, count in found.dropped.items()
            if text.split(": ", 1)[0] == name
        ]
        kept = [f"simulated in {round(found.kept[name])}"] if name in found.kept else []
        lines.append(f"  {name:<30} {'; '.join(kept + reasons)}")
    rest = others([name for name in names if name not in told])
    return [*lines, f"  {rest}"] if rest else lines


def _links(plan: Plan, case: int, width: Unit, strength: Unit) -> str:
    """The links of a case at the first point of the sweep, in words."""
    links = plan.build(case * len(plan.analyses) * len(plan.records)).links
    if not links:
        return "no links: runs as buildings alone"
    groups = Counter((link.kind, link.gap, _stiffness(link.law, strength)) for link in links if not link.columns)
    said = [f"{count} x {kind}, gap {width.text(gap)}, {stiffness}" for (kind, gap, stiffness), count in groups.items()]
    struck = [link for link in links if link.columns]
    for gap in dict.fromkeys(link.gap for link in struck):
        springs = sorted(link.law.initial_stiffness for link in struck if link.gap == gap)
        ends = " to ".join(dict.fromkeys(strength.text(each, 4) for each in (springs[0], springs[-1])))
        said.append(f"{len(springs)} x slab against columns, gap {width.text(gap)}, {ends} with the columns' bending")
    return "; ".join(said)


def _stiffness(law: LinkLaw, unit: Unit) -> str:
    """The stiffness of a law; of one that has none in N/m, its first parameter besides the gap that has a unit."""
    units = {name: each.metadata["parameter"].unit for name, each in law.parameters().items()}
    other = next((name for name, of in units.items() if name != "gap" and of != "-"), None)
    if "stiffness" in units or other is None:
        return unit.text(law.initial_stiffness, 4)
    return f"{getattr(law, other):.4g} {units[other]}"

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


MOST_POINTS, FEW_POINTS = 10_000, 2000
"""Points of a sweep that are all looked at, and of a larger one so many, spread evenly: each takes a quarter of a
millisecond."""


@click.command("check", short_help="Validate a study; show what a run would solve and leave out.")
@click.argument("study", type=click.Path(path_type=Path))
def command(study: Path) -> None:
    """Validate STUDY and show what a run would solve, what it would leave out and about how long it would take.

    The command reports every problem as file:line:column, what is wrong and what to write instead. It accepts studies
    of all commands, including their sections (`gap:`, `fragility:`, `sensitivity:`, `optimise:`), whose questions it
    lists with the scenes of their first round.

    Behind the line "OK" it lists the scenes with their expected time, for which it runs one scene of each kind, links,
    effects simulated and left out with the reason, and motions. Nothing is written.
    Exit code 0: the study is valid; 2: it was refused.

    Example: pound check configs/fig6.yaml
    """
    from pounding_cli.points import QUESTIONS, load
    from pounding_cli.reading import shortened
    from pounding_cli.study import expand, load_study
    from pounding_cli.study.kinds import kind_of_file
    from pounding_cli.study.thinned import thinned
    from pounding_cli.workflows import WORKFLOWS

    name = shortened(study)
    kind = kind_of_file(study)
    if kind in QUESTIONS:
        sweep = load(study, kind)
        for warning in sweep.warnings:
            streams.echo_warning(warning)
        click.echo(f"OK: {name}: a study of `pound {kind}`, {counted(len(sweep.points), 'point')} to compute")
        return
    read = load_study(study)
    asked = {each: workflow for each, workflow in WORKFLOWS.items() if read.root.get(each) is not None}
    for workflow in asked.values():
        if workflow.question:
            workflow.part("question")(read)
    some = read if math.prod(len(axis.values) for axis in read.axes) <= MOST_POINTS else thinned(read, FEW_POINTS)
    plan = expand(some)
    questions = {each: workflow.part("expand")(some) for each, workflow in asked.items() if workflow.is_section}
    for warning in read.warnings:
        streams.echo_warning(warning)
    click.echo(f"OK: {name}: {_size(read, plan)}")
    from pounding_cli.solver import solve  # here, so that a study that is refused need not wait for numba

    solve.say = lambda text: click.echo(text, err=True)
    for line in [*_lines(read, plan), *_questions(read, some, questions)]:
        click.echo(line)


def _size(study: Study, plan: Plan) -> str:
    """The rows of a study and, where all points of its sweep were looked at, its scenes."""
    points = math.prod(len(axis.values) for axis in study.axes)
    factors = [
        counted(len(plan.cases), "case"),
        counted(len(plan.analyses), "analysis", "analyses"),
        counted(len(plan.records), "record"),
        *([counted(points, "sweep point")] if study.axes else []),
    ]
    scenes = f" from {counted(len(plan.scenes), 'scene')}" if plan.study is study else ""
    return f"{' x '.join(factors)} = {counted(_rows(study, plan), 'row')}{scenes}"


def _rows(study: Study, plan: Plan) -> int:
    return math.prod((*(len(a.values) for a in study.axes), len(plan.cases), len(plan.analyses), len(plan.records)))


def _questions(study: Study, some: Study, plans: dict[str, Plan]) -> list[str]:
    """What the sections of a study ask, with the scenes of the first round of each question and their time.

    some : the study, or the thinned one that is looked at in its place
    plans : command -> the plan of its first round
    """
    from pounding_cli.batch.forecast import START, forecast

    times = math.prod(len(axis.values) / len(few.values) for axis, few in zip(study.axes, some.axes, strict=True))
    about = "" if some is study else "about "
    lines = []
    for name, plan in plans.items():
        later = ""
        if plan.ahead:
            later = f"; later rounds about {round(times * plan.ahead)} more at most"
        elif any(row.scene not in plan.scenes for row in plan.rows if row.scene):
            later = "; later rounds need more scenes, depending on the results"
        elif plan.state is not None:
            later = "; later rounds depend on its results"
        first = "the first round has" if later else "it has"
        scenes = f"{about}{counted(round(times * len(plan.scenes)), 'scene')}"
        time = time_text(START + times * forecast(plan).total)
        lines.append(f"  pound {name:<12} {first} {scenes}, about {time} on one core{later}")
    return ["questions  (the lines above are those of `pound run`)", *lines] if lines else []


def _lines(study: Study, plan: Plan) -> list[str]:
    from pounding_cli.batch.forecast import START, forecast

    found = forecast(plan, study)
    rows = _rows(study, plan)
    about = "" if plan.study is study else "about "
    repeated = max(0, rows - (found.all - found.alone))
    step = "" if plan.time_step is None else f"time step {plan.study.unit('time step').text(plan.time_step)}"
    setting = step or f"accuracy {plan.accuracy:g}"
    lines = [
        plan.study.title,
        f"group      {' | '.join(plan.buildings)}",
        *_sweep(study.axes),
        f"method     {plan.method}, {setting}",
        f"scenes     {about}{found.all}, on one core about {time_text(START + found.total)} with estimate: "
        f"{plan.estimate}",
        f"           timed by {counted(found.timed, 'scene')} of them",
    ]
    if found.looked_at < 1:
        lines.append(f"           judged by one scene in {1 / found.looked_at:.0f}")
    if about:
        lines.append("           other combinations of swept values are checked when the run begins")
    for what, count in sorted(found.scenes.items()):
        lines.append(f"  run      {round(count):6d} {what}, about {time_text(found.seconds[what])}")
    lines.append(
        f"  shared   {counted(rows * len(plan.buildings), 'baseline')} asked for, {about}{found.alone} run; "
        f"{about}{counted(repeated, 'row repeats', 'rows repeat')} another's scene"
    )
    if plan.time_step is None:
        lines.append("  not run         scenes whose gaps are wider than ones that turn out never to close")
    lines += _meetings(plan)
    lines.append("cases")
    units = plan.study.unit("gap"), plan.study.unit("link stiffness")
    lines += [f"  {case:<16} {_links(plan, case, *units)}" for case in plan.cases]
    lines.append("effects    (in scenes of the group)")
    lines += _effects(found)
    lines.append("motions    (as used)")
    unit = plan.study.unit("acceleration")
    lines += [
        f"  {use.name:<16} {use.source}, first {use.window:g} s x {use.scale:.3f}: "
        f"peak {unit.text(use.pga, 3)}, Arias {use.arias:.3f} m/s"
        for use in plan.motions
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
    from pounding_cli.study.facing import meetings_in_words

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


def _links(plan: Plan, case: str, width: Unit, strength: Unit) -> str:
    """The links of a case at the first point of the sweep, in words."""
    row = next(row for row in plan.rows if row.case == case)
    links = plan.scenes[row.scene].links
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

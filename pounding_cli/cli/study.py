"""The commands about a study that solve nothing: `pound init`, `check`, `cite`, `schema`."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli.options import FILE, changes_argument, output_option, study_argument
from pounding_cli.cli.taken import describe_taken_files
from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import count_histories, format_duration, pluralize, round_roughly
from pounding_cli.texts import escape_controls

if TYPE_CHECKING:
    from pounding_cli.api.standing import Standing
    from pounding_cli.batch.forecast import Forecast, RunDuration
    from pounding_cli.model.building import Building
    from pounding_cli.numbers import Unit
    from pounding_cli.questions.question import StudyQuestion
    from pounding_cli.study import Plan, Study
    from pounding_cli.study.vary.changes import Change


@click.command()
@click.argument("name")
@click.option(
    "-t", "--template", type=click.Choice(("pair", "measures", "connector", "wall")),
    help="Study to start from.  [default: pair]",
)  # fmt: skip
@click.option(
    "--like", metavar="NAME", help="Study of published results or of the gallery instead, e.g. impact-oscillator.",
)  # fmt: skip
def init(name: str, template: str | None, like: str | None) -> None:  # fmt: skip
    """Write NAME.yaml, a commented study that is ready to run, and pound.schema.json, with which editors complete keys.

    \b
    Templates:
      pair       two buildings, touching and with a gap, every key explained
      measures   the paper's measures: gap, infill, connectors, under its five motions
      connector  two connected oscillators in closed form
      wall       a floor striking a bumper wall

    With --like it writes a study of the pages "Compared with published results" and "Gallery", with the motions that
    these have; another name than theirs is refused with a list of them.

    \b
    Example:
      pound init walls/front --template wall
      pound init mine --like impact-oscillator
    """
    from pounding_cli.api.studies import default_output
    from pounding_cli.paper import TITLES as POINT_TITLES
    from pounding_cli.questions import TITLES, schema_text
    from pounding_cli.study.text.file import kind_of_file, read_study
    from pounding_cli.study.text.template import TEMPLATES, find_missing_motions, start_study

    if template and like:
        problem = Issue((), "--template and --like name two studies to start from", "write one of the two")
        raise InputError(problem)
    written = start_study(name, schema_text(), template or "pair", like)
    study = written[0]
    if like is None:
        how = TEMPLATES[template or "pair"]
    else:
        how = next((each for each in TITLES if each in read_study(study)[1]), kind_of_file(study))
    results = default_output(study, "run" if how in POINT_TITLES else how)
    quoted_study = shlex.quote(str(study))
    quoted_results = shlex.quote(str(results))
    steps = {
        f"pound check {quoted_study}": "checks it; repeat after every change",
        f"pound {how} {quoted_study}": f"writes {results} and prints a summary",
    }
    if how == "run":
        steps[f"pound show {quoted_results} storey"] = "shows shears and ductilities, storey by storey"
        steps[f"pound report {quoted_results}"] = f"draws {results.with_suffix('') / 'report.html'}, figures, tables"
    click.echo(f"wrote {', '.join(map(str, written))}")
    missing = find_missing_motions(study)
    if missing:
        click.echo(
            f"First put {' and '.join(missing)} beside it, which come from elsewhere: its comments say where from."
        )
    click.echo("Next, change it as you like, and:")
    for line, what in steps.items():
        click.echo(f"  {line:<{max(map(len, steps))}}   {what}")


@click.command()
@study_argument
@output_option("results/STUDY.h5", "Results file, beside which solved time histories are kept.")
def check(study: Path, changes: tuple[Change, ...], output: Path | None) -> None:
    """Validate STUDY and show what a run would solve, what is solved already and about how long the rest would take.

    The command reports every problem as file:line:column, what is wrong and what to write instead. It accepts studies
    of all commands. Nothing is solved, compiled or written; times are by the rates of earlier runs on this computer.
    KEY=VALUE puts a value in place of that of STUDY (docs/how-to/change.md): what is shown is about a run with it.
    Exit code 0: the study is valid; 2: it was refused.

    \b
    Example:
      pound check configs/fig6.yaml
      pound check configs/fig6.yaml accuracy=1e-8
    """
    from pounding_cli.paper import TITLES as POINT_TITLES
    from pounding_cli.questions import TITLES, study_model
    from pounding_cli.reading import shorten_path
    from pounding_cli.study.load import build_study
    from pounding_cli.study.text.file import kind_of, read_study

    name = shorten_path(study)
    text, tree = read_study(study)
    kind = kind_of(tree)
    if kind in POINT_TITLES:
        from pounding_cli.paper.points import load_sweep

        sweep = load_sweep(study, kind, changes)
        for warning in sweep.warnings:
            click.echo(f"warning: {warning}", err=True)
        click.echo(f"OK: {name}: a study of `pound {kind}`, {pluralize(len(sweep.points), 'point')} to compute")
        return
    read = build_study(study, text, tree, study_model(), changes)
    questions = _read_questions(read, [each for each in TITLES if each == "run" or read.tree.get(each) is not None])
    plan, *_ = [each.plan for each in questions]
    for warning in read.warnings:
        click.echo(f"warning: {warning}", err=True)
    factors = [
        pluralize(len(plan.cases), "case"),
        pluralize(len(plan.analyses), "analysis", "analyses"),
        pluralize(len(plan.records), "motion"),
        *([pluralize(math.prod(plan.shape[:-3]), "sweep point")] if plan.axes else []),
    ]
    rows = pluralize(math.prod(plan.shape), "row")
    click.echo(f"OK: {name}: {' x '.join(factors)} = {rows} of {count_histories(len(plan))}")
    click.echo("\n".join(_describe_plan(plan)))
    for line in describe_taken_files(read):
        click.echo(line)
    for sentence in dict.fromkeys(sentence for each in questions for sentence in each.taken):
        click.echo(escape_controls(sentence))
    click.echo("commands   (times on one core, by the rates of earlier runs on this computer)")
    for each in questions:
        line, *below = _describe_standing(each, output)
        click.echo("\n".join([f"  pound {each.name:<12} {line}", *below]))


def _read_questions(study: Study, names: Sequence[str]) -> list[StudyQuestion]:
    """Return what the sections of a study ask.  Raises `InputError` with what is wrong in all of them."""
    from pounding_cli.questions import load_question

    questions: list[StudyQuestion] = []
    problems: list[Issue] = []
    for name in names:
        try:
            questions.append(load_question(name).ask(study))
        except InputError as refused:
            problems += refused.issues
    if problems:
        raise InputError(sorted(problems, key=lambda problem: (problem.line, problem.column)))
    return questions


def _describe_standing(question: StudyQuestion, output: Path | None) -> list[str]:
    """Return how many time histories a question has, how many are solved, and the time of the others.

    Lines below say why others are not solved, by cause, and what is reused.
    """
    from pounding_cli.api.standing import find_standing
    from pounding_cli.api.studies import default_output

    study = question.study
    path = output or default_output(study.path, question.name, study.changes)
    try:
        standing = find_standing(question, path)
    except InputError as refused:  # another run is using these results
        return [f"{count_histories(len(question.plan))}; {refused.issues[0].message}"]
    if standing.is_current:
        return [f"{count_histories(standing.total)}, all solved: {path} is current"]
    total = count_histories(standing.total)
    missing = str(standing.missing)
    if question.extent != "has":
        total = f"about {count_histories(round_roughly(standing.total))}"
        missing = f"about {round_roughly(standing.missing)}"
    if question.extent == "has at most":
        total += f", at most {len(question.plan)}"
    said = [total, f"{standing.solved} solved, {missing} to solve", *standing.reasons]
    line = f"{'; '.join(said)}; {_describe_duration(standing.duration)}"
    return [line, *_describe_causes(standing, question.extent == "has")]


def _describe_causes(standing: Standing, has_counts: bool) -> Iterator[str]:
    """Yield in lines the changes that make time histories new, and what is reused.

    has_counts : whether the number of time histories is known beforehand
    """
    from pounding_cli.api.causes import format_subjects

    if standing.causes:
        since = "" if standing.since is None else f" since {standing.since} was written"
        yield from _wrap(f"new{since}:", 4)
    for cause in standing.causes:
        if not has_counts:
            yield from _wrap(cause.subject, 6)
        elif cause.count == standing.total:
            yield from _wrap(f"{cause.subject}: all {count_histories(cause.count)}", 6)
        else:
            yield from _wrap(str(cause), 6)
    if standing.causes and standing.solved:
        yield from _wrap(f"reused: {count_histories(standing.solved)}{format_subjects(dict(standing.reused))}", 4)


def _wrap(text: str, indent: int) -> list[str]:
    """Return the lines of a text that stands below a command."""
    from pounding_cli.texts import wrap_text

    first, *others = wrap_text(text, 79 - indent - 2)
    return [f"{'':{indent}}{first}", *(f"{'':{indent + 2}}{line}" for line in others)]


def _describe_duration(duration: RunDuration) -> str:
    """Return the expected time of a run, or why it is not known."""
    from pounding_cli.solver.kernels import COMPILE_TIME

    if duration.uncompiled:
        kernels = " and ".join(duration.uncompiled)
        is_are = "is" if len(duration.uncompiled) == 1 and not kernels.endswith("s") else "are"
        seconds = sum(COMPILE_TIME[kernel] for kernel in duration.uncompiled)
        compiled = f"{kernels} {is_are} not compiled on this computer yet"
        return f"{compiled}; the first run compiles for about {seconds:.0f} s"
    if duration.seconds is None:
        return "the time is not known before a first run on this computer"
    return f"about {format_duration(duration.seconds)}"


def _describe_plan(plan: Plan) -> list[str]:
    """Return in lines what a run of a plan would solve and leave out."""
    from pounding_cli.batch.forecast import build_forecast
    from pounding_cli.study.check.archetype_words import describe_seen_buildings
    from pounding_cli.study.construct.group import format_meetings

    study = plan.study
    first = (0,) * len(plan.axes)
    found = build_forecast(plan)
    step = "" if plan.time_step is None else f"time step {study.unit('time step').text(plan.time_step)}"
    lines = [study.title, f"group      {' | '.join(plan.buildings)}"]
    for axis in plan.axes:
        shown = [", ".join(axis.display_values(place)) for place in range(len(axis.values))]
        values = "; ".join(shown[:8]) + (f"; ... {len(shown)} in all" if len(shown) > 8 else "")
        lines.append(f"sweep      {', '.join(axis.names)}: {values}")
    lines += [
        f"method     {plan.method}, {step or f'accuracy {plan.accuracy:g}'}, estimate: {plan.estimate}",
        f"solves     {count_histories(len(plan))}",
        *(f"           {count:6d} {what}" for what, count in found.scenes.items()),
    ]
    if divided_count := int(plan.divided.sum()):
        lines.append(f"           {divided_count:6d} of these by parts that nothing links, each part once")
    lines.append("meetings (at the first point of the sweep)" if study.axes_changing("buildings") else "meetings")
    group = study.group(first).buildings
    lines += [f"  {line}" for line in format_meetings(group)]
    lines += _isolators(group, study.unit("gap"))
    lines += describe_seen_buildings(study)
    lines += _plans(plan, group)
    lines.append("cases")
    units = study.unit("gap"), study.unit("link stiffness")
    lines += [f"  {case:<16} {_links(plan, place, *units)}" for place, case in enumerate(plan.cases)]
    lines += ["effects    (in time histories of the group)", *_effects(found)]
    is_swept = bool(study.axes_changing("records"))
    lines.append(
        "motions    (with the values that the study writes; the sweep changes them)"
        if is_swept
        else "motions    (as used)"
    )
    unit = study.unit("acceleration")
    for use in study.written_suite.uses.values():
        measures = f"peak {unit.text(use.pga, 3)}, Arias {use.arias:.3f} m/s"
        lines.append(f"  {use.name:<16} {use.source}, first {use.window:g} s x {use.scale:.3f}: {measures}")
    if (match := study.spectrum_match()) is not None:
        lines.append(f"  {match.words}")
    return lines


def _isolators(group: Sequence[Building], width: Unit) -> list[str]:
    """Period and damping ratio of isolators as a linear oscillator has them at their capacity, or at 10 cm."""
    lines = []
    for building in group:
        isolation = building.foundation.isolation if building.foundation is not None else None
        if isolation is not None:
            at = isolation.capacity if isolation.capacity < math.inf else 0.1
            period, damping = isolation.effective(building.weight, at)
            told = f"period {period:.2f} s, damping {100 * damping:.1f} %"
            lines.append(f"  {building.name:<16} at {width.text(at)}: {told}")
    return ["isolators  (as a linear oscillator)", *lines] if lines else []


def _plans(plan: Plan, group: Sequence[Building]) -> list[str]:
    """Return the plans of the buildings in lines, and which floors twist in which case why; none without plans."""
    from pounding_cli.study.check.twist_words import describe_plans, describe_twists

    if all(building.plan is None for building in group):
        return []
    first = plan.study.first_point
    links = {case: plan.study.parts.links[case].value_at(first) for case in plan.cases}
    lines = ["plans (at the first point of the sweep)" if plan.study.axes_changing("buildings") else "plans"]
    for name, words in describe_plans(group):
        lines += _hang(name, words)
    lines.append("twist")
    for case, words in describe_twists(group, links):
        lines += _hang(case, words)
    return lines


def _hang(name: str, words: str) -> list[str]:
    """Return sentences about something in lines, behind its name."""
    from pounding_cli.texts import wrap_text

    first, *others = wrap_text(words, 100)
    return [f"  {name:<16} {first}", *(f"  {'':<16} {line}" for line in others)]


def _effects(found: Forecast) -> Iterator[str]:
    """In how many time histories each effect is simulated, and why it is left out in the others."""
    from pounding_cli.model.effects import summarize_effects

    for name, here, out, why in summarize_effects(found.kept, found.dropped):
        said = [f"simulated in {round(here)}"] * bool(here) + [f"left out in {round(out)}: {why}"] * bool(out)
        yield f"  {name:<30} {'; '.join(said)}"


def _links(plan: Plan, case: int, width: Unit, strength: Unit) -> str:
    """Return the links of a case at the first point of the sweep, in words."""
    from pounding_cli.study.check.link_words import describe_links

    scene = plan.build(case * len(plan.analyses) * len(plan.records))
    twists = any(building.plan is not None for building in scene.buildings)
    return describe_links(scene.links, plan.study.group((0,) * len(plan.axes)), width, strength, twists)


@click.command()
@click.argument("source", type=FILE, metavar="STUDY|FILE.h5")
@changes_argument
@click.option(
    "--format", "form", type=click.Choice(("text", "bibtex")), default="text", show_default=True,
    help="Plain text, or entries for a .bib file.",
)  # fmt: skip
def cite(source: Path, changes: tuple[Change, ...], form: str) -> None:  # fmt: skip
    """List the references of a study or a results file, what each is used for, and the sources of the motions.

    KEY=VALUE puts a value in place of that of STUDY (docs/how-to/change.md).

    \b
    Example:
      pound cite configs/fig6.yaml --format bibtex > references.bib
    """
    from pounding_cli.api.studies import load_study, open_results
    from pounding_cli.questions import load_question
    from pounding_cli.report.references import REFERENCES, iter_motion_sources, list_citations

    if source.suffix in (".yaml", ".yml"):
        study = load_study(source, changes)
        title = study.title
        question = "run"
        resolved = study.to_plain_data()
        methods: tuple[str, ...] = (study.spec.method,)
        sources = {use.name: use.source for use in study.motion_uses(study.first_point).values()}
    else:
        if changes:
            raise InputError(
                Issue((), "changes a study, not results", "name a study, or leave it out", file=changes[0].mark[0])
            )
        results = open_results(source)
        title = results.title
        question = results.workflow
        resolved = results.study_data
        methods = tuple(results.methods)
        sources = dict(results.records().drop_duplicates("record").set_index("record")["source"])
    citations = list_citations(resolved, sources, methods, load_question(question).cite)
    if form == "bibtex":
        click.echo("\n\n".join(REFERENCES[key].bibtex for key in citations))
        return
    click.echo(title)
    for key, purposes in citations.items():
        click.echo(f"\n{REFERENCES[key].text}\n    for {'; '.join(purposes)}")
    click.echo("\n".join(["\nMotions", *(f"  {line}" for line in iter_motion_sources(sources))]))


@click.command()
@click.option("-o", "--output", type=FILE, help="Write to this file. Default: print it.")
def schema(output: Path | None) -> None:
    """Print the JSON Schema of study files, with which editors complete keys and mark mistakes, of studies that begin
    with `# yaml-language-server: $schema=pound.schema.json`.

    \b
    Example:
      pound schema -o pound.schema.json
    """
    from pounding_cli.outputs import check_output
    from pounding_cli.questions import schema_text

    text = schema_text()
    if output is None:
        click.echo(text, nl=False)
        return
    check_output(output, mine=lambda _, head: head.startswith(text.encode()[:60]))
    output.write_text(text, encoding="utf-8")
    click.echo(f"wrote {output}")

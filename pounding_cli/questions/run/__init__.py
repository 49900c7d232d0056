"""`pound run`: every time history of a study, and what becomes of its statements."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from pounding_cli.errors import InputError
from pounding_cli.questions.expressions import find_missing_places, find_scope
from pounding_cli.questions.question import Answer, LateFunction, Question, StudyQuestion
from pounding_cli.questions.run.statements import STATEMENT_COLUMNS, STATEMENTS, build_statement_table
from pounding_cli.study.issues import Issues
from pounding_cli.study.statements import StudyStatement, parse_statements

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.study import Plan, Study


class Run(StudyQuestion):
    """Every time history of a study.

    statements : what should hold of its results
    """

    name = "run"

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        self.statements = read_statements(self)
        self.problems.check()
        self.content = repr(self.statements) if isinstance(study.spec.statements, str) else ""

    @cached_property
    def plan(self) -> Plan:
        """All time histories."""
        from pounding_cli.study import make_plan

        return make_plan(self.study)

    def answer(self, solver: Solver) -> Answer:
        """Return what all time histories did, and the numbers of the statements."""
        arrays = solver.solve_arrays(self.plan)
        if not self.statements:
            return Answer(self.plan, arrays, ())
        needs_histories = any(each.needs_histories for each in self.statements)
        histories = solver.iter_histories(self.plan, arrays) if needs_histories else ()
        return Answer(self.plan, arrays, [build_statement_table(self.plan, arrays, self.statements, histories)])


def read_statements(question: StudyQuestion) -> list[StudyStatement]:
    """Return the statements of a study.  Note what is wrong with them."""
    study = question.study
    specs = study.spec.statements
    is_file = isinstance(specs, str)
    if is_file:
        specs = _read_statements_of(question, specs)
    statements, faults = parse_statements(specs, find_scope(study, whole=True))
    places = [(("statements", *path), message, hint) for path, message, hint in faults]
    for number, statement in enumerate(statements):
        written = [" ".join(text.split()) for text in specs[number].holds]
        for comparison in statement.comparisons:
            text = comparison.text
            key = ("holds", written.index(text)) if text in written else ("number",)
            places += [(("statements", number, *key), *each) for each in find_missing_places(comparison, question)]
        places += [(("statements", number), *each) for each in _find_lost_histories(statement, study)]
        if statement.needs_histories and question.name != Run.name:
            message = f"statement {statement.name} rests on an instant, and `pound {question.name}` keeps no histories"
            places.append((("statements", number), message, "move it to another study, for `pound run`"))
        elif statement.needs_histories and study.spec.keep is None:
            message = f"statement {statement.name} rests on an instant, and the study keeps no histories"
            places.append((("statements", number), message, "write e.g. `keep: {histories: {every: 1 ms}}`"))
    for path, message, hint in places:
        if is_file:
            message = f"{study.spec.statements}, statement {statements[int(path[1])].name}: {message}"
        question.problems.add_at(study.tree, path[:1] if is_file else path, message, hint)
    return statements


def _find_lost_histories(statement: StudyStatement, study: Study) -> Iterator[tuple[str, str]]:
    """Yield the cases, analyses and motions whose histories a statement names and the study does not keep, and what to
    write."""
    keep = study.spec.keep
    if keep is None or isinstance(keep, str) or isinstance(keep.histories, str):
        return
    scope = find_scope(study, whole=True)
    chosen = (
        ("cases", keep.histories.cases, scope.cases, "case"),
        ("analyses", keep.histories.analyses, scope.analyses, "analysis"),
        ("records", keep.histories.records, scope.motions, "motion"),
    )
    for comparison in statement.comparisons:
        for part in comparison.quantities:
            for key, kept, names, kind in chosen:
                place = getattr(part, kind)
                if part.instant is not None and kept is not None and place is not None and names[place] not in kept:
                    message = f"'{comparison}' rests on a history of {names[place]}, which is not kept"
                    yield message, f"write {names[place]} in `{key}` of `keep: histories`"


def _read_statements_of(question: StudyQuestion, file: str) -> tuple[Any, ...]:
    """Return the statements of another study file as they are validated.  Note that it has none."""
    from pounding_cli.study.file import read_study
    from pounding_cli.study.written import read_specs

    study = question.study
    path = study.path.resolve().parent / file
    try:
        _, tree = read_study(path)
    except InputError as error:
        question.problems.extend(error.problems)
        return ()
    issues = Issues()
    specs = read_specs(tree, issues, type(study.spec))
    found = specs.get(("statements",))
    if not isinstance(found, tuple) or not found:
        hint = "name a study file with a list under `statements:`"
        question.problems.add_at(study.tree, ("statements",), f"{file} has no list of statements", hint)
        return ()
    return found


QUESTION = Question(
    name="run",
    ask=Run,
    tables={STATEMENTS: STATEMENT_COLUMNS},
    sentences=LateFunction("pounding_cli.questions.run.words:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.run.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.run.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.run.figures:list_figures"),
    further_sections=LateFunction("pounding_cli.questions.run.figures:further_sections"),
)
"""`pound run`."""

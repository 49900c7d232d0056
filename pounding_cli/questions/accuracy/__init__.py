"""`pound accuracy`: error and time of every method on time histories of a study.

Its numbers are measured on this machine and stand on a page, not in a results file, so it is no `Question`; it has the
same parts: tables, sentences, notes, figures, references.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from pounding_cli.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.report.document import Report
    from pounding_cli.solver.work_precision import Subject, WorkPrecision
    from pounding_cli.study import Study


@dataclass(frozen=True, eq=False)
class Measurement:
    """Errors and times of methods on the time histories of a study.

    title : of the study
    command : that repeats it
    found : errors and times of all runs
    """

    title: str
    command: str
    found: WorkPrecision

    @cached_property
    def runs(self) -> pd.DataFrame:
        """The table of all runs, with the columns of `tables.RUN_COLUMNS`."""
        import pandas as pd

        from pounding_cli.questions.accuracy.tables import RUN_COLUMNS

        return pd.DataFrame(self.found.runs, columns=[column.name for column in RUN_COLUMNS])


def measure_accuracy(
    study: Study,
    methods: Sequence[str],
    cases: Sequence[str],
    records: Sequence[str],
    budget: float,
    command: str,
    tell: Callable[[str], None],
) -> Measurement:
    """Run methods on time histories of a study at the first point of its sweep.

    methods, cases, records : names; all where there are none
    budget : time for the runs [s]
    command : that repeats the measurement
    tell : called with the place of every time history before it is run

    Raises
    ------
    InputError : a name that is not there
    """
    from pounding_cli.solver.work_precision import measure, resolve_methods

    names = resolve_methods(methods)
    subjects = list_subjects(study, cases, records)
    return Measurement(study.title, command, measure(subjects, names, budget, tell))


def list_subjects(study: Study, cases: Sequence[str], records: Sequence[str]) -> list[Subject]:
    """Return the time histories of the group at the first point of a study's sweep, each once.

    Raises InputError for names that the study does not have.
    """
    from pounding_cli.study import make_plan

    plan = make_plan(study)
    for kind, wanted, known in (("case", cases, plan.cases), ("record", records, plan.records)):
        for name in set(wanted) - set(known):
            raise InputError(f"the study has no {kind} {name}", f"write one of {', '.join(known)}")
    subjects = []
    for number in range(math.prod(plan.shape[-3:])):
        row = plan.row(number)
        if row.case in (cases or plan.cases) and row.record in (records or plan.records):
            place = {"case": row.case, "analysis": row.analysis, "record": row.record}
            subjects.append((place, plan.scene(row.scene)))
    return subjects


def build_report(measurement: Measurement) -> Report:
    """Return the report of a measurement."""
    from pounding_cli.questions.accuracy.figures import list_figures
    from pounding_cli.questions.accuracy.words import list_notes, list_sentences, list_sources, list_tables
    from pounding_cli.report.document import Report, Section

    shown, runs = list_tables(measurement)
    return Report(
        f"What accuracy costs: {measurement.title}",
        Section("", list_sentences(measurement), [shown], notes=list_notes(measurement)),
        lambda: list_figures(measurement),
        lambda: [
            Section("Every run", tables=[runs], folded=True),
            Section("Sources", list_sources(measurement)),
        ],
    )

"""`pound drift`: the storey that drifts most, and whether its drift exceeds a limit."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated

from pounding_cli.batch.solve import Solver
from pounding_cli.numbers import Unit
from pounding_cli.questions.frames import PLACE_COLUMNS, list_swept_columns
from pounding_cli.questions.question import Answer, Question, StudyQuestion
from pounding_cli.results.results import ResultTables
from pounding_cli.study import Plan, make_plan
from pounding_cli.study.schema.base import Model, spec_field
from pounding_cli.study.schema.quantity import Quantity
from pounding_cli.study.schema.study import StudySection
from pounding_cli.tables import Column, Table, build_table

PERCENT = Unit("%", 0.01, "1")

DRIFT_COLUMNS = (
    *PLACE_COLUMNS,
    Column("drift", "largest interstorey drift of all motions, over the height of the storey", PERCENT, digits=3),
    Column("limit", "drift that the study allows", PERCENT, digits=3),
    Column("exceeded", "whether the drift is larger"),
)


class DriftSpec(Model):
    """Settings of `pound drift`."""

    limit: Annotated[float, Quantity("interstorey drift", "", "2 %", 0.0, 1.0, open_low=True, percent=True)] = (
        spec_field("2 %", "largest interstorey drift that is allowed, of the storey height")
    )


class Drift(StudyQuestion):
    """The storey that drifts most, in every case and analysis."""

    name = "drift"
    spec: DriftSpec

    @cached_property
    def plan(self) -> Plan:
        """All time histories of the study."""
        return make_plan(self.study)

    def answer(self, solver: Solver) -> Answer:
        """Return the largest drift of every building, and the storey in which it occurs."""
        arrays = solver.solve_arrays(self.plan)
        storeys = ResultTables(Path(self.study.path), arrays).storey("drift_ratio")
        place = [*storeys.columns[: list(storeys.columns).index("record")], "building"]
        known = storeys[storeys["drift_ratio"].notna()]  # not so where a storey collapsed, or the run failed
        largest = known.groupby(place, sort=False)["drift_ratio"].idxmax()
        rows = known.loc[largest, [*place, "storey", "drift_ratio"]]
        rows = rows.rename(columns={"drift_ratio": "drift"}).reset_index(drop=True)
        rows["limit"] = self.spec.limit
        rows["exceeded"] = rows["drift"] > self.spec.limit
        columns = [*list_swept_columns(self.plan.axes), *DRIFT_COLUMNS]
        return Answer(self.plan, arrays, [build_table("drift", rows, columns, caption="Largest interstorey drifts")])


def list_sentences(results: ResultTables) -> Sequence[str]:
    """Return which storey drifts most, and whether that is too much."""
    table = results.answer("drift")
    if table.frame.empty:
        return ["No interstorey drift is known: every time history failed or ended with a collapse."]
    row = table.frame.loc[table.frame["drift"].idxmax()].to_dict()
    drift = table.column("drift").format_with_unit(row)
    limit = table.column("limit").format_with_unit(row)
    verdict = f"more than the {limit} that are allowed" if row["exceeded"] else f"within the {limit} that are allowed"
    point = "".join(f", {key} = {results.value_label(key, row[key])}" for key in results.axes)
    where = f"storey {row['storey']} of {row['building']}, case {row['case']}, {row['analysis']}{point}"
    return [f"The largest interstorey drift is {drift} ({where}), {verdict}."]


def list_tables(results: ResultTables) -> Sequence[Table]:
    """Return the table of drifts."""
    return [results.answer("drift")]


QUESTION = Question(
    name="drift",
    ask=Drift,
    section=StudySection("drift", DriftSpec, "settings of `pound drift`"),
    tables={"drift": DRIFT_COLUMNS},
    sentences=list_sentences,
    shown_tables=list_tables,
)

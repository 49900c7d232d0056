"""The question of `pound gap` asked of one study: how wide must the gaps be, and are those of the cases enough?"""

from __future__ import annotations

import dataclasses
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.laws.apart import Apart
from pounding_cli.model.links import Link
from pounding_cli.questions.gap.apart import build_apart_study, find_street_places, link_all_facing
from pounding_cli.questions.gap.cases import build_cases_table
from pounding_cli.questions.gap.codes import build_codes_table
from pounding_cli.questions.gap.edges import EdgeMovements, EdgePlan, build_edge_plans
from pounding_cli.questions.gap.neighbours import build_neighbour_tables, drop_axis, select_median
from pounding_cli.questions.gap.separations import build_distances, build_separations
from pounding_cli.questions.gap.spec import GapSpec
from pounding_cli.questions.gap.statistics import build_statistics_table
from pounding_cli.questions.gap.tables import GAP_TABLE, LINE_TABLE
from pounding_cli.questions.gap.written_gaps import add_written_gaps
from pounding_cli.questions.neighbours import build_neighbour_axis
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.construct.swept import Swept, sweep_map

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.batch.solve import Solver
    from pounding_cli.questions.gap.rate import RateBasis
    from pounding_cli.questions.hazard import Hazard
    from pounding_cli.questions.specs import Measure
    from pounding_cli.tables import Table


class Gap(StudyQuestion):
    """The required separations of all neighbours over the motions.

    Raises InputError: a rate of contact without an intensity, or without its hazard curve; no neighbours that face each
    other.

    apart : the study with nothing between its buildings; swept keys of links are left out, those of buildings and
        motions stay
    neighbours : its last axis, of what neighbours may be that are only seen; None where all buildings are certain
    intensity_axis : number of its axis that varies the intensity; None of one intensity
    intensities : of the motions [SI], of a study with a hazard curve; empty of others
    hazard : how often a year an intensity is exceeded; None where the study does not say it
    """

    name = "gap"
    spec: GapSpec

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        self.apart = build_apart_study(study)
        self.neighbours = build_neighbour_axis(self)
        self.problems.check()
        if self.neighbours is not None:
            self.apart = self.apart.with_axes([*self.apart.axes, self.neighbours])
        self.intensity_axis: int | None = None
        self.intensities = np.zeros(0)
        self.hazard: Hazard | None = None
        if not any(links for _, links in self.links.iter_values()):
            message = "no two neighbours share an edge along the street, so no gap between them can close"
            self.problems.add_at(study.tree, ("group",), message, "let their plans overlap along the street (`shift:`)")
            self.problems.check()
        if self.spec.hazard is not None:
            self._read_hazard()

    def _read_hazard(self) -> None:
        """Find the intensities of the motions and how often they are exceeded.  Raises InputError."""
        from pounding_cli.questions.hazard import build_hazard, find_intensity_axis  # with scipy: few studies need it

        self.intensity_axis = find_intensity_axis(self, self.apart.axes)
        scaled = self._find_swept_intensity() or self._find_written_intensity()
        if scaled is None:
            hint = "write e.g. `scale: {sa: 0.4 g, period: 0.5 s}` in `records`, and sweep `records.scale.sa`"
            asking = "hazard" if self.spec.rate is None else "rate"
            self.add_problem((asking,), "a rate needs motions that are scaled to an intensity", hint, key=True)
        self.problems.check()
        assert scaled is not None
        measure, intensities = scaled
        self.intensities = np.array(intensities, float)
        self.hazard = build_hazard(self, measure)

    def _find_swept_intensity(self) -> tuple[Measure, list[Any]] | None:
        """Return the intensity measure that is swept, and its values [SI]; None where none is."""
        from pounding_cli.questions.specs import Measure
        from pounding_cli.study.schema.records import INTENSITY_KEYS

        if self.intensity_axis is None:
            return None
        axis = self.apart.axes[self.intensity_axis]
        return Measure(INTENSITY_KEYS.get(axis.names[0], "pga")), [values[0] for values in axis.values]

    def _find_written_intensity(self) -> tuple[Measure, list[Any]] | None:
        """Return the intensity measure that the motions are scaled to, and its value [SI]; None where there is none."""
        from pounding_cli.questions.specs import Measure
        from pounding_cli.study.schema.records import En1998Spec, PgaSpec, PgvSpec, SaSpec, SpectrumSpec

        scale = self.study.spec.records.scale
        if isinstance(scale, SpectrumSpec) and isinstance(scale.target, En1998Spec):
            return Measure("ag"), [scale.target.ag]
        if not isinstance(scale, PgaSpec | PgvSpec | SaSpec):
            return None
        name = type(scale).__name__.removesuffix("Spec").lower()
        return Measure(name, getattr(scale, "period", 0.0)), [getattr(scale, name)]

    @cached_property
    def links(self) -> Swept[tuple[Link, ...]]:
        """The links without force between all floors that face each other."""
        link = partial(link_all_facing, street_places=find_street_places(self.study))
        return sweep_map(link, self.apart.parts.group)

    @cached_property
    def plan(self) -> Plan:
        """The time histories of every motion and analysis, with nothing between the buildings."""
        return make_plan(self.apart, dataclasses.replace(self.apart.parts, links={Apart.name: self.links}))

    @cached_property
    def edge_plans(self) -> list[EdgePlan]:
        """The time histories that tell how far floors that twist move beside their centres of mass."""
        return build_edge_plans(self.apart, self.links)

    @property
    def expected_count(self) -> int:
        return len(self.plan) + sum(each.numbers.size for each in self.edge_plans)

    def answer(self, solver: Solver) -> Answer:
        """Return what is required, what that means for the cases, and the distances to property lines."""
        plan = self.plan
        arrays = solver.solve_arrays(plan)
        edges = EdgeMovements(self.apart, self.edge_plans, solver)
        separations = build_separations(plan, self.spec, arrays, edges)
        distances = build_distances(plan, self.spec, arrays, edges)
        basis = self._build_rate_basis(separations)
        of_neighbours: list[Table] = []
        if self.neighbours is not None:
            of_neighbours = build_neighbour_tables(self.study, plan, separations, basis)
            separations = select_median(separations, len(self.neighbours))
            distances = select_median(distances, len(self.neighbours))
        tables = [
            build_statistics_table(plan, GAP_TABLE, self.spec, separations),
            build_cases_table(self.study, plan, separations),
            build_codes_table(plan, separations, basis),
            build_statistics_table(plan, LINE_TABLE, self.spec, distances),
        ]
        if basis is not None and self.spec.rate is not None:
            from pounding_cli.questions.gap.rate import build_rate_table

            tables.append(build_rate_table(plan, basis, self.spec.rate))
        if self.neighbours is not None:
            tables = [drop_axis(table, self.neighbours.names) for table in tables]
        return Answer(plan, add_written_gaps(arrays, self.study), [*tables, *of_neighbours])

    def _build_rate_basis(self, separations: pd.DataFrame) -> RateBasis | None:
        """Return what annual rates of contact follow from; None without a hazard curve."""
        if self.hazard is None:
            return None
        from pounding_cli.questions.gap.rate import build_rate_basis  # with scipy: few studies need it

        buildings = 1 if self.neighbours is None else len(self.neighbours)
        return build_rate_basis(self.plan, self.intensity_axis, self.intensities, self.hazard, separations, buildings)

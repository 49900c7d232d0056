"""A study at one point: what checks look at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.building import Building
from pounding_cli.study.check.values import Written
from pounding_cli.study.construct.complete_links import CompleteLink
from pounding_cli.study.construct.group import Group
from pounding_cli.study.construct.motions import Suite
from pounding_cli.study.construct.resolve import StudyParts, tree_at
from pounding_cli.study.construct.swept import Point
from pounding_cli.study.schema.building import BuildingSpec
from pounding_cli.study.schema.like import resolve_all_likes
from pounding_cli.study.schema.links import ImpactSpec
from pounding_cli.study.schema.records import RecordsSpec
from pounding_cli.study.text.file import Map
from pounding_cli.study.vary.axes import Axis, sweep_maps


@dataclass(frozen=True, eq=False)
class View:
    """A study at a point of some axes.

    base : its file, without the values of the axes
    axes : of its sweep, or others in their place
    parts : its parts at the points of these axes
    needs_units : whether a number should have its unit, as in a file; in Python data numbers are SI
    """

    base: Map
    axes: Sequence[Axis]
    parts: StudyParts
    needs_units: bool
    point: Point = ()

    def at(self, point: Point) -> View:
        """Return the study at another point."""
        return replace(self, point=point)

    @cached_property
    def written(self) -> Written:
        """The file at the point with every `like:` resolved, made when it is first asked for: most points need none."""
        return Written(resolve_all_likes(tree_at(self.base, self.axes, self.point)), self.needs_units)

    @property
    def where(self) -> str:
        """The point in words."""
        return ", ".join(axis.format_point(index) for axis, index in zip(self.axes, self.point, strict=True))

    @property
    def group(self) -> Group:
        """The buildings in their places."""
        return self.parts.group.value_at(self.point)

    @property
    def impact(self) -> ImpactSpec:
        """The section `impact`."""
        return self.parts.impact.value_at(self.point)

    @property
    def records(self) -> RecordsSpec:
        """The section `records`."""
        return self.parts.records.value_at(self.point)

    @property
    def suite(self) -> Suite:
        """The motions as they are used."""
        return self.parts.suite.value_at(self.point)

    @property
    def is_swept_pga(self) -> bool:
        """True if the peak that motions are scaled to is swept."""
        return any("records.scale.pga" in holder for holder in sweep_maps(self.base))

    def building_spec(self, name: str) -> BuildingSpec:
        """Return the section of a building type."""
        return self.parts.building_specs[name].value_at(self.point)

    def building(self, name: str) -> Building:
        """Return a building type."""
        return self.parts.types[name].value_at(self.point)

    def links_of(self, case: str) -> Sequence[CompleteLink]:
        """Return the links of a case, as they are written and completed."""
        return self.parts.complete_links[case].value_at(self.point)

    def laws_of(self, case: str) -> Sequence[LinkLaw | None]:
        """Return the laws of the links of a case; None of no link."""
        return self.parts.link_laws[case].value_at(self.point)

"""The bumper wall of Fig. 8: plane stress and frame elements, struck by a floor.

`study` has its keys, `impact` solves it, `figures` draws it; here are its numbers, sentences and references.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from pounding_cli.numbers import Unit, pluralize
from pounding_cli.paper.points import PointAnswer, PointCommand, SweepPoint, describe_extremes
from pounding_cli.paper.wall.study import WallStudySpec
from pounding_cli.tables import Column

if TYPE_CHECKING:
    from pounding_cli.report.document import Picture

_FORCE = Unit("kN", 1e3, "N")
_IMPULSE = Unit("kN s", 1e3, "N s")
_MOMENT = Unit("kN m", 1e3, "N m")
_STRESS = Unit("N/mm²", 1e6, "N/m2")
_TIME = Unit("ms", 1e-3, "s")

WALL_COLUMNS = (
    Column("peak_force", "largest contact force", _FORCE, "force"),
    Column("peak_time", "time of the largest contact force", _TIME, "at"),
    Column("separation", "first time the striker leaves the wall", _TIME),
    Column("last_contact", "last time the striker pushes", _TIME, "last contact"),
    Column("impulse", "impulse of the contact force", _IMPULSE),
    Column("energy_residual", "largest open part of the energy balance, over the first energy", Unit("", 1.0, "1"),
           "energy left open"),
    Column("wall_stress", "largest von Mises stress of an element", _STRESS, "stress of an element", optional=True),
    Column("averaged_stress", "largest von Mises stress, averaged over the length stated", _STRESS, "stress"),
    Column("beam_stress", "largest edge stress of the beams", _STRESS, "stress of beams"),
    Column("beam_stress_then", "largest edge stress of the beams at the instant of the wall's peak", _STRESS,
           "stress of beams then"),
    Column("column_stress", "largest edge stress of the columns", _STRESS, "stress of columns"),
    Column("column_stress_then", "largest edge stress of the columns at the instant of the wall's peak", _STRESS,
           "stress of columns then"),
    Column("wall_shear", "largest shear force in a cross-section of the wall", _FORCE, "shear of the wall"),
    Column("wall_moment", "largest bending moment in a cross-section of the wall", _MOMENT, "moment of the wall"),
    Column("reach", "farthest from the contact that the averaged stress exceeds half its largest", Unit("m", 1.0, "m")),
    Column("step", "time step", _TIME, "time step"),
    Column("freedoms", "degrees of freedom", Unit("", 1.0, "1"), "degrees of freedom", digits=0),
    Column("time_of_peak", "instant of the largest stress of an element", _TIME, "time of the stress"),
)  # fmt: skip
"""The numbers of a point."""

SHOWN_COLUMNS = ("peak_force", "separation", "averaged_stress", "wall_stress")
"""Those that a terminal prints; the page and the CSV table have all."""


def solve_wall(study: WallStudySpec) -> PointAnswer:
    """Return the answer of one impact, as `impact.solve_impact`."""
    from pounding_cli.paper.wall import impact  # here: `pound check` needs the study alone

    return impact.solve_impact(study)


def list_wall_sentences(points: Sequence[SweepPoint]) -> list[str]:
    """Return the largest force and stress, and when the striker leaves the wall."""
    force, stress = (describe_extremes(points, COMMAND.column(name)) for name in ("peak_force", "averaged_stress"))
    lengths = {point.study.averaging_length for point in points}
    averaged = f"{lengths.pop():g} m" if len(lengths) == 1 else "the averaging length"
    answer = f"The largest contact force is {force}; the largest von Mises stress, mean over {averaged}, is {stress}."
    return [f"{answer} {_describe_separation(points)}"]


def _describe_separation(points: Sequence[SweepPoint]) -> str:
    """Return when free strikers leave the wall, and when glued ones begin to pull at it."""
    free = [point for point in points if point.study.contact.bond == "unilateral"]
    glued = [point for point in points if point.study.contact.bond == "glued"]
    sentences = []
    if free:
        sentences.append(_describe_end(free, "The striker leaves the wall", "it does not leave it"))
    if glued:
        sentences.append(_describe_end(glued, "The glued striker begins to pull", "it does not pull"))
    return " ".join(sentences)


def _describe_end(points: Sequence[SweepPoint], ends: str, never: str) -> str:
    """Return when the striker pushes no more in words; at how many points that is not so before the end."""
    column = COMMAND.column("separation")
    ending = [point for point in points if math.isfinite(point.numbers[column.name])]
    pushing_count = len(points) - len(ending)
    if not ending:
        return f"{ends} at no time before the end of the analysis."
    text = f"{ends} after {describe_extremes(ending, column)}"
    if pushing_count:
        return f"{text}; at {pluralize(pushing_count, 'point')} {never} before the end of the analysis."
    return f"{text}."


def cite_wall(_study: WallStudySpec) -> Iterator[tuple[str, str]]:
    """Yield the references of a study, each with what for."""
    yield "spiliopoulos1996", "the bumper wall, Fig. 8"
    yield "anagnostopoulos1992", "bumper walls"
    yield "gustafsson2020", "the plane-stress elements of the wall"
    yield "wood1980", "the time integration"


def _figures(title: str, points: Sequence[SweepPoint]) -> list[Picture]:
    from pounding_cli.paper.wall.figures import list_wall_figures

    return list_wall_figures(title, points)


COMMAND = PointCommand(
    name="wall",
    spec=WallStudySpec,
    solve=solve_wall,
    columns=WALL_COLUMNS,
    shown_columns=SHOWN_COLUMNS,
    sentences=list_wall_sentences,
    figures=_figures,
    cite=cite_wall,
)
"""`pound wall`."""

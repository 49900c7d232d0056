"""From validated sections to buildings and their group: stiffness and yield shears derived, floors that meet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from pounding_cli.laws import storey_laws
from pounding_cli.model.building import Building, Foundation, weight_above
from pounding_cli.model.code_design import BaseShearDesign, Design, UbcDesign
from pounding_cli.model.links import BASE
from pounding_cli.model.meetings import Strike, meetings
from pounding_cli.model.separation import ASCE7, EN1998, UBC, asce7_displacement, en1998_displacement
from pounding_cli.model.stiffness import frequencies, rayleigh_factors, stiffness_for_period
from pounding_cli.model.wall import ENDLESS, Wall
from pounding_cli.numbers import counted, listed
from pounding_cli.study.file import Problems, Steps, nearest
from pounding_cli.study.laws import own
from pounding_cli.study.models import BaseShear, StiffnessAt
from pounding_cli.study.quantity import StoreyMultiple

COLUMNS = (
    "or write `columns:`, what part of a storey's stiffness and yield shear the columns have that the other's slab "
    "strikes, e.g. `columns: 20 %`"
)
"""What to write where slabs strike columns."""


def tell_left_out(group: Sequence[Building], root: Any, path: Steps, notes: Problems) -> None:
    """Note the floors of every pair of neighbours whose slabs strike columns of which nothing is known."""
    for place, pair in enumerate(pairwise(group)):
        floors, strikes = meetings(*pair)
        unknown = [strike for strike in strikes if pair[strike.side].columns is None]
        if unknown:
            told = listed(f"floor {strike.slab} of {pair[1 - strike.side].name}" for strike in unknown)
            struck = " and ".join(sorted({pair[strike.side].name for strike in unknown}))
            where = f"meet at {counted(len(floors), 'floor')} only" if floors else "meet at no floor"
            message = f"{pair[0].name} and {pair[1].name} {where}: blows on columns are left out of {told}"
            hint = f"give both the same `height:`, a `slab:` thick enough to meet, {COLUMNS} in {struck}"
            notes.at(root, (*path, place + 1), message, hint)


def meetings_in_words(group: Sequence[Building]) -> list[str]:
    """Every meeting of neighbours, a line each from the ground up: slabs that meet, slabs that strike columns, and
    blows that are left out. Floors that all meet those of their number share a line."""
    lines = []
    for left, right in pairwise(group):
        pair, (floors, strikes) = f"{left.name}|{right.name}  ", meetings(left, right)
        if isinstance(left, Wall) or isinstance(right, Wall):
            named = ", ".join(f"floor {floor}" if floor else BASE for floor, _ in floors)
            lines.append(f"{pair}the wall meets {named}")
            continue
        if not strikes and len(floors) > 1 and all(i == j for i, j in floors):
            first, last = floors[0][0], floors[-1][0]
            heights = f"{left.level(first):g} to {left.level(last):g} m"
            lines.append(f"{pair}{heights}: floors {first} to {last} meet those of the same number")
            continue
        found = [(left.level(i), f"floor {i} meets floor {j}") for i, j in floors]
        for strike in strikes:
            columns, slab = (left, right)[strike.side], (right, left)[strike.side]
            said = f"floor {strike.slab} of {slab.name} strikes columns of {columns.name} in storey {strike.storey}"
            said += f", at {100 * strike.at:.3g} % of its height"
            left_out = f"left out: {said}; write `columns:` in {columns.name}"
            share = f"{said}, {100 * (columns.columns or 0.0):.3g} % of the storey"
            found.append((slab.level(strike.slab), left_out if columns.columns is None else share))
        lines += [f"{pair}{height:g} m: {said}" for height, said in sorted(found)]
    return lines


MOST_IN_GROUP = 20


def building(name: str, spec: Any) -> Building:
    """The building that a section describes.  Raises ValueError, UnstableError where it cannot stand."""
    if spec.wall is not None:
        return _wall(name, spec.wall)
    mass, height, hardening = (_filled(getattr(spec, key), spec.count) for key in ("mass", "height", "hardening"))
    if spec.stiffness is None:
        stiffness, period = stiffness_for_period(mass, spec.period, spec.taper), spec.period
    else:
        if isinstance(spec.stiffness, StiffnessAt):
            at = _filled(spec.stiffness.mass, spec.count)
            stiffness = stiffness_for_period(at, spec.stiffness.period, spec.taper)
        else:
            stiffness = np.array(spec.stiffness)
        period = 2 * np.pi / float(frequencies(mass, stiffness)[0])
    if spec.yield_shear is None:
        yield_shear = spec.yield_.overstrength * _design(spec.yield_).yield_shears(mass, height, period)
    else:
        yield_shear = np.full(spec.count, np.inf) if spec.yield_shear == "never" else np.array(spec.yield_shear)
    given = spec.rayleigh
    alpha, beta = (given.alpha, given.beta) if given else rayleigh_factors(mass, stiffness, spec.damping)
    law, base = storey_laws()[spec.storey_law], spec.foundation
    load = (weight_above(mass) if spec.p_delta else None) if isinstance(spec.p_delta, bool) else np.array(spec.p_delta)
    below = None
    if base != "fixed":
        isolation = None if base.isolation is None else base.isolation.law
        sways, rocks = base.sways, base.rocking_stiffness is not None
        below = Foundation(
            base.mass, base.sway_stiffness or 0.0, base.sway_damping,
            base.inertia, base.rocking_stiffness or 0.0, base.rocking_damping, sways, rocks,
            isolation,
        )  # fmt: skip
    parameters = tuple((key, value) for key in own(law) if (value := getattr(spec, key)) is not None)
    collapse = np.inf if isinstance(spec.collapse, str) else spec.collapse
    return Building(
        name, mass, height, stiffness, yield_shear, hardening, float(alpha), float(beta), below, law, parameters, load,
        collapse, spec.slab, spec.columns,
    )  # fmt: skip


def _wall(name: str, spec: Any) -> Wall:
    if spec == "fixed":
        return Wall.of(name)
    height = ENDLESS if spec.height is None else spec.height
    if spec.stiffness is None:
        return Wall.of(name, height)
    return Wall.of(name, height, spec.mass, spec.stiffness, spec.damping)


def _filled(value: Any, storeys: int) -> np.ndarray:
    return np.array(value) if isinstance(value, tuple) else np.full(storeys, float(value))


def _design(code: Any) -> Design:
    """What sets the yield shears."""
    if isinstance(code, BaseShear):
        return BaseShearDesign(code.base_shear, code.distribution)
    known = {key: value for key in ("rw", "k") if (value := getattr(code, key)) is not None}
    return UbcDesign(int(code.code[-4:]), code.zone, code.soil, code.importance, **known)


def code_displacements(spec: Any, building: Building) -> dict[str, np.ndarray]:
    """The displacement that a code expects, by the name of its rule [m], shape (n,), from the ground up; without the
    rules whose factors the study does not give.

    All follow from the static displacements under the design forces: those of the UBC times
    `UbcDesign.amplification`, delta_M and d_s from the forces of `base_shear` and `distribution`.
    """
    if spec.wall is not None or spec.yield_shear is not None:
        return {}
    code, design, found = spec.yield_, _design(spec.yield_), dict[str, np.ndarray]()
    elastic = design.displacements(building.mass, building.height, building.stiffness, float(building.periods[0]))
    if isinstance(design, UbcDesign):
        return {UBC: design.amplification * elastic}
    if code.cd is not None and code.ie is not None:
        found[ASCE7] = asce7_displacement(elastic, code.cd, code.ie)
    if code.qd is not None:
        found[EN1998] = en1998_displacement(elastic, code.qd)
    return found


def separation(left: np.ndarray | None, right: np.ndarray | None) -> float | None:
    """Code separation of two neighbours at the lower roof [m], the sum of their displacements by the UBC there (clauses
    of `UbcDesign.amplification`; the paper's "sum of the design maximum displacements"); None where one has none."""
    if left is None or right is None:
        return None
    lower = min(left.size, right.size) - 1
    return float(left[lower] + right[lower])


def places(names: Sequence[str]) -> tuple[str, ...]:
    """Names by place: a type that stands more than once is told apart by a number (soft-1, soft-2)."""
    return tuple(
        f"{name}-{list(names[: n + 1]).count(name)}" if list(names).count(name) > 1 else name
        for n, name in enumerate(names)
    )


@dataclass(frozen=True, eq=False)
class Group:
    """The buildings by place and by name; of each pair of neighbours the floors that meet, and slabs that strike
    columns whose share of the storey is known."""

    buildings: tuple[Building, ...]
    types: Mapping[str, Building]
    common: tuple[dict[int, int], ...]
    strikes: tuple[tuple[Strike, ...], ...]

    @classmethod
    def of(cls, names: Sequence[str], types: Mapping[str, Building]) -> Group:
        placed = tuple(
            b if (b := types[name]).name == label else replace(b, name=label)
            for name, label in zip(names, places(names), strict=True)
        )
        roof = max((float(b.elevation[-1]) for b in placed if not isinstance(b, Wall)), default=0.0)
        placed = tuple(b.up_to(roof) if isinstance(b, Wall) else b for b in placed)
        return cls.of_buildings(placed, types)

    @classmethod
    def of_buildings(cls, placed: tuple[Building, ...], types: Mapping[str, Building]) -> Group:
        """The group of buildings by place."""
        pairs = list(pairwise(placed))
        common = tuple(dict(meetings(*pair)[0]) for pair in pairs)
        strikes = tuple(tuple(s for s in meetings(*pair)[1] if pair[s.side].columns is not None) for pair in pairs)
        return cls(placed, types, common, strikes)

    def stiffness(self, given: Any) -> float:
        """A stiffness in N/m.  Raises KeyError for a building that is not defined."""
        if not isinstance(given, StoreyMultiple):
            return given
        named = self.buildings if given.building is None else (self.types[given.building],)
        some = [b for b in named if not isinstance(b, Wall)] or named
        stiffest = given.which == "stiffest"
        each = (max(k) if stiffest else sum(k) / len(k) for k in (b.stiffness.tolist() for b in some))
        return given.factor * max(each)


def check_group(names: Sequence[str], defined: Sequence[str], root: Any, problems: Problems) -> bool:
    """Whether the names of a group are sound; what is wrong is noted."""
    before, count, labels = len(problems.found), len(names), places(names)
    if not 2 <= count <= MOST_IN_GROUP:
        example = ", ".join((*defined, *defined)[:2])
        hint = f"name 2 to {MOST_IN_GROUP}, e.g. `group: [{example}]`; each alone is computed anyway"
        problems.at(root, ("group",), f"the group has {counted(count, 'building')}: pounding takes two", hint)
        return False
    for place, (name, label) in enumerate(zip(names, labels, strict=True)):
        if name not in defined:
            problems.at(root, ("group", place), f"no building '{name}' is defined", nearest(name, defined))
        if labels.index(label) != place:
            what = f"two places of the group are called '{label}'"
            problems.at(root, ("group", place), what, "give the building another name")
    return len(problems.found) == before


def check_meetings(group: Group, root: Any, problems: Problems) -> bool:
    """Whether all neighbours can strike each other; what is wrong is noted."""
    before = len(problems.found)
    for place, (floors, strikes) in enumerate(zip(group.common, group.strikes, strict=True)):
        if not floors and not strikes:
            one, other = group.buildings[place : place + 2]
            levels = (listed(f"{each:g}" for each in b.elevation) for b in (one, other))
            message = f"{one.name} and {other.name} have no floor at one elevation: {' against '.join(levels)} m"
            hint = f"let the storey heights agree somewhere; {COLUMNS}"
            problems.at(root, ("group", place + 1), message, hint)
    return len(problems.found) == before

"""From validated sections to buildings and their group: stiffness and yield shears derived, floors that meet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from pounding_cli.laws import storey_laws
from pounding_cli.model.building import Building, weight_above
from pounding_cli.model.code_design import BaseShearDesign, UbcDesign, code_separation
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import BASE
from pounding_cli.model.meetings import Strike, meetings
from pounding_cli.model.separation import ASCE7, EN1998, asce7_displacement, en1998_displacement
from pounding_cli.model.stiffness import frequencies, rayleigh_factors, stiffness_for_period
from pounding_cli.model.wall import ENDLESS, Wall
from pounding_cli.numbers import counted
from pounding_cli.study.file import Problems, Steps, nearest
from pounding_cli.study.laws import own
from pounding_cli.study.models import BaseShear, StiffnessAt
from pounding_cli.study.quantity import Storey

COLUMNS = (
    "or write `columns:`, what part of a storey's stiffness and yield shear the columns have that the other's slab "
    "strikes, e.g. `columns: 20 %`"
)
"""What to write where slabs strike columns."""


def facing(left: Building, right: Building) -> tuple[tuple[tuple[int, int], ...], tuple[Strike, ...]]:
    """Floors of `left` and `right`, from 1, that meet, and slabs that strike columns whose share of the storey is
    known."""
    floors, strikes = meetings(left, right)
    return floors, tuple(strike for strike in strikes if (left, right)[strike.side].columns is not None)


def left_out(left: Building, right: Building) -> tuple[list[int], list[int]]:
    """Floors of `left` and of `right`, from 1, whose slabs strike columns of which nothing is known."""
    found: tuple[list[int], list[int]] = [], []
    for strike in meetings(left, right)[1]:
        if (left, right)[strike.side].columns is None:
            found[1 - strike.side].append(strike.slab)
    return found


def tell_left_out(
    group: Sequence[Building], common: Sequence[Mapping[int, int]], root: Any, path: Steps, notes: Problems
) -> None:
    """Note the floors of every pair of neighbours that are left out."""
    for place, ((left, right), pairs) in enumerate(zip(pairwise(group), common, strict=True)):
        floors = left_out(left, right)
        if not any(floors):
            continue
        strikers = [(own, building) for own, building in zip(floors, (left, right), strict=True) if own]
        struck = [building.name for own, building in zip(floors, (right, left), strict=True) if own]
        alone = " and ".join(f"{_floors(own)} of {building.name}" for own, building in strikers)
        meets = ", ".join(
            f"{one}" if one == other else f"{one} with {other}" for one, other in _some(list(pairs.items()))
        )
        where = f"{counted(len(pairs), 'floor')} only ({meets})" if pairs else "no floor"
        count = sum(map(len, floors))
        notes.at(
            root,
            (*path, place + 1),
            f"{left.name} and {right.name} meet at {where}: {alone} "
            f"{'meets' if count == 1 else 'meet'} no floor and {'is' if count == 1 else 'are'} simulated as never "
            "touching",
            f"give both the same `height:`, a `slab:` thick enough to meet, {COLUMNS} in {' and '.join(struck)}; "
            "as it stands the results are those of buildings that touch nowhere else",
        )


def _floors(numbers: Sequence[int]) -> str:
    """Floors in words: `floor 3`, `floors 1 to 6`, `floors 1, 2 and 4 to 6`."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [word for run in runs for word in ([f"{run[0]} to {run[-1]}"] if len(run) > 2 else map(str, run))]
    listed = ", ".join(words[:-1]) + (" and " if len(words) > 1 else "") + words[-1]
    return f"floor{'s' if len(numbers) > 1 else ''} {listed}"


def _some(pairs: Sequence[tuple[int, int]], most: int = 6) -> list[tuple[int | str, int | str]]:
    return [*pairs[:most], *([("...", "...")] if len(pairs) > most else [])]


def meetings_in_words(group: Sequence[Building]) -> list[str]:
    """Every meeting of neighbours, a line each from the ground up: slabs that meet, slabs that strike columns, and
    blows that are left out. Floors of one number that meet one above the other share a line."""
    lines = []
    for left, right in pairwise(group):
        floors, strikes = meetings(left, right)
        if isinstance(left, Wall) or isinstance(right, Wall):
            named = ", ".join(f"floor {floor}" if floor else BASE for floor, _ in floors)
            lines.append(f"{left.name}|{right.name}  the wall meets {named}")
            continue
        found = [(float(left.elevation[i - 1]), "", (i, j)) for i, j in floors]
        for strike in strikes:
            columns, slab = (left, right)[strike.side], (right, left)[strike.side]
            height = float(slab.elevation[strike.slab - 1])
            said = f"floor {strike.slab} of {slab.name} strikes columns of {columns.name} in storey {strike.storey}"
            where = f"at {100 * strike.at:.3g} % of its height"
            if columns.columns is None:
                said = f"left out: {said}, {where}; write `columns:` in {columns.name}"
            else:
                said = f"{said}, {where}, {100 * columns.columns:.3g} % of the storey"
            found.append((height, said, (0, 0)))
        lines += [f"{left.name}|{right.name}  {line}" for line in _from_the_ground(found)]
    return lines


def _from_the_ground(found: list[tuple[float, str, tuple[int, int]]]) -> list[str]:
    """Lines by height; `found`: height [m], what is said, or "" for the pair of floors that meet."""
    lines: list[str] = []
    run: list[tuple[float, int]] = []
    for height, said, (one, other) in [*sorted(found), (0.0, "end", (0, 0))]:
        if run and not (said == "" and one == other == run[-1][1] + 1):
            heights = f"{run[0][0]:g} m" if len(run) == 1 else f"{run[0][0]:g} to {run[-1][0]:g} m"
            first, last = run[0][1], run[-1][1]
            both = f"floors {first} to {last} meet those of the same number"
            lines.append(f"{heights}: {both if first < last else f'floor {first} meets floor {first}'}")
            run = []
        if said == "" and one == other:
            run.append((height, one))
        elif said == "":
            lines.append(f"{height:g} m: floor {one} meets floor {other}")
        elif said != "end":
            lines.append(f"{height:g} m: {said}")
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


def _design(code: Any) -> UbcDesign | BaseShearDesign:
    """What sets the yield shears."""
    if isinstance(code, BaseShear):
        return BaseShearDesign(code.base_shear, code.distribution)
    known = {key: value for key in ("rw", "k") if (value := getattr(code, key)) is not None}
    return UbcDesign(int(code.code[-4:]), code.zone, code.soil, code.importance, **known)


def design_displacements(spec: Any, building: Building) -> np.ndarray | None:
    """Design displacements by the code that set the yield shears [m], shape (n,); None without one."""
    if spec.wall is not None or spec.yield_shear is not None or isinstance(spec.yield_, BaseShear):
        return None
    design, period = _design(spec.yield_), float(building.periods[0])
    assert isinstance(design, UbcDesign)
    return design.design_displacements(building.mass, building.height, building.stiffness, period)


def code_displacements(spec: Any, building: Building) -> dict[str, np.ndarray]:
    """The displacement that a code expects, by the name of its rule [m], shape (n,), from the ground up; without the
    rules whose factors the study does not give.

    delta_M and d_s follow from the static displacements under the forces of `base_shear` and `distribution`.
    """
    code = spec.yield_ if spec.yield_shear is None else None
    if not isinstance(code, BaseShear):
        return {}
    design, found = BaseShearDesign(code.base_shear, code.distribution), {}
    mass, height, stiffness = building.mass, building.height, building.stiffness
    elastic = design.elastic_displacements(mass, height, stiffness, float(building.periods[0]))
    if code.cd is not None and code.ie is not None:
        found[ASCE7] = asce7_displacement(elastic, code.cd, code.ie)
    if code.qd is not None:
        found[EN1998] = en1998_displacement(elastic, code.qd)
    return found


def separation(left: np.ndarray | None, right: np.ndarray | None) -> float | None:
    """Code separation of two neighbours at the lower roof [m]; None where no code designed one."""
    return None if left is None or right is None else float(code_separation(left, right)[-1])


def places(names: Sequence[str]) -> tuple[str, ...]:
    """Names by place: a type that stands more than once is told apart by a number (soft-1, soft-2)."""
    return tuple(
        f"{name}-{list(names[: n + 1]).count(name)}" if list(names).count(name) > 1 else name
        for n, name in enumerate(names)
    )


@dataclass(frozen=True, eq=False)
class Group:
    """The buildings by place and by name; of each pair of neighbours the floors that meet, and slabs that strike
    columns whose share of the storey is known.

    defined : every name that the file defines, sound or not
    """

    buildings: tuple[Building, ...]
    types: Mapping[str, Building]
    common: tuple[dict[int, int], ...]
    strikes: tuple[tuple[Strike, ...], ...]
    defined: Sequence[str] = ()

    @classmethod
    def of(cls, names: Sequence[str], types: Mapping[str, Building], defined: Sequence[str] = ()) -> Group:
        placed = tuple(
            b if (b := types[name]).name == label else replace(b, name=label)
            for name, label in zip(names, places(names), strict=True)
        )
        roof = max((float(b.elevation[-1]) for b in placed if not isinstance(b, Wall)), default=0.0)
        placed = tuple(b.up_to(roof) if isinstance(b, Wall) else b for b in placed)
        return cls.of_buildings(placed, types, defined)

    @classmethod
    def of_buildings(
        cls, placed: tuple[Building, ...], types: Mapping[str, Building], defined: Sequence[str] = ()
    ) -> Group:
        """The group of buildings by place."""
        found = [facing(one, other) for one, other in pairwise(placed)]
        common, strikes = tuple(dict(floors) for floors, _ in found), tuple(strikes for _, strikes in found)
        return cls(placed, types, common, strikes, defined)

    @property
    def is_empty(self) -> bool:
        """Whether it stands in for one that is not sound, so that cases can be checked all the same."""
        return not self.buildings

    @cached_property
    def _stiffness(self) -> dict[Storey, float]:
        return {}

    def stiffness(self, given: Any) -> float:
        """A stiffness in N/m.  Raises KeyError for a building that is not defined."""
        if not isinstance(given, Storey):
            return given
        if given not in self._stiffness:
            named = self.buildings if given.building is None else (self.types[given.building],)
            some = [b for b in named if not isinstance(b, Wall)] or named
            stiffest = given.which == "stiffest"
            each = (max(k) if stiffest else sum(k) / len(k) for k in (b.stiffness.tolist() for b in some))
            self._stiffness[given] = given.factor * max(each)
        return self._stiffness[given]


def check_group(names: Sequence[str], defined: Sequence[str], root: Any, problems: Problems) -> bool:
    """Whether the names of a group are sound; what is wrong is noted."""
    before, count = len(problems.found), len(names)
    if count > MOST_IN_GROUP:
        problems.at(root, ("group",), f"the group has {count} buildings", f"name at most {MOST_IN_GROUP}")
        return False
    for place, name in enumerate(names):
        if name not in defined:
            problems.at(root, ("group", place), f"no building '{name}' is defined", nearest(name, defined))
    if count < 2:
        hint = "name at least two, e.g. `group: [stiff, soft]`; each alone is computed as a baseline anyway"
        problems.at(root, ("group",), f"the group has {counted(count, 'building')}: pounding takes two", hint)
    labels = places(names)
    for place, label in enumerate(labels):
        if labels.index(label) != place:
            problems.at(
                root,
                ("group", place),
                f"two places of the group are called '{label}'",
                "give the building another name",
            )
    return len(problems.found) == before


def check_meetings(group: Group, root: Any, problems: Problems) -> bool:
    """Whether all neighbours can strike each other; what is wrong is noted."""
    before = len(problems.found)
    for place, (floors, strikes) in enumerate(zip(group.common, group.strikes, strict=True)):
        if floors or strikes:
            continue
        one, other = group.buildings[place : place + 2]
        told = (", ".join(f"{each:g}" for each in b.elevation[:6]) + ", ..." * (b.storeys > 6) for b in (one, other))
        message = f"{one.name} and {other.name} have no floor at one elevation: {' against '.join(told)} m"
        problems.at(root, ("group", place + 1), message, f"let the storey heights agree somewhere; {COLUMNS}")
    return len(problems.found) == before

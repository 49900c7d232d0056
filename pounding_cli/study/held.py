"""What is held constant where the mass of a building varies: its period or its stiffness, and its strength."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pounding_cli.numbers import listed
from pounding_cli.study.file import Map, Mark, Problems, get
from pounding_cli.study.models import Building

if TYPE_CHECKING:
    from pounding_cli.study.study import Study

_VARIED = (("sweep",), ("uncertain",), ("optimise", "over"))


def tell_held(study: Study, notes: Problems) -> None:
    """Note every mass that varies in a building with a `period`: its stiffness follows the mass, and its yield shears
    follow the weight, which an uncertain mass is hardly meant to do."""
    from pounding_cli.study.study import touched_by

    model, specs = study.model, dict[str, Any]()
    specs |= {name: study.building_spec(study.base, name) for name in dict.fromkeys(model.group)}
    for key, mark, beside in _masses(study.root):
        touched = touched_by([key], study.root)
        names = [
            name
            for name, spec in specs.items()
            if ("buildings", name) in touched and spec.stiffness is None and f"buildings.{name}.period" not in beside
        ]
        if names:
            is_weight = "inelastic" in model.analyses and specs[names[0]].yield_shear is None
            _tell(names, is_weight, mark, study, notes)


def _masses(root: Map) -> Iterator[tuple[str, Mark, frozenset[str]]]:
    """The keys of masses that vary, where each stands, and the keys that move with it."""
    for section in _VARIED:
        node = get(root, *section)
        for holder in node if isinstance(node, list) else [node]:
            for key in holder if isinstance(holder, Map) else ():
                path = key.split(".")
                if path[0] == "buildings" and path[2:3] == ["mass"]:
                    yield key, holder.marks[key][0], frozenset(holder) if isinstance(node, list) else frozenset()


def _tell(names: list[str], is_weight: bool, mark: Mark, study: Study, notes: Problems) -> None:
    first = names[0]
    buildings, building = study.tree(study.base)["buildings"], study.type(study.base, first)
    assert building is not None  # the study was validated
    period = _text(get(buildings, first, "period"), "")
    mass = _text(get(buildings, first, "mass"), str(Building.model_fields["mass"].default))
    one = len(names) == 1
    what = f"the period of {first} is held at {period}" if one else f"the periods of {listed(names)} are held"
    strength = ", and so do the yield shears, which are a part of the weight" if is_weight else ""
    hint = f"to hold the stiffness instead, write `stiffness: {{period: {period}, mass: {mass}}}` in place of `period`"
    if is_weight:
        shears = ", ".join(f"{shear / 1e3:.5g} kN" for shear in building.yield_shear.tolist())
        hint += f"; to hold the yield shears too, `yield_shear: [{shears}]` in place of `yield`"
    hint += "" if one else f" (of {first}; likewise in the others)"
    notes.add(mark, f"where the mass varies, {what}: the stiffness changes in proportion to the mass{strength}", hint)


def _text(value: Any, default: str) -> str:
    """A value as the file says it."""
    if value is None:
        return default
    return f"[{', '.join(map(str, value))}]" if isinstance(value, list) else str(value)

"""What is held constant where the mass of a building varies: its period or its stiffness, and its strength."""

from __future__ import annotations

from collections.abc import Iterator

from pounding_cli.numbers import listed
from pounding_cli.study.building_schema import BuildingSpec
from pounding_cli.study.problems import Problems
from pounding_cli.study.resolve import Resolver
from pounding_cli.study.schema import StudyModel
from pounding_cli.study.sections import touched_by
from pounding_cli.study.source import Mark, Node
from pounding_cli.study.sweep import SweepAxis

_VARIED = (("sweep",), ("uncertain",), ("optimise", "over"))


def tell_held(model: StudyModel, root: Node, resolver: Resolver, notes: Problems) -> None:
    """Note every mass that varies in a building with a `period`: its stiffness follows the mass, and its yield shears
    follow the weight, which an uncertain mass is hardly meant to do."""
    for key, mark, beside in _masses(root):
        touched = touched_by(SweepAxis((key,), ()), root)
        specs = {name: resolver.entry(resolver.base, "buildings", name) for name in dict.fromkeys(model.group)}
        names = [
            name
            for name, spec in specs.items()
            if ("buildings", name) in touched and spec.stiffness is None and f"buildings.{name}.period" not in beside
        ]
        if names:
            is_weight = "inelastic" in model.analyses and specs[names[0]].yield_shear is None
            _tell(names, is_weight, mark, resolver, notes)


def _masses(root: Node) -> Iterator[tuple[str, Mark, frozenset[str]]]:
    """The keys of masses that vary, where each stands, and the keys that move with it."""
    for section in _VARIED:
        node = root.get(*section)
        for holder in [] if node is None else node.value if node.is_list else [node]:
            for key in holder.value if holder.is_mapping else ():
                path = key.split(".")
                if path[0] == "buildings" and path[2:3] == ["mass"]:
                    together = frozenset(holder.value) if node is not None and node.is_list else frozenset()
                    yield key, (holder.keys or {})[key], together


def _tell(names: list[str], is_weight: bool, mark: Mark, resolver: Resolver, notes: Problems) -> None:
    first = names[0]
    buildings, building = resolver.tree(resolver.base, "buildings"), resolver.type(resolver.base, first)
    assert buildings is not None
    assert building is not None  # the study was validated
    period = _text(buildings.get(first, "period"), "")
    mass = _text(buildings.get(first, "mass"), str(BuildingSpec.model_fields["mass"].default))
    one = len(names) == 1
    what = f"the period of {first} is held at {period}" if one else f"the periods of {listed(names)} are held"
    strength = ", and so do the yield shears, which are a part of the weight" if is_weight else ""
    hint = f"to hold the stiffness instead, write `stiffness: {{period: {period}, mass: {mass}}}` in place of `period`"
    if is_weight:
        shears = ", ".join(f"{shear / 1e3:.5g} kN" for shear in building.yield_shear.tolist())
        hint += f"; to hold the yield shears too, `yield_shear: [{shears}]` in place of `yield`"
    hint += "" if one else f" (of {first}; likewise in the others)"
    notes.add(mark, f"where the mass varies, {what}: the stiffness changes in proportion to the mass{strength}", hint)


def _text(node: Node | None, default: str) -> str:
    """A value as the file says it."""
    if node is None:
        return default
    return f"[{', '.join(each.text for each in node.value)}]" if node.is_list else node.text

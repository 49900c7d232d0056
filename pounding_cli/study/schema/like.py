"""Buildings that are like another one: `like:` resolved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.study.schema.building import BASE_SHEAR
from pounding_cli.study.text.file import Items, Map, get, nearest

CODE = frozenset({"code", "zone", "soil", "importance", "Rw", "K"})
"""Keys of a yield that speak of a code."""

Sides = tuple[frozenset[str], frozenset[str]]
ALTERNATIVES: dict[str, tuple[Sides, ...]] = {
    "building": (
        (frozenset({"stiffness"}), frozenset({"period", "taper"})),
        (frozenset({"yield_shear"}), frozenset({"yield"})),
        (frozenset({"rayleigh"}), frozenset({"damping"})),
    ),
    "yield": ((frozenset({"K"}), frozenset({"Rw"})), (BASE_SHEAR, CODE)),
    "plan": (
        (frozenset({"lines", "across", "torsional_stiffness"}), frozenset({"eccentricity", "frequency_ratio"})),
        (frozenset({"depth"}), frozenset({"inertia"})),
    ),
}
"""Keys of which one mapping may give one side only; an inherited key is replaced by its alternative."""

GIVEN_BY_LINES = {
    "stiffness": frozenset({"stiffness", "period", "taper"}),
    "yield_shear": frozenset({"yield_shear", "yield"}),
}
"""Keys of a building that its lines replace, by the key of the lines that has numbers, not shares."""


def resolve_like(buildings: Map, name: str, resolved: dict[str, Any] | None = None) -> Any:
    """Return a building as the file has it with the keys that it takes from others, each with line and column.

    resolved : buildings that were resolved before, by name; those resolved now are added

    Raises
    ------
    InputError : `like:` leads to an unknown name or in a circle
    """
    resolved = {} if resolved is None else resolved
    chain = _find_chain(buildings, name, resolved)
    oldest = chain[-1]
    building = resolved[oldest] if oldest in resolved else buildings[oldest]
    for heir in reversed(chain[:-1]):
        building = _merge(building, buildings[heir], "building")
        resolved[heir] = building
    return building


def find_like(building: Any) -> str | None:
    """Return the name of the building that one is like, which may be a number; None where it stands on its own."""
    like = building.get("like") if isinstance(building, Map) else None
    return str(like) if isinstance(like, str | int | float) and not isinstance(like, bool) else None


def _find_chain(buildings: Map, name: str, resolved: Mapping[str, Any]) -> list[str]:
    """Return a building, the one it is like, and so on, up to one that stands on its own or is resolved."""
    chain = [name]
    while chain[-1] not in resolved and (like := find_like(buildings[chain[-1]])) is not None:
        path: KeyPath = ("buildings", chain[-1], "like")
        if like not in buildings:
            others = [other for other in buildings if other != chain[-1]]
            raise InputError([Issue(path, f"like: no building '{like}' is defined", nearest(like, others))])
        if like in chain:
            circle = " -> ".join((*chain[-5:], like))
            raise InputError([Issue(path, f"like: is circular: {circle}", "let one of them stand on its own")])
        chain.append(like)
    return chain


def _merge(parent: Any, child: Any, kind: str = "") -> Any:
    """Return `child` over `parent`, mapping by mapping; lists and scalars are replaced whole."""
    if not (isinstance(parent, Map) and isinstance(child, Map)):
        return child
    replaced = {"like"}
    for one, other in _find_alternatives(kind, child.get("stiffness") or parent.get("stiffness")):
        replaced |= other if child.keys() & one else set()
        replaced |= one if child.keys() & other else set()
    if kind == "building":
        replaced |= _find_keys_given_by_lines(child)
    merged = Map((), child.mark)
    for key in parent:
        if key not in replaced:
            merged.take(key, parent)
    for key in child:
        value = _merge(merged[key], child[key], key) if key in merged else child[key]
        merged.take(key, child)
        merged[key] = value
    return merged


def _find_alternatives(kind: str, stiffness: Any) -> tuple[Sides, ...]:
    """Return those of a mapping; a `stiffness` that is itself made from a period takes the taper."""
    pairs = ALTERNATIVES.get(kind, ())
    if kind == "building" and isinstance(stiffness, Map):
        return ((frozenset({"stiffness"}), frozenset({"period"})), *pairs[1:])
    return pairs


def _find_keys_given_by_lines(building: Map) -> frozenset[str]:
    """Return the keys of a building that the lines of its own plan replace."""
    lines = get(building, "plan", "lines")
    first = get(lines, 0) if isinstance(lines, Items) else None
    replaced = frozenset[str]()
    for key, beside in GIVEN_BY_LINES.items():
        value = get(first, key)
        if isinstance(value, Items) or value == "never":
            replaced |= beside
    return replaced


def resolve_all_likes(tree: Map) -> Map:
    """Return a file with the keys that buildings take from others, to find where these stand.

    Faulty buildings stay as written.
    """
    buildings = tree.get("buildings")
    if not isinstance(buildings, Map):
        return tree
    resolved: dict[str, Any] = {}
    for name in buildings:
        try:
            resolved[name] = resolve_like(buildings, name, resolved)
        except InputError:
            resolved[name] = buildings[name]
    return Map({**tree, "buildings": Map(resolved, buildings.mark, buildings.marks)}, tree.mark, tree.marks)


def inherits_key(buildings: Map, name: str, path: Sequence[str]) -> bool:
    """Return whether building `name` takes the key at `path` (building, key, ...) from there, itself or by `like:`."""
    seen: set[str] = set()
    while name != path[0]:
        like = find_like(buildings.get(name))
        if name in seen or like is None or get(buildings, name, *path[1:]) is not None:
            return False
        seen.add(name)
        name = like
    return True

"""`like:` a building takes the keys of another; what is given nearer wins, also against its alternatives."""

from __future__ import annotations

from pounding_cli.study.problems import Faults, nearest
from pounding_cli.study.source import Node

ALTERNATIVES: dict[str, tuple[tuple[frozenset[str], frozenset[str]], ...]] = {
    "building": (
        (frozenset({"stiffness"}), frozenset({"period", "taper"})),
        (frozenset({"yield_shear"}), frozenset({"yield"})),
        (frozenset({"rayleigh"}), frozenset({"damping"})),
    ),
    "yield": ((frozenset({"K"}), frozenset({"Rw"})),),
    "link": ((frozenset({"damping_ratio"}), frozenset({"restitution"})),),
}
"""Keys of which one mapping may give one side only; an inherited one gives way to the other side."""


def refuse_alternatives(node: Node, kind: str, faults: Faults) -> None:
    """Note every pair of keys in this one mapping that say the same thing in two ways."""
    if not node.is_mapping:
        return
    for one, other in ALTERNATIVES[kind]:
        first = [key for key in node.value if key in one]
        second = [key for key in node.value if key in other]
        if first and second:
            faults.at(
                node,
                (first[0],),
                f"'{first[0]}' and '{second[0]}' cannot both be given",
                f"remove one: '{first[0]}' stands in place of {' and '.join(repr(k) for k in sorted(other))}",
                key=True,
            )


def inherited(buildings: Node, faults: Faults) -> Node:
    """The buildings with every `like:` carried out; unknown names and circles are noted and left out."""
    if not buildings.is_mapping:
        return buildings
    done: dict[str, Node] = {}
    circles: set[frozenset[str]] = set()
    for name, node in buildings.value.items():
        refuse_alternatives(node, "building", faults)
        below = node.get("yield")
        if below is not None:
            refuse_alternatives(below, "yield", faults)
        done[name] = _follow(name, buildings, faults, (), circles)
    return Node(done, buildings.mark, keys=buildings.keys)


def _follow(name: str, buildings: Node, faults: Faults, seen: tuple[str, ...], circles: set[frozenset[str]]) -> Node:
    node: Node = buildings.value[name]
    like = node.get("like")
    if like is None or not isinstance(like.value, str):
        return node
    if like.value not in buildings.value:
        faults.add(
            like.mark,
            f"like: no building '{like.value}' is defined",
            nearest(like.value, [other for other in buildings.value if other != name]),
        )
        return node
    if like.value in (*seen, name):
        if frozenset((*seen, name)) not in circles:
            circles.add(frozenset((*seen, name)))
            shown = " -> ".join((*seen, name, like.value))
            faults.add(like.mark, f"like: goes round in a circle: {shown}", "let one of them stand on its own")
        return node
    return merged(_follow(like.value, buildings, faults, (*seen, name), circles), node, "building")


def merged(parent: Node, child: Node, kind: str = "") -> Node:
    """`child` over `parent`, mapping by mapping; lists and scalars are replaced whole."""
    if not (parent.is_mapping and child.is_mapping):
        return child
    given = set(child.value)
    gone: set[str] = {"like"}
    for one, other in ALTERNATIVES.get(kind, ()):
        gone |= other if given & one else set()
        gone |= one if given & other else set()
    values = {key: node for key, node in parent.value.items() if key not in gone}
    keys = {key: mark for key, mark in (parent.keys or {}).items() if key in values}
    for key, node in child.value.items():
        values[key] = merged(values[key], node, key) if key in values else node
        keys[key] = (child.keys or {})[key]
    return Node(values, child.mark, keys=keys)

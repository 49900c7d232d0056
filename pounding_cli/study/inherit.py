"""`like:` a building takes the keys of another; what is given nearer wins, also against its alternatives."""

from __future__ import annotations

from pounding_cli.study.building_schema import BASE_SHEAR
from pounding_cli.study.problems import Problems, nearest
from pounding_cli.study.source import Node

MOST_LIKES = 50
"""Buildings that one may inherit from, one through the other."""

CODE = frozenset({"code", "zone", "soil", "importance", "Rw", "K"})
"""Keys of a yield that speak of a code."""

ALTERNATIVES: dict[str, tuple[tuple[frozenset[str], frozenset[str]], ...]] = {
    "building": (
        (frozenset({"stiffness"}), frozenset({"period", "taper"})),
        (frozenset({"yield_shear"}), frozenset({"yield"})),
        (frozenset({"rayleigh"}), frozenset({"damping"})),
    ),
    "yield": (
        (frozenset({"K"}), frozenset({"Rw"})),
        (BASE_SHEAR, CODE),
    ),
    "link": ((frozenset({"damping_ratio"}), frozenset({"restitution"})),),
}
"""Keys of which one mapping may give one side only; an inherited key is replaced by its alternative."""


def _alternatives(kind: str, stiffness: Node | None) -> tuple[tuple[frozenset[str], frozenset[str]], ...]:
    """Those of a mapping; a `stiffness` that is itself made from a period takes the taper."""
    pairs = ALTERNATIVES.get(kind, ())
    if kind == "building" and stiffness is not None and stiffness.is_mapping:
        return ((frozenset({"stiffness"}), frozenset({"period"})), *pairs[1:])
    return pairs


def refuse_alternatives(node: Node, kind: str, problems: Problems) -> None:
    """Note every pair of keys in this one mapping that say the same thing in two ways."""
    if not node.is_mapping:
        return
    for one, other in _alternatives(kind, node.get("stiffness")):
        first = [key for key in node.value if key in one]
        second = [key for key in node.value if key in other]
        if first and second:
            problems.at(
                node,
                (first[0],),
                f"'{first[0]}' and '{second[0]}' cannot both be given",
                f"remove one: '{first[0]}' stands in place of {' and '.join(repr(k) for k in sorted(other))}",
                key=True,
            )


def inherited(buildings: Node, problems: Problems) -> Node:
    """The buildings with every `like:` carried out; unknown names and circles are noted and left out."""
    if not buildings.is_mapping:
        return buildings
    own = {name: _own(node, problems) for name, node in buildings.value.items()}
    done: dict[str, Node] = {}
    for name in own:
        chain = _chain(name, own, done, problems)
        for each in reversed(chain):
            like = like_of(own[each]) or ""
            parent = done.get(like, own.get(like))  # as it is written only where that is told as a fault
            done[each] = own[each] if parent is None else merged(parent, own[each], "building")
    return Node({name: done[name] for name in own}, buildings.mark, keys=buildings.keys)


def _own(node: Node, problems: Problems) -> Node:
    """A building as it is written, of keys that say the same in two ways the first."""
    refuse_alternatives(node, "building", problems)
    below = node.get("yield")
    if below is None:
        return node
    refuse_alternatives(below, "yield", problems)
    if not below.is_mapping:
        return node
    gone = CODE if "base_shear" in below.value else BASE_SHEAR if not CODE.isdisjoint(below.value) else frozenset()
    kept = {key: value for key, value in below.value.items() if key not in gone}
    return node.replaced(("yield",), Node(kept, below.mark, below.text, below.keys))


def like_of(node: Node) -> str | None:
    """The building that one is like, which a number may name too; None where it stands on its own."""
    like = node.get("like")
    if like is None or isinstance(like.value, bool) or not isinstance(like.value, str | int | float):
        return None
    return str(like.value)


def _chain(name: str, own: dict[str, Node], done: dict[str, Node], problems: Problems) -> list[str]:
    """A building, the one it is like, and so on, up to one that stands on its own or is done."""
    chain: list[str] = []
    while name not in done:
        chain.append(name)
        like = like_of(own[name])
        if like is None:
            break
        mark = own[name].value["like"].mark
        if like not in own:
            known = [other for other in own if other != name]
            problems.add(mark, f"like: no building '{like}' is defined", nearest(like, known))
            break
        if like in chain:
            shown = " -> ".join((*chain[:5], *(("...",) if len(chain) > 5 else ()), like))
            problems.add(mark, f"like: is circular: {shown}", "let one of them stand on its own")
            break
        if len(chain) > MOST_LIKES:
            problems.add(
                mark, f"like: leads through more than {MOST_LIKES} buildings", "let one of them stand on its own"
            )
            break
        name = like
    return chain


def merged(parent: Node, child: Node, kind: str = "") -> Node:
    """`child` over `parent`, mapping by mapping; lists and scalars are replaced whole."""
    if not (parent.is_mapping and child.is_mapping):
        return child
    given = set(child.value)
    gone: set[str] = {"like"}
    for one, other in _alternatives(kind, child.get("stiffness") or parent.get("stiffness")):
        gone |= other if given & one else set()
        gone |= one if given & other else set()
    values = {key: node for key, node in parent.value.items() if key not in gone}
    keys = {key: mark for key, mark in (parent.keys or {}).items() if key in values}
    for key, node in child.value.items():
        values[key] = merged(values[key], node, key) if key in values else node
        keys[key] = (child.keys or {})[key]
    return Node(values, child.mark, keys=keys)

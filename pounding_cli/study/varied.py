"""Keys of a study that take values at will: drawn from a distribution, chosen from a list or searched over a range."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from pounding_cli.numbers import Unit
from pounding_cli.study.distributions import (
    EXAMPLES,
    NEEDED,
    RANGE,
    Distribution,
    DistributionReader,
    lacks_unit,
    share_of,
)
from pounding_cli.study.problems import Problems, nearest
from pounding_cli.study.ranges import number_node
from pounding_cli.study.rules import StiffnessRule, read_stiffness
from pounding_cli.study.schema import StudyModel
from pounding_cli.study.source import Mark, Node
from pounding_cli.study.sweep import is_sweepable
from pounding_cli.study.units import Quantity
from pounding_cli.study.written import quantity_of, unit_of

MOTION = "motion"
"""The key that stands for the choice of motions."""

ANY, BOOTSTRAP = "any", "bootstrap"
"""What it chooses: one of the motions, or as many as there are, drawn anew with replacement."""

DRAWN_SETS = 64
"""Different sets of motions of a bootstrap."""

CHOICE = "choice"
DISTRIBUTIONS = (*NEEDED, CHOICE)


@dataclass(frozen=True)
class Factor:
    """One key that varies, as a function of a number u between 0 and 1.

    key : dotted, as in the file; MOTION for the choice of motion
    mark : where it stands
    options : how many values it chooses from; 0 where it is continuous, and of MOTION
    unit : people read its values in
    number : (u, shape (n,)) -> values in SI, the multiple of a storey's stiffness, or the number of the option
    node : u -> what stands in the study
    labels : of the options
    spacing : of a range, linear or log
    place : a node of the file -> its u; None where it lies outside a range or among no options, and of a distribution
    together : further keys of the study that move with it, by the same u
    """

    key: str
    mark: Mark
    options: int
    unit: Unit
    number: Callable[[np.ndarray], np.ndarray]
    node: Callable[[float], Node]
    labels: tuple[str, ...] = ()
    place: Callable[[Node], float | None] = lambda node: None
    spacing: str = ""
    together: tuple[Factor, ...] = ()

    @property
    def members(self) -> tuple[Factor, ...]:
        """Itself and those that move with it."""
        return (self, *self.together)


def choice_of(u: np.ndarray, options: int) -> np.ndarray:
    """The number of the option, from 0, at u in [0, 1]."""
    return np.minimum((np.asarray(u) * options).astype(int), options - 1)


def read_uncertain(node: Node, root: Node, problems: Problems) -> list[Factor]:
    """The keys under `uncertain:`; those of one entry of a list move together. What is wrong is noted in `problems`."""
    entries = node.value if node.is_list else [node]
    found, seen = list[Factor](), dict[str, int]()
    for entry in entries:
        mine = list[Factor]()
        for key, mark, value in _keys("uncertain", entry, root, problems, EXAMPLES["uniform"]):
            if key in seen:
                problems.add(mark, f"'{key}' is also in line {seen[key]}", "remove one of the two")
            elif key == MOTION:
                mine += _motion(mark, value, problems)
            elif is_sweepable(key, mark, root, problems, "the key"):
                mine += _factor(key, mark, value, problems)
            seen.setdefault(key, mark[0])
        found += _together(mine, problems) if node.is_list else mine
    return found


def _together(factors: list[Factor], problems: Problems) -> list[Factor]:
    """One factor of several keys; none where they cannot move together."""
    if len(factors) < 2:
        return factors
    first, others = factors[0], factors[1:]
    for other in others:
        if other.key == MOTION or first.key == MOTION:
            problems.add(other.mark, "the motion moves by itself", "write `- motion: ...` as an entry of its own")
            return []
        if other.options != first.options:
            what = f"keys that move together need as many options each: {first.key} has {first.options or 'a range'}"
            problems.add(other.mark, f"{what}, {other.key} {other.options or 'a range'}", "give as many of each")
            return []
    return [dataclasses.replace(first, together=tuple(others))]


def read_searched(section: str, node: Node, root: Node, problems: Problems) -> list[Factor]:
    """Keys that are searched over a range, or chosen: {from: 1, to: 5}, {choice: [1, 2]}; wrong ones are noted."""
    found = []
    for key, mark, value in _keys(section, node, root, problems, RANGE):
        if not is_sweepable(key, mark, root, problems, "the key"):
            continue
        if not value.is_mapping or CHOICE not in value.value:  # a range is what a uniform distribution is drawn from
            value = Node({"uniform": value}, value.mark, value.text, {"uniform": value.mark})
        found += _factor(key, mark, value, problems, is_range=True)
    return found


def _keys(section: str, node: Node, root: Node, problems: Problems, example: str) -> list[tuple[str, Mark, Node]]:
    """The keys of a section that are not swept too."""
    if not node.is_mapping:
        problems.add(node.mark, f"'{section}' is not a mapping of keys", f"write `impact.restitution: {example}`")
        return []
    swept, found = _swept(root), []
    for key, value in node.value.items():
        mark = (node.keys or {})[key]
        if key in swept:
            problems.add(mark, f"'{key}' is also in line {swept[key]}, under `sweep:`", "vary it in one of the two")
        else:
            found.append((key, mark, value))
    return found


def _swept(root: Node) -> dict[str, int]:
    """The swept keys and the line of each."""
    sweep = root.get("sweep")
    holders = [] if sweep is None else sweep.value if sweep.is_list else [sweep]
    return {key: mark[0] for holder in holders for key, mark in (holder.keys or {}).items()}


def _motion(mark: Mark, node: Node, problems: Problems) -> list[Factor]:
    """The choice of motions, which is no key of the file; how many there are to choose from is not known here."""
    if node.value not in (ANY, BOOTSTRAP):
        hint = "write `motion: any` (one of them) or `motion: bootstrap` (as many, drawn with replacement)"
        problems.add(node.mark, f"motion: '{node.text}' is not known", hint)
        return []
    options = DRAWN_SETS if node.value == BOOTSTRAP else 0
    return [Factor(MOTION, mark, options, Unit(), lambda u: u, lambda u: node)]


def _factor(key: str, mark: Mark, node: Node, problems: Problems, is_range: bool = False) -> list[Factor]:
    names = list(node.value) if node.is_mapping else []
    if len(names) != 1:
        what = "has more than one distribution" if names else "has no distribution"
        hint = f"write one of {', '.join(DISTRIBUTIONS)}, e.g. `{key}: {EXAMPLES['uniform']}`"
        if is_range:
            what, hint = "has more than its choice", f"write `{key}: {EXAMPLES[CHOICE]}` or `{key}: {RANGE}`"
        problems.add(node.mark, f"'{key}' {what}", hint)
        return []
    name, below = names[0], node.value[names[0]]
    if name not in DISTRIBUTIONS:
        problems.add((node.keys or {})[name], f"no distribution '{name}' is known", nearest(name, DISTRIBUTIONS))
        return []
    quantity = quantity_of(StudyModel, key.split("."))
    if name == CHOICE:
        return _choice(key, mark, below, quantity, problems)
    found = DistributionReader(key, quantity, problems, is_range).read(name, below)
    if found is None:
        return []

    spacing = ("log" if found.is_log else "linear") if is_range else ""

    def place(written: Node) -> float | None:
        return _place(found, quantity, written) if is_range else None

    if found.rule is not None:
        of, storey = found.rule.building, f"x {found.rule.which} storey"
        which = found.rule.which

        def multiple(u: float) -> Node:
            text = str(StiffnessRule(float(found(u)), which, of))
            return Node(text, mark, text)

        return [Factor(key, mark, 0, Unit(f"{storey} of {of}" if of else storey), found, multiple, (), place, spacing)]
    unit = unit_of(StudyModel, key.split("."), list(below.value.values()))

    def number(u: float) -> Node:
        return number_node(unit.number(float(found(u))), unit.name, mark)

    return [Factor(key, mark, 0, unit, found, number, (), place, spacing)]


def _place(found: Distribution, quantity: Quantity | None, written: Node) -> float | None:
    """The u of what the file says, where that lies in the range."""
    try:
        if found.rule is None:
            value = quantity.read(written.plain()) if quantity is not None else None
        else:
            rule = read_stiffness(written.value)
            is_same = isinstance(rule, StiffnessRule) and (rule.which, rule.building) == (
                found.rule.which, found.rule.building,
            )  # fmt: skip
            value = rule.factor if is_same else None  # type: ignore[union-attr]
    except PydanticCustomError:
        return None
    return share_of(found, float(value)) if isinstance(value, int | float) else None


def _choice(key: str, mark: Mark, node: Node, quantity: Quantity | None, problems: Problems) -> list[Factor]:
    if not node.is_list or len(node.value) < 2:
        hint = f"write `{key}: {EXAMPLES[CHOICE]}`"
        problems.add(node.mark, f"'{key}': a choice is a list of two values or more", hint)
        return []
    options: Sequence[Node] = list(node.value)
    seen: dict[Any, str] = {}
    for option in options:
        same = _same(option, quantity)
        if same in seen:
            problems.add(option.mark, f"'{key}': {option.text} and {seen[same]} are one value", "remove one of the two")
            return []
        if quantity is not None and lacks_unit(option, quantity):
            hint = f"write its unit too, e.g. {quantity.example}"
            problems.add(option.mark, f"'{key}': {option.text} has no unit", hint)
            return []
        seen[same] = option.text
    unit = unit_of(StudyModel, key.split("."), options)
    count, labels = len(options), tuple(option.text or str(option.plain()) for option in options)
    numbers = {same: number for number, same in enumerate(seen)}

    def place(written: Node) -> float | None:
        same = _same(written, quantity)
        return (numbers[same] + 0.5) / count if same in numbers else None

    return [
        Factor(
            key, mark, count, unit, lambda u: choice_of(u, count).astype(float),
            lambda u: options[int(choice_of(np.asarray(u), count))], labels, place,
        )
    ]  # fmt: skip


def _same(option: Node, quantity: Quantity | None) -> Any:
    """What two options have in common that are one: 0.5 and 1/2."""
    try:
        return quantity.read(option.plain()) if quantity is not None else repr(option.plain())
    except PydanticCustomError:
        return repr(option.plain())

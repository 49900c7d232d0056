"""The axes of a sweep: dotted keys with their values, lists or ranges; keys of one list entry move together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticCustomError

from pounding_cli.numbers import Unit
from pounding_cli.study import schema
from pounding_cli.study.file import Items, Map, Mark, Problems, get, nearest, put
from pounding_cli.study.quantity import Quantity, said_place, written_unit
from pounding_cli.study.words import keys_at, quantity_at
from pounding_cli.units import factor

MOST_POINTS, MOST_AXES, MOST_VALUES = 2_000_000, 20, 10_000
FORM = "{from: 0.2 s, to: 1.5 s, count: 14}"
_RANGE = ("from", "to", "count", "step", "spacing")
_BRACKET = ("values", "middle")


class _Unwritten:
    def __str__(self) -> str:
        return "default"


UNWRITTEN = _Unwritten()
"""What stands at a point of an axis for a key that the file leaves to its default."""

Values = tuple[Sequence[Any], Sequence[Mark], Unit]
"""Values of a key as the file says them, where they stand, and the unit they are written in."""


@dataclass(frozen=True, eq=False)
class SweepAxis:
    """One dimension: its keys, what each takes at every point as the file says it, and where that stands.

    units : each key is shown in
    """

    names: tuple[str, ...]
    given: Sequence[tuple[Any, ...]]
    marks: Sequence[tuple[Mark, ...]]
    units: tuple[Unit, ...]

    def __len__(self) -> int:
        return len(self.given)

    @property
    def paths(self) -> list[list[str]]:
        """The keys, step by step."""
        return [name.split(".") for name in self.names]

    def told(self, place: int) -> str:
        """The values at a point in words."""
        return ", ".join(f"{name} = {value}" for name, value in zip(self.names, self.given[place], strict=True))

    def some(self, places: Sequence[int]) -> SweepAxis:
        """The axis at some of its points."""
        return replace(self, given=[self.given[n] for n in places], marks=[self.marks[n] for n in places])


def read_axes(root: Map, problems: Problems, model: type[BaseModel] = schema.Study) -> tuple[SweepAxis, ...]:
    """The axes under `sweep:`, each key of a mapping one; what is wrong is noted."""
    sweep, mark = root.get("sweep"), root.marks.get("sweep", (root.mark, root.mark))[1]
    if sweep is None:
        return ()
    if not isinstance(sweep, Map | Items):
        problems.add(mark, "'sweep' is not a mapping", "write `sweep: {impact.restitution: [0.4, 0.5]}`")
        return ()
    entries = [(sweep, [name]) for name in sweep] if isinstance(sweep, Map) else []
    for number, node in enumerate(sweep if isinstance(sweep, Items) else ()):
        if isinstance(node, Map) and node:
            entries.append((node, list(node)))
        elif isinstance(sweep, Items):
            what = "an axis is a mapping of keys to lists"
            problems.add(sweep.marks[number], what, "write `- {impact.restitution: [0.4, 0.5]}`")
    if len(entries) > MOST_AXES:
        problems.add(mark, f"the sweep has {len(entries)} axes", f"keep it to {MOST_AXES}")
        return ()
    axes, seen = list[SweepAxis](), dict[str, Mark]()
    for holder, names in entries:
        columns = []
        for name in names:
            there = holder.marks[name][0]
            sound = can_vary(name, there, root, problems, model=model)
            values = values_of(name, holder, problems, model) if sound else None
            if name in seen:
                first = said_place(seen[name])
                problems.add(there, f"'{name}' is an axis twice; first {first}", "remove one of the two")
            elif values is not None:
                columns.append(values)
            seen.setdefault(name, there)
        if len(columns) < len(names):
            continue
        if len({len(column[0]) for column in columns}) > 1:
            lengths = ", ".join(f"{name} has {len(column[0])}" for name, column in zip(names, columns, strict=True))
            message = f"keys that move together need as many values each: {lengths}"
            problems.add(holder.mark, message, "give as many values of each")
            continue
        given, marks, units = zip(*columns, strict=True)
        rows = list(zip(*given, strict=True)), list(zip(*marks, strict=True))
        axes.append(SweepAxis(tuple(names), *rows, units))
    if (points := math.prod(map(len, axes))) > MOST_POINTS:
        hint = f"keep it to {MOST_POINTS}: make axes shorter, or let keys move together in a list entry"
        problems.add(mark, f"the sweep has {points} points", hint)
        return ()
    return tuple(axes)


def can_vary(
    name: str,
    mark: Mark,
    root: Map,
    problems: Problems,
    what: str = "sweep axis",
    model: type[BaseModel] = schema.Study,
) -> bool:
    """Whether a dotted key can differ from point to point; why not is noted."""
    path, whole = name.split("."), model is schema.Study
    fixed = path[0] in (schema.ONCE if whole else ("title", "sweep"))
    meant = _meant(path, root) if whole else ""
    if fixed and len(path) > 1 and meant:  # a case or a building called as a section, e.g. gap
        problems.add(mark, f"{what} '{name}': no such key", f"did you mean '{meant}'?")
        return False
    if fixed or (whole and (path[:2] == ["records", "use"] or path[-1] == "like")):
        cannot = "be an axis" if what == "sweep axis" else "vary"
        hint = "run one study for each value"
        problems.add(mark, f"'{name}' cannot {cannot}: it is one for the whole study", hint)
        return False
    for place, step in enumerate(path):
        above, known = get(root, *path[:place]), _known(path[:place], root, model)
        if isinstance(above, list) and step.isdigit() and int(step) < len(above):
            continue
        before = ".".join(path[:place])
        if above is not None and not isinstance(above, dict) and step in known:
            shown = "a list" if isinstance(above, list) else f"'{above}'"
            message = f"{what} '{name}': '{before}' is {shown} in this study and has no key '{step}'"
            problems.add(mark, message, f"give '{before}' as a mapping with '{step}' in it, or remove it there")
            return False
        if step not in known:
            hint = f"did you mean '{meant}'?" if meant and not place else nearest(step, known)
            problems.add(mark, f"{what} '{name}': no key '{step}'{f' under {before!r}' * bool(before)}", hint)
            return False
    below = _known(path, root, model)
    least = {"buildings": 3, "cases": 3, "laws": 3, "tail": 1}.get(path[0], 2)
    if len(path) < least if whole else below:
        example = f"{name}.{(below or ['KEY'])[-1 if whole else 0]}"
        problems.add(mark, f"{what} '{name}' is a whole section", f"name one value in it, e.g. `{example}`")
        return False
    return True


def _known(path: list[str], root: Map, model: type[BaseModel]) -> list[str]:
    """The keys that may stand at a path: those of the schema; of a case, those of any link."""
    if model is schema.Study and path[:1] == ["cases"] and len(path) > 1:
        return [*keys_at(schema.Study, (*path[:2], "links", "0", *path[4:]), root), "links"]
    return keys_at(model, path, root)


def _meant(path: list[str], root: Map) -> str:
    """The key that ends in what was written where its beginning was left out: soft.period, restitution, pga; or ""."""
    named = [
        [section, name]
        for section in ("buildings", "cases")
        if isinstance(node := root.get(section), Map)
        for name in node
    ]
    for before in (["buildings"], ["cases"], ["impact"], *named, ["records", "scale"], ["records"]):
        whole = [*before, *path]
        if all(step in _known(whole[:place], root, schema.Study) for place, step in enumerate(whole)):
            return ".".join(whole)
    return ""


def values_of(name: str, holder: Map, problems: Problems, model: type[BaseModel] = schema.Study) -> Values | None:
    """The values of a swept key; None where something is wrong, which is noted."""
    given, mark, quantity = holder[name], holder.marks[name][1], quantity_at(model, tuple(name.split(".")))
    if isinstance(given, Map) and not given.keys().isdisjoint(_RANGE):
        return _range(name, given, quantity or Quantity("number", "", "5"), problems)
    if isinstance(given, Map) and "values" in given:
        for key in given.keys() - {*_BRACKET}:
            problems.add(given.marks[key][0], f"unknown key '{key}' of an axis", nearest(key, _BRACKET))
        mark, given = given.marks["values"][1], given["values"]
    if not isinstance(given, Items):
        hint = f"write `{name}: [first, second]`, or a range: `{name}: {FORM}`"
        problems.add(mark, f"the values of '{name}' are not a list", hint)
    elif not given:
        problems.add(mark, f"the axis '{name}' has no values", "give at least one")
    elif len(given) > MOST_VALUES:
        problems.add(mark, f"the axis '{name}' has {len(given)} values", f"give at most {MOST_VALUES}")
    else:
        return given, given.marks, unit_of(given, quantity)
    return None


def with_middles(root: Map, problems: Problems) -> tuple[Map, tuple[str, ...]]:
    """The tree with the middle of every unknown value (`{values: [...], middle: ...}`) where its key stands, and the
    keys that have one: it comes first in tables and figures."""
    keys = list[str]()
    sweep: Any = root.get("sweep")
    for holder in sweep if isinstance(sweep, Items) else [sweep]:
        for name, node in list(holder.items()) if isinstance(holder, Map) else ():
            if isinstance(node, Map) and "middle" in node and _is_middle(name, node, root, problems):
                keys.append(name)
                if can_vary(name, holder.marks[name][0], root, Problems("")):  # else the axis says what is wrong
                    root = put(root, name.split("."), node["middle"], node.marks["middle"][1])
    return root, tuple(keys)


def _is_middle(name: str, node: Map, root: Map, problems: Problems) -> bool:
    values, middle, own = node.get("values"), node["middle"], get(root, *name.split("."))
    quantity = quantity_at(schema.Study, tuple(name.split(".")))
    if not isinstance(values, Items) or len(values) < 3 or len(values) % 2 == 0:
        message = f"'{name}' with a middle takes an odd number of values, three at least"
        hint = f"write low, middle and high, e.g. `{name}: {{values: [low, middle, high], middle: middle}}`"
        problems.add(node.marks["values"][1] if "values" in node else node.mark, message, hint)
    elif same(values[len(values) // 2], quantity) != same(middle, quantity):
        message = f"the middle of the values of '{name}' is {values[len(values) // 2]}, not {middle}"
        problems.add(node.marks["middle"][1], message, "write low, middle and high in this order")
    elif own is not None and same(own, quantity) != same(middle, quantity):
        message = f"'{name}' is {own} here and {middle} in the middle of its values"
        problems.at(root, tuple(name.split(".")), message, "leave it to the sweep, or write the middle")
    else:
        return True
    return False


def same(value: Any, quantity: Quantity | None) -> Any:
    """What two spellings of one value have in common: 0.5 and 1/2."""
    try:
        return quantity.read(value) if quantity is not None else repr(value)
    except PydanticCustomError:
        return repr(value)


def unit_of(values: Sequence[Any], quantity: Quantity | None) -> Unit:
    """The first unit written among some values; SI where all are bare numbers."""
    if quantity is None:
        return Unit()
    for value in values:
        try:
            if (unit := written_unit(value)) and (one := factor(unit, quantity.si)) is not None:
                return Unit(unit, one, quantity.si)
        except ValueError:
            continue
    return Unit(quantity.si, 1.0, quantity.si)


def in_unit(number: float, unit: Unit) -> Any:
    """An SI number as a study writes it in a unit."""
    value = unit.number(number)
    plain: int | float = int(value) if value.is_integer() and abs(value) < 1e15 else value
    return f"{plain} {unit.name}" if unit.name else plain


def _range(name: str, node: Map, quantity: Quantity, problems: Problems) -> Values | None:
    """The values of `{from, to, count | step, spacing}`."""
    before = len(problems.found)
    for message, hint, key, at_key in _wrong_range(name, node, quantity):
        problems.add(node.marks[key][0 if at_key else 1] if key else node.mark, message, hint)
    if len(problems.found) > before:
        return None
    first, last = quantity.read(node["from"]), quantity.read(node["to"])
    log, count = node.get("spacing") == "log", node.get("count") or round((last - first) / _step(node, quantity)) + 1
    unit = unit_of([node[key] for key in ("from", "to", "step") if key in node], quantity)
    shares = [place / (count - 1) for place in range(count)]
    numbers = [first * (last / first) ** s if log else first + (last - first) * s for s in shares[:-1]]
    return [in_unit(number, unit) for number in (*numbers, last)], [node.mark] * count, unit


def _step(node: Map, quantity: Quantity) -> float:
    return float(Quantity(f"step of a {quantity.name}", quantity.si, quantity.example).read(node["step"]))


Wrong = tuple[str, str, str, bool]
"""Message, hint, key of the range ("" for all of it), whether it stands at the key."""


def _wrong_range(name: str, node: Map, quantity: Quantity) -> Iterator[Wrong]:
    """What is wrong with a range; nothing further is looked at where its keys are."""
    found = list(_wrong_keys(name, node)) or list(_wrong_ends(node, quantity))
    yield from found
    if found:
        return
    first, last = quantity.read(node["from"]), quantity.read(node["to"])
    if node.get("spacing") == "log" and not first * last > 0:
        yield "a logarithmic range cannot reach zero", "begin above zero, e.g. `from: 0.1 s`", "spacing", False
    elif "step" in node:
        yield from _wrong_step(first, last, _step(node, quantity), node)
    elif isinstance(count := node["count"], bool) or not isinstance(count, int):
        yield f"count: '{count}' is not a whole number", "write how many values, e.g. 15", "count", False
    elif not 2 <= count <= MOST_VALUES:
        hint = "write a list of one value" if count == 1 else "write a smaller count"
        message = f"count: {count}; a range has 2 to {MOST_VALUES} values"
        yield message, hint if count > 0 else "write how many values, e.g. 15", "count", False


def _wrong_keys(name: str, node: Map) -> Iterator[Wrong]:
    for key in node:
        if key not in _RANGE:
            yield f"unknown key '{key}' in a range", nearest(key, _RANGE), key, True
    for key in [key for key in ("from", "to") if key not in node][:1]:
        yield f"the range lacks '{key}'", f"write e.g. `{name}: {FORM}`", "", False
    if ("count" in node) == ("step" in node):
        what = "has both 'count' and 'step'" if "count" in node else "has neither 'count' nor 'step'"
        hint = "write one of them: how many values, or the step from one to the next"
        yield f"the range {what}", hint, "", False
    if node.get("spacing", "linear") not in ("linear", "log"):
        yield f"spacing: '{node['spacing']}' is not known", "write linear or log", "spacing", False
    if node.get("spacing") == "log" and "step" in node:
        yield "a logarithmic range has no step", "write `count:` in its place", "step", True


def _wrong_ends(node: Map, quantity: Quantity) -> Iterator[Wrong]:
    ends: dict[str, float] = {}
    step = Quantity(f"step of a {quantity.name}", quantity.si, quantity.example)
    for key, kind in (("from", quantity), ("to", quantity), ("step", step)):
        if key not in node:
            continue
        try:
            value = kind.read(node[key])
        except PydanticCustomError as error:
            context: dict[str, Any] = error.context or {}
            yield context["message"], context["hint"], key, False
            continue
        if isinstance(value, float):
            ends[key] = value
        else:
            yield f"'{node[key]}' is not a number: a range runs between numbers", quantity.wanted, key, False
    if len(ends) < 2 + ("step" in node):
        return
    written = {key: bool(written_unit(node[key])) for key, value in ends.items() if value}
    if len(set(written.values())) > 1:
        bare = next(key for key, has in written.items() if not has)
        hint = f"write its unit too; without one it is {node[bare]} {quantity.si}".rstrip()
        yield f"{node[bare]} has no unit, but the other end of the range has one", hint, bare, False
    elif ends["from"] == ends["to"]:
        yield "the range ends where it begins", "write `to:` apart from `from:`, or a single value", "to", False


def _wrong_step(first: float, last: float, step: float, node: Map) -> Iterator[Wrong]:
    steps = (last - first) / step if step else -1.0
    if steps < 0:
        away = f"{node['step']} leads away from 'to'" if step else "zero leads nowhere"
        yield f"a step of {away}", "give the step from `from:` towards `to:`, e.g. 0.1 s", "step", False
    elif steps > MOST_VALUES:
        hint = f"an axis has at most {MOST_VALUES}: write a larger step"
        yield f"steps of {node['step']} make {steps:.3g} values", hint, "step", False
    elif round(steps) == 0 or not math.isclose(steps, round(steps), rel_tol=1e-9):
        fits = max(math.floor(steps + 1e-9), 1) + 1
        ends = f"from {node['from']} to {node['to']}"
        message = f"steps of {node['step']} do not lead {ends}: that is {steps:.4g} steps"
        yield message, f"change an end or the step, or write `count: {max(fits, 2)}`", "step", False

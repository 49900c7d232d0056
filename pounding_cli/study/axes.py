"""The axes of a sweep: dotted keys with their values, lists or ranges; keys of one list entry move together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticCustomError

from pounding_cli.numbers import Unit
from pounding_cli.study import schema
from pounding_cli.study.file import Items, Map, Mark, Problems, get, nearest, with_value
from pounding_cli.study.quantity import Quantity, format_location, lacks_unit, written_unit
from pounding_cli.study.words import keys_at, quantity_at, value_at
from pounding_cli.units import find_unit_factor

MAX_POINTS, MAX_AXES, MAX_VALUES = 2_000_000, 20, 10_000
_RANGE = ("from", "to", "count", "step", "spacing")
_BRACKET = ("values", "middle")


def example_values(quantity: Quantity | None, *shares: float) -> list[str]:
    """Return some parts of the example of a quantity, in its unit, e.g. `100 t` and `200 t`."""
    number, unit = 5.0, ""
    if quantity is not None:
        unit = written_unit(quantity.example)
        try:
            number = float(quantity.example.removesuffix(unit))
        except ValueError:  # an example in words
            number, unit = 1.0, quantity.si
    return [f"{share * number:g} {unit}".rstrip() for share in shares]


def range_example(quantity: Quantity | None, more: str = "") -> str:
    """Return how a range of a quantity is written."""
    low, high = example_values(quantity, 0.5, 1.0)
    return f"{{from: {low}, to: {high}{more}}}"


class _Unwritten:
    def __str__(self) -> str:
        return "default"


UNWRITTEN = _Unwritten()
"""What stands at a point of an axis for a key that the file leaves to its default."""

Values = tuple[Sequence[Any], Sequence[Mark], Unit]
"""Values of a key as the file says them, where they stand, and the unit they are written in."""


@dataclass(frozen=True, eq=False)
class Axis:
    """One dimension of a sweep.

    names : dotted keys as in the file, more than one when they move together
    written_values, marks : what each takes at every point as the file says it, and where that stands
    units : the unit each key is written in; SI where none are given
    model : of the file
    """

    names: tuple[str, ...]
    written_values: Sequence[tuple[Any, ...]]
    marks: Sequence[tuple[Mark, ...]]
    units: tuple[Unit, ...]
    model: type[BaseModel] = schema.StudySpec

    def __len__(self) -> int:
        return len(self.written_values)

    @property
    def paths(self) -> list[list[str]]:
        """The keys, step by step."""
        return [name.split(".") for name in self.names]

    def format_point(self, place: int) -> str:
        """The values at a point in words."""
        return ", ".join(
            f"{name} = {value}" for name, value in zip(self.names, self.written_values[place], strict=True)
        )

    @cached_property
    def values(self) -> tuple[tuple[float | str, ...], ...]:
        """One tuple per point, as long as names: SI numbers, or the file's text for what is no number."""
        paths = [tuple(path) for path in self.paths]
        return tuple(
            tuple(value_at(self.model, path, value) for path, value in zip(paths, row, strict=True))
            for row in self.written_values
        )

    def display_values(self, place: int) -> tuple[str, ...]:
        """The values at a point in the units of the study, e.g. ("0.7 g",)."""
        return tuple(unit.text(value) for unit, value in zip(self.units, self.values[place], strict=True))


def sweep_maps(root: Any) -> list[Map]:
    """The mappings of keys to values under `sweep:`."""
    sweep = get(root, "sweep")
    return [node for node in (sweep if isinstance(sweep, Items) else [sweep]) if isinstance(node, Map)]


def read_axes(root: Map, problems: Problems, model: type[BaseModel] = schema.StudySpec) -> tuple[Axis, ...]:
    """The axes under `sweep:`, each key of a mapping one; what is wrong is noted."""
    sweep, mark = root.get("sweep"), root.marks.get("sweep", (root.mark, root.mark))[1]
    if sweep is None:
        return ()
    maps = sweep_maps(root)
    if not isinstance(sweep, Map) and (not isinstance(sweep, Items) or len(maps) < len(sweep) or not all(maps)):
        hint = "write `sweep: {impact.restitution: [0.4, 0.5]}`, or a list of such mappings"
        problems.add(mark, "'sweep' is not a mapping of keys to values", hint)
        return ()
    entries = [(sweep, [name]) for name in sweep] if isinstance(sweep, Map) else [(node, list(node)) for node in maps]
    if len(entries) > MAX_AXES:
        problems.add(mark, f"the sweep has {len(entries)} axes", f"keep it to {MAX_AXES}")
        return ()
    axes, seen = list[Axis](), dict[str, Mark]()
    for holder, names in entries:
        columns = list[Values]()
        for name in names:
            there = holder.marks[name][0]
            sound = can_vary(name, there, root, problems, model=model)
            values = read_axis_values(name, holder, problems, model) if sound else None
            if name in seen:
                first = format_location(seen[name])
                problems.add(there, f"'{name}' is an axis twice; first {first}", "remove one of the two")
            elif values is not None:
                columns.append(values)
            seen.setdefault(name, there)
        if len(columns) < len(names):
            continue
        if len({len(given) for given, _, _ in columns}) > 1:
            lengths = ", ".join(f"{name} has {len(column[0])}" for name, column in zip(names, columns, strict=True))
            message = f"keys that move together need as many values each: {lengths}"
            problems.add(holder.mark, message, "give as many values of each")
            continue
        given, marks, units = zip(*columns, strict=True)
        rows = list(zip(*given, strict=True)), list(zip(*marks, strict=True))
        axis = Axis(tuple(names), *rows, units, model)
        places: dict[tuple[float | str, ...], int] = {}
        for place, point in enumerate(axis.values):
            if (twin := places.setdefault(point, place)) != place:
                what = f"{axis.format_point(twin)} and {axis.format_point(place)} are the same point of this axis"
                problems.add(axis.marks[place][0], what, "remove one of the two")
        axes.append(axis)
    if (points := math.prod(map(len, axes))) > MAX_POINTS:
        hint = f"keep it to {MAX_POINTS}: make axes shorter, or let keys move together in a list entry"
        problems.add(mark, f"the sweep has {points} points", hint)
        return ()
    return tuple(axes)


def can_vary(
    name: str,
    mark: Mark,
    root: Map,
    problems: Problems,
    what: str = "sweep axis",
    model: type[BaseModel] = schema.StudySpec,
) -> bool:
    """Whether a dotted key can differ from point to point; why not is noted."""
    path, whole = name.split("."), model is schema.StudySpec
    once = schema.ONCE if whole else {"title", "sweep"}
    if path[0] in once or (whole and (path[:2] == ["records", "use"] or path[-1] == "like")):
        message = f"{what} '{name}' cannot vary: it is one for the whole study"
        inner = find_whole_key(path, root) if whole and path[-1] != "like" and "sweep" not in path else ""
        problems.add(mark, message, f"write the whole key, `{inner}`" if inner else "run one study for each value")
        return False
    for place, step in enumerate(path):
        above, known = get(root, *path[:place]), _known(path[:place], root, model)
        if isinstance(above, list) and step.isdigit() and int(step) < len(above):
            continue
        if step in known and (above is None or isinstance(above, dict)):
            continue
        problems.add(mark, *_refuse_step(what, path, place, above, known, root, model))
        return False
    if _is_section(path, root, model):
        example = _value_in_section(path, root, model)
        problems.add(mark, f"{what} '{name}' is a whole section", f"name one value in it, e.g. `{example}`")
        return False
    return True


def _is_section(path: Sequence[str], root: Map, model: type[BaseModel]) -> bool:
    """Return whether a path leads to a section that no single value can stand for."""
    if model is schema.StudySpec:
        least = {"buildings": 3, "cases": 3, "laws": 3, "tail": 1}.get(path[0], 2)
        return len(path) < least
    return bool(_known([*path], root, model))


def _refuse_step(
    what: str, path: list[str], place: int, above: Any, known: list[str], root: Map, model: type[BaseModel]
) -> tuple[str, str]:
    """Return what is wrong with a dotted key whose step at `place` leads nowhere, and what to write.

    above : what stands in the file above that step
    known : keys that may stand there
    """
    name, step, before = ".".join(path), path[place], ".".join(path[:place])
    message = f"{what} '{name}': no key '{step}'{f' under {before!r}' * bool(before)}"
    if place == 0:
        whole = find_whole_key(path, root) if model is schema.StudySpec else ""
        hint = f"write the whole key, `{whole}`" if whole else nearest(step, known)
        return message, hint
    if step in known:
        return message, f"give '{before}' as a mapping with '{step}' in it"
    if path[0] == "cases" and path[2:3] == ["links"] and above is None:
        without = ".".join((*path[:2], *path[4:]))
        if can_vary(without, root.mark, root, Problems(""), model=model):
            return message, f"this case has one link: write `{without}`"
    if above is not None and not isinstance(above, dict | list):
        owner = (
            f" of {path[0].removesuffix('s')} '{path[1]}'" if place > 2 and path[0] in ("buildings", "cases") else ""
        )
        is_number = isinstance(above, int | float) or written_unit(above) != ""
        message = f"{what} '{name}': '{path[place - 1]}'{owner} is {'a number' if is_number else 'a word'}, {above}"
        without = ".".join((*path[: place - 1], *path[place:]))
        hints = [key for key in (without, before) if can_vary(key, root.mark, root, Problems(""), model=model)]
        return message, f"write {' or '.join(f'`{key}`' for key in hints)}" if hints else nearest(step, known)
    return message, nearest(step, known)


def find_whole_key(path: Sequence[str], root: Map) -> str:
    """Return the dotted key of the study that the end of one stands for, `buildings.B.period` for `B.period`; "" where
    there is none."""
    buildings, cases, laws = (list(get(root, section) or ()) for section in ("buildings", "cases", "laws"))
    above = [
        *(("buildings",), ("cases",), ("laws",)),
        *(("buildings", name) for name in buildings),
        ("impact",),
        *(("cases", name) for name in cases),
        *(("records",), ("records", "scale")),
        *(("laws", name, "parameters") for name in laws),
    ]
    keys = (".".join((*steps, *path)) for steps in above)
    found = [key for key in keys if _is_known(key.split("."), root)]
    return next((key for key in found if can_vary(key, root.mark, root, Problems(""))), (*found, "")[0])


def _is_known(path: list[str], root: Map) -> bool:
    """Return whether the schema knows a value at a path, whatever the file has there."""
    if _is_section(path, root, schema.StudySpec):
        return False
    for place, step in enumerate(path):
        above = get(root, *path[:place])
        is_item = isinstance(above, list) and step.isdigit() and int(step) < len(above)
        if not is_item and step not in _known(path[:place], root, schema.StudySpec):
            return False
    return True


_LIKELY = ("period", "gap", "stiffness", "scale", "restitution", "force")
"""Keys that a sweep is likely to be of."""


def _value_in_section(path: Sequence[str], root: Map, model: type[BaseModel]) -> str:
    """Return the dotted key of a value below a section, one that is likely to vary."""
    steps = [*path]
    while _is_section(steps, root, model):
        below = _known(steps, root, model)
        if not below:
            return ".".join((*steps, "KEY"))
        above = get(root, *steps)
        written = [key for key in below if isinstance(above, dict) and key in above]
        steps.append(next((key for key in _LIKELY if key in below), (written or below)[0]))
    return ".".join(steps)


def _known(path: list[str], root: Map, model: type[BaseModel]) -> list[str]:
    """Return the keys that may stand at a path."""
    return keys_at(model, path, root)


def read_axis_values(
    name: str, holder: Map, problems: Problems, model: type[BaseModel] = schema.StudySpec
) -> Values | None:
    """The values of a swept key; None where something is wrong, which is noted."""
    given, mark, quantity = holder[name], holder.marks[name][1], quantity_at(model, tuple(name.split(".")))
    if isinstance(given, Map) and not given.keys().isdisjoint(_RANGE):
        return _range(name, given, quantity or Quantity("number", "", "5"), problems)
    if isinstance(given, Map) and "values" in given:
        refuse_unknown(given, _BRACKET, f"the axis '{name}'", problems)
        mark, given = given.marks["values"][1], given["values"]
    if not isinstance(given, Items) or not 0 < len(given) <= MAX_VALUES:
        ranged = range_example(quantity, ", count: 5")
        hint = f"write `{name}: [first, second]`, at most {MAX_VALUES} values, or a range: `{name}: {ranged}`"
        problems.add(mark, f"the axis '{name}' has no list of values, or too long a one", hint)
        return None
    return given, given.marks, unit_of(given, quantity)


def with_middles(root: Map, problems: Problems) -> Map:
    """The tree with the middle of every unknown value (`{values: [...], middle: ...}`) where its key stands: figures
    and the answer show it."""
    for holder in sweep_maps(root):
        for name, node in holder.items():
            if not isinstance(node, Map) or "middle" not in node:
                continue
            values: Any = node.get("values")
            steps, middle, mark = name.split("."), node["middle"], node.marks["middle"][1]
            quantity, own = quantity_at(schema.StudySpec, tuple(steps)), get(root, *steps)
            is_odd = isinstance(values, Items) and len(values) >= 3 and len(values) % 2 == 1
            others = [values[len(values) // 2], middle if own is None else own] if is_odd else []
            if not others or any(
                canonical_value(other, quantity) != canonical_value(middle, quantity) for other in others
            ):
                what = f"{middle} is not the middle of an odd number of values, or not what the study has there"
                hint = f"write low, middle and high, e.g. `{name}: {{values: [low, middle, high], middle: middle}}`"
                problems.add(mark, f"'{name}': {what}", hint)
                continue
            if can_vary(name, holder.marks[name][0], root, Problems("")):  # else the axis says what is wrong
                root = with_value(root, steps, middle, mark)
    return root


def canonical_value(value: Any, quantity: Quantity | None) -> Any:
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
            if (unit := written_unit(value)) and (one := find_unit_factor(unit, quantity.si)) is not None:
                return Unit(unit, one, quantity.si)
        except ValueError:
            continue
    return Unit(quantity.si, 1.0, quantity.si)


def in_unit(number: float, unit: Unit) -> Any:
    """An SI number as a study writes it in a unit."""
    value = unit.number(number)
    plain: int | float = int(value) if value.is_integer() and abs(value) < 1e15 else value
    return f"{plain} {unit.name}" if unit.name else plain


# Mappings of numbers: ranges, distributions


def refuse_unknown(node: Map, known: Sequence[str], owner: str, problems: Problems) -> None:
    """Note the keys that a mapping does not have."""
    for key in node.keys() - {*known}:
        problems.add(node.marks[key][0], f"unknown key '{key}' of {owner}", nearest(key, known))


def read_numbers(
    node: Map, kinds: Mapping[str, Quantity], problems: Problems, needs_unit: bool = False
) -> dict[str, Any] | None:
    """The numbers of a mapping in SI, or as multiples of a storey's stiffness, all with a unit or none; None where
    something is wrong, which is noted.

    kinds : what stands at each key, and may be absent; needs_unit : whether each of them must have its unit
    """
    found, before = dict[str, Any](), len(problems.found)
    for key in kinds.keys() & node.keys():
        try:
            found[key] = kinds[key].read(node[key])
        except PydanticCustomError as error:
            context: dict[str, Any] = error.context or {}
            problems.add(node.marks[key][1], context["message"], context["hint"])
        else:
            if isinstance(found[key], str):
                problems.add(node.marks[key][1], f"'{node[key]}' is not a number", kinds[key].usage)
    refuse_bare([(node[key], node.marks[key][1], kinds[key]) for key in found], problems, needs_unit)
    return None if len(problems.found) > before else {key: found[key] for key in kinds if key in found}


def refuse_bare(written: Sequence[tuple[Any, Mark, Quantity]], problems: Problems, needs_unit: bool = True) -> None:
    """Note numbers without their unit, where others beside them have one (beside 20 % a number is no share: 0.5, or
    50 %?) or each needs it."""
    others = {quantity.name for value, _, quantity in written if written_unit(value)}
    for value, mark, quantity in written if needs_unit or others else ():
        is_bare = isinstance(value, int | float) and value != 0 and quantity.name in others
        if lacks_unit(value, quantity) or is_bare:
            in_si = f"; without one it is in {quantity.si}" if quantity.si else ""
            problems.add(mark, f"{value} has no unit", f"write its unit too, e.g. {quantity.example}{in_si}")


def _range(name: str, node: Map, quantity: Quantity, problems: Problems) -> Values | None:
    """The values of `{from, to, count | step, spacing}`; None where something is wrong, which is noted."""
    before, spacing, count = len(problems.found), node.get("spacing", "linear"), node.get("count")

    def note(key: str, message: str, hint: str) -> None:
        problems.add(node.marks[key][1], message, hint)

    refuse_unknown(node, _RANGE, "a range", problems)
    if not {"from", "to"} <= node.keys() or ("count" in node) == ("step" in node):
        what = f"a range has `from`, `to` and either `count` or `step`, not {', '.join(node)}"
        problems.add(node.mark, what, f"write e.g. `{name}: {range_example(quantity, ', count: 5')}`")
    elif spacing not in ("linear", "log") or (spacing == "log" and "step" in node):
        note("spacing", f"spacing: '{spacing}' is not known here", "write linear, or log beside `count:`")
    elif "count" in node and (type(count) is not int or not 2 <= count <= MAX_VALUES):
        note("count", f"count: {count}; a range has 2 to {MAX_VALUES} values", "write how many values, e.g. 15")
    step = quantity.replace(
        name=f"step of a {quantity.name}", low=-math.inf, high=math.inf, open_low=False, open_high=False
    )
    ends = read_numbers(node, {"from": quantity, "to": quantity, "step": step}, problems)
    if ends is None or len(problems.found) > before:
        return None
    for key, value in ends.items():
        if not isinstance(value, float):
            note(key, f"'{node[key]}' is not a number: a range runs between numbers", quantity.usage)
            return None
    first, last = ends["from"], ends["to"]
    steps = (last - first) / ends["step"] if ends.get("step") else -1.0
    if first == last:
        note("to", "the range ends where it begins", "write `to:` apart from `from:`, or a single value")
    elif spacing == "log" and not first * last > 0:
        note("spacing", "a logarithmic range cannot reach zero", "begin above zero, e.g. `from: 0.1 s`")
    elif count is None and (not 0.5 < steps < MAX_VALUES or not math.isclose(steps, round(steps), rel_tol=1e-9)):
        what = f"steps of {node['step']} do not lead from {node['from']} to {node['to']}: that is {steps:.4g} steps"
        note("step", what, f"change an end or the step, at most {MAX_VALUES} values, or write `count:`")
    if len(problems.found) > before:
        return None
    count = count or round(steps) + 1
    shares = [place / (count - 1) for place in range(count - 1)]
    values = [first * (last / first) ** s if spacing == "log" else first + (last - first) * s for s in shares]
    written = [node[key] for key in ends]
    unit = unit_of(written, quantity)
    own = unit if any(map(written_unit, written)) else Unit()  # without one the values have none either
    return [in_unit(number, own) for number in (*values, last)], [node.mark] * count, unit

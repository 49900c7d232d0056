"""The axes of a sweep: dotted keys with their values, lists or ranges; keys of one list entry move together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from pydantic import BaseModel
from pydantic_core import PydanticCustomError

from pounding_cli.numbers import Unit
from pounding_cli.study import schema
from pounding_cli.study.file import Items, Map, Mark, Problems, get, nearest, with_value
from pounding_cli.study.quantity import Quantity, format_location, lacks_unit, written_unit
from pounding_cli.study.words import keys_at, names_in, quantity_at, value_at
from pounding_cli.units import find_unit_factor

MAX_POINTS = 2_000_000
"""Largest number of points of a sweep."""

MAX_AXES = 20
"""Largest number of axes of a sweep."""

MAX_VALUES = 10_000
"""Largest number of values of an axis."""

_RANGE_KEYS = ("from", "to", "count", "step", "spacing")
_BRACKET_KEYS = ("values", "middle")


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
    """A value that the file does not write."""

    def __str__(self) -> str:
        return "default"


UNWRITTEN = _Unwritten()
"""Value at a point of an axis of a key that the file leaves to its default."""


class WrittenValues(NamedTuple):
    """The values of a swept key.

    values : as the file writes them
    marks : where each stands
    unit : in which they are written
    """

    values: Sequence[Any]
    marks: Sequence[Mark]
    unit: Unit


@dataclass(frozen=True, eq=False)
class Axis:
    """One dimension of a sweep.

    names : dotted keys as in the file, more than one when they move together
    written_values : the values of the keys at every point as the file writes them
    marks : where these stand
    units : the unit in which each key is written; SI where none is given
    model : model of the file
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
        """Return the values at a point in words."""
        values = self.written_values[place]
        return ", ".join(f"{name} = {value}" for name, value in zip(self.names, values, strict=True))

    @cached_property
    def values(self) -> tuple[tuple[float | str, ...], ...]:
        """One tuple per point, as long as names: SI numbers, or the file's text for what is no number."""
        paths = [tuple(path) for path in self.paths]
        return tuple(
            tuple(value_at(self.model, path, value) for path, value in zip(paths, row, strict=True))
            for row in self.written_values
        )

    def display_values(self, place: int) -> tuple[str, ...]:
        """Return the values at a point in the units of the study, e.g. ("0.7 g",)."""
        return tuple(unit.text(value) for unit, value in zip(self.units, self.values[place], strict=True))


def sweep_maps(root: Any) -> list[Map]:
    """Return the mappings of keys to values under `sweep:`."""
    sweep = get(root, "sweep")
    nodes = sweep if isinstance(sweep, Items) else [sweep]
    return [node for node in nodes if isinstance(node, Map)]


def read_axes(root: Map, problems: Problems, model: type[BaseModel] = schema.StudySpec) -> tuple[Axis, ...]:
    """Return the axes under `sweep:`, one for each key of a mapping.  Note what is wrong."""
    sweep = root.get("sweep")
    if sweep is None:
        return ()
    _, mark = root.marks.get("sweep", (root.mark, root.mark))
    if not _is_sweep(sweep):
        hint = "write `sweep: {impact.restitution: [0.4, 0.5]}`, or a list of such mappings"
        problems.add(mark, "'sweep' is not a mapping of keys to values", hint)
        return ()
    if isinstance(sweep, Map):
        entries = [(sweep, [name]) for name in sweep]
    else:
        entries = [(holder, list(holder)) for holder in sweep]
    if len(entries) > MAX_AXES:
        problems.add(mark, f"the sweep has {len(entries)} axes", f"keep it to {MAX_AXES}")
        return ()
    first_marks: dict[str, Mark] = {}
    axes = []
    for holder, names in entries:
        axis = _read_axis(holder, names, root, problems, model, first_marks)
        if axis is not None:
            _refuse_equal_points(axis, problems)
            axes.append(axis)
    point_count = math.prod(len(axis) for axis in axes)
    if point_count > MAX_POINTS:
        hint = f"keep it to {MAX_POINTS}: make axes shorter, or let keys move together in a list entry"
        problems.add(mark, f"the sweep has {point_count} points", hint)
        return ()
    return tuple(axes)


def _is_sweep(sweep: Any) -> bool:
    """Return whether a value is a mapping, or a list of mappings that hold something."""
    if isinstance(sweep, Items):
        return all(isinstance(node, Map) and len(node) > 0 for node in sweep)
    return isinstance(sweep, Map)


def _read_axis(
    holder: Map,
    names: Sequence[str],
    root: Map,
    problems: Problems,
    model: type[BaseModel],
    first_marks: dict[str, Mark],
) -> Axis | None:
    """Return the axis of some keys that move together; None where something is wrong, which is noted.

    holder : mapping in which the keys stand
    first_marks : where each key of the axes before stands; those of this axis are added
    """
    columns = []
    for name in names:
        mark = holder.marks[name][0]
        values = None
        if can_vary(name, mark, root, problems, model=model):
            values = read_axis_values(name, holder, problems, model)
        if name in first_marks:
            first = format_location(first_marks[name])
            problems.add(mark, f"'{name}' is an axis twice; first {first}", "remove one of the two")
        elif values is not None:
            columns.append(values)
        first_marks.setdefault(name, mark)
    if len(columns) < len(names):
        return None
    if len({len(column.values) for column in columns}) > 1:
        lengths = [f"{name} has {len(column.values)}" for name, column in zip(names, columns, strict=True)]
        message = f"keys that move together need as many values each: {', '.join(lengths)}"
        problems.add(holder.mark, message, "give as many values of each")
        return None
    written_values = list(zip(*(column.values for column in columns), strict=True))
    marks = list(zip(*(column.marks for column in columns), strict=True))
    return Axis(tuple(names), written_values, marks, tuple(column.unit for column in columns), model)


def _refuse_equal_points(axis: Axis, problems: Problems) -> None:
    """Note the points of an axis that occurred before."""
    first_places: dict[tuple[float | str, ...], int] = {}
    for place, values in enumerate(axis.values):
        first = first_places.setdefault(values, place)
        if first != place:
            message = f"{axis.format_point(first)} and {axis.format_point(place)} are the same point of this axis"
            problems.add(axis.marks[place][0], message, "remove one of the two")


def can_vary(
    name: str,
    mark: Mark,
    root: Map,
    problems: Problems,
    what: str = "sweep axis",
    model: type[BaseModel] = schema.StudySpec,
) -> bool:
    """Return whether a dotted key can differ from point to point; note why it cannot.

    what : the key in words
    """
    path = name.split(".")
    if _is_fixed(path, root, model):
        _refuse_fixed(name, mark, root, problems, what, model)
        return False
    for place, step in enumerate(path):
        above = get(root, *path[:place])
        known = keys_at(model, path[:place], root)
        is_item = isinstance(above, list) and step.isdigit() and int(step) < len(above)
        is_key = step in known and (above is None or isinstance(above, dict))
        if not is_item and not is_key:
            message, hint = describe_wrong_step(path, place, above, known, root, model)
            problems.add(mark, f"{what} '{name}': {message}", hint)
            return False
    if _is_section(path, root, model):
        example = _value_in_section(path, root, model)
        problems.add(mark, f"{what} '{name}' is a whole section", f"name one value in it, e.g. `{example}`")
        return False
    return True


def _is_fixed(path: Sequence[str], root: Map, model: type[BaseModel]) -> bool:
    """Return whether a key has one value for all points."""
    if model is not schema.StudySpec:
        return path[0] in {"title", "sweep"}
    is_of_question = path[0] in root and path[0] not in schema.StudySpec.model_fields
    return is_of_question or path[0] in schema.ONCE or path[:2] == ["records", "use"] or path[-1] == "like"


def _refuse_fixed(name: str, mark: Mark, root: Map, problems: Problems, what: str, model: type[BaseModel]) -> None:
    """Note a key that has one value for all points, with the key that is meant instead where there is one."""
    path = name.split(".")
    may_be_short = model is schema.StudySpec and path[-1] != "like" and "sweep" not in path
    whole_key = find_whole_key(path, root) if may_be_short else ""
    hint = f"write the whole key, `{whole_key}`" if whole_key else "run one study for each value"
    problems.add(mark, f"{what} '{name}' cannot vary: it is one for the whole study", hint)


def _is_section(path: Sequence[str], root: Map, model: type[BaseModel]) -> bool:
    """Return whether a path leads to a section that no single value can stand for."""
    if model is schema.StudySpec:
        least_depth = {"buildings": 3, "cases": 3, "laws": 3, "tail": 1}.get(path[0], 2)
        return len(path) < least_depth
    return bool(keys_at(model, path, root))


def describe_wrong_step(
    path: Sequence[str], place: int, above: Any, known: list[str], root: Map, model: type[BaseModel]
) -> tuple[str, str]:
    """Return what is wrong with a dotted key whose step at `place` leads nowhere, and what to write.

    above : what stands in the file above that step
    known : keys that may stand there
    """
    step = path[place]
    before = ".".join(path[:place])

    def find_allowed(*keys: str) -> list[str]:
        return [key for key in keys if can_vary(key, root.mark, root, Problems(""), model=model)]

    if isinstance(above, list):
        return describe_missing_entry(path, place, above)
    message = f"no key '{step}'{f' under {before!r}' if before else ''}"
    if place == 0:
        whole_key = find_whole_key(path, root) if model is schema.StudySpec else ""
        return message, f"write the whole key, `{whole_key}`" if whole_key else nearest(step, known)
    if step in known:
        return message, f"give '{before}' as a mapping with '{step}' in it"
    if path[0] == "cases" and path[2:3] == ["links"] and above is None:
        of_one_link = ".".join((*path[:2], *path[4:]))
        if find_allowed(of_one_link):
            return message, f"this case has one link: write `{of_one_link}`"
    if above is None or isinstance(above, dict):
        return message, nearest(step, known)
    owner = ""
    if place > 2 and path[0] in ("buildings", "cases"):
        owner = f" of {path[0].removesuffix('s')} '{path[1]}'"
    kind = "a number" if isinstance(above, int | float) or written_unit(above) else "a word"
    message = f"'{path[place - 1]}'{owner} is {kind}, {above}"
    without_step_above = ".".join((*path[: place - 1], *path[place:]))
    allowed = find_allowed(without_step_above, before)
    return message, f"write {' or '.join(f'`{key}`' for key in allowed)}" if allowed else nearest(step, known)


def describe_missing_entry(path: Sequence[str], place: int, entries: Sequence[Any]) -> tuple[str, str]:
    """Return what is wrong with a dotted key whose step at `place` is no entry of a list, and what to write."""
    message = f"no entry '{path[place]}' in the list '{'.'.join(path[:place])}'"
    return message, f"{nearest(path[place], map(str, range(len(entries))))} (entries count from 0)"


def find_whole_key(path: Sequence[str], root: Map) -> str:
    """Return the dotted key of the study that the end of one stands for, `buildings.B.period` for `B.period`; "" where
    there is none."""
    sections: list[tuple[str, ...]] = [("buildings",), ("cases",), ("laws",)]
    sections += [("buildings", name) for name in names_in(root, "buildings")]
    sections.append(("impact",))
    sections += [("cases", name) for name in names_in(root, "cases")]
    sections += [("records",), ("records", "scale")]
    sections += [("laws", name, "parameters") for name in names_in(root, "laws")]
    paths = [[*section, *path] for section in sections]
    keys = [".".join(whole) for whole in paths if _is_known(whole, root)]
    for key in keys:
        if can_vary(key, root.mark, root, Problems("")):
            return key
    return keys[0] if keys else ""


def _is_known(path: list[str], root: Map) -> bool:
    """Return whether the schema knows a value at a path, whatever the file has there."""
    if _is_section(path, root, schema.StudySpec):
        return False
    for place, step in enumerate(path):
        above = get(root, *path[:place])
        is_item = isinstance(above, list) and step.isdigit() and int(step) < len(above)
        if not is_item and step not in keys_at(schema.StudySpec, path[:place], root):
            return False
    return True


_LIKELY = ("period", "gap", "stiffness", "scale", "restitution", "force")
"""Keys that a sweep is likely to be of."""


def _value_in_section(path: Sequence[str], root: Map, model: type[BaseModel]) -> str:
    """Return the dotted key of a value below a section, one that is likely to vary."""
    steps = [*path]
    while _is_section(steps, root, model):
        below = keys_at(model, steps, root)
        if not below:
            return ".".join((*steps, "KEY"))
        above = get(root, *steps)
        written = [key for key in below if isinstance(above, dict) and key in above]
        steps.append(next((key for key in _LIKELY if key in below), (written or below)[0]))
    return ".".join(steps)


def read_axis_values(
    name: str, holder: Map, problems: Problems, model: type[BaseModel] = schema.StudySpec
) -> WrittenValues | None:
    """Return the values of a swept key; None where something is wrong, which is noted."""
    node = holder[name]
    mark = holder.marks[name][1]
    quantity = quantity_at(model, tuple(name.split(".")))
    if isinstance(node, Map) and not node.keys().isdisjoint(_RANGE_KEYS):
        return _read_range(name, node, quantity or Quantity("number", "", "5"), problems)
    if isinstance(node, Map) and "values" in node:
        refuse_unknown(node, _BRACKET_KEYS, f"the axis '{name}'", problems)
        mark = node.marks["values"][1]
        node = node["values"]
    if not isinstance(node, Items) or not 0 < len(node) <= MAX_VALUES:
        example = range_example(quantity, ", count: 5")
        hint = f"write `{name}: [first, second]`, at most {MAX_VALUES} values, or a range: `{name}: {example}`"
        problems.add(mark, f"the axis '{name}' has no list of values, or too long a one", hint)
        return None
    return WrittenValues(node, node.marks, unit_of(node, quantity))


def with_middles(root: Map, problems: Problems) -> Map:
    """Return the tree with the middle of every unknown value, `{values: [...], middle: ...}`, where its key stands:
    figures and the answer show it."""
    for holder in sweep_maps(root):
        for name, node in holder.items():
            if not isinstance(node, Map) or "middle" not in node:
                continue
            mark = node.marks["middle"][1]
            if not _is_middle(name, node, root):
                message = (
                    f"'{name}': {node['middle']} is not the middle of an odd number of values, "
                    "or not what the study has there"
                )
                hint = f"write low, middle and high, e.g. `{name}: {{values: [low, middle, high], middle: middle}}`"
                problems.add(mark, message, hint)
            elif can_vary(name, holder.marks[name][0], root, Problems("")):  # else the axis says what is wrong
                root = with_value(root, name.split("."), node["middle"], mark)
    return root


def _is_middle(name: str, node: Map, root: Map) -> bool:
    """Return whether the middle of an unknown value is that of an odd number of values, and what the study has."""
    values: Any = node.get("values")
    if not isinstance(values, Items) or len(values) < 3 or len(values) % 2 == 0:
        return False
    path = name.split(".")
    quantity = quantity_at(schema.StudySpec, tuple(path))
    middle = canonical_value(node["middle"], quantity)
    value_of_study = get(root, *path)
    is_middle = canonical_value(values[len(values) // 2], quantity) == middle
    return is_middle and (value_of_study is None or canonical_value(value_of_study, quantity) == middle)


def canonical_value(value: Any, quantity: Quantity | None) -> Any:
    """Return what all spellings of one value have in common, such as 0.5 and 1/2."""
    if quantity is None:
        return repr(value)
    try:
        return quantity.read(value)
    except PydanticCustomError:
        return repr(value)


def unit_of(values: Sequence[Any], quantity: Quantity | None) -> Unit:
    """Return the first unit written among some values; SI where all are bare numbers."""
    if quantity is None:
        return Unit()
    for value in values:
        name = written_unit(value)
        if not name:
            continue
        try:
            factor = find_unit_factor(name, quantity.si)
        except ValueError:
            continue
        if factor is not None:
            return Unit(name, factor, quantity.si)
    return Unit(quantity.si, 1.0, quantity.si)


def in_unit(number: float, unit: Unit) -> Any:
    """Return an SI number as a study writes it in a unit."""
    value = unit.number(number)
    is_whole = value.is_integer() and abs(value) < 1e15
    short = int(value) if is_whole else value
    return f"{short} {unit.name}" if unit.name else short


# Mappings of numbers: ranges, distributions


def refuse_unknown(node: Map, known: Sequence[str], owner: str, problems: Problems) -> None:
    """Note the keys that a mapping does not have."""
    for key in node.keys() - {*known}:
        problems.add(node.marks[key][0], f"unknown key '{key}' of {owner}", nearest(key, known))


def read_numbers(
    node: Map, kinds: Mapping[str, Quantity], problems: Problems, needs_unit: bool = False
) -> dict[str, Any] | None:
    """Return the numbers of a mapping in SI, or as multiples of a storey's stiffness, all with a unit or none; None
    where something is wrong, which is noted.

    kinds : quantity at each key, which may be absent
    needs_unit : each of them must have its unit
    """
    count_before = len(problems.found)
    numbers: dict[str, Any] = {}
    for key, quantity in kinds.items():
        if key not in node:
            continue
        mark = node.marks[key][1]
        try:
            number = quantity.read(node[key])
        except PydanticCustomError as error:
            context: dict[str, Any] = error.context or {}
            problems.add(mark, context["message"], context["hint"])
            continue
        if isinstance(number, str):
            problems.add(mark, f"'{node[key]}' is not a number", quantity.usage)
        numbers[key] = number
    refuse_bare([(node[key], node.marks[key][1], kinds[key]) for key in numbers], problems, needs_unit)
    return None if len(problems.found) > count_before else numbers


def refuse_bare(written: Sequence[tuple[Any, Mark, Quantity]], problems: Problems, needs_unit: bool = True) -> None:
    """Note numbers without their unit, where others beside them have one (beside 20 % a number is no share: 0.5, or
    50 %?) or each needs it."""
    with_unit = {quantity.name for value, _, quantity in written if written_unit(value)}
    if not needs_unit and not with_unit:
        return
    for value, mark, quantity in written:
        is_bare_beside_others = isinstance(value, int | float) and value != 0 and quantity.name in with_unit
        if lacks_unit(value, quantity) or is_bare_beside_others:
            in_si = f"; without one it is in {quantity.si}" if quantity.si else ""
            problems.add(mark, f"{value} has no unit", f"write its unit too, e.g. {quantity.example}{in_si}")


def _read_range(name: str, node: Map, quantity: Quantity, problems: Problems) -> WrittenValues | None:
    """Return the values of `{from, to, count | step, spacing}`; None where something is wrong, which is noted."""
    count_before = len(problems.found)
    _check_range_keys(name, node, quantity, problems)
    numbers = _read_range_numbers(node, quantity, problems)
    if numbers is None or len(problems.found) > count_before:
        return None
    is_log = node.get("spacing") == "log"
    first = numbers["from"]
    last = numbers["to"]
    count = node.get("count")
    if not _check_ends(node, first, last, is_log, problems):
        return None
    if count is None:
        count = _find_count(node, first, last, numbers["step"], problems)
        if count is None:
            return None
    written = [node[key] for key in numbers]
    unit = unit_of(written, quantity)
    has_unit = any(written_unit(value) for value in written)
    unit_to_write = unit if has_unit else Unit()  # without one the values have none either
    values = [in_unit(number, unit_to_write) for number in _space_numbers(first, last, count, is_log)]
    return WrittenValues(values, [node.mark] * count, unit)


def _check_range_keys(name: str, node: Map, quantity: Quantity, problems: Problems) -> None:
    """Note a range that lacks a key, has one too many, or an unknown spacing or count."""
    refuse_unknown(node, _RANGE_KEYS, "a range", problems)
    spacing = node.get("spacing", "linear")
    count = node.get("count")
    if not {"from", "to"} <= node.keys() or ("count" in node) == ("step" in node):
        message = f"a range has `from`, `to` and either `count` or `step`, not {', '.join(node)}"
        problems.add(node.mark, message, f"write e.g. `{name}: {range_example(quantity, ', count: 5')}`")
    elif spacing not in ("linear", "log") or (spacing == "log" and "step" in node):
        message = f"spacing: '{spacing}' is not known here"
        problems.add(node.marks["spacing"][1], message, "write linear, or log beside `count:`")
    elif "count" in node and (type(count) is not int or not 2 <= count <= MAX_VALUES):
        message = f"count: {count}; a range has 2 to {MAX_VALUES} values"
        problems.add(node.marks["count"][1], message, "write how many values, e.g. 15")


def _read_range_numbers(node: Map, quantity: Quantity, problems: Problems) -> dict[str, float] | None:
    """Return the ends and the step of a range in SI; None where one is no number, which is noted."""
    step = quantity.replace(
        name=f"step of a {quantity.name}", low=-math.inf, high=math.inf, open_low=False, open_high=False
    )
    numbers = read_numbers(node, {"from": quantity, "to": quantity, "step": step}, problems)
    for key, number in (numbers or {}).items():
        if not isinstance(number, float):
            message = f"'{node[key]}' is not a number: a range runs between numbers"
            problems.add(node.marks[key][1], message, quantity.usage)
            return None
    return numbers


def _check_ends(node: Map, first: float, last: float, is_log: bool, problems: Problems) -> bool:
    """Return whether a range can run between two ends; note why it cannot."""
    if first == last:
        hint = "write `to:` apart from `from:`, or a single value"
        problems.add(node.marks["to"][1], "the range ends where it begins", hint)
        return False
    if is_log and not first * last > 0:
        hint = "begin above zero, e.g. `from: 0.1 s`"
        problems.add(node.marks["spacing"][1], "a logarithmic range cannot reach zero", hint)
        return False
    return True


def _find_count(node: Map, first: float, last: float, step: float, problems: Problems) -> int | None:
    """Return the number of values between two ends, a step apart; None where steps do not fit, which is noted."""
    steps = (last - first) / step if step else -1.0
    if 0.5 < steps < MAX_VALUES and math.isclose(steps, round(steps), rel_tol=1e-9):
        return round(steps) + 1
    message = f"steps of {node['step']} do not lead from {node['from']} to {node['to']}: that is {steps:.4g} steps"
    hint = f"change an end or the step, at most {MAX_VALUES} values, or write `count:`"
    problems.add(node.marks["step"][1], message, hint)
    return None


def _space_numbers(first: float, last: float, count: int, is_log: bool) -> list[float]:
    """Return numbers from the first to the last, equally apart or in equal ratios."""
    shares = [place / (count - 1) for place in range(count - 1)]
    if is_log:
        return [*(first * (last / first) ** share for share in shares), last]
    return [*(first + (last - first) * share for share in shares), last]

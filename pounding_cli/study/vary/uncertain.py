"""Read the keys that vary: under `uncertain:`, those that `optimise` searches, those of buildings only seen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.study.schema import study as schema
from pounding_cli.study.schema.archetypes import UNCERTAIN_KEYS, Seen, list_seen
from pounding_cli.study.schema.lookup import quantity_at
from pounding_cli.study.schema.quantity import Quantity, StoreyMultiple, format_location, quote
from pounding_cli.study.text.file import Items, Map, Mark, Problems
from pounding_cli.study.vary.axes import sweep_maps
from pounding_cli.study.vary.dotted_keys import can_vary
from pounding_cli.study.vary.inputs import (
    MOTION,
    ChoiceInput,
    DistributedInput,
    Distribution,
    KeyInput,
    MotionInput,
    UncertainInput,
    find_storey,
)
from pounding_cli.study.vary.ranges import (
    canonical_value,
    check_mapping,
    example_values,
    range_example,
    read_numbers,
    refuse_bare,
    refuse_unknown,
    unit_of,
)

ANY = "any"
"""The choice of one of the motions."""

BOOTSTRAP = "bootstrap"
"""The choice of as many motions as there are, drawn anew with replacement."""

REQUIRED_FIELDS = {
    "uniform": ("from", "to"), "normal": ("mean", "sd"), "lognormal": ("median", "spread"),
    "triangular": ("from", "mode", "to"),
}  # fmt: skip
"""Fields that must be written of every distribution."""

_OPTIONAL_FIELDS = {
    "uniform": ("spacing",), "normal": ("from", "to"), "lognormal": ("from", "to"), "triangular": (),
}  # fmt: skip

CHOICE = "choice"
RANGE = "{from: 0.3, to: 0.6}"
DISTRIBUTIONS = (*REQUIRED_FIELDS, CHOICE)
"""Ways in which a key may vary."""


def distribution_example(name: str, quantity: Quantity | None) -> str:
    """Return how a distribution of a quantity is written."""
    least, low, most_likely, value = example_values(quantity, 0.1, 0.5, 0.8, 1.0)
    fields = {
        "uniform": f"{{from: {low}, to: {value}}}",
        "normal": f"{{mean: {value}, sd: {least}}}",
        "lognormal": f"{{median: {value}, spread: 0.2}}",
        "triangular": f"{{from: {low}, mode: {most_likely}, to: {value}}}",
        CHOICE: f"[{low}, {value}]",
    }
    return f"{{{name}: {fields[name]}}}"


MAX_OVER_MEDIAN = 6.0
"""Largest value over the median of an input of a building that is only seen [-]: beyond four standard deviations."""

_MULTIPLE = Quantity("multiple of a storey's stiffness", "", "20 x stiffest storey", 0.0, open_low=True)


def read_uncertain(root: Map, problems: Problems, motion_count: int = 0) -> list[UncertainInput]:
    """Return the inputs under `uncertain:`; keys of one entry of a list move together.  Note what is wrong.

    Behind them stand what is uncertain of buildings that are only seen, unless its key is swept or stands there too.

    motion_count : number of the motions of the study, for a choice of motions that is drawn from
    """
    written = [] if root.get("uncertain") is None else _read_written(root, problems, motion_count)
    known = {member.key for each in written for member in each.members}
    return [*written, *(each for each in list_seen_inputs(root) if each.key not in known)]


def is_uncertain(root: Map) -> bool:
    """Return whether a study has keys that are uncertain: by `uncertain:`, or of buildings that are only seen."""
    return root.get("uncertain") is not None or bool(list_seen_inputs(root))


def list_seen_inputs(root: Map) -> list[DistributedInput]:
    """Return what is uncertain of the buildings of the group that are only seen, without keys that are swept."""
    swept = {key for holder in sweep_maps(root) for key in holder}
    inputs = []
    for seen in list_seen(root):
        prefix = f"buildings.{seen.name}."
        is_one_of_them = seen.spec.sample > 0 or any(key.startswith(f"{prefix}archetype.") for key in swept)
        for quantity in () if is_one_of_them else seen.uncertain_quantities():
            key = f"{prefix}{UNCERTAIN_KEYS[quantity]}"
            if key not in swept:
                inputs.append(_build_seen_input(key, seen, quantity))
    return inputs


def _build_seen_input(key: str, seen: Seen, quantity: str) -> DistributedInput:
    """Return a lognormal input of a building that is only seen."""
    kind = quantity_at(schema.StudySpec, tuple(key.split(".")))
    assert kind is not None
    fields = {"median": seen.median(quantity), "spread": seen.archetype.spreads[quantity]}
    if np.isfinite(kind.high):
        fields["to"] = min(kind.high, MAX_OVER_MEDIAN * fields["median"])
    unit = Unit(kind.si, 1.0, kind.si)
    return DistributedInput(
        key=key, mark=seen.mark, unit=unit, quantity=kind, distribution=Distribution("lognormal", fields)
    )


def _read_written(root: Map, problems: Problems, motion_count: int) -> list[UncertainInput]:
    """Return the inputs under `uncertain:`.  Note what is wrong."""
    node = root["uncertain"]
    node_mark = root.marks["uncertain"][1]
    is_list = isinstance(node, Items)
    entries = zip(node, node.marks, strict=True) if is_list else [(node, node_mark)]
    example = distribution_example("uniform", None)
    inputs: list[UncertainInput] = []
    first_marks: dict[str, Mark] = {}
    for entry, entry_mark in entries:
        of_entry: list[UncertainInput] = []
        for key, mark in _iter_unswept_keys("uncertain", entry, entry_mark, root, problems, example):
            if key in first_marks:
                problems.add(mark, f"'{key}' is also {format_location(first_marks[key])}", "remove one of the two")
                continue
            first_marks[key] = mark
            each: UncertainInput | None = None
            if key == MOTION:
                each = _read_motion_input(entry, problems, motion_count)
            elif can_vary(key, mark, root, problems, "the key"):
                each = _read_key_input(key, entry, problems, is_joined=is_list and len(entry) > 1)
            if each is not None:
                of_entry.append(each)
        inputs += _join_inputs(entry, of_entry, problems) if is_list else of_entry
    return inputs


def read_searched(root: Map, problems: Problems) -> list[KeyInput]:
    """Return the inputs under `optimise.over:`, `{from: 1, to: 5}` or `{choice: [1, 2]}`.  Note what is wrong."""
    over = root["optimise"]["over"]
    over_mark = root["optimise"].marks["over"][1]
    inputs = []
    for key, mark in _iter_unswept_keys("over", over, over_mark, root, problems, RANGE):
        if can_vary(key, mark, root, problems, "the key"):
            each = _read_key_input(key, over, problems, is_searched=True)
            if each is not None:
                inputs.append(each)
    return inputs


def _iter_unswept_keys(
    section: str, node: Any, at: Mark, root: Map, problems: Problems, example: str
) -> Iterator[tuple[str, Mark]]:
    """Yield the keys of a section that are not swept too, with their places."""
    if not check_mapping(
        section, node, at, f"write keys with how each varies, `impact.restitution: {example}`", problems
    ):
        return
    swept = {key: mark[0] for holder in sweep_maps(root) for key, mark in holder.marks.items()}
    for key, (mark, _) in node.marks.items():
        if key in swept:
            message = f"'{key}' is swept too, {format_location(swept[key])}"
            problems.add(mark, message, "vary it in one of the two")
        else:
            yield key, mark


def _read_motion_input(entry: Map, problems: Problems, motion_count: int) -> MotionInput | None:
    """Return the choice of motions; None where it is not understood, which is noted."""
    mark, value_mark = entry.marks[MOTION]
    if entry[MOTION] not in (ANY, BOOTSTRAP):
        hint = "write `motion: any` (one of them) or `motion: bootstrap` (as many, drawn with replacement)"
        problems.add(value_mark, f"motion: {quote(entry[MOTION])} is not known", hint)
        return None
    is_bootstrap = entry[MOTION] == BOOTSTRAP
    return MotionInput(key=MOTION, mark=mark, unit=Unit(), is_bootstrap=is_bootstrap, motion_count=motion_count)


def _join_inputs(entry: Map, inputs: list[UncertainInput], problems: Problems) -> list[UncertainInput]:
    """Return one input of several keys of an entry; none where they cannot move together, which is noted."""
    if len(inputs) < 2:
        return inputs
    first, *others = inputs
    joined = [other for other in others if isinstance(other, KeyInput)]
    for other in others:
        is_key = isinstance(first, KeyInput) and isinstance(other, KeyInput)
        if not is_key or other.option_count != first.option_count:
            message = "keys that move together need as many options each, or a range each; the motion moves by itself"
            problems.add(other.mark, message, "give as many of each, or write an entry of its own, `- motion: ...`")
            return []
    assert isinstance(first, KeyInput)
    choices = [each for each in (first, *joined) if isinstance(each, ChoiceInput)]
    columns = [[canonical_value(option, each.quantity) for option in each.options] for each in choices]
    _refuse_equal_options(first.key, entry, list(zip(*columns, strict=True)), problems, "in every key of the entry")
    return [replace(first, moves_with=tuple(joined))]


def _refuse_equal_options(key: str, holder: Map, options: Sequence[Any], problems: Problems, where: str = "") -> None:
    """Note the options of a choice that are one value.

    options : canonical values; of keys that move together a tuple each
    where : the keys that are compared, in words
    """
    written = holder[key].get(CHOICE, ())
    for number, option in enumerate(options):
        first = options.index(option)
        if first < number:
            message = f"'{key}': {written[number]} and {written[first]} are one value {where}".rstrip()
            problems.add(written.marks[number], message, "remove one of the two")


def _read_key_input(
    key: str, holder: Map, problems: Problems, is_searched: bool = False, is_joined: bool = False
) -> KeyInput | None:
    """Return how one key varies; None where something is wrong, which is noted.

    is_searched : over a range, which is read as the uniform distribution between its ends
    is_joined : other keys move with it, so that a value may occur twice
    """
    mark, node_mark = holder.marks[key]
    node = holder[key]
    quantity = quantity_at(schema.StudySpec, tuple(key.split(".")))
    if is_searched and not (isinstance(node, Map) and CHOICE in node):
        node = Map({"uniform": node}, node_mark, {"uniform": (node_mark, node_mark)})
    name = next(iter(node)) if isinstance(node, Map) and len(node) == 1 else ""
    if name not in DISTRIBUTIONS:
        place = node.marks[name][0] if name else node_mark
        _refuse_distribution(key, node, place, quantity, problems, is_searched)
        return None
    if name == CHOICE:
        return _read_choice_input(key, holder, quantity, problems, is_joined)
    fields = node[name]
    fields_mark = node.marks[name][1]
    if quantity is None:
        hint = f"write the values to choose from: `{key}: {{choice: [...]}}`"
        problems.add(fields_mark, f"'{key}' takes no number that could be drawn from a range", hint)
        return None
    example = range_example(quantity) if is_searched else distribution_example(name, quantity)
    if not _check_fields(key, name, fields, fields_mark, f"write `{key}: {example}`", problems):
        return None
    distribution = _read_distribution(key, name, fields, fields_mark, quantity, problems)
    if distribution is None:
        return None
    if distribution.storey is None:
        unit = unit_of(list(fields.values()), quantity)
    else:
        unit = Unit(str(distribution.storey).removeprefix("1 "))
    return DistributedInput(key=key, mark=mark, unit=unit, quantity=quantity, distribution=distribution)


def _refuse_distribution(
    key: str, node: Any, mark: Mark, quantity: Quantity | None, problems: Problems, is_searched: bool
) -> None:
    """Note a key that has no known distribution, or more than one; `node` is what stands there."""
    choice = distribution_example(CHOICE, quantity)
    if is_searched:
        expected = f"{range_example(quantity)} or {choice}"
        example = choice
    else:
        expected = f"one distribution: {', '.join(DISTRIBUTIONS)}"
        example = distribution_example("uniform", quantity)
    problems.add(mark, f"'{key}' takes {expected}, not {quote(node)}", f"write e.g. `{key}: {example}`")


def _read_choice_input(
    key: str, holder: Map, quantity: Quantity | None, problems: Problems, is_joined: bool
) -> ChoiceInput | None:
    """Return a key that takes one of some values; None where something is wrong, which is noted."""
    count_before = len(problems.found)
    options = holder[key][CHOICE]
    if not isinstance(options, Items) or len(options) < 2:
        message = f"'{key}': a choice is a list of two values or more, not {quote(options)}"
        example = distribution_example(CHOICE, quantity)
        problems.add(holder[key].marks[CHOICE][1], message, f"write `{key}: {example}`")
        return None
    if not is_joined:
        _refuse_equal_options(key, holder, [canonical_value(option, quantity) for option in options], problems)
    if quantity is not None:
        refuse_bare([(*each, quantity) for each in zip(options, options.marks, strict=True)], problems)
    if len(problems.found) > count_before:
        return None
    unit = unit_of(options, quantity)
    return ChoiceInput(key=key, mark=holder.marks[key][0], unit=unit, quantity=quantity, options=tuple(options))


def _check_fields(key: str, name: str, node: Any, mark: Mark, hint: str, problems: Problems) -> bool:
    """Return whether a distribution is written with the fields that it has; note what is wrong.

    node, mark : its fields as the file writes them, and where they stand
    hint : how to write them
    """
    required = REQUIRED_FIELDS[name]
    if not check_mapping(key, node, mark, hint, problems):
        return False
    count_before = len(problems.found)
    refuse_unknown(node, (*required, *_OPTIONAL_FIELDS[name]), name, problems)
    if len(problems.found) > count_before:
        return False
    missing = [word for word in required if word not in node]
    if missing:
        problems.add(mark, f"'{key}' lacks '{missing[0]}'", hint)
        return False
    spacing = node.get("spacing", "linear")
    if spacing not in ("linear", "log"):
        problems.add(node.marks["spacing"][1], f"spacing: {quote(spacing)} is not known", "write linear or log")
        return False
    return True


def _read_distribution(
    key: str, name: str, node: Map, mark: Mark, quantity: Quantity, problems: Problems
) -> Distribution | None:
    """Return a distribution; None where its numbers are wrong, which is noted."""
    quantities = {word: _field_quantity(word, quantity) for word in node if word != "spacing"}
    values = read_numbers(node, quantities, problems, needs_unit=True)
    if values is None:
        return None
    storey, *other_storeys = {find_storey(value): None for word, value in values.items() if word != "spread"}
    if other_storeys:
        hint = "write each of them as a multiple of one storey's stiffness, or none"
        problems.add(mark, f"'{key}': {', '.join(map(str, node.values()))} are not multiples of the same", hint)
        return None
    fields = {word: value.factor if isinstance(value, StoreyMultiple) else value for word, value in values.items()}
    distribution = Distribution(name, fields, node.get("spacing") == "log", storey)
    fault = _find_fault(key, distribution, quantity if storey is None else _MULTIPLE)
    if fault is None:
        return distribution
    word, message, hint = fault
    problems.add(node.marks[word][1] if word in node else mark, message, hint)
    return None


def _field_quantity(word: str, quantity: Quantity) -> Quantity:
    """Return what stands at a field of a distribution of a quantity."""
    if word == "sd":
        return quantity.replace(name="standard deviation", low=0.0, open_low=True, high=np.inf, open_high=False)
    if word == "spread":
        return Quantity("spread", "", "0.2", 0.0, open_low=True)
    if word == "median" and quantity.low <= 0:  # its logarithm is taken
        return quantity.replace(low=0.0, open_low=True)
    return quantity


def _find_fault(key: str, distribution: Distribution, quantity: Quantity) -> tuple[str, str, str] | None:
    """Return the field (or ""), message and hint where the numbers of a distribution do not fit together, or leave the
    limits of the key."""
    low, high = distribution.ends
    least = max(low, 0.0) if distribution.name == "lognormal" else low
    if not least < high:
        return "to", "the range ends where it begins, or before", "write `to:` above `from:`"
    if not low <= distribution.fields.get("mode", low) <= high:
        return "mode", "the mode lies outside the range", "write it between `from:` and `to:`"
    if distribution.is_log and low <= 0:
        return "from", "a logarithmic range cannot reach zero", "begin above zero"
    with np.errstate(all="ignore"):  # what is beyond the numbers of a computer is refused below
        first, last = distribution(np.array([0.0, 1.0])).tolist()
    is_too_low = first < quantity.low or (quantity.open_low and first == quantity.low)
    is_too_high = last > quantity.high or (quantity.open_high and last == quantity.high)
    if is_too_low or is_too_high:
        number = f"{first if is_too_low else last:.3g} {quantity.si}".rstrip()
        message = f"'{key}': this {distribution.name} distribution reaches {number}"
        bound = "from" if is_too_low else "to"
        return "", f"{message}, but the {quantity.name} must be {quantity.range}", f"write `{bound}:` in it"
    if not (np.isfinite([first, last]).all() and first < last):
        return "", "the range has next to no probability", "move its ends towards the mean"
    return None

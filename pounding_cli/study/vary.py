"""Keys that take values at will: drawn from a distribution, chosen from a list or searched over a range."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.study import schema
from pounding_cli.study.archetypes import UNCERTAIN_KEYS, Seen, list_seen
from pounding_cli.study.axes import (
    can_vary,
    canonical_value,
    example_values,
    in_unit,
    range_example,
    read_numbers,
    refuse_bare,
    refuse_unknown,
    sweep_maps,
    unit_of,
)
from pounding_cli.study.file import Items, Map, Mark, Problems
from pounding_cli.study.quantity import Quantity, StoreyMultiple, format_location
from pounding_cli.study.words import quantity_at

MOTION = "motion"
"""The key that stands for the choice of motions."""

ANY = "any"
"""The choice of one of the motions."""

BOOTSTRAP = "bootstrap"
"""The choice of as many motions as there are, drawn anew with replacement."""

DRAWN_SETS = 64
"""Number of the sets of motions of a bootstrap."""

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


_LEAST = 1e-12
"""Probability beyond the last values of a distribution without an end: seven standard deviations from the mean."""

_TAIL = 0.01
"""Probability beyond which the values of a distribution without an end count as its end."""

MAX_OVER_MEDIAN = 6.0
"""Largest value over the median of an input of a building that is only seen [-]: beyond four standard deviations."""

_MULTIPLE = Quantity("multiple of a storey's stiffness", "", "20 x stiffest storey", 0.0, open_low=True)


@dataclass(frozen=True)
class Distribution:
    """A distribution with its fields in SI.

    name : key in REQUIRED_FIELDS
    is_log : uniform in the logarithm
    storey : its values are multiples of the stiffness of this storey
    """

    name: str
    fields: Mapping[str, float] = field(default_factory=dict)
    is_log: bool = False
    storey: StoreyMultiple | None = None

    @property
    def spacing(self) -> str:
        """Spacing of a range as a study writes it."""
        return "log" if self.is_log else "linear"

    @property
    def ends(self) -> tuple[float, float]:
        """`from` and `to`, infinite where they are not given."""
        return self.fields.get("from", -np.inf), self.fields.get("to", np.inf)

    @cached_property
    def _scipy(self) -> Any:
        """The distribution of scipy, of the logarithm where that is normal."""
        from scipy import stats  # half a second to import, and few studies have distributions

        low, high = self.ends
        if self.name == "uniform":
            return stats.loguniform(low, high) if self.is_log else stats.uniform(low, high - low)
        if self.name == "triangular":
            return stats.triang((self.fields["mode"] - low) / (high - low), low, high - low)
        if self.name == "normal":
            centre = self.fields["mean"]
            width = self.fields["sd"]
        else:
            centre = np.log(self.fields["median"])
            width = self.fields["spread"]
            with np.errstate(divide="ignore"):
                low = np.log(max(low, 0.0))
                high = np.log(high)
        return stats.truncnorm((low - centre) / width, (high - centre) / width, centre, width)

    def __call__(self, u: np.ndarray | float) -> np.ndarray:
        """Return the values at u in [0, 1], which covers what lies between `from` and `to`; same shape."""
        u = np.asarray(u, dtype=float)
        is_endless = self.name in ("normal", "lognormal") and not {"from", "to"} <= self.fields.keys()
        values = self._scipy.ppf(np.clip(u, _LEAST, 1 - _LEAST) if is_endless else u)
        return np.clip(np.exp(values) if self.name == "lognormal" else values, *self.ends)

    def quantile_of(self, value: float) -> float | None:
        """Return the u of a uniform distribution at a value; None beyond its ends."""
        low, high = self.ends
        return float(self._scipy.cdf(value)) if low <= value <= high else None


@dataclass(frozen=True, kw_only=True)
class UncertainInput(ABC):
    """An input of a study that varies with a number u between 0 and 1.

    key : dotted key as in the file; MOTION for the choice of motions
    mark : where the key stands
    unit : unit in which people read its values
    """

    key: str
    mark: Mark
    unit: Unit

    @property
    @abstractmethod
    def members(self) -> tuple[KeyInput, ...]:
        """The keys of the study that move with u."""

    @property
    @abstractmethod
    def option_count(self) -> int:
        """Number of the options that it chooses from; 0 where it is continuous."""

    @abstractmethod
    def end_quantiles(self) -> list[float]:
        """Return the u of both ends of a range, or of every option."""

    @abstractmethod
    def split_at_ends(self, u: np.ndarray, output: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the values of an output at the low and at the high end of the input; None where it has no ends.

        u, output : of every sample, shape (samples,)
        share : part of the range that counts as an end [-]
        """


@dataclass(frozen=True, kw_only=True)
class KeyInput(UncertainInput):
    """A key of the study that varies.

    quantity : what the key takes; None for a word
    moves_with : further keys that move by the same u
    """

    quantity: Quantity | None = None
    moves_with: tuple[KeyInput, ...] = ()

    @property
    def members(self) -> tuple[KeyInput, ...]:
        return (self, *self.moves_with)

    @property
    @abstractmethod
    def middle(self) -> float:
        """The u of the middle of the range or of the options."""

    @property
    @abstractmethod
    def column_unit(self) -> str:
        """SI unit of its column in a table, "1" for a pure number; "" where the column holds texts."""

    @abstractmethod
    def values(self, u: Sequence[float] | np.ndarray) -> list[Any]:
        """Return the values at every u as a study writes them."""

    @abstractmethod
    def to_column(self, u: np.ndarray) -> list[str] | np.ndarray:
        """Return the values at every u as a table has them: SI numbers, or the texts of the options."""

    @abstractmethod
    def quantile_of(self, written: Any) -> float | None:
        """Return the u of a value as the file writes it; None for a value that the key does not take here."""


@dataclass(frozen=True, kw_only=True)
class ChoiceInput(KeyInput):
    """A key that takes one of some values.

    options : the values as the file writes them, two or more
    """

    options: tuple[Any, ...]

    @property
    def option_count(self) -> int:
        return len(self.options)

    @property
    def middle(self) -> float:
        return option_quantile(self.option_count // 2, self.option_count)

    @property
    def column_unit(self) -> str:
        return ""

    def end_quantiles(self) -> list[float]:
        return option_quantiles(self.option_count)

    def split_at_ends(self, u: np.ndarray, output: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
        return _split_by_option(choose_option(u, self.option_count), output)

    def values(self, u: Sequence[float] | np.ndarray) -> list[Any]:
        numbers = choose_option(np.asarray(u), self.option_count)
        return [self.options[number] for number in numbers.tolist()]

    def to_column(self, u: np.ndarray) -> list[str]:
        return [str(option) for option in self.values(u)]

    def quantile_of(self, written: Any) -> float | None:
        value = canonical_value(written, self.quantity)
        numbers = {canonical_value(option, self.quantity): number for number, option in enumerate(self.options)}
        return option_quantile(numbers[value], self.option_count) if value in numbers else None


@dataclass(frozen=True, kw_only=True)
class DistributedInput(KeyInput):
    """A key that is drawn from a distribution, or searched over a range.

    distribution : of its values; of a range the uniform one
    """

    distribution: Distribution

    @property
    def option_count(self) -> int:
        return 0

    @property
    def middle(self) -> float:
        return 0.5

    @property
    def column_unit(self) -> str:
        return self.unit.si or "1"

    def end_quantiles(self) -> list[float]:
        low, high = self.distribution.ends
        return [0.0 if np.isfinite(low) else _TAIL, 1.0 if np.isfinite(high) else 1.0 - _TAIL]

    def split_at_ends(self, u: np.ndarray, output: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
        return output[u < share], output[u >= 1 - share]

    def values(self, u: Sequence[float] | np.ndarray) -> list[Any]:
        numbers = self.to_column(np.asarray(u)).tolist()
        storey = self.distribution.storey
        if storey is None:
            return [in_unit(number, self.unit) for number in numbers]
        return [str(replace(storey, factor=number)) for number in numbers]

    def to_column(self, u: np.ndarray) -> np.ndarray:
        return self.distribution(u)

    def quantile_of(self, written: Any) -> float | None:
        value = canonical_value(written, self.quantity)
        if _find_storey(value) != self.distribution.storey:
            return None
        number = value.factor if isinstance(value, StoreyMultiple) else value
        return self.distribution.quantile_of(number) if isinstance(number, int | float) else None


@dataclass(frozen=True, kw_only=True)
class MotionInput(UncertainInput):
    """The choice of motions: one of them, or as many as there are, drawn anew with replacement.

    is_bootstrap : drawn with replacement
    motion_count : number of the motions of the study
    """

    is_bootstrap: bool
    motion_count: int

    @property
    def members(self) -> tuple[KeyInput, ...]:
        return ()

    @property
    def option_count(self) -> int:
        return DRAWN_SETS if self.is_bootstrap else self.motion_count

    def end_quantiles(self) -> list[float]:
        return option_quantiles(self.option_count)

    def split_at_ends(self, u: np.ndarray, output: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray] | None:
        if self.is_bootstrap:
            return None
        return _split_by_option(choose_option(u, self.option_count), output)

    def draw_sets(self, seed: int) -> np.ndarray:
        """Return the numbers of the motions of every option, shape (options, motions of an option)."""
        if not self.is_bootstrap:
            return np.arange(self.motion_count)[:, None]
        size = self.option_count, self.motion_count
        return np.sort(np.random.default_rng(seed).integers(self.motion_count, size=size), axis=1)


def choose_option(u: np.ndarray, count: int) -> np.ndarray:
    """Return the number of the option, from 0, at every u in [0, 1]."""
    return np.minimum((np.asarray(u) * count).astype(int), count - 1)


def option_quantile(number: int, count: int) -> float:
    """Return the u of an option, in the middle of its share."""
    return (number + 0.5) / count


def option_quantiles(count: int) -> list[float]:
    """Return the u of every option."""
    return [option_quantile(number, count) for number in range(count)]


def _split_by_option(numbers: np.ndarray, output: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the values of an output at the options where its mean is least and most.

    numbers : of the option of every sample, shape (samples,)
    """
    groups = sorted((output[numbers == number] for number in np.unique(numbers)), key=np.mean)
    return groups[0], groups[-1]


# From the file


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
    if not isinstance(node, Map):
        problems.add(at, f"'{section}' is not a mapping of keys", f"write `impact.restitution: {example}`")
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
        problems.add(value_mark, f"motion: '{entry[MOTION]}' is not known", hint)
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
        _refuse_distribution(key, place, quantity, problems, is_searched)
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
    key: str, mark: Mark, quantity: Quantity | None, problems: Problems, is_searched: bool
) -> None:
    """Note a key that has no known distribution, or more than one."""
    choice = distribution_example(CHOICE, quantity)
    if is_searched:
        expected = f"{range_example(quantity)} or {choice}"
        example = choice
    else:
        expected = f"one distribution: {', '.join(DISTRIBUTIONS)}"
        example = distribution_example("uniform", quantity)
    problems.add(mark, f"'{key}' takes {expected}", f"write e.g. `{key}: {example}`")


def _read_choice_input(
    key: str, holder: Map, quantity: Quantity | None, problems: Problems, is_joined: bool
) -> ChoiceInput | None:
    """Return a key that takes one of some values; None where something is wrong, which is noted."""
    count_before = len(problems.found)
    options = holder[key][CHOICE]
    if not isinstance(options, Items) or len(options) < 2:
        message = f"'{key}': a choice is a list of two values or more"
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
    if isinstance(node, Map):
        count_before = len(problems.found)
        refuse_unknown(node, (*required, *_OPTIONAL_FIELDS[name]), name, problems)
        if len(problems.found) > count_before:
            return False
    missing = [word for word in required if not isinstance(node, Map) or word not in node]
    if missing:
        problems.add(mark, f"'{key}' lacks '{missing[0]}'", hint)
        return False
    spacing = node.get("spacing", "linear")
    if spacing not in ("linear", "log"):
        problems.add(node.marks["spacing"][1], f"spacing: '{spacing}' is not known", "write linear or log")
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
    storey, *other_storeys = {_find_storey(value): None for word, value in values.items() if word != "spread"}
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


def _find_storey(value: Any) -> StoreyMultiple | None:
    """Return the storey whose stiffness a value is a multiple of, once its stiffness; None for other values."""
    return replace(value, factor=1.0) if isinstance(value, StoreyMultiple) else None


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

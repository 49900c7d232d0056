"""Keys that take values at will: drawn from a distribution, chosen from a list or searched over a range."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.study import schema
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

ANY, BOOTSTRAP = "any", "bootstrap"
"""What it chooses: one of the motions, or as many as there are, drawn anew with replacement."""

DRAWN_SETS = 64
"""Different sets of motions of a bootstrap."""

NEEDED = {
    "uniform": ("from", "to"), "normal": ("mean", "sd"), "lognormal": ("median", "spread"),
    "triangular": ("from", "mode", "to"),
}  # fmt: skip
"""Every distribution with what must be written of it."""

_MORE = {"uniform": ("spacing",), "normal": ("from", "to"), "lognormal": ("from", "to"), "triangular": ()}
CHOICE, RANGE = "choice", "{from: 0.3, to: 0.6}"
DISTRIBUTIONS = (*NEEDED, CHOICE)
"""How a key may vary."""


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

_MULTIPLE = Quantity("multiple of a storey's stiffness", "", "20 x stiffest storey", 0.0, open_low=True)


@dataclass(frozen=True)
class Distribution:
    """A distribution with its fields in SI; `spacing` as written.

    storey : its values are multiples of the stiffness of this storey
    """

    name: str
    fields: Mapping[str, float] = field(default_factory=dict)
    is_log: bool = False
    storey: StoreyMultiple | None = None

    @property
    def ends(self) -> tuple[float, float]:
        """`from` and `to`, infinite where they are not given."""
        return self.fields.get("from", -np.inf), self.fields.get("to", np.inf)

    @cached_property
    def _frozen(self) -> Any:
        """The distribution of scipy, of the logarithm where that is normal."""
        from scipy import stats  # half a second to import, and few studies have distributions

        given, (low, high) = self.fields, self.ends
        if self.name == "uniform":
            return stats.loguniform(low, high) if self.is_log else stats.uniform(low, high - low)
        if self.name == "triangular":
            return stats.triang((given["mode"] - low) / (high - low), low, high - low)
        if self.name == "normal":
            centre, width = given["mean"], given["sd"]
        else:
            centre, width = np.log(given["median"]), given["spread"]
            with np.errstate(divide="ignore"):
                low, high = np.log(max(low, 0.0)), np.log(high)
        return stats.truncnorm((low - centre) / width, (high - centre) / width, centre, width)

    def __call__(self, u: np.ndarray | float) -> np.ndarray:
        """Values at u in [0, 1], which covers what lies between `from` and `to`; same shape."""
        u = np.asarray(u, dtype=float)
        endless = self.name in ("normal", "lognormal") and not {"from", "to"} <= self.fields.keys()
        found = self._frozen.ppf(np.clip(u, _LEAST, 1 - _LEAST) if endless else u)
        return np.clip(np.exp(found) if self.name == "lognormal" else found, *self.ends)

    def share_of(self, value: float) -> float | None:
        """The u of a uniform distribution at a value; None beyond its ends."""
        low, high = self.ends
        return float(self._frozen.cdf(value)) if low <= value <= high else None


@dataclass(frozen=True)
class Factor:
    """One key that varies, as a function of a number u between 0 and 1.

    key : dotted, as in the file; MOTION for the choice of motion
    mark : where it stands
    unit : people read its values in
    options : how many values it chooses from; 0 where it is continuous, and of MOTION
    choices : the values themselves
    drawn : its distribution, or the range it is searched over
    quantity : what the key takes
    spacing : of a range that is searched, linear or log
    together : further keys of the study that move with it, by the same u
    """

    key: str
    mark: Mark
    unit: Unit
    options: int = 0
    choices: tuple[Any, ...] = ()
    drawn: Distribution | None = None
    quantity: Quantity | None = None
    spacing: str = ""
    together: tuple[Factor, ...] = ()

    @property
    def members(self) -> tuple[Factor, ...]:
        """Itself and those that move with it."""
        return (self, *self.together)

    @property
    def labels(self) -> tuple[str, ...]:
        """Of the options."""
        return tuple(map(str, self.choices))

    def number(self, u: np.ndarray) -> np.ndarray:
        """Values in SI at u, multiples of a storey's stiffness, or numbers of options; same shape."""
        if self.options:
            return choice_of(u, self.options).astype(float)
        return u if self.drawn is None else self.drawn(u)

    def values(self, u: Sequence[float] | np.ndarray) -> list[Any]:
        """What stands in the study at every u."""
        if self.options:
            return [self.choices[number] for number in choice_of(np.asarray(u), self.options).tolist()]
        assert self.drawn is not None
        numbers, storey = self.drawn(np.asarray(u)).tolist(), self.drawn.storey
        if storey is None:
            return [in_unit(number, self.unit) for number in numbers]
        return [str(replace(storey, factor=number)) for number in numbers]

    def place(self, written: Any) -> float | None:
        """The u of what the file says; None where it lies outside a range or among no options."""
        value = canonical_value(written, self.quantity)
        if self.options:
            known = {canonical_value(option, self.quantity): number for number, option in enumerate(self.choices)}
            return (known[value] + 0.5) / self.options if value in known else None
        assert self.drawn is not None
        if _base(value) != self.drawn.storey:
            return None
        value = value.factor if isinstance(value, StoreyMultiple) else value
        return self.drawn.share_of(value) if isinstance(value, int | float) else None


def choice_of(u: np.ndarray, options: int) -> np.ndarray:
    """The number of the option, from 0, at u in [0, 1]."""
    return np.minimum((np.asarray(u) * options).astype(int), options - 1)


def read_uncertain(root: Map, problems: Problems) -> list[Factor]:
    """The keys under `uncertain:`; those of one entry of a list move together.  What is wrong is noted."""
    node, found, seen = root["uncertain"], list[Factor](), dict[str, Mark]()
    is_list = isinstance(node, Items)
    entries = zip(node, node.marks, strict=True) if is_list else [(node, root.marks["uncertain"][1])]
    for entry, at in entries:
        mine = list[Factor]()
        for key, mark in _keys("uncertain", entry, at, root, problems, distribution_example("uniform", None)):
            if key in seen:
                problems.add(mark, f"'{key}' is also {format_location(seen[key])}", "remove one of the two")
            elif key == MOTION and entry[key] in (ANY, BOOTSTRAP):
                mine.append(Factor(MOTION, mark, Unit(), options=DRAWN_SETS if entry[key] == BOOTSTRAP else 0))
            elif key == MOTION:
                hint = "write `motion: any` (one of them) or `motion: bootstrap` (as many, drawn with replacement)"
                problems.add(entry.marks[key][1], f"motion: '{entry[key]}' is not known", hint)
            elif can_vary(key, mark, root, problems, "the key"):
                mine += _factor(key, entry, problems, is_joined=is_list and len(entry) > 1)
            seen.setdefault(key, mark)
        found += _together(entry, mine, problems) if is_list else mine
    return found


def read_searched(root: Map, problems: Problems) -> list[Factor]:
    """The keys of `optimise.over:`: {from: 1, to: 5}, {choice: [1, 2]}; wrong ones are noted."""
    over, at = root["optimise"]["over"], root["optimise"].marks["over"][1]
    found = []
    for key, mark in _keys("over", over, at, root, problems, RANGE):
        if can_vary(key, mark, root, problems, "the key"):
            found += _factor(key, over, problems, is_range=True)
    return found


def _keys(section: str, node: Any, at: Mark, root: Map, problems: Problems, example: str) -> Iterator[tuple[str, Mark]]:
    """The keys of a section that are not swept too."""
    if not isinstance(node, Map):
        problems.add(at, f"'{section}' is not a mapping of keys", f"write `impact.restitution: {example}`")
        return
    swept = {key: mark[0] for holder in sweep_maps(root) for key, mark in holder.marks.items()}
    for key, (mark, _) in node.marks.items():
        if key in swept:
            message = f"'{key}' is also {format_location(swept[key])}, under `sweep:`"
            problems.add(mark, message, "vary it in one of the two")
        else:
            yield key, mark


def _together(entry: Map, factors: list[Factor], problems: Problems) -> list[Factor]:
    """One factor of several keys of an entry; none where they cannot move together."""
    if len(factors) < 2:
        return factors
    first, *others = factors
    for other in others:
        if MOTION in (other.key, first.key) or other.options != first.options:
            what = "keys that move together need as many options each, or a range each; the motion moves by itself"
            problems.add(other.mark, what, "give as many of each, or write an entry of its own, `- motion: ...`")
            return []
    columns = [[canonical_value(option, factor.quantity) for option in factor.choices] for factor in factors]
    _refuse_equal_options(first.key, entry, list(zip(*columns, strict=True)), problems, "in every key of the entry")
    return [replace(first, together=tuple(others))]


def _refuse_equal_options(key: str, holder: Map, options: Sequence[Any], problems: Problems, where: str = "") -> None:
    """Note the options of a choice that are one value.

    options : canonical values; of keys that move together a tuple each
    where : the keys that are compared, in words
    """
    written = holder[key].get(CHOICE, ())
    for number, option in enumerate(options):
        first = options.index(option)
        if first < number:
            what = f"'{key}': {written[number]} and {written[first]} are one value {where}".rstrip()
            problems.add(written.marks[number], what, "remove one of the two")


def _factor(key: str, holder: Map, problems: Problems, is_range: bool = False, is_joined: bool = False) -> list[Factor]:
    """How one key varies; none where something is wrong, which is noted.

    is_range : whether it is searched over a range, which is read as the uniform distribution between its ends
    is_joined : whether other keys move with it, so that a value may occur twice
    """
    (mark, at), node, quantity = holder.marks[key], holder[key], quantity_at(schema.StudySpec, tuple(key.split(".")))
    if is_range and not (isinstance(node, Map) and CHOICE in node):
        node = Map({"uniform": node}, at, {"uniform": (at, at)})
    name = next(iter(node)) if isinstance(node, Map) and len(node) == 1 else ""
    if name not in DISTRIBUTIONS:
        choice = distribution_example(CHOICE, quantity)
        known = (
            f"{range_example(quantity)} or {choice}" if is_range else f"one distribution: {', '.join(DISTRIBUTIONS)}"
        )
        place = node.marks[name][0] if name else at
        example = choice if is_range else distribution_example("uniform", quantity)
        problems.add(place, f"'{key}' takes {known}", f"write e.g. `{key}: {example}`")
        return []
    below, at = node[name], node.marks[name][1]
    if name == CHOICE:
        return _chosen(key, holder, quantity, problems, is_joined)
    if quantity is None:
        hint = f"write the values to choose from: `{key}: {{choice: [...]}}`"
        problems.add(at, f"'{key}' takes no number that could be drawn from a range", hint)
        return []
    example = f"write `{key}: {range_example(quantity) if is_range else distribution_example(name, quantity)}`"
    drawn = _distribution(key, name, below, at, quantity, problems, example)
    if drawn is None:
        return []
    unit = unit_of(list(below.values()), quantity) if drawn.storey is None else Unit(str(drawn.storey)[2:])
    return [Factor(key, mark, unit, drawn=drawn, quantity=quantity, spacing=below.get("spacing", "linear"))]


def _chosen(key: str, holder: Map, quantity: Quantity | None, problems: Problems, is_joined: bool) -> list[Factor]:
    """A key that takes one of some values; none where something is wrong, which is noted."""
    before = len(problems.found)
    mark = holder.marks[key][0]
    options = holder[key][CHOICE]
    if not isinstance(options, Items) or len(options) < 2:
        what = f"'{key}': a choice is a list of two values or more"
        example = distribution_example(CHOICE, quantity)
        problems.add(holder[key].marks[CHOICE][1], what, f"write `{key}: {example}`")
        return []
    if not is_joined:
        _refuse_equal_options(key, holder, [canonical_value(option, quantity) for option in options], problems)
    if quantity is not None:
        refuse_bare([(*each, quantity) for each in zip(options, options.marks, strict=True)], problems)
    if len(problems.found) > before:
        return []
    return [Factor(key, mark, unit_of(options, quantity), len(options), tuple(options), quantity=quantity)]


def _distribution(
    key: str, name: str, node: Any, at: Mark, quantity: Quantity, problems: Problems, example: str
) -> Distribution | None:
    """A distribution, or a range as the uniform one; None where something is wrong, which is noted."""
    before, needed, spacing = len(problems.found), NEEDED[name], ""
    missing = [word for word in needed if not isinstance(node, Map) or word not in node]
    if isinstance(node, Map):
        refuse_unknown(node, (*needed, *_MORE[name]), f"{name}", problems)
        spacing = node.get("spacing", "linear")
    if len(problems.found) > before:
        return None
    if missing:
        problems.add(at, f"'{key}' lacks '{missing[0]}'", example)
        return None
    if spacing not in ("linear", "log"):
        problems.add(node.marks["spacing"][1], f"spacing: '{spacing}' is not known", "write linear or log")
    own = quantity.replace(name="standard deviation", low=0.0, open_low=True, high=np.inf, open_high=False)
    kinds = {"sd": own, "spread": Quantity("spread", "", "0.2", 0.0, open_low=True)}
    of_words = {word: kinds.get(word, quantity) for word in node if word != "spacing"}
    read = read_numbers(node, of_words, problems, needs_unit=True)
    if read is None or len(problems.found) > before:
        return None
    storey, *others = {_base(value): None for word, value in read.items() if word != "spread"}
    if others:
        hint = "write each of them as a multiple of one storey's stiffness, or none"
        problems.add(at, f"'{key}': {', '.join(map(str, node.values()))} are not multiples of the same", hint)
        return None
    fields = {word: value.factor if isinstance(value, StoreyMultiple) else value for word, value in read.items()}
    found = Distribution(name, fields, spacing == "log", storey)
    for word, message, hint in _wrong(key, found, quantity if storey is None else _MULTIPLE):
        problems.add(node.marks[word][1] if word in node else at, message, hint)
    return found if len(problems.found) == before else None


def _base(value: Any) -> StoreyMultiple | None:
    """The storey whose stiffness a value is a multiple of."""
    return replace(value, factor=1.0) if isinstance(value, StoreyMultiple) else None


def _wrong(key: str, drawn: Distribution, quantity: Quantity) -> Iterator[tuple[str, str, str]]:
    """Where the fields of a distribution do not fit together, or leave the limits of the key: field or "", message,
    hint."""
    low, high = drawn.ends
    if not (max(low, 0.0) if drawn.name == "lognormal" else low) < high:
        yield "to", "the range ends where it begins, or before", "write `to:` above `from:`"
    elif not low <= drawn.fields.get("mode", low) <= high:
        yield "mode", "the mode lies outside the range", "write it between `from:` and `to:`"
    elif drawn.is_log and low <= 0:
        yield "from", "a logarithmic range cannot reach zero", "begin above zero"
    else:
        first, last = drawn(np.array([0.0, 1.0])).tolist()
        too_low = first < quantity.low or (quantity.open_low and first == quantity.low)
        too_high = last > quantity.high or (quantity.open_high and last == quantity.high)
        if too_low or too_high:
            reached = f"'{key}': this {drawn.name} distribution reaches {first if too_low else last:.3g} {quantity.si}"
            what = f"{reached.rstrip()}, but the {quantity.name} must be {quantity.range}"
            yield "", what, f"write `{'from' if too_low else 'to'}:` in it"
        elif not (np.isfinite([first, last]).all() and first < last):
            yield "", "the range has next to no probability", "move its ends towards the mean"

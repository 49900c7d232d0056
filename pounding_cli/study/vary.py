"""Keys that take values at will: drawn from a distribution, chosen from a list or searched over a range."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from pounding_cli.numbers import Unit
from pounding_cli.study import schema
from pounding_cli.study.axes import can_vary, in_unit, same, unit_of
from pounding_cli.study.file import Items, Map, Mark, Problems, nearest
from pounding_cli.study.quantity import LINK_STIFFNESS, Quantity, Storey, lacks_unit, said_place
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
EXAMPLES = {
    "uniform": "{uniform: {from: 0.3, to: 0.6}}",
    "normal": "{normal: {mean: 0.5, sd: 0.1, from: 0.2, to: 0.8}}",
    "lognormal": "{lognormal: {median: 0.5, spread: 0.2}}",
    "triangular": "{triangular: {from: 0.3, mode: 0.5, to: 0.6}}",
    CHOICE: "{choice: [0.4, 0.5]}",
}

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
    storey: Storey | None = None

    @cached_property
    def _frozen(self) -> Any:
        """The distribution of scipy, of the logarithm where that is normal."""
        from scipy import stats  # half a second to import, and few studies have distributions

        given = self.fields
        low, high = given.get("from", -np.inf), given.get("to", np.inf)
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
        u, given = np.asarray(u, dtype=float), self.fields
        endless = self.name in ("normal", "lognormal") and not {"from", "to"} <= given.keys()
        found = self._frozen.ppf(np.clip(u, _LEAST, 1 - _LEAST) if endless else u)
        found = np.exp(found) if self.name == "lognormal" else found
        return np.clip(found, given.get("from", -np.inf), given.get("to", np.inf))

    def share_of(self, value: float) -> float | None:
        """The u of a uniform distribution at a value; None beyond its ends."""
        low, high = self.fields["from"], self.fields["to"]
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

    def value(self, u: float) -> Any:
        """What stands in the study at u."""
        if self.options:
            return self.choices[int(choice_of(np.asarray(u), self.options))]
        assert self.drawn is not None
        number, storey = float(self.drawn(u)), self.drawn.storey
        return in_unit(number, self.unit) if storey is None else str(replace(storey, factor=number))

    def place(self, written: Any) -> float | None:
        """The u of what the file says; None where it lies outside a range or among no options."""
        if self.options:
            known = {same(option, self.quantity): number for number, option in enumerate(self.choices)}
            number = known.get(same(written, self.quantity))
            return None if number is None else (number + 0.5) / self.options
        try:
            value: Any = self.quantity.read(written) if self.quantity is not None else None
        except PydanticCustomError:
            return None
        assert self.drawn is not None
        storey = self.drawn.storey
        if isinstance(value, Storey) or storey is not None:
            is_same = isinstance(value, Storey) and storey is not None and replace(value, factor=1.0) == storey
            value = value.factor if is_same else None
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
        for key, mark in _keys("uncertain", entry, at, root, problems, EXAMPLES["uniform"]):
            if key in seen:
                problems.add(mark, f"'{key}' is also {said_place(seen[key])}", "remove one of the two")
            elif key == MOTION and entry[key] in (ANY, BOOTSTRAP):
                mine.append(Factor(MOTION, mark, Unit(), options=DRAWN_SETS if entry[key] == BOOTSTRAP else 0))
            elif key == MOTION:
                hint = "write `motion: any` (one of them) or `motion: bootstrap` (as many, drawn with replacement)"
                problems.add(entry.marks[key][1], f"motion: '{entry[key]}' is not known", hint)
            elif can_vary(key, mark, root, problems, "the key"):
                mine += _Reader(key, entry, problems).factor()
            seen.setdefault(key, mark)
        found += _together(mine, problems) if is_list else mine
    return found


def read_searched(root: Map, problems: Problems) -> list[Factor]:
    """The keys of `optimise.over:`: {from: 1, to: 5}, {choice: [1, 2]}; wrong ones are noted."""
    over, at = root["optimise"]["over"], root["optimise"].marks["over"][1]
    found = []
    for key, mark in _keys("over", over, at, root, problems, RANGE):
        if can_vary(key, mark, root, problems, "the key"):
            found += _Reader(key, over, problems, is_range=True).factor()
    return found


def _keys(section: str, node: Any, at: Mark, root: Map, problems: Problems, example: str) -> Iterator[tuple[str, Mark]]:
    """The keys of a section that are not swept too."""
    if not isinstance(node, Map):
        problems.add(at, f"'{section}' is not a mapping of keys", f"write `impact.restitution: {example}`")
        return
    sweep = root.get("sweep")
    holders = sweep if isinstance(sweep, Items) else [sweep]
    swept = {key: mark[0] for holder in holders if isinstance(holder, Map) for key, mark in holder.marks.items()}
    for key, (mark, _) in node.marks.items():
        if key in swept:
            message = f"'{key}' is also {said_place(swept[key])}, under `sweep:`"
            problems.add(mark, message, "vary it in one of the two")
        else:
            yield key, mark


def _together(factors: list[Factor], problems: Problems) -> list[Factor]:
    """One factor of several keys; none where they cannot move together."""
    if len(factors) < 2:
        return factors
    first, *others = factors
    for other in others:
        if MOTION in (other.key, first.key):
            problems.add(other.mark, "the motion moves by itself", "write `- motion: ...` as an entry of its own")
            return []
        if other.options != first.options:
            what = f"keys that move together need as many options each: {first.key} has {first.options or 'a range'}"
            problems.add(other.mark, f"{what}, {other.key} {other.options or 'a range'}", "give as many of each")
            return []
    return [replace(first, together=tuple(others))]


class _Reader:
    """Reads how one key varies; what is wrong is noted in `problems`.

    is_range : whether it is searched over a range, which is read as the uniform distribution between its ends
    """

    def __init__(self, key: str, holder: Map, problems: Problems, is_range: bool = False) -> None:
        (self.mark, self.at), self.node = holder.marks[key], holder[key]
        self.key, self.problems, self.is_range = key, problems, is_range
        self.quantity = quantity_at(schema.Study, tuple(key.split(".")))

    def factor(self) -> list[Factor]:
        """The factor; none where something is wrong."""
        node = self.node
        if self.is_range and not (isinstance(node, Map) and CHOICE in node):
            node = Map({"uniform": node}, self.at, {"uniform": (self.at, self.at)})
        if not isinstance(node, Map) or len(node) != 1:
            what = "has more than one distribution" if isinstance(node, Map) and node else "has no distribution"
            hint = f"write one of {', '.join(DISTRIBUTIONS)}, e.g. `{self.key}: {EXAMPLES['uniform']}`"
            if self.is_range:
                what, hint = (
                    "has more than its choice",
                    f"write `{self.key}: {EXAMPLES[CHOICE]}` or `{self.key}: {RANGE}`",
                )
            self.problems.add(self.at, f"'{self.key}' {what}", hint)
            return []
        ((name, below),) = node.items()
        name_at, self.at = node.marks[name]
        if name not in DISTRIBUTIONS:
            self.problems.add(name_at, f"no distribution '{name}' is known", nearest(name, DISTRIBUTIONS))
            return []
        return self._choice(below) if name == CHOICE else self._drawn(name, below)

    def _choice(self, options: Any) -> list[Factor]:
        if not isinstance(options, Items) or len(options) < 2:
            hint = f"write `{self.key}: {EXAMPLES[CHOICE]}`"
            self.problems.add(self.at, f"'{self.key}': a choice is a list of two values or more", hint)
            return []
        seen: dict[Any, Any] = {}
        for option, mark in zip(options, options.marks, strict=True):
            alike = same(option, self.quantity)
            if alike in seen:
                message = f"'{self.key}': {option} and {seen[alike]} are one value"
                self.problems.add(mark, message, "remove one of the two")
                return []
            if self.quantity is not None and lacks_unit(option, self.quantity):
                hint = f"write its unit too, e.g. {self.quantity.example}"
                self.problems.add(mark, f"'{self.key}': {option} has no unit", hint)
                return []
            seen[alike] = option
        unit = unit_of(options, self.quantity)
        return [Factor(self.key, self.mark, unit, len(options), tuple(options), quantity=self.quantity)]

    def _drawn(self, name: str, node: Any) -> list[Factor]:
        before = len(self.problems.found)
        found = self._distribution(name, node)
        if found is None or len(self.problems.found) > before:
            return []
        spacing = ("log" if found.is_log else "linear") if self.is_range else ""
        storey = found.storey
        if storey is None:
            unit = unit_of(list(node.values()), self.quantity)
        else:
            unit = Unit(f"x {storey.which} storey" + (f" of {storey.building}" if storey.building else ""))
        return [Factor(self.key, self.mark, unit, drawn=found, quantity=self.quantity, spacing=spacing)]

    def _distribution(self, name: str, node: Any) -> Distribution | None:
        """The distribution; None, or noted, where something is wrong."""
        if not self._has_its_keys(name, node):
            return None
        if self.quantity is None:
            how = "that could be searched over a range" if self.is_range else "that could be drawn from a distribution"
            hint = f"write the values to choose from: `{self.key}: {{choice: [...]}}`"
            self.problems.add(self.at, f"'{self.key}' takes no number {how}", hint)
            return None
        read = {word: self._number(word, node) for word in node if word != "spacing"}
        if any(value is None for value in read.values()):
            return None
        placed = {word: value for word, value in read.items() if word != "spread"}
        storeys = {replace(v, factor=1.0) if isinstance(v, Storey) else None for v in placed.values()}
        if len(storeys) > 1:
            self._refuse_mixed(placed, node)
            return None
        (storey,) = storeys
        fields = {word: value.factor if isinstance(value, Storey) else value for word, value in read.items()}
        found = Distribution(name, fields, node.get("spacing") == "log", storey)
        return found if self._is_sound(found, node) else None

    def _refuse_mixed(self, placed: dict[str, Any], node: Map) -> None:
        """Note values that are not all multiples of one storey's stiffness."""
        said = [word for word, value in placed.items() if isinstance(value, Storey)]
        other = next((word for word in placed if word not in said), said[-1])
        whole = "range" if self.is_range else "distribution"
        what = f"'{self.key}': {node[other]} is no multiple of the same storey's stiffness"
        what = f"{what}, but another value of this {whole} is"
        self.problems.add(node.marks[other][1], what, f"write e.g. `{node[said[0]]}` for each of them")

    def _has_its_keys(self, name: str, node: Any) -> bool:
        before, known = len(self.problems.found), (*NEEDED[name], *_MORE[name])
        what, where = ("the range", "a range") if self.is_range else (f"'{name}'", name)
        example = f"write `{self.key}: {RANGE if self.is_range else EXAMPLES[name]}`"
        if not isinstance(node, Map):
            self.problems.add(self.at, f"{what} is not a mapping", example)
            return False
        for word in node.keys() - {*known}:
            self.problems.add(node.marks[word][0], f"unknown key '{word}' in {where}", nearest(word, known))
        for word in NEEDED[name] if node.keys() <= {*known} else ():
            if word not in node:
                self.problems.add(self.at, f"{what} lacks '{word}'", example)
        if node.get("spacing", "linear") not in ("linear", "log"):
            message = f"spacing: '{node['spacing']}' is not known"
            self.problems.add(node.marks["spacing"][1], message, "write linear or log")
        return len(self.problems.found) == before

    def _number(self, word: str, node: Map) -> Any:
        """A field in SI, or a multiple of a storey's stiffness; None where it is wrong, which is noted."""
        assert self.quantity is not None
        kind, mark, given = self.quantity, node.marks[word][1], node[word]
        if word == "sd":
            is_multiple = isinstance(given, str) and "stor" in given
            name = "standard deviation"
            kind = LINK_STIFFNESS if is_multiple else Quantity(name, kind.si, kind.example, 0.0, open_low=True)
        elif word == "spread":
            kind = Quantity("spread", "", "0.2", 0.0, open_low=True)
        if lacks_unit(given, kind):
            hint = f"write its unit too, e.g. {self.quantity.example}; without one it would be {given} {kind.si}"
            self.problems.add(mark, f"'{self.key}': {given} has no unit", hint)
            return None
        try:
            value = kind.read(given)
        except PydanticCustomError as error:
            context: dict[str, Any] = error.context or {}
            self.problems.add(mark, context["message"], context["hint"])
            return None
        if isinstance(value, str):
            self.problems.add(mark, f"'{value}' is not a number", self.quantity.wanted)
            return None
        return value

    def _is_sound(self, found: Distribution, node: Map) -> bool:
        """Whether the fields fit together and the range keeps within the limits of the key."""
        low, high = found.fields.get("from", -np.inf), found.fields.get("to", np.inf)
        quantity = _MULTIPLE if found.storey is not None else self.quantity
        assert quantity is not None

        def note(word: str, message: str, hint: str) -> bool:
            self.problems.add(node.marks[word][1] if word in node else self.at, message, hint)
            return False

        if not (max(low, 0.0) if found.name == "lognormal" else low) < high:
            return note("to", "the range ends where it begins, or before", "write `to:` above `from:`")
        if not low <= found.fields.get("mode", low) <= high:
            return note("mode", "the mode lies outside the range", "write it between `from:` and `to:`")
        if found.is_log and low <= 0:
            return note("from", "a logarithmic range cannot reach zero", "begin above zero")
        first, last = found(np.array([0.0, 1.0])).tolist()
        for end, reached in (("from", first), ("to", last)):
            beyond = reached < quantity.low if end == "from" else reached > quantity.high
            limit, is_open = (quantity.low, quantity.open_low) if end == "from" else (quantity.high, quantity.open_high)
            if beyond or (is_open and reached == limit):
                message = f"'{self.key}': this {found.name} distribution reaches {reached:.3g} {quantity.si}".rstrip()
                return note("", f"{message}, but the {quantity.name} must be {quantity.range}", f"write `{end}:` in it")
        if np.isfinite([first, last]).all() and first < last:
            return True
        return note("", "the range has next to no probability", "move its ends towards the mean")

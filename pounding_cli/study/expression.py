"""Expressions over the tables, such as `largest mu in soft` or `max(V_ratio in stiff, V_ratio in soft)`."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pounding_cli import variables
from pounding_cli.study.file import nearest
from pounding_cli.study.quantity import NUMBER

STOREY, FLOOR, LINK = (
    {
        v.name: v.unit.removeprefix("1")
        for v in variables.RESPONSES
        if v.dims == dims and v.name not in variables.OF_COLUMNS
    }
    for dims in (variables.STOREY, variables.FLOOR, variables.LINK)
)
QUANTITIES = STOREY | FLOOR | LINK
"""What an expression may name, as the tables do, and the SI unit of each."""

REDUCTIONS = ("largest", "smallest", "mean")
"""What is taken of several storeys, floors or links; `largest` unless written."""

_FUNCTIONS: dict[str, Callable[..., np.ndarray]] = {
    "max": np.maximum, "min": np.minimum, "abs": np.abs, "sqrt": np.sqrt, "log": np.log, "exp": np.exp,
}  # fmt: skip
_SEVERAL = ("max", "min")
_SUMS: dict[str, Callable[..., np.ndarray]] = {"+": np.add, "-": np.subtract}
_PRODUCTS: dict[str, Callable[..., np.ndarray]] = {"*": np.multiply, "/": np.divide}
_TOKEN = re.compile(rf"\s*(?:(?P<number>{NUMBER.replace('[-+]?', '', 1)})|(?P<word>[A-Za-z_]\w*)|(?P<sign>[-+*/(),]))")
_LEVEL = re.compile(r"\s*(?P<kind>storey|floor)\s+(?P<number>[0-9]{1,3})(?!\w)")
_IN = re.compile(r"\s*in\b")

FORM = "write e.g. `mu`, `mean V_ratio in stiff`, `drift in soft storey 1` or `max(V_ratio in stiff, V_ratio in soft)`"
_LONGEST = 500
_DEEPEST = 50


@dataclass(frozen=True)
class Quantity:
    """One number of the tables.

    name : of QUANTITIES
    reduction : of REDUCTIONS, over storeys, floors or links and, where none is named, over buildings
    building : its place in the group from 0; None for all
    level : storey or floor from 1; 0 for all
    """

    name: str
    reduction: str = "largest"
    building: int | None = None
    level: int = 0


@dataclass(frozen=True)
class Expression:
    """An expression.

    text : as people read it
    unit : SI unit; "" of a pure number, and where the parts have different ones
    quantities : what it takes from the tables
    """

    text: str
    unit: str
    quantities: tuple[Quantity, ...]
    _work: Callable[[Callable[[Quantity], np.ndarray]], np.ndarray]

    def __call__(self, value: Callable[[Quantity], np.ndarray]) -> np.ndarray:
        """The expression from the values of its quantities; not finite where it has none (a root of -1)."""
        with np.errstate(all="ignore"):
            return self._work(value)

    def __str__(self) -> str:
        return self.text


class NotUnderstood(ValueError):
    """What is wrong with an expression; the second argument says what to write."""


def read_expression(text: str, buildings: Sequence[str]) -> Expression:
    """An expression over the tables of a study.

    buildings : names of the group by place, left to right

    Raises
    ------
    NotUnderstood : what is wrong, and what to write
    """
    if len(text) > _LONGEST:
        raise NotUnderstood(f"{len(text)} characters are not an expression", FORM)
    reader = _Reader(text, buildings)
    found = reader.sum()
    if reader.rest():
        raise NotUnderstood(f"'{text.strip()}': '{reader.rest()}' is not understood", FORM)
    if not reader.quantities:
        raise NotUnderstood(f"'{text.strip()}' takes nothing from the tables", FORM)
    return Expression(" ".join(text.split()), found.unit, tuple(reader.quantities), found.work)


@dataclass(frozen=True)
class _Part:
    unit: str
    work: Callable[[Callable[[Quantity], np.ndarray]], np.ndarray]


class _Reader:
    """Recursive descent: sums of products of signed quantities, numbers, functions and brackets."""

    def __init__(self, text: str, buildings: Sequence[str]) -> None:
        self.text, self.place, self.deep = text, 0, 0
        self.buildings = buildings
        self.quantities: list[Quantity] = []

    def rest(self) -> str:
        return self.text[self.place :].strip()

    def refuse(self, what: str, hint: str = FORM) -> NotUnderstood:
        return NotUnderstood(f"'{' '.join(self.text.split())}': {what}", hint)

    def _next(self, *signs: str) -> str:
        """The next token if it is one of `signs`, "" otherwise."""
        found = _TOKEN.match(self.text, self.place)
        if found is None or found["sign"] not in signs:
            return ""
        self.place = found.end()
        return found["sign"]

    def sum(self) -> _Part:
        return self._chain(self._product, _SUMS, keeps_unit=True)

    def _product(self) -> _Part:
        return self._chain(self._signed, _PRODUCTS, keeps_unit=False)

    def _chain(self, below: Callable[[], _Part], signs: dict[str, Callable], keeps_unit: bool) -> _Part:
        left = below()
        while sign := self._next(*signs):
            right = below()
            unit = left.unit if keeps_unit and left.unit == right.unit else ""
            left = _Part(unit, _both(signs[sign], left, right))
        return left

    def _signed(self) -> _Part:
        if self._next("-"):
            self.deep += 1
            if self.deep > _DEEPEST:
                raise self.refuse("too many brackets and signs")
            inner = self._signed()
            self.deep -= 1
            return _Part(inner.unit, lambda value: -inner.work(value))
        return self._atom()

    def _atom(self) -> _Part:
        found = _TOKEN.match(self.text, self.place)
        if found is None or (found["sign"] and found["sign"] != "("):
            rest = self.rest()
            raise self.refuse(f"'{rest[:40]}' is not understood" if rest else "it ends too early")
        self.place = found.end()
        if found["number"]:
            number = float(found["number"])
            return _Part("", lambda value: np.asarray(number))
        if found["sign"]:
            self.deep += 1
            if self.deep > _DEEPEST:
                raise self.refuse("too many brackets")
            inner = self.sum()
            self.deep -= 1
            self._closed()
            return inner
        if found["word"] in _FUNCTIONS:
            return self._function(found["word"])
        return self._quantity(found["word"])

    def _closed(self) -> None:
        if not self._next(")"):
            raise self.refuse("a bracket is not closed", "close it with )")

    def _function(self, name: str) -> _Part:
        if not self._next("("):
            raise self.refuse(f"{name} lacks its bracket", f"write e.g. `{name}(mu)`")
        self.deep += 1
        if self.deep > _DEEPEST:
            raise self.refuse("too many brackets")
        parts = [self.sum()]
        while self._next(","):
            parts.append(self.sum())
        self.deep -= 1
        self._closed()
        if (len(parts) > 1) != (name in _SEVERAL):
            wanted = "two values or more" if name in _SEVERAL else "one value"
            raise self.refuse(
                f"{name} takes {wanted}", f"write e.g. `{name}({'mu, mu0' if name in _SEVERAL else 'mu'})`"
            )
        whole = parts[0]
        if name not in _SEVERAL:
            return _Part(whole.unit if name == "abs" else "", _one(_FUNCTIONS[name], whole))
        for part in parts[1:]:
            whole = _Part(whole.unit if whole.unit == part.unit else "", _both(_FUNCTIONS[name], whole, part))
        return whole

    def _quantity(self, word: str) -> _Part:
        reduction = word if word in REDUCTIONS else REDUCTIONS[0]
        if word in REDUCTIONS:
            found = _TOKEN.match(self.text, self.place)
            if found is None or not found["word"]:
                raise self.refuse(f"{word} of what?", f"write e.g. `{word} mu`")
            self.place, word = found.end(), found["word"]
        if word not in QUANTITIES:
            raise self.refuse(f"no quantity '{word}' is known", nearest(word, (*QUANTITIES, *_FUNCTIONS)))
        building, level = self._place(word)
        quantity = Quantity(word, reduction, building, level)
        self.quantities.append(quantity)
        return _Part(QUANTITIES[word], lambda value: value(quantity))

    def _place(self, name: str) -> tuple[int | None, int]:
        """Building and level of what follows `in`."""
        here = _IN.match(self.text, self.place)
        if here is None:
            return None, 0
        if name in LINK:
            raise self.refuse(f"{name} belongs to links, not to a building", f"write `{name}`: of all links")
        self.place = here.end()
        after = self.text[self.place :].lstrip()
        known = [each for each in self.buildings if re.match(rf"{re.escape(each)}(?!\w)", after)]
        name_of = max(known, key=len, default="")
        if name_of:
            self.place = len(self.text) - len(after) + len(name_of)
        level = _LEVEL.match(self.text, self.place)
        if level is None and not name_of:
            word = re.split(r"[-+*/(),]", after)[0].strip()[:40]
            raise self.refuse(f"no building '{word}' in the group", nearest(word, self.buildings))
        if level is None:
            return self.buildings.index(name_of), 0
        own = "floor" if name in FLOOR else "storey"
        if level["kind"] != own:
            raise self.refuse(f"{name} belongs to a {own}", f"write `{own} {level['number']}`")
        if int(level["number"]) < 1:
            raise self.refuse(f"there is no {own} 0", f"the lowest is `{own} 1`")
        self.place = level.end()
        return self.buildings.index(name_of) if name_of else None, int(level["number"])


def _one(work: Callable, part: _Part) -> Callable[[Callable[[Quantity], np.ndarray]], np.ndarray]:
    return lambda value: work(part.work(value))


def _both(work: Callable, left: _Part, right: _Part) -> Callable[[Callable[[Quantity], np.ndarray]], np.ndarray]:
    return lambda value: work(left.work(value), right.work(value))

"""The distribution of an uncertain key: what a study writes, checked, as a function of a number u between 0 and 1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic_core import PydanticCustomError
from scipy.special import ndtr, ndtri

from pounding_cli.study.problems import Problems, nearest
from pounding_cli.study.rules import StiffnessRule, read_stiffness
from pounding_cli.study.source import Node
from pounding_cli.study.units import Quantity, written_unit

NEEDED = {
    "uniform": ("from", "to"), "normal": ("mean", "sd"), "lognormal": ("median", "spread"),
    "triangular": ("from", "mode", "to"),
}  # fmt: skip
"""Every distribution with what must be written of it."""

_MORE = {"uniform": ("spacing",), "normal": ("from", "to"), "lognormal": ("from", "to"), "triangular": ()}

EXAMPLES = {
    "uniform": "{uniform: {from: 0.3, to: 0.6}}",
    "normal": "{normal: {mean: 0.5, sd: 0.1, from: 0.2, to: 0.8}}",
    "lognormal": "{lognormal: {median: 0.5, spread: 0.2}}",
    "triangular": "{triangular: {from: 0.3, mode: 0.5, to: 0.6}}",
    "choice": "{choice: [0.4, 0.5]}",
}

RANGE = "{from: 0.3, to: 0.6}"
"""A key that is searched over a range."""

_LEAST = 1e-12
"""Probability beyond the last values of a distribution without an end: seven standard deviations from the mean."""


@dataclass(frozen=True)
class Distribution:
    """A distribution with its fields in SI; `spacing` as written.

    rule : its values are multiples of the stiffness of this storey
    """

    name: str
    fields: dict[str, float]
    is_log: bool = False
    rule: StiffnessRule | None = None

    def __call__(self, u: np.ndarray | float) -> np.ndarray:
        """Values at u in [0, 1], which covers what lies between `from` and `to`; same shape."""
        u, given = np.asarray(u, dtype=float), self.fields
        low, high = given.get("from", -np.inf), given.get("to", np.inf)
        if self.name == "uniform":
            found = low * (high / low) ** u if self.is_log else low + (high - low) * u
        elif self.name == "triangular":
            mode, width = given["mode"], high - low
            rising = low + np.sqrt(u * width * (mode - low))
            found = np.where(u * width < mode - low, rising, high - np.sqrt((1 - u) * width * (high - mode)))
        else:
            found = self._normal(u, low, high)
        return np.clip(found, low, high)

    def _normal(self, u: np.ndarray, low: float, high: float) -> np.ndarray:
        if self.name == "normal":
            centre, width, ends = self.fields["mean"], self.fields["sd"], (low, high)
        else:
            with np.errstate(divide="ignore"):
                ends = float(np.log(max(low, 0.0))), float(np.log(high))
            centre, width = float(np.log(self.fields["median"])), self.fields["spread"]
        first, last = (float(ndtr((end - centre) / width)) for end in ends)
        score = centre + width * ndtri(np.clip(first + (last - first) * u, _LEAST, 1 - _LEAST))
        return score if self.name == "normal" else np.exp(score)


def share_of(found: Distribution, value: float) -> float | None:
    """The u of a uniform distribution at a value; None beyond its ends."""
    low, high = found.fields["from"], found.fields["to"]
    if not low <= value <= high:
        return None
    return float(np.log(value / low) / np.log(high / low)) if found.is_log else (value - low) / (high - low)


class DistributionReader:
    """Reads the distribution of one key; what is wrong is noted in `problems`.

    quantity : what the key takes; None where it takes no number
    is_range : whether it is searched over a range, which is read as the uniform distribution between its ends
    """

    def __init__(self, key: str, quantity: Quantity | None, problems: Problems, is_range: bool = False) -> None:
        self.key, self.quantity, self.problems, self.is_range = key, quantity, problems, is_range

    def read(self, name: str, node: Node) -> Distribution | None:
        """The distribution; None where something is wrong."""
        before = len(self.problems.found)
        self._check_fields(name, node)
        if len(self.problems.found) > before:
            return None
        rule = self._rule(node)
        quantity = self.quantity
        if rule is not None:
            quantity = Quantity("multiple of a storey's stiffness", "", "20 x stiffest storey", 0.0, open_low=True)
        elif quantity is None and len(self.problems.found) == before:
            hint = f"write the values to choose from: `{self.key}: {{choice: [...]}}`"
            how = "that could be searched over a range" if self.is_range else "that could be drawn from a distribution"
            self.problems.add(node.mark, f"'{self.key}' takes no number {how}", hint)
        if len(self.problems.found) > before or quantity is None:
            return None
        fields = {field: self._number(field, each, quantity, rule) for field, each in node.value.items()}
        if len(self.problems.found) > before:
            return None
        spacing = node.get("spacing")
        numbers = {field: value for field, value in fields.items() if value is not None}
        found = Distribution(name, numbers, spacing is not None and spacing.value == "log", rule)
        return found if self._is_sound(found, node, quantity) else None

    def _check_fields(self, name: str, node: Node) -> None:
        example = f"write `{self.key}: {RANGE if self.is_range else EXAMPLES[name]}`"
        what = "the range" if self.is_range else f"'{name}'"
        if not node.is_mapping:
            self.problems.add(node.mark, f"{what} is not a mapping", example)
            return
        known = (*NEEDED[name], *_MORE[name])
        for field in node.value:
            if field not in known:
                where = "a range" if self.is_range else name
                self.problems.at(node, (field,), f"unknown key '{field}' in {where}", nearest(field, known), key=True)
        for field in NEEDED[name] if set(node.value) <= set(known) else ():
            if field not in node.value:
                self.problems.at(node, (), f"{what} lacks '{field}'", example)
        spacing = node.get("spacing")
        if spacing is not None and spacing.value not in ("linear", "log"):
            self.problems.add(spacing.mark, f"spacing: '{spacing.text}' is not known", "write linear or log")

    def _rule(self, node: Node) -> StiffnessRule | None:
        """The storey whose stiffness the values are multiples of; None where they are none."""
        numbers = [each for field, each in node.value.items() if field not in ("spread", "spacing")]
        said = [each for each in numbers if isinstance(each.value, str) and "stor" in each.value]
        try:
            rules = [rule for rule in (read_stiffness(each.value) for each in said) if isinstance(rule, StiffnessRule)]
        except PydanticCustomError as error:
            self._refused(said[0], error)
            return None
        if not rules:
            return None
        if len({(rule.which, rule.building) for rule in rules}) > 1 or len(said) < len(numbers):
            other = next((each for each in numbers if each not in said), said[-1])
            whole = "range" if self.is_range else "distribution"
            what = f"all values of a {whole} are multiples of one storey's stiffness, or none is"
            self.problems.add(other.mark, what, f"write e.g. `{said[0].text}` for each of them")
        return rules[0]

    def _number(self, field: str, node: Node, quantity: Quantity, rule: StiffnessRule | None) -> float | None:
        """A field in SI."""
        if field == "spacing":
            return None
        kind = quantity
        if field == "sd":
            kind = Quantity("standard deviation", quantity.si, quantity.example, 0.0, open_low=True)
        elif field == "spread":
            kind = Quantity("spread", "", "0.2", 0.0, open_low=True)
        try:
            if rule is not None and field != "spread":
                found = read_stiffness(node.value)
                return found.factor if isinstance(found, StiffnessRule) else None
            if lacks_unit(node, kind):
                hint = f"write its unit too, e.g. {quantity.example}; without one it would be {node.text} {kind.si}"
                self.problems.add(node.mark, f"'{self.key}': {node.text} has no unit", hint)
                return None
            value = kind.read(node.plain())
        except PydanticCustomError as error:
            self._refused(node, error)
            return None
        if isinstance(value, str):
            self.problems.add(node.mark, f"'{value}' is not a number", quantity.wanted)
            return None
        return float(value)

    def _refused(self, node: Node, error: PydanticCustomError) -> None:
        context = error.context or {}
        self.problems.add(node.mark, str(context.get("message", error)), str(context.get("hint", "")))

    def _is_sound(self, found: Distribution, node: Node, quantity: Quantity) -> bool:
        """Whether the fields fit together and the range keeps within the limits of the key."""
        low, high = found.fields.get("from", -np.inf), found.fields.get("to", np.inf)
        if not (max(low, 0.0) if found.name == "lognormal" else low) < high:
            self.problems.at(node, ("to",), "the range ends where it begins, or before", "write `to:` above `from:`")
        elif not low <= found.fields.get("mode", low) <= high:
            self.problems.at(node, ("mode",), "the mode lies outside the range", "write it between `from:` and `to:`")
        elif found.is_log and low <= 0:
            self.problems.at(node, ("from",), "a logarithmic range cannot reach zero", "begin above zero")
        else:
            first, last = found(np.array([0.0, 1.0])).tolist()
            if first < quantity.low or (first == quantity.low and quantity.open_low):
                self._leaves(found, node, "from", first, quantity)
            elif last > quantity.high or (last == quantity.high and quantity.open_high):
                self._leaves(found, node, "to", last, quantity)
            elif np.isfinite([first, last]).all() and first < last:
                return True
            else:
                self.problems.at(node, (), "the range has next to no probability", "move its ends towards the mean")
        return False

    def _leaves(self, found: Distribution, node: Node, end: str, reached: float, quantity: Quantity) -> None:
        message = f"'{self.key}': this {found.name} distribution reaches {reached:.3g} {quantity.si}".rstrip()
        limits = f"the {quantity.name} must be {quantity.range}"
        self.problems.at(node, (), f"{message}, but {limits}", f"write `{end}:` in it")


def lacks_unit(node: Node, quantity: Quantity) -> bool:
    """Whether a value is written without the unit that it has."""
    if not quantity.si or node.is_list or node.is_mapping or node.value in quantity.words:
        return False
    try:
        return bool(quantity.read(node.plain())) and not written_unit(str(node.value))
    except PydanticCustomError:
        return False  # said where it is read

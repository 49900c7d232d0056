"""Quantities as people write them, `5 cm` or `0.35 g`: one declaration gives reading, range, messages, schema, docs."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic_core import PydanticCustomError, core_schema

from pounding_cli.units import GRAVITY, KNOWN_UNITS, Dimension, find_unit_factor, parse_unit

LENGTH_FACTORS = {"cm": 1e-2, "mm": 1e-3, "m": 1.0}
MASS_FACTORS = {"t": 1e3, "kg": 1.0}
TIME_FACTORS = {"s": 1.0, "ms": 1e-3}
FORCE_FACTORS = {"kN": 1e3, "MN": 1e6, "N": 1.0}
WEIGHT_FACTORS = {"W": 1.0, "%": 0.01}
STIFFNESS_FACTORS = {"kN/mm": 1e6, "kN/m": 1e3, "MN/mm": 1e9, "N/m": 1.0}
HERTZ_STIFFNESS_FACTORS = {"kN/m^1.5": 1e3, "kN/mm^1.5": 1e3 * 1000**1.5, "N/mm^1.5": 1000**1.5, "N/m^1.5": 1.0}
VELOCITY_FACTORS = {"cm/s": 0.01, "m/s": 1.0}
ACCELERATION_FACTORS = {"g": GRAVITY, "m/s2": 1.0}


@dataclass(frozen=True, eq=False)
class PlausibleRange:
    """A range outside of which a value is more likely a slip than meant.

    low, high : the range, in SI
    reason : where it comes from
    units : units a person writes the value in with their factor to SI, the likeliest first
    name : of the quantity
    """

    low: float
    high: float
    reason: str
    units: Mapping[str, float]
    name: str

    def holds(self, value: float) -> bool:
        """Return whether a value is plausible; nothing at all (no gap, no damping) is."""
        return value == 0 or self.low <= value <= self.high

    def excess(self, value: float) -> float:
        """Return by how many powers of ten a value lies beyond the range; 0 within it."""
        if self.holds(value):
            return 0.0
        if value <= 0:
            return math.inf
        below = self.low / value if self.low > 0 else 0.0
        return math.log10(max(below, value / self.high))


_PASSING = "floors pass through each other where a contact is softer than storeys; studies take 5 to 1000 times"
_RANGES = (
    (1e-4, 1.0, LENGTH_FACTORS, "gap", "gaps are millimetres to decimetres; the largest a code asks for is near 1 m"),
    (
        5e3, 1e7, MASS_FACTORS, "floor mass",
        "floors weigh 0.5 to 1.5 t a square metre: 5 t is a shed, 10000 t a whole block",
    ),
    (2.0, 12.0, LENGTH_FACTORS, "storey height", "people stand in a storey; halls and lobbies reach 12 m"),
    (3.0, 200.0, LENGTH_FACTORS, "size of a plan", "floors measure 3 to 200 m from one joint to the next"),
    (0.02, 10.0, TIME_FACTORS, "period", "the tallest buildings there are have about 10 s"),
    (0.02, 0.5, TIME_FACTORS, "period of a storey", "frames and walls have 0.05 to 0.2 s a storey"),
    (0.006, 0.3, {"%": 0.01}, "damping ratio", "structures have 1 to 10 % of critical; dampers reach 30 %"),
    (0.005, 3.0, FORCE_FACTORS, "base yield shear over weight", "codes design for 2 to 30 %, 100 % with overstrength"),
    (
        3e-4, 1e4, STIFFNESS_FACTORS, "link stiffness",
        "far below that of a storey a link does nothing, far above it is rigid",
    ),
    (1.0, 1e4, STIFFNESS_FACTORS, "contact stiffness", _PASSING),
    (0.1, 1e4, HERTZ_STIFFNESS_FACTORS, "stiffness of a Hertz contact", _PASSING),
    (
        2e-3, 100.0, FORCE_FACTORS, "force of a damper",
        "far below a floor's weight it does nothing, far above it is rigid",
    ),
    (0.0, 10.0, TIME_FACTORS, "period on a moving base", "isolated buildings have 2 to 5 s"),
    (0.005, 5.0, VELOCITY_FACTORS, "peak velocity asked for", "damage begins near 5 cm/s, recorded peaks reach 3 m/s"),
    (1e8, 3e11, {"GPa": 1e9, "MPa": 1e6}, "modulus", "concrete has 20 to 45 GPa, masonry 1 GPa, steel 210 GPa"),
    (100.0, 2e4, {"kg/m3": 1.0, "t/m3": 1e3}, "density", "concrete has 2500 kg/m3, steel 7850 kg/m3"),
    (0.01, 10.0, {"m/s": 1.0, "cm/s": 0.01}, "speed of a blow", "floors strike with 0.1 to 2 m/s"),
    (
        0.01 * GRAVITY, 3 * GRAVITY, ACCELERATION_FACTORS, "peak asked for",
        "damage begins near 0.05 g, recorded peaks reach 3 g",
    ),
    (
        0.01 * GRAVITY, 3 * GRAVITY, ACCELERATION_FACTORS, "acceleration of a code's spectrum",
        "maps of codes have 0.02 to 0.6 g on rock, and ordinates up to 3 g",
    ),
    (
        0.001 * GRAVITY, 5 * GRAVITY, ACCELERATION_FACTORS, "peak of a motion",
        "few motions were ever recorded with more than 2 g; below 0.001 g they are not felt",
    ),
)  # fmt: skip
PLAUSIBLE_RANGES = {name: PlausibleRange(low, high, reason, units, name) for low, high, units, name, reason in _RANGES}
"""What is plausible, one row a quantity."""

NUMBER_PATTERN = r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
_QUANTITY = re.compile(rf"({NUMBER_PATTERN})(?:\s*/\s*({NUMBER_PATTERN}))?\s*([A-Za-zµ°%].*)?\Z")
_COMMA = re.compile(r"([-+]?[0-9]{1,15}),([0-9]{1,15})((?: ?[A-Za-z%][^,]*)?)\Z")
BOTH_SIGNS = re.compile(r"\s*(?:\+\s*/?\s*-|±)\s*([0-9.].*?)\s*\Z")
"""A size to both sides of zero: `+-5 %`."""

SEVERAL_VALUES = "several values to run one after the other stand under `sweep:`"
"""What to write of a key that takes one value."""

LONGEST_QUOTE = 60
"""Largest number of characters of a value that a message quotes."""

LONGEST = 200
"""Largest number of characters of a quantity."""


def written_unit(value: Any) -> str:
    """Return the unit in a text such as "5 cm"; "" where it names none or is no quantity."""
    if not isinstance(value, str) or len(value) > LONGEST:
        return ""
    match = _QUANTITY.match(value.strip())
    return (match[3] or "") if match else ""


def lacks_unit(value: Any, quantity: Quantity | None) -> bool:
    """Return whether a value is written without the unit that it has."""
    if quantity is None or not quantity.si or isinstance(value, list | dict | bool) or value in quantity.words:
        return False
    try:
        number = quantity.read(value)
        return isinstance(number, int | float) and number != 0 and not written_unit(str(value))
    except PydanticCustomError:
        return False  # it is refused where it is read


def refuse(message: str, hint: str = "", key: bool = False, whole: bool = False) -> PydanticCustomError:
    """Return a pydantic error with a hint.

    key : it stands at the key, not at the value
    whole : the message names its owner itself
    """
    return PydanticCustomError("refused", "{message}", {"message": message, "hint": hint, "key": key, "whole": whole})


def quote(value: Any) -> str:
    """Return a value as messages quote it: a mapping and a list by their beginnings."""
    if isinstance(value, list | tuple | dict):
        kind = "mapping" if isinstance(value, dict) else "list"
        if not value:
            return f"an empty {kind}"
        text = str(value)
        return f"the {kind} {text[:LONGEST_QUOTE]}{'...' * (len(text) > LONGEST_QUOTE)}"
    if value is None or isinstance(value, bool):
        return {True: "true", False: "false", None: "nothing"}[value]
    return f"'{str(value)[:LONGEST_QUOTE]}'"


def refuse_no_single(value: Any, form: str, hint: str) -> None:
    """Raise PydanticCustomError where a mapping, a list, a truth value or nothing stands for one value.

    Parameters
    ----------
    form : what belongs there, in words
    hint : what to write
    """
    if isinstance(value, list | tuple | dict):
        raise refuse(f"{quote(value)} stands where one {form} belongs", f"{hint}; {SEVERAL_VALUES}")
    if value is None or isinstance(value, bool):
        raise refuse(f"{quote(value)} stands where one {form} belongs", hint)


def format_location(mark: tuple[Any, int]) -> str:
    """Return a place of the study in words."""
    return f"at {mark[0]}" if isinstance(mark[0], str) else f"in line {mark[0]}"


class ValueParser:
    """A parser of the values of a key, for `Annotated[...]`.

    form : what is read, in words
    examples : values as the file writes them
    quantity : what its numbers are, where it has some
    """

    form: str = ""
    examples: tuple[Any, ...] = ()
    quantity: Quantity | None = None

    def read(self, value: Any) -> Any:
        """Return the value as the program takes it.  Raises PydanticCustomError saying what to write."""
        raise NotImplementedError

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of its values."""
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "title": self.form, "examples": list(self.examples)}

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return self.schema()


@dataclass(frozen=True)
class Quantity(ValueParser):
    """A number with a unit.

    name : in words, e.g. "gap"
    si : SI unit; "" for a plain number
    example : one as the file writes it
    low, high : the range allowed, in SI
    open_low, open_high : the end itself is excluded
    words : other texts, taken as they are
    percent : it is written with its %
    usual : plausible range; values beyond are warned of
    """

    name: str
    si: str
    example: str
    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False
    open_high: bool = False
    words: tuple[str, ...] = ()
    percent: bool = False
    usual: PlausibleRange | None = None

    def replace(self, **changes: Any) -> Quantity:
        """Return the quantity with other values of some fields."""
        return dataclasses.replace(self, **changes)

    @property
    def range(self) -> str:
        """The range in words, e.g. "above 0 s and at most 20 s"."""
        ends = []
        if self.low > -math.inf:
            ends.append(f"{'above' if self.open_low else 'at least'} {self._format_number(self.low)}")
        if self.high < math.inf:
            ends.append(f"{'below' if self.open_high else 'at most'} {self._format_number(self.high)}")
        return " and ".join(ends)

    def _format_number(self, number: float) -> str:
        """Return an SI number with its unit, or in %."""
        return f"{100 * number:g} %" if self.percent else f"{number:g} {self.si}".rstrip()

    @property
    def usage(self) -> str:
        """The way to write one, in words."""
        article = "an" if self.name[0] in "aeio" else "a"
        unit = f" [{self.si}]" if self.si else ""
        range_in_words = f" {self.range}" if self.range else ""
        words = "".join(f" or {word}" for word in self.words)
        return f"write {article} {self.name}{unit}{range_in_words}{words}, e.g. {self.example}"

    @property
    def form(self) -> str:  # type: ignore[override]
        if self.percent:
            return f"{self.name} in %"
        return ", ".join(filter(None, (self.si or "-", self.range, *(f"`{word}`" for word in self.words))))

    def read(self, value: Any) -> Any:
        """Return the SI number, or one of `words`.  Raises PydanticCustomError saying what to write."""
        if isinstance(value, str) and value.strip() in self.words:
            return value.strip()
        number = self._parse_number(value)
        if not math.isfinite(number):
            raise refuse(f"{value} is not a finite number", self.usage)
        at_end = (self.open_low and number == self.low) or (self.open_high and number == self.high)
        if at_end or not self.low <= number <= self.high:
            hint = f"{self._suggest_percent(value, number)}{self.usage}"
            raise refuse(f"the {self.name} is {self._format_number(number)}; it must be {self.range}", hint)
        return number

    def _suggest_percent(self, value: Any, number: float) -> str:
        """Return what to write where a plain number out of range is likely meant in %; "" where it is not.

        value : as written
        number : the same in SI
        """
        is_plain = not self.si and self.example.endswith("%") and not written_unit(value)
        if is_plain and abs(number) >= 1.0 and self.low <= 0.01 * number <= self.high:
            return f"write `{number:g} %` if that is meant; otherwise "
        return ""

    def _parse_number(self, value: Any) -> float:
        """Return the number in SI, whatever its range.  Raises PydanticCustomError."""
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            refuse_no_single(value, self.name, self.usage)
            raise refuse(f"{quote(value)} is not a {self.name}", self.usage)
        if self.percent and not str(value).strip().endswith("%"):
            raise refuse(f"{quote(value)} is not a {self.name}: it lacks its %", self.usage)
        if not isinstance(value, str):
            return float(value)
        return self._parse_text(value.strip())

    def _parse_text(self, text: str) -> float:
        """Return the number in a text, `5 cm` or `1/475`, in SI.  Raises PydanticCustomError."""
        match = _QUANTITY.match(text) if len(text) <= LONGEST else None
        if match is None:
            slip = _describe_slip(text[:LONGEST])
            several = f"; {SEVERAL_VALUES}" if BOTH_SIGNS.match(text[:LONGEST]) else ""
            raise refuse(f"{quote(text)} is not a number with a unit{slip}", f"{self.usage}{several}")
        numerator, denominator, unit = match.groups()
        number = float(numerator)
        if denominator is not None:
            if float(denominator) == 0:
                raise refuse(f"'{text}' divides by zero", self.usage)
            number /= float(denominator)
        if unit is None:
            return number
        try:
            factor = find_unit_factor(unit, self.si)
        except ValueError:
            hint = f"{self.usage}; the units are {KNOWN_UNITS}, and products such as kN/mm"
            raise refuse(f"'{unit}' is not a unit this program knows{_describe_slip(text)}", hint) from None
        if factor is None:
            hint = self._suggest_related(number, unit) or self.usage
            plain = "a plain number or %" if self.example.endswith("%") else "a plain number"
            raise refuse(f"'{text}' is no {self.name}: expected {self.si or plain}", hint)
        return number * factor

    def _suggest_related(self, number: float, unit: str) -> str:
        """Return what to write where the unit is that of a related quantity: a weight for a mass, the coefficient of a
        damper for its force at 1 m/s; "" where it is of none."""
        size, dimension = parse_unit(unit)
        mass, length, time = dimension
        if self.si == "kg" and dimension == (1.0, 1.0, -2.0):
            return f"write the mass; a weight of {number:g} {unit} is that of `{number * size / GRAVITY / 1e3:.4g} t`"
        if self.si == "N" and mass == 1.0 and length < 1.0 and abs(length - 1.0 + time + 2.0) < 1e-9:
            return f"write the force at 1 m/s: `{number * size / 1e3:.6g} kN`; the power is `exponent: {1 - length:g}`"
        return ""

    def schema(self) -> dict[str, Any]:
        number: dict[str, Any] = {"type": "number"}
        if self.low > -math.inf:
            number["exclusiveMinimum" if self.open_low else "minimum"] = self.low
        if self.high < math.inf:
            number["exclusiveMaximum" if self.open_high else "maximum"] = self.high
        kinds = [{"type": "string"}] if self.percent else [number, {"type": "string"}]
        title = f"{self.name} [{self.si}]" if self.si else self.name
        return {"anyOf": kinds, "title": title, "examples": [self.example, *self.words]}


def _describe_slip(text: str) -> str:
    """Return the likely slip in a text that is no quantity; "" where none is seen."""
    match = _COMMA.match(text)
    if match is not None:
        return f": it has a decimal comma, write `{match[1]}.{match[2]}{match[3]}`"
    both = BOTH_SIGNS.match(text)
    if both is not None:
        return f": it stands for two, -{both[1]} and {both[1]}"
    return ": a comment needs a blank before its #" if "#" in text else ""


@dataclass(frozen=True)
class StoreyMultiple:
    """A stiffness as a multiple of that of a storey.

    factor : multiple [-]
    which : `stiffest` or `mean`
    building : the one whose storey it is; None for all of the group
    """

    factor: float
    which: str
    building: str | None = None

    def __str__(self) -> str:
        return f"{self.factor:.12g} x {self.which} storey{f' of {self.building}' if self.building else ''}"


_RULE = re.compile(
    rf"\s*(?:(?P<top>{NUMBER_PATTERN})\s*(?:/\s*(?P<bottom>{NUMBER_PATTERN}))?\s*(?P<percent>%)?\s*(?:x|X|×|\*|times)?\s*)?"
    r"(?:the\s+)?(?P<which>stiffest|mean|average)\s+store?y(?:\s+of\s+(?:the\s+)?(?P<building>\S.*?))?\s*\Z"
)


@dataclass(frozen=True)
class Stiffness(Quantity):
    """A stiffness [N/m], or a multiple of a storey's: `20 x stiffest storey`, `1/5 mean storey of stiff`."""

    def read(self, value: Any) -> float | StoreyMultiple:
        if isinstance(value, StoreyMultiple):
            return value
        if not isinstance(value, str) or "stor" not in value:
            return super().read(value)
        hint = "write an SI or unit value such as 200 kN/mm, or `20 x stiffest storey`, or `1/5 mean storey of NAME`"
        match = _RULE.match(value) if len(value) <= LONGEST else None
        if match is None or float(match["bottom"] or 1) == 0:
            raise refuse(f"'{value[:LONGEST]}' is not a stiffness", hint)
        multiple = float(match["top"] or 1) / float(match["bottom"] or 1) / (100 if match["percent"] else 1)
        if not 0 < multiple < 1e12:
            raise refuse(f"the factor in '{value}' is {multiple:g}; it must be above 0", hint)
        which = "mean" if match["which"] == "average" else match["which"]
        return StoreyMultiple(multiple, which, match["building"])

    @property
    def form(self) -> str:  # type: ignore[override]
        return "N/m, or a multiple of a storey's"


@dataclass(frozen=True)
class WholeNumber(ValueParser):
    """A whole number, in digits.

    low, high : least and largest one
    zero : word that stands for 0
    """

    low: int
    high: int
    si: str = ""
    zero: str = ""

    @property
    def form(self) -> str:  # type: ignore[override]
        return "whole number"

    def read(self, value: Any) -> int:
        if self.zero and value == self.zero:
            return 0
        hint = f"write a whole number, at least {self.low} and at most {self.high}"
        refuse_no_single(value, self.form, hint)
        is_digits = isinstance(value, str) and re.fullmatch(r"[0-9]{1,9}", value)
        if is_digits or (isinstance(value, float) and value.is_integer() and abs(value) < 1e15):
            value = int(value)
        if not isinstance(value, int):
            raise refuse(f"{quote(value)} is not a whole number", hint)
        if not self.low <= value <= self.high:
            raise refuse(f"'{value}' is not allowed", hint)
        return value

    def schema(self) -> dict[str, Any]:
        number = {"type": "integer", "minimum": self.low, "maximum": self.high}
        return {"anyOf": [{"const": self.zero}, number]} if self.zero else number


@dataclass(frozen=True)
class ParsedText(ValueParser):
    """A text or a number that a function reads.

    reader : of the value
    quantity : what its numbers are, where it has some
    name : what stands there, in the words of messages; its form unless given
    """

    reader: Callable[[Any], Any]
    form: str = ""
    examples: tuple[Any, ...] = ()
    quantity: Quantity | None = None
    name: str = ""

    def read(self, value: Any) -> Any:
        if self.quantity is None:
            hint = f"write e.g. {', '.join(f'`{example}`' for example in self.examples)}"
            refuse_no_single(value, self.name or self.form, hint)
        return self.reader(value)


@dataclass(frozen=True)
class MeasuredValue:
    """A number with a unit of any dimension.

    value : in SI
    dimension : powers of kg, m and s
    text : as the file writes it
    """

    value: float
    dimension: Dimension
    text: str


def parse_measured(value: Any) -> MeasuredValue:
    """Return a number with any unit, or none.  Raises PydanticCustomError."""
    unit = written_unit(value)
    try:
        factor, dimension = parse_unit(unit) if unit else (1.0, (0.0, 0.0, 0.0))
    except ValueError:
        hint = f"write e.g. 20 kN/mm or 5e12 N/m^3; the units are {KNOWN_UNITS}"
        raise refuse(f"'{unit}' is not a unit this program knows", hint) from None
    bare = value.strip().removesuffix(unit) if unit else value
    return MeasuredValue(Quantity("parameter", "", "20 kN/mm").read(bare) * factor, dimension, str(value))


LENGTH = Quantity("length", "m", "3 m", 0.0, open_low=True)
GAP = Quantity("gap", "m", "5 cm", 0.0, 10.0, usual=PLAUSIBLE_RANGES["gap"])
MASS = Quantity("mass", "kg", "200 t", 0.0, open_low=True, usual=PLAUSIBLE_RANGES["floor mass"])
TIME = Quantity("time", "s", "0.36 s", 0.0, open_low=True)
STIFFNESS = Quantity("stiffness", "N/m", "200 kN/mm", 0.0, open_low=True)
LINK_STIFFNESS = Stiffness("stiffness", "N/m", "200 kN/mm", 0.0, open_low=True)
FORCE = Quantity("force", "N", "900 kN", 0.0, open_low=True)
ACCELERATION = Quantity("acceleration", "m/s2", "0.35 g", 0.0, open_low=True)

"""Quantities as people write them, `5 cm` or `0.35 g`, turned into SI numbers (units are read by pint)."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

from pydantic import BeforeValidator, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

if TYPE_CHECKING:
    from pint import UnitRegistry

GRAVITY = 9.80665
"""Standard acceleration of gravity [m/s2]: the `g` of an acceleration."""

LONGEST = 200
"""Characters of a quantity."""

LONGEST_UNIT = 40
"""Characters of a unit."""

NUMBER = r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
_QUANTITY = re.compile(rf"(?P<top>{NUMBER})(?:\s*/\s*(?P<bottom>{NUMBER}))?\s*(?P<unit>[A-Za-zµ°%].*)?\Z")
_DIGITS = re.compile(r"[0-9]{1,9}\Z")
_DECIMAL_COMMA = re.compile(r"([-+]?[0-9]{1,15}),([0-9]{1,15})((?: ?[A-Za-z%][^,]*)?)\Z")
_COMMENT = re.compile(r"([^#]*[^#\s])#(.*)\Z")
_POWER = re.compile(r"(?<=[A-Za-z])([23])(?![0-9])")
_ONE_UNIT = r"\(?[A-Za-zµ°%]+(?:(?:\*\*|\^)[1-9]\.5|(?:\*\*|\^)?-?[1-9]|[²³])?\)?"
_UNIT = re.compile(rf"{_ONE_UNIT}(?:(?:\s*[*/·.]\s*|\s+){_ONE_UNIT})*\Z")

# The units of this field and no more: pint's own list is long to load and takes `h` for hour, `a` for year.
_DEFINITIONS = """
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
metre = [length] = m = meter
second = [time] = s = sec
gram = [mass] = g
tonne = 1e6 * gram = t = ton
radian = [] = rad
percent = 0.01 * radian = pct
newton = kilogram * metre / second ** 2 = N
pascal = newton / metre ** 2 = Pa
inch = 0.0254 * metre = in
foot = 0.3048 * metre = ft
minute = 60 * second = min
hertz = 1 / second = Hz
gal = 0.01 * metre / second ** 2 = Gal
"""

_COMMON = {
    "m": {"m": 1.0, "cm": 0.01, "mm": 1e-3},
    "s": {"s": 1.0, "ms": 1e-3},
    "kg": {"kg": 1.0, "t": 1e3},
    "N": {"N": 1.0, "kN": 1e3, "MN": 1e6},
    "N/m": {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6},
    "N/m^1.5": {"N/m^1.5": 1.0, "kN/m^1.5": 1e3, "MN/m^1.5": 1e6},
    "m/s2": {"m/s2": 1.0, "g": GRAVITY},
}
"""Factors to SI of what nearly all studies are written in: to load pint takes a quarter of a second."""


@cache
def _registry() -> UnitRegistry:
    from pint import UnitRegistry

    registry: UnitRegistry = UnitRegistry(None)
    registry.load_definitions([line for line in _DEFINITIONS.splitlines() if line])
    return registry


@cache
def _factor(unit: str, si: str) -> float | None:
    """One `unit` in `si` [-], or None where the dimensions differ.  Raises ValueError for an unknown unit."""
    if unit in _COMMON.get(si, ()):
        return _COMMON[si][unit]
    if unit == "%":
        return 0.01 if si == "" else None
    return _converted(unit, si)


def _converted(unit: str, si: str) -> float | None:
    """The same by pint, which would compute any power and take any number: only products of units reach it."""
    if len(unit) > LONGEST_UNIT or not _UNIT.match(unit):
        raise ValueError(unit)
    registry = _registry()
    try:
        wanted = registry.parse_units(_POWER.sub(r"**\1", si)) if si else registry.parse_units("radian")
        given = registry.parse_units(_POWER.sub(r"**\1", unit))
        ratio = registry.Quantity(1.0, given)
        if ratio.dimensionality != registry.Quantity(1.0, wanted).dimensionality:
            return None
        return float(ratio.to(wanted).magnitude)
    except Exception as error:  # pint raises many kinds, tokenizer errors among them
        raise ValueError(unit) from error


def written_unit(text: str) -> str:
    """The unit in a text such as "5 cm"; "" where it names none or is no quantity."""
    found = _QUANTITY.match(text.strip()) if len(text) <= LONGEST else None
    return (found["unit"] or "") if found else ""


def factor_of(unit: str, si: str) -> float | None:
    """One `unit` in `si` [-]; None where it is unknown or of another dimension."""
    try:
        return _factor(unit, si)
    except ValueError:
        return None


def refuse(message: str, hint: str) -> PydanticCustomError:
    """A pydantic error that carries a hint; braces in the texts are left alone."""
    return PydanticCustomError("refused", "{message}", {"message": message, "hint": hint})


@dataclass(frozen=True)
class Quantity:
    """A number with a unit: put it into `Annotated[float, ...]`.

    name : what the number is; si : its SI unit ("" for a plain number); example : how to write one
    low, high : the range allowed, in SI; open_low, open_high : the end itself is excluded
    words : other texts, taken as they are
    """

    name: str
    si: str
    example: str
    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False
    open_high: bool = False
    words: tuple[str, ...] = ()

    @property
    def range(self) -> str:
        """The range in words, e.g. "above 0 s and at most 20 s"."""
        unit = f" {self.si}" if self.si else ""
        parts = []
        if self.low > -math.inf:
            parts.append(f"above {self.low:g}{unit}" if self.open_low else f"at least {self.low:g}{unit}")
        if self.high < math.inf:
            parts.append(f"below {self.high:g}{unit}" if self.open_high else f"at most {self.high:g}{unit}")
        return " and ".join(parts)

    @property
    def wanted(self) -> str:
        """What to write, in words."""
        what = f"{'an' if self.name[0] in 'aeio' else 'a'} {self.name}" + (f" [{self.si}]" if self.si else "")
        limits = f" {self.range}" if self.range else ""
        words = "".join(f" or {word}" for word in self.words)
        return f"write {what}{limits}{words}, e.g. {self.example}"

    def read(self, value: Any) -> Any:
        """The SI number, or one of `words` as it is.  Raises PydanticCustomError saying what to write."""
        if isinstance(value, str) and value.strip() in self.words:
            return value.strip()
        number = self._number(value)
        if not math.isfinite(number):
            raise refuse(f"{value} is not a finite number", self.wanted)
        too_low = number < self.low or (self.open_low and number == self.low)
        too_high = number > self.high or (self.open_high and number == self.high)
        if too_low or too_high:
            unit = f" {self.si}" if self.si else ""
            raise refuse(f"the {self.name} is {number:g}{unit}; it must be {self.range}", self.wanted)
        return number

    def _number(self, value: Any) -> float:
        if isinstance(value, list | tuple | dict):
            what = "a mapping" if isinstance(value, dict) else "a list"
            hint = f"{self.wanted}; several values to run one after the other stand under `sweep:`"
            raise refuse(f"{what} stands where one {self.name} belongs", hint)
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            shown = {True: "true", False: "false", None: "nothing"}.get(value, "this")
            raise refuse(f"{shown} is not a {self.name}", self.wanted)
        if not isinstance(value, str):
            return float(value)
        value = value.strip()
        if len(value) > LONGEST:
            raise refuse(f"{len(value)} characters are not a {self.name}", self.wanted)
        found = _QUANTITY.match(value)
        if not found:
            raise refuse(f"'{value}' is not a number with a unit{_slip(value)}", self.wanted)
        number = float(found["top"])
        if found["bottom"] is not None:
            bottom = float(found["bottom"])
            if bottom == 0.0:
                raise refuse(f"'{value}' divides by zero", self.wanted)
            number /= bottom
        unit = found["unit"]
        if unit is None:
            return number
        try:
            factor = _factor(unit, self.si)
        except ValueError:
            raise refuse(f"'{unit}' is not a unit this program knows{_slip(value)}", self.wanted) from None
        if factor is None:
            if self.si == "kg" and (force := factor_of(unit, "N")) is not None:
                tonnes = f"{number * force / GRAVITY / 1000:.3g} t"
                raise refuse(f"'{value}' is a force, not a mass: the weight of about {tonnes}", f"write `{tonnes}`")
            expected = f"expected {self.si}" if self.si else "expected a plain number"
            raise refuse(f"'{value}' is no {self.name}: {expected}", self.wanted)
        return number * factor

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        number: dict[str, Any] = {"type": "number"}
        if self.low > -math.inf:
            number["exclusiveMinimum" if self.open_low else "minimum"] = self.low
        if self.high < math.inf:
            number["exclusiveMaximum" if self.open_high else "maximum"] = self.high
        title = f"{self.name} [{self.si}]" if self.si else self.name
        return {
            "anyOf": [number, {"type": "string"}],
            "title": title,
            "examples": [self.example, *self.words],
        }


def _slip(value: str) -> str:
    """What is probably meant by a text that is no quantity, as the end of a message."""
    if found := _DECIMAL_COMMA.match(value):
        return f": it has a decimal comma, write `{found[1]}.{found[2]}{found[3]}`"
    if found := _COMMENT.match(value):
        return f": a comment needs a blank before its #, write `{found[1]}  # {found[2].strip()}`"
    return ""


def limited(quantity: Quantity, **changes: Any) -> Quantity:
    """The same quantity with another name, example or range."""
    return replace(quantity, **changes)


@dataclass(frozen=True)
class TextForm:
    """A value read by a function of its own; `form` and `examples` tell the JSON schema how it may look.

    quantity : what it is where it is a number with a unit
    """

    read: Callable[[Any], Any]
    form: str
    examples: tuple[Any, ...]
    quantity: Quantity | None = None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        kinds = [{"type": "number"}, {"type": "string"}]
        return {"anyOf": kinds, "title": self.form, "examples": list(self.examples)}


@dataclass(frozen=True)
class Measured:
    """A number with a unit of any dimension: its value in SI units and its powers of kg, m and s.

    text : as it is written
    """

    value: float
    dimension: tuple[float, float, float]
    text: str


def measured(value: Any) -> Measured:
    """A number with any unit, or none.  Raises PydanticCustomError saying what to write."""
    unit = written_unit(value) if isinstance(value, str) else ""
    factor, dimension = 1.0, (0.0, 0.0, 0.0)
    if unit and unit != "%":
        try:
            factor, dimension = _measure(unit)
        except ValueError:
            raise refuse(f"'{unit}' is not a unit this program knows", "write e.g. 20 kN/mm or 5e12 N/m^3") from None
    bare = value.strip().removesuffix(unit) if unit and unit != "%" else value
    number = Quantity("parameter", "", "20 kN/mm").read(bare)
    return Measured(number * factor, dimension, str(value))


@cache
def _measure(unit: str) -> tuple[float, tuple[float, float, float]]:
    """One `unit` in kg, m and s, and its powers of them.  Raises ValueError for an unknown unit."""
    if len(unit) > LONGEST_UNIT or not _UNIT.match(unit):
        raise ValueError(unit)
    registry = _registry()
    try:
        base = registry.Quantity(1.0, registry.parse_units(_POWER.sub(r"**\1", unit))).to_base_units()
        mass, length, time = (
            float(str(base.dimensionality.get(f"[{name}]", 0.0))) for name in ("mass", "length", "time")
        )
        return float(base.magnitude) * 1e-3**mass, (mass, length, time)
    except Exception as error:  # pint raises many kinds, tokenizer errors among them
        raise ValueError(unit) from error


def whole_number(low: int, high: int) -> BeforeValidator:
    """Digits and nothing else, for `Annotated[int, ...]`: neither true, nor 1_0, nor digits of other scripts."""

    def read(value: Any) -> int:
        if isinstance(value, str) and _DIGITS.match(value):
            value = int(value)
        if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int):
            raise refuse(f"{_said(value)} is not a whole number", f"write a whole number from {low} to {high}, e.g. 5")
        if not low <= value <= high:
            bound = f"at least {low}" if value < low else f"at most {high}"
            raise refuse(f"'{value}' is not allowed; it must be {bound}", f"write a number {bound}")
        return value

    return BeforeValidator(read)


def _said(value: Any) -> str:
    if isinstance(value, list | tuple | dict):
        return "a mapping" if isinstance(value, dict) else "a list"
    return {True: "true", False: "false", None: "nothing"}.get(value, f"'{str(value)[:60]}'")


LENGTH = Quantity("length", "m", "3 m", 0.0, open_low=True)
GAP = Quantity("gap", "m", "5 cm", 0.0, 10.0)
MASS = Quantity("mass", "kg", "200 t", 0.0, open_low=True)
TIME = Quantity("time", "s", "0.36 s", 0.0, open_low=True)
STIFFNESS = Quantity("stiffness", "N/m", "200 kN/mm", 0.0, open_low=True)
FORCE = Quantity("force", "N", "900 kN", 0.0, open_low=True)
ACCELERATION = Quantity("acceleration", "m/s2", "0.35 g", 0.0, open_low=True)

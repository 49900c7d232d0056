"""Plans of floors that twist, as a study writes them: pydantic models, and what may be wrong with their keys."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field
from pydantic_core import PydanticCustomError

from pounding_cli.errors import Issue
from pounding_cli.study.schema.base import Model, list_or, one_or_many, spec_field
from pounding_cli.study.schema.quantity import (
    BOTH_SIGNS,
    FORCE,
    LENGTH,
    PLAUSIBLE_RANGES,
    STIFFNESS,
    Quantity,
    quote,
    refuse,
)

PLACE = Quantity("place", "m", "-6 m", -1000.0, 1000.0)
"""A place across the row [m], from the middle of a plan."""

_SIZE = LENGTH.replace(high=500.0, usual=PLAUSIBLE_RANGES["size of a plan"])
PLAN_WIDTH = _SIZE.replace(name="width", example="20 m")
PLAN_DEPTH = _SIZE.replace(name="depth", example="14 m")


@dataclass(frozen=True)
class _PartOfWidth(Quantity):
    """A place across the row as part of the width, from the middle of the plan: half of the width is its edge."""

    @property
    def range(self) -> str:
        """The range in words, with its reason."""
        return f"{super().range} (half of the width is the edge of the plan)"

    def _format_number(self, number: float) -> str:
        """Return the part in %."""
        return f"{100 * number:g} %"


@dataclass(frozen=True)
class _AccidentalPart(_PartOfWidth):
    """A part of the width, to one side or, as `+-5 %`, to both; `study.both_sides` reads the latter."""

    @property
    def usage(self) -> str:
        """The way to write one, in words."""
        return f"{super().usage}, which most codes ask for, or to both sides, `+-{self.example}`"

    def read(self, value: Any) -> Any:
        """Return the part.  Raises PydanticCustomError."""
        match = BOTH_SIGNS.match(value) if isinstance(value, str) else None
        if match is None:
            return super().read(value)
        try:
            size = super().read(match[1])
        except PydanticCustomError as error:
            context = error.context or {}
            raise refuse(f"{quote(value)}: {context.get('message')}", context.get("hint", "")) from None
        if size == 0.0:
            raise refuse(f"{quote(value)} is the same on both sides", self.usage)
        hint = "write it as `accidental` of a plan; among the values of a sweep write both"
        raise refuse(f"{quote(value)} stands where one value belongs", f"{hint}, `-{match[1]}` and `{match[1]}`")


RATIO_OF_WIDTH = _PartOfWidth("part of the width", "", "10 %", -0.5, 0.5, open_low=True, open_high=True)
ACCIDENTAL = _AccidentalPart("part of the width", "", "5 %", -0.5, 0.5, open_low=True, open_high=True)


REST = "rest"
"""Word for the share that all others leave."""


def find_fault_in_shares(shares: Sequence[float | str]) -> tuple[str, str]:
    """Return what is wrong with shares that must add up to the whole, and what to write; "" where nothing is."""
    numbers = [share for share in shares if isinstance(share, float)]
    total = sum(numbers)
    missing = len(shares) - len(numbers)
    if missing > 1:
        return f"have `{REST}` {missing} times", "write it once: it stands for what all others leave"
    if missing == 1 and total > 1.0 - 1e-9:
        return f"beside `{REST}` add up to {100 * total:.6g} %", "let them add up to less than 100 %"
    if missing == 0 and abs(total - 1.0) > 1e-9:
        return f"add up to {100 * total:.6g} %", f"let them add up to 100 %, or write `{REST}` for one of them"
    return "", ""


def fill_rest(shares: Sequence[float | str]) -> tuple[float, ...]:
    """Return shares with a number in place of `rest` [-]."""
    left = 1.0 - sum(share for share in shares if isinstance(share, float))
    return tuple(share if isinstance(share, float) else left for share in shares)


@dataclass(frozen=True)
class _Share(Quantity):
    """A share of what all lines of a storey have, in place of a list of numbers.

    numbers : how a list of them is written
    """

    numbers: str = ""

    def read(self, value: Any) -> Any:
        """Return the share, or one of `words`.  Raises PydanticCustomError: one number is neither share nor list."""
        is_number = isinstance(value, int | float | str) and not isinstance(value, bool)
        if not is_number or value in self.words or str(value).strip().endswith("%"):
            return super().read(value)
        words = "".join(f", or `{word}`" for word in self.words)
        hint = (
            f"write a share such as `60 %`, or the numbers of all storeys from the ground up, `{self.numbers}`{words}"
        )
        raise refuse(f"{quote(value)} is neither a share nor a list", hint)


_SHARE = _Share("share of the storey", "", "60 %", 0.0, 1.0, open_low=True, percent=True)
_SHARE_OF_STIFFNESS = dataclasses.replace(_SHARE, numbers="[200 kN/mm, 150 kN/mm]")
_SHARE_OF_YIELD_SHEAR = dataclasses.replace(_SHARE, numbers="[900 kN, 700 kN]", words=("never",))
_PART_OF_STIFFNESS = dataclasses.replace(_SHARE_OF_STIFFNESS, words=(REST,))
_PART_OF_YIELD_SHEAR = dataclasses.replace(_SHARE_OF_YIELD_SHEAR, words=(REST, "never"))
Inertias: Any = one_or_many(Annotated[float, Quantity("rotary inertia", "kg m2", "1e7 kg m2", 0.0, open_low=True)])
TorsionalStiffnesses: Any = one_or_many(Annotated[float, Quantity("torsional stiffness", "N m", "5e9 N m", 0.0)])
_SHORT_FORM = ("eccentricity", "frequency_ratio")
"""Keys in place of `lines`."""


@dataclass(frozen=True)
class _NumberOfStorey(Quantity):
    """The number of one storey in the list of a line."""

    def read(self, value: Any) -> Any:
        """Return the number.  Raises PydanticCustomError: it is a share, which stands alone."""
        if isinstance(value, str) and value.strip().endswith("%"):
            hint = (
                f"write the share alone, `{value.strip()}`: it is that of every storey; or numbers, e.g. {self.example}"
            )
            raise refuse(f"{quote(value)} is a share in a list of numbers", hint)
        return super().read(value)


def _each_storey(quantity: Quantity, one: Any) -> Any:
    """Return the type of a list from the ground up, or of something else."""
    number = _NumberOfStorey(**{each.name: getattr(quantity, each.name) for each in dataclasses.fields(Quantity)})
    return list_or(Annotated[tuple[Annotated[float, number], ...], Field(min_length=1, max_length=100)], one)


class _LineSpec(Model):
    """A frame or wall of the plan; lists run from the ground up."""

    stiffness: _each_storey(STIFFNESS, Annotated[float, _SHARE_OF_STIFFNESS]) = spec_field(  # type: ignore[valid-type]
        ..., "stiffness of its storeys [N/m], a list, or its share of those of the building", "60 %"
    )
    yield_shear: _each_storey(FORCE, Annotated[float | str, _SHARE_OF_YIELD_SHEAR]) | None = spec_field(  # type: ignore[valid-type]
        None,
        "yield shears of its storeys [N], a list; `never`: it stays elastic; or its share of those of the building; "
        "default: its share of the stiffness",
        "60 %",
    )


class LineSpec(_LineSpec):
    """A frame or wall along the row; lists run from the ground up."""

    stiffness: _each_storey(STIFFNESS, Annotated[float | str, _PART_OF_STIFFNESS]) = spec_field(  # type: ignore[valid-type]
        ...,
        "stiffness of its storeys [N/m], a list, or its share of those of the building; `rest`: what other lines leave",
        "60 %",
    )
    yield_shear: _each_storey(FORCE, Annotated[float | str, _PART_OF_YIELD_SHEAR]) | None = spec_field(  # type: ignore[valid-type]
        None,
        "yield shears of its storeys [N], a list; `never`: it stays elastic; or its share of those of the building, "
        "`rest` for what other lines leave; default: its share of the stiffness",
        "60 %",
    )
    y: Annotated[float, PLACE] = spec_field(..., "its place across the row [m], from the middle of the plan", "-8 m")


class AcrossSpec(_LineSpec):
    """A frame or wall across the row, which resists the twist alone; lists run from the ground up."""

    x: Annotated[float, PLACE] = spec_field(..., "its place along the row [m], from the centre of mass", "-6 m")


def _is_share(value: Any) -> bool:
    """Return whether a line has a share of its storeys, not numbers."""
    return isinstance(value, float) or value == REST


class PlanSpec(Model):
    """The plan of a building whose floors may twist."""

    width: Annotated[float, PLAN_WIDTH] = spec_field(
        ..., "width of the floors across the row, along the street [m]", "20 m"
    )
    depth: Annotated[float, PLAN_DEPTH] | None = spec_field(
        None, "depth of the floors along the row [m], for their rotary inertia"
    )
    shift: Annotated[float, PLACE] = spec_field(
        "0 m", "how far the middle of the plan stands off along the street [m], the same way as y"
    )
    centre_of_mass: Annotated[float, PLACE] = spec_field(
        "0 m", "y of the centres of mass of the floors [m], from the middle of the plan"
    )
    accidental: Annotated[float, ACCIDENTAL] = spec_field(
        "0 %",
        "how far the centres of mass stand off further, while the lines stay, as part of the width [-]; `+-5 %` runs "
        "-5 %, 0 % and 5 %, as an unknown value of the sweep",
    )
    inertia: Inertias | None = spec_field(
        None, "rotary inertia of the floors about their centres of mass [kg m2]; default: m (width^2 + depth^2) / 12"
    )
    lines: Annotated[tuple[LineSpec, ...], Field(min_length=1, max_length=30)] | None = spec_field(
        None, "frames and walls along the row", [{"y": "-8 m", "stiffness": "60 %"}, {"y": "8 m", "stiffness": "40 %"}]
    )
    across: Annotated[tuple[AcrossSpec, ...], Field(max_length=30)] = spec_field(
        (), "frames and walls across the row that may yield", [{"x": "-6 m", "stiffness": "60 %"}]
    )
    torsional_stiffness: TorsionalStiffnesses | None = spec_field(
        None, "of what else resists the twist of a storey, such as elastic frames across the row [N m]"
    )
    eccentricity: Annotated[float, RATIO_OF_WIDTH] | None = spec_field(
        None,
        "instead of `lines`: y of the centre of stiffness from the centre of mass, without what is accidental, as part "
        "of the width [-]",
    )
    frequency_ratio: Annotated[float, Quantity("ratio of frequencies", "", "1.1", 0.05, 20.0)] | None = spec_field(
        None,
        "beside `eccentricity`: first frequency of the twist about the centres of mass over that along the row, each "
        "without the other [-]; the torsional stiffness follows from it",
    )
    twist: Literal["auto", "always"] = spec_field(
        "auto", "`auto`: floors twist where something is eccentric; `always`: they may turn in any case"
    )

    @property
    def centre(self) -> float:
        """y of the centres of mass from the middle of the plan [m]."""
        return self.centre_of_mass + self.accidental * self.width

    def list_lengths(self) -> dict[str, int]:
        """Return the lengths of its lists, by key."""
        values = {"inertia": self.inertia, "torsional_stiffness": self.torsional_stiffness}
        found = {name: len(value) for name, value in values.items() if isinstance(value, tuple)}
        for key, lines in (("lines", self.lines or ()), ("across", self.across)):
            for number, line in enumerate(lines):
                for name in ("stiffness", "yield_shear"):
                    value = getattr(line, name)
                    if isinstance(value, tuple):
                        found[f"{key}.{number}.{name}"] = len(value)
        return found

    @property
    def gives_stiffness(self) -> bool:
        """True where the lines give the stiffness of the storeys, not shares of it."""
        return bool(self.lines) and all(isinstance(line.stiffness, tuple) for line in self.lines or ())

    @property
    def gives_yield_shear(self) -> bool:
        """True where the lines give the yield shears of the storeys, not shares of them."""
        values = [line.yield_shear for line in self.lines or ()]
        return bool(values) and not any(value is None or _is_share(value) for value in values)

    def fill_rest(self, name: str) -> tuple[Any, ...]:
        """Return what the lines along the row have at a key, with a share in place of `rest`.

        name : "stiffness" or "yield_shear"
        """
        values = tuple(getattr(line, name) for line in self.lines or ())
        return fill_rest(values) if REST in values else values

    def issues(self) -> Iterator[Issue]:
        if self.depth is None and self.inertia is None:
            hint = "write the depth of the floors along the row, e.g. `depth: 14 m`, or `inertia`"
            yield Issue((), "'depth' is missing: the rotary inertia of the floors needs it", hint)
        half = 0.5 * self.width
        if abs(self.centre) >= half:
            key = "centre_of_mass" if abs(self.centre_of_mass) >= half else "accidental"
            message = f"the centres of mass stand {self.centre:g} m from the middle of the plan, outside of its "
            hint = f"let `centre_of_mass` and `accidental` put them between {-half:g} and {half:g} m"
            yield Issue((key,), f"{message}{self.width:g} m", hint)
        if self.lines is not None:
            for name in _SHORT_FORM:
                if getattr(self, name) is not None:
                    yield Issue(
                        (name,), f"'{name}' and 'lines' cannot both be given", "remove one of the two", at_key=True
                    )
            yield from self._find_line_issues()
            return
        if self.eccentricity is None:
            hint = "write `lines`, or in short `eccentricity: 10 %` and `frequency_ratio: 1.1`"
            yield Issue((), "this plan has neither 'lines' nor 'eccentricity'", hint)
        elif self.frequency_ratio is None:
            hint = "write the frequency of the twist over that along the row, e.g. `frequency_ratio: 1.1`"
            yield Issue((), "'frequency_ratio' is missing: 'eccentricity' needs it", hint)
        for name in ("across", "torsional_stiffness"):
            if self.eccentricity is not None and getattr(self, name):
                hint = "remove it: 'frequency_ratio' sets the torsional stiffness; or write `lines`"
                yield Issue((name,), f"'{name}' does not apply beside 'eccentricity'", hint, at_key=True)

    def _find_line_issues(self) -> Iterator[Issue]:
        """Yield what is wrong with the lines: shares beside numbers, shares that do not add up, places outside."""
        assert self.lines is not None
        for name in ("stiffness", "yield_shear"):
            values = [getattr(line, name) for line in self.lines]
            given = [value for value in values if value is not None]
            shares = [value for value in given if _is_share(value)]
            if name == "yield_shear" and given and len(given) < len(values):
                number = values.index(None)
                hint = "write it in every line, or in none: each has its share of the stiffness"
                yield Issue(("lines", number), f"'{name}' is missing, but other lines have it", hint)
            elif shares and len(shares) < len(given):
                number = next(place for place, value in enumerate(values) if _is_share(value))
                other = "`never`" if "never" in given else "a list of numbers"
                message = f"'{name}' is a share here, but {other} in other lines"
                yield Issue(
                    ("lines", number, name), message, "write shares in all lines, or numbers in all", at_key=True
                )
            elif shares:
                message, hint = find_fault_in_shares(shares)
                if message:
                    yield Issue(("lines",), f"the shares of 'lines' in '{name}' {message}", hint, at_key=True)
        half = 0.5 * self.width
        for number, line in enumerate(self.lines):
            if abs(line.y) > half * (1.0 + 1e-12):
                message = f"the line stands at {line.y:g} m, outside of the plan"
                yield Issue(
                    ("lines", number, "y"), message, f"write a place from {-half:g} to {half:g} m, or a larger width"
                )
        for number, across in enumerate(self.across):
            if self.depth is not None and abs(across.x) > self.depth:
                message = f"the line stands {across.x:g} m from the centre of mass, outside of the plan"
                yield Issue(("across", number, "x"), message, f"write a place within its depth of {self.depth:g} m")

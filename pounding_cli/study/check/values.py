"""Check values: what is plausible, and what may have been meant.

The ranges are those of `schema/quantity.py`."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args, get_origin

import numpy as np
from pydantic import BaseModel

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.study.schema.lookup import fields_of, leaf_types
from pounding_cli.study.schema.quantity import NUMBER_PATTERN, ParsedText, PlausibleRange, Quantity, lacks_unit
from pounding_cli.study.text.file import Map, get
from pounding_cli.units import GRAVITY

MAX_IN_G = 3.0
"""Largest number without a unit that may have been meant in g: recorded peaks reach 3 g."""

MIN_IN_CM = 0.1
"""Smallest number without a unit that may have been a gap in cm: of gaps in m hardly one is as wide."""

BARE = 1000.0
"""Excess of a number without a unit, which is told before any that is beyond a range."""

AS_MEANT = "the study runs as it is"
_NUMBER_AND_UNIT = re.compile(rf"\s*({NUMBER_PATTERN})\s*(.*?)\s*\Z")


class Written:
    """What a file has: the texts of its values, beside which these are checked.

    tree : the file
    needs_units : whether a number should have its unit, as in a file; in Python data numbers are SI
    """

    def __init__(self, tree: Map, needs_units: bool = True) -> None:
        self.tree = tree
        self.needs_units = needs_units

    def find_text(self, path: KeyPath) -> str:
        """Return what stands at a path, as text; "" where nothing does."""
        value = get(self.tree, *path)
        return "" if value is None else str(value)


@dataclass(frozen=True)
class RelativeRange:
    """The plausible range of values of a key, beside something else.

    fits : plausible range of value * share
    share : reciprocal of what they are compared with [1/SI unit of the value]
    name : of the value, in words
    than : what they are compared with, in words
    code : of a value that is beyond the range
    """

    fits: PlausibleRange
    share: float
    name: str
    than: str
    code: str

    def ratio_in_words(self, value: float) -> str:
        """Return the ratio in words, e.g. `0.2 times that of the stiffest storey`."""
        return f"{value * self.share:.2g} {self.than}"


# Values and their ranges


def check_values(
    written: Written,
    spec: BaseModel,
    path: KeyPath,
    compared: Mapping[str, RelativeRange] | None = None,
    skip: Sequence[str] = (),
) -> Iterator[Issue]:
    """Yield the values that a validated mapping, or one below it, gives and that are implausible or have no unit.

    compared : what the values of some of its keys are compared with
    skip : keys that are not looked at
    """
    for key, (name, quantity) in list_quantities(type(spec)).items():
        value = getattr(spec, name)
        of = (*path, key)
        node = get(written.tree, *of)
        if name not in spec.model_fields_set or node is None or key in skip:
            continue
        for below, each in _scalars_of(value, node):
            here = (*of, *below)
            if isinstance(each, BaseModel):
                yield from check_values(written, each, here)
            elif quantity is not None and isinstance(each, float):
                yield from check_value(written, key, quantity, each, here, of, (compared or {}).get(key))


def _scalars_of(value: Any, written: Any) -> list[tuple[KeyPath, Any]]:
    """Return the values of a key, each with its place below it: those of a list, of a mapping, or the one."""
    if isinstance(value, tuple):
        return [((n,) if isinstance(written, list) else (), each) for n, each in enumerate(value)]
    if isinstance(value, dict) and isinstance(written, dict):
        return [((word,), each) for word, each in zip(written, value.values(), strict=False)]
    return [((), value)]


@functools.cache
def list_quantities(model: type[BaseModel]) -> dict[str, tuple[str, Quantity | None]]:
    """Return of every key of a mapping its attribute, and the quantity that it takes."""
    names = {info.alias or name: name for name, info in model.model_fields.items()}
    found = {}
    for key, (hint, _) in fields_of(model).items():
        kinds = list(leaf_types(hint))
        kinds += [one for kind in kinds if get_origin(kind) in (tuple, dict) for one in leaf_types(get_args(kind)[-1])]
        kinds += [one for kind in kinds if get_origin(kind) is tuple for one in leaf_types(get_args(kind)[0])]
        quantities = (kind.quantity if isinstance(kind, ParsedText) else kind for kind in kinds)
        found[key] = names[key], next((each for each in quantities if isinstance(each, Quantity)), None)
    return found


def check_value(
    written: Written,
    key: str,
    quantity: Quantity,
    value: float,
    path: KeyPath,
    of: KeyPath,
    compared: RelativeRange | None = None,
) -> Iterator[Issue]:
    """Yield that a value is implausible or has no unit, with what may have been meant.

    path, of : of the value, and of the key that it is a value of
    compared : what it is compared with, in place of the plausible range of the quantity
    """
    text = written.find_text(path)
    is_bare = lacks_its_unit(text, quantity)
    if is_bare and quantity.si == "m/s2" and 0 < value <= MAX_IN_G:
        message = f"{key}: {text} has no unit: it is {value:.4g} m/s2 = {value / GRAVITY:.3f} g"
        hint = f"write `{text} g`, or `{text} m/s2` if that is meant"
        yield Issue(path, message, hint, code="unit", of=of, excess=BARE)
        return
    if is_bare and quantity.name == "gap" and MIN_IN_CM <= value <= 1.0 and written.needs_units:
        message = f"{key}: {text} has no unit: it is {value:.4g} m = {100 * value:.4g} cm"
        hint = f"write `{text} cm`, or `{text} m` if that is meant"
        yield Issue(path, message, hint, code="unit", of=of, excess=BARE)
        return
    fits = quantity.usual if compared is None else compared.fits
    share = 1.0 if compared is None else compared.share
    is_plausible = fits is None or fits.holds(value * share)
    excess = 0.0 if fits is None else fits.excess(value * share)
    size = format_value(value, units_of_size(quantity.si) if fits is None else fits.units)
    if compared is not None:
        size += f", {compared.ratio_in_words(value)}"
    reason = "" if is_plausible or fits is None else f": {fits.reason}"
    if is_bare and written.needs_units and customary_unit(quantity.si) != "":
        message = f"{key}: {text} has no unit: it is {size}{reason}"
        hint = suggest_unit(text, value, fits, share, quantity.si)
        yield Issue(path, message, hint, code="unit", of=of, excess=BARE + excess)
    elif fits is not None and not is_plausible:
        name = fits.name if compared is None else compared.name
        code = "value" if compared is None else compared.code
        hint = suggest_value(text, value, fits, share)
        yield Issue(path, f"{name} is {size}{reason}", hint, code=code, of=of, excess=excess)


def customary_unit(si: str) -> str:
    """Return the unit in which people write a quantity of SI unit `si`; "" where that is the SI unit itself.

    Forces, stiffnesses, dashpots and inertias are written in kN and t; masses, lengths, times and moduli have ranges
    that tell the unit.
    """
    if si == "N/m2":
        return ""
    if si.startswith("N"):
        return f"k{si}"
    return si.replace("kg", "t", 1) if si.startswith("kg ") else ""


def units_of_size(si: str) -> dict[str, float]:
    """Return the units in which people write a quantity of SI unit `si`, with their factors to it."""
    if si.startswith("N"):
        return {f"{prefix}{si}": factor for prefix, factor in (("k", 1e3), ("M", 1e6), ("G", 1e9), ("", 1.0))}
    return {customary_unit(si): 1e3, si: 1.0}


def lacks_its_unit(text: str, quantity: Quantity) -> bool:
    """Return whether a text is a number without the unit that it should have."""
    return text != "" and lacks_unit(text, quantity)


def format_value(value: float, units: Mapping[str, float]) -> str:
    """Return a value in the unit a person would use: the largest that it is at least one of, seconds from 0.01 s on."""
    sizes = sorted(units.items(), key=lambda unit: unit[1])
    fitting = [unit for unit in sizes if value >= unit[1] * (0.01 if unit[0] == "s" else 1 - 1e-12)]
    unit, factor = (fitting or sizes[:1])[-1]
    return f"{format_rounded(value / factor)} {unit}"


def _find_plausible_texts(text: str, value: float, fits: PlausibleRange, share: float) -> list[str]:
    """Return the number of a text in the other units in which it would be plausible, the likeliest first."""
    parted = _NUMBER_AND_UNIT.match(text)
    written = parted[1] if parted else "0"
    number = float(written)
    return [
        f"{written} {unit}"
        for unit, factor in fits.units.items()
        if number > 0 and not np.isclose(number * factor, value) and fits.holds(number * factor * share)
    ]


def suggest_value(text: str, value: float, fits: PlausibleRange, share: float = 1.0, si: str = "") -> str:
    """Return the same number in another unit, else with its decimal point elsewhere, `share` of which is plausible.

    si : the unit in which a number without one was read
    """
    meant = _find_plausible_texts(text, value, fits, share)
    meant += [format_value(value * f, fits.units) for f in (0.1, 10.0, 0.01, 100.0) if fits.holds(value * f * share)]
    otherwise = f"otherwise write `{text} {si}`" if si else f"otherwise leave it, {AS_MEANT}"
    return f"did you mean {meant[0]}? {otherwise}" if meant else f"leave it if meant, {AS_MEANT}"


def suggest_unit(
    text: str, value: float, fits: PlausibleRange | None, share: float, si: str, multiple: str = ""
) -> str:
    """Return the units in which a number without one would be plausible.

    fits : plausible range of value * share; None where none is known
    multiple : what the number may be a multiple of, in place of a unit
    """
    if fits is None:
        return f"write `{text} {customary_unit(si)}`, or `{text} {si}` if that is meant"
    meant = [each for each in _find_plausible_texts(text, value, fits, share) if not each.endswith("MN/mm")]
    number = _NUMBER_AND_UNIT.match(text)
    if multiple and number and fits.holds(float(number[1])):
        meant.insert(0, f"{text} x {multiple}")
    units = " or ".join(f"`{each}`" for each in meant)
    if units:
        return f"write {units}, or `{text} {si}` if that is meant"
    return f"write its unit, `{text} {si}` if that is meant"


def format_rounded(value: float) -> str:
    """Return a value to three digits, and to whole numbers from 1000 on."""
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"

"""Numbers as a user reads them: results, counts, times, and quantities in the unit a study wrote."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

NOTHING = "–"
"""Stands where there is no number."""

ROUNDING = 1e-9
"""Relative difference up to which the ends of a range are one number [-]."""

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def format_number(value: float, digits: int = 4) -> str:
    """Return a computed number with its significant digits: 1.234, 12.34, 3.100×10⁻⁹; `NOTHING` if it is not finite."""
    if not math.isfinite(value):
        return NOTHING
    if value == 0:
        return "0"
    mantissa, power = f"{value:.{digits - 1}e}".split("e")
    exponent = int(power)
    if -3 <= exponent < 6:
        decimals = max(digits - 1 - exponent, 0)
        return f"{value:.{decimals}f}".replace("-", "−")
    return f"{mantissa}×10{str(exponent).translate(_SUPERSCRIPTS)}".replace("-", "−")


def format_range(least: float, most: float, form: str) -> str:
    """Return the ends of a range as they are written, "60 to 63", or one of them where they are equal.

    form : of a number, such as ".3g". Ends that differ by rounding are equal, though a half may round apart.
    """
    if most - least <= ROUNDING * abs(most):
        most = least
    low = format(least, form)
    high = format(most, form)
    return low if low == high else f"{low} to {high}"


def pluralize(number: int, one: str, many: str = "") -> str:
    """Return a number with its noun: `1 scene`, `2 scenes`; `many` where an s does not make the plural."""
    return f"{number} {one if number == 1 else many or one + 's'}"


def count_histories(number: int) -> str:
    """Return a number of time histories: `1 time history`, `2 time histories`."""
    return pluralize(number, "time history", "time histories")


def round_roughly(number: int) -> int:
    """Return a number that is known about, to two digits."""
    return int(float(f"{number:.2g}"))


def join_limited(words: Iterable[str], max_characters: int = 1600, last: str = ", ") -> str:
    """Return words joined by commas, `a, b, c`; of more than fill a screen (`max_characters`), how many are left.

    last : what stands before the last word where all are shown
    """
    words = list(words)
    shown = sum(end <= max_characters for end in accumulate(len(word) + 2 for word in words))
    left = len(words) - shown
    if left == 0 and len(words) > 1:
        return f"{', '.join(words[:-1])}{last}{words[-1]}"
    return ", ".join(words[:shown]) + (f" and {left} more" if left else "")


def format_duration(seconds: float) -> str:
    """Return a time [s] for people: "12 ms", "3.4 s", "5.0 min"."""
    if seconds < 1:
        return f"{1000 * seconds:.0f} ms"
    return f"{seconds:.1f} s" if seconds < 120 else f"{seconds / 60:.1f} min"


@dataclass(frozen=True)
class Unit:
    """The unit a quantity is written in.

    name : as in the study, e.g. "cm"; "" for a pure number
    factor : one such unit in SI [SI unit of the quantity]
    si : SI unit of the quantity; "1" or "" for a pure number
    """

    name: str = ""
    factor: float = 1.0
    si: str = ""

    def number(self, value: float) -> float:
        """An SI value in this unit, without the last digits that the conversion leaves behind (0.7, not 0.6999...)."""
        return float(f"{value / self.factor:.12g}")

    def text(self, value: Any, digits: int = 6) -> str:
        """Return an SI value as a study would write it: "0.7 g"; texts are returned as they are."""
        if isinstance(value, str):
            return value
        rounded = float(f"{self.number(float(value)):.{digits}g}")
        return f"{rounded:.10g} {self.name}".rstrip()  # 20240, not 2.024e+04

    def label(self, key: str) -> str:
        """A key with its unit for headings and axis titles: "cases.gap.gap [cm]"."""
        return f"{key} [{self.name}]" if self.name else key

"""Shares that a study writes in per cent: percentiles, probabilities, confidences."""

from __future__ import annotations

import re
from typing import Any

from pounding_cli.study.units import NUMBER, TextForm, refuse

_PERCENT = re.compile(rf"\s*({NUMBER})\s*%\s*\Z")


def percent(what: str, example: str) -> TextForm:
    """A share above 0 % and below 100 %, written with its %; read as a number from 0 to 1."""

    def read(value: Any) -> float:
        hint = f"write a {what} above 0 % and below 100 %, e.g. {example}"
        if isinstance(value, bool | list | dict) or value is None:
            raise refuse(f"this is not a {what}", hint)
        found = _PERCENT.match(value) if isinstance(value, str) and len(value) < 60 else None
        if found is None:
            said = str(value).strip()[:60]
            raise refuse(f"'{said}' is not a {what}: it lacks its %", hint)
        share = float(found[1]) / 100
        if not 0 < share < 1:
            raise refuse(f"the {what} is {value.strip()}; it must be above 0 % and below 100 %", hint)
        return share

    return TextForm(read, f"{what} in %", (example,))


CONFIDENCE = percent("confidence", "90 %")

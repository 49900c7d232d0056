"""Places in a results file named on the command line: points of the sweep as KEY=VALUE."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.errors import InputError, Problem

if TYPE_CHECKING:
    from pounding_cli.numbers import Unit
    from pounding_cli.results.results import Results

at_option = click.option(
    "--at", multiple=True, metavar="KEY=VALUE", help="Value of a swept key; may be given more than once."
)


def key_and_value(text: str, option: str = "--at") -> tuple[str, str]:
    """The two sides of KEY=VALUE.

    Raises
    ------
    InputError : no value
    """
    key, _, value = text.partition("=")
    if not (key.strip() and value.strip()):
        raise InputError(Problem(f"{option} {text}: no value", f"write e.g. {option} 'cases.gap.gap=5 cm'"))
    return key.strip(), value.strip()


def points_at(results: Results, texts: Sequence[str]) -> dict[str, Any]:
    """Swept keys with the values meant, as they stand in the tables.

    texts : KEY=VALUE; the last words of a key do where they are clear, a value is written as in a study

    Raises
    ------
    InputError : a key that is not swept, a value that it does not take
    """
    found, problems = {}, []
    for text in texts:
        given, value = key_and_value(text)
        keys = [key for key in results.axes if key == given] or [k for k in results.axes if k.endswith(f".{given}")]
        if len(keys) != 1:
            swept = ", ".join(keys or results.axes)
            hint = f"write one of: {swept}" if swept else "nothing is swept in this file; leave --at out"
            problems.append(Problem(f"--at {text}: {given} is {'more than one' if keys else 'no'} swept key", hint))
            continue
        (key,) = keys
        unit = results.units[key]
        values = meant(results.axes[key], value, unit)
        if not values:
            there = ", ".join(unit.text(each) for each in results.axes[key])
            problems.append(Problem(f"--at {text}: {key} does not take this value", f"write one of: {there}"))
            continue
        found[key] = values[0]
    if problems:
        raise InputError(problems)
    return found


def meant(values: Iterable[Any], text: str, unit: Unit) -> list[Any]:
    """Those of the values that a text means; a number may be with its unit, in SI or in the unit of the study."""
    numbers = _numbers(text, unit)
    return [value for value in values if str(value) == text or _is_one_of(value, numbers)]


def _is_one_of(value: Any, numbers: list[float]) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return any(math.isclose(value, number, rel_tol=1e-6, abs_tol=1e-12) for number in numbers)


def _numbers(text: str, unit: Unit) -> list[float]:
    from pydantic_core import PydanticCustomError

    from pounding_cli.study.quantity import Quantity

    try:
        number = float(Quantity("value", unit.si, "").read(text))
    except PydanticCustomError:
        return []
    try:
        return [number, float(text) * unit.factor]
    except ValueError:
        return [number]

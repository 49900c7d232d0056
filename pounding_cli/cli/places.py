"""Places in a results file named on the command line: points of the sweep as KEY=VALUE."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.errors import InputError, Problem

if TYPE_CHECKING:
    from pounding_cli.numbers import Unit
    from pounding_cli.store import Results

at_option = click.option(
    "--at", multiple=True, metavar="KEY=VALUE", help="Value of a swept key; may be given more than once."
)


def key_and_value(text: str) -> tuple[str, str]:
    """The two sides of KEY=VALUE.

    Raises
    ------
    InputError : no value
    """
    key, _, value = text.partition("=")
    if not (key.strip() and value.strip()):
        raise InputError(Problem(f"--at {text}: no value", "write e.g. --at 'cases.gap.gap=5 cm'"))
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
        meant = next((each for each in results.axes[key] if _is(each, value, unit)), None)
        if meant is None:
            there = ", ".join(unit.text(each) for each in results.axes[key])
            problems.append(Problem(f"--at {text}: {key} does not take this value", f"write one of: {there}"))
            continue
        found[key] = meant
    if problems:
        raise InputError(problems)
    return found


def _is(value: Any, text: str, unit: Unit) -> bool:
    """Whether a text means a value of an axis; a bare number may be in SI or in the unit of the study."""
    if isinstance(value, str):
        return value == text
    return any(math.isclose(value, number, rel_tol=1e-6, abs_tol=1e-12) for number in _numbers(text, unit))


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

"""Arguments and options that several commands take, and a time as they print it."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from pathlib import Path
from typing import Any

import click

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

FILE = click.Path(path_type=Path)

study_argument: Decorator = click.argument("study", type=FILE)
quiet_option: Decorator = click.option("-q", "--quiet", is_flag=True, help="Print only what failed.")


def together(*options: Decorator) -> Decorator:
    """Several options as one decorator, in the order of the help."""
    return lambda command: reduce(lambda found, option: option(found), reversed(options), command)


def output_option(default: str, text: str = "Results file.") -> Decorator:
    """`-o FILE.h5`."""
    return click.option("-o", "--output", type=FILE, metavar="FILE.h5", help=f"{text} Default: {default}.")


def seconds(text: str) -> float:
    """A time as a study writes it, in s: the type of an option."""
    from pydantic_core import PydanticCustomError

    from pounding_cli.study.quantity import TIME

    try:
        return float(TIME.read(text))
    except PydanticCustomError as refused:
        said = refused.context or {}
        raise click.BadParameter(f"{said.get('message', refused)}; {said.get('hint', '')}") from None

"""What every part of the study's schema is made of: the base of its mappings, optional keys, names, lists of values."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Discriminator, Field, StringConstraints

from pounding_cli.study.units import Quantity

Name = Annotated[str, StringConstraints(pattern=r"^\w[\w +-]*$", max_length=60, strip_whitespace=True)]

DampingShare = Annotated[float, Quantity("damping ratio", "", "5 %", 0.0, 1.0, open_high=True)]
EACH_STOREY = Field(min_length=1, max_length=100)
"""Of a list with a value for every storey, or for every floor."""


def list_or_one(value: Any) -> str:
    """Whether a list is given or one value: for the discriminator of a union of both."""
    return "list" if isinstance(value, list | tuple) else "one"


EITHER = Discriminator(list_or_one)


def word_or_mapping(value: Any) -> str:
    """Which of two forms a value has: for the discriminator of a union of both."""
    return "word" if isinstance(value, str | int | float) or value is None else "mapping"


def optional(default: Any, description: str, **more: Any) -> Any:
    """A key that need not be given."""
    return Field(default=default, description=description, **more)


class Model(BaseModel):
    """Base of every mapping in the file: unknown keys are refused, values are frozen."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        coerce_numbers_to_str=True,
        validate_default=True,
        defer_build=True,  # validators are built for whole studies, when one is read, not for each of their mappings
    )

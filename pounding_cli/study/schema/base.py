"""Building blocks of the schema: the base of its mappings, keys, lists or single values, checks of whole mappings."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Iterator
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    StringConstraints,
    Tag,
    ValidationError,
    model_validator,
)
from pydantic_core import InitErrorDetails

from pounding_cli.errors import Issue
from pounding_cli.study.schema.quantity import refuse

Name = Annotated[str, StringConstraints(pattern=r"^\w[\w +-]*$", max_length=60, strip_whitespace=True)]
"""A name that dotted keys lead through, as `cases.near.gap`; so it has no dot."""

LabelText = Annotated[str, StringConstraints(pattern=r"^\w[\w +.-]*$", max_length=60, strip_whitespace=True)]
"""A name that no dotted key leads through."""


def spec_field(default: Any, description: str, example: Any = None, **more: Any) -> Any:
    """Return a key of the file; `...` as its default where it must be given."""
    return Field(default=default, description=description, examples=None if example is None else [example], **more)


def tagged_union(pick: Callable[[Any], str], **kinds: Any) -> Any:
    """Return the type of one of several kinds of values, which `pick` tells apart by name."""
    parts = [Annotated[kind, Tag(f"({name})")] for name, kind in kinds.items()]
    union = functools.reduce(operator.or_, parts)
    return Annotated[union, Discriminator(lambda value: f"({pick(value)})")]


def one_or_many(one: Any, least: int = 1, most: int = 100, as_list: bool = False) -> Any:
    """Return the type of a value or a list of them.

    least, most : length of the list
    as_list : what is read is a tuple in any case
    """
    many = Annotated[tuple[one, ...], Field(min_length=least, max_length=most)]
    return list_or(many, Annotated[one, AfterValidator(lambda value: (value,))] if as_list else one)


def list_or(many: Any, one: Any) -> Any:
    """Return the type of a list, or of something else."""
    return tagged_union(lambda value: "list" if isinstance(value, list | tuple) else "one", list=many, one=one)


def word_or(word: Any, mapping: Any) -> Any:
    """Return the type of a word, or of a mapping."""
    is_word = str | int | float | None
    return tagged_union(lambda v: "word" if isinstance(v, is_word) else "mapping", word=word, mapping=mapping)


def mapping_schema(*required: str, **properties: Any) -> dict[str, Any]:
    """Return the JSON Schema of a mapping with these keys."""
    return {"type": "object", "properties": properties, "required": [*required], "additionalProperties": False}


class Model(BaseModel):
    """Base of every mapping in the file."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, coerce_numbers_to_str=True, validate_default=True, defer_build=True
    )

    def issues(self) -> Iterator[Issue]:
        """Yield what is wrong with the mapping as a whole; paths are those below it."""
        yield from ()

    @model_validator(mode="after")
    def _check(self) -> Any:
        issues = list(self.issues())
        if issues:
            raise errors(self, issues)
        return self


def errors(owner: Any, issues: list[Issue]) -> ValidationError:
    """Return issues with their places inside a mapping, as pydantic collects them."""
    details = [
        InitErrorDetails(type=refuse(each.message, each.hint, each.at_key, whole=True), loc=each.path, input=None)
        for each in issues
    ]
    return ValidationError.from_exception_data(type(owner).__name__, details)

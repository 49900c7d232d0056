"""Buildings that are only seen, as a study writes them: `archetype:` of a building."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from pounding_cli.errors import Issue
from pounding_cli.model.archetypes import DESIGNS, find_archetype, list_designs, list_types
from pounding_cli.study.schema.base import Model, spec_field
from pounding_cli.study.schema.quantity import WholeNumber, quote, refuse
from pounding_cli.study.text.file import nearest

DEFAULT_NEIGHBOURS = 30
"""Buildings that a neighbour may be, unless a study says how many."""

MAX_NEIGHBOURS = 1000


def _check_type(value: Any) -> Any:
    """Return a type of HAZUS.  Raises PydanticCustomError: there is no such type."""
    name = value.strip().upper() if isinstance(value, str) else value
    if name in list_types():
        return name
    raise refuse(f"{quote(value)} is not a building type of HAZUS", nearest(name, list_types()))


class ArchetypeSpec(Model):
    """A building of which no more is known than its type, age and storeys: a model building type of HAZUS."""

    type: Annotated[Literal[list_types()], BeforeValidator(_check_type)] = spec_field(  # type: ignore[valid-type]
        ..., "building type of HAZUS: system, material and height", "C1M"
    )
    design: Literal[DESIGNS] = spec_field(  # type: ignore[valid-type]
        ..., "design level: the code that the building was designed to, or none", "pre-code"
    )
    storeys: Annotated[int, WholeNumber(1, 100)] = spec_field(..., "number of storeys", 5)
    uncertain: bool = spec_field(
        True,
        "whether period, strength, damping and drift capacity are uncertain: `pound gap` and `pound fragility` answer "
        "over the buildings that it may be, and `pound sensitivity` varies them; `false`: the median building alone",
        False,
    )
    neighbours: Annotated[int, WholeNumber(2, MAX_NEIGHBOURS)] = spec_field(
        DEFAULT_NEIGHBOURS, "number of the buildings that it may be, which `pound gap` and `pound fragility` draw"
    )
    sample: Annotated[int, WholeNumber(0, MAX_NEIGHBOURS)] = spec_field(
        0, "one of these buildings by its number; 0: the median building, which `pound run` has"
    )

    def issues(self) -> Iterator[Issue]:
        designs = list_designs(self.type)
        if self.design not in designs:
            message = f"HAZUS has no {self.design} design of {self.type}"
            yield Issue(("design",), message, f"write {' or '.join(designs)}")
            return
        if self.sample > self.neighbours:
            message = f"'sample' is {self.sample}, but only {self.neighbours} buildings are drawn"
            yield Issue(("sample",), message, f"write 0 to {self.neighbours}, or a larger number of `neighbours`")

    def find(self) -> Any:
        """Return the building type at its design level (`model.archetypes.Archetype`)."""
        return find_archetype(self.type, self.design)

"""The section `optimise:` of a study: which number is to be least or most, over which keys."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import WithJsonSchema

from pounding_cli.study.base import Model, optional
from pounding_cli.study.sensitivity_keys import EXPRESSION, SEED
from pounding_cli.study.units import whole_number

_END = {"type": ["number", "string"]}
_OVER_FORM = {
    "type": "object",
    "additionalProperties": {
        "anyOf": [
            {
                "type": "object",
                "properties": {"from": _END, "to": _END, "spacing": {"enum": ["linear", "log"]}},
                "required": ["from", "to"],
                "additionalProperties": False,
            },
            {
                "type": "object",
                "properties": {"choice": {"type": "array", "minItems": 2}},
                "required": ["choice"],
                "additionalProperties": False,
            },
        ]
    },
    "title": "Over",
    "examples": [{"cases.near.gap": {"from": "1 cm", "to": "10 cm"}, "cases.near.floors": {"choice": [[5], [3, 5]]}}],
}


class OptimiseSpec(Model):
    """What `pound optimise` is asked."""

    least: Annotated[str, EXPRESSION] | None = optional(
        None,
        description="number that is to be as small as possible: a column of the tables, `largest`, `smallest` or "
        "`mean` over its storeys (`largest` unless written), `in BUILDING`, `storey N`; arithmetic, `max`, `min`",
    )
    most: Annotated[str, EXPRESSION] | None = optional(
        None, description="number that is to be as large as possible, in place of `least`"
    )
    over: Annotated[Any, WithJsonSchema(_OVER_FORM)] = optional(
        None,
        description="dotted keys with the range of each, `{from: 1 cm, to: 5 cm}` (`spacing: log` for stiffnesses), or "
        "with the values to choose from, `{choice: [[5], [3, 5]]}`",
    )
    case: str | None = optional(None, description="case that is looked at; needed where the study has several")
    analysis: Literal["elastic", "inelastic"] | None = optional(
        None, description="analysis that is looked at; needed where the study has both"
    )
    over_motions: Literal["mean", "largest"] = optional(
        "mean", description="what is taken of the motions, storey by storey"
    )
    over_sweep: Literal["worst", "mean"] = optional(
        "worst",
        description="what is taken of the points of a `sweep:` beside; `worst`: the largest where the least is sought, "
        "the smallest where the most is",
    )
    generations: Annotated[int, whole_number(1, 10_000)] = optional(
        100, description="generations of the search at most; it ends where all points of one are nearly as good"
    )
    population: Annotated[int, whole_number(5, 10_000)] | None = optional(
        None, description="points of a generation; 12 for each key unless given, 20 at least"
    )
    slice_points: Annotated[int, whole_number(5, 1001)] = optional(
        21, description="points along each key through the optimum"
    )
    map_points: Annotated[int, whole_number(5, 201)] = optional(
        15, description="points along each of the two keys of the map"
    )
    seed: SEED = optional(1, description="seed of the search")

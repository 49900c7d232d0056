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
        description="number to minimise: a column of the tables, `largest`, `smallest` or "
        "`mean` over its storeys (default: `largest`), `in BUILDING`, `storey N`; arithmetic, `max`, `min`",
    )
    most: Annotated[str, EXPRESSION] | None = optional(None, description="number to maximise, instead of `least`")
    over: Annotated[Any, WithJsonSchema(_OVER_FORM)] = optional(
        None,
        description="dotted keys with the range of each, `{from: 1 cm, to: 5 cm}` (`spacing: log` for stiffnesses), or "
        "with the values to choose from, `{choice: [[5], [3, 5]]}`",
    )
    case: str | None = optional(None, description="case to optimise; required if the study has several")
    analysis: Literal["elastic", "inelastic"] | None = optional(
        None, description="analysis to optimise; required if the study has both"
    )
    over_motions: Literal["mean", "largest"] = optional("mean", description="value over the motions, storey by storey")
    over_sweep: Literal["worst", "mean"] = optional(
        "worst",
        description="value over the points of a `sweep:`; `worst`: the largest for `least`, the smallest for `most`",
    )
    generations: Annotated[int, whole_number(1, 10_000)] = optional(
        100, description="largest number of generations; the search ends when all points of one are nearly as good"
    )
    population: Annotated[int, whole_number(5, 10_000)] | None = optional(
        None, description="points of a generation; default: 12 for each key, at least 20"
    )
    slice_points: Annotated[int, whole_number(5, 1001)] = optional(
        21, description="points along each key through the optimum"
    )
    map_points: Annotated[int, whole_number(5, 201)] = optional(
        15, description="points along each of the two keys of the map"
    )
    seed: SEED = optional(1, description="seed of the search")

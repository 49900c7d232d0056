"""The section `optimise:` of a study."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import WithJsonSchema

from pounding_cli.errors import Issue
from pounding_cli.questions.specs import EXPRESSION, EXPRESSION_COLUMNS, SEED, STATEMENT
from pounding_cli.study.schema.base import Model, mapping_schema, one_or_many, spec_field
from pounding_cli.study.schema.quantity import WholeNumber

_END = {"type": ["number", "string"]}
_SEARCHED = mapping_schema("from", "to", **{"from": _END, "to": _END}, spacing={"enum": ["linear", "log"]})
_CHOSEN = mapping_schema("choice", choice={"type": "array", "minItems": 2})
_OVER_FORM = {
    "type": "object",
    "additionalProperties": {"anyOf": [_SEARCHED, _CHOSEN]},
    "title": "Over",
    "examples": [{"cases.near.gap": {"from": "1 cm", "to": "10 cm"}, "cases.near.floors": {"choice": [[5], [3, 5]]}}],
}


class OptimiseSpec(Model):
    """Settings of `pound optimise`."""

    least: EXPRESSION | None = spec_field(None, f"number to minimise: {EXPRESSION_COLUMNS}")
    most: EXPRESSION | None = spec_field(None, "number to maximise, instead of `least`")
    over: Annotated[Any, WithJsonSchema(_OVER_FORM)] = spec_field(
        None,
        "dotted keys with the range of each, `{from: 1 cm, to: 5 cm}` (`spacing: log` for stiffnesses), or "
        "with the values to choose from, `{choice: [[5], [3, 5]]}`",
    )
    require: one_or_many(STATEMENT, 0, 50, True) = spec_field(  # type: ignore[valid-type]
        (),
        "statements that must hold under every motion, one or a list; shear_demand is that of loaded columns over "
        "their strength",
        ["shear_demand < 1", "drift in soft < 2 cm"],
    )
    case: str | None = spec_field(None, "case to optimise; required if the study has several")
    analysis: Literal["elastic", "inelastic"] | None = spec_field(
        None, "analysis to optimise; required if the study has both"
    )
    over_motions: Literal["mean", "largest"] = spec_field("mean", "value over the motions, storey by storey")
    over_sweep: Literal["worst", "mean"] = spec_field(
        "worst", "value over the points of a `sweep:`; `worst`: the largest for `least`, the smallest for `most`"
    )
    generations: Annotated[int, WholeNumber(1, 10_000)] = spec_field(
        100, "largest number of generations; the search ends when all points of one are nearly as good"
    )
    population: Annotated[int, WholeNumber(5, 10_000)] | None = spec_field(
        None, "points of a generation; default: 12 for each key, at least 20"
    )
    slice_points: Annotated[int, WholeNumber(5, 1001)] = spec_field(21, "points along each key through the optimum")
    seed: SEED = spec_field(1, "seed of the search")

    def issues(self) -> Iterator[Issue]:
        if self.least is not None and self.most is not None:
            yield Issue(
                ("most",), "'least' and 'most' both stand here: give one of them", "remove one of the two", at_key=True
            )
        points = self.generations * (self.population or 0)
        if points > 200_000:
            message = f"generations and population make {points} points"
            yield Issue(("generations",), message, "keep it to 200000: write fewer")

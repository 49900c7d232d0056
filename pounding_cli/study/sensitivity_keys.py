"""The section `sensitivity:` of a study: which numbers are looked at, with how many samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag

from pounding_cli.study.base import Model, optional
from pounding_cli.study.shares import CONFIDENCE
from pounding_cli.study.units import TextForm, refuse, whole_number

SEED = Annotated[int, whole_number(1, 2**31 - 1)]


def _read_text(value: Any) -> str:
    if not isinstance(value, str):
        raise refuse("this is not an expression", "write e.g. `largest mu in soft`")
    return value


EXPRESSION = TextForm(_read_text, "expression over the tables", ("mu", "largest V_ratio in stiff", "max(mu, mu0)"))
_EITHER = Discriminator(lambda value: "list" if isinstance(value, list | tuple) else "one")
_Several = Annotated[tuple[Annotated[str, EXPRESSION], ...], Field(max_length=50), Tag("list")]
_Only = Annotated[Annotated[str, EXPRESSION], AfterValidator(lambda text: (text,)), Tag("one")]
if TYPE_CHECKING:
    Outputs = tuple[str, ...]
else:
    Outputs = Annotated[_Several | _Only, _EITHER]


class SensitivitySpec(Model):
    """What `pound sensitivity` is asked."""

    outputs: Outputs = optional(
        (),
        description="numbers that are looked at, one or a list: a column of the tables, `largest`, `smallest` or "
        "`mean` over its storeys (`largest` unless written), `in BUILDING`, `storey N`; arithmetic, `max`, `min`",
    )
    method: Literal["sobol", "morris"] = optional(
        "sobol",
        description="`sobol`: shares of the variance, and the distribution of each output; `morris`: a cheap screening "
        "by elementary effects",
    )
    samples: Annotated[int, whole_number(4, 2**17)] | None = optional(
        None,
        description="base samples; `sobol` takes (keys + 2) points for each, a power of 2, 256 unless given; `morris` "
        "(keys + 1), 32 unless given",
    )
    confidence: Annotated[float, CONFIDENCE] = optional("95 %", description="confidence of all intervals")
    draws: Annotated[int, whole_number(100, 100_000)] = optional(1000, description="draws of the bootstrap")
    over_motions: Literal["mean", "largest"] = optional(
        "mean", description="what is taken of the motions, storey by storey, unless the motion is a key that varies"
    )
    seed: SEED = optional(1, description="seed of samples and draws")

"""The section `sensitivity:` of a study: which numbers are looked at, with how many samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, Tag

from pounding_cli.study.base import EITHER, Model, optional
from pounding_cli.study.claim_names import CLAIMS
from pounding_cli.study.problems import nearest
from pounding_cli.study.shares import CONFIDENCE
from pounding_cli.study.units import TextForm, refuse, whole_number

ALL = "all"
"""Every claim about the figure of the study."""

SEED = Annotated[int, whole_number(1, 2**31 - 1)]


def _read_text(value: Any) -> str:
    if not isinstance(value, str):
        raise refuse("this is not an expression", "write e.g. `largest mu in soft`")
    return value


EXPRESSION = TextForm(_read_text, "expression over the tables", ("mu", "largest V_ratio in stiff", "max(mu, mu0)"))
_Several = Annotated[tuple[Annotated[str, EXPRESSION], ...], Field(max_length=50), Tag("list")]
_Only = Annotated[Annotated[str, EXPRESSION], AfterValidator(lambda text: (text,)), Tag("one")]
if TYPE_CHECKING:
    Outputs = tuple[str, ...]
else:
    Outputs = Annotated[_Several | _Only, EITHER]


def _read_claim(value: Any) -> str:
    if value not in (ALL, *CLAIMS):
        shown = f"'{value[:60]}'" if isinstance(value, str) else "this"
        raise refuse(f"{shown} is not a claim", nearest(str(value), (ALL, *CLAIMS)))
    return str(value)


_CLAIM = TextForm(_read_claim, "name of a claim, or `all`", ("all", "infill-response"))
_Claims = Annotated[tuple[Annotated[str, _CLAIM], ...], Field(max_length=50), Tag("list")]
_OneClaim = Annotated[Annotated[str, _CLAIM], AfterValidator(lambda text: (text,)), Tag("one")]
if TYPE_CHECKING:
    ClaimNames = tuple[str, ...]
else:
    ClaimNames = Annotated[_Claims | _OneClaim, EITHER]


class SensitivitySpec(Model):
    """What `pound sensitivity` is asked."""

    outputs: Outputs = optional(
        (),
        description="outputs, one or a list: a column of the tables, `largest`, `smallest` or "
        "`mean` over its storeys (default: `largest`), `in BUILDING`, `storey N`; arithmetic, `max`, `min`",
    )
    claims: ClaimNames = optional(
        (),
        description="statements of the paper whose probability is computed, one or a list, or `all` about the figure "
        "that `claims:` of the study names",
    )
    method: Literal["sobol", "morris"] = optional(
        "sobol",
        description="`sobol`: shares of the variance, and the distribution of each output; `morris`: a cheap screening "
        "by elementary effects",
    )
    samples: Annotated[int, whole_number(4, 2**17)] | None = optional(
        None,
        description="base samples; `sobol` takes (keys + 2) points for each, a power of 2, default: 256; `morris` "
        "(keys + 1), default: 32",
    )
    confidence: Annotated[float, CONFIDENCE] = optional("95 %", description="confidence of all intervals")
    draws: Annotated[int, whole_number(100, 100_000)] = optional(1000, description="draws of the bootstrap")
    over_motions: Literal["mean", "largest"] = optional(
        "mean", description="value over the motions, storey by storey, unless each sample has one motion"
    )
    seed: SEED = optional(1, description="seed of samples and draws")

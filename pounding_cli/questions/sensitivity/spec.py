"""The section `sensitivity:` of a study."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pounding_cli.errors import Issue
from pounding_cli.questions.specs import CONFIDENCE_QUANTITY, EXPRESSION, EXPRESSION_COLUMNS, SEED, STATEMENT
from pounding_cli.study.schema.base import Model, one_or_many, spec_field
from pounding_cli.study.schema.quantity import WholeNumber


class SensitivitySpec(Model):
    """Settings of `pound sensitivity`."""

    outputs: one_or_many(EXPRESSION, 0, 50, True) = spec_field(  # type: ignore[valid-type]
        (), f"outputs, one or a list: {EXPRESSION_COLUMNS}"
    )
    probabilities: one_or_many(STATEMENT, 0, 50, True) = spec_field(  # type: ignore[valid-type]
        (),
        "statements whose probability is computed, one or a list: an output above (`>`) or below (`<`) a value, e.g. "
        "`largest mu in soft > 4`, `drift > 2 cm`, `impacts > 0`",
    )
    statements: Literal["all"] | None = spec_field(
        None, "`all`: also the probability that each of the study's `statements` holds"
    )
    method: Literal["sobol", "morris"] = spec_field(
        "sobol",
        "`sobol`: shares of the variance, and the distribution of each output; `morris`: a cheap screening "
        "by elementary effects",
    )
    samples: Annotated[int, WholeNumber(4, 2**17)] | None = spec_field(
        None,
        "base samples; `sobol` takes (keys + 2) points for each, a power of 2, default: 256; `morris` "
        "(keys + 1), default: 32",
    )
    confidence: Annotated[float, CONFIDENCE_QUANTITY] = spec_field("95 %", "confidence of all intervals")
    draws: Annotated[int, WholeNumber(100, 100_000)] = spec_field(1000, "draws of the bootstrap")
    over_motions: Literal["mean", "largest"] = spec_field(
        "mean", "value over the motions, storey by storey, unless each sample has one motion"
    )
    seed: SEED = spec_field(1, "seed of samples and draws")

    def issues(self) -> Iterator[Issue]:
        if self.method == "sobol" and self.samples is not None and self.samples & (self.samples - 1):
            low = 1 << (self.samples.bit_length() - 1)
            message = f"{self.samples} samples: Sobol's sequence is even only at powers of 2"
            yield Issue(("samples",), message, f"write {low} or {2 * low}")

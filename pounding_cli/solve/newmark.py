"""Newmark's average acceleration with Newton iterations: generalized-alpha without either alpha."""

from __future__ import annotations

import functools

from pounding_cli.solve.generalized_alpha import STABILITY, family, march, without_root
from pounding_cli.solve.method import Method

NEWMARK = Method(
    "newmark",
    "Newmark",
    2,
    "time step",
    STABILITY,
    "Newmark, N. M. (1959). A method of computation for structural dynamics. J. Eng. Mech. Div. ASCE 85(3).",
    functools.partial(march, family(0.0, 0.0)),
    note=without_root,
)

"""A spring and a dashpot that act at all times: connectors, dampers, storeys that cannot yield, foundation springs."""

from __future__ import annotations

import math
from typing import Any

from pounding_cli.laws.law import Behaviour, line

K, C = range(2)
"""Parameters: spring [N/m] and dashpot [N s/m]."""


def next_branch(e: Any, guard: int) -> None:
    """One branch without end."""
    line(e, e.p[K], e.p[C], 0.0, -math.inf, math.inf)


JOINED = Behaviour(next_branch)

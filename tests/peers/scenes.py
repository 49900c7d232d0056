"""Two buildings of three storeys, as the peers march them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tests.adapter import Scene
from tests.physics.cases import shake

IMPACT = {"impact": {"stiffness": 2e10, "restitution": 0.5}}


def building(period: float, storeys: int = 3, **keys: Any) -> dict[str, Any]:
    """Floors of 200 t, strengths by the code."""
    return {"storeys": storeys, "period": period, **keys}


def pair(case: Mapping[str, Any], analysis: str = "elastic", duration: float = 2.0, peak: float = 4.0) -> Scene:
    """The 0.36 s and 0.60 s buildings under noise."""
    return Scene([building(0.36), building(0.60)], shake(duration, peak), 0.02, case, analysis, IMPACT)

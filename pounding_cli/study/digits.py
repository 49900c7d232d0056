"""What `accuracy: auto` asks for: every digit that costs next to nothing."""

from __future__ import annotations

COSTS = {1e-3: 1.0, 1e-4: 1.10, 1e-5: 1.23, 1e-6: 1.36, 1e-7: 1.49, 1e-8: 1.61, 1e-9: 1.73, 1e-10: 1.85, 1e-12: 2.10}
"""Taylor orders computed at an accuracy over those at 1e-3, below which nothing is saved: all linked scenes of Figs 6
and 7 that are not linear."""

WORTH = 1.4
"""Digits are taken as long as the run costs no more than this times the cheapest."""


def cheap_accuracy() -> float:
    """The finest accuracy [-] that costs next to nothing more than the coarsest."""
    return min(accuracy for accuracy, cost in COSTS.items() if cost <= WORTH)

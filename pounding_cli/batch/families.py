"""The order in which scenes are solved, and of what sorts they are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pounding_cli.study import Plan

Sort = tuple[str, str]
"""Case ("" for a building alone) and analysis: scenes of one sort run the same code and cost about the same."""


@dataclass
class Order:
    """What is to be solved.

    digests : family by family in the order of the rows; a family is the scenes that share all their baselines, the
        baselines first, since the others can often be answered from them
    counts : scenes of every sort
    samples : the first two scenes of every sort, one to compile for and one to time
    """

    digests: list[str] = field(default_factory=list)
    counts: Counter[Sort] = field(default_factory=Counter)
    samples: dict[Sort, list[str]] = field(default_factory=dict)

    def put(self, digest: str, sort: Sort) -> None:
        """Count a scene."""
        self.counts[sort] += 1
        some = self.samples.setdefault(sort, [])
        if len(some) < 2:
            some.append(digest)


def order_of(plan: Plan, solved: Container[str]) -> Order:
    """The scenes of a plan that are not solved yet; rows may name others, which a later round may ask for."""
    order = Order()
    families: dict[tuple[str, ...], list[str]] = {}
    seen: set[str] = set()
    for row in plan.rows:
        sorts = [*((digest, "") for digest in row.baselines), (row.scene, row.case)]
        for digest, case in sorts:
            if digest not in seen and digest not in solved and digest in plan.scenes:
                seen.add(digest)
                families.setdefault(row.baselines, []).append(digest)  # of a search most rows ask for nothing
                order.put(digest, (case, row.analysis))
    order.digests = [digest for family in families.values() for digest in family]
    return order

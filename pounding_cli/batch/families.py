"""The order in which scenes are solved, and of what sorts they are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.study.scenes import DigestList, Scenes, first_of

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
    rest : the digests without the samples
    """

    digests: Sequence[str] = ()
    counts: Counter[Sort] = field(default_factory=Counter)
    samples: dict[Sort, list[str]] = field(default_factory=dict)
    rest: Sequence[str] = ()


def order_of(plan: Plan, solved: Callable[[Sequence[str]], np.ndarray]) -> Order:
    """The scenes of a plan that are not solved yet; rows may name others, which a later round may ask for.

    solved : of digests, whether each is, shape (digests,)
    """
    rows, table = plan.rows, plan.rows.table
    cases, analyses, records = rows.frame.shape[-3:]
    left = np.ones(len(table), bool)
    if not (isinstance(plan.scenes, Scenes) and plan.scenes.table is table):
        left[:] = False
        wanted = table.numbers(list(plan.scenes))
        left[wanted[wanted >= 0]] = True
    asked = np.flatnonzero(left)
    left[asked] = ~solved(DigestList(table.digests, asked))
    each = rows.scenes.shape[1]
    flat = np.roll(rows.scenes, -1, axis=1).ravel()  # the buildings alone before the scene of the row
    numbers, first = first_of(flat, np.append(left, False)[flat], len(table))
    row, which = np.divmod(first, each)
    case, analysis = row // (analyses * records) % cases, row // records % analyses
    sorts = np.where(which == each - 1, case, cases) * analyses + analysis
    names = [(name, kind) for name in (*rows.frame.cases, "") for kind in rows.frame.analyses]
    order = Order(DigestList(table.digests, numbers[np.argsort(_families(rows.scenes[row, 1:]), kind="stable")]))
    found, begins, counts = np.unique(sorts, return_index=True, return_counts=True)
    for number in np.argsort(begins).tolist():
        sort = names[found[number]]
        some = numbers[np.flatnonzero(sorts == found[number])[:2]]
        order.counts[sort] = int(counts[number])
        order.samples[sort] = list(DigestList(table.digests, some))
        left[some] = False
    assert isinstance(order.digests, DigestList)
    order.rest = DigestList(table.digests, order.digests.numbers[left[order.digests.numbers]])
    return order


def _families(baselines: np.ndarray) -> np.ndarray:
    """Of every line its number among the different ones, in the order in which these come first."""
    code = np.zeros(len(baselines), np.int64)
    for column in baselines.T:
        code = np.unique(code * (int(column.max(initial=0)) + 2) + column + 1, return_inverse=True)[1]
    _, begins, code = np.unique(code, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(begins))[code]

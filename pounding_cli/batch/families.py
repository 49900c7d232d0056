"""The order in which scenes are solved, and of what sorts they are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.digests import DigestList, pieces
from pounding_cli.study.scenes import Scenes, first_of

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
    begins : where in `rest` a family begins; none where all are one
    """

    digests: Sequence[str] = ()
    counts: Counter[Sort] = field(default_factory=Counter)
    samples: dict[Sort, list[str]] = field(default_factory=dict)
    rest: Sequence[str] = ()
    begins: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))


def order_of(plan: Plan, solved: Callable[[Sequence[str]], np.ndarray]) -> Order:
    """The scenes of a plan that are not solved yet; rows may name others, which a later round may ask for.

    solved : of digests, whether each is, shape (digests,)
    """
    rows, table = plan.rows, plan.rows.table
    cases, analyses, records = rows.frame.shape[-3:]
    left = np.ones(len(table), bool)
    if not (isinstance(plan.scenes, Scenes) and plan.scenes.table is table):
        left[:] = False
        wanted = np.concatenate([table.numbers(some) for some in pieces(plan.scenes)] or [np.zeros(0, np.int64)])
        left[wanted[wanted >= 0]] = True
    asked = np.flatnonzero(left)
    left[asked] = ~solved(DigestList(table.digests, asked))
    del asked
    numbers, first = first_of(rows.scenes, np.append(left, False), turned=1)  # the scene of a row after the others
    row, which = np.divmod(first, rows.scenes.shape[1])
    case, analysis = (
        (row // (analyses * records) % cases).astype(np.int32),
        (row // records % analyses).astype(np.int32),
    )
    case[which < rows.scenes.shape[1] - 1] = cases
    sorts = case * analyses + analysis
    order = Order()
    for sort in _distinct(sorts):
        name = (*rows.frame.cases, "")[sort // analyses], rows.frame.analyses[sort % analyses]
        mine = sorts == sort
        some = numbers[np.flatnonzero(mine)[:2]]
        order.counts[name] = int(np.count_nonzero(mine))
        order.samples[name] = list(DigestList(table.digests, some))
        left[some] = False
    families = _families(rows.scenes, row)
    if families is not None:
        turn = np.argsort(families, kind="stable")
        numbers, families = numbers[turn], families[turn]
        order.begins = np.flatnonzero(np.diff(families[left[numbers]])) + 1
    order.digests = DigestList(table.digests, numbers)
    order.rest = DigestList(table.digests, numbers[left[numbers]])
    return order


def _distinct(sorts: np.ndarray) -> list[int]:
    """The different ones, in the order in which they come first."""
    found, begins = np.unique(sorts, return_index=True)
    return found[np.argsort(begins)].tolist()


def _families(scenes: np.ndarray, rows: np.ndarray) -> np.ndarray | None:
    """Of some rows the numbers of their baselines, in the order in which these come first; None where all are one."""
    code = np.zeros(len(rows), np.int64)
    for place in range(1, scenes.shape[1]):
        column = scenes[rows, place]
        if len(rows) and (column != column[0]).any():
            code = np.unique(code * (int(column.max()) + 2) + column + 1, return_inverse=True)[1]
    if not code.any():
        return None
    _, begins, code = np.unique(code, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(begins))[code].astype(np.int32)

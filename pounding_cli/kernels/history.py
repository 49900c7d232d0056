"""The state at the output times of a history: what a run enters at the end of its segments."""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import of, of_link_integer, of_storey
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import no_inline, pointer
from pounding_cli.laws.program import MEMORIES

History = namedtuple("History", "segments lengths outputs u v storey_branch storey_memory link_branch link_memory work")
"""segments : number of segments, 0 for a run without a history
lengths, outputs : of each its length [s] and the place of the output time at its end, or -1
u, v, storey_branch, storey_memory, link_branch, link_memory : as in `layout.State`, shape (times, slots or
    links); of storey_memory (times, MEMORIES slots)
work : put in by the ground, taken by dashpots, hysteresis and links so far, shape (times, 4) [J]"""


@njit(**PART)
def history_pointers(a):
    """History of pointers from History of arrays."""
    return History(
        a.segments, pointer(a.lengths), pointer(a.outputs), pointer(a.u), pointer(a.v), pointer(a.storey_branch),
        pointer(a.storey_memory), pointer(a.link_branch), pointer(a.link_memory), pointer(a.work),
    )  # fmt: skip


@njit(**CALLED)
def enter(run, row, history, segment, slots, links):
    """Enter the state at the end of this segment; `links` is their number with padding."""
    no_inline()
    output = history.outputs[segment]
    if output < 0:
        return
    records = run.slots
    work = output * 4
    for slot in range(row.slots):
        i = row.slot_places[slot]
        at = output * slots.size + slot
        history.u[at] = run.W[i - run.padded]
        history.v[at] = run.W[i]
        history.storey_branch[at] = run.storeys[of_storey(run, i, c.STOREY_BRANCH)]
        kept = output * MEMORIES * slots.size + slot
        c.copy_memories(
            slots.memories, records, of(i, c.STOREY_MEMORY), np.int64(8), history.storey_memory, kept, slots.size
        )
        history.work[work] += records[of(i, c.INPUT_ENERGY)]
        history.work[work + 1] += records[of(i, c.DASHPOT_ENERGY)] + records[of(i, c.DRAG_ENERGY)]
        history.work[work + 2] += records[of(i, c.HYSTERESIS_ENERGY)]
    for link in range(row.links):
        e = row.link_places[link]
        history.link_branch[output * links + link] = run.link_integers[of_link_integer(e, c.BRANCH)]
        history.link_memory[output * links + link] = run.links[c.of_link(e, c.MEMORY)]
        history.work[work + 3] += run.links[c.of_link(e, c.WORK)]

"""The scratch of a run of the Taylor integrator: how much it needs, and where in it everything stands."""

from __future__ import annotations

from numba import njit, types

from pounding_cli.kernels.cells import LINK_INTEGERS, STOREY_INTEGERS, record_parts, record_sizes, run_frame
from pounding_cli.kernels.clock import CLOCK_SIZE, TALLY_SIZE
from pounding_cli.kernels.frame import DOUBLES, Frame, filler
from pounding_cli.kernels.islands import NOTE_COUNT, row_frame
from pounding_cli.kernels.layout import PART
from pounding_cli.kernels.ledger import RULE_SIZE
from pounding_cli.kernels.program_frame import room_for_programs
from pounding_cli.kernels.simd import further
from pounding_cli.kernels.tangent import room_for_tangent
from pounding_cli.kernels.terms import room_for_terms

MAX_ORDER = 30
"""No series is longer."""

ROWS = MAX_ORDER + 2
"""Rows of a series, with its order 0 and one beyond the last."""

SETTINGS = Frame(
    "settings",
    dict.fromkeys(
        (
            "inelastic",
            "has_terms",
            "use_islands",
            "watched",
            "booked",
            "carried",
            "max_order",
            "max_steps",
            "max_events",
            "max_events_at_instant",
        ),
        types.int64,
    )
    | {"tolerance": types.float64, "nodes": DOUBLES, "weights": DOUBLES},
)
"""Arguments of `taylor.build` of these names; inelastic, has_terms, use_islands: whether storeys can yield,
there are points or springs (`terms`), islands and collapse (`watched`) are looked for, energies of plain steps are
`booked`, a tangent is `carried` (1 or 0)."""

settings_frame = filler(SETTINGS)

FRAMES = 64
"""Most integers of a frame."""


def memory_needed(
    padded: int,
    links: int,
    links_per_side: int,
    buildings: int,
    registers: int,
    springs: int,
    flowing: bool,
    carried: bool = False,
) -> tuple[int, int]:
    """Doubles and integers of scratch that `integrate` needs; the first of the integers are the tally. `registers`: of
    a force, or a flow, written as operations; 0 where there is none. `flowing`: storeys have a memory that flows.
    `carried`: a tangent is."""
    doubles, integers = record_sizes(padded, links, ROWS)
    rows = ROWS + 1 + 5
    small = 2 * ROWS + CLOCK_SIZE + RULE_SIZE + 64
    saved, link_integers = record_sizes(padded, links, 0)
    tables = 2 * max(links_per_side, 1) * padded + NOTE_COUNT * buildings + 6 * FRAMES
    written, resting = room_for_programs(padded, links, registers, ROWS, flowing) if registers else (0, 0)
    beside = room_for_tangent(padded, links, ROWS) if carried else 0
    return (
        doubles
        + rows * padded
        + links
        + small
        + saved
        + 2 * padded
        + written
        + room_for_terms.py_func(springs, ROWS)
        + beside,
        TALLY_SIZE + integers + link_integers + tables + resting,
    )


@njit(**PART)
def lay_out_scratch(links, row, memory, integers):
    """The scratch of a run as records and rows, whole vectors first; returns (run, row, where three more frames and
    whole numbers go, where doubles go)."""
    padded, padded_links = row.first_slot[row.number], row.first_link[row.number - 1]
    by_slot, by_link, by_term = record_parts(padded, padded_links, ROWS)
    ends = further(memory, (ROWS + 1) * padded)
    records = further(ends, 5 * padded)
    link_records = further(records, by_slot)
    series = further(link_records, by_link)
    link_forces = further(series, by_term)
    clock = further(link_forces, padded_links + 8)
    rule = further(clock, CLOCK_SIZE)
    checkpoint = further(rule, RULE_SIZE)
    reciprocal = further(checkpoint, by_slot + by_link + 2 * padded)
    scratch = further(reciprocal, ROWS)
    link_integers = further(integers, TALLY_SIZE)
    storeys = further(link_integers, LINK_INTEGERS * padded_links)
    left_links = further(storeys, STOREY_INTEGERS * padded)
    right_links = further(left_links, max(row.links_per_side, 1) * padded)
    checkpoint_integers = further(right_links, max(row.links_per_side, 1) * padded)
    notes = further(checkpoint_integers, STOREY_INTEGERS * padded + LINK_INTEGERS * padded_links)
    reciprocal[0] = 0.0
    for k in range(1, ROWS):
        reciprocal[k] = 1.0 / k
    run = run_frame(further(notes, NOTE_COUNT * row.number), (
        0, padded, 0, padded_links, padded, padded_links, row.links_per_side,
        further(memory, padded), ends, records, storeys, link_records, link_integers, links.branches, links.guards,
        links.operations, left_links, right_links, link_forces, series, rule, reciprocal, clock, integers, scratch,
    ))  # fmt: skip
    frames = further(notes, NOTE_COUNT * row.number + FRAMES)
    row_places = row_frame(frames, (
        row.number, row.slots, row.links, row.first_slot, row.first_link, row.slot_places, row.link_places, notes,
        checkpoint, checkpoint_integers,
    ))  # fmt: skip
    return run, row_places, further(frames, FRAMES), further(scratch, ROWS)

"""The scratch of a program step: the series of its links and storeys, and where each stands."""

from __future__ import annotations

from numba import njit, types

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import of_link, of_link_integer
from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler
from pounding_cli.kernels.layout import PART
from pounding_cli.kernels.program import ROOT
from pounding_cli.kernels.simd import further

LARGEST_ROOT = 8
"""Largest b."""

_ROWS_OF = ("T", "B", "powers", "registers", "sizes", "U", "A", "storeys")
PROGRAMS = Frame(
    "programs",
    dict.fromkeys(("rows", "each"), types.int64)
    | {"resting": INTEGERS, "closed": INTEGERS, "numbers": DOUBLES}
    | dict.fromkeys(_ROWS_OF, DOUBLES),
)
"""rows: room for orders; each: doubles of the registers of one link, or of one storey. resting: whether a closed link
presses with less than is resolved (1 or 0). closed: how many links have a force to follow, then these. numbers: below.
By order: T time [s] and B what dt / ds is [s]; powers: of q, one after another. registers: series of each link
(`program`); storeys: likewise of each storey, where a memory flows. sizes: of each link the largest closing and rate so
far, what is rounding is judged by, and what may be left out of its force [N]. By order and place: U displacements [m],
A accelerations relative to the ground [m/s2]."""

fill_programs = filler(PROGRAMS)

SCALE, CHOSEN, B_ROOT, FLOWING = range(4)
"""Places in `numbers`: h; the link whose q the step is taken in, -1 for none; b; how many storeys have a memory that
flows."""

NUMBERS = 8

CLOSINGS, RATES, ALLOWED = range(3)
"""Places in `sizes` of a link."""

SIZES = 3


def room_for_programs(padded: int, linked: int, registers: int, rows: int, flowing: bool) -> tuple[int, int]:
    """Doubles and integers of scratch. `flowing`: whether storeys have a memory that flows."""
    by_order = 2 + LARGEST_ROOT + registers * (linked + (padded if flowing else 0)) + 2 * padded
    return NUMBERS + rows * by_order + SIZES * linked, 2 * linked + 1


@njit(**PART)
def programs_frame(place, run, registers, rows, memory, integers):
    """The frame at `place`, its rows in `memory`."""
    time = further(memory, NUMBERS)
    powers = further(time, 2 * rows)
    written = further(powers, LARGEST_ROOT * rows)
    sizes = further(written, registers * run.padded_links * rows)
    displacements = further(sizes, SIZES * run.padded_links)
    accelerations = further(displacements, rows * run.padded)
    return fill_programs(place, (
        rows, registers * rows, integers, further(integers, run.padded_links), memory, time, further(time, rows),
        powers, written, sizes, displacements, accelerations, further(accelerations, rows * run.padded),
    ))  # fmt: skip


@njit(**PART)
def branch_of(run, e):
    """The branch that link e is on."""
    return run.link_integers[of_link_integer(e, c.BRANCH)]


@njit(**PART)
def is_closed(run, e):
    """Whether link e has a force to follow."""
    return run.links[of_link(e, c.CLOSED)] != 0.0


@njit(**PART)
def flows(run, e):
    """Whether the memory of link e changes with time while its branch holds."""
    return t.branch(run, branch_of(run, e), t.FLOW) != 0.0


@njit(**PART)
def register(p, e, which):
    """The series of a register of link e."""
    return further(p.registers, e * p.each + which * p.rows)


@njit(**PART)
def force_register(run, p, e):
    """The series of the force of link e [N]."""
    b = branch_of(run, e)
    regular = e == int(p.numbers[CHOSEN])
    first, last = (t.FIRST_REGULAR, t.LAST_REGULAR) if regular else (t.FIRST_STEP, t.LAST_STEP)
    return register(p, e, ROOT + int(t.branch(run, b, last) - t.branch(run, b, first)))


@njit(**PART)
def sides_of(run, e):
    return run.link_integers[of_link_integer(e, c.LEFT_SLOT)], run.link_integers[of_link_integer(e, c.RIGHT_SLOT)]

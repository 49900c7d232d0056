"""Contact times of floors that stand in touch before anything moves.

Such floors move alike at first: storeys above the ground answer it at a high order of time, so that their closing is
lost in the last digits of their displacements for milliseconds. Its sign there is rounding, and differs from run to run
with the steps. So nothing is counted until the floors have parted or pressed by more than rounding; whichever it is,
they did from the start."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import link_table as t
from pounding_cli.kernels.cells import at_link, of, of_link, of_tie
from pounding_cli.kernels.clock import END, H
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import greater, load, lowest, splat, stand_alone

ALIKE = 1e-9
"""Floors move alike while their displacements, and their velocities, differ by less than this part of them [-]."""


@njit(**PART)
def _edge(run, e):
    """The closing at which link e opens or closes [m]; infinite for one that never does."""
    closed = run.links[of_link(e, c.CLOSED)] != 0.0
    return t.branch(run, run.ties[of_tie(e, c.BRANCH)], t.FROM if closed else t.TO)


@njit(**CALLED)
def start_in_touch(run):
    """Which links begin so: at the closing where they would close, and at rest."""
    stand_alone()
    for e in range(run.linked):
        left = run.ties[of_tie(e, c.LEFT_SLOT)]
        right = run.ties[of_tie(e, c.RIGHT_SLOT)]
        closing = run.W[left - run.padded] - run.W[right - run.padded] - run.links[of_link(e, c.LEAVES_OUT)]
        touch = closing == _edge(run, e) and run.W[left] == run.W[right]
        run.links[of_link(e, c.UNDECIDED)] = 0.0 if touch else -1.0


@njit(**PART)
def _alike(a, b, offset):
    return abs(a - b - offset) <= ALIKE * max(abs(a), abs(b))


@njit(**CALLED)
def _decide(run, e):
    """Go on with the time for which link e is undecided, or end it at this step's end: all of it was contact, or none
    of it."""
    stand_alone()
    links = run.links
    left = run.ties[of_tie(e, c.LEFT_SLOT)]
    right = run.ties[of_tie(e, c.RIGHT_SLOT)]
    time = links[of_link(e, c.UNDECIDED)] + run.clock[H] * run.clock[END]
    offset = links[of_link(e, c.LEAVES_OUT)] + _edge(run, e)
    displacements_alike = _alike(run.ends[left], run.ends[right], offset)
    if displacements_alike and _alike(run.slots[of(left, c.V_END)], run.slots[of(right, c.V_END)], 0.0):
        links[of_link(e, c.CONTACT)] = 0.0
        links[of_link(e, c.UNDECIDED)] = time
    else:
        links[of_link(e, c.CONTACT)] = time * links[of_link(e, c.APPLIED)]  # fault: contact-from-rest
        links[of_link(e, c.UNDECIDED)] = -1.0


@njit(**PART)
def count_from_rest(run):
    """Contact times of the links that began in touch and are undecided yet; those of others stay as they are."""
    for b in range(run.first, run.last, 8):
        undecided = ~greater(splat(0.0), load(run.links, at_link(b, c.UNDECIDED))) & 255
        while undecided != 0:
            e = b + lowest(undecided)
            undecided &= undecided - 1
            _decide(run, e)

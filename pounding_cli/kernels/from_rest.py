"""Contact times of floors that stand in touch before anything moves.

Such floors move alike at first: storeys above the ground answer it at a high order of time, so that their closing is
lost in the last digits of their displacements for milliseconds. Its sign there is rounding, and differs from run to run
with the steps. So nothing is counted until the floors have parted or pressed by more than rounding; whichever it is,
they did from the start."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import at_link, of, of_link, of_link_integer
from pounding_cli.kernels.clock import END, H
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import greater, load, lowest, no_inline, splat

ALIKE = 1e-9
"""Floors move alike while their displacements, and their velocities, differ by less than this part of them [-]."""


@njit(**PART)
def _edge(run, e):
    """The closing at which link e opens or closes [m]; infinite for one that never does."""
    closed = run.links[of_link(e, c.CLOSED)] != 0.0
    return t.branch(run, run.link_integers[of_link_integer(e, c.BRANCH)], t.FROM if closed else t.TO)


@njit(**CALLED)
def start_in_touch(run):
    """Which links begin so: at the closing where they would close, and at rest."""
    no_inline()
    for e in range(run.padded_links):
        left = run.link_integers[of_link_integer(e, c.LEFT_SLOT)]
        right = run.link_integers[of_link_integer(e, c.RIGHT_SLOT)]
        closing = run.W[left - run.padded] - run.W[right - run.padded] - run.links[of_link(e, c.LINK_OFFSET)]
        touch = closing == _edge(run, e) and run.W[left] == run.W[right]
        run.links[of_link(e, c.UNDECIDED)] = 0.0 if touch else -1.0


@njit(**PART)
def _alike(a, b, offset):
    return abs(a - b - offset) <= ALIKE * max(abs(a), abs(b))


@njit(**CALLED)
def _decide(run, e):
    """Go on with the time for which link e is undecided, or end it at this step's end: all of it was contact, or none
    of it."""
    no_inline()
    links = run.links
    left = run.link_integers[of_link_integer(e, c.LEFT_SLOT)]
    right = run.link_integers[of_link_integer(e, c.RIGHT_SLOT)]
    time = links[of_link(e, c.UNDECIDED)] + run.clock[H] * run.clock[END]
    offset = links[of_link(e, c.LINK_OFFSET)] + _edge(run, e)
    displacements_alike = _alike(run.ends[left], run.ends[right], offset)
    if displacements_alike and _alike(run.slots[of(left, c.V1)], run.slots[of(right, c.V1)], 0.0):
        links[of_link(e, c.CONTACT_TIME)] = 0.0
        links[of_link(e, c.UNDECIDED)] = time
    else:
        links[of_link(e, c.CONTACT_TIME)] = time * links[of_link(e, c.ACTS)]
        links[of_link(e, c.UNDECIDED)] = -1.0


@njit(**PART)
def count_from_rest(run):
    """Contact times of the links that began in touch and are undecided yet; those of others stay as they are."""
    for b in range(run.link_start, run.link_stop, 8):
        undecided = ~greater(splat(0.0), load(run.links, at_link(b, c.UNDECIDED))) & 255
        while undecided != 0:
            e = b + lowest(undecided)
            undecided &= undecided - 1
            _decide(run, e)

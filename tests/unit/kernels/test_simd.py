"""The vector type: every operation against numpy, element by element."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from pounding_cli.kernels.simd import (
    LANES,
    choose,
    from_left,
    from_right,
    further,
    fused,
    gather,
    greater,
    load,
    lowest,
    magnitude,
    maximum,
    minimum,
    pointer,
    ramp,
    splat,
    square_root,
    store,
)

RNG = np.random.default_rng(1)
A, B = RNG.normal(size=2 * LANES), RNG.normal(size=2 * LANES)


@njit
def evaluate(a, b, out):
    p, q, r = pointer(a), pointer(b), pointer(out)
    left, this = load(p, 0), load(p, LANES)
    other = load(q, LANES)
    store(r, 0, this + other)
    store(r, LANES, this - other)
    store(r, 2 * LANES, this * other)
    store(r, 3 * LANES, this / other)
    store(r, 4 * LANES, 2.0 * this + 1)
    store(r, 5 * LANES, from_left(left, this))
    store(r, 6 * LANES, from_right(left, this))
    store(r, 7 * LANES, magnitude(this))
    store(r, 8 * LANES, maximum(this, other))
    store(r, 9 * LANES, minimum(this, other))
    store(r, 10 * LANES, square_root(magnitude(this)))
    store(r, 11 * LANES, splat(3.5))
    store(further(r, 12 * LANES), 0, this)


@njit
def bits(a, b):
    return greater(load(pointer(a), 0), load(pointer(b), 0))


@njit
def places(mask, out):
    n = 0
    while mask != 0:
        out[n] = lowest(mask)
        n += 1
        mask &= mask - 1
    return n


def test_every_operation():
    out = np.zeros(13 * LANES)
    evaluate(A, B, out)
    left, this, other = A[:LANES], A[LANES:], B[LANES:]
    expected = [
        this + other, this - other, this * other, this / other, 2 * this + 1,
        np.r_[left[-1], this[:-1]], np.r_[left[1:], this[0]], np.abs(this),
        np.maximum(this, other), np.minimum(this, other), np.sqrt(np.abs(this)), np.full(LANES, 3.5), this,
    ]  # fmt: skip
    for row, (found, true) in enumerate(zip(out.reshape(-1, LANES), expected, strict=True)):
        assert found == pytest.approx(true, rel=1e-15), row


def test_greater_gives_one_bit_a_lane_and_nan_none():
    a = np.array([1.0, 0.0, np.nan, 2.0, -1.0, 5.0, 0.0, 9.0])
    b = np.array([0.0, 0.0, 0.0, 3.0, -2.0, np.nan, 1.0, 8.0])
    out = np.zeros(8, np.int64)
    assert out[: places(bits(a, b), out)].tolist() == [0, 4, 7]


@njit
def _new_ones(a, b, index, out):
    p, q, r = pointer(a), pointer(b), pointer(out)
    this, other = load(p, 0), load(q, 0)
    store(r, 0, fused(this, other, 3.0))
    store(r, LANES, choose(0b10010110, this, other))
    store(r, 2 * LANES, gather(p, 2, pointer(index), 1))
    store(r, 3 * LANES, ramp())
    out[4 * LANES] = fused(a[0], b[0], 3.0)


def test_fusing_choosing_and_gathering():
    index = np.array([9, 3, 0, 11, 5, 5, 2, 8, 1], np.int64)
    out = np.zeros(4 * LANES + 1)
    _new_ones(A, B, index, out)
    this, other = A[:LANES], B[:LANES]
    chosen = np.where([0, 1, 1, 0, 1, 0, 0, 1], this, other)
    for row, expected in enumerate((this * other + 3.0, chosen, A[2 + index[1:]], np.arange(8.0))):
        assert out[row * LANES : (row + 1) * LANES] == pytest.approx(expected, rel=1e-15), row
    assert out[-1] == out[0]


def test_fused_rounds_once():
    """(1 + e)(1 - e) - 1 = -e^2 exactly; two roundings give 0."""
    e = 2.0**-30
    out = np.zeros(4 * LANES + 1)
    a, b = np.full(2 * LANES, 1 + e), np.full(2 * LANES, 1 - e)

    @njit
    def last_digits(a, b, out):
        out[0] = fused(a[0], b[0], -1.0)
        store(pointer(out), 8, fused(load(pointer(a), 0), load(pointer(b), 0), -1.0))

    last_digits(a, b, out)
    assert out[0] == -(e**2)
    assert (out[8:16] == -(e**2)).all()

"""The Motion itself: windows, scaling, digest, refusals."""

import numpy as np
import pytest

from pounding_cli.records import Motion

RAMP = Motion("ramp", 0.02, np.arange(501.0))


def test_window_keeps_the_sample_at_its_end() -> None:
    cut = RAMP.windowed(4.0)
    assert cut.acceleration.size == 201
    assert cut.duration == pytest.approx(4.0, abs=1e-12)
    assert cut.acceleration[-1] == 200.0


def test_window_between_samples_ends_before_it() -> None:
    assert RAMP.windowed(4.019).acceleration.size == 201


def test_longer_window_returns_the_motion_whole() -> None:
    assert RAMP.windowed(99.0) is RAMP


def test_scaled_scales_the_peak_and_keeps_name_and_label() -> None:
    real = Motion("m", 0.01, [0.0, -3.0, 2.0], "real")
    twice = real.scaled(2.0)
    assert twice.pga == 6.0
    assert (twice.name, twice.source, twice.dt) == ("m", "real", 0.01)


def test_digest_tells_samples_and_step_apart_but_not_names() -> None:
    one = Motion("a", 0.01, [0.0, 1.0, 2.0])
    assert one.digest == Motion("b", 0.01, [0.0, 1.0, 2.0]).digest
    assert one.digest != Motion("a", 0.02, [0.0, 1.0, 2.0]).digest
    assert one.digest != Motion("a", 0.01, [0.0, 1.0, 2.0 + 1e-15]).digest


def test_samples_are_copied_and_frozen() -> None:
    samples = np.ones(5)
    motion = Motion("m", 0.01, samples)
    samples[0] = 7.0
    assert motion.acceleration[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        motion.acceleration[0] = 2.0


@pytest.mark.parametrize(
    ("dt", "samples"),
    [(0.01, [1.0]), (0.01, [[1.0, 2.0]]), (0.01, [1.0, np.nan]), (0.0, [1.0, 2.0]), (np.inf, [1.0, 2.0])],
)
def test_refuses_what_is_no_motion(dt: float, samples: list) -> None:
    with pytest.raises(ValueError, match="a motion needs"):
        Motion("m", dt, samples)

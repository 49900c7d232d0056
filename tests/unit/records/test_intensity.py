"""Intensity measures against closed forms, a matrix exponential and brute-force sums."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import expm

from pounding_cli.records import (
    GRAVITY,
    Motion,
    arias,
    cumulative_arias,
    husid,
    husid_times,
    pgv,
    significant_duration,
    spectrum,
)
from pounding_cli.records.intensity import (
    displacement,
    oscillator,
    pgd,
    spectral_displacement,
    velocity,
)


def noise(seed: int = 3, size: int = 400, dt: float = 0.02) -> Motion:
    return Motion("noise", dt, np.random.default_rng(seed).standard_normal(size))


def sine(amplitude: float, period: float, cycles: int, dt: float) -> Motion:
    t = np.arange(round(cycles * period / dt) + 1) * dt
    return Motion("sine", dt, amplitude * np.sin(2 * np.pi * t / period))


def test_arias_of_a_triangle_is_exact() -> None:
    # A triangle of height A over 2 h: integral of a^2 = 2 h A^2 / 3.
    motion = Motion("triangle", 0.5, [0.0, 3.0, 0.0])
    assert arias(motion) == pytest.approx(np.pi / (2 * GRAVITY) * 2 * 0.5 * 9.0 / 3.0, rel=1e-14)


def test_arias_of_a_sine_has_its_closed_form_and_second_order() -> None:
    exact = np.pi / (2 * GRAVITY) * 2.0**2 * 5.0 / 2.0
    errors = [abs(arias(sine(2.0, 1.0, 5, dt)) / exact - 1) for dt in (0.02, 0.01, 0.005)]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert rates == pytest.approx([2.0, 2.0], abs=0.02)
    assert errors[-1] < 2e-4


def test_arias_grows_with_the_factor_squared() -> None:
    assert arias(noise().scaled(3.0)) == pytest.approx(9.0 * arias(noise()), rel=1e-13)


def test_arias_does_not_depend_on_extra_samples_on_the_straight_line() -> None:
    motion = noise()
    fine = np.interp(np.arange(7 * 399 + 1) / 7, np.arange(400), motion.acceleration)
    assert arias(Motion("fine", motion.dt / 7, fine)) == pytest.approx(arias(motion), rel=1e-12)


def test_husid_runs_from_zero_to_one() -> None:
    curve = husid(noise())
    assert curve[0] == 0.0
    assert curve[-1] == 1.0
    assert (np.diff(curve) >= 0).all()


def test_husid_of_rest_is_zero() -> None:
    assert not husid(Motion("rest", 0.1, np.zeros(4))).any()


def test_husid_times_of_a_constant_acceleration_are_even() -> None:
    motion = Motion("step", 0.3, np.full(11, 2.0))
    assert husid_times(motion, (0.05, 0.5, 0.95)) == pytest.approx([0.15, 1.5, 2.85], rel=1e-12)
    assert significant_duration(motion) == pytest.approx(2.7, rel=1e-12)


def test_husid_times_of_a_ramp_follow_the_cube_root() -> None:
    # a = t: the integral of a^2 grows as t^3, inside steps too.
    motion = Motion("ramp", 0.25, np.arange(9) * 0.25)
    fractions = np.array([1e-4, 0.05, 0.31, 0.95])
    assert husid_times(motion, fractions) == pytest.approx(2.0 * np.cbrt(fractions), rel=1e-12)


def test_husid_times_invert_the_cumulative_intensity() -> None:
    motion = noise()
    times = np.arange(1, 399) * motion.dt
    assert husid_times(motion, cumulative_arias(motion)[1:399] / arias(motion)) == pytest.approx(times, rel=1e-9)


def test_husid_times_refuse_rest_and_fractions_outside() -> None:
    with pytest.raises(ValueError, match="at rest"):
        husid_times(Motion("rest", 0.1, np.zeros(4)), (0.5,))
    with pytest.raises(ValueError, match="between 0 and 1"):
        husid_times(noise(), (1.0,))


def test_velocity_and_displacement_of_a_ramp_are_exact() -> None:
    motion = Motion("ramp", 0.1, 3.0 * np.arange(21) * 0.1)
    t = np.arange(21) * 0.1
    assert velocity(motion) == pytest.approx(1.5 * t**2, abs=1e-13)
    assert displacement(motion) == pytest.approx(0.5 * t**3, abs=1e-13)
    assert pgd(motion) == pytest.approx(4.0, rel=1e-12)


def test_peak_velocity_is_found_between_samples() -> None:
    # From -1 m/s after the first second, a rises from -3 through zero half a second on: -1 - 3/4.
    assert pgv(Motion("turn", 1.0, [1.0, -3.0, 3.0, 0.0])) == pytest.approx(1.75, rel=1e-14)
    assert pgv(Motion("fall", 1.0, [1.0, -1.1])) == pytest.approx(0.5 / 2.1, rel=1e-14)


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.4])
@pytest.mark.parametrize("period", [0.05, 0.36, 2.0, 60.0])
def test_oscillator_agrees_with_a_matrix_exponential(period: float, damping: float) -> None:
    motion = noise(size=120)
    omega, h, a = 2 * np.pi / period, motion.dt, motion.acceleration
    # State u, u', a, a': the straight line between samples is part of the linear system, so expm is exact.
    system = np.zeros((4, 4))
    system[0, 1] = system[2, 3] = 1.0
    system[1] = [-(omega**2), -2 * damping * omega, -1.0, 0.0]
    step, state, path = expm(system * h), np.zeros(4), [0.0]
    for first, last in pairwise(a):
        state[2:] = first, (last - first) / h
        state = step @ state
        path.append(state[0])
    u, v = oscillator(motion, period, damping)
    scale = np.abs(path).max()
    assert u == pytest.approx(np.array(path), abs=1e-10 * scale)
    assert v[-1] == pytest.approx(state[1], abs=1e-9 * scale * omega)


def test_oscillator_between_samples_agrees_with_the_samples() -> None:
    u, v = oscillator(noise(), 0.3)
    fine_u, fine_v = oscillator(noise(), 0.3, parts=5)
    assert fine_u[::5] == pytest.approx(u, abs=1e-12 * np.abs(u).max())
    assert fine_v[::5] == pytest.approx(v, abs=1e-12 * np.abs(v).max())


def test_step_load_on_an_undamped_oscillator_doubles_the_static_displacement() -> None:
    # u = -(a / w^2)(1 - cos wt): peak 2 a / w^2 at half a period, between samples here.
    motion = Motion("step", 0.07, np.full(40, 1.5))
    assert spectral_displacement(motion, (1.0,), 0.0) == pytest.approx([2 * 1.5 / (2 * np.pi) ** 2], rel=2e-7)
    assert spectrum(motion, (1.0,), 0.0) == pytest.approx([3.0], rel=2e-7)


def test_step_load_overshoot_with_damping() -> None:
    zeta = 0.05
    overshoot = 1.0 + np.exp(-np.pi * zeta / np.sqrt(1 - zeta**2))
    motion = Motion("step", 0.01, np.full(300, 2.0))
    assert spectrum(motion, (0.5, 0.9), zeta) == pytest.approx([2.0 * overshoot] * 2, rel=1e-6)


def test_resonance_reaches_one_over_twice_the_damping() -> None:
    # Steady state at resonance: w^2 |u| = A / (2 zeta); 60 cycles leave exp(-6 pi) of the start.
    motion = sine(1.0, 1.0, 60, 0.005)
    assert spectrum(motion, (1.0,)) == pytest.approx([10.0], rel=1e-4)


def test_undamped_resonance_grows_by_pi_a_cycle() -> None:
    # u = (A / 2 w^2)(wt cos wt - sin wt): at the end of cycle n, w^2 u = A pi n.  Straight lines through the
    # samples of a sine have its fundamental times sinc^2(h / T).
    u, _ = oscillator(sine(1.0, 1.0, 4, 0.01), 1.0, 0.0)
    assert abs(u[-1]) * (2 * np.pi) ** 2 == pytest.approx(4 * np.pi * np.sinc(0.01) ** 2, rel=1e-6)


def test_very_stiff_oscillator_feels_the_ground() -> None:
    motion = noise(dt=0.02)
    smooth = Motion("smooth", 0.02, np.convolve(motion.acceleration, np.hanning(41), "same"))
    assert spectrum(smooth, (0.002,)) == pytest.approx([smooth.pga], rel=5e-3)


def test_very_soft_oscillator_stays_where_it_was() -> None:
    motion = sine(1.0, 0.5, 8, 0.01)
    assert spectral_displacement(motion, (2000.0,), 0.0) == pytest.approx([pgd(motion)], rel=1e-4)


def test_peaks_between_samples_do_not_depend_on_the_sampling() -> None:
    motion = noise(size=200)
    fine = np.interp(np.arange(400 * 199 + 1) / 400, np.arange(200), motion.acceleration)
    periods = (0.03, 0.11, 0.36, 0.6, 2.0)
    dense = [np.abs(oscillator(Motion("fine", motion.dt / 400, fine), t)[0]).max() for t in periods]
    assert spectral_displacement(motion, periods) == pytest.approx(dense, rel=1e-5)
    assert (spectral_displacement(motion, periods) >= np.array(dense) * (1 - 1e-6)).all()


@pytest.mark.parametrize(("period", "damping"), [(0.0, 0.05), (-1.0, 0.05), (1.0, 1.0), (1.0, -0.1)])
def test_oscillator_refuses_what_it_cannot_do(period: float, damping: float) -> None:
    with pytest.raises(ValueError, match="oscillator needs"):
        oscillator(noise(), period, damping)

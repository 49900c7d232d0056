"""Scale factors, and what Table 1's own scales rest on."""

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.records import (
    GRAVITY,
    Motion,
    TargetSpectrum,
    arias,
    arias_factor,
    entry,
    names,
    pga_factor,
    pgv,
    pgv_factor,
    sa_factor,
    spectrum,
    spectrum_factors,
)

SHAKE = Motion("shake", 0.01, np.random.default_rng(1).standard_normal(500))
OTHER = Motion("other", 0.02, np.random.default_rng(2).standard_normal(900))


def test_arias_factor_reaches_the_target_motion() -> None:
    assert arias(SHAKE.scaled(arias_factor(SHAKE, OTHER))) == pytest.approx(arias(OTHER), rel=1e-13)


def test_arias_factor_reaches_a_value() -> None:
    assert arias(SHAKE.scaled(arias_factor(SHAKE, 1.2))) == pytest.approx(1.2, rel=1e-13)


def test_arias_factor_to_itself_is_one() -> None:
    assert arias_factor(SHAKE, SHAKE) == 1.0


def test_pga_factor_reaches_the_peak() -> None:
    assert SHAKE.scaled(pga_factor(SHAKE, 0.35 * GRAVITY)).pga == pytest.approx(0.35 * GRAVITY, rel=1e-14)


def test_pgv_factor_reaches_the_peak_velocity() -> None:
    assert pgv(SHAKE.scaled(pgv_factor(SHAKE, 0.4))) == pytest.approx(0.4, rel=1e-13)


def test_pgv_factor_of_a_half_sine_by_hand() -> None:
    """a = A sin(w t) over half a period: the velocity ends at 2 A / w."""
    t = np.linspace(0.0, 1.0, 2001)
    pulse = Motion("pulse", t[1], 3.0 * np.sin(np.pi * t))
    assert pgv_factor(pulse, 1.0) == pytest.approx(np.pi / 6.0, rel=1e-5)


def test_sa_factor_reaches_the_ordinate_at_its_period_and_damping() -> None:
    factor = sa_factor(SHAKE, 8.0, 0.7, 0.02)
    assert spectrum(SHAKE.scaled(factor), (0.7,), 0.02)[0] == pytest.approx(8.0, rel=1e-12)
    assert spectrum(SHAKE.scaled(factor), (0.7,), 0.05)[0] < 7.9


def test_sa_factor_of_a_slow_ramp_by_hand() -> None:
    """A rise so slow that the oscillator follows it: Sa is the peak acceleration, within the ringing."""
    ramp = Motion("ramp", 0.01, np.minimum(np.arange(4001) / 3000, 1.0))
    assert sa_factor(ramp, 2.0, 0.1) == pytest.approx(2.0, rel=2e-3)


FLAT = TargetSpectrum((0.1, 0.5, 3.0), (8.0, 8.0, 2.0), 0.2, 1.2)
SUITE = {"shake": SHAKE, "other": OTHER, "third": Motion("third", 0.01, np.random.default_rng(3).standard_normal(700))}


def mean_spectrum(factors: dict[str, float], periods: np.ndarray, damping: float = 0.05) -> np.ndarray:
    return np.mean([factors[name] * spectrum(motion, periods, damping) for name, motion in SUITE.items()], axis=0)


def test_the_target_is_straight_between_its_points_in_logarithms() -> None:
    assert FLAT.grid[0] == 0.2
    assert FLAT.grid[-1] == 1.2
    below = FLAT.grid <= 0.5
    assert FLAT.ordinates[below] == pytest.approx(8.0)
    slope = np.log(2.0 / 8.0) / np.log(3.0 / 0.5)
    assert FLAT.ordinates[~below] == pytest.approx(8.0 * (FLAT.grid[~below] / 0.5) ** slope, rel=1e-12)


def test_one_factor_brings_the_mean_spectrum_to_the_target() -> None:
    factors = spectrum_factors(SUITE, FLAT, each=False)
    assert len(set(factors.values())) == 1
    misfit = np.log(mean_spectrum(factors, FLAT.grid) / FLAT.ordinates)
    assert misfit.mean() == pytest.approx(0.0, abs=1e-12)
    best = (misfit**2).sum()
    for change in (0.99, 1.01):  # least squares: any other factor is worse
        assert ((misfit + np.log(change)) ** 2).sum() > best


def test_a_factor_each_brings_every_spectrum_to_the_target() -> None:
    factors = spectrum_factors(SUITE, FLAT, each=True)
    assert len(set(factors.values())) == 3
    for name, motion in SUITE.items():
        misfit = np.log(factors[name] * spectrum(motion, FLAT.grid) / FLAT.ordinates)
        assert misfit.mean() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("each", [False, True])
def test_at_least_lifts_all_by_one_factor_until_the_mean_touches_its_bound(each: bool) -> None:
    free, held = spectrum_factors(SUITE, FLAT, each), spectrum_factors(SUITE, FLAT, each, at_least=0.9)
    ratio = mean_spectrum(held, FLAT.grid) / FLAT.ordinates
    assert ratio.min() == pytest.approx(0.9, rel=1e-12)
    lifts = [held[name] / free[name] for name in SUITE]
    assert lifts == pytest.approx([lifts[0]] * 3)
    assert lifts[0] > 1.0
    assert spectrum_factors(SUITE, FLAT, each, at_least=0.01) == free, "a bound that is met changes nothing"


def test_the_spectrum_of_a_motion_as_target_gives_back_its_scale() -> None:
    target = TargetSpectrum.of(SHAKE.scaled(1.7), 0.2, 1.2, 0.1)
    assert spectrum_factors({"shake": SHAKE}, target, each=True)["shake"] == pytest.approx(1.7, rel=1e-12)
    assert spectrum_factors({"shake": SHAKE}, target, each=False)["shake"] == pytest.approx(1.7, rel=1e-12)


@pytest.mark.parametrize(
    ("periods", "values", "low", "high"),
    [
        ((0.1,), (), 0.1, 0.2),
        ((0.2, 0.1), (1, 1), 0.1, 0.2),
        ((0.1, 1), (1, 1), 0.05, 0.5),
        ((0.1, 1), (1, 1), 0.5, 0.5),
    ],
)
def test_targets_that_are_none(periods: tuple, values: tuple, low: float, high: float) -> None:
    with pytest.raises(ValueError, match="target"):
        TargetSpectrum(periods, values, low, high)


def test_rest_and_targets_at_or_below_zero_are_refused() -> None:
    rest = Motion("rest", 0.1, np.zeros(5))
    for call in (
        lambda: arias_factor(rest, SHAKE),
        lambda: pga_factor(rest, 1.0),
        lambda: arias_factor(SHAKE, rest),
        lambda: arias_factor(SHAKE, -1.0),
        lambda: pga_factor(SHAKE, 0.0),
        lambda: pga_factor(SHAKE, float("nan")),
        lambda: pgv_factor(rest, 1.0),
        lambda: pgv_factor(SHAKE, -1.0),
        lambda: sa_factor(rest, 1.0, 0.5),
        lambda: sa_factor(SHAKE, 0.0, 0.5),
        lambda: spectrum_factors({"rest": rest}, FLAT, each=True),
        lambda: TargetSpectrum.of(rest, 0.1, 0.2),
    ):
        with pytest.raises(InputError):
            call()


def test_table1_scales_follow_from_the_facts_but_for_taft() -> None:
    """Arias scaling over Table 1's windows gives its last column, except Taft: 1.565 against 1.75 printed."""
    target = entry("elcentro").facts.arias
    found = {name: (target / entry(name).facts.arias) ** 0.5 for name in names()}
    assert found["elcentro"] == 1.0
    assert found["parkfield"] == pytest.approx(0.822, abs=5e-4)
    assert found["taft"] == pytest.approx(1.565, abs=5e-4)
    for name in ("eureka", "olympia", "parkfield"):
        assert found[name] == pytest.approx(entry(name).scale, abs=5e-3)

"""Annual rates from hazard curves: closed forms, a quadrature, and the files of services."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtr

import pounding_cli as pound
from pounding_cli.questions.hazard import Hazard, poisson_probability
from tests.adapter import read_hazard

G = 9.80665
X, Y = np.array([0.05, 0.1, 0.2, 0.4, 0.8]), np.array([2e-2, 7e-3, 2e-3, 3e-4, 2e-5])


def test_a_power_law_has_a_closed_form() -> None:
    """lambda = k0 theta^-k exp(k^2 beta^2 / 2) (Cornell et al. 2002)."""
    rate = float(Hazard.from_power_law(1e-4, 2.5).lognormal_rates(0.4, 0.5))
    assert rate == pytest.approx(1e-4 * 0.4**-2.5 * math.exp(2.5**2 * 0.5**2 / 2), rel=1e-12)
    assert rate == pytest.approx(2.15845e-3, rel=2e-6)
    assert poisson_probability(rate) == pytest.approx(0.10230, abs=5e-6)


@pytest.mark.parametrize(
    ("median", "spread"), [(0.3, 0.4), (0.02, 0.4), (2.0, 0.3), (0.3, 3.0), (0.3, 0.01), (1e-4, 0.2), (50.0, 0.5)]
)
def test_a_table_is_integrated_exactly(median: float, spread: float) -> None:
    """Against a quadrature over ln x of P(x) |d lambda|, piece by piece, the last one without end."""
    k = -np.diff(np.log(Y)) / np.diff(np.log(X))
    ends, whole = [*np.log(X[1:-1]), np.log(X[-2]) + 15], 0.0
    for start, end, slope, rate in zip(np.log(X[:-1]), ends, k, Y, strict=False):
        whole += quad(
            lambda x, start=start, slope=slope, rate=rate: (
                ndtr((x - math.log(median)) / spread) * slope * rate * math.exp(-slope * (x - start))
            ),
            start, end, epsabs=0, epsrel=1e-12, limit=500,
        )[0]  # fmt: skip
    assert Hazard.from_points(X, Y).lognormal_rates(median, spread) == pytest.approx(whole, rel=1e-10)


def test_contributions_add_up_and_a_curve_without_spread_is_a_step() -> None:
    table, edges = Hazard.from_points(X, Y), np.array([0.05, 0.07, 0.3, 1.0, np.inf])
    c, b = -math.log(0.3) / 0.4, 1 / 0.4
    parts = table.contributions(edges, np.full(4, c), np.full(4, b))
    assert parts.sum() == pytest.approx(table.lognormal_rates(0.3, 0.4), rel=1e-12)
    assert (parts > 0).all()
    assert table.lognormal_rates(0.2, 0.0) == pytest.approx(2e-3, rel=1e-12)
    assert table.lognormal_rates(0.2, 1e-6) == pytest.approx(2e-3, rel=1e-5)
    constant = table.contributions(edges, np.full(4, 0.3), np.zeros(4))
    assert constant.sum() == pytest.approx(ndtr(0.3) * 2e-2, rel=1e-12)
    np.testing.assert_allclose(table.rate(X), Y, rtol=1e-12)


TWO = "PGA (g), annual rate of exceedance\n0.05, 2e-2\n0.1, 7e-3\n0.2, 2e-3\n"
OPENQUAKE = (
    "#,,,\"generated_by='OpenQuake engine', kind='mean', investigation_time=50.0, imt='PGA'\"\n"
    "lon,lat,depth,poe-0.0500000,poe-0.1000000,poe-0.2000000\n"
    "11.0,45.0,0.0,6.32121E-01,2.95312E-01,9.51626E-02\n"
)
WIDE = "name,lon,lat,0.05,0.1,0.2\nsite,-118,34,2e-2,7e-3,2e-3\n"


@pytest.mark.parametrize(
    ("text", "unit"), [(TWO, None), (OPENQUAKE, None), (WIDE, "g"), ("0.05 2e-2\n0.1 7e-3\n0.2 2e-3\n", "g")]
)
def test_files_of_services(text: str, unit: str | None, tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text(text)
    intensity, rate, measure = read_hazard(tmp_path / "h.csv", unit, "m/s2")
    np.testing.assert_allclose(intensity, G * X[:3], rtol=1e-12)
    np.testing.assert_allclose(rate, Y[:3], rtol=1e-5)
    assert measure == ("PGA" if text is OPENQUAKE else "")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (TWO.replace("(g)", ""), "does not say the unit"),
        (TWO.replace("(g)", "(cm)"), "no unit of this intensity"),
        (TWO.replace("7e-3", "x"), ":3:1: '0.1, x' is no intensity and rate"),
        (TWO.replace("7e-3", "7e-2"), "not a hazard curve"),
        (OPENQUAKE.replace("investigation_time=50.0, ", ""), "unknown number of years"),
        (OPENQUAKE.replace("=50.0", "=5..0"), "unknown number of years"),
        (OPENQUAKE + "12,45,0,0.5,0.2,0.1\n", "curves of 2 sites"),
        ("", "the file is empty"),
        ("0.1 0.02\n", "no two rows"),
        (OPENQUAKE.replace("2.95312E-01", ""), "not a hazard curve"),
        (TWO.replace("2e-2", "-2e-2"), "not a hazard curve"),
    ],
)
def test_files_that_are_refused(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text(text)
    with pytest.raises(pound.InputError) as refused:
        read_hazard(tmp_path / "h.csv", None, "m/s2")
    assert words in str(refused.value)

"""Annual rates from hazard curves: closed forms, a quadrature, and the files of services."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtr

import pounding_cli as pound
from pounding_cli.questions.hazard import Hazard, poisson_probability
from tests.adapter import HazardColumns, read_hazard

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
COLUMNS = HazardColumns(intensity=1, unit="g", rate=2)
OPENQUAKE = (
    "#,,,\"generated_by='OpenQuake engine', kind='mean', investigation_time=50.0, imt='PGA'\"\n"
    "lon,lat,depth,poe-0.0500000,poe-0.1000000,poe-0.2000000\n"
    "11.0,45.0,0.0,6.32121E-01,2.95312E-01,9.51626E-02\n"
)
IN_50_YEARS = "site;gal;p\n" + "".join(
    f"7;{980.665 * x:.9g};{-math.expm1(-50 * y):.9g}\n" for x, y in zip(X, Y, strict=True)
)


@pytest.mark.parametrize(
    ("text", "declared"),
    [
        (TWO, COLUMNS),
        ("0.2 2e-3\n0.05 2e-2\n0.1 7e-3\n", COLUMNS),
        ("2e-2;0,05\n7e-3;0,1\n2e-3;0,2\n", replace(COLUMNS, intensity=2, rate=1, decimal=",")),
        ("1 9\n" + TWO, replace(COLUMNS, skip=2)),
        (TWO.replace("\n", " \n").replace(", ", "\t"), replace(COLUMNS, separator="tab")),
        (IN_50_YEARS, HazardColumns(intensity=2, unit="gal", probability=3, years=50.0)),
        (OPENQUAKE, None),
    ],
)
def test_files_of_hazard_curves(text: str, declared: HazardColumns | None, tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text(text)
    curve = read_hazard(tmp_path / "h.csv", "m/s2", declared, "PGA")
    np.testing.assert_allclose(curve.intensity[:3], G * X[:3], rtol=1e-6)
    np.testing.assert_allclose(curve.rate[:3], Y[:3], rtol=1e-5)


def test_what_was_taken_is_said(tmp_path: Path) -> None:
    """With the lines that were not read, and the probabilities 1 and 0, which tell no rate."""
    (tmp_path / "h.csv").write_text("Kathmandu\n" + TWO + "0.4, 0\n")
    assert read_hazard(tmp_path / "h.csv", "m/s2", COLUMNS).taken == (
        "h.csv: hazard curve of 3 points, intensities from 0.05 to 0.2 g, annual rates from 0.02 to 0.002; intensity: "
        "column 1, rate: column 2; 2 lines not read: 'Kathmandu', 'PGA (g), annual rate of exceedance'; left "
        "out: 1 point of 0, too rare to say"
    )
    saturated = OPENQUAKE.replace("depth,", "depth,poe-0.01,").replace("0.0,6", "0.0,1.000000E+00,6")
    (tmp_path / "o.csv").write_text(saturated)
    curve = read_hazard(tmp_path / "o.csv", "m/s2", None, "PGA")
    np.testing.assert_allclose(curve.rate, Y[:3], rtol=1e-5)
    assert curve.taken.endswith("1 point of probability 1, which tells no rate, so that nothing below 0.05 g counts")
    (tmp_path / "often.csv").write_text("0.1 9\n2 0.5\n")
    assert "1 g would be exceeded every 1." in read_hazard(tmp_path / "often.csv", "m/s2", COLUMNS).taken


@pytest.mark.parametrize(("imt", "wanted"), [("PGV", "PGV"), ("SA(1.0)", "SA(1)"), ("SA(0.3)", "SA")])
def test_openquake_names_the_measure(imt: str, wanted: str, tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text(OPENQUAKE.replace("PGA", imt))
    curve = read_hazard(tmp_path / "h.csv", "m/s" if imt == "PGV" else "m/s2", None, wanted)
    assert curve.intensity[0] == pytest.approx(5e-4 if imt == "PGV" else 0.05 * G, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "declared", "words"),
    [
        (TWO, None, "write `hazard: {file: h.csv, intensity: 1, unit: g, rate: 2}` or `hazard: {file: h.csv, "),
        (TWO, HazardColumns(unit="Gal", separator=","), 'intensity: 1, unit: Gal, rate: 2, separator: ","}`'),
        (TWO, replace(COLUMNS, unit=None), "nothing says the unit of the intensities"),
        (TWO, replace(COLUMNS, unit="cm"), "'cm' is no unit of this intensity"),
        (TWO, replace(COLUMNS, rate=3), ":2:1: rate or probability: there is no column 3"),
        (TWO.replace("7e-3", "x"), COLUMNS, ":3:6: 'x' is not a number"),
        (TWO.replace("7e-3", ""), COLUMNS, ":3:1: 1 cell on this line, where the first row, line 2, has 2"),
        (TWO.replace("7e-3", "7e-3, 5"), COLUMNS, ":3:1: 3 cells on this line"),
        (TWO.replace("7e-3", "7e-2"), COLUMNS, ":3:6: this is not a hazard curve: the rate does not fall"),
        (TWO.replace("7e-3", "0"), COLUMNS, ":4:6: this is not a hazard curve: the rate does not fall"),
        (TWO.replace("0.1,", "0.05,"), COLUMNS, "the intensity 0.05 stands twice"),
        (TWO.replace("0.2,", "200,"), COLUMNS, "the ground does not reach 200 g"),
        (TWO.replace("2e-2", "-2e-2"), COLUMNS, ":2:7: -0.02 is no annual rate"),
        (TWO, replace(COLUMNS, separator="blank"), ":2:1: '0.05,' is not a number"),
        ("0,05;0,02\n0,1;0,007\n1;0\n", COLUMNS, ":1:1: '0,05' is not a number"),
        ("0.05;63.2\n0.1;29.5\n", HazardColumns(1, "g", probability=2, years=50.0), ":1:6: 63.2 is no probability"),
        (OPENQUAKE, COLUMNS, "says itself what intensity, unit, rate would"),
        (OPENQUAKE.replace("PGA", "AvgSA"), None, "the hazard is that of AvgSA, the intensity is PGA"),
        (OPENQUAKE.replace("PGA", "SA(0.1)"), None, "the hazard is that of SA(0.1), the intensity is PGA"),
        (OPENQUAKE.replace(", imt='PGA'", ""), None, "does not say of what intensity measure"),
        (OPENQUAKE.replace("investigation_time=50.0, ", ""), None, "unknown number of years"),
        (OPENQUAKE.replace("=50.0", "=5..0"), None, "unknown number of years"),
        (OPENQUAKE + "12,45,0,0.5,0.2,0.1\n", None, "curves of 2 sites"),
        (OPENQUAKE.replace("2.95312E-01", ""), None, ":3:27: a cell is empty"),
        (OPENQUAKE.replace("2.95312E-01,", ""), None, ":3:1: the row has 5 cells below 6 headings"),
        (OPENQUAKE.replace("2.95312E-01", "1.0"), None, "not a hazard curve"),
        ("", COLUMNS, "the file is empty"),
        ("0.1 0.02\n", COLUMNS, "it has 1 point"),
    ],
)
def test_files_that_are_refused(text: str, declared: HazardColumns | None, words: str, tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text(text)
    with pytest.raises(pound.InputError) as refused:
        read_hazard(tmp_path / "h.csv", "m/s2", declared, "PGA")
    assert words in str(refused.value)

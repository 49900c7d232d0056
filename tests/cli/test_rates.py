"""Annual rates: what `pound fragility` and `pound gap` make of a hazard curve."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pounding_cli as pound
from pounding_cli.questions.hazard import Hazard
from pounding_cli.questions.reports import build_report as report
from tests.adapter import refused

G = 9.80665
STUDY: dict[str, Any] = {
    "records": {"use": ["elcentro", "taft", "eureka", "olympia", "parkfield"], "scale": {"pga": "0.3 g"}},
    "buildings": {"stiff": {"storeys": 2, "period": 0.36}, "soft": {"like": "stiff", "period": 0.6}},
    "group": ["stiff", "soft"],
    "cases": {"gap": {"link": "pounding", "gap": 0.01}},
    "estimate": "none",
}
POWER = {"k0": 1e-4, "k": 2.5}
TABLE = {"0.05 g": 0.02, "0.3 g": "1/475", "1 g": 1e-4}
LEVELS = {"from": "0.02 g", "to": "1.2 g", "step": "0.02 g"}


def fragility(hazard: Any, folder: Path) -> pound.Results:
    study = STUDY | {"analyses": ["inelastic"], "sweep": {"records.scale.pga": LEVELS}}
    return pound.run(
        study | {"fragility": {"limits": ["mu > 3"], "hazard": hazard}}, folder / "f.h5", workflow="fragility"
    )


def test_the_rate_of_a_limit(tmp_path: Path) -> None:
    """The closed form with the median and the spread of the curve; alone and with pounding, and their ratio."""
    results = fragility(POWER, tmp_path)
    curves = results.answer("fragility").frame
    rates = results.answer("fragility_rates").frame
    place = ["limit", "building", "state"]
    assert rates[place].equals(curves[place])
    theta = curves["median"] / G
    wanted = 1e-4 * theta**-2.5 * np.exp(0.5 * (2.5 * curves["spread"]) ** 2)
    np.testing.assert_allclose(rates["rate"], wanted, rtol=1e-9)
    np.testing.assert_allclose(rates["probability"], 1 - np.exp(-50 * wanted), rtol=1e-9)
    assert (rates["rate_low"] <= wanted).all()
    assert (rates["rate_high"] >= wanted).all()
    alone = rates[rates["state"] == "alone"]
    pounding = rates[rates["state"] == "with pounding"]
    ratio = pounding["rate"].to_numpy() / alone["rate"].to_numpy()
    np.testing.assert_allclose(pounding["rate_ratio"], ratio, rtol=1e-12)
    assert alone["rate_ratio"].isna().all()
    parts = results.answer("fragility_contributions").frame.groupby(["building", "state"], sort=False)["rate"].sum()
    assert parts.to_numpy() == pytest.approx(rates["rate"].to_numpy(), rel=0.05)
    assert (parts.to_numpy() < rates["rate"].to_numpy()).all()


def test_a_table_in_the_study_and_in_a_file_are_one(tmp_path: Path) -> None:
    rates = fragility(TABLE, tmp_path).answer("fragility_rates").frame
    lines = ["PGA [g]; annual rate", *(f"{x}; {y}" for x, y in ((0.05, 0.02), (0.3, 1 / 475), (1, 1e-4)))]
    (tmp_path / "h.csv").write_text("\n".join(lines))
    (tmp_path / "second").mkdir()
    declared = {"file": str(tmp_path / "h.csv"), "intensity": 1, "unit": "g", "rate": 2}
    again = fragility(declared, tmp_path / "second").answer("fragility_rates").frame
    np.testing.assert_allclose(again["rate"], rates["rate"], rtol=1e-12)
    assert (rates["beyond"] > 0).all()
    assert (rates["beyond"] < 1).all()


def test_the_gap_for_a_rate(tmp_path: Path) -> None:
    """Elastic closings grow in proportion to the intensity: the closed form holds for one intensity, and for several
    alike."""
    asked = {"gap": {"hazard": POWER, "rate": "1/2475"}, "analyses": ["elastic"]}
    one = pound.run(STUDY | asked, tmp_path / "one.h5", workflow="gap")
    required = one.answer("gap").frame
    roof = required[(required["rule"] == "exact") & (required["floor"] == 2)].iloc[0]
    gap = one.answer("gap_rate").frame.iloc[0]
    often = 2475 * 1e-4 * math.exp(0.5 * (2.5 * roof["dispersion"]) ** 2)
    theta = often ** (1 / 2.5)  # [g]: k0 theta^-k exp(k^2 beta^2 / 2) is the rate
    assert gap["gap"] == pytest.approx(roof["median"] * theta / 0.3, rel=1e-6)
    assert gap["gap_low"] < gap["gap"] < gap["gap_high"]
    assert gap["probability"] == pytest.approx(1 - math.exp(-50 / 2475), rel=1e-9)
    sweep = {"sweep": {"records.scale.pga": ["0.1 g", "0.3 g", "0.6 g"]}}
    several = pound.run(STUDY | asked | sweep, tmp_path / "several.h5", workflow="gap").answer("gap_rate").frame
    assert several["gap"].iloc[0] == pytest.approx(gap["gap"], rel=1e-6)


def test_the_rate_at_the_gap_of_a_code(tmp_path: Path) -> None:
    """The closed form of elastic closings; and the gap for that rate is the gap of the code. Fails if a rate is that of
    another analysis, of one floor or of one intensity of a sweep."""
    code = {"hazard": POWER, "codes": ["NBC 202"]}
    study = STUDY | {"records": STUDY["records"] | {"duration": 4.0}}
    one = pound.run(study | {"gap": code}, tmp_path / "one.h5", workflow="gap")
    rows = one.answer("gap_codes").frame.query("rule == 'NBC 202'").set_index("analysis")
    closings = one.link().groupby(["analysis", "record"])["max_closing"].max()
    for analysis, row in rows.iterrows():
        logs = np.log(closings[analysis])
        theta = 0.3 * 0.04 / np.exp(logs.mean())
        wanted = 1e-4 * theta**-2.5 * np.exp(0.5 * (2.5 * logs.std(ddof=1)) ** 2)
        assert row["rate"] == pytest.approx(wanted, rel=1e-6)
        assert row["rate_low"] < row["rate"] < row["rate_high"]
    assert rows["rate"].nunique() == len(rows) == 2
    rate = float(rows.loc["elastic", "rate"])
    sweep = {"sweep": {"records.scale.pga": ["0.1 g", "0.3 g", "0.6 g"]}, "analyses": ["elastic"]}
    several = pound.run(study | {"gap": code | {"rate": rate}} | sweep, tmp_path / "several.h5", workflow="gap")
    swept = several.answer("gap_codes").frame.query("rule == 'NBC 202'")
    np.testing.assert_allclose(swept["rate"], rate, rtol=1e-6)
    assert swept["closed"].is_monotonic_increasing
    assert several.answer("gap_rate").frame["gap"].iloc[0] == pytest.approx(0.04, rel=1e-6)


def test_a_table_of_gaps_follows_its_rate() -> None:
    """More contacts are allowed by a narrower gap: the rate of every other gap by the same pieces."""
    table = Hazard.from_points(np.array([0.05, 0.3, 1.0]), np.array([0.02, 1 / 475, 1e-4]))
    rates = table.lognormal_rates(np.array([0.1, 0.2, 0.4]), 0.3)
    assert (np.diff(rates) < 0).all()


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("fragility: {limits: [mu > 4], hazard: {0.1 g: 1e-4, 0.2 g: 1e-3}}", "not a hazard curve"),
        ("fragility: {limits: [mu > 4], hazard: {0.1 kg: 1e-2, 0.2 g: 1e-3}}", "no acceleration"),
        ("fragility: {limits: [mu > 4], hazard: nowhere.csv}", "no such file"),
        ("fragility: {limits: [mu > 4], hazard: {k0: 1e-4}}", "'k' is missing"),
        ("gap: {hazard: {file: h.csv, intensity: 1}}", "nothing says which column holds the annual rates"),
        ("gap: {hazard: {file: h.csv, rate: 1}}", "nothing says which column holds the intensities"),
        ("gap: {hazard: {file: h.csv, intensity: 1, rate: 1}}", "column 1 holds the intensities"),
        ("gap: {hazard: {file: h.csv, intensity: 1, rate: 2, probability: 3, years: 50}}", "rates or probabilities"),
        ("gap: {hazard: {file: h.csv, intensity: 1, probability: 2}}", "write e.g. `years: 50`"),
        ("gap: {hazard: {file: h.csv, intensity: 1, rate: 2, years: 50}}", "`years` belongs to `probability`"),
        ("gap: {rate: 1/475}", "needs a hazard curve"),
        ("gap: {rate: 0, hazard: {k0: 1e-4, k: 2}}", "rate"),
    ],
)
def test_hazards_that_are_refused(section: str, words: str) -> None:
    study = (
        "records: {use: [elcentro], scale: {pga: 0.3 g}}\nbuildings:\n  A: {storeys: 2, period: 0.3 s}\ngroup: [A, A]\n"
        "cases: {near: {link: pounding, gap: 1 cm}}\nsweep: {records.scale.pga: [0.1 g, 0.2 g]}\n"
    )
    problems = refused(study + section)
    assert any(words in told for _, _, told in problems), problems


@pytest.mark.parametrize(
    ("sweep", "words"),
    [
        ({}, "scaled to an intensity"),
        ({"records.scale": [1, "table1"]}, "not numbers"),
        ([{"records.scale": [1, 2], "buildings.soft.period": ["0.5 s", "0.6 s"]}], "an axis of its own"),
    ],
)
def test_a_rate_takes_an_intensity(tmp_path: Path, sweep: Any, words: str) -> None:
    study = STUDY | {"records": {"use": ["elcentro", "taft"]}, "gap": {"hazard": POWER, "rate": "1/475"}}
    with pytest.raises(pound.InputError, match=words):
        pound.run(study | ({"sweep": sweep} if sweep else {}), tmp_path / "x.h5", workflow="gap")


def test_the_page_of_a_limit_that_nothing_passes(tmp_path: Path) -> None:
    study = STUDY | {"sweep": {"records.scale.pga": ["0.1 g", "0.2 g"]}}
    asked = {"fragility": {"limits": ["mu > 500"], "hazard": POWER}}
    results = pound.run(study | asked, tmp_path / "f.h5", workflow="fragility")
    assert "never passed" in str(report(results))

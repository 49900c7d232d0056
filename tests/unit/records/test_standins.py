"""How well the shipped stand-ins match, and that they can be made again; with real motions, against those."""

import os
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.records import (
    GRAVITY,
    arias,
    entry,
    find,
    husid,
    husid_times,
    names,
    pgv,
    read_motion,
    spectrum,
)
from pounding_cli.records.catalogue import real_folders, shipped_folder
from pounding_cli.records.intensity import displacement, significant_duration, velocity
from pounding_cli.records.standins import DIGITS, stand_in, stand_in_text
from pounding_cli.records.synthesis import _lack

FINER = np.geomspace(0.1, 1.5, 60)
# Log-spaced otherwise than the catalogue's own periods: what lies between the targets counts too.


def shipped(name: str):
    return read_motion(shipped_folder() / f"{name}.txt", source="stand-in")


def interpolated(name: str, periods: np.ndarray) -> np.ndarray:
    facts = entry(name).facts
    return np.exp(np.interp(np.log(periods), np.log(facts.periods), np.log(facts.spectrum)))


@pytest.mark.parametrize("name", ["elcentro", "taft", "eureka", "olympia", "parkfield"])
def test_shipped_stand_in_matches_the_facts(name: str) -> None:
    motion, facts = shipped(name), entry(name).facts
    assert motion.duration == pytest.approx(entry(name).duration, abs=1e-9)
    assert motion.pga == pytest.approx(facts.pga, rel=0.01)
    assert arias(motion) == pytest.approx(facts.arias, rel=0.005)
    assert significant_duration(motion) == pytest.approx(facts.significant_duration, rel=0.10)
    assert (np.abs(spectrum(motion, FINER) / interpolated(name, FINER) - 1) < 0.10).all()
    times = np.arange(motion.acceleration.size) * motion.dt
    grown = np.interp(facts.husid_times, times, husid(motion))
    assert np.abs(grown - facts.husid_fractions).max() < 0.035
    if facts.pgv is not None:
        assert pgv(motion) == pytest.approx(facts.pgv, rel=0.03)


@pytest.mark.parametrize("name", ["eureka", "olympia"])
def test_stand_in_without_a_real_motion_has_table1s_peak(name: str) -> None:
    assert shipped(name).pga / GRAVITY == pytest.approx(entry(name).peak / GRAVITY, abs=0.005)


@pytest.mark.parametrize("name", ["elcentro", "taft", "eureka", "olympia", "parkfield"])
def test_stand_in_starts_and_ends_at_rest(name: str) -> None:
    motion = shipped(name)
    assert motion.acceleration[0] == 0.0
    assert abs(velocity(motion)[-1]) < 0.01 * np.abs(velocity(motion)).max()
    assert abs(displacement(motion)[-1]) < 0.1 * np.abs(displacement(motion)).max()


# The two quickest always; the others, some seconds each, where ALL_STAND_INS is set.
AGAIN = list(names()) if os.environ.get("ALL_STAND_INS") else ["eureka", "parkfield"]


@pytest.mark.parametrize("name", AGAIN)
def test_stand_in_is_made_again_to_the_printed_digit(name: str) -> None:
    again, motion = stand_in(entry(name)), shipped(name)
    assert again.source == "stand-in"
    assert np.abs(again.acceleration - motion.acceleration).max() <= 0.51 * 10.0**-DIGITS * GRAVITY
    head = stand_in_text(entry(name), again).splitlines()[:7]
    assert head == (shipped_folder() / f"{name}.txt").read_text().splitlines()[:7]


def test_lack_holds_lesser_peaks_and_pulls_the_largest() -> None:
    ratio = np.array([0.98, -0.97, 0.5])
    assert _lack(ratio, 0) == pytest.approx(0.02)
    assert _lack(ratio, 1) == 0.0
    assert _lack(np.array([1.1, -1.04]), 1) == pytest.approx(0.04)


needs_real = pytest.mark.skipif(not os.environ.get("POUND_RECORDS"), reason="POUND_RECORDS is not set")


def real_ones() -> list[str]:
    return [name for name in names() if entry(name).facts_of == "real"]


@needs_real
@pytest.mark.parametrize("name", real_ones())
def test_facts_are_those_of_the_real_motion(name: str) -> None:
    assert real_folders()
    motion, facts = find(name), entry(name).facts
    if motion.source != "real":
        pytest.skip(f"no {name} in POUND_RECORDS")
    window = motion.windowed(entry(name).duration)
    assert (motion.dt, motion.acceleration.size) == (facts.dt, facts.samples)
    assert arias(motion) == pytest.approx(facts.arias_whole, rel=1e-5)
    assert window.pga == pytest.approx(facts.pga, rel=1e-5)
    assert pgv(window) == pytest.approx(facts.pgv, rel=1e-4)
    assert arias(window) == pytest.approx(facts.arias, rel=1e-5)
    assert husid_times(window, facts.husid_fractions) == pytest.approx(facts.husid_times, abs=1e-4)
    assert spectrum(window, facts.periods) == pytest.approx(facts.spectrum, rel=1e-4)


@needs_real
@pytest.mark.parametrize("name", real_ones())
def test_stand_in_matches_the_real_motion_and_is_no_copy(name: str) -> None:
    motion = find(name)
    if motion.source != "real":
        pytest.skip(f"no {name} in POUND_RECORDS")
    real, synthetic = motion.windowed(entry(name).duration), shipped(name)
    assert synthetic.pga == pytest.approx(real.pga, rel=0.02)
    assert arias(synthetic) == pytest.approx(arias(real), rel=0.01)
    assert significant_duration(synthetic) == pytest.approx(significant_duration(real), rel=0.10)
    assert (np.abs(spectrum(synthetic, FINER) / spectrum(real, FINER) - 1) < 0.10).all()
    times = np.arange(synthetic.acceleration.size) * synthetic.dt
    other = np.interp(times, np.arange(real.acceleration.size) * real.dt, real.acceleration)
    alike = np.correlate(other, synthetic.acceleration, "full")
    alike /= np.linalg.norm(other) * np.linalg.norm(synthetic.acceleration)
    # A copy would give 1; Parkfield's two great pulses, which energy and spectrum pin down, give 0.72.
    assert np.abs(alike).max() < 0.8


def test_shipped_files_are_the_catalogues_and_no_more() -> None:
    files = {path.name for path in Path(shipped_folder()).glob("*.txt")}
    assert files == {f"{name}.txt" for name in names()}

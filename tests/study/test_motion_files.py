"""Motion files as networks and people write them: the unit that the file states is taken, and what is no ground motion
is refused at its line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pounding_cli as pound
from pounding_cli.records import Declaration, read_file
from tests.helpers import motion_layouts as layouts

CM, IN_G = layouts.samples(60.0), layouts.samples(0.3)
G = 9.80665
ROWS = "0,0.1\n0.01,-0.25\n0.02,0.05\n0.03,0.2\n"
COUNTS = [round(40000 * value) + 8009 for value in layouts.samples(1.0)]


def read(folder: Path, text: str, **options) -> pound.Motion:
    (folder / "motion.txt").write_text(text, encoding="utf-8")
    return pound.motion(folder / "motion.txt", **options)


@pytest.mark.parametrize(
    ("unit", "one"),
    [
        ("cm/s2", 0.01), ("m/s^2", 1.0), ("in/s2", 0.0254), ("g", G), ("G", G), ("cm/sec/sec", 0.01), ("gal", 0.01),
        ("0.01 m/s2", 0.01), ("3920/6182761 gal", 39.2 / 6182761), ("mm/s²", 0.001), ("1e-3 g", 1e-3 * G),
    ],
)  # fmt: skip
def test_the_unit_that_is_declared(tmp_path, unit, one):
    samples = read(tmp_path, f"time,acc\n{ROWS}", unit=unit, time=1).acceleration
    assert samples == pytest.approx(one * np.array([0.1, -0.25, 0.05, 0.2]), rel=1e-12)


def test_rounded_times_are_refused_with_the_step(tmp_path, monkeypatch):
    """75 Hz with times of two decimals: fails if they are taken as they stand, or if the step is not 1/75 s."""
    monkeypatch.chdir(tmp_path)
    values = layouts.samples(0.3, 203)
    rows = "".join(f"{place / 75:.2f},{value}\n" for place, value in enumerate(values))
    with pytest.raises(pound.InputError, match=r"rounded to 0.01 s") as caught:
        read(Path(), f"Time (s),Acc (g)\n{rows}", unit="g", time=1)
    assert "{file: motion.txt, unit: g, dt: 0.01333333 s, column: 2}" in caught.value.issues[0].hint


def test_an_offset_is_warned_or_refused_and_the_mean_cures_it(tmp_path):
    """Half a percent of the peak is told; 0.25 g, with which the ground would go away by 176 m, is refused."""
    values = np.array([0.3 * np.sin(0.3 * place) for place in range(600)])
    values -= values.mean()
    for offset, word in ((0.0, ""), (0.005 * 0.3, "ends at"), (0.25, "no ground goes beyond 100 m")):
        (tmp_path / "motion.txt").write_text("".join(f"{value:.9f}\n" for value in values + offset))
        declared = Declaration(unit="g", dt=0.02)
        try:
            reading = read_file(tmp_path / "motion.txt", declared)
            said = "".join(each.message for each in reading.doubts)
        except pound.InputError as refused:
            said = str(refused)
            assert "`baseline: mean`" in said
        assert word in said
        assert bool(said) == bool(word), said
        cured = read_file(tmp_path / "motion.txt", replace(declared, baseline="mean"))
        assert cured.motion.acceleration == pytest.approx(G * values, abs=1e-8)
        assert cured.doubts == ()
        assert f"its mean of {G * offset:.4g} m/s2 is taken away" in cured.lines[0] or offset == 0


def test_counts_of_a_recorder_become_gal_about_their_mean(tmp_path):
    motion = read(tmp_path, layouts.knet(COUNTS))
    counts = np.array(COUNTS, float)
    assert motion.acceleration == pytest.approx((counts - counts.mean()) * 39.2 / 6182761, rel=1e-9, abs=1e-12)
    assert motion.dt == 0.01


TWO_COSMOS = layouts.cosmos_channel(CM) + layouts.cosmos_channel(CM, 2, step_ms=10.0)
TWO_CSMIP = layouts.csmip_v2_channel(CM) + layouts.csmip_v2_channel(CM, 2, "180 Deg")


@pytest.mark.parametrize(
    ("text", "line", "word"),
    [
        (layouts.at2(CM, "CM/S", "VELOCITY"), 3, "velocity"),
        (layouts.at2(CM, "CM"), 3, "displacement"),
        (layouts.at2(CM, "COUNTS"), 3, "counts"),
        (layouts.at2(IN_G, count=44), 4, "NPTS = 44, but 43"),
        (layouts.knet(COUNTS, scale=""), 1, "Scale Factor"),
        (layouts.knet(COUNTS, scale="7840(gal)/6182761"), 15, "peak"),
        (layouts.knet(COUNTS, duration="2"), 12, "200"),
        (layouts.esm(CM, "cm/s"), 18, "velocity"),
        (layouts.esm(CM, peak=99.0), 22, "peak of 99"),
        (layouts.esm(CM, count=50), 15, "NDATA = 50"),
        (layouts.smc(CM, rate=None), 18, "evenly"),
        (layouts.smc(CM, flag=1), 14, "faulty"),
        (layouts.smc(CM, count=16), 32, "more than the 16"),
        (layouts.cosmos_channel(COUNTS, unit=("counts", 50), form=("(10I8)", "8d", 10)), 49, "counts"),
        (layouts.cosmos_channel(CM, 1, "velocity", ("cm/s", 5)), 49, "velocity"),
        (layouts.cosmos_channel(CM) + layouts.cosmos_channel(CM, 2), 49, "--channel 1"),
        (layouts.cosmos_channel(CM).replace(" 100 Real", "  40 Real"), 34, "how many samples"),
        (TWO_COSMOS.replace("acceleration pts", "acceleration ptx", 1), 49, "how many samples"),
        (TWO_COSMOS[: len(layouts.cosmos_channel(CM)) + 1500], 78, "the header says"),
        (TWO_CSMIP.replace("points of accel", "points of acxel", 1), 53, "no acceleration"),
        (layouts.csmip_v2_channel(CM, count=60), 52, "8 should stand"),
        ("UNCORRECTED ACCELEROGRAM DATA\n1 2 3\n", 1, "(V2)"),
        ("# dt: 0.02 s\n# unit: counts\n1\n-2\n", 3, "counts"),
        ("# dt: 0.01 s\n# samples: 3\n# unit: g\n0.1\n-0.2\n", 2, "samples = 3"),
    ],
)  # fmt: skip
def test_no_ground_motion(tmp_path, text, line, word):
    with pytest.raises(pound.InputError) as caught:
        read(tmp_path, text)
    (problem,) = caught.value.issues
    assert (problem.line, word in f"{problem.message} {problem.hint}") == (line, True), problem

"""Motion files as networks and people write them: the unit that the file states is taken, and what is no ground motion
is refused at its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import pounding_cli as pound
from tests.helpers import motion_layouts as layouts

CM, IN_G = layouts.samples(60.0), layouts.samples(0.3)
G = 9.80665
ROWS = "0,0.1\n0.01,-0.25\n0.02,0.05\n0.03,0.2\n"
COUNTS = [round(40000 * value) + 8009 for value in layouts.samples(1.0)]


def read(folder: Path, text: str, **options) -> pound.Motion:
    (folder / "motion.txt").write_text(text, encoding="utf-8")
    return pound.motion(folder / "motion.txt", **options)


@pytest.mark.parametrize(
    ("head", "unit"),
    [
        ("time,acc (cm/s2)", 0.01), ("t [s]; a [m/s^2]", 1.0), ("# unit: in/s2", 0.0254), ("time, m/s2", 1.0),
        ("Units: cm/sec/sec\ntime, value", 0.01), ("ACCELERATION IN UNITS OF G", G), ("time,acc\ns,m/s2", 1.0),
        ("Acceleration (cm/s/s)", 0.01), ("Time;Accel, mg", 1e-3 * G), ("time_s,acc_g", G), ("t, a (ms-2)", 1.0),
    ],
)  # fmt: skip
def test_the_unit_that_the_heading_states(tmp_path, head, unit):
    samples = read(tmp_path, f"{head}\n{ROWS}").acceleration
    assert samples == pytest.approx(unit * np.array([0.1, -0.25, 0.05, 0.2]), rel=1e-12)


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
        ("# unit: counts\n" + ROWS, 1, "counts"),
        ("t (s), v (cm/s)\n" + ROWS, 1, "velocity"),
        ("0 0.1\n0.01 0.2\n0.03 0.1\n0.04 0.2\n0.05 0.1\n", 3, "uneven"),
        (ROWS.replace("0.02,", "0.005,"), 3, "a step of -0.005 s here"),
        (ROWS.replace("0.05", "nan"), 3, "finite"),
        ("# unit: g\n0 341\n0.01 20\n", 2, "341 g"),
        ("t,x,y\n0,1,2\n0.01,2,3\n", 2, "--column 2"),
        ("0.1\n0.2\n", 1, "no time step"),
        ("# dt: 0.01 s\n# samples: 3\n0.1\n0.2\n", 2, "samples = 3"),
    ],
)  # fmt: skip
def test_no_ground_motion(tmp_path, text, line, word):
    with pytest.raises(pound.InputError) as caught:
        read(tmp_path, text)
    (problem,) = caught.value.problems
    assert (problem.line, word in f"{problem.message} {problem.hint}") == (line, True), problem

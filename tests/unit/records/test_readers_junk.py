"""Any bytes give a motion or an `InputError` with a place and a way out: never anything else, whatever the format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pounding_cli.errors import InputError
from pounding_cli.records import FORMATS, read_file
from tests.helpers import motion_layouts as layouts

CM = layouts.samples(60.0, 20)
WHOLE = [
    layouts.at2(CM, "cm/s2"),
    layouts.knet([round(300 * v) for v in CM]),
    layouts.esm(CM),
    layouts.smc(CM),
    layouts.cosmos_channel(CM) + layouts.cosmos_channel(CM, 2),
    layouts.csmip_v2_channel(CM),
    layouts.csmip_v1_channel([v / 30 for v in CM]),
    layouts.csmip_v1_channel(CM, words_line="    20 Accelerogram points at 50 pts/sec in units of g (8f9.6)"),
    "time (s); a (m/s2); b (g)\n" + "".join(f"{0.01 * i:.2f};{v / 60:.5f};{v / 600:.5f}\n" for i, v in enumerate(CM)),
    "# dt: 0.01 s\n# unit: gal\n# samples: 20\n" + "".join(f"{v}\n" for v in CM),
]  # fmt: skip
WORDS = [
    "", " ", "\n", "\t", ",", ";", "-", ".", "nan", "inf", "1e999", "-1e-999", "0", "-0", "9" * 400, "1e308", "-1e308",
    "NPTS=", "DT=",
    "(8F10.5)", "(0F0.0)", "(99999999F9)", "-999", "counts", "cm/s", "é", "\x00", "\x1a",
    "#", "| ", "End of data for channel",
    "points of accel data equally spaced at 0 sec", "2 CORRECTED ACCELEROGRAM", "Origin Time", "EVENT_NAME:",
    "(Format v01.20", "²", "٣", "１",
]  # fmt: skip


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("junk") / "motion.txt"


def attempt(path: Path, raw: bytes, **options) -> None:
    path.write_bytes(raw)
    try:
        motion = read_file(path, **options).motion
    except InputError as refused:
        for problem in refused.problems:
            assert problem.message
            assert problem.hint
            assert problem.file == str(path)
            assert 0 <= problem.line <= raw.count(b"\n") + raw.count(b"\r") + 1
    else:
        assert motion.acceleration.size >= 2
        assert np.isfinite(motion.acceleration).all()
        assert motion.dt > 0


OPTIONS = st.fixed_dictionaries(
    {},
    optional={
        "format": st.sampled_from(FORMATS),
        "unit": st.sampled_from(["g", "gal", "1e-9 g", "cm/s", "1e300 m/s2"]),
        "dt": st.sampled_from([0.01, 0.0, -1.0, float("nan"), 1e-300, 1e300]),
        "channel": st.integers(-1, 3),
        "column": st.integers(-1, 4),
    },
)
LENIENT = settings(max_examples=250, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@LENIENT
@given(st.binary(max_size=200), OPTIONS)
def test_bytes(path: Path, raw: bytes, options: dict) -> None:
    attempt(path, raw, **options)


@LENIENT
@given(st.lists(st.sampled_from(WORDS) | st.floats().map(repr) | st.integers().map(str), max_size=40), OPTIONS)
def test_words(path: Path, words: list[str], options: dict) -> None:
    attempt(path, "".join(words).encode(), **options)
    attempt(path, " ".join(words).encode(), **options)


@settings(LENIENT, max_examples=600)
@given(st.data(), st.sampled_from(WHOLE), OPTIONS)
def test_files_with_a_piece_replaced(path: Path, data: st.DataObject, whole: str, options: dict) -> None:
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(whole)))
        length = data.draw(st.integers(0, 30) | st.integers(0, len(whole)))
        word = data.draw(st.sampled_from(WORDS) | st.text(max_size=5))
        whole = whole[:start] + word + whole[start + length :]
    attempt(path, whole.encode("utf-8", "surrogatepass"), **options)


@settings(LENIENT, max_examples=150)
@given(st.data(), st.sampled_from(WHOLE))
def test_files_with_lines_dropped_and_doubled(path: Path, data: st.DataObject, whole: str) -> None:
    lines = whole.splitlines(keepends=True)
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(lines) - 1))
        lines[place : place + 1] = [lines[place]] * data.draw(st.sampled_from([0, 2]))
        if not lines:
            break
    attempt(path, "".join(lines).encode())

"""Every file format read, and every bad file refused with its line and a way out."""

from pathlib import Path

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.records import GRAVITY, Motion, read_file, read_motion
from pounding_cli.records.readers import UNITS
from pounding_cli.records.writers import motion_text, write_text

AT2 = """PEER NGA STRONG MOTION DATABASE RECORD
Somewhere, 1/1/2000, Station, 090
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=   7, DT=   .0050 SEC
  .1000000E-02 -.2000000E-02  .3000000E-02 -.4000000E-02  .5000000E-02
 -.6000000E-02  .7000000E-02
"""
G_VALUES = np.array([0.001, -0.002, 0.003, -0.004, 0.005, -0.006, 0.007])


@pytest.fixture
def file(tmp_path: Path):
    def write(text: str, name: str = "motion.txt") -> Path:
        path = tmp_path / name
        path.write_bytes(text.encode())
        return path

    return write


def refusal(path: Path, **options) -> str:
    with pytest.raises(InputError) as caught:
        read_motion(path, **options)
    problem = caught.value.problems[0]
    assert problem.hint, "a refusal says what to write instead"
    assert problem.file == str(path)
    return f"{problem.line}:{problem.column}: {problem.message}"


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_at2(file, ends: str) -> None:
    motion = read_motion(file(AT2.replace("\n", ends), "x.AT2"))
    assert motion.dt == 0.005
    assert motion.acceleration == pytest.approx(G_VALUES * GRAVITY, rel=1e-15)
    assert (motion.name, motion.source) == ("x", "user")


def test_at2_of_the_older_header(file) -> None:
    text = AT2.replace("NPTS=   7, DT=   .0050 SEC", "     7    0.0050    NPTS, DT")
    assert read_motion(file(text)).dt == 0.005


def test_at2_with_touching_columns(file) -> None:
    text = AT2.replace(".1000000E-02 -.2000000E-02", ".1000000E-02-.2000000E-02")
    assert read_motion(file(text)).acceleration == pytest.approx(G_VALUES * GRAVITY, rel=1e-15)


def test_at2_with_fewer_values_than_npts(file) -> None:
    assert refusal(file(AT2.replace("  7,", "  8,"))) == "4:1: the header says NPTS = 8, but 7 values follow"


def test_two_columns(file) -> None:
    motion = read_motion(file("t a\n0.00 0.1\n0.02, -0.2\n\n0.04 0.3\n"), name="mine")
    assert (motion.name, motion.dt) == ("mine", 0.02)
    assert motion.acceleration == pytest.approx(np.array([0.1, -0.2, 0.3]) * GRAVITY)


def test_two_columns_with_fortran_exponents(file) -> None:
    motion = read_motion(file("0.0D+00 1.0D-01\n1.0D-02 -2.0d-01\n"))
    assert motion.acceleration == pytest.approx(np.array([0.1, -0.2]) * GRAVITY)


def test_times_printed_with_few_digits_are_even(file) -> None:
    times = np.arange(2000) / 256
    motion = read_motion(file("".join(f"{t:.4f} 0.1\n" for t in times)))
    assert motion.dt == pytest.approx(1 / 256, rel=1e-5)


def test_one_column_with_dt_given(file) -> None:
    motion = read_motion(file("0.1\n-0.2\n0.3\n"), dt=0.01)
    assert motion.dt == 0.01
    assert motion.acceleration.size == 3


def test_one_column_with_dt_in_its_header(file) -> None:
    motion = read_motion(file("# dt: 0.02 s\n# unit: cm/s2\n# name: mine\n10\n-20\n"))
    assert (motion.dt, motion.name) == (0.02, "mine")
    assert motion.acceleration == pytest.approx([0.1, -0.2])


def test_values_row_by_row(file) -> None:
    motion = read_motion(file("0.1 0.2 0.3\n0.4 0.5\n"), format="column", dt=0.01)
    assert motion.acceleration == pytest.approx(np.array([0.1, 0.2, 0.3, 0.4, 0.5]) * GRAVITY)


@pytest.mark.parametrize(
    ("unit", "in_si"),
    [("g", 9.80665), ("m/s2", 1.0), ("cm/s2", 0.01), ("gal", 0.01), ("mm/s2", 1e-3), ("ft/s2", 0.3048)],
)
def test_units(file, unit: str, in_si: float) -> None:
    assert read_motion(file("0 1\n0.1 2\n"), unit=unit).acceleration == pytest.approx([in_si, 2 * in_si])
    assert UNITS[unit] == in_si


def test_a_unit_given_comes_before_the_one_in_the_file(file) -> None:
    other = read_file(file("# unit: g\n1\n2\n"), unit="m/s2", dt=0.1)
    assert other.motion.acceleration == pytest.approx([1.0, 2.0])
    assert other.words == "in m/s2 (as given, although the file says g)"
    motion = read_motion(file("# unit: cm/s2\n1\n2\n"), unit="gal", dt=0.1)
    assert motion.acceleration == pytest.approx([0.01, 0.02])


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        ("", {}, "the file is empty"),
        ("  \n\n", {}, "the file is empty"),
        ("time acceleration\n", {}, "no line of numbers"),
        ("0.1\n0.2\n", {}, "no time step"),
        ("0.1\n0.2\n", {"dt": -0.01}, "the time step is -0.01"),
        ("# dt: soon\n0.1\n0.2\n", {}, "the time step is soon"),
        ("# dt: 0.01 s\n0.1\n0.2\n", {"dt": 0.02}, "dt is given as 0.02 s, but the file says 0.01 s"),
        ("0 0.1\n0.01 0.2\n0.02 0.1\n", {"dt": 0.02}, "dt is given as 0.02 s, but the file says 0.01 s"),
        ("0 0.1\n0.01 0.2\n0.02 nan\n", {}, "3:6: 'nan' is not a finite number"),
        ("0 0.1\n0.01 x\n", {}, "2:6: 'x' is not a number"),
        ("0 0.1\n0.01 1.2.3\n", {}, "2:6: '1.2.3' is not a number"),
        ("0 0.1\n0.01 0.2\n0.02 0.1 9\n", {}, "3:1: 3 values on this line"),
        (
            "0 0.1\n0.01 0.2\n0.03 0.1\n0.04 0.2\n0.05 0.1\n",
            {},
            "3:1: uneven time steps: 0.02 s here, 0.01 s",
        ),
        ("0 0.1\n0.02 0.2\n0.01 0.1\n", {}, "3:1: the time 0.01 s does not come after 0.02 s"),
        ("0 0.1\n0 0.2\n", {}, "does not come after"),
        ("1 2 3\n4 5 6\n", {}, "3 values on a line"),
        ("0.5\n", {"dt": 0.1}, "only one sample"),
        ("0 0.5\n", {}, "only one sample"),
        ("0 0\n1 0\n", {}, "every sample is zero"),
        ("0 341\n0.01 20\n", {}, "the peak is 341 g"),
        ("0 0.1\n0.01 0.2\n", {"unit": "furlong"}, "unknown unit 'furlong'"),
        ("0 0.1\n0.01 0.2\n", {"format": "wav"}, "unknown format 'wav'"),
        ("0 0.1\n0.01 0.2\n", {"format": "at2"}, "no header line with NPTS and DT"),
        ("# dt: 0.01\n# samples: 3\n0.1\n0.2\n", {}, "the header says samples = 3, but 2"),
    ],
)
def test_refusals(file, text: str, options: dict, said: str) -> None:
    assert said in refusal(file(text), **options)


def test_missing_binary_and_folder_are_refused(tmp_path: Path) -> None:
    assert "no such file" in refusal(tmp_path / "none.txt")
    (tmp_path / "picture.png").write_bytes(b"\x89PNG\xff\xfe\x00")
    assert "not a text file" in refusal(tmp_path / "picture.png")
    assert "cannot be read" in refusal(tmp_path)


def test_what_is_written_in_full_reads_back_to_the_bit(tmp_path: Path) -> None:
    motion = Motion("m", 1 / 3, np.random.default_rng(0).standard_normal(50))
    path = tmp_path / "deep" / "m.txt"
    write_text(path, motion_text(motion, {"motion": "test", "digest": motion.digest}))
    back = read_motion(path)
    assert back.digest == motion.digest
    assert path.read_text().startswith("# motion: test\n")
    assert list(path.parent.iterdir()) == [path], "no draft is left"


def test_a_changed_sample_is_caught_by_the_digest(tmp_path: Path) -> None:
    motion = Motion("m", 0.01, [0.5, 0.25, 0.125])
    path = tmp_path / "m.txt"
    path.write_text(motion_text(motion, {"digest": motion.digest}).replace("0.125", "0.126"))
    assert "digest differs" in refusal(path)


def test_a_failed_write_leaves_the_old_file_and_no_draft(tmp_path: Path) -> None:
    path = tmp_path / "m.txt"
    write_text(path, "old")
    with pytest.raises(UnicodeEncodeError):
        write_text(path, "\ud800")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]

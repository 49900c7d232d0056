"""Plain columns with any separator, heading and unit; and what of them is refused."""

from pathlib import Path

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.records import GRAVITY, UNITS, acceleration_unit, read_file

ROWS = [(0.0, 0.1, -5.0), (0.01, -0.25, 6.0), (0.02, 0.05, 7.0), (0.03, 0.2, -8.0)]
A, B = np.array([row[1] for row in ROWS]), np.array([row[2] for row in ROWS])


@pytest.fixture
def read(tmp_path: Path):
    def write_and_read(text: str, **options):
        path = tmp_path / "motion.csv"
        path.write_text(text, encoding="utf-8")
        return read_file(path, **options)

    return write_and_read


def table(separator: str, columns: int, head: str = "", comma: bool = False) -> str:
    lines = [separator.join(f"{value:g}" for value in row[:columns]) for row in ROWS]
    text = "\n".join(lines) + "\n"
    return head + (text.replace(".", ",") if comma else text)


@pytest.mark.parametrize("separator", [" ", "\t", ",", ";", ", ", "   ", " ; "])
def test_two_columns_by_any_separator(read, separator: str) -> None:
    reading = read(table(separator, 2))
    assert (reading.format, reading.unit, reading.unit_from) == ("two-column", "g", "nobody")
    assert reading.motion.dt == 0.01
    assert reading.motion.acceleration == pytest.approx(A * GRAVITY)


@pytest.mark.parametrize("separator", [";", "\t", " ", "; "])
def test_decimal_commas(read, separator: str) -> None:
    motion = read(table(separator, 2, comma=True)).motion
    assert motion.dt == 0.01
    assert motion.acceleration == pytest.approx(A * GRAVITY)


@pytest.mark.parametrize("separator", [" ,", ",", ", ", " , "])
def test_commas_between_whole_numbers_separate_them(read, separator: str) -> None:
    motion = read(f"0{separator}1\n1{separator}2\n2{separator}1\n", unit="m/s2").motion
    assert motion.dt == 1.0
    assert motion.acceleration == pytest.approx([1.0, 2.0, 1.0])


@pytest.mark.parametrize(
    ("head", "unit"),
    [
        ("time,acc (cm/s2)\n", 0.01),
        ("t [s], a [m/s^2]\n", 1.0),
        ("a title\nTime (sec), Acceleration (gal)\n\n", 0.01),
        ("# t [s] a [mm/s2]\n", 0.001),
        ("Units: cm/sec/sec\ntime, value\n", 0.01),
        ("ACCELERATION IN UNITS OF G\n", GRAVITY),
        ("# unit: in/s2\n", 0.0254),
        ("time, m/s2\n", 1.0),
        ("time,gal\n", 0.01),
        ("time, cm/s2\n", 0.01),
        ("time;mg\n", 1e-3 * GRAVITY),
        ("t [s]; a [m/s^2]\n", 1.0),
        ("Acceleration (cm/s/s)\n", 0.01),
        ("time,acc (gal)\n", 0.01),
        ("# units: g\n", GRAVITY),
        ("Time;Accel, mg\n", 1e-3 * GRAVITY),
        ("Time, Accel m / s2\n", 1.0),
        ("time_s,acc_g\n", GRAVITY),
        ("t/s, a/(m/s^2)\n", 1.0),
        ("time,acc\ns,m/s2\n", 1.0),
        ("DT=0.01 SEC, ACC IN CM/SEC/SEC\n", 0.01),
    ],
)
def test_a_unit_in_the_heading_is_the_files(read, head: str, unit: float) -> None:
    reading = read(table(",", 2, head))
    assert reading.unit_from == "the file"
    assert reading.motion.acceleration == pytest.approx(A * unit)
    assert read(table(",", 2, head), unit=f"{unit} m/s2").motion.digest == reading.motion.digest
    other = read(table(",", 2, head), unit="3 g")
    assert other.motion.acceleration == pytest.approx(A * 3 * GRAVITY)
    assert other.words == f"in 3 g (as given, although the file says {reading.unit})"


@pytest.mark.parametrize(
    ("head", "why"),
    [
        ("", "the file states no unit"),
        ("time,acc\n", "the file states no unit"),
        ("PEAK ACCELERATION = 0.35 G\n", "the file states no unit"),  # the peak is in g; the values need not be
        ("El Centro 1940\n", "the file states no unit"),
        ("time,furlongs\n", "'furlongs' in the file is no unit"),
        ("time, acc [xyz]\n", "'acc [xyz]' in the file is no unit"),
        ("Acceleration [xyz]\n", "'Acceleration [xyz]' in the file is no unit"),
    ],
)
def test_a_unit_that_nobody_states_is_assumed_and_said(read, head: str, why: str) -> None:
    reading = read(table(",", 2, head))
    assert reading.words == f"in g (assumed: {why})"
    assert reading.motion.source == "user, unit g assumed"
    assert reading.motion.acceleration == pytest.approx(A * GRAVITY)
    given = read(table(",", 2, head), unit="gal")
    assert (given.words, given.motion.source) == ("in gal (as given)", "user")


def test_a_column_of_a_table(read) -> None:
    text = table(",", 3, "t (s),x (g),y (cm/s2)\n")
    with pytest.raises(InputError, match=r"3 values on a line \(1: t \(s\), 2: x \(g\), 3: y \(cm/s2\)\)"):
        read(text)
    assert read(text, column=2).motion.acceleration == pytest.approx(A * GRAVITY)
    reading = read(text, column=3)
    assert (reading.format, reading.motion.dt) == ("table", 0.01)
    assert reading.motion.acceleration == pytest.approx(B * 0.01)
    with pytest.raises(InputError, match="there is no column 4 among 3"):
        read(text, column=4)
    with pytest.raises(InputError, match="column 1 is the time, unless dt is given"):
        read(text, column=1)


def test_a_table_without_times_takes_dt(read) -> None:
    text = "0.1 5\n-0.2 6\n0.05 7\n"
    motion = read(text, column=1, dt=0.02).motion
    assert motion.dt == 0.02
    assert motion.acceleration == pytest.approx(np.array([0.1, -0.2, 0.05]) * GRAVITY)


def test_zeros_have_no_sign(read) -> None:
    """Fails if a motion has another digest, and so is solved again, where a line is read at once."""
    text = "0.1\n{} 0.2\n-0.3\n0.05D0\n"
    plain, signed = (read(text.format(zero), dt=0.02).motion for zero in ("0.0", "-0.0"))
    assert signed.digest == plain.digest
    assert not np.signbit(signed.acceleration[1])


@pytest.mark.parametrize("word", ["1_0", "0x1", "1e", "infinity"])
def test_only_plain_numbers_are_read(read, word: str) -> None:
    with pytest.raises(InputError, match=f"2:5: '{word}' is not a"):
        read(f"0.1 0.2\n0.3 {word}\n", column=1, dt=0.02)


@pytest.mark.parametrize("head", ["t, ms; a, g", "time (msec); acc", "time; acc\nms; g"])
def test_times_in_milliseconds_in_any_spelling(read, head: str) -> None:
    assert read(f"{head}\n0; 0.1\n5; 0.2\n10; 0.1\n").motion.dt == 0.005


def test_times_in_milliseconds(read) -> None:
    assert read("t (ms), a (g)\n0, 0.1\n5, 0.2\n10, 0.1\n").motion.dt == 0.005


def test_times_rounded_to_their_last_digit_are_even(read) -> None:
    """1/256 s printed with three decimals: no step differs by more than the digit that is not printed."""
    times = np.arange(500) / 256
    text = "".join(f"{t:.3f} {np.sin(t):.5f}\n" for t in times)
    assert read(text).motion.dt == pytest.approx(1 / 256, rel=3e-4)
    assert read(text, dt=1 / 256).motion.dt == 1 / 256, "the step given is the exact one"
    without = [line for place, line in enumerate(text.splitlines(keepends=True)) if place != 250]
    with pytest.raises(InputError, match=r"251:1: uneven time steps: 0\.007 s here, 0\.004 s"):
        read("".join(without))


@pytest.mark.parametrize(
    "line", ["dt = 0.005\n", "Time step: 0.005 s\n", "# dt: 0.005 s\n", "sampling interval (s) 5 ms\n"]
)
def test_a_time_step_in_the_heading_of_one_column(read, line: str) -> None:
    assert read(f"{line}0.1\n0.2\n").motion.dt == 0.005


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        ("t (s), v (cm/s)\n0,1\n0.01,2\n", {}, "1:1: the file holds velocity"),
        ("time, velocity\n0,1\n0.01,2\n", {}, "1:1: the file holds velocity"),
        ("t (s), u (cm)\n0,1\n0.01,2\n", {}, "1:1: the file holds displacement"),
        ("time, cm/s\n0,1\n0.01,2\n", {}, "1:1: the file holds velocity"),
        ("# unit: counts\n0 1\n0.01 2\n", {}, "1:1: the file holds recorder counts"),
        ("# unit: furlong\n0 1\n0.01 2\n", {}, "1:1: unknown unit 'furlong'"),
        ("0 8009\n0.01 8007\n", {}, "recorder counts need their scale"),
        ("0 0.1\n0.01 nan\n", {}, "2:6: 'nan' is not a finite number"),
        ("0 0.1\n0.01 inf\n", {}, "2:6: 'inf' is not a finite number"),
        ("0 0.1\n0.01 ****\n", {}, "2:6: '****' is not a finite number"),
        ("0 0.1\n0.01 1e999\n", {}, "2:6: '1e999' is not a finite number"),
        ("0 0.1\n1e7 0.2\n", {}, "the time 1e+07 s is not a valid time"),
        ("0 0.1\n20 0.2\n", {}, "the time step is 20"),
        ("0 1 2\n0.01 2\n0.02 3 4\n", {"column": 2}, "2:1: 2 values on this line, where every other has 3"),
        ("0 1\n0.01 2\n", {"format": "table"}, "format 'table' needs a column"),
    ],
)
def test_refused(read, text: str, options: dict, said: str) -> None:
    with pytest.raises(InputError) as caught:
        read(text, **options)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("written", "in_si"),
    [
        ("G", 9.80665), ("g", 9.80665), ("mg", 9.80665e-3), ("g/10", 0.980665), ("%g", 0.0980665),
        ("0.01 g", 0.0980665),
        ("M/S2", 1.0), ("m/s/s", 1.0), ("m/s^2", 1.0), ("m s-2", 1.0), ("m/sec**2", 1.0), ("m/s²", 1.0),
        ("cm/sec/sec", 0.01), ("CM/SEC2.", 0.01), ("cm/s**2", 0.01), ("Gal", 0.01), ("mGal", 1e-5), ("mm/s2", 1e-3),
        ("in/sec^2", 0.0254), ("ft/s/s", 0.3048), ("3920/6182761 gal", 39.2 / 6182761),
        ("6.34e-4 gal", 6.34e-6), ("µg", 9.80665e-6), ("g's", 9.80665), ("meters/sec2", 1.0), ("m.s-2", 1.0),
    ],
)  # fmt: skip
def test_units_in_any_spelling(written: str, in_si: float) -> None:
    assert acceleration_unit(written) == pytest.approx(in_si, rel=1e-12)


@pytest.mark.parametrize(
    "written", ["", "m", "m/s", "cm/s", "counts", "kg", "g/s", "0 g", "g/0", "1/0 g", "s2", "m/s3", "1e400 g", "2"]
)
def test_no_units_of_acceleration(written: str) -> None:
    assert acceleration_unit(written) is None


def test_every_named_unit_is_one() -> None:
    for name, in_si in UNITS.items():
        assert acceleration_unit(name) == in_si

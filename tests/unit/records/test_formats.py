"""Files in every published layout read to the very samples they were written from, and refused for what is wrong."""

import math
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.records import GRAVITY, Reading, read_file
from tests.helpers import motion_layouts as layouts

CM = layouts.samples(60.0)
IN_G = layouts.samples(0.3)
NINE = layouts.samples(9.9)
V1_WORDS = "    43 Accelerogram points at 50 pts/sec in units of g .      Format: (8f9.5)"
SAYS_ALL = "43 points of accel data equally spaced at .010 sec, in cm/sec/sec (8f9.5)"
COUNTS = [round(40000 * math.sin(0.3 * i) * math.exp(-0.02 * i)) + 8009 for i in range(100)]


@pytest.fixture
def read(tmp_path: Path):
    def write_and_read(text: str | bytes, name: str = "motion.txt", **options) -> Reading:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_file(path, **options)

    return write_and_read


def told(read, text: str | bytes, **options) -> str:
    """The refusal of a file: `line: message | hint`."""
    with pytest.raises(InputError) as caught:
        read(text, **options)
    (problem,) = caught.value.problems
    assert problem.file.endswith("motion.txt")
    assert problem.hint
    return f"{problem.line}: {problem.message} | {problem.hint}"


WHOLE = {
    "at2": (layouts.at2(IN_G), "at2", np.array(IN_G) * GRAVITY, 0.02),
    "at2 in cm/s2": (layouts.at2(CM, "CM/SEC/SEC"), "at2", np.array(CM) * 0.01, 0.02),
    "esm": (layouts.esm(CM), "esm", np.array(CM) * 0.01, 0.02),
    "esm in m/s2": (layouts.esm(IN_G, "m/s2", peak=0.0), "esm", np.array(IN_G), 0.02),
    "smc": (layouts.smc(CM), "smc", np.array([float(f"{v:.3E}") for v in CM]) * 0.01, 0.02),
    "smc uncorrected": (
        layouts.smc(CM, "1 UNCORRECTED ACCELEROGRAM"), "smc", np.array([float(f"{v:.3E}") for v in CM]) * 0.01, 0.02,
    ),
    "cosmos": (layouts.cosmos_channel(CM), "cosmos", np.array(CM) * 0.01, 0.02),
    "cosmos in g": (layouts.cosmos_channel(IN_G, unit=("g", 2)), "cosmos", np.array(IN_G) * GRAVITY, 0.02),
    "cosmos, one a line": (
        layouts.cosmos_channel(CM, form=("(1E15.6)", "15.6E", 1)), "cosmos", np.array(CM) * 0.01, 0.02,
    ),
    "cosmos, touching": (
        layouts.cosmos_channel(NINE, form=("(10F8.5)", "8.5f", 10)), "cosmos", np.array(NINE) * 0.01, 0.02,
    ),
    "csmip V2": (layouts.csmip_v2_channel(CM), "csmip", np.array(CM) * 0.01, 0.02),
    "csmip V2 in capitals": (layouts.csmip_v2_channel(CM, upper=True), "csmip", np.array(CM) * 0.01, 0.02),
    "csmip V2 in g": (layouts.csmip_v2_channel(IN_G, unit="in g."), "csmip", np.array(IN_G) * GRAVITY, 0.02),
    "csmip V2, no unit": (layouts.csmip_v2_channel(CM, unit=""), "csmip", np.array(CM) * 0.01, 0.02),
    "csmip V1": (
        layouts.csmip_v1_channel([round(10 * v, 4) for v in IN_G]), "csmip",
        np.round(10 * np.array(IN_G), 4) * 0.1 * GRAVITY, 0.02,
    ),
    "csmip V1 behind words": (
        layouts.csmip_v1_channel(IN_G, unit="Units of uncor data are sec and g .", words_line=V1_WORDS), "csmip",
        np.array(IN_G) * GRAVITY, 0.02,
    ),
    "csmip V1 behind words that say all": (
        layouts.csmip_v1_channel(CM, unit="", words_line=SAYS_ALL), "csmip", np.array(CM) * 0.01, 0.01,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WHOLE)
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_whole(read, name: str, ends: str) -> None:
    text, format, wanted, dt = WHOLE[name]
    reading = read(text.replace("\n", ends))
    assert (reading.format, reading.unit_from) == (format, "the file")
    assert reading.motion.dt == dt
    assert reading.motion.acceleration == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def test_knet_counts_become_gal_about_their_mean(read) -> None:
    motion = read(layouts.knet(COUNTS)).motion
    counts = np.array(COUNTS, dtype=float)
    assert motion.dt == 0.01
    assert motion.acceleration == pytest.approx((counts - counts.mean()) * 3920 / 6182761 * 0.01, rel=1e-12, abs=1e-12)
    assert abs(motion.acceleration.mean()) < 1e-12


def test_a_latin_name_in_an_old_file_is_read(read) -> None:
    assert read(layouts.esm(CM).encode("latin-1")).motion.acceleration == pytest.approx(np.array(CM) * 0.01)


def test_cosmos_falls_back_on_the_recorders_own_step(read) -> None:
    assert read(layouts.cosmos_channel(CM, step_ms=-999.0)).motion.dt == 0.005


def test_cosmos_as_its_own_document_writes_it(read) -> None:
    """The example of the format's document: six reals a line, the unit's code in brackets, another word for channel."""
    text = layouts.cosmos_channel(CM)
    head, rest = text.split(" 100 Real-header")
    reals = layouts.rows([float(word) for line in rest.splitlines()[1:21] for word in line.split()], "13.6f", 6)
    tail = rest.split("(5F15.6)\n")[1].split("\n", 20)[20]
    text = head + " 100 Real-header values follow on  17 lines, Format= (6F13.6)\n" + reals + tail
    text = text.replace("units=cm/s^2 (4),", "units=cm/sec2(04),").replace("Sta Chan   1:", "Sta Cha:  1:")
    assert read(text).motion.digest == read(layouts.cosmos_channel(CM)).motion.digest
    assert "1: 1: 90 deg; 2: 1: 90 deg" in told(read, text + text)


CHANNELS = {
    "cosmos": [layouts.cosmos_channel(layouts.samples(60.0, seed=s), c) for c, s in ((1, 1.0), (2, 1.3), (3, 0.7))],
    "csmip V2": [
        layouts.csmip_v2_channel(layouts.samples(60.0, seed=s), c, label)
        for c, s, label in ((1, 1.0, "90 Deg"), (2, 1.3, "Up"), (3, 0.7, "360 Deg"))
    ],
    "csmip V1": [
        layouts.csmip_v1_channel([round(v, 4) for v in layouts.samples(3.0, seed=s)], c, label)
        for c, s, label in ((1, 1.0, "90 DEG"), (2, 1.3, "UP"), (3, 0.7, "360 DEG"))
    ],
}


LABELS = {
    "cosmos": "1: 1: 90 deg; 2: 2:180 deg; 3: 3:270 deg",
    "csmip V2": "1: 1: 90 Deg; 2: 2: Up; 3: 3: 360 Deg",
    "csmip V1": "1: 1: 90 DEG; 2: 2: UP; 3: 3: 360 DEG",
}


@pytest.mark.parametrize("name", CHANNELS)
def test_of_several_channels_one_is_named(read, name: str) -> None:
    text = "".join(CHANNELS[name])
    said = told(read, text)
    assert f"3 channels of acceleration: {LABELS[name]}" in said
    assert "--channel 1" in said
    for place, alone in enumerate(CHANNELS[name], 1):
        motion = read(text, channel=place).motion
        assert motion.digest == read(alone).motion.digest
    assert "there is no channel 4" in told(read, text, channel=4)


def test_series_of_velocity_between_channels_are_passed_over(read) -> None:
    text = layouts.cosmos_channel(CM, 1) + layouts.cosmos_channel(CM, 1, "velocity", ("cm/s", 5))
    assert read(text).motion.acceleration == pytest.approx(np.array(CM) * 0.01)


REFUSED = {
    "at2 of velocity": (layouts.at2(CM, "CM/S", "VELOCITY"), {}, "3: the file holds velocity, not acceleration"),
    "at2 of displacement": (layouts.at2(CM, "CM", "DISPLACEMENT"), {}, "3: the file holds displacement"),
    "at2 in a unit of velocity": (layouts.at2(CM, "CM/S"), {}, "3: the file holds velocity"),
    "at2 against the unit given": (layouts.at2(IN_G), {"unit": "gal"}, "3: the unit is given as gal, but the file"),
    "at2 cut short": (layouts.at2(IN_G, count=44), {}, "4: the header says NPTS = 44, but 43 values follow"),
    "at2 in counts": (layouts.at2(CM, "COUNTS"), {}, "3: the file holds recorder counts, and no scale"),
    "knet without a scale": (layouts.knet(COUNTS, scale=""), {}, "14: the scale factor is '': the counts have no unit"),
    "knet with another scale": (
        layouts.knet(COUNTS, scale="7840(gal)/6182761"), {}, "15: the header says a maximum of 2",
    ),
    "knet cut short": (layouts.knet(COUNTS, duration="2"), {}, "12: the header says duration x frequency = 200"),
    "knet of no frequency": (layouts.knet(COUNTS, frequency="fast"), {}, "11: the sampling frequency is 'fast'"),
    "knet of another step": (layouts.knet(COUNTS), {"dt": 0.02}, "11: dt is given as 0.02 s, but the file says 0.01 s"),
    "esm of velocity": (layouts.esm(CM, quantity="VELOCITY"), {}, "30: the file holds velocity"),
    "esm in cm/s": (layouts.esm(CM, "cm/s"), {}, "18: the file holds velocity"),
    "esm in counts": (layouts.esm(CM, "counts"), {}, "18: the file holds recorder counts"),
    "esm cut short": (layouts.esm(CM, count=50), {}, "15: the header says NDATA = 50, but 43 values follow"),
    "esm of another peak": (layouts.esm(CM, peak=99.0), {}, "22: the header says a peak of 99 cm/s2"),
    "esm without interval": (
        layouts.esm(CM).replace("SAMPLING_INTERVAL_S: 0.020000", "SAMPLING_INTERVAL_S: "), {}, "14: the header does",
    ),
    "smc of velocity": (layouts.smc(CM, "3 VELOCITY"), {}, "1: the file holds velocity"),
    "smc of spectra": (layouts.smc(CM, "5 RESPONSE SPECTRA"), {}, "1: the file holds response spectra"),
    "smc of uneven steps": (layouts.smc(CM, rate=None), {}, "18: the header gives no sampling rate"),
    "smc with a flag": (layouts.smc(CM, flag=1), {}, "14: the record is flagged as faulty"),
    "smc cut short": (layouts.smc(CM, count=60), {}, "35: 3 values on this line, where 8 should stand"),
    "smc with values left over": (layouts.smc(CM, count=16), {}, "32: more than the 16 values that the header says"),
    "cosmos in counts": (
        layouts.cosmos_channel(COUNTS[:43], unit=("counts", 50), form=("(10I8)", "8d", 10)), {},
        "49: the file holds recorder counts, and no scale",
    ),
    "cosmos of velocity": (
        layouts.cosmos_channel(CM, 1, "velocity", ("cm/s", 5)), {}, "49: the file holds velocity",
    ),
    "cosmos cut short": (layouts.cosmos_channel(CM, count=50), {}, "3 values on this line, where 8 should stand"),
    "cosmos with values left over": (layouts.cosmos_channel(CM, count=40), {}, "more than the 40 values"),
    "cosmos without reals": (
        layouts.cosmos_channel(CM).replace("Real-header", "Unreal"), {}, "25: no line that says how many real header",
    ),
    "cosmos with nan": (
        layouts.cosmos_channel(CM).replace(f"{CM[1]:10.5f}", "       NaN"), {}, "'NaN' is not a finite number",
    ),
    "csmip V3": ("RESPONSE AND FOURIER AMPLITUDE SPECTRA\nCORRECTED ACCELEROGRAM\n", {}, "1: the file holds spectra"),
    "csmip V2 without series": ("CORRECTED ACCELEROGRAM\nwords\n", {}, "1: no line that says how many points"),
    "csmip V2 cut short": (layouts.csmip_v2_channel(CM, count=60), {}, "where 8 should stand"),
    "csmip V1 uneven": (
        layouts.csmip_v1_channel(
            [round(v, 4) for v in IN_G], times=[round(0.02 * i + (0.007 if i > 20 else 0.0), 4) for i in range(43)]
        ), {}, "32: uneven time steps: 0.027 s here, 0.02 s elsewhere | download the corrected record (V2)",
    ),
    "csmip V1 without unit": (
        layouts.csmip_v1_channel(IN_G, unit="words", words_line="words (8f9.5)"), {}, "29: the file does not state",
    ),
    "a channel of plain columns": ("0 0.1\n0.01 0.2\n", {"channel": 2}, "0: a file of format 'two-column' has"),
    "a column of an AT2": (layouts.at2(IN_G), {"column": 2}, "0: a file of format 'at2' has no columns"),
    "a zip": (b"PK\x03\x04rest", {}, "0: a zip archive, not a motion | unpack it"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused(read, name: str) -> None:
    text, options, wanted = REFUSED[name]
    assert wanted in told(read, text, **options)


def test_a_v1_file_without_unit_is_read_in_the_one_given(read) -> None:
    text = layouts.csmip_v1_channel(IN_G, unit="words", words_line="words (8f9.5)")
    reading = read(text, unit="g")
    assert reading.unit_from == "you"
    assert reading.motion.acceleration == pytest.approx(np.array(IN_G) * GRAVITY)


def test_counts_are_read_where_the_user_says_what_one_is(read) -> None:
    text = layouts.cosmos_channel(COUNTS[:43], unit=("counts", 50), form=("(10I8)", "8d", 10))
    reading = read(text, unit="3920/6182761 gal")
    assert reading.unit_from == "you"
    assert reading.motion.acceleration == pytest.approx(np.array(COUNTS[:43]) * 3920 / 6182761 * 0.01)

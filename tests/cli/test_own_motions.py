"""Motions of one's own as `pound` shows them: what was taken, doubtful units, steps and peaks, all names."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import pounding_cli
from pounding_cli.cli.main import cli
from pounding_cli.records.motion import spectrum, velocity
from pounding_cli.records.sines import Sine

STUDY = """\
title: own motions
records: {use: §USE, duration: §DURATION, scale: §SCALE}
buildings:
  stiff: {storeys: 1, period: 0.3 s}
  soft: {like: stiff, period: 0.5 s}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 2 cm}}
analyses: [elastic]
estimate: none
"""

A_CSV = "[{file: a.csv, unit: g, time: 1}]"


@pytest.fixture
def motion(tmp_path: Path):
    def write(name: str, head: str = "time [s], acc [g]\n", peak: float = 0.3) -> Path:
        path = tmp_path / name
        rows = (f"{0.02 * i:.2f},{peak * math.sin(math.pi * i / 10):.5f}\n" for i in range(200))
        path.parent.mkdir(exist_ok=True)
        path.write_text(head + "".join(rows), encoding="utf-8")
        return path

    return write


@pytest.fixture
def pound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)

    def run(command: str, use: str, duration: str = "whole", scale: str = "1.0") -> Result:
        text = STUDY.replace("§USE", use).replace("§DURATION", duration).replace("§SCALE", scale)
        Path("study.yaml").write_text(text, encoding="utf-8")
        done = CliRunner().invoke(cli, [command, "study.yaml"], catch_exceptions=False)
        assert done.exit_code == 0, done.output
        return done

    return run


def flat(text: str) -> str:
    """A text with its line breaks taken for blanks."""
    return " ".join(text.split())


@pytest.mark.parametrize("command", ["check", "run"])
def test_what_was_taken_is_told_in_two_lines(motion, pound, command) -> None:
    """Fails if a value, the unit, the peak or the lines that were not read are not told."""
    motion("a.csv", "Scale factor: 2.5\ntime,acc\n", 30.0)
    done = pound(command, "[{file: a.csv, unit: 0.01 g, time: 1}]")
    lines = done.stdout.splitlines() if command == "check" else done.stderr.splitlines()
    place = next(place for place, line in enumerate(lines) if line.startswith("a.csv: "))
    taken = "a.csv: 200 values of column 2, every 0.02 s to 3.98 s, 0.01 g; peak 2.942 m/s2 = 0.3 g at 0.1 s"
    assert lines[place] == taken
    assert lines[place + 1] == "  2 lines not read: 'Scale factor: 2.5', 'time,acc'"


@pytest.mark.parametrize("command", ["check", "run"])
def test_files_of_which_nothing_is_declared_get_one_refusal_with_the_line(motion, pound, command) -> None:
    """Pasted as it stands, it is accepted.  Fails if each of 24 files is refused, or the line names another path."""
    for number in range(24):
        motion(f"set/gm{number:02d}.txt")
    with pytest.raises(pounding_cli.InputError) as caught:
        pound(command, "[set/*.txt]")
    (problem,) = caught.value.issues
    assert "(and so it is with 23 more files)" in problem.message
    line = "{file: set/*.txt, unit: g, time: 1, column: 2}"
    assert problem.hint.endswith(f"\n    {line}")
    done = pound(command, f"[{line}]")
    assert f"{done.stdout}{done.stderr}".count("200 values of column 2") == 20
    assert "and 4 more files" in flat(f"{done.stdout}{done.stderr}")


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_step_that_no_accelerograph_has_is_told(motion, pound, tmp_path, command) -> None:
    rows = "".join(f"{0.2 * i:.1f},{0.3 * math.sin(math.pi * i / 10):.5f}\n" for i in range(200))
    (tmp_path / "a.csv").write_text(f"time [s],acc [g]\n{rows}")
    said = flat(pound(command, "[{file: a.csv, unit: 0.01 g, time: 1}]").stderr)
    assert "a: the time step is 0.2 s, longer than the 0.05 s of any accelerograph" in said
    shown = CliRunner().invoke(cli, ["records", "show", "a.csv", "--unit", "0.01 g", "--time", "1"])
    assert "warning: [time-step] the time step is 0.2 s" in shown.stderr


def test_a_unit_that_the_file_states_otherwise_is_told_with_both(motion, pound, tmp_path) -> None:
    motion("a.csv", "time,a (gal)\n", 0.3)
    said = pound("check", "[{file: a.csv, unit: g, time: 1}]").stderr
    assert "a: read in g, as declared, although the file says gal" in said
    study = pounding_cli.load_study(tmp_path / "study.yaml")
    assert study.motion((), "a").pga == pytest.approx(0.3 * 9.80665, rel=1e-3)
    motion("a.csv", "time,a (gal)\n", 300)
    assert pound("check", "[{file: a.csv, unit: cm/s2, time: 1}]").stderr == ""


@pytest.mark.parametrize("scale", ["9.81", "0.1019716", "980.665"])
def test_a_factor_that_is_a_unit_in_disguise_is_told(motion, pound, scale) -> None:
    """Fails if a file is scaled by g without a word, or if a factor of a catalogue motion is doubted."""
    motion("a.csv", peak=0.001)
    said = flat(pound("check", A_CSV, scale=scale).stderr)
    assert "a unit in disguise" in said
    assert "a unit in disguise" not in pound("check", A_CSV, scale="9.5").stderr
    assert "a unit in disguise" not in pound("check", "[taft]", scale=scale).stderr


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_peak_above_2_g_in_the_file_is_told_unless_it_is_scaled_to_less(motion, pound, command) -> None:
    motion("a.csv", peak=2.9)
    said = pound(command, A_CSV).stderr
    assert "unlikely peaks: a (2.9 g): few motions were ever recorded with more than 2 g" in said
    assert "check `unit:` of its file" in said
    assert "unlikely peaks: a (4.35 g)" in pound(command, A_CSV, scale="1.5").stderr
    for scale in ("0.1", "{pga: 0.3 g}", "{pgv: 40 cm/s}"):
        assert "unlikely peaks" not in pound(command, A_CSV, scale=scale).stderr
    motion("a.csv", peak=1.9)
    assert "unlikely peaks" not in pound(command, A_CSV).stderr
    assert "unlikely peaks" not in pound(command, A_CSV, scale="1.5").stderr, "that factor is the study's own"


@pytest.mark.parametrize(
    ("peak", "duration", "words"),
    [
        (0.3, "10 s", "shorter than the 10 s asked for: "),
        (2.9, "whole", "unlikely peaks: "),
    ],
)
def test_a_warning_about_many_motions_names_all_of_them(motion, pound, peak, duration, words) -> None:
    names = [f"gm{number:02d}" for number in range(24)]
    for name in names:
        motion(f"set/{name}.txt", peak=peak)
    said = pound("check", "[{file: set/, unit: g, time: 1}]", duration).stderr
    assert said.count("warning: ") == 1
    assert words in flat(said)
    assert [name for name in names if f"{name} (" not in flat(said)] == []
    assert " more" not in flat(said).replace("more than 2 g", "")


def test_the_summary_of_a_run_and_a_check_name_all_motions(motion, pound) -> None:
    names = [f"gm{number:02d}" for number in range(24)]
    for name in names:
        motion(f"set/{name}.txt")
    run, checked = (
        flat(pound("run", "[{file: set/, unit: g, time: 1}]").stdout),
        pound("check", "[{file: set/, unit: g, time: 1}]").stdout,
    )
    assert f"Motions: user: {', '.join(names)}" in run
    assert [name for name in names if f"\n  {name} " not in checked] == []


def test_sines_swing_an_oscillator_as_the_closed_form(tmp_path: Path) -> None:
    """From rest: u = -A / (w^2 - W^2) (sin W t - W / w sin w t).  Fails by a wrong amplitude, frequency or length."""
    use = "[{sine: {from: 1.5 Hz, to: 3 Hz, step: 1.5 Hz}, amplitude: 0.2 g, cycles: 6}]"
    text = STUDY.replace("§USE", use).replace("§DURATION", "whole").replace("§SCALE", "1.0")
    text = text.replace("0.3 s}", "0.3 s, damping: 0 %, yield_shear: never}").replace("2 cm", "1 m")
    study = tmp_path / "sines.yaml"
    study.write_text(text, encoding="utf-8")
    floors = pounding_cli.run(study, tmp_path / "sines.h5").floor().set_index(["building", "record"])
    for building, period in (("stiff", 0.3), ("soft", 0.5)):
        for frequency in (1.5, 3.0):
            own, forced = 2 * math.pi / period, 2 * math.pi * frequency
            times = np.linspace(0.0, 6 / frequency, 200_001)
            factor = 0.2 * 9.80665 / (own**2 - forced**2)
            swing = factor * (np.sin(forced * times) - forced / own * np.sin(own * times))
            displacement = floors.loc[(building, f"sine {frequency:g} Hz"), "displacement"]
            assert displacement == pytest.approx(np.abs(swing).max(), rel=2e-4)


def test_a_half_cycle_is_a_pulse() -> None:
    """Its area is the change of velocity 2 A / (2 pi f)."""
    motion = Sine(frequency=5.0, amplitude=3.0, cycles=0.5).build_motion()
    assert motion.duration == pytest.approx(0.1)
    assert velocity(motion)[-1] == pytest.approx(3.0 / (math.pi * 5.0), rel=1e-4)


def test_a_ramp_leaves_the_steady_motion() -> None:
    """Response over static: 1 / sqrt((1 - r^2)^2 + (2 z r)^2).  Fails where the start from rest decides."""
    motion = Sine(frequency=1.2, amplitude=1.0, cycles=120, ramp=80).build_motion()
    ratio = 1.2 * 0.5
    steady = 1.0 / math.hypot(1.0 - ratio**2, 2.0 * 0.05 * ratio)
    assert spectrum(motion, [0.5], 0.05)[0] == pytest.approx(steady, rel=2e-3)
    assert spectrum(Sine(1.2, 1.0, 120).build_motion(), [0.5], 0.05)[0] > 1.2 * steady


def test_a_motion_may_have_a_dot_in_its_name(motion, pound) -> None:
    """Fails if a name that is only a label is refused, or is cut at its dot in results or files."""
    motion("sine.txt")
    said = flat(pound("run", "[{file: sine.txt, name: 1.25 Hz, unit: g, time: 1}]").stdout)
    assert "Motions: user: 1.25 Hz" in said
    results = pounding_cli.open_results("results/study.h5")
    assert set(results.storey()["record"]) == {"1.25 Hz"}


def test_a_part_of_a_steady_motion_is_no_doubt(pound) -> None:
    """Fails if it is warned that strong shaking is cut off, which a sine has all along."""
    done = pound("check", "[{sine: 2 Hz, amplitude: 0.1 g, cycles: 40}]", duration="5 s")
    assert "Arias intensity of" not in flat(done.output)

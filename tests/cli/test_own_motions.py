"""Motions of one's own as `pound` shows them: the unit that was read, doubtful steps and peaks, all names."""

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


@pytest.fixture
def motion(tmp_path: Path):
    def write(name: str, head: str = "time [s], acc [g]\n", peak: float = 0.3) -> Path:
        path = tmp_path / name
        rows = (f"{0.02 * i:.2f},{peak * math.sin(0.3 * i):.5f}\n" for i in range(200))
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


@pytest.mark.parametrize(
    ("head", "unit", "in_g"),
    [("time, m/s2\n", "m/s2", 9.80665), ("time,acc (gal)\n", "gal", 980.665), ("Accel, mg\n", "mg", 1000.0)],
)
def test_the_unit_over_the_column_is_that_of_the_motion(motion, pound, tmp_path, head, unit, in_g) -> None:
    motion("a.csv", head, 0.3 * in_g)
    done = pound("check", "[a.csv]")
    assert done.stderr == ""
    study = pounding_cli.load_study(tmp_path / "study.yaml")
    assert study.motion((), "a").pga == pytest.approx(0.3 * 9.80665, rel=1e-3)
    shown = CliRunner().invoke(cli, ["records", "show", str(tmp_path / "a.csv")]).output
    assert f"in {unit} (as the file says)" in shown


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("", "no line says in which unit the values are"),
        ("time,furlongs\n", "'furlongs' names no unit of acceleration"),
        ("# acceleration (stones)\n# Component 90\n", "'acceleration (stones)' names no unit of acceleration"),
        ("# PGA 0.3 g\n", "'PGA 0.3 g' speaks of one number"),
    ],
)
def test_a_file_that_does_not_state_its_unit_needs_one(motion, pound, command, head, said) -> None:
    motion("a.csv", head)
    with pytest.raises(pounding_cli.InputError) as caught:
        pound(command, "[a.csv]")
    assert said in str(caught.value)
    assert "`unit: m/s2` beside the file in a study" in flat(str(caught.value))
    assert "furlongs" not in pound("check", "[{file: a.csv, unit: g}]").stderr


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_step_that_no_accelerograph_has_is_told(motion, pound, tmp_path, command) -> None:
    rows = "".join(f"{i},{0.3 * math.sin(0.3 * i):.5f}\n" for i in range(200))
    (tmp_path / "a.csv").write_text(f"time [s],acc [g]\n{rows}")
    said = flat(pound(command, "[a.csv]").stderr)
    assert "a: the time step is 1 s, longer than the 0.05 s of any accelerograph" in said
    assert "write `dt: 0.01 s` beside `file:`" in said
    shown = CliRunner().invoke(cli, ["records", "show", "a.csv"])
    assert "warning: the time step is 1 s" in shown.stderr


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_step_of_the_header_that_the_times_do_not_have_is_told(motion, pound, tmp_path, command) -> None:
    rows = "".join(f"{0.02 * i:.2f},{0.3 * math.sin(0.3 * i):.5f}\n" for i in range(200))
    (tmp_path / "a.csv").write_text(f"dt: 0.01 s\ntime [s],acc [g]\n{rows}")
    said = flat(pound(command, "[a.csv]").stderr)
    assert "a: line 1 says a time step of 0.01 s, but the times rise by 0.02 s, which is used" in said
    assert "write `dt: 0.02 s` beside the file" in said
    shown = CliRunner().invoke(cli, ["records", "show", "a.csv"])
    assert "warning: line 1 says a time step of 0.01 s" in shown.stderr
    assert "0.01 s" not in pound(command, "[{file: a.csv, dt: 0.02 s}]").stderr


def test_a_unit_in_the_study_comes_before_the_heading_and_the_difference_is_told(motion, pound, tmp_path) -> None:
    motion("a.csv", "time, gal\n", 0.3)
    said = pound("check", "[{file: a.csv, unit: g}]").stderr
    assert "a: read in g, as the study says, although the file says gal" in said
    study = pounding_cli.load_study(tmp_path / "study.yaml")
    assert study.motion((), "a").pga == pytest.approx(0.3 * 9.80665, rel=1e-3)
    motion("a.csv", "time, gal\n", 300)
    assert pound("check", "[{file: a.csv, unit: cm/s2}]").stderr == ""


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_peak_above_2_g_in_the_file_is_told_unless_it_is_scaled_to_less(motion, pound, command) -> None:
    motion("a.csv", peak=2.9)
    said = pound(command, "[a.csv]").stderr
    assert "unlikely peaks: a (2.9 g): few motions were ever recorded with more than 2 g" in said
    assert "check `unit:` of its file" in said
    assert "unlikely peaks: a (4.35 g)" in pound(command, "[a.csv]", scale="1.5").stderr
    for scale in ("0.1", "{pga: 0.3 g}", "{pgv: 40 cm/s}"):
        assert "unlikely peaks" not in pound(command, "[a.csv]", scale=scale).stderr
    motion("a.csv", peak=1.9)
    assert "unlikely peaks" not in pound(command, "[a.csv]").stderr
    assert "unlikely peaks" not in pound(command, "[a.csv]", scale="1.5").stderr, "that factor is the study's own"


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
    said = pound("check", "[set/]", duration).stderr
    assert said.count("warning: ") == 1
    assert words in flat(said)
    assert [name for name in names if f"{name} (" not in flat(said)] == []
    assert " more" not in flat(said).replace("more than 2 g", "")


def test_the_summary_of_a_run_and_a_check_name_all_motions(motion, pound) -> None:
    names = [f"gm{number:02d}" for number in range(24)]
    for name in names:
        motion(f"set/{name}.txt")
    run, checked = flat(pound("run", "[set/]").stdout), pound("check", "[set/]").stdout
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
    said = flat(pound("run", "[{file: sine.txt, name: 1.25 Hz}]").stdout)
    assert "Motions: user: 1.25 Hz" in said
    results = pounding_cli.open_results("results/study.h5")
    assert set(results.storey()["record"]) == {"1.25 Hz"}


def test_a_part_of_a_steady_motion_is_no_doubt(pound) -> None:
    """Fails if it is warned that strong shaking is cut off, which a sine has all along."""
    done = pound("check", "[{sine: 2 Hz, amplitude: 0.1 g, cycles: 40}]", duration="5 s")
    assert "Arias intensity of" not in flat(done.output)

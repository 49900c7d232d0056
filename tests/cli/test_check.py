"""`pound check` and `pound plan`: one line for a sound study, every problem for another, nothing written."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from pounding_cli.cli.main import cli
from pounding_cli.errors import InputError

CONFIGS = sorted(Path("configs").rglob("*.yaml"))


@pytest.mark.parametrize("path", CONFIGS, ids=str)
def test_shipped_studies_are_sound(path):
    result = CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False)
    assert result.exit_code == 0
    assert result.stdout.startswith(f"OK: {path}: ")


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("configs/fig5.yaml", "a study of `pound connector`, 2 points to compute"),
        ("configs/fig8.yaml", "a study of `pound wall`, 8 points to compute"),
    ],
)
def test_studies_of_the_other_systems(path, said):
    result = CliRunner().invoke(cli, ["check", path], catch_exceptions=False)
    assert (result.exit_code, result.output) == (0, f"OK: {path}: {said}\n")
    with pytest.raises(InputError) as refused:
        CliRunner().invoke(cli, ["run", path], catch_exceptions=False)
    (problem,) = refused.value.problems
    command = said.split("`")[1]
    assert (problem.message, problem.hint) == (f"is a study of `{command}`", f"write `{command} {path}`")


@pytest.mark.parametrize(
    ("given", "path", "right"),
    [
        ("wall", "configs/fig6.yaml", "run"),
        ("wall", "configs/fig5.yaml", "connector"),
        ("connector", "configs/fig8.yaml", "wall"),
    ],
)
def test_a_command_given_another_s_study_names_the_right_one(given, path, right):
    with pytest.raises(InputError) as refused:
        CliRunner().invoke(cli, [given, path], catch_exceptions=False)
    assert [problem.hint for problem in refused.value.problems] == [f"write `pound {right} {path}`"]


def test_faults_of_the_other_systems_are_told(tmp_path):
    path = tmp_path / "wall.yaml"
    path.write_text("striker: {mass: 200 kg m}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"wall\.yaml:1:17"):
        CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False)


def test_counts():
    result = CliRunner().invoke(cli, ["check", "configs/fig7.yaml"], catch_exceptions=False)
    assert "6 cases x 2 analyses x 5 records = 60 rows from 80 scenes" in result.output


def test_refused_study(tmp_path):
    """Through the real command: exit code 2, every problem on the screen, no traceback, no file."""
    path = tmp_path / "bad.yaml"
    path.write_text("titel: x\nrecords: {use: [elcentroo]}\n", encoding="utf-8")
    code = "from pounding_cli.cli.main import main; main()"
    done = subprocess.run([sys.executable, "-c", code, "check", str(path)], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert f"{path}:1:1: unknown key 'titel'" in done.stderr
    assert f"{path}:2:17: no motion 'elcentroo'" in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == [path]


def test_missing_study():
    with pytest.raises(InputError, match="no such file"):
        CliRunner().invoke(cli, ["check", "nowhere.yaml"], catch_exceptions=False)


def test_warning_is_no_refusal(tmp_path):
    text = Path("configs/quickstart.yaml").read_text(encoding="utf-8") + "\nimpact: {dashpot: printed}\n"
    path = tmp_path / "a.yaml"
    path.write_text(text, encoding="utf-8")
    result = CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False)
    assert result.exit_code == 0
    assert "warning:" in result.output
    assert "eq. (7)" in result.output


def test_plan_shows_what_is_shared():
    result = CliRunner().invoke(cli, ["plan", "configs/fig7.yaml"], catch_exceptions=False)
    assert result.exit_code == 0
    assert "soft-1 | stiff | soft-2" in result.output
    assert "180 baselines asked for, 20 run" in result.output
    assert "4 x connector, gap 7 cm" in result.output


def test_plan_says_why_an_effect_is_dropped():
    """60 scenes: half elastic; 20 pounding, 30 infill, 10 connector."""
    result = CliRunner().invoke(cli, ["plan", "configs/fig6.yaml"], catch_exceptions=False)
    lines = {" ".join(line.split()) for line in result.output.splitlines()}
    assert "yielding storeys simulated in 30; left out in 30: the analysis is elastic" in lines
    assert "pounding links simulated in 20; left out in 40: the case has none" in lines
    assert "infill links simulated in 30; left out in 30: the case has none" in lines
    assert "foundation motions left out in 60: every base is fixed" in lines


def test_plan_shows_the_sweep():
    result = CliRunner().invoke(cli, ["plan", "configs/sensitivity/restitution.yaml"], catch_exceptions=False)
    assert "impact.restitution: 0.4; 0.5; 0.65" in result.output


def test_neither_needs_the_solver():
    """Checking a study imports no numba, matplotlib, pandas or h5py: it stays quick."""
    code = (
        "import sys\nfrom click.testing import CliRunner\nfrom pounding_cli.cli.main import cli\n"
        "r = CliRunner().invoke(cli, ['check', 'configs/fig6.yaml'])\nassert r.exit_code == 0, r.output\n"
        "print([m for m in ('numba', 'matplotlib', 'pandas', 'h5py') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("fragility: {limits: [mu > 4 in soft storey 9]}", "13:22: 'mu > 4 in soft storey 9': the highest is 5"),
        ("sensitivity: {outputs: [mu in tall]}", "13:25: 'mu in tall': no building 'tall' in the group"),
    ],
)
def test_what_a_section_asks_is_checked(tmp_path, section, said):
    """As the command of that section would refuse it. Fails if `pound check` leaves the section aside."""
    study = """\
records: {use: [elcentro]}
buildings:
  stiff: {storeys: 5, period: 0.36 s}
  soft: {like: stiff, period: 0.60 s}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 1 cm}}
sweep:
  records.scale.pga: [0.1 g, 0.2 g]
uncertain:
  impact.restitution: {uniform: {from: 0.4, to: 0.65}}
  buildings.soft.hardening: {uniform: {from: 0.02, to: 0.1}}

"""
    path = tmp_path / "s.yaml"
    path.write_text(study.replace("use: [elcentro]", "use: [elcentro], scale: {pga: 0.3 g}") + section + "\n")
    with pytest.raises(InputError) as error:
        CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False)
    assert any(said in str(problem) for problem in error.value.problems)

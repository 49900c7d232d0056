"""`pound check`: what runs, what needs no run, what is dropped and why."""

from __future__ import annotations

import contextlib
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from pounding_cli import explain_run, load_study, open_results, run
from pounding_cli.batch import forecast
from pounding_cli.batch.cache import Cache
from pounding_cli.cli.main import cli
from pounding_cli.solver import kernels
from pounding_cli.study import make_plan
from tests.night import NIGHTLY

from .conftest import TWO

STUDY = TWO.replace("5 mm", "1 cm")
WIDE = STUDY.replace("gap: 1 cm", "gap: 50 cm")


def checked() -> str:
    result = CliRunner().invoke(cli, ["check", "two.yaml"], catch_exceptions=False)
    assert result.exit_code == 0
    return result.output


def test_scenes_and_effects(folder):
    """Fails if a check says something else than the run then does."""
    (folder / "two.yaml").write_text(WIDE)
    said = checked()
    assert re.search(r"\n +8 of a building alone\n", said)
    assert re.search(r"\n +8 of the group\n", said)
    assert re.search(r"yielding storeys +simulated in 4; left out in 4: the analysis is elastic", said)


def test_a_check_solves_and_compiles_nothing(folder, tmp_path):
    """Fails if a check loads the solver, or tells a time where the solver is not compiled yet."""
    empty = tmp_path / "no kernels"
    code = (
        "import sys; from click.testing import CliRunner; from pounding_cli.cli.main import cli\n"
        "done = CliRunner().invoke(cli, ['check', 'two.yaml'], catch_exceptions=False)\n"
        "print(done.output, [name for name in ('numba', 'pandas', 'xarray') if name in sys.modules])"
    )
    env = os.environ | {"NUMBA_CACHE_DIR": str(empty)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=env)
    said, _, loaded = done.stdout.strip().rpartition("\n")
    assert loaded.strip() == "[]"
    assert "the solver is not compiled on this computer yet; the first run compiles for about 20 s" in said
    assert not empty.exists()
    assert not Path("results").exists()


def standing(*options: str) -> str:
    """Return what a check says of `pound run`."""
    said = CliRunner().invoke(cli, ["check", "two.yaml", *options], catch_exceptions=False).stdout
    return re.search(r"pound run +(.*)", said)[1]


def causes(*options: str) -> list[str]:
    """Return what a check says makes time histories of `pound run` new."""
    said = CliRunner().invoke(cli, ["check", "two.yaml", *options], catch_exceptions=False).stdout
    below = said.split("commands ")[1].split(" was written:\n")
    if len(below) < 2:
        return []
    lines = below[1].split("\n    reused:")[0].replace("\n        ", " ").splitlines()
    return [line.strip() for line in lines]


def test_a_check_knows_what_is_solved_already(folder, pound):
    """Fails if a check counts otherwise than the next run, or gives another reason than the change that was made."""

    def solves(expected: int) -> None:
        said = standing()
        assert f"; {16 - expected} solved, {expected} to solve" in said
        code, out, _ = pound("run", "two.yaml")
        assert code == 0
        assert f"Time histories: {expected} solved, {16 - expected} reused" in out

    study = Path("two.yaml")
    assert "16 time histories; 0 solved, 16 to solve; 16 never run: results/two.h5 does not exist; " in standing()
    solves(16)
    assert standing() == "16 time histories, all solved: results/two.h5 is current"
    assert "16 never run: other.h5 does not exist" in standing("-o", "other.h5")
    study.write_text(study.read_text().replace("1 cm", "12 mm"))
    assert causes() == ["cases.gap.gap 1 cm -> 12 mm: 4 time histories of case gap"]
    solves(4)
    study.write_text(study.read_text() + "accuracy: 1e-5\n")
    assert causes() == ["accuracy 1e-6 -> 1e-5: all 16 time histories"]
    solves(16)
    Path("results/two.h5").unlink()
    assert "16 solved, 0 to solve; about " in standing()
    solves(0)
    study.write_text(study.read_text().replace("12 mm", "13 mm"))
    Path("results/two.h5.cache").unlink()
    assert "16 not known: results/two.h5.cache, the cache of results/two.h5, does not exist" in standing()
    Path("results/two.h5.cache").write_text("no database")
    assert "16 not known: results/two.h5.cache is damaged" in standing()
    assert Path("results/two.h5.cache").read_text() == "no database"


SOFTER = ("period: 0.5 s", "period: 0.6 s")
WIDER = ("gap: 1 cm", "gap: 2 cm")
THIRD = ("cases:\n", "cases:\n  third: {link: connector, gap: 3 cm}\n")
GAPS = ("estimate: none\n", "estimate: none\nsweep: {cases.gap.gap: [1 cm, 2 cm]}\n")
STIFFNESSES = ("period: 0.5 s", "stiffness: [100 MN/m, 80 MN/m]")
OF_SOFT = "buildings.soft.period 0.5 s -> 0.6 s"
OF_GAP = "cases.gap.gap 1 cm -> 2 cm"


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ([WIDER], {OF_GAP: "4 time histories of case gap"}),
        ([SOFTER], {OF_SOFT: "12 time histories: 4 of case touching, 4 of case gap, 4 of soft alone"}),
        (
            [SOFTER, WIDER],
            {
                OF_SOFT: "8 time histories: 4 of case touching, 4 of soft alone",
                f"{OF_SOFT} and {OF_GAP}": "4 time histories of case gap",
            },
        ),
        ([THIRD], {"cases.third (new)": "4 time histories of case third"}),
        ([GAPS], {"sweep (new)": "4 time histories of case gap"}),
        (
            [STIFFNESSES],  # changed back one by one, the study is refused
            {
                "buildings.soft.period 0.5 s -> unset and buildings.soft.stiffness unset -> [100 MN/m, 80 MN/m]": (
                    "12 time histories: 4 of case touching, 4 of case gap, 4 of soft alone"
                )
            },
        ),
        ([("title: Two", "title: 2")], {}),
        (
            [("use: [elcentro, taft]", "use: [weak.txt, taft]")],
            {"records.use [elcentro, taft] -> [weak.txt, taft]": "8"},
        ),
    ],
    ids=["gap", "period", "both", "case", "sweep", "alternatives", "title", "motion"],
)
def test_every_new_time_history_has_the_key_that_made_it_so(folder, pound, changes, expected):
    """Fails if a key is named that changes nothing, or time histories are counted that the next run does not solve."""
    study = Path("two.yaml")
    pound("run", "two.yaml", "-q")
    for old, new in changes:
        assert old in study.read_text()
        study.write_text(study.read_text().replace(old, new, 1))
    if "weak.txt" in study.read_text():
        time = np.arange(0.0, 0.5, 0.01)
        np.savetxt("weak.txt", 0.1 * np.sin(12 * time), header="unit: g\ndt: 0.01 s")
    said = causes()
    assert len(said) == len(expected)
    for line, (reason, histories) in zip(said, expected.items(), strict=True):
        assert line.startswith(f"{reason}: {histories}")
    counted = sum(int(re.search(r": (?:all )?(\d+) time histor", line)[1]) for line in said)
    _, out, _ = pound("run", "two.yaml")
    assert re.search(rf"Time histories: {counted} solved, \d+ reused", out)


def test_changed_samples_of_a_motion_are_the_cause(folder, pound):
    """Fails if a motion file with other samples under the same name is taken for the one before, or is not named."""
    study = Path("two.yaml")
    study.write_text(study.read_text().replace("use: [elcentro, taft]", "use: [weak.txt, strong.txt]"))
    pound("run", "two.yaml", "-q")
    Path("weak.txt").write_text(Path("weak.txt").read_text().replace("\n0.0", "\n0.00", 1))
    np.savetxt("strong.txt", np.linspace(-0.1, 0.3, 50), header="unit: g\ndt: 0.01 s")
    (line,) = causes()
    assert line.startswith("motion strong, other samples: 8 time histories")
    study.write_text(study.read_text().replace(*WIDER))
    told = causes()
    assert [re.sub(" time histor.*", "", line) for line in told] == [
        "motion strong, other samples: 6",
        f"{OF_GAP}: 2",
        f"{OF_GAP} and motion strong, other samples: 2",
    ]
    assert "Time histories: 10 solved, 6 reused" in pound("run", "two.yaml")[1]


def test_another_version_of_the_solver_is_the_cause(folder, pound, monkeypatch):
    pound("run", "two.yaml", "-q")
    monkeypatch.setattr("pounding_cli.results.responses.solver_version", lambda: "0.0+other")
    monkeypatch.setattr("pounding_cli.api.running.solver_version", lambda: "0.0+other")
    said = CliRunner().invoke(cli, ["check", "two.yaml"], catch_exceptions=False).stdout
    assert "another version of the program: all 16 time histories" in said
    assert "Time histories: 16 solved, 0 reused" in pound("run", "two.yaml")[1]


def test_many_changed_keys_are_told_together_where_time_is_short(folder, pound, monkeypatch):
    """Fails if a check takes as long as there are changed keys, or forgets those that it has no time for."""
    pound("run", "two.yaml", "-q")
    monkeypatch.setattr("pounding_cli.api.causes.MAX_SECONDS", 0.0)
    study = Path("two.yaml")
    study.write_text(study.read_text().replace(*SOFTER).replace(*WIDER).replace("mass: 200 t", "mass: 250 t"))
    assert sum(int(re.search(r": (?:all )?(\d+) time histor", line)[1]) for line in causes()) == 16


def test_a_script_asks_what_a_run_would_solve(folder):
    first = explain_run("two.yaml")
    assert (first.total, first.solved, first.causes) == (16, 0, ())
    run("two.yaml")
    again = explain_run(load_study("two.yaml", {"cases.gap.gap": "2 cm"}))
    (cause,) = again.causes
    assert (cause.reasons, cause.count, cause.subjects) == ((OF_GAP,), 4, {"case gap": 4})
    assert again.reused == {"case touching": 4, "stiff alone": 4, "soft alone": 4}
    assert explain_run("two.yaml").is_current


def test_a_check_beside_a_run_says_so(folder, pound):
    pound("run", "two.yaml")
    study = Path("two.yaml")
    study.write_text(study.read_text().replace("1 cm", "12 mm"))
    with contextlib.closing(Cache(Path("results/two.h5.cache"))):
        assert standing() == "16 time histories; another run is using these results"


def test_what_failed_is_solved_again(folder, pound):
    """Fails if a time history without a result counts as solved."""
    Path("two.yaml").write_text(STUDY + "method: central-difference\ntime_step: 0.1 s\n")
    assert pound("run", "two.yaml")[0] == 1
    assert re.match(r"16 time histories; (\d+) solved, (?!0 )\d+ to solve; \d+ failed in an earlier run; ", standing())


def test_times_are_by_rates_of_earlier_runs(folder, pound, monkeypatch, tmp_path):
    """A run of the same scenes with another gap takes as long. Fails if the rate misses work that scenes differ in."""
    pound("run", "two.yaml")  # compiles
    monkeypatch.setattr(kernels, "FOLDER", tmp_path / "kernels")
    assert "the solver is not compiled on this computer yet" in standing("-o", "other.h5")
    monkeypatch.setattr(kernels, "is_compiled", lambda kernel: True)
    monkeypatch.setattr(forecast, "is_compiled", lambda kernel: True)
    assert "the time is not known before a first run on this computer" in standing("-o", "other.h5")
    pound("run", "two.yaml", "-o", "again.h5")
    rates = kernels.read_rates()
    assert set(rates) == {"the solver, taylor, linked", "the solver, taylor, alone"}
    plan = make_plan(load_study(Path("two.yaml")))
    every = np.arange(len(plan))
    kinds, work = forecast.classify_histories(plan)
    seconds = np.array([open_results("again.h5").attrs["solver_seconds"]])
    by_rates = sum(rates[kind] * each for kind, each in zip(kinds, work, strict=True))
    assert by_rates == pytest.approx(seconds[0], rel=1e-6)
    longer = replace(plan, estimate="none")
    one = forecast.estimate_duration(longer, every, len(every), rates).seconds
    twice = forecast.estimate_duration(longer, every, 2 * len(every), rates).seconds
    assert twice - forecast.RUN_OVERHEAD == pytest.approx(2 * (one - forecast.RUN_OVERHEAD))


INCHES = """\
records: {use: [elcentro], duration: 2 s, scale: {pga: 350 cm/s2}}
buildings: {A: {storeys: 4, period: 0.5 s}, B: {storeys: 4, period: 0.3 s}}
group: [A, B]
cases:
  bare: {link: pounding, gap: 0}
  p: {link: pounding, gap: 1.5 in}
  c: {link: connector, gap: 50.8 mm, floors: 4, stiffness: 30 kN/mm}
analyses: [elastic]
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", ("peak 350 cm/s2,", "4 x pounding, gap 1.5 in,", "1 x connector, gap 2 in, 30 kN/mm")),
        ("350 cm/s2", "3.5", ("peak 3.5 m/s2,",)),
        ("350 cm/s2", "0.35 g", ("peak 0.35 g,",)),
        ("{pga: 350 cm/s2}", "2.0", (" g, Arias",)),
        ("stiffness: 30 kN/mm", "stiffness: 1/5 mean storey", (" MN/m, damping ratio 21.5 % (restitution 0.5)\n",)),
        ("analyses", "method: newmark\ntime_step: 0.5 ms\nanalyses", ("newmark, time step 0.5 ms, estimate: all\n",)),
        ("analyses", "sweep: {cases.bare.gap: [2 mm, 1 in]}\nanalyses", ("gap 38.1 mm", "gap 50.8 mm")),
    ],
)
def test_values_are_shown_in_the_unit_of_the_study(folder, old, new, said):
    """Fails if a unit is fixed, or one of the study's is not found."""
    (folder / "two.yaml").write_text(INCHES.replace(old, new) if old else INCHES)
    shown = checked()
    for words in said:
        assert words in shown


def test_gaps_that_never_close_are_simulated_once(folder, pound):
    (folder / "two.yaml").write_text(WIDE + "sweep: {cases.gap.gap: [50 cm, 80 cm, 60 cm, 0 cm]}\n")
    assert pound("run", "two.yaml", "-o", "a.h5")[0] == 0
    scene = open_results("a.h5").scene()
    gap = scene[scene.case == "gap"]
    assert gap[gap["cases.gap.gap"] > 0].dropped_reasons.str.contains("the gap never closes, ").all()
    assert not gap[gap["cases.gap.gap"] == 0].dropped_reasons.str.contains("never closes").any()
    assert (gap.seconds == 0).sum() >= 4
    (folder / "one.yaml").write_text(WIDE + "sweep: {cases.gap.gap: [60 cm]}\n")
    pound("run", "one.yaml", "-o", "one.h5")
    alone, same = open_results("one.h5").storey(), open_results("a.h5").storey()
    same = same[same["cases.gap.gap"] == 0.6]
    for name in ("V", "V0", "mu", "mu0"):
        assert same[name].to_numpy() == pytest.approx(alone[name].to_numpy(), rel=1e-9)


def test_the_parameters_of_links_are_listed(tmp_path):
    """Fails if a dashpot that a study does not give, or a parameter of a damper, is not told."""
    links = {
        "link: connector": "damping ratio 21.5 % (restitution 0.5)",
        "link: connector, damping_ratio: 0": "damping ratio 0 % (restitution 1)",
        "link: infill, restitution: 0.6": "damping ratio 16 % (restitution 0.6)",
        "link: damper, damping_coefficient: 2 MN s/m": "damping coefficient 2 MN s/m",
        "link: viscous, force_at_1_m_s: 500 kN, exponent: 0.3": "force at 1 m/s 500 kN, exponent 0.3",
        "link: friction, slip_force: 200 kN": "slip force 200 kN",
        "link: hertz-damp, hertz_stiffness: 20 GN/m^1.5": "hertz stiffness 20 GN/m^1.5, restitution 0.5",
    }
    cases = "".join(f"  case {number}: {{gap: 5 cm, {link}}}\n" for number, link in enumerate(links))
    path = tmp_path / "study.yaml"
    path.write_text(
        "records: {use: [elcentro], duration: 1 s}\nanalyses: [elastic]\nestimate: none\n"
        "buildings: {A: {storeys: 1, period: 0.3 s, height: 3 m}, B: {storeys: 1, period: 0.4 s, height: 3 m}}\n"
        f"group: [A, B]\ncases:\n{cases}"
    )
    result = CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False)
    assert result.exit_code == 0
    told = result.stdout.split("cases\n")[1].splitlines()
    for line, words in zip(told, links.values(), strict=False):
        assert line.endswith(words), line


def test_every_meeting_is_listed(tmp_path):
    """Slabs that meet, slabs against columns, what is left out. Fails if one is missing, or a height is that
    of another floor."""
    path = tmp_path / "study.yaml"
    path.write_text(
        "title: x\nrecords: {use: [elcentro], duration: 1 s}\n"
        "buildings:\n  A: {storeys: 4, period: 0.3 s, height: 3 m}\n"
        "  B: {storeys: 3, period: 0.5 s, height: [3 m, 4 m, 5 m], columns: 20 %}\n"
        "group: [A, B]\ncases: {touching: {link: pounding, gap: 1 cm}}\n"
    )
    result = CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False)
    said = result.stdout.split("meetings\n")[1].split("cases\n")
    assert said[0].splitlines() == [
        "  A|B  3 m: floor 1 meets floor 1",
        "  A|B  6 m: floor 2 of A strikes columns of B in storey 2, at 75 % of its height, 20 % of the storey",
        "  A|B  7 m: left out: floor 2 of B strikes columns of A in storey 3, at 33.3 % of its height; "
        "write `columns:` in A",
        "  A|B  9 m: floor 3 of A strikes columns of B in storey 3, at 40 % of its height, 20 % of the storey",
        "  A|B  12 m: floor 4 meets floor 3",
    ]
    assert "2 x slab against columns, gap 1 cm" in said[1]


def test_places_have_their_names(tmp_path):
    """A wall on both sides of a building on isolators. Fails if meetings or isolators have the names of types."""
    path = tmp_path / "study.yaml"
    path.write_text(
        "records: {use: [elcentro], duration: 1 s}\nbuildings:\n  moat: {wall: {height: 0 m}}\n"
        "  A: {storeys: 1, period: 0.3 s, foundation: {mass: 300 t, isolation: {radius: 3 m, friction: 6 %}}}\n"
        "group: [A, moat, A]\ncases: {narrow: {link: pounding, gap: 8 cm}}\n"
    )
    lines = CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False).stdout.splitlines()
    meetings = lines[lines.index("meetings") + 1 :]
    assert meetings[:2] == ["  A-1|moat  the wall meets base", "  moat|A-2  the wall meets base"]
    assert [line.split()[0] for line in meetings[3:5]] == ["A-1", "A-2"]


QUESTIONS = """\
title: All questions
records: {use: [elcentro, taft], duration: 3 s, scale: {pga: 0.3 g}}
buildings:
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, storeys: 1, period: 0.5 s}
group: [A, B]
cases: {near: {link: pounding, gap: 3 mm}}
analyses: [inelastic]
sweep: {records.scale.pga: {from: 0.05 g, to: 1 g, step: 0.05 g}}
gap: {contact: 10 %}
fragility: {limits: [mu > 2, contact]}
uncertain:
  buildings.A.mass: {uniform: {from: 100 t, to: 200 t}}
  cases.near.gap: {uniform: {from: 1 mm, to: 5 mm}}
sensitivity: {outputs: [largest V_ratio], samples: 4}
optimise: {least: largest V_ratio, over: {cases.near.gap: {from: 1 mm, to: 9 mm}}, population: 6, generations: 2}
"""


@NIGHTLY
def test_the_questions_of_a_study(folder):
    """By hand: 20 levels x 2 motions x 3 (the pair, each alone) for `gap`, at most all of these for `fragility`. Fails
    if a question is not told, or with scenes that its command does not solve."""
    (folder / "two.yaml").write_text(QUESTIONS)
    said = checked().split("commands  ")[1]
    counted = {line.split()[1]: int(re.search(r"([\d]+) time histor", line)[1]) for line in said.splitlines()[1:]}
    assert list(counted) == ["run", "gap", "fragility", "sensitivity", "optimise"]
    assert counted["gap"] == 20 * 2 * 3
    assert counted["fragility"] <= 20 * 2 * 3
    assert re.search(r"pound fragility +about \d+ time histories, at most 120; ", said)
    about = {name: int(re.search(rf"pound {name} +about (\d+) ", said)[1]) for name in ("fragility", "optimise")}
    for name in ("gap", "sensitivity", "fragility", "optimise"):
        ran = CliRunner().invoke(cli, [name, "two.yaml", "-o", f"{name}.h5"], catch_exceptions=False)
        solved = int(re.search(r"Time histories: (\d+) solved", ran.output)[1])
        if name in about:
            assert 0.25 < about[name] / solved < 4
        else:
            assert counted[name] == solved


def test_a_study_that_asks_nothing_has_no_questions(folder):
    assert re.findall(r"\n  pound (\w+)", checked()) == ["run"]


def test_a_bad_question_is_refused_at_its_place(folder, pound):
    (folder / "two.yaml").write_text(QUESTIONS.replace("mu > 2", "mu in C > 2"))
    code, out, err = pound("check", "two.yaml")
    assert (code, out) == (2, "")
    assert "two.yaml:11:22: 'mu in C': no building 'C' in the group" in err


SWEPT = """\
records: {use: [elcentro, taft], duration: 1 s}
buildings: {A: {storeys: 2, period: 0.5 s}, B: {storeys: 2, period: 0.3 s}}
group: [A, B]
cases: {gap: {link: pounding, gap: 0 cm}, none: {link: none}}
analyses: [elastic]
estimate: none
sweep:
  buildings.A.period: {from: 0.4 s, to: 0.6 s, count: 6}
  cases.gap.gap: {from: 0 cm, to: 2 cm, count: 12}
"""


def test_scenes_that_points_share_are_counted_once(folder):
    """2 motions x (6 x 12 linked, 6 without links, 6 A and 1 B alone). Fails if a building alone is counted once a
    gap."""
    (folder / "two.yaml").write_text(SWEPT)
    said = checked()
    assert re.search(
        r"^OK: two.yaml: 2 cases x 1 analysis x 2 motions x 72 sweep points = 288 rows of 170 time histories", said
    )
    assert re.search(r"solves +170 time histories\n", said)
    assert re.search(r"\n +14 of a building alone\n", said)


def test_only_effects_that_a_scene_has_or_a_reader_may_expect_have_a_line(folder):
    """Fails if every law of links that no case has takes a line of its own, or what is left out loses its name."""
    (folder / "two.yaml").write_text(STUDY)
    said = checked()
    lines = [line.strip() for line in said.split("\neffects ")[1].split("\nmotions ")[0].splitlines()[1:]]
    names = [re.split(r"  +", line)[0] for line in lines[:-1]]
    assert {"yielding storeys", "foundation motions", "P-Delta", "pounding links"} <= set(names)
    assert not [name for name in names if name in ("collapse", "hertz links", "viscous links")]
    assert re.match(r"all others +left out in \d+: not used in this study: collapse", lines[-1])
    for law in ("infill", "connector", "hertz-damp", "bilinear"):
        assert law in lines[-1]

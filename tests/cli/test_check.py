"""`pound check`: what runs, what needs no run, what is dropped and why."""

from __future__ import annotations

import re

import pytest
from click.testing import CliRunner

from pounding_cli import open_results
from pounding_cli.cli.main import cli

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
    assert re.search(r"run +8 of a building alone\n", said)
    assert re.search(r"run +8 of the group\n", said)
    assert re.search(r"yielding storeys +simulated in 4; left out in 4: the analysis is elastic", said)


def test_a_check_says_where_its_times_are_from(folder):
    """Fails if times of a formula are told as those of this computer."""
    said = checked()
    assert re.search(r"pound run +about [\d.]+ s, timed by \d+ scenes of them", said)


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
        ("analyses", "method: newmark\ntime_step: 0.5 ms\nanalyses", ("newmark, time step 0.5 ms\n",)),
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
    assert gap[gap["cases.gap.gap"] > 0].dropped.str.contains("the gap never closes, ").all()
    assert not gap[gap["cases.gap.gap"] == 0].dropped.str.contains("never closes").any()
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


def test_the_questions_of_a_study(folder):
    """By hand: 20 levels x 2 motions x 3 (the pair, each alone) for `gap`, at most all of these for `fragility`. Fails
    if a question is not told, or with scenes that its command does not solve."""
    (folder / "two.yaml").write_text(QUESTIONS)
    said = checked().split("questions  ")[1].split("times  ")[0]
    counted = {
        line.split()[1]: int(re.search(r"(?:has|most|with) (\d+) scene", line)[1]) for line in said.splitlines()[1:]
    }
    assert list(counted) == ["gap", "fragility", "sensitivity", "optimise"]
    assert counted["gap"] == 20 * 2 * 3
    assert counted["fragility"] == 20 * 2 * 3
    assert re.search(r"pound gap +has", said)
    assert re.search(r"pound fragility +has at most", said)
    assert re.search(r"pound optimise +begins with", said)
    for name in ("gap", "sensitivity"):
        ran = CliRunner().invoke(cli, [name, "two.yaml", "-o", f"{name}.h5"], catch_exceptions=False)
        assert f"{counted[name]} solved" in ran.output


def test_a_study_that_asks_nothing_has_no_questions(folder):
    assert "questions" not in checked()


def test_a_bad_question_is_refused_at_its_place(folder, pound):
    (folder / "two.yaml").write_text(QUESTIONS.replace("mu > 2", "mu > 2 in C"))
    code, out, err = pound("check", "two.yaml")
    assert (code, out) == (2, "")
    assert "two.yaml:11:22: 'mu > 2 in C': no building 'C' in the group" in err


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
        r"^OK: two.yaml: 2 cases x 1 analysis x 2 records x 72 sweep points = 288 rows from 170 scenes", said
    )
    assert re.search(r"scenes +170, with estimate", said)
    assert re.search(r"run +14 of a building alone", said)


def test_only_effects_that_a_scene_has_or_a_reader_may_expect_have_a_line(folder):
    """Fails if every law of links that no case has takes a line of its own, or what is left out loses its name."""
    (folder / "two.yaml").write_text(STUDY)
    said = checked()
    lines = [line.strip() for line in said.split("\neffects ")[1].split("\nmotions ")[0].splitlines()[1:]]
    names = [re.split(r"  +", line)[0] for line in lines[:-1]]
    assert {"yielding storeys", "foundation motions", "P-Delta", "pounding links"} <= set(names)
    assert not [name for name in names if name in ("collapse", "hertz links", "viscous links")]
    assert re.match(r"all others +left out in \d+: nothing in the study calls for: collapse", lines[-1])
    for law in ("infill", "connector", "hertz-damp", "bilinear"):
        assert law in lines[-1]

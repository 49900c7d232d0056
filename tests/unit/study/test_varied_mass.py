"""A mass that varies beside a `period`: what is held is told, and `stiffness: {period: ..., mass: ...}` holds the
stiffness, so that the period grows with the root of the mass."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import pounding_cli
from pounding_cli.cli.main import cli
from pounding_cli.errors import InputError
from pounding_cli.study import expand, load_study
from pounding_cli.study.sensitivity import expand_sensitivity

STUDY = """\
title: mass
records: {use: [elcentro], duration: 2 s}
buildings:
  stiff: {storeys: 3, period: 0.3 s, yield_shear: never}
  soft: {storeys: 3, mass: 300 t, taper: 0.5, §}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 2 cm}}
analyses: [inelastic]
estimate: none
"""
PERIOD, STIFFNESS = "period: 0.42 s", "stiffness: {period: 0.42 s, mass: 300 t}"
UNCERTAIN = """\
uncertain:
  buildings.soft.mass: {uniform: {from: 270 t, to: 330 t}}
  buildings.soft.hardening: {uniform: {from: 0.02, to: 0.10}}
sensitivity: {outputs: [largest mu in soft], samples: 4}
"""
SWEEP = "sweep: {buildings.soft.mass: [300 t, 363 t]}\n"


@pytest.fixture
def study(tmp_path: Path):
    def write(soft: str, more: str = "", **changes: str) -> Path:
        path = tmp_path / "study.yaml"
        text = STUDY.replace("§", soft) + more
        for old, new in changes.items():
            text = text.replace(old, new)
        path.write_text(text, encoding="utf-8")
        return path

    return write


def soft(scene):
    return next((building for building in scene.buildings if building.name == "soft"), None)


def test_the_stiffness_of_a_period_and_masses_is_that_of_the_period(study) -> None:
    by_period, by_both = (load_study(study(text)).building((), 1) for text in (PERIOD, STIFFNESS))
    assert by_both.stiffness == pytest.approx(by_period.stiffness, rel=1e-14)
    assert by_both.stiffness[-1] / by_both.stiffness[0] == pytest.approx(0.5), "the taper counts"
    assert by_both.periods[0] == pytest.approx(0.42, rel=1e-12)
    other = load_study(study("stiffness: {period: 0.42 s, mass: [400 t, 300 t, 200 t]}")).building((), 1)
    mine = load_study(study(PERIOD.replace("period", "mass: [400 t, 300 t, 200 t], period"), **{"mass: 300 t, ": ""}))
    assert other.stiffness == pytest.approx(mine.building((), 1).stiffness, rel=1e-14)


def test_a_swept_mass_holds_the_period_or_the_stiffness(study) -> None:
    """T = 2 pi sqrt(m / k) for every mode shape: 1.21 times the mass is 1.1 times the period, or 1.21 times k."""
    held = load_study(study(PERIOD, SWEEP))
    light, heavy = (held.building((place,), 1) for place in (0, 1))
    assert heavy.periods == pytest.approx(light.periods, rel=1e-12)
    assert heavy.stiffness == pytest.approx(1.21 * light.stiffness, rel=1e-12)
    assert heavy.yield_shear == pytest.approx(1.21 * light.yield_shear, rel=1e-12)
    free = load_study(study(STIFFNESS, SWEEP))
    light, heavy = (free.building((place,), 1) for place in (0, 1))
    assert heavy.stiffness == pytest.approx(light.stiffness, rel=1e-14)
    assert heavy.periods == pytest.approx(1.1 * light.periods, rel=1e-12)


def test_the_periods_of_the_samples_follow_the_uncertain_mass(study) -> None:
    for text, exponent in ((PERIOD, 0.0), (STIFFNESS, 0.5)):
        scenes = [soft(scene) for scene in expand_sensitivity(load_study(study(text, UNCERTAIN))).scenes.values()]
        found = np.array([(each.mass[0], each.periods[0]) for each in scenes if each is not None])
        assert np.ptp(found[:, 0]) > 30e3, "the samples spread over the range"
        assert found[:, 1] == pytest.approx(0.42 * (found[:, 0] / 300e3) ** exponent, rel=1e-12)


@pytest.mark.parametrize("command", ["check", "plan", "run", "sensitivity"])
def test_what_is_held_is_told_and_how_to_hold_the_stiffness(study, command, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = study(PERIOD, UNCERTAIN)
    done = CliRunner().invoke(cli, [command, path.name], catch_exceptions=False)
    assert done.exit_code == 0
    shears = load_study(path).building((), 1).yield_shear / 1e3
    assert (
        "warning: study.yaml:11:3: where the mass varies, the period of soft is held at 0.42 s: the stiffness changes "
        "in proportion to the mass, and so do the yield shears, which are a part of the weight\n"
        "    to hold the stiffness instead, write `stiffness: {period: 0.42 s, mass: 300 t}` in place of `period`; to "
        f"hold the yield shears too, `yield_shear: [{', '.join(f'{shear:.5g} kN' for shear in shears)}]` in place of "
        "`yield`\n"
    ) in done.stderr
    study(STIFFNESS, UNCERTAIN)
    assert CliRunner().invoke(cli, ["check", path.name], catch_exceptions=False).stderr == ""


def test_the_spellings_that_are_told_hold_stiffness_and_yield_shears(study) -> None:
    (warning,) = load_study(study(PERIOD, SWEEP)).warnings
    stiffness, shears = warning.hint.split("`")[1], warning.hint.split("`")[5]
    held = load_study(study(f"{stiffness}, {shears}", SWEEP))
    assert held.warnings == ()
    light, heavy = (held.building((place,), 1) for place in (0, 1))
    assert (heavy.stiffness.tolist(), heavy.yield_shear.tolist()) == (
        light.stiffness.tolist(),
        light.yield_shear.tolist(),
    )
    first = load_study(study(PERIOD)).building((), 1)
    assert light.stiffness == pytest.approx(first.stiffness, rel=1e-14)
    assert light.yield_shear == pytest.approx(first.yield_shear, rel=1e-4)


@pytest.mark.parametrize(
    ("soft", "more", "told"),
    [
        (PERIOD, "optimise: {least: largest mu, over: {buildings.soft.mass: {from: 270 t, to: 330 t}}}\n", ["soft"]),
        (PERIOD, "sweep: {buildings.stiff.mass: [200 t, 300 t]}\n", ["stiff"]),
        (
            "like: stiff, period: 0.42 s",
            "sweep: {buildings.stiff.mass: [200 t, 300 t]}\n",
            ["stiff"],
        ),  # a mass of its own
        (PERIOD, "sweep: [{buildings.soft.mass: [200 t, 300 t], buildings.soft.period: [0.4 s, 0.5 s]}]\n", []),
        (PERIOD, "sweep: {buildings.soft.mass: [200 t, 300 t], buildings.soft.period: [0.4 s, 0.5 s]}\n", ["soft"]),
        (PERIOD, "sweep: {buildings.soft.period: [0.4 s, 0.5 s]}\n", []),
        ("stiffness: [3e8, 3e8, 3e8]", SWEEP, []),  # with no taper beside it
    ],
)
def test_only_a_mass_that_varies_beside_a_period_is_told(study, soft, more, told) -> None:
    taper = {"taper: 0.5, ": ""} if "[3e8" in soft else {}
    said = [warning.message for warning in load_study(study(soft, more, **taper)).warnings]
    assert len(said) == len(told)
    assert all(f"the period of {name} is held at" in message for name, message in zip(told, said, strict=True))


def test_all_buildings_that_take_the_mass_are_told(study) -> None:
    path = study(
        "like: stiff, period: 0.42 s", "sweep: {buildings.stiff.mass: [200 t, 300 t]}\n", **{"mass: 300 t, ": ""}
    )
    (warning,) = load_study(path).warnings
    assert "the periods of stiff, soft are held: the stiffness changes in proportion to the mass" in warning.message
    assert "yield" not in warning.message, "stiff never yields"
    assert (
        "`stiffness: {period: 0.3 s, mass: 200 t}` in place of `period` (of stiff; likewise in the others)"
        in warning.hint
    )


def test_a_building_like_one_with_a_period_may_give_the_stiffness(study) -> None:
    path = study("like: stiff, stiffness: {period: 0.5 s, mass: 300 t}")
    assert load_study(path).building((), 1).periods[0] == pytest.approx(0.5, rel=1e-12)
    back = study("like: base, period: 0.42 s", **{"  stiff: {": f"  base: {{storeys: 3, {STIFFNESS}}}\n  stiff: {{"})
    assert load_study(back).building((), 1).periods[0] == pytest.approx(0.42, rel=1e-12)


@pytest.mark.parametrize(
    ("soft", "message", "hint"),
    [
        ("stiffness: {period: 0.42 s}", "'mass' is missing", "`mass: 300 t`"),
        ("stiffness: {mass: 300 t}", "'period' is missing", "`period: 0.42 s`"),
        ("stiffness: {period: 0.42 s, mass: [300 t, 200 t]}", "stiffness.mass has 2 values for 3 storeys", "3 values"),
        ("stiffness: {period: 0.42 s, mass: 0 t}", "it must be above 0 kg", "200 t"),
        ("stiffness: {period: 0.42 s, mass: 300 t, taper: 1}", "unknown key 'taper'", "known: period, mass"),
        (f"{STIFFNESS}, {PERIOD}", "'stiffness' and 'period' cannot both be given", "remove one"),
    ],
)
def test_what_is_wrong_with_such_a_stiffness_is_refused(study, soft, message, hint) -> None:
    with pytest.raises(InputError) as refused:
        load_study(study(soft))
    (problem,) = refused.value.problems
    assert problem.line == 5
    assert message in problem.message
    assert hint in problem.hint


@pytest.mark.parametrize(("text", "share"), [(PERIOD, 0.0), (STIFFNESS, 1.0)])
def test_an_uncertain_mass_decides_an_elastic_drift_only_where_the_stiffness_is_held(
    study, tmp_path, monkeypatch, text, share
) -> None:
    """Under one motion the drift of an elastic building that meets nobody is a function of its period and damping
    alone: with the period held, the damping has all of the variance; with a damping that hardly varies, the mass."""
    monkeypatch.chdir(tmp_path)
    more = """\
uncertain:
  buildings.soft.mass: {uniform: {from: 240 t, to: 360 t}}
  buildings.soft.damping: {uniform: {from: 5 %, to: 5.01 %}}
sensitivity: {outputs: [largest drift in soft], samples: 64, draws: 100}
"""
    path = study(text, more, **{"gap: 2 cm": "gap: 1 m", "inelastic": "elastic"})
    done = CliRunner().invoke(cli, ["sensitivity", path.name, "-q"], catch_exceptions=False)
    assert done.exit_code == 0
    indices = pounding_cli.open_results(Path("results/study-sensitivity.h5")).answer("sensitivity").frame
    total = indices.set_index("key")["total"]
    assert total["buildings.soft.mass"] == pytest.approx(share, abs=0.1)


def test_expanded_scenes_of_a_study_without_varying_mass_have_both_spellings_alike(study) -> None:
    first, second = (expand(load_study(study(text))).scenes for text in (PERIOD, STIFFNESS))
    assert [soft(scene).stiffness.tolist() for scene in first.values() if soft(scene)] == [
        soft(scene).stiffness.tolist() for scene in second.values() if soft(scene)
    ]

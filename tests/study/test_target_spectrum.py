"""Motions scaled to a target spectrum: what is said of the whole range holds between the periods of the fit."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from pounding_cli.api.studies import load_study
from pounding_cli.errors import InputError
from pounding_cli.questions.fragility import QUESTION as FRAGILITY
from pounding_cli.questions.gap import QUESTION as GAP
from pounding_cli.records import CODES, TargetSpectrum
from pounding_cli.records.motion import spectrum
from pounding_cli.study import load_study_file
from pounding_cli.study.check.suite_rules import check_suite
from pounding_cli.study.construct.buildings import build_building
from pounding_cli.study.construct.group import Group
from pounding_cli.study.construct.motions import MotionItem, MotionUse, Suite
from pounding_cli.study.display import to_plain_data
from pounding_cli.study.schema.building import BuildingSpec
from pounding_cli.study.schema.lookup import quantity_at
from pounding_cli.study.schema.records import CodeTargetSpec, RecordsSpec
from pounding_cli.study.schema.study import StudySpec
from pounding_cli.units import GRAVITY

STUDY = """\
records:
  use: [elcentro, taft]
  duration: 6 s
  scale: {spectrum: WAY, target: TARGET, from: 0.1 s, to: 1.5 s, damping: DAMPING, at_least: 90 %}
buildings: {A: {storeys: 1, period: 0.3 s}, B: {storeys: 1, period: 0.5 s}}
group: [A, B]
cases: {gap: {link: pounding, gap: 1 cm}}
"""
EN = "{code: EN 1998-1, type: 1, soil: C, ag: 0.25 g}"
ASCE = "{code: ASCE 7-16, sds: 1 g, sd1: 0.6 g, tl: 8 s}"
GB = "{code: GB 50011-2010, alpha_max: 0.5, tg: 0.2 s}"
POINTS = "{0.1 s: 0.8 g, 0.5 s: 0.8 g, 0.61 s: 0.5 g, 2 s: 0.2 g}"


def en_by_hand(periods):
    """EN 1998-1, type 1, soil C, 0.25 g, 5 % [m/s2]: a second way, by the largest of nothing but its four lines."""
    rising = 0.2875 * (1 + periods / 0.2 * 1.5)
    return GRAVITY * np.minimum.reduce([rising, np.full_like(periods, 0.71875), 0.43125 / periods, 0.8625 / periods**2])


def gb_by_hand(periods):
    """GB 50011-2010, alpha_max 0.5, Tg 0.2 s, 5 % [m/s2], up to 6 s."""
    falling = np.where(periods < 1.0, (0.2 / periods) ** 0.9, 0.2**0.9 - 0.02 * (periods - 1.0))
    return GRAVITY * 0.5 * np.minimum.reduce([0.45 + 5.5 * periods, np.ones_like(periods), falling])


def points_by_hand(periods):
    """The points of POINTS [m/s2], straight in ln T and ln Sa."""
    logarithms = np.interp(np.log(periods), np.log([0.1, 0.5, 0.61, 2.0]), np.log([0.8, 0.8, 0.5, 0.2]))
    return GRAVITY * np.exp(logarithms)


def study_of(folder: Path, text: str):
    (folder / "s.yaml").write_text(text)
    return load_study_file(folder / "s.yaml")


def filled_in(way: str, target: str, damping: str) -> str:
    return STUDY.replace("WAY", way).replace("TARGET", target).replace("DAMPING", damping)


@pytest.mark.parametrize(
    ("way", "target", "damping", "by_hand"),
    [
        ("mean", POINTS, "2 %", points_by_hand),
        ("each", POINTS, "5 %", points_by_hand),
        ("mean", "parkfield", "5 %", None),
        ("mean", EN, "5 %", en_by_hand),
        ("each", GB, "5 %", gb_by_hand),
    ],
)
def test_the_mean_spectrum_is_nowhere_below_its_part_of_the_target(tmp_path: Path, way, target, damping, by_hand):
    """At 1,200 periods and at the corners, by the spectra alone. Fails if only the 50 periods of the fit are looked at:
    at 2 % damping it then falls to 0.89; and if the rising line of a code is taken as straight in ln T and ln Sa."""
    study = study_of(tmp_path, filled_in(way, target, damping))
    match = study.spectrum_match()
    assert match is not None
    motions = list(study.motions(study.first_point).values())
    corners = [period for period in match.target.periods if 0.1 < period < 1.5]
    periods = np.union1d(np.geomspace(0.1, 1.5, 1200), corners)
    mean = np.mean([spectrum(motion, periods, match.target.damping) for motion in motions], axis=0)
    if by_hand is None:
        wanted = np.exp(np.interp(np.log(periods), np.log(match.target.periods), np.log(match.target.values)))
    else:
        wanted = by_hand(periods)
    ratio = mean / wanted
    assert ratio.min() == pytest.approx(0.9, rel=1e-3)
    assert ratio.min() > 0.9 * (1 - 1e-5)
    period, lowest = map(float, re.search(r"lowest at ([\d.]+) s: ([\d.]+) of the target", match.words).groups())
    assert lowest == 0.9
    assert np.interp(period, periods, ratio) == pytest.approx(0.9, rel=1e-2)


def test_a_swept_target_is_shown_with_the_value_that_the_study_writes(tmp_path: Path):
    """Not with that of the first point. Fails if the match is of the point at which the sweep begins."""
    text = filled_in("mean", EN, "5 %").replace(", at_least: 90 %", "")
    study = study_of(tmp_path, f"{text}sweep: {{records.scale.target.soil: [A, E]}}\n")
    match = study.spectrum_match()
    alone = study_of(tmp_path, text).spectrum_match()
    assert match == alone
    assert "soil A" not in match.words


@pytest.mark.parametrize("way", ["mean", "each"])
def test_the_factors_are_those_of_least_squares_to_the_spectrum_of_a_code(tmp_path: Path, way):
    """By a search for the least sum of squares of ln(factor Sa / target) over the 50 periods, without `at_least`."""
    study = study_of(tmp_path, filled_in(way, EN, "5 %").replace(", at_least: 90 %", ""))
    uses = study.motion_uses(study.first_point)
    periods = np.geomspace(0.1, 1.5, 50)
    whole = {name: study.reader.whole_motion(use.item).cut_to(use.window) for name, use in uses.items()}
    spectra = {name: spectrum(motion, periods) for name, motion in whole.items()}
    mean = np.mean(list(spectra.values()), axis=0)
    for name, use in uses.items():
        logs = np.log((spectra[name] if way == "each" else mean) / en_by_hand(periods))
        factor = np.exp(np.linalg.lstsq(np.ones((50, 1)), -logs, rcond=None)[0][0])
        assert use.scale == pytest.approx(factor, rel=1e-12)


TABULATED = [
    (
        "EN 1998-1",
        {"type": 1, "soil": "C", "ag": 0.25 * GRAVITY},
        {0: 0.2875, 0.1: 0.503125, 0.2: 0.71875, 0.4: 0.71875, 0.6: 0.71875, 1: 0.43125, 2: 0.215625, 4: 0.05390625},
    ),
    (
        "EN 1998-1",
        {"type": 2, "soil": "D", "ag": 0.1 * GRAVITY, "importance": 1.2, "damping": 0.02},
        {0: 0.216, 0.05: 0.4307117, 0.1: 0.6454235, 0.3: 0.6454235, 0.6: 0.3227117, 1.2: 0.1613559, 2.4: 0.0403390},
    ),
    ("EN 1998-1", {"type": 1, "soil": "A", "ag": 0.2 * GRAVITY, "damping": 0.6}, {0: 0.2, 0.15: 0.275, 0.4: 0.275}),
    ("EN 1998-1", {"type": 1, "soil": "B", "ag": 0.2 * GRAVITY}, {0: 0.24, 0.15: 0.6, 0.5: 0.6, 2: 0.15, 4: 0.0375}),
    ("EN 1998-1", {"type": 1, "soil": "D", "ag": 0.2 * GRAVITY}, {0: 0.27, 0.2: 0.675, 0.8: 0.675, 1.6: 0.3375}),
    ("EN 1998-1", {"type": 1, "soil": "E", "ag": 0.2 * GRAVITY}, {0: 0.28, 0.15: 0.7, 0.5: 0.7, 1: 0.35}),
    ("EN 1998-1", {"type": 2, "soil": "A", "ag": 0.2 * GRAVITY}, {0: 0.2, 0.05: 0.5, 0.25: 0.5, 1.2: 5 / 48}),
    ("EN 1998-1", {"type": 2, "soil": "B", "ag": 0.2 * GRAVITY}, {0: 0.27, 0.05: 0.675, 0.25: 0.675, 0.5: 0.3375}),
    ("EN 1998-1", {"type": 2, "soil": "C", "ag": 0.2 * GRAVITY}, {0: 0.3, 0.1: 0.75, 0.25: 0.75, 0.5: 0.375}),
    ("EN 1998-1", {"type": 2, "soil": "E", "ag": 0.2 * GRAVITY}, {0: 0.32, 0.05: 0.8, 0.25: 0.8, 2.4: 1 / 24}),
    (
        "ASCE 7-16",
        {"sds": GRAVITY, "sd1": 0.6 * GRAVITY, "tl": 8.0},
        {0: 0.4, 0.06: 0.7, 0.12: 1.0, 0.6: 1.0, 1: 0.6, 8: 0.075, 16: 0.01875},
    ),
    (
        "ASCE 7-16",
        {"sds": GRAVITY, "sd1": 0.6 * GRAVITY, "tl": 8.0, "level": "mcer"},
        {0: 0.6, 0.06: 1.05, 0.12: 1.5, 0.6: 1.5, 1: 0.9, 8: 0.1125, 16: 0.028125},
    ),
    (
        "NTC 2018",
        {"ag": 0.25 * GRAVITY, "f0": 2.4, "tc_star": 0.33, "soil": "C"},
        {0: 0.335, 0.0832611: 0.5695, 0.1665222: 0.804, 0.4995666: 0.804, 1: 0.4016515, 2.6: 0.1544814, 3: 0.1160327},
    ),
    (
        "NTC 2018",  # the factors of the soils at their limits, and a slope
        {"ag": 0.4 * GRAVITY, "f0": 2.5, "tc_star": 0.25, "soil": "D", "topography": "T4"},
        {0: 0.504, 0.625: 1.26, 3.2: 0.24609375},
    ),
    ("NTC 2018", {"ag": 0.1 * GRAVITY, "f0": 2.4, "tc_star": 0.3, "soil": "B"}, {0: 0.12, 0.4: 0.288}),
    (
        "NTC 2018",
        {"ag": 0.1 * GRAVITY, "f0": 2.4, "tc_star": 0.3, "soil": "A", "topography": "T2"},
        {0: 0.12, 0.3: 0.288},
    ),
    ("NTC 2018", {"ag": 0.1 * GRAVITY, "f0": 2.4, "tc_star": 0.3, "soil": "E"}, {0: 0.16, 0.4: 0.384}),
    (
        "GB 50011-2010",
        {"alpha_max": 0.9, "tg": 0.4},
        {0: 0.405, 0.05: 0.6525, 0.1: 0.9, 0.4: 0.9, 1: 0.3945450, 2: 0.2114314, 4: 0.1754314, 6: 0.1394314},
    ),
    (
        "GB 50011-2010",
        {"alpha_max": 0.16, "tg": 0.35, "damping": 0.02},
        {0: 0.072, 0.1: 0.2028571, 0.35: 0.2028571, 1.75: 0.0424806, 4.75: 0.0297772},
    ),
]
"""Ordinates in g by hand, at corners and between them, of every ground and code."""


def spectrum_of(code: str, parameters: dict) -> TargetSpectrum:
    built = CODES[code].build(**parameters)
    return TargetSpectrum(built.periods, built.values, 0.1, 1.0, 0.05, built.straight_in_period, built.name)


@pytest.mark.parametrize(("code", "parameters", "ordinates"), TABULATED)
def test_the_spectra_of_codes_have_the_ordinates_of_their_equations(code, parameters, ordinates):
    """Exact at the corners and between them. Fails if a factor of damping, of soil or a corner is another."""
    target = spectrum_of(code, parameters)
    periods = np.array(list(ordinates), float)
    found = target.interpolate(np.maximum(periods, 1e-12)) / GRAVITY
    assert found == pytest.approx(list(ordinates.values()), rel=2e-6)
    corners = np.array(target.periods[1:-1])
    assert target.interpolate(corners) == pytest.approx(target.values[1:-1], rel=1e-14)
    assert target.interpolate(corners * (1 - 1e-9)) == pytest.approx(target.interpolate(corners * (1 + 1e-9)), rel=1e-7)


@pytest.mark.parametrize(("code", "parameters"), [row[:2] for row in TABULATED if "level" not in row[1]])
def test_slopes_of_a_target_lie_within_their_bounds(code, parameters):
    """By differences over a thousandth of every interval. Fails if the slope of a branch that is straight in T is taken
    as constant in ln T: the search for the lowest ratio would then pass over intervals in which it may stand."""
    target = spectrum_of(code, parameters)
    inner = [period for period in target.periods if 0.01 < period < 3.9]
    periods = np.union1d(np.geomspace(0.01, 3.9, 7), inner)
    lowest, highest = target.slope_bounds(periods)
    for place, (start, end) in enumerate(pairwise(periods)):
        x = np.linspace(np.log(start), np.log(end), 1001)
        slopes = np.diff(np.log(target.interpolate(np.exp(x)))) / np.diff(x)
        assert slopes.min() >= lowest[place] - 1e-6
        assert slopes.max() <= highest[place] + 1e-6
        assert slopes.min() == pytest.approx(lowest[place], abs=2e-3)
        assert slopes.max() == pytest.approx(highest[place], abs=2e-3)


def test_parameters_of_a_code_are_swept(tmp_path: Path):
    """Factors are in proportion to ag; another soil has another shape. Fails if a swept key inside the target is not
    taken, or is shown in another unit."""
    text = filled_in("mean", EN, "5 %").replace(", at_least: 90 %", "")
    sweep = "sweep: {records.scale.target.ag: [0.1 g, 0.3 g], records.scale.target.soil: [A, D]}\n"
    study = study_of(tmp_path, text + sweep)
    factors = [[study.motion_uses((ag, soil))["taft"].scale for soil in (0, 1)] for ag in (0, 1)]
    assert factors[1] == pytest.approx([3 * factor for factor in factors[0]])
    names = [study.parts.suite.value_at((1, soil)).target.name for soil in (0, 1)]
    assert names == ["EN 1998-1, type 1, soil A, 0.3 g", "EN 1998-1, type 1, soil D, 0.3 g"]
    ground = {soil: spectrum_of("EN 1998-1", {"type": 1, "soil": soil, "ag": 1.0}) for soil in "AD"}
    periods = np.geomspace(0.1, 1.5, 50)
    change = np.log(ground["D"].interpolate(periods) / ground["A"].interpolate(periods)).mean()
    assert np.log(factors[0][1] / factors[0][0]) == pytest.approx(change, rel=1e-9)
    assert [axis.display_values(0) for axis in study.axes] == [("0.1 g",), ("A",)]
    assert study.unit("acceleration").name == "g"


def test_the_ground_acceleration_of_a_code_is_an_intensity(tmp_path: Path):
    """Of curves and rates; other measures grow in proportion to it. Fails if the motions are measured at another level,
    or the spectrum of NTC 2018, which is not in proportion to it, is taken for one that is."""
    text = filled_in("mean", EN, "5 %").replace(", at_least: 90 %", "")
    text += "sweep: {records.scale.target.ag: [0.1 g, 0.3 g]}\n"
    text += "fragility: {limits: [drift > 1 cm], method: stripes}\ngap: {rate: 1/475, hazard: {k0: 1e-4, k: 2}}\n"
    (tmp_path / "s.yaml").write_text(text)
    study = load_study(tmp_path / "s.yaml")
    by_ag = FRAGILITY.ask(study)
    assert by_ag.intensities[0] / GRAVITY == pytest.approx(np.array([[0.1, 0.3]] * 2))
    assert GAP.ask(study).intensities / GRAVITY == pytest.approx(np.array([0.1, 0.3]))
    (tmp_path / "s.yaml").write_text(text.replace("stripes", "stripes, intensity: pga"))
    by_peak = FRAGILITY.ask(load_study(tmp_path / "s.yaml"))
    peaks = [[study.motion_uses((level,))[name].pga for level in (0, 1)] for name in ("elcentro", "taft")]
    assert by_peak.intensities[0] == pytest.approx(np.array(peaks))
    ntc = "{code: NTC 2018, f0: 2.4, tc_star: 0.3 s, soil: C, ag: 0.25 g}"
    (tmp_path / "s.yaml").write_text(text.replace(EN, ntc))
    with pytest.raises(InputError, match="not in proportion"):
        FRAGILITY.ask(load_study(tmp_path / "s.yaml"))
    (tmp_path / "s.yaml").write_text(text.replace("target.ag: [0.1 g, 0.3 g]", "target.soil: [A, C]"))
    assert GAP.ask(load_study(tmp_path / "s.yaml")).intensities / GRAVITY == pytest.approx(np.array([0.25]))


def test_parameters_of_a_code_have_their_own_units(tmp_path: Path):
    """Fails if a period or a plain number inside the target is taken for an acceleration, as those of points are."""
    text = filled_in("each", ASCE, "5 %").replace(", at_least: 90 %", "")
    study = study_of(tmp_path, text + "sweep: {records.scale.target.tl: [8, 12]}\n")
    assert study.axes[0].display_values(1) == ("12 s",)
    assert quantity_at(StudySpec, ("records", "scale", "target", "soil")) is None
    assert study.unit("acceleration").name == "g"
    study = study_of(tmp_path, text.replace(ASCE, GB))
    assert study.unit("acceleration").name == "g"


@pytest.mark.parametrize(
    ("inside", "beside"), [("", "damping: 2 %"), (", damping: 2 %", ""), (", damping: 2 %", "damping: 2 %")]
)
def test_target_and_motions_have_one_damping_ratio(tmp_path: Path, inside, beside):
    """Wherever it is written. Fails if the ordinates of the target, the spectra of the motions or the study as data
    have another one."""
    target = EN.removesuffix("}") + inside + "}"
    text = filled_in("mean", target, "2 %").replace("damping: 2 %, at_least: 90 %}", f"{beside}}}")
    study = study_of(tmp_path, text.replace("to: 1.5 s, }", "to: 1.5 s}"))
    suite = study.parts.suite.value_at(study.first_point)
    assert suite.target.damping == 0.02
    assert max(suite.target.values) == pytest.approx(0.71875 * GRAVITY * np.sqrt(10 / 7))
    periods = np.geomspace(0.1, 1.5, 50)
    used = [spectrum(motion, periods, 0.02) for motion in study.motions(study.first_point).values()]
    assert np.log(np.mean(used, axis=0) / suite.target.interpolate(periods)).mean() == pytest.approx(0, abs=1e-12)
    scale = to_plain_data(study.spec.records.scale)
    assert scale["damping"] == scale["target"]["damping"] == 0.02


SUITE_RULES = [
    (EN, "from: 0.06 s, to: 1 s, at_least: 90 %", 3, []),
    (EN, "from: 0.06 s, to: 1 s, at_least: 90 %", 2, [("use", "3.2.3.1.2(4)a")]),
    (EN, "from: 0.07 s, to: 1 s, at_least: 90 %", 3, [("from", "0.06 s, 0.2 times")]),
    (EN, "from: 0.06 s, to: 0.99 s, at_least: 90 %", 3, [("to", "1 s, 2 times")]),
    (EN, "from: 0.06 s, to: 1 s", 3, [("at_least", "anywhere")]),
    (EN, "from: 0.06 s, to: 1 s, at_least: 80 %", 3, [("at_least", "may fall to 80 %")]),
    (EN, "from: 0.06 s, to: 1 s, at_least: 90 %, damping: 4 %", 3, [("damping", "5 % damped")]),
    (EN.replace("0.25", "0.28"), "from: 0.06 s, to: 1 s, at_least: 90 %", 3, [("target", "ag S, 0.322 g")]),
    (ASCE, "from: 0.06 s, to: 1 s, at_least: 90 %", 11, []),
    (ASCE, "from: 0.06 s, to: 1 s, at_least: 90 %", 10, [("use", "16.2.2")]),
    (ASCE, "from: 0.2 s, to: 0.7 s", 11, [("from", "16.2.3.1"), ("to", "16.2.3.1"), ("at_least", "16.2.3.2")]),
    (GB, "from: 0.2 s, to: 0.7 s", 1, []),
    ("{0.1 s: 1 g, 2 s: 1 g}", "from: 0.2 s, to: 0.7 s", 1, []),
]
"""Target, rest of the scale, number of motions, and what is told: the last key of its path and a word."""


@pytest.mark.parametrize(("target", "rest", "count", "told"), SUITE_RULES)
def test_what_a_code_asks_of_motions_is_told(target, rest, count, told):
    """Buildings of 0.3 and 0.5 s, one on soil and a wall, whose first periods are not those of the scenes;
    motions with a peak of 0.3 g. Fails if a clause is not looked at, or one that is met is told."""
    scale = yaml.safe_load(f"{{spectrum: mean, target: {target}, {rest}}}")
    spec = RecordsSpec.model_validate({"use": ["taft"], "scale": scale})
    built = None
    if isinstance(spec.scale.target, CodeTargetSpec):
        code = spec.scale.target.build(spec.scale.damping)
        built = TargetSpectrum(code.periods, code.values, 0.06, 1.0)
    use = MotionUse(MotionItem("m"), "user", "", 1.0, 10.0, 0.3 * GRAVITY, 1.0)
    suite = Suite({f"m{number}": use for number in range(count)}, built, ())
    first, second, third, wall = (
        build_building(name, BuildingSpec.model_validate(keys))
        for name, keys in {
            "a": {"storeys": 2, "period": 0.3, "yield_shear": "never"},
            "b": {"storeys": 2, "period": 0.5, "yield_shear": "never"},
            "c": {
                "storeys": 2,
                "period": 0.1,
                "yield_shear": "never",
                "foundation": {"inertia": 1e5, "rocking_stiffness": 1e10},
            },
            "w": {"wall": "fixed"},
        }.items()
    )
    group = Group((first, second, third, wall), {})
    found = list(check_suite(SimpleNamespace(records=spec, suite=suite, group=group)))
    assert [issue.path[-1] for issue in found] == [key for key, _ in told]
    assert all(word in issue.message for issue, (_, word) in zip(found, told, strict=True))

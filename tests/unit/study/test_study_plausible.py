"""Unlikely input is warned of, with the value in a person's unit and what may have been meant; and it runs."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from pounding_cli.cli.main import cli
from pounding_cli.study import expand, load, load_study
from pounding_cli.study.kinds import kind_of_file, load_for
from pounding_cli.study.plausible import RANGES, few, shown

STUDY = """\
records: {use: [elcentro], duration: 5 s, scale: {pga: 0.35 g}}
buildings:
  A: {storeys: 5, period: 0.36 s, height: &h 3.2 m, mass: 200 t, damping: 5 %, yield: {base_shear: 0.10 W}}
  B: {storeys: 3, stiffness: [200 kN/mm, 200 kN/mm, 200 kN/mm], height: *h, yield_shear: [900 kN, 900 kN, 900 kN]}
group: [A, B]
impact: {stiffness: 20 x stiffest storey}
cases:
  gap: {link: pounding, gap: 2 cm}
  con: {link: connector, gap: 5 cm, stiffness: 1/5 mean storey, floors: [3]}
"""

# what is written in place of what, the value shown, what is suggested
SLIPS = {
    "gap in metres": ("gap: 2 cm", "gap: §2", "gap is 2 m:", "did you mean 2 cm?"),
    "gap in metres, with its unit": ("gap: 2 cm", "gap: §2 m", "gap is 2 m:", "did you mean 2 cm?"),
    "gap of nearly nothing": ("gap: 2 cm", "gap: §0.002 mm", "gap is 0.002 mm:", "did you mean 0.002 m?"),
    "mass in kilograms": ("mass: 200 t", "mass: §200", "floor mass is 200 kg:", "did you mean 200 t?"),
    "one mass of a list": (
        "mass: 200 t",
        "mass: [200 t, 200 t, §200, 200 t, 200 t]",
        "floor mass is 200 kg:",
        "did you mean 200 t?",
    ),
    "height in centimetres": (
        "&h 3.2 m",
        "§&h 3.2 cm",
        "storey height is 3.2 cm:",
        "did you mean 3.2 m?",
    ),
    "height of a bare number": (
        "&h 3.2 m",
        "§&h 320",
        "height is 320 m:",
        "did you mean 320 cm?",
    ),
    "period": ("0.36 s", "§36 s", "a period of 36 s for 5 storeys, 7.2 s a storey:", "did you mean 0.36 s?"),
    "short period": ("0.36 s", "§0.036 s", "a period of 0.036 s for 5 storeys, 0.0072 s", "did you mean 0.36 s?"),
    "stiffness in N/m": (
        "stiffness: [200 kN/mm,",
        "stiffness: [§200 N/m,",
        "these stiffnesses give a period of",
        "did you mean 200 kN/mm?",
    ),
    "yield shear in N": ("yield_shear: [900 kN,", "yield_shear: [§900,", "yields at 900 N, 0.00015 of", "900 kN?"),
    "damping": ("5 %", "§50 %", "damping ratio is 50 %:", "did you mean 5 %?"),
    "damping as a fraction": ("5 %", "§0.5", "damping ratio is 50 %:", "did you mean 5 %?"),
    "base shear": ("0.10 W", "§0.001 W", "base shear is 0.1 %: codes design", "did you mean 1 %?"),
    "base shear in per cent": ("0.10 W", "§10 W", "base shear is 10 W: codes design", "did you mean 10 %?"),
    "impact stiffness": (
        "stiffness: 20 x stiffest storey",
        "stiffness: §20",
        "the impact stiffness is 20 N/m,",
        "did you mean 20 x stiffest storey?",
    ),
    "connector": ("1/5 mean storey", "§2 N/m", "the link stiffness is 2 N/m,", "did you mean 2 kN/mm?"),
    "pga": ("pga: 0.35 g", "pga: §0.35", "pga: 0.35 has no unit: it is 0.35 m/s2 = 0.036 g", "write `0.35 g`"),
    "scale": ("scale: {pga: 0.35 g}", "scale: §200", "'elcentro' peaks at", "check `unit:`"),
}


def read(folder: Path, text: str):
    path = folder / "slip.yaml"
    path.write_text(text)
    return load_study(path)


def loaded(path: Path):
    """A study of any kind."""
    return load_for(path, kind_of_file(path))


def test_a_plain_study_is_not_warned_of(tmp_path):
    assert read(tmp_path, STUDY).warnings == ()


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_told_at_its_place_with_what_was_meant(tmp_path, slip):
    old, new, message, hint = SLIPS[slip]
    assert STUDY.count(old) == 1
    text = STUDY.replace(old, new)
    before = text[: text.index("§")]
    study = read(tmp_path, text.replace("§", ""))
    (warning,) = study.warnings
    assert message in warning.message
    assert hint in warning.hint
    assert (warning.line, warning.column) == (before.count("\n") + 1, len(before) - before.rfind("\n"))
    assert len(expand(study).rows) == 4  # it runs all the same


def test_a_value_of_the_sweep_is_told_at_its_place_and_the_one_it_replaces_is_not(tmp_path):
    text = STUDY.replace("gap: 2 cm", "gap: 2") + "sweep: {cases.gap.gap: [1 cm, 3 m]}\n"
    (warning,) = read(tmp_path, text).warnings
    assert warning.message.startswith("gap is 3 m:")
    assert (warning.line, warning.column) == (10, 31)


@pytest.mark.parametrize(
    ("range_", "told"),
    [
        ("{from: 0.01 g, to: 1 g, step: 0.01 g}", []),  # the first intensities of an incremental dynamic analysis
        ("[0.02 g, 0.3 g]", ["0.196 m/s2"]),
    ],
)
def test_low_ends_of_a_range_of_intensities_are_meant(tmp_path, range_, told):
    warnings = read(tmp_path, STUDY + f"sweep: {{records.scale.pga: {range_}}}\n").warnings
    assert [one.message.split(":")[0] for one in warnings] == [
        f"peak ground acceleration asked for is {one}" for one in told
    ]


BARE = {
    "pga": ("{pga: §0.4}", "", "pga: 0.4 has no unit: it is 0.4 m/s2 = 0.041 g", "write `0.4 g`, or `0.4 m/s2`"),
    "a fraction": ("{pga: §1/3}", "", "pga: 1/3 has no unit: it is 0.3333 m/s2 = 0.034 g", "write `1/3 g`"),
    "the largest": ("{pga: §3}", "", "pga: 3 has no unit: it is 3 m/s2 = 0.306 g", "write `3 g`"),
    "sa": ("{sa: §0.8, period: 0.5 s}", "", "sa: 0.8 has no unit: it is 0.8 m/s2 = 0.082 g", "write `0.8 g`"),
    "a target": (
        "{spectrum: mean, target: {0.1 s: §0.8, 2 s: 0.2}, from: 0.2 s, to: 1.2 s}", "",
        "target: 0.8, 0.2 have no unit: 0.8 is 0.8 m/s2 = 0.082 g", "write `0.8 g`",
    ),
    "swept": (
        "{pga: 0.4}", "sweep: {records.scale.pga: [§0.1, 0.2, 0.4]}",
        "pga: 0.1, 0.2, 0.4 have no unit: 0.1 is 0.1 m/s2 = 0.010 g", "write `0.1 g`",
    ),
    "a swept range": (
        "{pga: 0.4 g}", "sweep: {records.scale.pga: {from: §0.01, to: 0.3, count: 3}}",
        "pga: 0.01, 0.3 have no unit: 0.01 is 0.01 m/s2 = 0.001 g", "write `0.01 g`",
    ),
    "swept scales": (
        "1.0", "sweep: {records.scale: [{pga: §0.4}, {pga: 0.5 g}]}",
        "pga: 0.4 has no unit: it is 0.4 m/s2 = 0.041 g", "write `0.4 g`",
    ),
    "a list of axes": (
        "{sa: 1 g, period: 1 s}", "sweep: [{records.scale.sa: [§0.4, 0.8]}]",
        "sa: 0.4, 0.8 have no unit: 0.4 is 0.4 m/s2 = 0.041 g", "write `0.4 g`",
    ),
    "a bracket": (
        "{pga: 0.4}", "bracket: {records.scale.pga: [§0.2, 0.4, 0.6]}",
        "pga: 0.2, 0.4, 0.6 have no unit: 0.2 is 0.2 m/s2 = 0.020 g", "write `0.2 g`",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BARE)
def test_an_acceleration_without_unit_that_may_be_meant_in_g_is_told(tmp_path, name):
    scale, more, message, hint = BARE[name]
    text = STUDY.replace("{pga: 0.35 g}", scale) + more + "\n"
    before = text[: text.index("§")]
    (warning,) = read(tmp_path, text.replace("§", "")).warnings
    assert warning.message == message
    assert hint in warning.hint
    assert (warning.line, warning.column) == (before.count("\n") + 1, len(before) - before.rfind("\n"))


@pytest.mark.parametrize(
    ("scale", "more"),
    [
        ("{pga: 0.4 g}", ""),
        ("{pga: 0.5 m/s2}", ""),
        ("{pga: 3.5}", ""),  # 0.36 g: nobody writes that many g
        ("{sa: 0.8 m/s2, period: 0.5 s}", ""),
        ("0.4", ""),  # a factor
        ("1.0", "sweep: {records.scale: [0.4, 1.0]}"),
        ("{pga: 0.4 g}", "sweep: {records.scale.pga: [0.1 g, 0.4 g]}"),
    ],
)
def test_an_acceleration_with_its_unit_is_not(tmp_path, scale, more):
    assert read(tmp_path, STUDY.replace("{pga: 0.35 g}", scale) + more + "\n").warnings == ()


def test_of_many_values_alike_the_first_are_told_and_the_rest_counted(tmp_path):
    values = ", ".join(map(str, range(2, 10)))
    warnings = read(tmp_path, STUDY + f"sweep: {{cases.gap.gap: [{values}]}}\n").warnings
    assert [warning.message.split(":")[0] for warning in warnings] == ["gap is 2 m", "gap is 3 m", "gap is 4 m"]
    assert warnings[-1].message.endswith("; and 5 more like it")
    assert few(warnings[:2]) == list(warnings[:2])


def test_no_gap_and_no_damping_are_plausible():
    assert RANGES["gap"].holds(0.0)
    assert RANGES["damping ratio"].holds(0.0)
    assert not RANGES["gap"].holds(1e-6)


@pytest.mark.parametrize(
    ("value", "what", "text"),
    [(2.0, "gap", "2 m"), (0.02, "gap", "2 cm"), (0.36, "period", "0.36 s"), (2e5, "floor mass", "200 t")],
)
def test_values_are_shown_in_the_unit_a_person_would_use(value, what, text):
    assert shown(value, RANGES[what].units) == text


def test_values_that_are_unlikely_together_only_are_told_with_their_combination(tmp_path):
    """1600 t or 25 kN/mm alone are plausible. Fails if only one axis is looked along, or an axis apart is named."""
    mass, stiffness = "buildings.B.mass: [200 t, 1600 t]", "buildings.B.stiffness.0: [200 kN/mm, 25 kN/mm]"
    sweep = f"sweep: {{{mass}, impact.restitution: [0.4, 0.6], {stiffness}}}\n"
    (warning,) = read(tmp_path, STUDY.replace(", yield_shear: [900 kN, 900 kN, 900 kN]", "") + sweep).warnings
    assert warning.message.startswith("these stiffnesses give a period of 2.85 s for 3 storeys")
    assert warning.message.endswith("(where buildings.B.mass = 1600 t, buildings.B.stiffness.0 = 25 kN/mm)")
    assert (warning.line, warning.column) == (10, sweep.index("25 kN/mm") + 1)


def test_the_corners_of_a_large_sweep_are_bounded():
    """Fails if 2^20 combinations are looked at, or a value between two others is taken for an end."""
    axes = tuple(load.Axis((f"key{number}",), ((3.0,), (1.0,), (2.0,))) for number in range(20))
    corners = list(load._corners(axes))
    assert len(corners) == load.MOST_CORNERS
    assert corners[0][:8] == (1,) * 8
    assert corners[-1][:8] == (0,) * 8


WALL = "title: w\nwall: {length: 2 m, thickness: 25 cm}\nstriker: {mass: 200 t, speed: 0.5 m/s}\n"
PAIR = "title: c\nfirst: {mass: 200 t, stiffness: 30 kN/mm}\nsecond: {period: 0.6 s}\ndamping: 5 %\n"


@pytest.mark.parametrize(
    ("text", "old", "new", "message", "hint"),
    [
        (WALL, "200 t", "§200", "striker mass is 200 kg:", "did you mean 200 t?"),
        (WALL, "0.5 m/s", "§50 m/s", "striker speed is 50 m/s:", "did you mean 50 cm/s?"),
        (WALL, "25 cm", "§25 mm", "wall thickness is 2.5 cm:", "did you mean 25 cm?"),
        (PAIR, "0.6 s", "§60 s", "second period is 60 s:", "did you mean 6 s?"),
        (PAIR, "5 %", "§50 %", "damping is 50 %:", "did you mean 5 %?"),
        (PAIR, "30 kN/mm", "§30 N/m", "mass and stiffness give the first system a period of 513 s:", "check the units"),
        (PAIR + "sweep: {damping: [4 %, 6 %]}\n", "6 %]", "§60 %]", "damping is 60 %:", "did you mean 6 %?"),
    ],
)
def test_studies_of_the_wall_and_of_two_oscillators_are_looked_at_too(tmp_path, text, old, new, message, hint):
    """Fails if a value of theirs passes in silence, is told at another place, or is refused."""
    path = tmp_path / "slip.yaml"
    path.write_text(text)
    assert loaded(path).warnings == ()
    written = text.replace(old, new)
    before = written[: written.index("§")]
    path.write_text(written.replace("§", ""))
    found = CliRunner().invoke(cli, ["check", str(path)])
    assert found.exit_code == 0, found.stderr
    assert found.stderr.count("warning: ") == 1
    assert f"slip.yaml:{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}: {message}" in found.stderr
    assert hint in found.stderr


@pytest.mark.parametrize("path", sorted(Path("configs").rglob("*.yaml")), ids=str)
def test_no_study_that_ships_is_doubted(path):
    said = [warning.message for warning in loaded(path).warnings]
    assert [one for one in said if not one.startswith("where the mass varies")] == []  # the paper states the periods


@pytest.mark.parametrize("name", sorted(path.stem for path in Path("pounding_cli/study/templates").glob("*.yaml")))
def test_no_template_is_doubted(tmp_path, name):
    from pounding_cli.study.template import TEMPLATES

    path = tmp_path / "new.yaml"
    path.write_text(TEMPLATES[name].written("new"))
    assert loaded(path).warnings == ()

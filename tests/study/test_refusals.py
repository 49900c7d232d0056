"""Wrong studies are refused, and doubtful ones warned of, at their place: `refusals.yaml` has them."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pounding_cli.cli.main import cli
from tests.adapter import refused

TABLE = yaml.safe_load(Path(__file__).with_name("refusals.yaml").read_text(encoding="utf-8"))
WRONG = [(part["study"], row) for part in TABLE for row in part.get("wrong", ())]
DOUBTED = [(part["study"], row) for part in TABLE for row in part.get("doubted", ())]


def changed(study: str, row: list) -> tuple[str, tuple[int, int], str]:
    """The study of a row, the line and column that are told, and the word."""
    *changes, word = (part for part in row if isinstance(part, str))
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert old in study
        study = study.replace(old, new, 1) if old else f"{study}{new}\n"
    if "§" not in study:
        return study, tuple(row[-2:]), word
    before = study[: study.index("§")]
    return study.replace("§", ""), (before.count("\n") + 1, len(before) - before.rfind("\n")), word


def told(folder: Path, study: str) -> list[str]:
    """Warnings of `pound check`, which takes the study."""
    path = folder / "study.yaml"
    path.write_text(study, encoding="utf-8")
    done = CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False)
    assert done.exit_code == 0
    return done.stderr.replace(str(path), "study").split("warning: ")[1:]


@pytest.mark.parametrize(("study", "row"), WRONG, ids=[str(row) for _, row in WRONG])
def test_refused_at_its_place(study, row):
    text, place, word = changed(study, row)
    problems = refused(text)
    assert any((line, column) == place and word in words for line, column, words in problems), problems


@pytest.mark.parametrize(("study", "row"), DOUBTED, ids=[str(row) for _, row in DOUBTED])
def test_doubted_at_its_place(tmp_path, study, row):
    text, (line, column), word = changed(study, row)
    (warning,) = told(tmp_path, text)
    assert warning.startswith(f"study:{line}:{column}: ")
    assert word in warning


THREE = """\
buildings:
  A: {storeys: 6, period: 0.4 s, mass: 100 t, height: 3 m}
  B: {like: A}
group: [A, B]
records: {use: [elcentro]}
analyses: [elastic]
cases: {case: {gap: 5 cm, link: [pounding]}}
"""


def test_what_stands_for_a_list_of_links_is_sound():
    """Fails if the example of a refusal is itself refused."""
    ((_, _, words),) = refused(THREE)
    assert refused(THREE.replace("link: [pounding]", words.split("`")[-2])) == []


@pytest.mark.parametrize(
    ("floors", "hint"), [("7", "write floors among 1, 2, 3, 4, 5, 6"), ("base", "6"), ("[[6, 7]]", "")]
)
def test_a_floor_that_is_not_there_is_never_suggested(floors, hint):
    """Fails if `[[7, 6]]` or `[[0, 1]]` is told where there is no seventh floor, and no base that moves."""
    study = THREE.replace("link: [pounding]", f"link: pounding, floors: {floors}")
    ((_, _, words),) = refused(study)
    assert words.endswith(hint)
    assert "[[" not in words


@pytest.mark.parametrize(
    ("force", "unit"),
    [
        ("k*v**0.5", "MN/m^0.5"),
        ("k*v**1.25", "MN/m^1.25"),
        ("k*v*m**0.3/m**0.3", "kN/(mm s2)*s^2"),
        ("k*r", "kN/(m/s)"),
    ],
)
def test_powers_and_brackets_in_units_are_read(force, unit):
    """Fails if a formula whose force is in N is refused for the unit of its parameter."""
    (study,) = {study for study, _ in WRONG if "rubber: {force" in study}
    study = study.replace('"k*v", parameters: {k: 1 kN/mm', f'"{force}", parameters: {{k: 1 {unit}')
    assert refused(study) == []


@pytest.mark.parametrize("part", [part for part in TABLE if part["study"].count("\n") > 1])
def test_the_studies_themselves_are_sound(tmp_path, part):
    """Fails if a study is wrong or doubtful before it is changed: then its rows would show nothing."""
    assert refused(part["study"]) == []
    assert "doubted" not in part or told(tmp_path, part["study"]) == []


@pytest.mark.parametrize(
    "more",
    [
        "{pga: 0.5 m/s2}", "{pga: 3.5}", "0.4", "1.0\nsweep: {records.scale: [0.4, 1.0]}",
        "{pga: 0.4 g}\nsweep: {records.scale.pga: {from: 0.01 g, to: 1 g, step: 0.01 g}}",
    ],
)  # fmt: skip
def test_what_is_meant_is_not_doubted(tmp_path, more):
    """Accelerations with their unit, or too large for g; factors; the low end of a range of intensities."""
    study = next(study for study, _ in DOUBTED if "records" in study)
    scale, _, sweep = more.partition("\n")
    assert told(tmp_path, study.replace("{pga: 0.35 g}", scale) + sweep + "\n") == []


def test_everything_wrong_is_told_at_once_in_the_order_of_the_lines():
    (study,) = {study for study, _ in WRONG if study.startswith("title: Test")}
    for old, new in (("0.36 s", "0.36 kg"), ("0.5}", "2}"), ("5 cm", "-1"), ("[elastic]", "[elastic]\naccuracy: 1")):
        study = study.replace(old, new)
    assert [line for line, _, _ in refused(study)] == [7, 10, 12, 14]


MISTAKEN = """\
records: {use: [elcentro], duration: 3 s}
buildings:
  A: {storeys: 3, period: 0.36 s, heigth: 3 m}
  B: {like: AA, period: 0.6 s, mas: 3 t}
group: [A, C]
impact: {law: hertzz, stiffness: 20 x stiffest storey of D, restitutoin: 0.5}
cases:
  c: {link: bumper, gap: 1 cm, stifness: 1 kN/mm}
  d: {link: pounding, gapp: 1 cm}
  e: {gap: 1 cm, links: [{link: connector, stiffnes: 1 kN/mm}, {link: pundig, pair: 4}, pumper]}
analyses: [elastic, plastic]
report: {plot: [f], building: Z}
keep: {histories: {cases: [g]}}
sweep: {impact.restitutoin: [0.4, 0.5]}
"""


def test_names_keys_and_laws_are_told_in_one_pass():
    """Fails if a name of a building or case, a key or a law of a link is told only when the others are corrected."""
    told = refused(MISTAKEN)
    wrong = (
        *("heigth", "'AA'", "'mas'", "'C'", "hertzz", "'D'", "unknown key 'restitutoin'", "bumper", "stifness", "gapp"),
        *("stiffnes'", "pundig", "pair: 4", "pumper", "plastic", "'f'", "'Z'", "'g'", "axis 'impact.restitutoin'"),
    )
    for word in wrong:
        assert any(word in words.partition("\n")[0] for _, _, words in told), word
    assert len(told) == len(wrong)


def test_floors_are_looked_at_beside_an_unknown_law():
    """Fails if a floor that no pair has is told only when the law of contact is corrected."""
    (study,) = {study for study, _ in WRONG if study.startswith("title: Test")}
    study = study.replace("restitution: 0.5", "law: hertzz").replace("gap: 5 cm", "gap: 5 cm, floors: 9")
    assert [line for line, _, _ in refused(study)] == [10, 12]


@pytest.mark.parametrize(
    ("change", "place", "word"),
    [
        ({"group": ["stiff", "sofft"]}, "group.1", "sofft"),
        ({"cases": {"gap": {"link": "pounding", "gap": -0.01}}}, "cases.gap.gap", "least"),
        ({"cases": {"gap": {"link": "pounding", "gap": 0.01, "gaap": 1}}}, "cases.gap.gaap", "unknown"),
        ({"records": {"use": ["tuft"]}}, "records.use.0", "tuft"),
        ({"records": {"use": [object()]}}, "records.use.0", "value"),
        ({"sweep": {"cases.gap.gap": [0.01, -0.02]}}, "sweep.cases.gap.gap.1", "least"),
    ],
)
def test_a_study_as_a_dict_is_refused_at_its_key(change, place, word):
    data = {
        "records": {"use": ["elcentro"]},
        "buildings": {"stiff": {"storeys": 2, "period": "0.3 s"}, "soft": {"storeys": 2, "period": 0.5}},
        "group": ["stiff", "soft"],
        "cases": {"gap": {"link": "pounding", "gap": 0.01}},
    }
    assert refused(data) == []
    ((_, _, said),) = refused({**data, **change})
    assert said.startswith(f"{place}: ")
    assert word in said


@pytest.mark.parametrize("content", [b"\xff\xfe\x00\x01", b"a: \x00\n", b"[" * 5000, "é: ü\n".encode("latin-1")])
def test_bytes_that_are_no_text(tmp_path, content):
    path = tmp_path / "study.yaml"
    path.write_bytes(content)
    done = CliRunner().invoke(cli, ["check", str(path)])
    assert type(done.exception).__name__ == "InputError"


SWEPT = TABLE[0]["study"] + "sweep:\n  impact.restitution: [0.4, 0.6]\n"
TOKENS = sorted({part for part in SWEPT.replace(",", " ").replace("{", " ").replace("}", " ").split() if part})
WORDS = (
    "", "~", "true", "0", "-1", "1e999", ".nan", "0:36", "[]", "{}", "[[]]", "{a: 1}", "5 cm", "5 kg", "1/0", "none",
    "infill", "all", "never", "{arias: taft}", "stiff", "like", "{link: infill}", "!!int x", "&a [*a]", "*b", "\t", "'",
)  # fmt: skip


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.tuples(st.sampled_from(TOKENS), st.sampled_from(WORDS)), min_size=1, max_size=3))
def test_whatever_is_written_is_taken_or_refused(changes):
    """Fails if junk in place of words ends in anything but a refusal with words."""
    study = SWEPT
    for old, new in changes:
        study = study.replace(old, new, 1)
    assert all(words for _, _, words in refused(study))

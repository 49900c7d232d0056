"""Keys that were meant otherwise are refused where they stand, with what was meant: never a traceback."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from pounding_cli.cli.main import cli
from pounding_cli.errors import InputError
from pounding_cli.study import load_study

STUDY = """\
title: keys
records: {use: [elcentro], duration: 5 s, scale: 1.0}
buildings:
  stiff: {storeys: 2, period: 0.36 s}
  soft: {like: stiff, period: 0.60 s}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 2 cm}}
"""
SOFT, CASES = "{like: stiff, period: 0.60 s}", "{gap: {link: pounding, gap: 2 cm}}"
STIFF = "{storeys: 2, period: 0.36 s}"

# what is written in place of what, or behind the study; message; hint. § marks the place that is told.
SLIPS = {
    "a building without its section": (
        "", "sweep: {§soft.period: [0.5 s, 1.0 s]}", "sweep axis 'soft.period': no key 'soft'",
        "did you mean 'buildings.soft.period'?",
    ),
    "the same with a range": (
        "", "sweep: {§soft.period: {from: 0.5 s, to: 1.0 s, count: 3}}", "sweep axis 'soft.period': no key 'soft'",
        "did you mean 'buildings.soft.period'?",
    ),
    "uncertain": (
        "", "uncertain: {§soft.period: {uniform: {from: 0.5 s, to: 1.0 s}}}", "the key 'soft.period': no key 'soft'",
        "did you mean 'buildings.soft.period'?",
    ),
    "a key of the impact": (
        "", "sweep: {§restitution: [0.4, 0.5]}", "sweep axis 'restitution': no key 'restitution'",
        "did you mean 'impact.restitution'?",
    ),
    "a case that is called as a section": (
        "", "sweep: {§gap.gap: [1 cm, 2 cm]}", "sweep axis 'gap.gap': no such key", "did you mean 'cases.gap.gap'?",
    ),
    "a key that is nowhere": (
        "", "sweep: {§foo.bar: {from: 1 cm, to: 2 cm, count: 3}}", "sweep axis 'foo.bar': no key 'foo'",
        "known: title, records",
    ),
    "a key below a number": (
        "", "sweep: {§records.scale.pga: [0.1 g, 0.2 g]}",
        "sweep axis 'records.scale.pga': 'records.scale' is '1.0' in this study and has no key 'pga'",
        "give 'records.scale' as a mapping with 'pga' in it",
    ),
    "like a number": (SOFT, "{like: §5}", "like: no building '5' is defined", "known: stiff"),
    "like a fraction": (SOFT, "{like: §1.5, period: 1 s}", "like: no building '1.5' is defined", "known: stiff"),
    "a case without a name": (
        CASES, "§{link: pounding, gap: 5 cm}", "the case under `cases:` has no name",
        "write e.g. `cases: {pair: {link: pounding, gap: 5 cm}}`; 'pair' names the case",
    ),
    "a case without a name, swept": (
        CASES, "§{link: pounding, gap: 5 cm}\nsweep: {cases.gap.gap: [1 cm, 2 cm]}",
        "the case under `cases:` has no name", "write e.g. `cases: {gap: {link: pounding, gap: 5 cm}}`",
    ),
    "a case without a name, bracketed": (
        CASES, "§{link: pounding, gap: 5 cm}\nbracket: {cases.gap.gap: [1 cm, 2 cm, 3 cm]}",
        "the case under `cases:` has no name", "`cases: {",
    ),
    "a case without a name, in lines of its own": (
        "cases: " + CASES, "cases:\n  §link: pounding\n  gap: 5 cm", "the case under `cases:` has no name",
        "write e.g. `cases: {pair: {link: pounding, gap: 5 cm}}`",
    ),
    "a building without a name": (
        "buildings:\n  stiff: {storeys: 2, period: 0.36 s}\n  soft: {like: stiff, period: 0.60 s}\n",
        "buildings: §{storeys: 2, period: 0.36 s}\n", "the building under `buildings:` has no name",
        "write e.g. `buildings: {A: {storeys: 2, period: 0.36 s}}`; 'A' names the building",
    ),
    "a unit behind a list": (
        STIFF, "{stiffness: [696194, 650000] §kN/m}",
        "YAML ends the list at its bracket: 'kN/m' behind it belongs to no value",
        "write the unit at each value: `stiffness: [696194 kN/m, 650000 kN/m]`",
    ),
    "a unit behind a list, and more": (
        STIFF, "{stiffness: [696194, 650000] §kN/m, mass: 200 t}", "YAML ends the list at its bracket: 'kN/m'",
        "`stiffness: [696194 kN/m, 650000 kN/m]`",
    ),
    "a unit behind a list in lines of its own": (
        STIFF, "\n    mass: [200,\n      150.5 t] §t  # with the roof\n    period: 0.36 s",
        "YAML ends the list at its bracket: 't' behind it", "`mass: [200 t, 150.5 t]`",
    ),
    "a unit behind swept values": (
        "", "sweep:\n  buildings.soft.period: [0.5, 0.6] §s", "YAML ends the list at its bracket: 's' behind it",
        "`buildings.soft.period: [0.5 s, 0.6 s]`",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SLIPS)
def test_a_slip_is_told_at_its_place_with_what_was_meant(tmp_path: Path, name: str) -> None:
    old, new, message, hint = SLIPS[name]
    text = STUDY.replace(old, new) if old else f"{STUDY}{new}\n"
    before = text[: text.index("§")]
    path = tmp_path / "study.yaml"
    path.write_text(text.replace("§", ""), encoding="utf-8")
    with pytest.raises(InputError) as refused:
        load_study(path)
    (problem,) = refused.value.problems
    assert message in problem.message
    assert hint in problem.hint
    assert (problem.line, problem.column) == (before.count("\n") + 1, len(before) - before.rfind("\n"))
    with pytest.raises(InputError):
        CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False)


def test_what_is_no_unit_behind_a_list_is_told_as_before(tmp_path: Path) -> None:
    path = tmp_path / "study.yaml"
    path.write_text(STUDY.replace(STIFF, "{mass: [200 t, 200 t] period: 0.36 s}"), encoding="utf-8")
    with pytest.raises(InputError, match="this is not YAML"):
        load_study(path)


def test_a_building_may_be_like_one_whose_name_is_a_number(tmp_path: Path) -> None:
    path = tmp_path / "study.yaml"
    text = STUDY.replace("stiff: {storeys", "5: {storeys").replace(SOFT, "{like: 5, period: 0.6 s}")
    path.write_text(text.replace("[stiff,", "[5,"), encoding="utf-8")
    assert load_study(path).building((), 1).storeys == 2

"""Every refused input says where it stands, what is wrong and what to write instead."""

from __future__ import annotations

import pytest

STIFF = "stiff: {storeys: 3, period: 0.36 s, mass: 200 t}"
SOFT = "soft: {like: stiff, period: 0.60 s}"
GAP = "gap: {link: pounding, gap: 5 cm}"
GROUP = "group: [stiff, soft]"

# (old, new with § where the problem stands, words of the message, words of the hint)
CASES = {
    "unknown key": ("title:", "§titel:", "unknown key 'titel'", "did you mean 'title'?"),
    "unknown building key": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s, §heigth: 3 m}",
        "'heigth'",
        "'height'",
    ),
    "beta of a smooth storey": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s, storey_law: bouc-wen, §wen_beta: 0.5}",
        "unknown key 'wen_beta'",
        "beta = 1 - gamma",
    ),
    "unknown case key": (GAP, "gap: {link: pounding, gap: 5 cm, §flors: [1]}", "'flors'", "'floors'"),
    "unknown record file key": ("taft", "{file: x.txt, §dtt: 1}", "'dtt'", "'dt'"),
    "unknown key in elsewhere": (
        GAP,
        "gap: {link: pounding, gap: 5 cm, floors: [1], elsewhere: {§gapp: 1 cm}}",
        "'gapp'",
        "'gap'",
    ),
    "wrong dimension": ("0.36 s", "§5 cm", "'5 cm' is no period: expected s", "e.g. 0.36 s"),
    "wrong dimension of a gap": (
        "5 cm",
        "§5 kg",
        "expected m",
        "write a gap [m] at least 0 m and at most 10 m, e.g. 5 cm",
    ),
    "unknown unit": ("5 cm", "§5 parsec", "'parsec' is not a unit", "e.g. 5 cm"),
    "sexagesimal": ("0.36 s", "§0:36", "'0:36' is not a number with a unit", "0.36 s"),
    "word for a number": ("5 cm", "§no", "'no' is not a number", "5 cm"),
    "truth for a number": ("5 cm", "§true", "true is not a gap", "5 cm"),
    "nothing": ("duration: 5 s", "duration:§", "nothing is not a duration", "table1 or whole"),
    "negative gap": ("5 cm", "§-5 cm", "the gap is -0.05 m; it must be at least 0 m", "5 cm"),
    "gap beyond reason": ("5 cm", "§50", "the gap is 50 m", "at most 10 m"),
    "negative mass": ("200 t", "§-200 t", "the mass is -200000 kg; it must be above 0 kg", "200 t"),
    "infinite": ("0.36 s", "§.inf", "'.inf' is not a number", "0.36 s"),
    "overflow": ("200 t", "§1e400 t", "not a finite number", "200 t"),
    "division by zero": ("200 t", "§1/0 t", "divides by zero", "200 t"),
    "restitution above 1": (
        "restitution: 0.5",
        "restitution: §1.5",
        "is 1.5; it must be above 0 and at most 1",
        "0.5",
    ),
    "restitution of 0": ("restitution: 0.5", "restitution: §0", "is 0; it must be above 0", "0.5"),
    "restitution and damping ratio": (
        "restitution: 0.5",
        "restitution: 0.5, §damping_ratio: 0.1",
        "'damping_ratio' and 'restitution' cannot both be given",
        "remove one",
    ),
    "stiffness rule misspelt": (
        "20 x stiffest",
        "§20 x stifest",
        "is not a stiffness",
        "20 x stiffest storey",
    ),
    "stiffness rule of nobody": (
        "20 x stiffest storey",
        "§20 x stiffest storey of stif",
        "no building 'stif' is defined",
        "did you mean 'stiff'?",
    ),
    "stiffness rule of zero": ("20 x", "§0 x", "the factor in '0 x stiffest storey' is 0", "20 x"),
    "key twice": (
        "title: Test",
        "title: Test\n§title: again",
        "'title' occurs twice; first in line 1",
        "remove one",
    ),
    "merge key": (
        SOFT,
        "soft: {§<<: {storeys: 3}, period: 1 s}",
        "merge keys (<<) are not used",
        "like: NAME",
    ),
    "decimal comma": ("0.36 s", "§'0,36 s'", "has a decimal comma, write `0.36 s`", "e.g. 0.36 s"),
    "decimal comma in brackets": (
        STIFF,
        "stiff: {storeys: 3, period: §0,36 s, mass: 200 t}",
        "'0,36 s' has a decimal comma: inside brackets a comma ends the value",
        "write `0.36 s`",
    ),
    "list for one value": (
        STIFF,
        "stiff: {storeys: 3, period: §[0.6, 0.2]}",
        "a list stands where one period belongs",
        "under `sweep:`",
    ),
    "mapping for one value": (STIFF, "stiff: {storeys: 3, period: §{s: 1}}", "a mapping stands where one", "0.36 s"),
    "comment that touches its value": (
        SOFT,
        "soft:\n    like: stiff\n    period: §0.60 s# secs",
        "a comment needs a blank before its #, write `0.60 s  # secs`",
        "0.36 s",
    ),
    "comment that hides a bracket": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s §# three}",
        "a # inside brackets hides the rest of its line, the closing bracket too",
        "behind the closing bracket",
    ),
    "no blank after a colon in brackets": (
        STIFF,
        "stiff: {storeys: 3, §period:0.36 s}",
        "'period:0.36 s' lacks a blank after its colon",
        "write `period: 0.36 s`",
    ),
    "no blank after a colon": (
        SOFT,
        "soft:\n    like: stiff\n    §period:0.60 s",
        "'period:0.60 s' lacks a blank after its colon",
        "write `period: 0.60 s`",
    ),
    "no blank after the only colon": (
        SOFT,
        "soft:\n    §period:0.60 s",
        "'period:0.60 s' lacks a blank after its colon",
        "write `period: 0.60 s`",
    ),
    "weight for a mass": (
        "200 t",
        "§2000 kN",
        "'2000 kN' is a force, not a mass: the weight of about 204 t",
        "`204 t`",
    ),
    "storeys are true": ("storeys: 3", "storeys: §true", "true is not a whole number", "e.g. 5"),
    "storeys with an underscore": ("storeys: 3", "storeys: §1_0", "'1_0' is not a whole number", "e.g. 5"),
    "storeys in fullwidth digits": ("storeys: 3", "storeys: §\uff13", "is not a whole number", "e.g. 5"),
    "period in fullwidth digits": ("0.36 s", "§\uff11 s", "is not a number with a unit", "0.36 s"),
    "building twice in two spellings": (
        SOFT,
        'soft: {like: stiff, period: 0.60 s}\n  §" soft": {like: stiff, period: 1 s}',
        "'soft' occurs twice; first in line 8",
        "remove one",
    ),
    "case twice in two spellings": (
        GAP,
        GAP + "\n  §' gap ': {link: none}",
        "'gap' occurs twice; first in line 12",
        "remove one",
    ),
    "floor twice in two spellings": (
        GAP,
        "gap: {link: pounding, gap: 5 cm, by_floor: {1: none, §01: pounding}}",
        "'1' occurs twice; first in line 12, column 47",
        "remove one",
    ),
    "target twice in two spellings": (
        "scale: 1.0",
        "scale: {spectrum: mean, target: §{0.1 s: 0.8 g, 100 ms: 0.2 g, 2 s: 0.1 g}, from: 0.2 s, to: 1 s}",
        "'0.1 s' and '100 ms' are one period",
        "remove one",
    ),
    "sweep value twice in two spellings": (
        "[elastic]",
        "[elastic]\nsweep:\n  impact.restitution: [0.5, 0.4, §1/2]",
        "0.5 and 1/2 are the same and stand on the axis",
        "remove one",
    ),
    "tag": ("0.36 s", "§!!python/name:os.system x", "is not used here", "plain value"),
}

RANGES = {
    "range of one": ("{from: 0.2 s, to: 1.5 s, count: §1}", "count: 1; a range has 2 to 10000 values", "list of one"),
    "range of millions": ("{from: 0.2 s, to: 1.5 s, count: §1900000}", "a range has 2 to 10000", "smaller count"),
    "range of half a value": ("{from: 0.2 s, to: 1.5 s, count: §2.5}", "'2.5' is not a whole number", "e.g. 15"),
    "range without count": ("§{from: 0.2 s, to: 1.5 s}", "neither 'count' nor 'step'", "one of them"),
    "range with both": ("§{from: 0.2 s, to: 1.5 s, count: 3, step: 0.1 s}", "both 'count' and 'step'", "one of them"),
    "range without end": ("§{from: 0.2 s, count: 3}", "lacks 'to'", "{from: 0.2 s, to: 1.5 s, count: 14}"),
    "range with another key": ("{from: 0.2 s, to: 1 s, §number: 3, count: 3}", "unknown key 'number'", "known: from"),
    "step that does not fit": ("{from: 0.2 s, to: 1.5 s, step: §0.4 s}", "that is 3.25 steps", "count: 4"),
    "step of zero": ("{from: 0.2 s, to: 1.5 s, step: §0 s}", "a step of zero leads nowhere", "towards `to:`"),
    "step backwards": ("{from: 0.2 s, to: 1.5 s, step: §-0.1 s}", "leads away from 'to'", "towards `to:`"),
    "step too small": ("{from: 0.2 s, to: 1.5 s, step: §1e-9 s}", "make 1.3e+09 values", "larger step"),
    "step in metres": ("{from: 0.2 s, to: 1.5 s, step: §1 m}", "'1 m' is no step of a period: expected s", "write"),
    "range in metres": ("{from: 0.2 s, to: §1 m, count: 3}", "'1 m' is no period: expected s", "e.g. 0.36 s"),
    "range to a bare number": ("{from: 0.2 s, to: §2, count: 3}", "2 has no unit", "without one it is 2 s"),
    "range of a point": ("{from: 0.2 s, to: §200 ms, count: 3}", "ends where it begins", "apart from"),
    "range beyond reason": ("{from: 0.2 s, to: §90 s, count: 3}", "the period is 90 s", "at most 60 s"),
    "log through zero": ("{from: §-1 s, to: 1.5 s, count: 3, spacing: log}", "above 0 s", "above 0 s"),
    "log with a step": ("{from: 0.2 s, to: 1.5 s, §step: 0.1 s, spacing: log}", "no step", "`count:`"),
    "unknown spacing": ("{from: 0.2 s, to: 1.5 s, count: 3, spacing: §logarithmic}", "is not known", "linear or log"),
}


@pytest.mark.parametrize("name", RANGES)
def test_range_refused(name, refused):
    """On an axis of its own and on one of two keys that move together."""
    text, message, hint = RANGES[name]
    refused(
        ("[elastic]", f"[elastic]\nsweep:\n  buildings.soft.period: {text}"),
        message=message,
        hint=hint,
    )
    refused(
        ("[elastic]", f"[elastic]\nsweep:\n  - {{buildings.soft.period: {text}, cases.gap.gap: [1 cm, 2 cm, 3 cm]}}"),
        message=message,
        hint=hint,
    )


def test_logarithmic_range_from_zero_is_refused(refused):
    refused(
        ("[elastic]", "[elastic]\nsweep:\n  cases.gap.gap: {from: 0 cm, to: 5 cm, count: 3, spacing: §log}"),
        message="a logarithmic range cannot reach zero",
        hint="above zero",
    )


@pytest.mark.parametrize("name", CASES)
def test_refused(name, refused):
    old, new, message, hint = CASES[name]
    refused((old, new), message=message, hint=hint)


def test_circle_is_told_once(refused):
    """Two buildings that are like each other: one problem, not one for each."""
    refused(
        (STIFF, "stiff: {like: soft, storeys: 3}"),
        ("like: stiff", "like: §stiff"),
        message="is circular",
    )


def test_missing_sections(refused):
    """A file with a title alone: the four sections it lacks, each with what to write."""
    problems = refused(text="title: x\n")
    assert {p.message for p in problems} == {
        f"'{key}' is missing" for key in ("records", "buildings", "group", "cases")
    }
    assert all(p.line == 1 and p.hint for p in problems)


def test_duration_of_table1_is_for_the_catalogue(refused, tmp_path):
    (tmp_path / "m.txt").write_text("\n".join(f"{i * 0.01:.2f} {0.1 * (-1) ** i}" for i in range(50)) + "\n")
    refused(
        ("[elcentro, taft]", "[{file: m.txt}]"),
        ("duration: 5 s", "duration: §table1"),
        message="table1 has no duration for 'm'",
        hint="`whole`",
    )
    refused(
        ("[elcentro, taft]", "[{file: m.txt}]"),
        ("scale: 1.0", "scale: §table1"),
        message="table1 has no scale for 'm'",
        hint="factor",
    )


def test_problem_inside_a_record_file_keeps_its_own_place(refused, tmp_path):
    """A record with a word among its numbers: the place told is in that file."""
    (tmp_path / "m.txt").write_text("0.00 0.1\n0.01 zero\n0.02 0.1\n")
    problems = refused(("taft", "{file: m.txt}"))
    assert [(p.file.endswith("m.txt"), p.line) for p in problems] == [(True, 2)]


def test_everything_in_one_go(refused):
    """Problems in six sections, in syntax, values and sweep, are all reported."""
    problems = refused(
        ("taft", "tafft"),
        ("0.36 s", "0.36 kg"),
        ("[stiff, soft]", "[stiff, sofft]"),
        ("restitution: 0.5", "restitution: 2"),
        (GAP, "gap: {link: infill, gap: 0}\n  other: {gap: 1 cm}\n  third: {link: pounding, gap: -1}"),
        ("[elastic]", "[elastic]\naccuracy: 1\nsweep: {tail: [1 s, -1 s]}"),
    )
    said = "\n".join(p.message for p in problems)
    for words in (
        "tafft",
        "0.36 kg",
        "sofft",
        "restitution is 2",
        "no thickness",
        "'link' is missing",
        "gap is -1 m",
    ):
        assert words in said, said
    assert "accuracy is 1" in said
    assert "tail is -1 s" in said
    assert [p.line for p in problems] == sorted(p.line for p in problems)


def test_fault_that_a_sweep_value_brings_out_elsewhere(refused):
    """Swept to a gap of zero, an infill loses its thickness: told at the value."""
    refused(
        (GAP, "gap: {link: infill, gap: 5 cm}"),
        ("[elastic]", "[elastic]\nsweep: {cases.gap.gap: [1 cm, §0 cm]}"),
        message="no thickness",
    )


def test_fault_that_a_sweep_value_brings_out_at_another_line(refused):
    """With one storey fewer the connector's floor is gone: told at the floor, naming the value."""
    refused(
        (GAP, "gap: {link: connector, gap: 5 cm, floors: [§3]}"),
        ("[elastic]", "[elastic]\nsweep: {buildings.stiff.storeys: [3, 2]}"),
        message="no common floor 3 (where buildings.stiff.storeys = 2)",
        hint="1, 2",
    )


def test_names_of_the_group_are_checked_though_every_building_is_faulty(refused):
    problems = refused(
        ("0.36 s", "-0.36 s"),
        ("period: 0.60 s", "period: 0.60 kg"),
        ("[stiff, soft]", "[stiff, §sofft]"),
        message="no building 'sofft' is defined",
        hint="did you mean 'soft'? known: stiff, soft",
        alone=False,
    )
    assert len(problems) == 3


def test_without_buildings_the_group_is_not_told_off_too(refused):
    text = "records: {use: [elcentro]}\ngroup: [stiff, soft]\ncases: {gap: {link: pounding, gap: 5 cm}}\n"
    (problem,) = refused(text=text)
    assert "'buildings' is missing" in problem.message

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
    "like nobody": ("like: stiff", "like: §stif", "no building 'stif' is defined", "did you mean 'stiff'?"),
    "no storeys": (STIFF, "stiff: §{period: 0.36 s}", "'storeys' is missing", "storeys: 5"),
    "no period": (STIFF, "stiff: §{storeys: 3}", "neither 'period' nor 'stiffness'", "period: 0.36 s"),
    "half a storey": ("storeys: 3", "storeys: §3.5", "'3.5' is not a whole number", "e.g. 5"),
    "zero storeys": ("storeys: 3", "storeys: §0", "must be at least 1", "at least 1"),
    "masses of another building": (
        "200 t",
        "§[200 t, 200 t]",
        "mass has 2 values for 3 storeys",
        "write 3 values",
    ),
    "stiffness beside period": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s, §stiffness: [3e9, 2e9, 1e9]}",
        "'stiffness' and 'period' cannot both be given",
        "'stiffness' stands in place of 'period' and 'taper'",
    ),
    "yield beside yield_shear": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s, yield: {zone: 0.4}, §yield_shear: never}",
        "'yield_shear' and 'yield' cannot both be given",
        "remove one",
    ),
    "rayleigh beside damping": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, damping: 5 %, §rayleigh: {alpha: 1, beta: 0.01}}",
        "'rayleigh' and 'damping' cannot both be given",
        "remove one",
    ),
    "damping in percent without the sign": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, damping: §5}",
        "is 5",
        "e.g. 5 %",
    ),
    "hardening of 1": (STIFF, "stiff: {storeys: 3, period: 1 s, hardening: §1}", "below 1", "0.05"),
    "unknown code": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: {code: §UBC-1990}}",
        "'UBC-1990' is not known",
        "'UBC-1985', 'UBC-1988', 'UBC-1991' or 'UBC-1994'",
    ),
    "Rw in 1985": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: {code: UBC-1985, §Rw: 12}}",
        "UBC-1985 has no Rw",
        "`K: 0.67`",
    ),
    "K in 1991": (STIFF, "stiff: {storeys: 3, period: 1 s, yield: {§K: 1}}", "UBC-1991 has no K", "`Rw: 12`"),
    "no K in 1985": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: §{code: UBC-1985}}",
        "'K' is missing",
        "K: 0.67",
    ),
    "no zone in 1985": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: §{code: UBC-1985, K: 1}}",
        "'zone' is missing",
        "zone: 1",
    ),
    "zone number": (STIFF, "stiff: {storeys: 3, period: 1 s, yield: {zone: §4}}", "factor Z is 4", "0.4"),
    "foundation that cannot move": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, foundation: §{}}",
        "cannot move",
        "foundation: fixed",
    ),
    "foundation mass without sway": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, foundation: {mass: §100 t, inertia: 1 t m2, rocking_stiffness: 1e9 N m}}",
        "'mass' has no effect without 'sway_stiffness'",
        "give 'sway_stiffness' too",
    ),
    "foundation without inertia": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, foundation: §{rocking_stiffness: 1e9 N m}}",
        "'inertia' is missing: 'rocking_stiffness' needs it",
        "above 0",
    ),
    "group of strangers": (
        GROUP,
        "group: [stiff, §sofft]",
        "no building 'sofft' is defined",
        "did you mean 'soft'?",
    ),
    "group of one": (
        GROUP,
        "group: §[stiff]",
        "the group has 1 building: pounding takes two",
        "at least two",
    ),
    "group of 21": (
        GROUP,
        "group: §[" + ", ".join(["stiff"] * 21) + "]",
        "the group has 21 buildings",
        "at most 20",
    ),
    "group is a word": (GROUP, "group: §stiff", "'stiff' is not a list", "[first, second, ...]"),
    "no common floor": (
        SOFT + "\n" + GROUP,
        "soft: {like: stiff, height: 2.9 m}\ngroup: [stiff, §soft]",
        "no floor at one elevation: 3, 6, 9 against 2.9, 5.8, 8.7 m",
        "storey heights agree",
    ),
    "record misspelt": ("taft", "§tafft", "no motion 'tafft'", "did you mean 'taft'?"),
    "record file missing": (
        "taft",
        "{file: §motions/x.AT2}",
        "motions/x.AT2 does not exist",
        "relative to the study file",
    ),
    "record twice": ("taft", "§elcentro", "the record 'elcentro' stands twice", "`name:`"),
    "record unit": ("taft", "{file: x.txt, unit: §cm/s}", "'cm/s' is no unit of acceleration", "g, m/s2, cm/s2"),
    "no records": ("[elcentro, taft]", "§[]", "'use' is empty", "catalogue names"),
    "no such arias reference": (
        "scale: 1.0",
        "scale: {arias: §elcentra}",
        "no record 'elcentra'",
        "'elcentro'",
    ),
    "scale of zero": ("scale: 1.0", "scale: §0", "the scale factor is 0", "above 0"),
    "pga in seconds": ("scale: 1.0", "scale: {pga: §1 s}", "expected m/s2", "0.35 g"),
    "scale in words": ("scale: 1.0", "scale: §table2", "'table2' is not a number", "table1"),
    "case without link": (
        GAP,
        "gap: §{gap: 5 cm}",
        "'link' is missing",
        "`link: pounding`, infill, connector or none",
    ),
    "case without gap": (GAP, "gap: §{link: pounding}", "'gap' is missing", "gap: 0 cm"),
    "unknown link": (GAP, "gap: {link: §bumper, gap: 5 cm}", "'bumper' is not known", "'pounding', 'infill'"),
    "case is a word": (GAP, "gap: §pounding", "'pounding' is not a mapping", "link, gap, stiffness"),
    "case name": (GAP, "§a/b: {link: pounding, gap: 5 cm}", "'a/b' cannot be a name", "letters, digits"),
    "infill without thickness": (
        GAP,
        "gap: {link: infill, gap: §0 cm}",
        "an infill in a gap of zero has no thickness",
        "`link: pounding`",
    ),
    "infill thinner than a micrometre": (
        GAP,
        "gap: {link: infill, gap: §0.9e-6 m}",
        "an infill 9e-07 m thick is thinner than 1e-06 m",
        "`link: pounding`",
    ),
    "infill stiffer than impact": (
        GAP,
        "gap: {link: infill, gap: 5 cm, stiffness: §50 x stiffest storey}",
        "is above the impact stiffness",
        "lower the one",
    ),
    "connector on no floor": (
        GAP,
        "gap: {link: connector, gap: 5 cm, floors: [2, §5]}",
        "stiff and soft have no common floor 5",
        "write floors among 1, 2, 3",
    ),
    "by_floor on no floor": (
        GAP,
        "gap: {link: pounding, gap: 5 cm, by_floor: {7: §none}}",
        "no common floor 7",
        "1, 2, 3",
    ),
    "elsewhere without floors": (
        GAP,
        "gap: {link: pounding, gap: 5 cm, elsewhere: §none}",
        "'elsewhere' needs 'floors'",
        "floors: [3, 5]",
    ),
    "pairs of another group": (
        GAP,
        "gap: {link: pounding, gap: 5 cm, pairs: §[none, none]}",
        "pairs has 2 entries for 1 pair of neighbours",
        "write 1",
    ),
    "law of a connector": (
        GAP,
        "gap: {link: connector, gap: 5 cm, §law: printed}",
        "'law' means nothing for link: connector",
        "belongs to an infill",
    ),
    "unknown analysis": (
        "[elastic]",
        "[elastic, §plastic]",
        "'plastic' is not known",
        "'elastic' or 'inelastic'",
    ),
    "analysis twice": ("[elastic]", "[elastic, §elastic]", "'elastic' stands twice", "remove one"),
    "accuracy": ("[elastic]", "[elastic]\naccuracy: §2", "must be at least 1e-14 and at most 0.1", "1e-6"),
    "fixed step without step": (
        "[elastic]",
        "[elastic]\nmethod: §central-difference",
        "needs 'time_step'",
        "time_step: 1e-4 s",
    ),
    "step without fixed step": ("[elastic]", "[elastic]\n§time_step: 1 ms", "means nothing", "remove it"),
    "unknown method": ("[elastic]", "[elastic]\nmethod: §newmarc", "'newmarc' is not known", "'taylor'"),
    "plot of no case": (
        "[elastic]",
        "[elastic]\nreport: {plot: [gap, §touching]}",
        "no case 'touching'",
        "known: gap",
    ),
    "figure of no building": (
        "[elastic]",
        "[elastic]\nreport: {building: §stif}",
        "no building 'stif' in the group",
        "did you mean 'stiff'?",
    ),
    "sweep of no key": (
        "[elastic]",
        "[elastic]\nsweep:\n  §impact.restitutoin: [0.4]",
        "no key 'restitutoin' under 'impact'",
        "did you mean 'restitution'?",
    ),
    "sweep of no case": (
        "[elastic]",
        "[elastic]\nsweep:\n  §cases.gapp.gap: [1 cm]",
        "no key 'gapp' under 'cases'",
        "did you mean 'gap'?",
    ),
    "sweep of a wrong value": (
        "[elastic]",
        "[elastic]\nsweep:\n  impact.restitution: [0.4, §1.4]",
        "is 1.4; it must be above 0 and at most 1",
        "0.5",
    ),
    "sweep without a list": (
        "[elastic]",
        "[elastic]\nsweep:\n  impact.restitution: §0.4",
        "the values of 'impact.restitution' are not a list",
        "[first, second]",
    ),
    "sweep of nothing": (
        "[elastic]",
        "[elastic]\nsweep:\n  impact.restitution: §[]",
        "has no values",
        "at least one",
    ),
    "sweep of the group": (
        "[elastic]",
        "[elastic]\nsweep:\n  §group: [a]",
        "cannot be an axis",
        "one study for each",
    ),
    "sweep of a section": (
        "[elastic]",
        "[elastic]\nsweep:\n  §impact: [1]",
        "is a whole section",
        "name one value",
    ),
    "sweep value twice": (
        "[elastic]",
        "[elastic]\nsweep:\n  impact.restitution: [0.4, §0.4]",
        "0.4 stands twice",
        "remove one",
    ),
    "zipped keys of two lengths": (
        "[elastic]",
        "[elastic]\nsweep:\n  - §{impact.restitution: [0.4], cases.gap.gap: [1 cm, 2 cm]}",
        "impact.restitution has 1, cases.gap.gap has 2",
        "as many values",
    ),
    "axis twice": (
        "[elastic]",
        "[elastic]\nsweep:\n  - {impact.restitution: [0.4]}\n  - {§impact.restitution: [0.5]}",
        "is an axis twice",
        "remove one",
    ),
    "key twice": (
        "title: Test",
        "title: Test\n§title: again",
        "'title' stands twice; first in line 1",
        "remove one",
    ),
    "merge key": (
        SOFT,
        "soft: {§<<: {storeys: 3}, period: 1 s}",
        "merge keys (<<) are not used",
        "like: NAME",
    ),
    "tag": ("0.36 s", "§!!python/name:os.system x", "is not used here", "plain value"),
}


@pytest.mark.parametrize("name", CASES)
def test_refused(name, refused):
    old, new, message, hint = CASES[name]
    refused((old, new), message=message, hint=hint)


def test_circle_is_told_once(refused):
    """Two buildings that are like each other: one problem, not one for each."""
    refused(
        (STIFF, "stiff: {like: soft, storeys: 3}"),
        ("like: stiff", "like: §stiff"),
        message="goes round in a circle",
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
    """Faults in six sections, of the file, of its meaning and of its sweep: none hides another."""
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

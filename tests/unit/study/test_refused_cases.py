"""What is refused of motions, links, methods and sweeps, with its place and what to write instead."""

from __future__ import annotations

import pytest

GAP = "gap: {link: pounding, gap: 5 cm}"

# (old, new with § where the problem stands, words of the message, words of the hint)
CASES = {
    "record misspelt": ("taft", "§tafft", "no motion 'tafft'", "did you mean 'taft'?"),
    "record file missing": (
        "taft",
        "{file: §motions/x.AT2}",
        "motions/x.AT2 does not exist",
        "relative to the study file",
    ),
    "record twice": ("taft", "§elcentro", "the record 'elcentro' occurs twice", "`name:`"),
    "record unit": ("taft", "{file: x.txt, unit: §cm/s}", "'cm/s' is not a unit of acceleration", "g, m/s2, cm/s2"),
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
        "`link: pounding`, infill, connector, damper, viscous, maxwell, friction, hertz, hertz-damp, jankowski, "
        "bilinear or none",
    ),
    "case without gap": (GAP, "gap: §{link: pounding}", "'gap' is missing", "gap: 0 cm"),
    "unknown link": (GAP, "gap: {link: §bumper, gap: 5 cm}", "'bumper' is not known", "write pounding, infill"),
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
        "'law' does not apply to link: connector",
        "belongs to an infill",
    ),
    "unknown analysis": (
        "[elastic]",
        "[elastic, §plastic]",
        "'plastic' is not known",
        "'elastic' or 'inelastic'",
    ),
    "analysis twice": ("[elastic]", "[elastic, §elastic]", "'elastic' occurs twice", "remove one"),
    "accuracy": ("[elastic]", "[elastic]\naccuracy: §2", "must be at least 1e-14 and at most 0.1", "1e-6"),
    "fixed step without step": (
        "[elastic]",
        "[elastic]\nmethod: §central-difference",
        "needs 'time_step'",
        "time_step: 1e-4 s",
    ),
    "step without fixed step": ("[elastic]", "[elastic]\n§time_step: 1 ms", "does not apply", "remove it"),
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
        "0.4 occurs twice",
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
    "floor 0": (GAP, "gap: {link: pounding, gap: 5 cm, floors: §0}", "must be at least 1", "at least 1"),
    "single floor that is not there": (
        GAP,
        "gap: {link: pounding, gap: 5 cm, floors: §7}",
        "no common floor 7",
        "1, 2, 3",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_refused(name, refused):
    old, new, message, hint = CASES[name]
    refused((old, new), message=message, hint=hint)

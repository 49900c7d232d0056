"""`bracket:` becomes an axis whose middle value is the study's own; what is wrong with one is refused at its place."""

from __future__ import annotations

import pytest

from pounding_cli.study import expand

SHORT = ("analyses: [elastic]\n", "analyses: [elastic]\nbracket: impact.stiffness\n")
STATED = ("stiffness: 20 x stiffest storey, ", "")


def longer(values: str) -> tuple[str, str]:
    return ("analyses: [elastic]\n", f"analyses: [elastic]\nbracket: {{{values}}}\n")


def factors(read) -> list[str]:
    (axis,) = read.axes
    assert axis.names == ("impact.stiffness",)
    return [str(value) for (value,) in axis.values]


def test_the_word_takes_a_quarter_of_and_five_times_the_studys_own(study):
    wanted = [f"{factor} x stiffest storey" for factor in (5, 20, 100)]
    assert factors(study(SHORT)) == wanted
    assert factors(study(SHORT, STATED)) == wanted  # the default
    own = ("20 x stiffest storey", "40x stiffest storey of soft")
    assert factors(study(SHORT, own))[::2] == [f"{factor} x stiffest storey of soft" for factor in (10, 200)]
    read = study(SHORT, ("20 x stiffest storey", "8e9 N/m"))
    assert [value for (value,) in read.axes[0].values] == [2e9, 8e9, 4e10]


def test_scenes_are_those_of_the_same_sweep(study):
    values = "[5 x stiffest storey, 20 x stiffest storey, 100 x stiffest storey]"
    swept = study(("analyses: [elastic]\n", f"analyses: [elastic]\nsweep: {{impact.stiffness: {values}}}\n"))
    for read in (study(SHORT), study(longer(f"impact.stiffness: {values}"))):
        assert list(expand(read).scenes) == list(expand(swept).scenes)


def test_the_middle_value_stands_where_the_key_stands(study):
    read = study(longer("impact.restitution: [0.4, 0.45, 0.65]"), (", restitution: 0.5", ""))
    resolved = read.resolved()
    assert resolved["impact"]["restitution"] == 0.45
    assert resolved["bracket"] == ["impact.restitution"]
    assert study(SHORT).resolved()["bracket"] == ["impact.stiffness"]
    assert study().resolved()["bracket"] is None


def test_a_bracket_comes_after_the_sweep_in_either_form(study):
    for sweep in ("{cases.gap.gap: [1 cm, 2 cm]}", "[{cases.gap.gap: [1 cm, 2 cm]}]"):
        read = study(("analyses: [elastic]\n", f"analyses: [elastic]\nbracket: impact.stiffness\nsweep: {sweep}\n"))
        assert [axis.names for axis in read.axes] == [("cases.gap.gap",), ("impact.stiffness",)]


@pytest.mark.parametrize(
    ("changes", "message", "hint"),
    [
        ([("analyses: [elastic]", "bracket: §impact.restitution")], "'impact.restitution' alone says no values", "low"),
        ([("analyses: [elastic]", "bracket: §5")], "'bracket' is neither a key nor a mapping", "impact.stiffness"),
        ([("analyses: [elastic]", "bracket: {tail: §[1, 2]}")], "takes an odd number of values", "[low, middle, high]"),
        ([("analyses: [elastic]", "bracket: {tail: §[1, 2, 3, 4]}")], "takes an odd number of values", "high"),
        ([("analyses: [elastic]", "bracket: {§impact.stifness: [1, 2, 3]}")], "no key 'stifness'", "'stiffness'"),
        (
            [
                ("analyses: [elastic]", "bracket: {impact.restitution: [0.4, 0.6, 0.7]}"),
                ("restitution: 0.5", "restitution: §0.5"),
            ],
            "is 0.5 here and 0.6 in the middle of its bracket",
            "leave it to the bracket",
        ),
        (
            [("analyses: [elastic]", "sweep: {impact.stiffness: [1e9]}\nbracket: §impact.stiffness")],
            "'impact.stiffness' is swept and bracketed",
            "remove one",
        ),
        ([("analyses: [elastic]", "bracket: {impact.restitution: [0.4, 0.5, §2]}")], "is 2; it must be", "0.5"),
    ],
)
def test_what_is_wrong_is_refused_at_its_place(refused, changes, message, hint):
    refused(*changes, message=message, hint=hint)

"""Results that are hardly plausible are said once, with their cause, in the terminal and on the page."""

from __future__ import annotations

from pathlib import Path

import pytest

STUDY = """\
title: Plausible
records: {use: [elcentro, taft], duration: 4 s, scale: {pga: 0.1 g}}
buildings:
  A: {storeys: 2, period: 0.3 s, height: 3 m, yield_shear: [4 MN, 3 MN]}
  B: {like: A, period: 0.5 s}
group: [A, B]
cases: {apart: {link: none}, gap: {link: pounding, gap: 8 cm}}
estimate: none
"""
DUCTILITY = "Hardly plausible: a ductility of"
DRIFT = "Hardly plausible: an interstorey drift of"
ACCELERATION = "Hardly plausible: a floor acceleration of"
SLAB = "Hardly plausible: floors that pass through each other by"
CLOSE = {"gap: 8 cm": "gap: 1 mm"}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, {}),
        ({"yield_shear: [4 MN, 3 MN]": "yield_shear: [60 kN, 50 kN]"}, {DUCTILITY: "check its yield level"}),
        (
            {"yield_shear: [4 MN, 3 MN]": "yield: {base_shear: 0.02 W}"},
            {DUCTILITY: "check its yield level"},
        ),
        (
            {", yield_shear: [4 MN, 3 MN]": "", "pga: 0.1 g": "pga: 0.4 g"},
            {DUCTILITY: "yield levels of the working stress of the UBC-1991"},
        ),
        (
            {"yield_shear: [4 MN, 3 MN]": "yield_shear: never", "0.3 s": "2 s", "0.5 s": "2.2 s"}
            | {"0.1 g": "2 g", "8 cm": "4 m"},
            {DRIFT: "check unit"},
        ),
        (
            {"yield_shear: [4 MN, 3 MN]": "yield: {base_shear: 0.08 W}, hardening: 1 %, p_delta: true"}
            | {"0.3 s": "0.9 s", "0.5 s": "1.1 s", "0.1 g": "0.4 g"}
            | {"[elcentro, taft], duration: 4 s": "[elcentro], duration: 8 s"},
            {DRIFT: "strength below 5 %: check unit and scale"},
        ),
        (
            CLOSE | {"pga: 0.1 g": "pga: 0.3 g", "yield_shear: [4 MN, 3 MN]": "yield_shear: never"},
            {ACCELERATION: "it grows with the root of the contact stiffness"},
        ),
        (
            {"yield_shear: [4 MN, 3 MN]": "yield_shear: never", "0.3 s": "0.06 s", "0.5 s": "0.07 s", "0.1 g": "5 g"},
            {ACCELERATION: "the building alone has as much"},
        ),
        (
            CLOSE | {"height: 3 m": "height: 3 m, slab: 1 cm", "estimate": "impact: {stiffness: 1 MN/m}\nestimate",
                     "pga: 0.1 g": "pga: 0.3 g", "yield_shear: [4 MN, 3 MN]": "yield_shear: never"},
            {SLAB: "more than a slab of 1 cm is thick: the contact is too soft"},
        ),
    ],
)  # fmt: skip
def test_each_kind_is_said_once_with_its_cause(pound, folder, changes, said):
    text = STUDY
    for before, after in changes.items():
        assert before in text
        text = text.replace(before, after)
    (folder / "two.yaml").write_text(text)
    code, out, err = pound("run", "two.yaml", "-o", "r.h5")
    assert code == 0, err
    pound("report", "r.h5", "-q", "--no-figures", "-o", "page")
    for told in (out, Path("page/report.html").read_text(encoding="utf-8")):
        words = " ".join(told.replace("&#39;", "'").split())
        for kind in (DUCTILITY, DRIFT, ACCELERATION, SLAB):
            assert words.count(kind) == (kind in said), kind
        for cause in said.values():
            assert cause in words
        assert words.count("Hardly plausible: ") == len(said)

"""The paper's claims: which numbers of the results test each, on which side of its threshold it holds, what is said."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from pounding_cli.numbers import NOTHING
from pounding_cli.paper.claims import AS_GIVEN, CLAIMS, FAILS, HOLDS, LARGEST_STOREY, MEAN_OF_STOREYS, PARTLY, UNTESTED
from pounding_cli.paper.comparison import _compare_claims
from pounding_cli.paper.verdicts import build_claims_table, evaluate_claims, format_verdict, summarize_verdicts
from pounding_cli.records import load_catalogue

CASES = ("touching", "gap", "infill", "infill_1_10", "infill_1_100", "connected")
RATIOS = {
    "touching": (1.5, 0.8), "gap": (1.05, 1.0), "infill": (1.5, 0.9), "infill_1_10": (1.6, 0.9),
    "infill_1_100": (1.6, 0.9), "connected": (1.5, 0.7),
}  # fmt: skip
"""Ratios of the stiff and the soft building to the same alone, by case; μ/μ0 of connected buildings is larger."""


def results(**changes: Any) -> xr.Dataset:
    """Results in which all claims hold, with some numbers replaced.

    ratios : by case, of the stiff and the soft building
    more_ductile : μ/μ0 over V/V0 of the connected stiff building
    acceleration : of touching and of infilled buildings [m/s2]
    separation, gap : by the code, of the study [m]
    closing : of links that are not connected and of connectors, over the gap
    contact : time that a connector acts over that of the motion
    impulse : smallest and largest of the connectors [N s]
    scale : of taft over that of the paper's Table 1
    is_reversed : whether the soft building is the left one
    """
    given: dict[str, Any] = {
        "ratios": RATIOS, "more_ductile": 1.3, "acceleration": (10.0, 1.0), "separation": 0.07, "gap": 0.05,
        "closing": (0.5, 0.8), "contact": 1.0, "impulse": (-2e3, 3e3), "scale": 1.0, "is_reversed": False,
    } | changes  # fmt: skip
    ratio = np.ones((len(CASES), 2, 2, 2, 2))  # case, analysis, record, building, storey
    for place, case in enumerate(CASES):
        ratio[place] *= np.array(given["ratios"][case])[:, None]
    inelastic = ratio.copy()
    inelastic[CASES.index("connected"), :, :, 0] *= given["more_ductile"]
    acceleration = np.full(ratio.shape, 5.0)
    acceleration[CASES.index("touching")] = given["acceleration"][0]
    acceleration[CASES.index("infill")] = given["acceleration"][1]
    kinds = np.array([["pounding", "pounding"]] * (len(CASES) - 1) + [["pounding", "connector"]])
    links = ("case", "analysis", "record", "link")
    of_links = np.ones((len(CASES), 2, 2, 2))
    impulse = of_links * np.array(given["impulse"])[:, None]
    places = ("case", "analysis", "record", "building", "storey")
    data = xr.Dataset(
        {
            "V_ratio": (places, ratio),
            "mu_ratio": (places, inelastic),
            "acceleration": ((*places[:4], "floor"), acceleration),
            "period": ("building", [0.36, 0.6]),
            "separation": ("building", [given["separation"]] * 2),
            "kind": (("case", "link"), kinds),
            "gap": (("case", "link"), np.full((len(CASES), 2), given["gap"])),
            "max_closing": (links, of_links * np.array(given["closing"]) * given["gap"]),
            "contact_time": (links, of_links * given["contact"] * 20.0),
            "impulse": (links, impulse),
            "impacts": (links, of_links),
            "record_window": ("record", [20.0, 20.0]),
            "record_scale": ("motion", [1.0, given["scale"] * load_catalogue()["taft"].scale]),
            "record_arias": ("motion", [1.0, 1.0]),
            "record_source": ("motion", ["real", "real"]),
        },
        {
            "case": list(CASES),
            "analysis": ["elastic", "inelastic"],
            "building": ["stiff", "soft"],
            "motion": ["elcentro", "taft"],
        },
    )
    if given["is_reversed"]:
        data = data.isel(building=[1, 0])
        data["separation"] = ("building", [given["separation"]] * 2)
    return data


def judge(figure: str, **changes: Any) -> pd.DataFrame:
    """The numbers of the claims about a figure, without a sweep."""
    return evaluate_claims(results(**changes), [], figure).assign(where=AS_GIVEN)


def swap(*cases: str) -> dict[str, Any]:
    """The ratios with those of two cases exchanged."""
    first, second = cases
    return {"ratios": {**RATIOS, first: RATIOS[second], second: RATIOS[first]}}


MIRRORED = {case: ratios[::-1] for case, ratios in RATIOS.items()}
"""The soft building in the place of the stiff one."""


@pytest.mark.parametrize("is_reversed", [False, True])
@pytest.mark.parametrize("figure", ["fig6", "fig7"])
def test_all_claims_hold_where_the_paper_is_right(figure, is_reversed):
    numbers = judge(figure, is_reversed=is_reversed)
    expected = [key for key, each in CLAIMS.items() if each.figure in ("", figure)]
    assert list(numbers["claim"].unique()) == expected
    assert set(numbers["verdict"]) == set(numbers["verdict_largest"]) == {HOLDS}


@pytest.mark.parametrize(
    ("claim", "changes", "verdict"),
    [
        ("infill-response", {"ratios": {**RATIOS, "infill": (1.0, 0.9), "gap": (1.5, 1.0)}}, FAILS),
        ("infill-response", {"ratios": {**RATIOS, "infill": (1.0, 0.9)}}, PARTLY),  # 0.67 of touching, 0.95 of the gap
        ("infill-accelerations", {"acceleration": (1.0, 10.0)}, FAILS),
        ("infill-accelerations", {"acceleration": (10.0, 2.5)}, FAILS),
        ("softer-infill", swap("infill", "infill_1_10"), FAILS),
        ("softer-infill", {"ratios": {**RATIOS, "infill": (1.7, 0.9)}}, FAILS),
        ("softer-infill", {"ratios": {**RATIOS, "infill": (1.3, 0.9)}}, FAILS),  # 23 % more
        ("code-gap", {"ratios": {**RATIOS, "gap": (1.2, 1.2)}}, FAILS),
        ("code-gap", {"ratios": {**RATIOS, "gap": (1.0, 1.2)}}, PARTLY),
        ("narrow-gap", {"separation": 0.05, "gap": 0.07}, FAILS),
        ("separation", {"separation": 0.064}, FAILS),
        ("separation", {"separation": 0.076}, FAILS),
        ("connection-stiffer", {"more_ductile": 1 / 1.3}, PARTLY),
        ("connection-stiffer", {"ratios": MIRRORED, "more_ductile": 0.9}, FAILS),
        ("connection-other", {"ratios": MIRRORED}, FAILS),
        ("connection-always", {"ratios": {**RATIOS, "connected": (1.5, 1.1)}}, FAILS),
        ("connection-always", {"ratios": MIRRORED}, HOLDS),
        ("connection-levels", {"closing": (1.2, 0.8)}, FAILS),
        ("connection-levels", {"closing": (0.9, 1.2)}, HOLDS),
        ("connection-both-ways", {"contact": 0.5}, PARTLY),
        ("connection-both-ways", {"impulse": (2e3, 3e3), "contact": 0.5}, PARTLY),
        ("connection-both-ways", {"impulse": (-2e3, -3e3)}, PARTLY),
        ("connection-closing", {"closing": (0.5, 1.2)}, FAILS),
        ("connection-closing", {"closing": (1.2, 0.9)}, HOLDS),
        ("scales", {"scale": 1.03}, FAILS),
        ("scales", {"scale": 0.97}, FAILS),
    ],
)  # fmt: skip
@pytest.mark.parametrize("is_reversed", [False, True])
def test_on_which_side_a_claim_holds(claim, changes, verdict, is_reversed):
    """Fails if a claim takes another building, case or side of its threshold. The mirror image has the same verdict."""
    figure = CLAIMS[claim].figure or "fig6"
    numbers = judge(figure, **changes, is_reversed=is_reversed)
    assert set(numbers.loc[numbers["claim"] == claim, "verdict"]) == {verdict}


@pytest.mark.parametrize(
    ("claim", "finding", "number", "unit"),
    [
        ("infill-response", "infill over touching", 1.0, "-"),
        ("infill-response", "infill over gap", 1.5 / 1.05, "-"),
        ("infill-accelerations", "at the floor where they fall most", 90.0, "%"),
        ("softer-infill", "infill at 1/10", 100 * (1.6 / 1.5 - 1), "%"),
        ("narrow-gap", "less the gap", 2.0, "cm"),
        ("separation", "separation by the code", 7.0, "cm"),
        ("connection-stiffer", "μ/μ0, inelastic: largest storey", 1.95, "-"),
        ("connection-stiffer", "less V/V0, elastic", 0.45, "-"),
        ("connection-other", "soft when connected", 0.7, "-"),
        ("connection-always", "motions in which", 100.0, "%"),
        ("connection-levels", "not connected, over the gap", 50.0, "%"),
        ("connection-both-ways", "time for which", 100.0, "%"),
        ("connection-both-ways", "smallest", -2.0, "kN s"),
        ("connection-both-ways", ", largest", 3.0, "kN s"),
        ("connection-closing", "over its gap", 80.0, "%"),
        ("scales", "taft (real)", 1.0, "-"),
    ],
)
def test_the_numbers_of_the_claims_by_hand(claim, finding, number, unit):
    numbers = judge("fig6")
    rows = numbers[(numbers["claim"] == claim) & numbers["finding"].str.contains(finding, regex=False)]
    assert len(rows)
    np.testing.assert_allclose(rows["number"], number, rtol=1e-12)
    assert set(rows["unit"]) == {unit}


def test_what_the_results_lack_is_not_tested():
    """Fails if a claim about a case that the study lacks is judged."""
    data = results().sel(case=["touching", "gap"])
    numbers = evaluate_claims(data, [], "fig6")
    verdicts = numbers.drop_duplicates("claim").set_index("claim")["verdict"]
    assert verdicts["connection-stiffer"] == verdicts["infill-response"] == verdicts["connection-levels"] == UNTESTED
    assert verdicts["narrow-gap"] == HOLDS
    assert numbers.loc[numbers["claim"] == "infill-response", "passed"].isna().all()


# What is said and shown


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({}, "Of 12 claims about Fig. 6, 12 hold (by the mean over the storeys)."),
        (
            {"separation": 0.064, "more_ductile": 1 / 1.3},
            "Of 12 claims about Fig. 6, 10 hold, 1 holds partly, 1 does not hold (by the mean over the storeys).",
        ),
        (
            {"ratios": MIRRORED, "separation": 0.05, "gap": 0.07, "more_ductile": 0.9},
            "Of 12 claims about Fig. 6, 7 hold, 5 do not hold (by the mean over the storeys).",
        ),
    ],
)
def test_how_many_claims_hold(changes, sentence):
    numbers = judge("fig6", **changes)
    counts = numbers.drop_duplicates("claim")["verdict"].value_counts()
    assert summarize_verdicts(numbers, "fig6") == sentence
    for verdict, words in ((HOLDS, "hold"), (PARTLY, "partly"), (FAILS, "not hold")):
        assert (f"{counts.get(verdict, 0)} " in sentence and words in sentence) == (verdict in counts)


def test_the_cells_of_the_table_of_claims():
    """The words of a claim with its verdict, then its numbers with their units; those that miss are told."""
    numbers = judge("fig6", separation=0.064)
    numbers["passed"] = numbers["passed"].astype("boolean")
    table = build_claims_table(numbers)
    cells = table.cells()
    (place,) = [n for n, row in enumerate(cells) if row[0].startswith("separation\n")]
    heading, number = cells[place : place + 2]
    assert "approximately 7cm" in heading[0]
    assert heading[1:] == [FAILS, "", ""]
    assert number == ["separation by the code, sum of the design displacements at the roof", "missed", "6.40 cm",
                      "at least 6.5 and at most 7.5 cm"]  # fmt: skip
    (place,) = [n for n, row in enumerate(cells) if row[0].startswith("connection-other\n")]
    assert [row[1:] for row in cells[place : place + 2]] == [[HOLDS, "", ""], ["met", "0.700", "below 1"]]
    assert table.frame["number"].dtype.kind == "f"


def test_a_verdict_by_the_largest_storey_stands_beside_another_one():
    row = {"verdict": HOLDS, "verdict_largest": PARTLY}
    assert format_verdict(row) == f"{HOLDS} ({LARGEST_STOREY}: {PARTLY})"
    assert format_verdict({**row, "verdict_largest": HOLDS}) == HOLDS
    assert MEAN_OF_STOREYS not in format_verdict(row)


def test_the_comparison_has_a_column_a_file_and_missed_numbers_bold():
    first = judge("fig6").assign(where="a")
    second = judge("fig6", separation=0.064).assign(where="b")
    third = second.assign(where="c", number=math.nan, passed=math.nan)
    claims = pd.concat([first, second, third])
    claims["passed"] = claims["passed"].astype("boolean")
    lines = list(_compare_claims(claims))
    assert "| claim | a | b | c |" in lines
    assert f"| separation | {HOLDS} | {FAILS} | {FAILS} |" in lines
    words = "separation by the code, sum of the design displacements at the roof"
    assert f"| {words} | 7.00 cm | **6.40 cm** | {NOTHING} |" in lines

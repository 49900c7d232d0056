"""The part of the report that says what limits its numbers: warnings, brackets, flags with their scenes."""

from __future__ import annotations

from pathlib import Path

from tests.helpers.pages import words
from tests.helpers.two_buildings import STUDY, known, strikes

SOLVE = known


def reported(folder, pound, text: str, solve=known) -> str:
    """The page of a study."""
    (folder / "two.yaml").write_text(text)
    pound("run", "two.yaml", "-q", solve=solve)
    pound("report", "results/two.h5", "--no-figures", "-o", "out", solve=None)
    return Path("out/report.html").read_text(encoding="utf-8")


def test_warnings_stand_on_the_page(folder, pound):
    text = STUDY.replace("gap: 1 cm", "gap: 2").replace("storeys: 2,", "storeys: 5, height: 2.25 m,")
    said = words(reported(folder, pound, text), "limits")
    assert "gap is 2 m: gaps between neighbours" in said
    assert "Line 14 of the study: did you mean 2 cm?" in said
    assert "floors 1 and 2 of stiff and floors 1 to 3 of soft meet no floor" in said


def test_without_a_bracket_one_sentence_offers_it(folder, pound):
    page = reported(folder, pound, STUDY)
    assert "grow with the square root of the impact stiffness" in words(page, "limits")
    assert 'href="#limits"' in page


def test_a_bracket_has_its_table(folder, pound):
    page = reported(folder, pound, STUDY + "bracket: impact.stiffness\n")
    said = words(page, "limits")
    assert "Bracket of impact.stiffness" in said
    assert "at 5 x stiffest storey at 100 x stiffest storey" in said
    assert "link force 1.00 (1.00 to 1.00) 1.00 (1.00 to 1.00)" in said  # this solver knows no impact stiffness
    assert "nobody knows" not in said
    assert "At impact.stiffness = 20 x stiffest storey." in words(page)  # the middle leads


def test_flags_name_their_scenes(folder, pound):
    page = reported(folder, pound, STUDY, solve=strikes)
    flag = "gap, elastic, 1 of 2 scenes (strong): connector closes more than the gap"
    assert f"not meaningful {flag}" in words(page, "simulated")


def test_where_there_is_nothing_to_say_the_section_is_left_out(folder, pound):
    page = reported(folder, pound, STUDY.replace("link: pounding, gap", "link: none, gap"))
    assert 'id="limits"' not in page

"""The catalogue of notes: every code is explained, used, and silenced by `accept:` where it may be."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pounding_cli import open_results
from tests.adapter import NOTES

ROOT = Path(__file__).parents[2]
STUDY = """\
title: Notes
records: {use: [{file: strong.txt}]}
buildings:
  low: {storeys: 2, period: 0.3 s}
  high: {like: low, period: 0.5 s, mass: 100 kg}
group: [low, high]
cases:
  near: {link: pounding, gap: 1 mm}
  joined: {link: connector, gap: 1 mm, stiffness: 1 kN/m}
analyses: [elastic]
"""


@pytest.mark.parametrize("code", NOTES)
def test_every_code_is_explained(pound, code):
    exit_code, out, _ = pound("explain", code)
    assert exit_code == 0
    assert out.startswith(f"[{code}] {NOTES[code].title}\n")
    assert NOTES[code].explanation in " ".join(out.split())
    assert (f"`accept: [{code}]`" in out) == (code != "struck")


def test_codes_without_an_argument_are_listed_and_unknown_ones_refused(pound):
    listed = pound("explain")[1].splitlines()
    assert [line.split()[0] for line in listed] == list(NOTES)
    exit_code, _, err = pound("explain", "stifness")
    assert exit_code == 2
    assert "did you mean stiffness?" in err


def test_no_code_of_the_catalogue_is_dead():
    """Fails if an entry is kept that nothing says any more, or that was mistyped where it is said."""
    package = [path for path in (ROOT / "pounding_cli").rglob("*.py") if path.name != "notes.py"]
    source = "\n".join(path.read_text(encoding="utf-8") for path in package)
    said = set(re.findall(r"(?:code=|Flag\(|beyond_gap = |code, )\"([a-z-]+)\"", source))
    said |= set(re.findall(r"\"([a-z-]+)\": _describe_", source))
    unused = {code for code in NOTES if code not in said and f'"{code}"' not in source}
    assert not unused


def run(pound, accept: str = "") -> tuple[str, str]:
    Path("two.yaml").write_text(STUDY + accept)
    exit_code, out, err = pound("run", "two.yaml", "-o", "r.h5", "--replace")
    assert exit_code == 0, err
    return " ".join(out.split()), err


def test_what_a_study_accepts_is_not_told(pound):
    """A warning, advice and a flag, each silenced by its own code and by no other."""
    out, err = run(pound)
    assert "[value]" in err
    assert "[stiffness]" in out
    assert "[heights]" in out
    assert "accept" not in out
    for code, text in (("value", err), ("stiffness", out), ("heights", out)):
        out_without, err_without = run(pound, f"accept: [{code}]\n")
        told = set(re.findall(r"\[([a-z-]+)\] ", out + err))
        assert set(re.findall(r"\[([a-z-]+)\] ", out_without + err_without)) == told - {code}
        assert f"[{code}]" in text
        assert f"Left out, as the study accepts them (`accept:`): {code}." in out_without


def test_a_flag_that_is_accepted_stays_in_the_tables(pound):
    text = STUDY.replace("1 mm, stiffness", "50 cm, stiffness").replace("0.3 s}", "0.3 s, damping: 0 %}")
    text = text.replace("[elastic]", "[inelastic]") + "residual_drift: true\n"
    Path("two.yaml").write_text(text)
    out = pound("run", "two.yaml", "-o", "r.h5")[1]
    assert "[residual-drift]" in out
    Path("two.yaml").write_text(text + "accept: [residual-drift]\n")
    out = pound("run", "two.yaml", "-o", "r.h5", "--replace")[1]
    assert "[residual-drift]" not in out
    assert set(open_results("r.h5").flagged()["code"]) == {"residual-drift"}
    assert pound("report", "r.h5")[0] == 0
    page = " ".join(re.sub(r"<[^>]+>", " ", Path("r/report.html").read_text(encoding="utf-8")).split())
    assert "as the study accepts them" in page


def test_numbers_without_meaning_cannot_be_accepted(pound):
    Path("two.yaml").write_text(STUDY + "accept: [heights, struck]\n")
    exit_code, _, err = pound("check", "two.yaml")
    assert exit_code == 2
    assert err.startswith("error: two.yaml:11:19: 'struck' cannot be accepted")
    Path("two.yaml").write_text(STUDY + "accept: [hights]\n")
    exit_code, _, err = pound("check", "two.yaml")
    assert exit_code == 2
    assert err.startswith("error: two.yaml:11:10: accept: 'hights' is not known\n    did you mean 'heights'?")

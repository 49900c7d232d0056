"""Numbers in sentences: of one thing every command and page speaks in the singular."""

from __future__ import annotations

import re

import pytest

from pounding_cli.numbers import counted
from tests.helpers.two_buildings import known

SOLVE = known

NOUNS = (
    "analyses|baselines|buildings|cases|channels|entries|figures|files|floors|frames|groups|impacts|keys|links|motions|"
    "points|records|rows|runs|samples|scenes|steps|storeys|values|columns|pairs"
)

PLURAL_OF_ONE = re.compile(rf"(?<![\w.,/×-])1 (?:(?:more|further|different|kept|sweep) )?(?:{NOUNS})\b")

STUDY = """\
title: One of everything
records: {use: [{file: weak.txt}], duration: whole, scale: 1.0}
buildings:
  stiff: {storeys: 1, period: 0.3 s}
  soft: {like: stiff, period: 0.5 s}
group: [stiff, soft]
cases:
  touching: {link: pounding, gap: 0 cm}
analyses: [elastic]
"""


@pytest.mark.parametrize(
    ("number", "words", "said"),
    [
        (0, ("scene",), "0 scenes"),
        (1, ("scene",), "1 scene"),
        (2, ("scene",), "2 scenes"),
        (1, ("analysis", "analyses"), "1 analysis"),
        (2, ("analysis", "analyses"), "2 analyses"),
    ],
)
def test_counted(number, words, said):
    assert counted(number, *words) == said


def test_one_of_everything_is_told_in_the_singular(folder, pound):
    """One case, analysis, motion, row and storey. Fails where a text counts without looking, e.g. `1 scenes`."""
    (folder / "one.yaml").write_text(STUDY)
    said = {}
    for words in (
        "check one.yaml",
        "plan one.yaml",
        "run one.yaml",
        "show results/one.h5",
        "compare results/one.h5 results/one.h5",
        "accuracy one.yaml --methods taylor --budget 0.1s",
        "report results/one.h5 -o page",
    ):
        code, *texts = pound(*words.split(), solve=None)
        assert code == 0, words
        said[words] = "\n".join(texts)
    for path in (*folder.glob("results/*/*.md"), *folder.glob("page/*.md"), *folder.glob("page/*.html")):
        said[path.name] = path.read_text(encoding="utf-8")
    for path in folder.glob("**/*.svg"):
        said[path.name] = re.sub("<[^<>]*>", "|", path.read_text(encoding="utf-8"))
    assert {"report.html", "accuracy.md", "accuracy-elastic.svg", "soft-response.svg"} <= said.keys()
    found = {where: PLURAL_OF_ONE.findall(text) for where, text in said.items()}
    assert not any(found.values()), {where: words for where, words in found.items() if words}
    assert "1 case x 1 analysis x 1 record = 1 row from 3 scenes" in said["check one.yaml"]
    assert "1: 1 case, 1 analysis, 1 record\n" in said["plan one.yaml"]
    assert "over 1 scene, with the same impacts" in said["accuracy one.yaml --methods taylor --budget 0.1s"]
    assert re.search(r"1 case,\s+elastic,\s+1 motion: 1 run\.", said["report.html"])

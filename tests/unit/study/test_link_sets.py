"""Sets of links of many points, kept apart from their gaps."""

from __future__ import annotations

import numpy as np

from pounding_cli.study.plan import LinkSeen
from pounding_cli.study.scenes import LinkSets


def test_sets_that_differ_in_their_gaps_only_are_found_together():
    """One gap for all links is kept once; no links, and links at other floors, are sets of their own."""
    sets = LinkSets()
    made = [
        (),
        *(tuple(LinkSeen(0, floor, floor, "", "pounding", gap) for floor in (1, 2)) for gap in (0.01, 0.02)),
        tuple(LinkSeen(0, floor, floor, "", "pounding", 0.01 * floor) for floor in (1, 2)),
        (LinkSeen(0, 2, 2, "", "pounding", 0.03),),
    ]
    numbers = np.array([sets.number(links) for links in (*made, made[1])])
    assert [sets[number] for number in numbers] == [*made, made[1]]
    found = {}
    for links, places, gaps in sets.alike(numbers):
        for place, row in zip(places.tolist(), gaps, strict=True):
            found[place] = tuple(link._replace(gap=float(gap)) for link, gap in zip(links, row, strict=True))
    assert [found[place] for place in range(len(numbers))] == [*made, made[1]]
    assert len(list(sets.alike(numbers))) == 3

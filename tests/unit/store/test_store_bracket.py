"""What a bracket does to the results, told from a file whose peaks are known functions of the bracketed value."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.store import overview, swept, write_results
from pounding_cli.store.bracket import ADVICE, spreads
from pounding_cli.store.bracket import said as said_of
from pounding_cli.store.files import opened
from pounding_cli.study import Axis
from tests.helpers.plans import FakeStudy, known, small_plan

KEY = "impact.stiffness"
RATIOS = (0.05, 0.2, 0.4)
"""Stand for the bracketed value: the small plan puts the first swept key into the dashpot of its links."""

AXIS = Axis((KEY,), tuple((ratio,) for ratio in RATIOS))


def responses(plan, pull: float = 1.0):
    """Accelerations and forces grow with the root of the value, shears and drifts not at all."""
    found = {}
    for digest, scene in plan.scenes.items():
        response = known(scene)
        if scene.links:
            root = np.sqrt(scene.links[0].law.damping_ratio / RATIOS[1])
            buildings = tuple(
                replace(b, acceleration=b.acceleration * root, shear=b.shear * pull**root) for b in response.buildings
            )
            links = replace(response.links, peak_force=response.links.peak_force * root)
            response = replace(response, buildings=buildings, links=links)
        found[digest] = response
    return found


@pytest.fixture
def file(tmp_path):
    def write(bracket=None, axes=(AXIS,), pull=1.0, **more):
        facts = {"accuracy": 1e-6, "bracket": bracket}
        plan = small_plan(axes=axes, study=FakeStudy(facts=facts), **more)
        write_results(tmp_path / "r.h5", plan, responses(plan, pull))
        return tmp_path / "r.h5"

    return write


def said(path):
    with opened(path) as file:
        return said_of(file)


def test_the_spread_of_every_quantity_over_its_middle_value(file):
    found = {spread.quantity: spread for spread in spreads(file([KEY]))}
    assert list(found) == ["V/V0", "mu/mu0", "floor acceleration", "link force"]
    for quantity, spread in found.items():
        assert (spread.key, spread.middle) == (KEY, "0.2")
        assert [end.value for end in spread.ends] == ["0.05", "0.4"]
        roots = (0.5, np.sqrt(2)) if quantity in ("floor acceleration", "link force") else (1.0, 1.0)
        for end, root in zip(spread.ends, roots, strict=True):
            assert (end.smallest, end.median, end.largest) == pytest.approx((root,) * 3)
        assert spread.hardly == (quantity in ("V/V0", "mu/mu0"))


def test_sentences_name_what_depends_on_it_and_what_does_not(file):
    lines = said(file([KEY]))
    assert lines[0].startswith("Bracket of impact.stiffness: at 0.05 and at 0.4, over the value at 0.2")
    assert "  link force: 0.50 (0.50 to 0.50) and 1.41 (1.41 to 1.41)" in lines
    assert "  It hardly changes V/V0 and mu/mu0." in lines
    assert "  It changes floor acceleration and link force." in lines
    lines = said(file([KEY], pull=1.2))
    assert "  It hardly changes mu/mu0." in lines
    assert "  It changes V/V0, floor acceleration and link force." in lines


def test_without_a_bracket_one_sentence_offers_it(file):
    assert said(file(axes=())) == [ADVICE]
    assert said(file(axes=(Axis(("impact.restitution",), ((0.4,), (0.5,))),))) == [ADVICE]
    assert said(file()) == []  # swept without being bracketed: the tables say it


def test_where_no_floor_strikes_nothing_is_said(file):
    assert said(file(axes=(), cases=(("free", None),))) == []
    assert said(file([KEY], cases=(("free", None),))) == []


def test_the_overview_leads_with_the_middle(file):
    axes = (AXIS, Axis(("tail",), ((0.0,), (1.0,))))
    found = overview(file([KEY], axes=axes, pull=1.2))
    assert list(found.points) == ["tail = 0", "tail = 1"]
    first = found.lines[0]
    assert first.roof[0].tolist() == pytest.approx([1.5 * 1.2] * 2)
    assert first.meaningless.shape == (2,)
    assert found.unknown[0].startswith("Bracket of impact.stiffness")


def test_the_overview_is_the_same_read_bit_by_bit(file, monkeypatch):
    """Fails if a piece of the file is left out, read twice or taken for another's points."""
    axes = (AXIS, Axis(("tail",), ((0.0,), (1.0,), (2.0,))))
    path = file([], axes=axes, pull=1.2)
    whole = overview(path)
    monkeypatch.setattr(swept, "PIECE", 1)
    again = overview(path)
    assert list(again.points) == list(whole.points)
    assert repr((again.flags, again.meaningless, again.trust)) == repr((whole.flags, whole.meaningless, whole.trust))
    for one, other in zip(again.lines, whole.lines, strict=True):
        for mine, theirs in zip(vars(one).values(), vars(other).values(), strict=True):
            np.testing.assert_array_equal(mine, theirs)
        assert len(one.roof[0]) == len(whole.points) == 3 * len(AXIS.values)

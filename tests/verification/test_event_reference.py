"""Nonlinear groups against the event-located reference: every peak, count and end state to 1e-8."""

from __future__ import annotations

import pytest

from pounding_cli.laws.dashpot import DashpotLaw
from pounding_cli.laws.infill import InfillLaw
from pounding_cli.model.scene import Scene
from tests.helpers.scenes import (
    ELASTIC,
    FOUNDATION,
    INELASTIC,
    links,
    oscillator,
    pair,
    shake,
    shear_building,
)
from tests.reference.agreement import agree


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("gap", [0.0, 0.004])
@pytest.mark.parametrize("cut", [False, True])
def test_pounding(analysis, gap, cut):
    """Fails if a contact is stepped over, or the tension cut opens the link for good."""
    agree(pair("pounding", gap, shake(0.7), analysis, tension_cut=cut))


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize(
    ("kind", "gap"), [("pounding", 0.0), ("pounding", 0.02), ("infill", 0.02), ("connector", 0.05)]
)
def test_five_storeys(kind, gap, analysis):
    """Two buildings that fill two vectors, linked like to like: their series have a loop of their own. Fails if that
    loop takes another sign, neighbour or mass."""
    two = shear_building(0.36, 5), shear_building(0.60, 5)
    motion = shake(1.2, 9.0, 3) if (kind, gap) == ("pounding", 0.02) else shake(0.5)
    expected = agree(Scene(two, links(kind, gap, (1, 2, 3, 4, 5)), motion, analysis))
    assert (expected.impacts.sum() > 0) == (kind != "connector")


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize("law", list(InfillLaw))
def test_infill_pressed_through(analysis, cut, law):
    """A 4 mm infill, compressed beyond its thickness. Fails if the branch at v = d is missed."""
    agree(pair("infill", 0.004, shake(0.5), analysis, tension_cut=cut, law=law))


def test_dashpot_as_printed():
    """Eq. (7) with the printed mass: next to no damping. Fails if an infill does without the printed law."""
    agree(pair("infill", 0.004, shake(0.5), INELASTIC, dashpot=DashpotLaw.PRINTED))


@pytest.mark.parametrize("kind", ["pounding", "infill"])
def test_foundations_under_pounding(kind):
    """Fails if a blow on the top floor does not reach the base."""
    agree(pair(kind, 0.004, shake(0.5), INELASTIC, FOUNDATION))


def test_inelastic_group_of_unequal_height_with_mixed_links():
    """Pounding and infill on one side, a connector on the other. Fails if a link's floors slip."""
    group = shear_building(0.6, 4), shear_building(0.3, 2, FOUNDATION), shear_building(0.2, 1)
    bridges = (
        *links("pounding", 0.002, (1,)),
        *links("infill", 0.01, (2,)),
        *links("connector", 0.05, (1,), left=1),
    )
    agree(Scene(group, bridges, shake(0.6), INELASTIC))


def test_yielding_connected_pair_with_a_tail():
    """Fails if yielding stops with the motion."""
    scene = pair("connector", 0.05, shake(0.5, peak=6.0), INELASTIC)
    agree(Scene(scene.buildings, scene.links, scene.motion, INELASTIC, tail=0.3))


def test_a_long_run_of_two_oscillators():
    """Twelve seconds, many yields and blows. Fails if errors build up over the events."""
    group = oscillator(2e5, 6e7, 0.05, 3e5, 0.05), oscillator(3e5, 3e7, 0.05, 3e5, 0.05)
    agree(Scene(group, links("pounding", 0.01, (1,), stiffness=5e8), shake(12.0, seed=4), INELASTIC), 1e-7)

"""Impossible buildings, foundations, links and scenes are refused in words that name the value."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.laws.dashpot import damping_ratio
from pounding_cli.laws.infill import Infill
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion


def building(**change):
    fields = {
        "name": "stiff", "mass": [2e5, 2e5], "height": [3.0, 3.0], "stiffness": [2e8, 1e8],
        "yield_shear": [1e6, math.inf], "hardening": [0.05, 0.0], "alpha": 1.0, "beta": 1e-3,
    }  # fmt: skip
    return Building(**(fields | change))


def link(**change):
    parameters = {"gap": 0.05, "stiffness": 1e9, "damping_ratio": 0.2}
    if (law := change.pop("law", Pounding)) is Infill:
        parameters["impact_stiffness"] = 1e9
    ends = {"left": 0, "left_floor": 1, "right_floor": 1}
    ends |= {name: change.pop(name) for name in list(change) if name in ends}
    return Link(**ends, law=law(**(parameters | change)))


MOTION = Motion("still", 0.01, np.zeros(3))


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"mass": [2e5, -1.0]}, "stiff: mass of storey 2 is -1; it must be finite and above zero"),
        ({"mass": [2e5, math.inf]}, "mass of storey 2"),
        ({"height": [0.0, 3.0]}, "height of storey 1"),
        ({"stiffness": [1e8, math.nan]}, "stiffness of storey 2"),
        ({"yield_shear": [1e6, 0.0]}, "inf for a storey that cannot yield"),
        ({"yield_shear": [math.nan, 1.0]}, "yield_shear of storey 1"),
        ({"hardening": [0.0, 1.0]}, "hardening of storey 2"),
        ({"alpha": -1.0}, "alpha is -1"),
        ({"beta": math.inf}, "beta"),
        ({"height": [3.0]}, "shape"),
        ({"gravity_load": [4e6]}, "gravity_load has shape"),
        ({"gravity_load": [4e6, -2e6]}, "gravity_load of storey 2"),
        ({"gravity_load": [4e6, 3e8]}, "leaves storey 2 no stiffness: theta"),
        ({k: [] for k in ("mass", "height", "stiffness", "yield_shear", "hardening")}, "no storeys"),
    ],
)
def test_building(change, word):
    building()
    with pytest.raises(ValueError, match=word):
        building(**change)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"gap": -0.01}, "gap is -0.01"),
        ({"gap": 0.0, "law": Infill}, "write pounding"),
        ({"stiffness": 0.0}, "stiffness is 0"),
        ({"law": Infill, "impact_stiffness": 0.0}, "impact_stiffness"),
        ({"damping_ratio": 1.0}, "damping_ratio"),
        ({"damping_ratio": math.nan}, "damping_ratio"),
        ({"left": -1}, "count from 0"),
        ({"right_floor": 0}, "count from 1"),
    ],
)
def test_link(change, word):
    link()
    with pytest.raises(ValueError, match=word):
        link(**change)


@pytest.mark.parametrize("restitution", [0.0, -0.5, 1.5, math.nan])
def test_restitution(restitution):
    with pytest.raises(ValueError, match="restitution"):
        damping_ratio(restitution)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"mass": 0.0}, "mass is 0 kg; it must be finite and above zero, or set sways to False"),
        ({"rocking_stiffness": 0.0}, "set rocks to False"),
        ({"sway_damping": -1.0}, "sway_damping is -1"),
        ({"inertia": math.nan}, "inertia"),
    ],
)
def test_foundation(change, word):
    fields = {"mass": 1e5, "sway_stiffness": 1e9, "inertia": 1e6, "rocking_stiffness": 1e10}
    Foundation(**fields)
    Foundation(mass=1e5, sway_stiffness=1e9, rocks=False)
    with pytest.raises(ValueError, match=word):
        Foundation(**(fields | change))


@pytest.mark.parametrize(
    ("buildings", "links", "tail", "word"),
    [
        ((), (), 0.0, "no buildings"),
        ((building(),), (link(),), 0.0, "no neighbour"),
        ((building(), building()), (link(left_floor=3),), 0.0, "has 2 floors, not 3"),
        ((building(), building()), (link(), link()), 0.0, "two pounding links alike"),
        ((building(),), (), -1.0, "tail"),
    ],
)
def test_scene(buildings, links, tail, word):
    Scene((building(), building()), (link(), link(left_floor=2, right_floor=2)), MOTION, Analysis.ELASTIC)
    with pytest.raises(ValueError, match=word):
        Scene(buildings, links, MOTION, Analysis.ELASTIC, tail)

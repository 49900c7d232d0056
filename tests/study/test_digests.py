"""Buildings that move differently have different digests, by which solved time histories are found again."""

from __future__ import annotations

from itertools import combinations

import pounding_cli as pound

KEYS = {"storeys": 2, "mass": 1e5, "height": 3.0, "stiffness": [1e8] * 2, "yield_shear": [2e6] * 2, "damping": 0.05}
PLAN = {"width": 12.0, "depth": 9.0, "eccentricity": 0.1, "frequency_ratio": 1.2}
CHANGES = {
    "as written": {},
    "mass": {"mass": 1.1e5},
    "height": {"height": 3.1},
    "stiffness": {"stiffness": [1.1e8] * 2},
    "yield shear": {"yield_shear": [2.1e6] * 2},
    "yield shear that is a stiffness": {"stiffness": [2e6] * 2, "yield_shear": [1e8] * 2},
    "hardening": {"hardening": 0.01},
    "damping": {"damping": 0.04},
    "gravity load": {"p_delta": True},
    "collapse": {"collapse": "5 %"},
    "storey law": {"storey_law": "bouc-wen"},
    "parameter of the storey law": {"storey_law": "bouc-wen", "wen_exponent": 3.0},
    "plan": {"plan": PLAN},
    "width of the plan": {"plan": PLAN | {"width": 13.0}},
    "foundation": {"foundation": {"mass": 5e4, "sway_stiffness": 1e9}},
    "isolators": {"foundation": {"mass": 5e4, "isolation": {"radius": 3.1, "friction": 0.06}}},
    "friction of the isolators": {"foundation": {"mass": 5e4, "isolation": {"radius": 3.1, "friction": 0.05}}},
}


def test_whatever_moves_a_building_differently_has_another_digest():
    """Fails if a field is left out of the digest, so that a run reuses the responses of another building."""
    digests = {name: pound.building("soft", **KEYS | keys).digest for name, keys in CHANGES.items()}
    assert [pair for pair in combinations(digests, 2) if digests[pair[0]] == digests[pair[1]]] == []


def test_what_does_not_move_a_building_leaves_its_digest():
    """Fails if a name, or what a neighbour strikes, makes solved time histories new."""
    written = pound.building("soft", **KEYS).digest
    assert pound.building("other", **KEYS | {"slab": 0.3}).digest == written

"""Check masses that vary beside a period that is held."""

from __future__ import annotations

from collections.abc import Iterator

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.numbers import join_limited
from pounding_cli.study.check.values import AS_MEANT
from pounding_cli.study.construct.buildings import build_building
from pounding_cli.study.construct.resolve import changes_part
from pounding_cli.study.schema.building import BuildingSpec
from pounding_cli.study.schema.like import resolve_like
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import Map, get


def check_held_period(study: Study) -> Iterator[Issue]:
    """Yield every mass that varies in a building with a `period`: its stiffness follows the mass."""
    spec = study.spec
    for path, beside in _iter_varied_masses(study.tree):
        key = str(path[-1])
        names = [
            name
            for name in dict.fromkeys(spec.group)
            if changes_part(key, ("buildings", name), study.tree)
            and spec.buildings[name].period is not None
            and f"buildings.{name}.period" not in beside
        ]
        if not names:
            continue
        has_code_strength = "inelastic" in spec.analyses and spec.buildings[names[0]].yield_shear is None
        held = f"the period of {names[0]} is" if len(names) == 1 else f"the periods of {join_limited(names)} are"
        message = f"where the mass varies, {held} held: the stiffness follows the mass"
        if has_code_strength:
            message += ", and the yield shears follow the weight"
        hint = _hint_to_hold(study, names[0], has_code_strength)
        likewise = f" (of {names[0]}; likewise in the others)" if len(names) > 1 else ""
        hint = f"{hint}{likewise}; otherwise leave it, {AS_MEANT}"
        yield Issue(path, message, hint, at_key=True, code="held-period")


MASS_KEYS = frozenset({"mass"})
"""Keys of a building that change its floor masses."""


def _iter_varied_masses(root: Map) -> Iterator[tuple[KeyPath, frozenset[str]]]:
    """Yield the paths of the keys of masses that vary, and the keys that move with each."""
    for section in (("sweep",), ("uncertain",), ("optimise", "over")):
        node = get(root, *section)
        holders = [((*section, place), each) for place, each in enumerate(node)] if isinstance(node, list) else []
        for path, holder in holders or [(section, node)]:
            for key in holder if isinstance(holder, Map) else ():
                section_of_key, _, rest = key.partition(".")
                if section_of_key == "buildings" and set(rest.split(".")[1:2]) & MASS_KEYS:
                    yield (*path, key), frozenset(holder if holders else ())


def _hint_to_hold(study: Study, name: str, has_code_strength: bool) -> str:
    """Return what to write to hold the stiffness of a building, and its yield shears."""
    tree = resolve_like(study.tree["buildings"], name)
    default = BuildingSpec.model_fields["mass"].default
    mass = get(tree, "mass")
    building = build_building(name, study.spec.buildings[name])
    period = get(tree, "period")
    if period is None:  # of a building that is only seen
        period = f"{building.periods[0]:.4g} s"
    hint = (
        f"to hold the stiffness, write `stiffness: {{period: {period}, mass: {default if mass is None else mass}}}` "
        "in place of `period`"
    )
    if has_code_strength:
        shears = ", ".join(f"{shear / 1e3:.5g} kN" for shear in building.yield_shear.tolist())
        hint += f"; to hold the yield shears too, `yield_shear: [{shears}]` in place of `yield`"
    return hint

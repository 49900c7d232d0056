"""Buildings that are only seen: the keys that follow from `archetype:`, what of them is uncertain, and what is written
beside."""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

from pydantic import TypeAdapter, ValidationError

from pounding_cli.errors import InputError
from pounding_cli.model.archetypes import FORCE_DISTRIBUTION, TAPER, Archetype, draw_factors
from pounding_cli.study.schema.archetype import ArchetypeSpec
from pounding_cli.study.schema.like import CODE, resolve_like
from pounding_cli.study.text.file import Items, Map, Mark, get

KEY = "archetype"
"""Key of a building that is only seen."""

SAMPLE = "sample"
"""Key there that chooses one of the buildings that it may be."""

UNCERTAIN_KEYS = {"period": "period", "strength": "yield.base_shear", "damping": "damping"}
"""What is uncertain of a building -> the key that takes its values."""


def is_sample_key(key: str) -> bool:
    """Return whether a dotted key chooses one of the buildings that a neighbour may be."""
    return key.endswith(f".{KEY}.{SAMPLE}")


class Seen(NamedTuple):
    """A building that is only seen.

    name : of the building type in the study
    spec : what is written of it
    archetype : its type at its design level
    building : its keys as written, those that it is like included
    mark : where `archetype:` stands
    """

    name: str
    spec: ArchetypeSpec
    archetype: Archetype
    building: Map
    mark: Mark

    @property
    def prefix(self) -> str:
        """The beginning of its dotted keys."""
        return f"buildings.{self.name}.{KEY}."

    @property
    def sample_key(self) -> str:
        """The dotted key that chooses one of the buildings that it may be."""
        return f"{self.prefix}{SAMPLE}"

    def is_known(self, quantity: str) -> bool:
        """Return whether the study gives a quantity beside the archetype."""
        keys = set(self.building)
        if quantity == "period":
            return bool(keys & {"period", "stiffness"}) or _gives_in_plan(self.building, "stiffness")
        if quantity == "strength":
            if "yield_shear" in keys or _gives_in_plan(self.building, "yield_shear"):
                return True
            written = self.building.get("yield")
            return isinstance(written, Map) and bool(written.keys() & (CODE | {"base_shear"}))
        if quantity == "damping":
            return bool(keys & {"damping", "rayleigh"})
        return quantity in keys

    def median(self, quantity: str) -> float:
        """Return the median of a quantity that is uncertain and takes values of a key [SI]."""
        storeys = self.spec.storeys
        medians = {
            "period": self.archetype.period(storeys),
            "strength": self.archetype.base_shear(storeys),
            "damping": self.archetype.damping,
        }
        return medians[quantity]

    def uncertain_quantities(self) -> list[str]:
        """Return what is uncertain of it and takes values of a key."""
        return [name for name in UNCERTAIN_KEYS if self.spec.uncertain and not self.is_known(name)]


def _gives_in_plan(building: Map, key: str) -> bool:
    """Return whether the lines of the plan of a building give a quantity as numbers, not as shares."""
    lines = get(building, "plan", "lines")
    return isinstance(lines, list) and any(isinstance(get(line, key), Items) for line in lines)


@functools.cache
def _adapter() -> TypeAdapter[ArchetypeSpec]:
    return TypeAdapter(ArchetypeSpec)  # building one takes longer than a validation


def find_seen(building: Any, name: str) -> Seen | None:
    """Return a building that is only seen; None of others, and where `archetype:` is faulty, which is told elsewhere.

    building : its keys as written, those that it is like included
    """
    written = building.get(KEY) if isinstance(building, Map) else None
    if not isinstance(written, Map):
        return None
    try:
        spec = _adapter().validate_python(written)
    except ValidationError:
        return None
    mark = building.marks[KEY][0]
    return Seen(name, spec, spec.find(), building, mark)


def fill_archetype(building: Any, name: str) -> Any:
    """Return a building with the keys that follow from its `archetype:`, each unless it is written beside.

    building : its keys as written, those that it is like included
    """
    seen = find_seen(building, name)
    if seen is None or "wall" in building:
        return building
    storeys = seen.spec.storeys
    archetype = seen.archetype
    factors = draw_factors(archetype.spreads, name, seen.spec.sample, seen.spec.neighbours)
    values = {quantity: factors[quantity] * seen.median(quantity) for quantity in UNCERTAIN_KEYS}
    filled = Map(building, building.mark, dict(building.marks))

    def put(key: str, value: Any) -> None:
        filled.marks[key] = (seen.mark, seen.mark)
        filled[key] = value

    put_unless_written = {
        "storeys": storeys,
        "height": f"{archetype.storey_height!r} m",
        "hardening": archetype.hardening,
    }
    if not seen.is_known("damping"):
        put_unless_written["damping"] = values["damping"]
    if not seen.is_known("period"):
        put_unless_written["period"] = f"{values['period']!r} s"
    if not _gives_in_plan(building, "stiffness") and not isinstance(building.get("stiffness"), Items):
        put_unless_written["taper"] = TAPER
    for key, value in put_unless_written.items():
        if key not in building:
            put(key, value)
    if not seen.is_known("strength"):
        written = building.get("yield")
        beside = written if isinstance(written, Map) else Map({}, seen.mark)
        marks = {"base_shear": (seen.mark, seen.mark), "distribution": (seen.mark, seen.mark)} | beside.marks
        put(
            "yield",
            Map({"base_shear": values["strength"], "distribution": FORCE_DISTRIBUTION} | beside, beside.mark, marks),
        )
    return filled


def list_seen(tree: Map) -> list[Seen]:
    """Return the buildings of the group that are only seen, as the file has them."""
    buildings = tree.get("buildings")
    group = tree.get("group")
    if not isinstance(buildings, Map) or not isinstance(group, list):
        return []
    found = []
    for name in dict.fromkeys(map(str, group)):
        if name not in buildings:
            continue
        try:
            seen = find_seen(resolve_like(buildings, name), name)
        except InputError:  # which is told elsewhere
            continue
        if seen is not None:
            found.append(seen)
    return found

"""Places of links along the street: as a study writes them, and at the edge that two neighbours share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.model.building import Building
from pounding_cli.study.schema.floor_plan import PLACE
from pounding_cli.study.schema.quantity import ParsedText, Quantity, quote, refuse

if TYPE_CHECKING:  # `links.py` imports this file
    from pounding_cli.study.schema.links import LinkSpec

_USAGE = (
    "write a place along the street, e.g. `4 m`, several of them, `[-5 m, 5 m]`, or both ends of one, each from the "
    "middle of its plan, `[[4 m, -2 m]]`"
)
EDGE_TOLERANCE = 1e-9
"""Length over that of an edge [-] by which a place may miss the edge and still stand on it."""


class PlaceOfLink(NamedTuple):
    """The place of a link as a study writes it.

    left, right : from the middles of both plans [m]; equal to each other and along the street unless `is_pair`
    """

    left: float
    right: float
    is_pair: bool = False

    def __str__(self) -> str:
        return f"[{self.left:g} m, {self.right:g} m]" if self.is_pair else f"{self.left:g} m"


def _read_place(value: Any) -> PlaceOfLink:
    """Return a place of a link.  Raises PydanticCustomError."""
    if isinstance(value, PlaceOfLink):
        return value
    if not isinstance(value, list | tuple):
        place = _read_end(value)
        return PlaceOfLink(place, place)
    if len(value) != 2:
        raise refuse(f"{quote(value)} is no place of a link", _USAGE)
    left, right = value
    return PlaceOfLink(_read_end(left), _read_end(right), is_pair=True)


def _read_end(value: Any) -> float:
    """Return the place of one end of a link along the street [m].  Raises PydanticCustomError."""
    try:
        return float(PLACE.read(value))
    except PydanticCustomError as error:
        raise refuse((error.context or {}).get("message", f"{quote(value)} is no place of a link"), _USAGE) from None


@dataclass(frozen=True)
class PlaceParser(ParsedText):
    """Read `4 m`, a place along the street, or `[4 m, -2 m]`, from the middle of each plan."""

    reader: Callable[[Any], PlaceOfLink] = _read_place
    form: str = "m, or [left, right]"
    examples: tuple[Any, ...] = ("4 m", ("4 m", "-2 m"))
    quantity: Quantity | None = PLACE

    def schema(self) -> dict[str, Any]:
        place = {"anyOf": [{"type": "number"}, {"type": "string"}]}
        both = {"type": "array", "items": place, "minItems": 2, "maxItems": 2}
        return {"anyOf": [{"type": "number"}, {"type": "string"}, both], "examples": ["4 m", ["4 m", "-2 m"]]}


class StreetSide(NamedTuple):
    """The plan on one side of a link, along the street.

    middle : of the plan along the street [m]
    centre : of mass, along the street [m]
    low, high : edges of the plan along the street [m]
    """

    middle: float
    centre: float
    low: float
    high: float

    @classmethod
    def of(cls, building: Building) -> StreetSide | None:
        """Return the side of a building; None where its floors do not twist."""
        plan = building.plan
        if plan is None:
            return None
        low = plan.street + plan.low
        high = plan.street + plan.high
        return cls(0.5 * (low + high), plan.street, low, high)

    def holds(self, street: float) -> bool:
        """Return whether a place along the street [m] is on the floors."""
        slack = EDGE_TOLERANCE * (self.high - self.low)
        return self.low - slack <= street <= self.high + slack


class LinkArms(NamedTuple):
    """The arms of a link, or of a part of it, on both floors.

    left_arm, right_arm : from the centres of mass [m]
    share : part of the link [-]
    """

    left_arm: float
    right_arm: float
    share: float


WHOLE_AT_CENTRES = (LinkArms(0.0, 0.0, 1.0),)
"""Where a link acts on floors that do not twist."""


def find_shared_edge(left: StreetSide | None, right: StreetSide | None) -> tuple[float, float]:
    """Return both ends of the edge that two neighbours share, along the street [m]; the first is above the second
    where they share none. A building without a plan, and a wall, is as wide as the other."""
    sides = [side for side in (left, right) if side is not None]
    return max(side.low for side in sides), min(side.high for side in sides)


def find_link_arms(
    link: LinkSpec, path: KeyPath, names: Sequence[str], left: StreetSide | None, right: StreetSide | None
) -> tuple[LinkArms, ...]:
    """Return where a link acts on two neighbours: at its places, else at both ends of the edge that they share.

    names : of the neighbours

    Raises
    ------
    InputError : it names places, but neither floor twists; a place is outside of a plan; or they share no edge
    """
    if left is None and right is None:
        if link.places is not None:
            message = f"neither {names[0]} nor {names[1]} has a plan, so 'places' has no effect"
            hint = "remove it, or give one a `plan:`"
            raise InputError([Issue((*path, "places"), message, hint, at_key=True)])
        return WHOLE_AT_CENTRES
    if link.places is None:
        parts = _halve_at_shared_edge(path, names, left, right)
    else:
        parts = tuple(zip(link.places, link.part_shares, strict=True))
    arms: list[LinkArms] = []
    for number, (place, share) in enumerate(parts):
        place_path: KeyPath = (*path, "places", number)
        left_arm = _find_arm(place, place.left, left, names[0], place_path)
        right_arm = _find_arm(place, place.right, right, names[1], place_path)
        if any((each.left_arm, each.right_arm) == (left_arm, right_arm) for each in arms):
            hint = "remove it, and let its share go to the other"
            raise InputError([Issue(place_path, f"the place {place} stands here twice", hint)])
        arms.append(LinkArms(left_arm, right_arm, share))
    return tuple(arms)


def _halve_at_shared_edge(
    path: KeyPath, names: Sequence[str], left: StreetSide | None, right: StreetSide | None
) -> tuple[tuple[PlaceOfLink, float], ...]:
    """Return both ends of the edge that two neighbours share, each with half of a link.

    Raises
    ------
    InputError : they share no edge
    """
    low, high = find_shared_edge(left, right)
    if low >= high:
        hint = "let the plans overlap along the street (`shift:`), write where both ends stand, e.g. "
        hint += "`places: [[2 m, -3 m]]`, or leave the link out"
        apart = "one ends where the other begins"
        if low > high:
            apart = f"their plans end {low - high:.4g} m apart"
        message = f"{names[0]} and {names[1]} share no edge: along the street {apart}"
        raise InputError([Issue(path, message, hint)])
    return (PlaceOfLink(low, low), 0.5), (PlaceOfLink(high, high), 0.5)


def _find_arm(place: PlaceOfLink, end: float, side: StreetSide | None, name: str, path: KeyPath) -> float:
    """Return the arm of one end of a link on the floors of one side [m], 0 where these do not twist.

    end : of the place, as written [m]
    name : of the building of this side

    Raises
    ------
    InputError : the place is outside of the plan
    """
    if side is None:
        return 0.0
    origin = side.middle if place.is_pair else 0.0
    street = origin + end
    if not side.holds(street):
        message = f"the place {place} is outside of {name}"
        hint = f"write a place from {side.low - origin:g} to {side.high - origin:g} m"
        raise InputError([Issue(path, message, hint)])
    return street - side.centre

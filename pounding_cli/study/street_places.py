"""Where links stand along the street: as a study writes it, and at the edge that two neighbours share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from pounding_cli.model.building import Building
from pounding_cli.study.issues import Issue, IssuesFound, KeyPath
from pounding_cli.study.plan_spec import PLACE
from pounding_cli.study.quantity import ParsedText, Quantity, quote, refuse

if TYPE_CHECKING:
    from pounding_cli.study.link_specs import LinkSpec

_USAGE = (
    "write a place along the street, e.g. `4 m`, or that of both ends from the middles of their plans, `[4 m, -2 m]`"
)
ROUNDING = 1e-9
"""Length over that of an edge [-] by which a place may miss the edge and still stand on it."""


class PlaceOfLink(NamedTuple):
    """Where a link stands.

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
        place = PLACE.read(value)
        return PlaceOfLink(place, place)
    if len(value) != 2:
        raise refuse(f"{quote(value)} is no place of a link", _USAGE)
    left, right = value
    return PlaceOfLink(PLACE.read(left), PLACE.read(right), is_pair=True)


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
    """What a link must know of the plan on one of its sides.

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


class LinkArms(NamedTuple):
    """Where a link, or a part of it, acts on both floors.

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


def find_arms(
    link: LinkSpec, path: KeyPath, names: Sequence[str], left: StreetSide | None, right: StreetSide | None
) -> tuple[LinkArms, ...]:
    """Return where a link acts on two neighbours: at its places, else at both ends of the edge that they share.

    names : of the neighbours

    Raises
    ------
    IssuesFound : it names places, but neither floor twists; a place is outside of a plan; or they share no edge
    """
    if left is None and right is None:
        if link.places is not None:
            message = f"neither {names[0]} nor {names[1]} has a plan, so 'places' has no effect"
            raise IssuesFound([Issue((*path, "places"), message, "remove it, or give one a `plan:`", at_key=True)])
        return WHOLE_AT_CENTRES
    low, high = find_shared_edge(left, right)
    if link.places is None:
        if low >= high:
            hint = "let the plans overlap along the street (`shift:`), write where both ends stand, e.g. "
            hint += "`places: [[2 m, -3 m]]`, or leave the link out"
            apart = f"their plans end {low - high:.4g} m apart" if low > high else "one ends where the other begins"
            message = f"{names[0]} and {names[1]} share no edge: along the street {apart}"
            raise IssuesFound([Issue(path, message, hint)])
        places: tuple[PlaceOfLink, ...] = (PlaceOfLink(low, low), PlaceOfLink(high, high))
        shares: tuple[float, ...] = (0.5, 0.5)
    else:
        places = link.places
        shares = link.part_shares
    arms: list[LinkArms] = []
    for number, (place, share) in enumerate(zip(places, shares, strict=True)):
        ends = []
        for name, y, side in zip(names, (place.left, place.right), (left, right), strict=True):
            if side is None:
                ends.append(0.0)
                continue
            along_street = y + side.middle if place.is_pair else y
            slack = ROUNDING * (side.high - side.low)
            if not side.low - slack <= along_street <= side.high + slack:
                origin = side.middle if place.is_pair else 0.0
                message = f"the place {place} is outside of {name}"
                hint = f"write a place from {side.low - origin:g} to {side.high - origin:g} m"
                raise IssuesFound([Issue((*path, "places", number), message, hint)])
            ends.append(along_street - side.centre)
        if any((each.left_arm, each.right_arm) == (ends[0], ends[1]) for each in arms):
            hint = "remove it, and let its share go to the other"
            raise IssuesFound([Issue((*path, "places", number), f"the place {place} stands here twice", hint)])
        arms.append(LinkArms(ends[0], ends[1], share))
    return tuple(arms)

"""Expressions over the tables, `largest mu in soft` or `mean V_ratio in infill stiff storey 2`; statements, which
compare them, `drift > 2 %`; limits of fragility: statements, `mu in soft storey 1 > 4`, or events, `contact`.

Quantities are read first, each with its place; what is left is arithmetic, which Python parses and nothing runs."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from pounding_cli import variables
from pounding_cli.model.archetypes import DAMAGE_STATES
from pounding_cli.study.axes import Axis
from pounding_cli.study.file import nearest
from pounding_cli.study.quantity import ACCELERATION, LENGTH, TIME, Quantity, written_unit

SHEAR_DEMAND = "shear_demand"
INSTANT_TIME = TIME.replace(name="time", example="1.1 s", low=0.0, open_low=False)


def _find_units(dims: tuple[str, ...]) -> dict[str, str]:
    """Return the SI unit of every response over some dimensions, by name; of loaded columns their shear demand only."""
    left_out = {*variables.COLUMN_VARIABLES} - {SHEAR_DEMAND}
    return {
        variable.name: variable.unit.removeprefix("1")
        for variable in variables.RESPONSE_VARIABLES
        if variable.dims == dims and variable.name not in left_out
    }


STOREY = _find_units(variables.STOREY_DIMS)
FLOOR = _find_units(variables.FLOOR_DIMS)
LINK = _find_units(variables.LINK_DIMS)
LINE = _find_units(variables.LINE_DIMS)
"""Quantities of frame lines by the names of their variables, `line_mu`; people write `mu in line 1 of NAME`."""

FACTS = {
    variable.name: variable.unit.removeprefix("1")
    for variable in (*variables.LINK_VARIABLES, *variables.BUILDING_VARIABLES)
    if variable.kind == "f" and variable.dims in (("case", "link"), ("building",), ("building", "storey"))
}
"""Numbers of links and buildings that no motion changes."""

LINK_FACTS = tuple(variable.name for variable in variables.LINK_VARIABLES if variable.kind == "f")

OF_MOTIONS = {
    variable.name.removeprefix("record_"): variable.unit.removeprefix("1")
    for variable in variables.RECORD_VARIABLES
    if variable.kind == "f"
}
"""Numbers of motions, by the names that their table has."""

OF_SCENES = {
    variable.name: variable.unit.removeprefix("1")
    for variable in variables.SCENE_VARIABLES
    if variable.kind in "fi" and variable.name not in ("seconds", "orders")
} | _find_units(variables.BUILDING_DIMS)
"""Numbers of whole time histories, and of whole buildings in them."""

HISTORY = {
    "time": "s", "displacement": "m", "velocity": "m/s", "total_acceleration": "m/s2", "drift": "m", "shear": "N",
    "twist": "rad", "sway": "m", "closing": "m", "link_force": "N",
}  # fmt: skip
"""Quantities that an expression may name at an instant, `displacement in mass [1.1 s]`."""

QUANTITIES = STOREY | FLOOR | LINK | FACTS | OF_MOTIONS | OF_SCENES
"""SI unit of every quantity that an expression may name, by its name in the tables."""

CONTACT_QUANTITIES = ("acceleration", "acceleration_ratio", "peak_force", "contact_time")
"""Quantities that depend on the contact stiffness where floors strike."""

TWISTING = {variable.name for variable in variables.TWIST_VARIABLES}
"""Variables that studies without plans do not have."""

OVER_HEIGHT = {"drift": "drift_ratio", "edge_drift": "edge_drift_ratio", "line_drift": "line_drift_ratio"}
"""Drift -> the same over the height of the storey, which a value in % means."""

REDUCTIONS = ("largest", "smallest", "mean")
"""Reductions of several storeys, floors or links; `largest` unless written."""


def expression_hint(buildings: Sequence[str]) -> str:
    """Return how an expression is written, with the buildings of the study."""
    first = buildings[0]
    last = buildings[-1]
    return (
        f"write e.g. `mu`, `mean V_ratio in {first}`, `drift in {last} storey 1` or "
        f"`max(V_ratio in {first}, V_ratio in {last})`"
    )


MAX_LENGTH = 500
_FUNCTIONS: Mapping[str, Callable[..., np.ndarray]] = {
    "max": np.maximum, "min": np.minimum, "abs": np.abs, "sqrt": np.sqrt, "log": np.log, "exp": np.exp,
}  # fmt: skip
_SEVERAL = ("max", "min")
_SIGNS: Mapping[type[ast.operator], Callable[..., np.ndarray]] = {
    ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide,
}  # fmt: skip
_KEEP_UNIT = (ast.Add, ast.Sub, "max", "min", "abs")
_PLACE_WORDS = r"line\s+[0-9]{{1,3}}\s+of\b|storey\s+[0-9]{{1,3}}\b|floor\s+[0-9]{{1,3}}\b|{roles}"
_PHRASE = (
    r"(?<![\w.])(?:(?P<over>largest|smallest|mean)\s+(?=(?:largest|smallest|mean)\b))?"
    r"(?:(?P<how>largest|smallest|mean)\s+)?(?P<name>[^\W\d]\w*)"
    r"(?P<in>\s+in\b(?P<places>(?:\s+(?:{places}))*))?(?:\s*\[(?P<where>[^\[\]]*)\])?"
)
STIFFEST, SOFTER = "stiffest building", "softer buildings"
"""The building of the group with the shortest period on a fixed base, of several the first; all with a longer one."""

SAME_PERIOD = 1.0 + 1e-9
"""A period within this factor of the shortest is as short [-]."""

_LAW = "law"
_KINDS = ("building", "case", "analysis", "motion", _LAW)


@dataclass(frozen=True)
class Scope:
    """What expressions of a study may name.

    buildings : names of the group by place, left to right
    cases, analyses, motions, laws : names, laws as `NAME links`; none where an expression is about each of them
    axes : of the sweep, at whose points a quantity may be asked for
    point : numbers of axes with the place on each that every quantity has which does not name another one
    of_limits : whether `shear_demand` may name the building and storey whose columns are loaded, as limits do
    """

    buildings: tuple[str, ...]
    cases: tuple[str, ...] = ()
    analyses: tuple[str, ...] = ()
    motions: tuple[str, ...] = ()
    laws: tuple[str, ...] = ()
    axes: tuple[Axis, ...] = ()
    point: tuple[tuple[int, int], ...] = ()
    of_limits: bool = False

    @property
    def names(self) -> dict[str, tuple[str, ...]]:
        """The names of every kind, in the order of _KINDS."""
        kinds = (self.buildings, self.cases, self.analyses, self.motions, self.laws)
        return dict(zip(_KINDS, kinds, strict=True))


@dataclass(frozen=True)
class Instant:
    """An instant of a time history.

    kind : `time`; `contact` or `release`, when the floors meet or part; `largest` or `smallest` of a quantity
    number : of the contact from 1, from the last one back below 0
    quantity : of HISTORY, of `largest` and `smallest`
    delay : after it [s]
    side : `after` or `before`, where the largest or smallest of a part of the history is meant
    end : of that part; None of the whole history
    """

    kind: str
    number: int = 0
    quantity: str = ""
    delay: float = 0.0
    side: str = ""
    end: Instant | None = None


@dataclass(frozen=True)
class TableQuantity:
    """One number of the tables.

    name : of QUANTITIES, or of LINE; of HISTORY at an instant
    reduction : of REDUCTIONS, over storeys, floors or links and, where none is named, over buildings
    building : its place in the group from 0; None for all
    level : storey or floor from 1; 0 for all
    line : frame line of the building, from 1, of a quantity of LINE; 0 of others
    over_buildings : reduction over buildings where it is another one than that over their storeys; "" of others
    role : STIFFEST or SOFTER in place of a building; "" of others
    case, analysis, motion : its place from 0; None for each
    law : of the links; "" for all
    point : numbers of axes of the sweep with its place on each
    instant : None of a peak
    """

    name: str
    reduction: str = "largest"
    building: int | None = None
    level: int = 0
    line: int = 0
    over_buildings: str = ""
    role: str = ""
    case: int | None = None
    analysis: int | None = None
    motion: int | None = None
    law: str = ""
    point: tuple[tuple[int, int], ...] = ()
    instant: Instant | None = None

    @property
    def is_of_links(self) -> bool:
        """Whether it belongs to links, and not to buildings."""
        return self.name in LINK or self.name in LINK_FACTS


Value = Callable[[TableQuantity], np.ndarray]
Work = Callable[[Value], np.ndarray]


@dataclass(frozen=True)
class Expression:
    """An expression.

    text : as people read it
    unit : SI unit; "" of a pure number, and where the parts have different ones
    quantities : the numbers of the tables that it rests on
    is_plain : whether it is its only quantity, without arithmetic
    """

    text: str
    unit: str
    quantities: tuple[TableQuantity, ...]
    _work: Work
    is_plain: bool = False

    def __call__(self, value: Value) -> np.ndarray:
        """Return the expression from the values of its quantities; not finite where it has none (a root of -1)."""
        with np.errstate(all="ignore"):
            return self._work(value)

    def __str__(self) -> str:
        return self.text


class ExpressionError(ValueError):
    """A fault in an expression; the second argument says what to write."""


def parse_expression(text: str, scope: Scope, over_height: bool = False) -> Expression:
    """Return an expression over the tables of a study.

    over_height : take drifts over the height of their storeys, where the expression is a length and has drifts only

    Raises
    ------
    ExpressionError : what is wrong, and what to write
    """
    hint = expression_hint(scope.buildings)
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"{len(text)} characters are not an expression", hint)
    text = " ".join(text.split())
    quantities: list[TableQuantity] = []

    def replace_phrase(match: re.Match[str]) -> str:
        """Return a name, `_0`, `_1`, in place of a quantity."""
        if match["name"] in _FUNCTIONS and match["how"] is None:
            return match[0]
        try:
            quantities.append(_parse_quantity(match, scope))
        except ExpressionError as error:
            raise ExpressionError(f"'{text}': {error.args[0]}", error.args[1]) from None
        return f"_{len(quantities) - 1}"

    arithmetic = re.sub(_PHRASE.format(places=_place_pattern(scope)), replace_phrase, text)
    try:
        node = ast.parse(arithmetic.strip(), mode="eval").body
        unit, work = _compile_node(node, quantities)
        if over_height and unit == "m" and all(map(_has_ratio, quantities)):
            quantities = [replace(each, name=OVER_HEIGHT[each.name]) for each in quantities]
            unit, work = _compile_node(node, quantities)
    except ExpressionError as error:
        raise ExpressionError(f"'{text}': {error}", hint) from None
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        message = "this is not arithmetic with the numbers of the tables"
        if arithmetic.count("(") > arithmetic.count(")"):
            message = "a bracket is not closed"
        raise ExpressionError(f"'{text}': {message}", hint) from None
    if not quantities or "#" in arithmetic:
        raise ExpressionError(f"'{text}': it takes nothing from the tables", hint)
    is_plain = isinstance(node, ast.Name)
    return Expression(text, "" if unit in (None, _MIXED) else unit, tuple(quantities), work, is_plain)


def _has_ratio(quantity: TableQuantity) -> bool:
    """Return whether the tables have a quantity over the height of its storey, too."""
    return quantity.name in OVER_HEIGHT and quantity.instant is None


def _place_pattern(scope: Scope) -> str:
    """Return the pattern of one place of a quantity."""
    named = {kind: sorted(names, key=len, reverse=True) for kind, names in scope.names.items()}
    laws = "|".join(map(re.escape, named.pop(_LAW)))
    every = sorted({name for names in named.values() for name in names}, key=len, reverse=True)
    either = "|".join(map(re.escape, every))
    words = _PLACE_WORDS.format(roles="|".join((STIFFEST, SOFTER)))
    of_links = rf"|(?:{laws})\s+links\b" if laws else ""
    return rf"{words}{of_links}|(?:(?:{'|'.join(named)})\s+)?(?:{either})(?![\w-])"


def _parse_quantity(match: re.Match[str], scope: Scope) -> TableQuantity:
    """Return the quantity of a phrase such as `mean mu in soft storey 2`.  Raises ExpressionError."""
    name = match["name"]
    buildings = scope.buildings
    if name == "in":
        raise ExpressionError(
            "places stand behind one `in`, before brackets", f"write e.g. `time in {buildings[0]} [1.1 s]`"
        )
    if name == "line":
        raise ExpressionError("a frame line stands before its building", f"write e.g. `mu in line 1 of {buildings[0]}`")
    if name in LINE:
        of_storey = name.removeprefix("line_")
        raise ExpressionError(f"{name} belongs to a frame line", f"write `{of_storey} in line 1 of {buildings[0]}`")
    point, instant = _parse_where(match["where"], scope)
    known = QUANTITIES if instant is None else HISTORY
    if name not in known:
        if name in HISTORY and scope.cases:
            hint = f"write e.g. `{name} [1.1 s]` or `{name} [contact 1]`"
            raise ExpressionError(f"{name} is a number of an instant", hint)
        kind = "quantity" if instant is None else "quantity over time"
        raise ExpressionError(f"no {kind} '{name}' is known", nearest(name, (*known, *_FUNCTIONS)))
    place = _parse_places(match, name, scope)
    names = [each.removeprefix("line_") for each in LINE]
    line = _check_line(place.line, name, names)
    of_line = f"line_{name}" if line else name
    reduction = match["how"] or ""
    if not (name == SHEAR_DEMAND and scope.of_limits):
        _check_owner(name, instant, place, reduction)
    level = 0
    if place.level:
        owner = name if instant is None or name in _HISTORY_OF_LEVELS else instant.quantity
        level = _check_level(place.level, owner in (FLOOR if instant is None else _OF_FLOORS), owner)
    quantity = TableQuantity(
        of_line, reduction or REDUCTIONS[0], place.building, level, line, match["over"] or "", place.role,
        place.case, place.analysis, place.motion, place.law, point, instant,
    )  # fmt: skip
    if quantity.over_buildings and (name not in (*STOREY, *FLOOR) or quantity.building is not None):
        raise ExpressionError(
            f"'{match['over']} {match['how']}' is of the buildings, then of their storeys", "write one of the two"
        )
    return quantity


def _check_owner(name: str, instant: Instant | None, place: _Places, reduction: str) -> None:
    """Raise ExpressionError where a phrase names a place that its quantity does not have, or reduces one number.

    reduction : as written; "" of none
    """
    written = place.role or place.level
    if instant is not None:
        has_building = any(each in _HISTORY_OF_BUILDINGS for each in (name, instant.quantity))
        has_level = any(each in _HISTORY_OF_LEVELS for each in (name, instant.quantity))
        owner = "links" if name in _HISTORY_OF_LINKS else "a time history"
        if place.line is not None:
            raise ExpressionError("histories of frame lines have no numbers of an instant", "leave the line out")
        if place.role:
            raise ExpressionError(f"'{place.role}' has no numbers of an instant", "write the name of the building")
        if reduction:
            hint = f"leave '{reduction}' out, and name the building and its storey or floor"
            raise ExpressionError(f"'{reduction}' is not of a number at an instant", hint)
    else:
        dims = variables.VARIABLES[f"record_{name}" if name in OF_MOTIONS else name].dims
        has_building = "building" in dims
        has_level = "storey" in dims or "floor" in dims
        owner = "a motion" if name in OF_MOTIONS else "a time history"
        if reduction and not has_building and "link" not in dims:
            hint = f"write `{name}`; `over_motions:` tells what is taken over the motions"
            raise ExpressionError(f"{name} is one number of {owner}, without a {reduction} one", hint)
    if not has_building and (place.building is not None or written):
        raise ExpressionError(f"{name} belongs to {owner}, not to a building", f"leave the {_say_place(place)} out")
    if place.level and not has_level:
        raise ExpressionError(f"{name} belongs to a building, not to a storey or floor", f"leave '{written}' out")


def _say_place(place: _Places) -> str:
    """Return the kind of the place of a building that a phrase names."""
    return "building" if place.building is not None or place.role else place.level.split()[0]


@dataclass
class _Places:
    """The places of a phrase, as it names them."""

    building: int | None = None
    case: int | None = None
    analysis: int | None = None
    motion: int | None = None
    law: str = ""
    role: str = ""
    level: str = ""
    line: str | None = None


def _parse_places(match: re.Match[str], name: str, scope: Scope) -> _Places:
    """Return the places behind `in` of a phrase.  Raises ExpressionError."""
    places = _Places()
    if match["in"] is None:
        return places
    buildings = scope.buildings
    written = [each[1] for each in re.finditer(rf"\s+({_place_pattern(scope)})", match["places"])]
    unknown = re.split(r"[-+*/(),<>=\[]", match.string[match.end("places") :])[0].strip()[:40]
    is_link = name in (*LINK, *LINK_FACTS) and not (name == SHEAR_DEMAND and scope.of_limits)
    of_line = bool(written) and written[-1].startswith("line ")  # no building stands behind it
    if not written or of_line:
        if is_link and not scope.cases:
            raise ExpressionError(f"{name} belongs to links, not to a building", f"write `{name}`: of all links")
        asked = re.match(r"line\s+([0-9]+)", unknown or " ".join(written[-1:]))
        if asked is not None:
            hint = f"write `{name} in line {asked[1]} of {buildings[0]}`"
            raise ExpressionError(f"line {asked[1]} of which building?", hint)
        if several := _list_places_of_type(unknown, buildings):
            repeated = several[0].rpartition("-")[0]
            hint = f"write {' or '.join(f'`{name} in {each}`' for each in several)}"
            raise ExpressionError(f"'{repeated}' stands at {len(several)} places of the group", hint)
        every = {kind: names for kind, names in scope.names.items() if names and kind != _LAW}
        kinds = ", ".join(every).replace(", motion", " or motion")
        raise ExpressionError(
            f"no {kinds} '{unknown}' in the {'group' if len(every) == 1 else 'study'}",
            nearest(unknown, [each for names in every.values() for each in names]),
        )
    for each in written:
        _take_place(places, each, scope)
    if places.law and name in _HISTORY_OF_LINKS:
        raise ExpressionError(f"{name} is of all links of a case, not of one law", "leave the links out")
    if places.law and not is_link:
        raise ExpressionError(f"{name} belongs to no link", "leave the links out")
    if is_link and (places.building is not None or places.role or places.level):
        raise ExpressionError(f"{name} belongs to links, not to a building", f"write `{name}`: of all links")
    if places.line is not None and places.building is None:
        raise ExpressionError(
            f"line {places.line} of which building?", f"write `{name} in line {places.line} of {buildings[0]}`"
        )
    return places


def _list_places_of_type(written: str, buildings: Sequence[str]) -> list[str]:
    """Return the names of the places at which a building stands, soft-1 and soft-2, where a text begins with its name,
    `soft`; none where it stands once."""
    for building in buildings:
        name = building.rpartition("-")[0]
        places = [each for each in buildings if re.fullmatch(rf"{re.escape(name)}-[0-9]+", each)]
        if name and len(places) > 1 and f"{written} ".startswith(f"{name} "):
            return places
    return []


def _take_place(places: _Places, written: str, scope: Scope) -> None:
    """Add one place of a phrase to those before it.  Raises ExpressionError."""
    first, _, rest = written.partition(" ")
    if first == "line" and rest:
        places.line = rest.split()[0]
    elif first in ("storey", "floor") and rest.isdigit():
        if places.level:
            raise ExpressionError(f"'{written}' is a second {first}", f"write one {first}")
        places.level = written
    elif written in (STIFFEST, SOFTER):
        if places.role or places.building is not None:
            raise ExpressionError(f"'{written}' is a second building", "write one building")
        places.role = written
    elif (law := written.removesuffix(" links")) != written:
        if places.law:
            raise ExpressionError(f"'{written}' is a second law of links", "write one law")
        places.law = law
    else:
        kinds = [kind for kind in _KINDS if kind != _LAW and written in scope.names[kind]]
        if not kinds and first in _KINDS:
            kinds, written = [first], rest
        if len(kinds) > 1:
            said = " and ".join(f"a {kind}" for kind in kinds)
            raise ExpressionError(f"'{written}' is {said}", f"write `{kinds[0]} {written}` or `{kinds[1]} {written}`")
        kind = kinds[0]
        if written not in scope.names[kind]:
            raise ExpressionError(f"no {kind} '{written}' in the study", nearest(written, scope.names[kind]))
        if getattr(places, kind) not in (None, "") or (kind == _KINDS[0] and places.role):
            raise ExpressionError(f"'{written}' is a second {kind}", f"write one {kind}")
        setattr(places, kind, scope.names[kind].index(written))


_INSTANT = re.compile(
    r"(?:(?P<time>[-+.0-9]\S* ?[A-Za-zµ]+)(?:\s+(?P<side>after|before)\s+|\Z))?"
    r"(?:(?P<kind>contact|release)\s+(?P<number>-?[1-9][0-9]*)|"
    r"(?P<most>largest|smallest)\s+(?P<quantity>\w+)(?:\s+(?P<part>after|before)\s+(?P<end>.+))?)?\Z"
)
_INSTANT_HINT = (
    "write e.g. `[1.1 s]`, `[contact 1]`, `[release 1]`, `[0.2 ms after contact 1]`, `[largest closing]` or "
    "`[largest closing after contact 2]`"
)
_OF_FLOORS = ("displacement", "velocity", "total_acceleration", "twist")
_HISTORY_OF_LEVELS = (*_OF_FLOORS, "drift", "shear")
_HISTORY_OF_BUILDINGS = (*_HISTORY_OF_LEVELS, "sway")
_HISTORY_OF_LINKS = ("closing", "link_force")


def _parse_where(text: str | None, scope: Scope) -> tuple[tuple[tuple[int, int], ...], Instant | None]:
    """Return the point of the sweep and the instant in the brackets of a phrase.  Raises ExpressionError."""
    written: dict[str, str] = {}
    instant = None
    for part in [] if text is None else text.split(","):
        key, sign, value = (each.strip() for each in part.partition("="))
        if sign:
            written[key] = value
        elif instant is None:
            instant = _parse_instant(key)
        else:
            raise ExpressionError(f"[{text}] has two instants", "write one")
    return tuple({**dict(scope.point), **dict(find_point(written, scope.axes))}.items()), instant


def find_point(written: Mapping[str, str], axes: Sequence[Axis]) -> tuple[tuple[int, int], ...]:
    """Return the numbers of the axes of some swept keys, with the place of their values on each.

    written : values as people write them, by key

    Raises
    ------
    ExpressionError : a key is not swept, or does not take the value, or takes it more than once
    """
    point = []
    for number, axis in enumerate(axes):
        asked = {key: value for key, value in written.items() if key in axis.names}
        if not asked:
            continue
        at = axis.find_places(asked)
        said = ", ".join(f"{key} = {value}" for key, value in asked.items())
        if len(at) != 1:
            points = [axis.format_point(place) for place in (at or range(len(axis)))]
            message = f"the sweep has {len(at)} points with {said}" if at else f"the sweep has no point with {said}"
            raise ExpressionError(message, f"it has: {'; '.join(points)[:300]}")
        point.append((number, at[0]))
    known = [name for axis in axes for name in axis.names]
    for key in written:
        if key not in known:
            raise ExpressionError(f"'{key}' is not swept", nearest(key, known))
    return tuple(point)


def _parse_instant(text: str) -> Instant:
    """Return an instant as people write it.  Raises ExpressionError."""
    match = _INSTANT.match(text)
    if match is None or not text or (match["side"] and not (match["kind"] or match["most"])):
        raise ExpressionError(f"[{text}] is not an instant", _INSTANT_HINT)
    delay = 0.0
    if match["time"]:
        try:
            delay = float(INSTANT_TIME.read(match["time"]))
        except PydanticCustomError:
            raise ExpressionError(f"[{text}]: '{match['time']}' is not a time", _INSTANT_HINT) from None
        delay = -delay if match["side"] == "before" else delay
    if match["most"]:
        if match["quantity"] not in HISTORY or match["quantity"] == "time":
            message = f"[{text}]: no quantity '{match['quantity']}' over time"
            raise ExpressionError(message, nearest(match["quantity"], HISTORY))
        end = _parse_instant(match["end"]) if match["end"] else None
        return Instant(match["most"], 0, match["quantity"], delay, match["part"] or "", end)
    if match["kind"]:
        return Instant(match["kind"], int(match["number"]), "", delay)
    return Instant("time", 0, "", delay)


def _check_line(number: str | None, name: str, of_lines: Sequence[str]) -> int:
    """Return the number of the frame line of a quantity or limit, from 1; 0 where it names none.  Raises
    ExpressionError: lines do not have the quantity, or there is no line 0.

    of_lines : quantities that lines have
    """
    if number is None:
        return 0
    if name not in of_lines:
        hint = f"write one of {', '.join(of_lines)}, or leave the line out"
        raise ExpressionError(f"frame lines have no {name}", hint)
    if int(number) < 1:
        raise ExpressionError("there is no line 0", "the first is `line 1`, as the plan lists them")
    return int(number)


def _check_level(written: str, is_of_floors: bool, owner: str) -> int:
    """Return the number of a storey or floor.  Raises ExpressionError: it is the other of the two, or 0.

    written : e.g. `storey 2`
    owner : quantity of the storey or floor, in words
    """
    word, number = written.split()
    kind = "floor" if is_of_floors else "storey"
    if word != kind:
        raise ExpressionError(f"{owner} belongs to a {kind}", f"write `{kind} {number}`")
    if int(number) < 1:
        raise ExpressionError(f"there is no {kind} 0", f"the lowest is `{kind} 1`")
    return int(number)


_MIXED = "?"
"""Unit of numbers whose parts have different ones."""


def _compile_node(node: ast.expr, quantities: Sequence[TableQuantity]) -> tuple[str | None, Work]:
    """Return the unit of a part of an expression, None of a plain number, and the function that computes it.  Raises
    ExpressionError."""
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return None, lambda value: np.asarray(float(number))
        case ast.Name(id=name) if name not in _FUNCTIONS:
            quantity = quantities[int(name[1:])]
            known = {**QUANTITIES, **LINE} if quantity.instant is None else HISTORY
            return known[quantity.name], lambda value: value(quantity)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            unit, work = _compile_node(inner, quantities)
            return unit, lambda value: -work(value)
        case ast.BinOp(op=sign, left=left, right=right) if type(sign) in _SIGNS:
            return _compile_operation(_SIGNS[type(sign)], [left, right], quantities, type(sign))
        case ast.Call(func=ast.Name(id=name), args=inner, keywords=[]) if name in _FUNCTIONS:
            if (len(inner) > 1) != (name in _SEVERAL):
                raise ExpressionError(f"{name} takes {'two values or more' if name in _SEVERAL else 'one value'}")
            return _compile_operation(_FUNCTIONS[name], inner, quantities, name)
    raise ExpressionError(
        "only numbers of the tables, + - * /, brackets, max, min, abs, sqrt, log and exp are understood"
    )


def _compile_operation(
    work: Callable[..., np.ndarray], nodes: Sequence[ast.expr], quantities: Sequence[TableQuantity], kind: Any
) -> tuple[str | None, Work]:
    """Return the unit of parts that are joined, two at a time where there are several, and the function that computes
    them.

    kind : of the operation: a type of `ast`, or the name of a function
    """
    parts = [_compile_node(node, quantities) for node in nodes]

    def operate(value: Value) -> np.ndarray:
        first, *others = (part(value) for _, part in parts)
        if not others:
            return work(first)
        for other in others:
            first = work(first, other)
        return first

    return _find_unit([unit for unit, _ in parts], kind), operate


def _find_unit(units: Sequence[str | None], kind: Any) -> str | None:
    """Return the unit of an operation on parts with units; plain numbers take that of what they are added to."""
    known = [unit for unit in units if unit is not None]
    if not known:
        return None
    if kind in _KEEP_UNIT:
        return known[0] if len(set(known)) == 1 else _MIXED
    if kind is ast.Mult:
        factors = [unit for unit in known if unit]
        return factors[0] if len(factors) == 1 else _MIXED if factors else ""
    if kind is ast.Div:
        above, below = units
        if below in (None, ""):
            return above or ""
        return "" if above == below != _MIXED else _MIXED
    return "" if set(known) == {""} else _MIXED


# Statements


def statement_hint(buildings: Sequence[str]) -> str:
    """Return how a statement is written, with the buildings of the study."""
    return f"write e.g. `mu > 4`, `drift in {buildings[-1]} > 2 cm` or `mean V_ratio in {buildings[0]} < 1.1`"


_SIGN = re.compile(r"\s*(<=|>=|<|>)\s*")
ROUNDING = 4 * float(np.finfo(float).eps)
"""Numbers that differ by this share of the larger one are the same [-]."""

_BEHIND = re.compile(r"(?P<value>.*\S)\s+in\s+(?P<place>\S.*)")
"""A value with a place behind it, as limits have it."""
_NAMES = re.compile(r"[^\W\d]\w*")
_VALUES = {"": "4", "m": "2 cm", "m/s2": "1 g", "N": "500 kN", "s": "0.1 s", "N s": "20 kN s", "rad": "0.01 rad"}


@dataclass(frozen=True)
class Statement:
    """A statement that expressions and values lie above or below one another: `mu > 4`, `0 < a / b - 1 < 15 %`.

    text : as people read it
    parts : expressions and values [SI], left to right
    signs : between them: <, >, <= or >=
    written_unit : of its values; "" where they have none
    """

    text: str
    parts: tuple[Expression | float, ...]
    signs: tuple[str, ...]
    written_unit: str = ""

    @property
    def expressions(self) -> tuple[Expression, ...]:
        """The expressions among its parts."""
        return tuple(part for part in self.parts if isinstance(part, Expression))

    @property
    def quantities(self) -> tuple[TableQuantity, ...]:
        """The numbers of the tables that it rests on."""
        return tuple(quantity for part in self.expressions for quantity in part.quantities)

    @property
    def first(self) -> Expression:
        """The first expression."""
        return self.expressions[0]

    @property
    def scale(self) -> float:
        """The size of its values, by which it is missed or met [SI]; 1 where they are 0 or where there are none."""
        return max((abs(part) for part in self.parts if isinstance(part, float)), default=0.0) or 1.0

    @property
    def bounds_below(self) -> bool:
        """Whether it holds the better, the larger its first expression is."""
        place = self.parts.index(self.first)
        return (self.signs[place] if place < len(self.signs) else {"<": ">", ">": "<"}[self.signs[-1][0]])[0] == ">"

    def find_parts(self, value: Value) -> list[np.ndarray]:
        """Return the values of its parts from those of its quantities [SI]; NaN where an expression has none."""
        parts = [part(value) if isinstance(part, Expression) else np.asarray(part) for part in self.parts]
        return [np.where(np.isfinite(part), part, np.nan) for part in parts]

    def find_steps(self, parts: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return by how much every comparison of two neighbouring parts is met, below 0 where it is missed; 0 where
        they differ by no more than rounding [SI]."""
        steps = []
        for left, sign, right in zip(parts[:-1], self.signs, parts[1:], strict=True):
            step = right - left if sign.startswith("<") else left - right
            is_rounding = np.abs(step) <= ROUNDING * np.maximum(np.abs(left), np.abs(right))
            steps.append(np.where(is_rounding, 0.0, step))
        return steps

    def margin(self, value: Value) -> np.ndarray:
        """Return by how much the statement is met, below 0 where it is missed; NaN where there is no value [SI]."""
        first, *others = self.find_steps(self.find_parts(value))
        for step in others:
            first = np.minimum(first, step)  # NaN stays NaN
        return np.asarray(first)

    def find_held(self, value: Value) -> np.ndarray:
        """Return 1 where the statement holds, 0 where it does not, NaN where there is no value."""
        is_met: np.ndarray | bool = True
        for sign, step in zip(self.signs, self.find_steps(self.find_parts(value)), strict=True):
            is_met = is_met & (step >= 0 if sign.endswith("=") else step > 0)
        return np.where(np.isnan(self.margin(value)), np.nan, is_met)

    def __str__(self) -> str:
        return self.text


def parse_statement(text: str, scope: Scope) -> Statement:
    """Return a statement over the tables of a study; arguments and errors as those of `parse_expression`."""
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"{len(text)} characters are not a comparison", statement_hint(scope.buildings))
    text = " ".join(text.split())
    outside = re.sub(r"\[[^\[\]]*\]", lambda match: "_" * len(match[0]), text)  # a point of the sweep has signs too
    marks = list(_SIGN.finditer(outside))
    ends = [0, *(end for mark in marks for end in mark.span()), len(text)]
    sides = [text[begin:end].strip() for begin, end in zip(ends[::2], ends[1::2], strict=True)]
    signs = tuple(mark[1] for mark in marks)
    if not signs or "" in sides[:1] or "=" in _SIGN.sub(" ", outside):
        raise ExpressionError(f"'{text}' is not compared with a value by < or >", statement_hint(scope.buildings))
    if len(sides) > 3 or len({sign[0] for sign in signs}) > 1:
        hint = statement_hint(scope.buildings)
        raise ExpressionError(f"'{text}' compares more than one number with its lower and upper end", hint)
    known = {*QUANTITIES, *HISTORY, *(name.removeprefix("line_") for name in LINE)}
    names = [set(_NAMES.findall(side)) & known for side in sides]
    if not any(names):
        parse_expression(sides[0], scope)  # says what is wrong with it
        raise ExpressionError(f"'{text}': it takes nothing from the tables", statement_hint(scope.buildings))
    in_percent = any(written_unit(side) == "%" for side in sides)
    parsed = [
        parse_expression(side, scope, in_percent) if found else None for side, found in zip(sides, names, strict=True)
    ]
    first = next(each for each in parsed if each is not None)
    parts: list[Expression | float] = []
    for side, expression in zip(sides, parsed, strict=True):
        parts.append(_parse_value(text, side, first, sides, signs) if expression is None else expression)
    units = {part.unit for part in parts if isinstance(part, Expression)}
    if len(units) > 1:
        found = " and ".join(f"[{unit or '-'}]" for unit in sorted(units))
        raise ExpressionError(f"'{text}' compares numbers in {found}", "compare numbers of one unit")
    written = next((written_unit(side) for side, each in zip(sides, parsed, strict=True) if each is None), "")
    return Statement(text, tuple(parts), signs, written)


def _parse_value(
    text: str, written: str, expression: Expression, sides: Sequence[str], signs: Sequence[str]
) -> float:  # fmt: skip
    """Return a value of a statement [SI].  Raises ExpressionError.

    written : the value
    expression : that it is compared with
    """
    behind = _BEHIND.fullmatch(written)
    if behind is not None and len(sides) == 2:
        ordered = _put_place_before(behind, written, sides, signs)
        raise ExpressionError(f"'{text}': the place stands behind the value", f"write `{ordered}`")
    unit = expression.unit
    shown = _VALUES.get(unit, f"1 {unit}")
    hint = f"write e.g. `{expression} {signs[0]} {shown}`"
    if unit == "m" and all(map(_has_ratio, expression.quantities)):
        hint += f" or `{expression} {signs[0]} 2 %`"
    measure = Quantity("value", unit, shown)
    try:
        number = float(measure.read(written))
    except PydanticCustomError as error:
        raise ExpressionError(f"'{text}': {(error.context or {})['message']}", hint) from None
    if unit and not written_unit(written):
        raise ExpressionError(f"'{text}': the value has no unit", hint)
    return number


def _put_place_before(behind: re.Match[str], written: str, sides: Sequence[str], signs: Sequence[str]) -> str:
    """Return a statement whose place stands behind its value, `mu > 4 in soft`, as it is written: `mu in soft > 4`.

    behind : match of the value with its place
    """
    other = sides[1] if written == sides[0] else sides[0]
    joint = " " if re.search(r"\sin\s", other) else " in "  # it names a place already
    ordered = f"{other}{joint}{behind['place']}"
    value = behind["value"]
    return f"{value} {signs[0]} {ordered}" if written == sides[0] else f"{ordered} {signs[0]} {value}"


# Limits


CONTACT = "contact"
COLLAPSE = "collapse"
DRIFT_RATIO = "drift_ratio"
DAMAGE_LIMITS = {f"{state} damage": state for state in DAMAGE_STATES}
"""Limits of buildings that are only seen: the drift at which a damage state of their type begins."""

EDGE_DRIFT = "edge_drift"
EDGE_DRIFT_RATIO = "edge_drift_ratio"
TWIST = "twist"
EVENTS = (CONTACT, COLLAPSE, *DAMAGE_LIMITS)
"""Limits without a value."""

OF_HEIGHT = {OVER_HEIGHT[name]: name for name in ("drift", EDGE_DRIFT)}
"""Quantity that is a part of the storey's height -> the same as a length."""

_RANGES = {
    "mu": Quantity("ductility", "", "mu > 4", 0.0, 1e6, open_low=True),
    "drift": LENGTH.replace(name="drift", example="drift > 6 cm"),
    "drift_ratio": Quantity("drift ratio", "", "drift > 2 %", 0.0, 1.0, open_low=True, open_high=True),
    EDGE_DRIFT: LENGTH.replace(name="edge drift", example="edge_drift > 6 cm"),
    "edge_drift_ratio": Quantity("edge drift ratio", "", "edge_drift > 2 %", 0.0, 1.0, open_low=True, open_high=True),
    TWIST: Quantity("twist", "rad", "twist > 0.01 rad", 0.0, 1.0, open_low=True),
    "acceleration": ACCELERATION.replace(example="acceleration > 1 g"),
    SHEAR_DEMAND: Quantity("shear demand", "", "shear_demand > 1", 0.0, 1e6, open_low=True),
}
"""Quantities that may be limited, with the range of the limit."""

LIMITS = (*_RANGES, *EVENTS)

LIMITS_OF_PAIRS = (CONTACT, SHEAR_DEMAND)
"""Limits that a building alone cannot pass."""

_EVENT = re.compile(rf"(?P<event>{'|'.join(EVENTS)})\b\s*(?P<rest>.*)")
_FIRST_NAME = re.compile(rf"(?:(?:{'|'.join(REDUCTIONS)})\s+)*(?P<name>[^\W\d]\w*)")


def limit_hint(buildings: Sequence[str]) -> str:
    """Return how a limit is written, with the buildings of the study."""
    return (
        f"write e.g. `mu > 4`, `mu in {buildings[0]} storey 1 > 4`, `drift > 2 %`, `edge_drift > 2 %`, "
        f"`acceleration > 1 g`, `shear_demand > 1`, `contact` or `collapse in {buildings[-1]}`"
    )


@dataclass(frozen=True)
class Limit:
    """One limit.

    text : as people read it
    quantity : one of LIMITS
    value : [-], [m] or [m/s2]; 0 of contact, where a gap that closes passes the limit, and of collapse
    of_height : the value is a part of the storey's height
    building : the place in the group of the only one it concerns, from 0; None for each of them
    level : its only storey or floor, from 1 at the ground; 0 for any of them
    line : the only frame line of that building it concerns, from 1; 0 for the storeys
    """

    text: str
    quantity: str
    value: float = 0.0
    of_height: bool = False
    building: int | None = None
    level: int = 0
    line: int = 0

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Target:
    """The limit of a curve, and the building that it concerns.

    building : its place in the group; of contact that of the left one of a pair
    is_damage : whether the limit is the drift at which a damage state begins
    """

    limit: Limit
    building: int
    is_damage: bool = False

    def label(self, names: tuple[str, ...]) -> str:
        """Return the name of the building, or of the pair."""
        if self.limit.quantity == CONTACT:
            return f"{names[self.building]}|{names[self.building + 1]}"
        return names[self.building]


def parse_limit(text: str, scope: Scope) -> Limit:
    """Return a limit of fragility: an event, or a statement that one quantity lies above a value.

    Raises
    ------
    ExpressionError : what is wrong, and what to write
    """
    text = " ".join(text[: MAX_LENGTH + 1].split())
    event = _EVENT.match(text)
    if event is not None:
        return _parse_event(text, event, scope)
    wrong = f"'{text[:60]}' is not a limit"
    hint = limit_hint(scope.buildings)
    first = _FIRST_NAME.match(text)
    name = first["name"] if first else text.partition(">")[0].strip()
    if name not in _RANGES:
        raise ExpressionError(wrong, f"{nearest(name, LIMITS)}; {hint}")
    if not _SIGN.search(text):
        raise ExpressionError(f"{wrong}: {name} takes `>` and a value", hint)
    statement = parse_statement(text, replace(scope, of_limits=True))
    expression, value = statement.parts[:2]
    if len(statement.parts) > 2 or not (isinstance(expression, Expression) and isinstance(value, float)):
        raise ExpressionError(f"{wrong}: it compares more than one quantity with one number", hint)
    if statement.signs != (">",):
        raise ExpressionError(f"{wrong}: {name} takes `>` and a value", hint)
    part = expression.quantities[0]
    if not expression.is_plain or part != TableQuantity(
        part.name, building=part.building, level=part.level, line=part.line
    ):
        raise ExpressionError(f"{wrong}: it takes the largest of one quantity, without arithmetic", hint)
    quantity = part.name.removeprefix("line_")
    try:
        _RANGES[quantity].read(value)
    except PydanticCustomError as error:
        message = (error.context or {})["message"]
        raise ExpressionError(f"'{text}': {message}", _RANGES[quantity].usage) from None
    length = OF_HEIGHT.get(quantity, quantity)
    return Limit(text, length, value, length != quantity, part.building, part.level, part.line)


def _parse_event(text: str, event: re.Match[str], scope: Scope) -> Limit:
    """Return a limit without a value, `collapse in soft`.  Raises ExpressionError."""
    name, rest = event["event"], event["rest"]
    hint = limit_hint(scope.buildings)
    if _SIGN.search(rest):
        raise ExpressionError(f"'{text[:60]}' is not a limit: {name} takes no value", hint)
    if not rest:
        return Limit(text, name)
    phrase = re.match(_PHRASE.format(places=_place_pattern(scope)), f"{name.split()[-1]} {rest}")
    if phrase is None or phrase["in"] is None:
        raise ExpressionError(f"'{text[:60]}' is not a limit", hint)
    if name == CONTACT:
        raise ExpressionError(f"'{text}': {name} concerns two buildings, not one of them", f"write `{name}`")
    try:
        places = _parse_places(phrase, name, scope)
    except ExpressionError as error:
        raise ExpressionError(f"'{text}': {error.args[0]}", error.args[1]) from None
    if places != _Places(places.building) or phrase.end() < len(phrase.string):
        message = f"'{text}': {name} concerns a building, not one of its storeys"
        raise ExpressionError(message, f"write `{name}` or `{name} in {scope.buildings[-1]}`")
    return Limit(text, name, building=places.building)

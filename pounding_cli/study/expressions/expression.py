"""Expressions over the tables: `largest mu in soft`, `mean V_ratio in infill stiff storey 2`, `time [contact 2]`.

Quantities are read first, each with its place; what is left is arithmetic, which Python parses and nothing runs."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from pounding_cli import variables
from pounding_cli.errors import InputError
from pounding_cli.study.schema.quantity import TIME
from pounding_cli.study.text.file import nearest
from pounding_cli.study.vary.axes import Axis

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
PHRASE = (
    r"(?<![\w.])(?:(?P<over>largest|smallest|mean)\s+(?=(?:largest|smallest|mean)\b))?"
    r"(?:(?P<how>largest|smallest|mean)\s+)?(?P<name>[^\W\d]\w*)"
    r"(?P<in>\s+in\b(?P<places>(?:\s+(?:{places}))*))?(?:\s*\[(?P<where>[^\[\]]*)\])?"
)
STIFFEST, SOFTER = "stiffest building", "softer buildings"
"""The building of the group with the shortest period on a fixed base, of several the first; all with a longer one."""

ABSENT = -1
"""Place of a motion that the study does not use."""

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
    absent : names of motions of the catalogue that the study does not use; what is asked under one has no value
    of_limits : whether `shear_demand` may name the building and storey whose columns are loaded, as limits do
    """

    buildings: tuple[str, ...]
    cases: tuple[str, ...] = ()
    analyses: tuple[str, ...] = ()
    motions: tuple[str, ...] = ()
    laws: tuple[str, ...] = ()
    axes: tuple[Axis, ...] = ()
    point: tuple[tuple[int, int], ...] = ()
    absent: tuple[str, ...] = ()
    of_limits: bool = False

    @property
    def names(self) -> dict[str, tuple[str, ...]]:
        """The names of every kind, in the order of _KINDS."""
        kinds = (self.buildings, self.cases, self.analyses, (*self.motions, *self.absent), self.laws)
        return dict(zip(_KINDS, kinds, strict=True))

    @cached_property
    def place_pattern(self) -> str:
        """The pattern of one place of a quantity."""
        named = {kind: sorted(names, key=len, reverse=True) for kind, names in self.names.items()}
        laws = "|".join(map(re.escape, named.pop(_LAW)))
        every = sorted({name for names in named.values() for name in names}, key=len, reverse=True)
        either = "|".join(map(re.escape, every))
        words = _PLACE_WORDS.format(roles="|".join((STIFFEST, SOFTER)))
        of_links = rf"|(?:{laws})\s+links\b" if laws else ""
        return rf"{words}{of_links}|(?:(?:{'|'.join(named)})\s+)?(?:{either})(?![\w-])"


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
    case, analysis, motion : its place from 0; None for each; ABSENT of a motion that is not used
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


def parse_expression(text: str, scope: Scope, over_height: bool = False) -> Expression:
    """Return an expression over the tables of a study.

    over_height : take drifts over the height of their storeys, where the expression is a length and has drifts only

    Raises
    ------
    InputError : what is wrong, and what to write
    """
    hint = expression_hint(scope.buildings)
    if len(text) > MAX_LENGTH:
        raise InputError(f"{len(text)} characters are not an expression", hint)
    text = " ".join(text.split())
    quantities: list[TableQuantity] = []

    def replace_phrase(match: re.Match[str]) -> str:
        """Return a name, `_0`, `_1`, in place of a quantity."""
        if match["name"] in _FUNCTIONS and match["how"] is None:
            return match[0]
        try:
            quantities.append(_parse_quantity(match, scope))
        except InputError as error:
            raise error.about(text) from None
        return f"_{len(quantities) - 1}"

    arithmetic = re.sub(PHRASE.format(places=scope.place_pattern), replace_phrase, text)
    try:
        node = ast.parse(arithmetic.strip(), mode="eval").body
        unit, work = _compile_node(node, quantities)
        if over_height and unit == "m" and all(map(has_ratio, quantities)):
            quantities = [replace(each, name=OVER_HEIGHT[each.name]) for each in quantities]
            unit, work = _compile_node(node, quantities)
    except InputError as error:
        raise InputError([replace(each, hint=hint) for each in error.about(text).issues]) from None
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        message = "this is not arithmetic with the numbers of the tables"
        if arithmetic.count("(") > arithmetic.count(")"):
            message = "a bracket is not closed"
        raise InputError(f"'{text}': {message}", hint) from None
    if not quantities or "#" in arithmetic:
        raise InputError(f"'{text}': it takes nothing from the tables", hint)
    is_plain = isinstance(node, ast.Name)
    return Expression(text, "" if unit in (None, _MIXED) else unit, tuple(quantities), work, is_plain)


def has_ratio(quantity: TableQuantity) -> bool:
    """Return whether the tables have a quantity over the height of its storey, too."""
    return quantity.name in OVER_HEIGHT and quantity.instant is None


def _parse_quantity(match: re.Match[str], scope: Scope) -> TableQuantity:
    """Return the quantity of a phrase such as `mean mu in soft storey 2`.  Raises InputError."""
    name = match["name"]
    buildings = scope.buildings
    if name == "in":
        raise InputError(
            "places stand behind one `in`, before brackets", f"write e.g. `time in {buildings[0]} [1.1 s]`"
        )
    if name == "line":
        raise InputError("a frame line stands before its building", f"write e.g. `mu in line 1 of {buildings[0]}`")
    if name in LINE:
        of_storey = name.removeprefix("line_")
        raise InputError(f"{name} belongs to a frame line", f"write `{of_storey} in line 1 of {buildings[0]}`")
    point, instant = _parse_where(match["where"], scope)
    known = QUANTITIES if instant is None else HISTORY
    if name not in known:
        if name in HISTORY and scope.cases:
            hint = f"write e.g. `{name} [1.1 s]` or `{name} [contact 1]`"
            raise InputError(f"{name} is a number of an instant", hint)
        kind = "quantity" if instant is None else "quantity over time"
        raise InputError(f"no {kind} '{name}' is known", nearest(name, (*known, *_FUNCTIONS)))
    place = parse_places(match, name, scope)
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
        raise InputError(
            f"'{match['over']} {match['how']}' is of the buildings, then of their storeys", "write one of the two"
        )
    return quantity


def _check_owner(name: str, instant: Instant | None, place: Places, reduction: str) -> None:
    """Raise InputError where a phrase names a place that its quantity does not have, or reduces one number.

    reduction : as written; "" of none
    """
    if instant is not None:
        has_building = any(each in _HISTORY_OF_BUILDINGS for each in (name, instant.quantity))
        has_level = any(each in _HISTORY_OF_LEVELS for each in (name, instant.quantity))
        owner = "links" if name in _HISTORY_OF_LINKS else "a time history"
        if place.line is not None:
            raise InputError("histories of frame lines have no numbers of an instant", "leave the line out")
        if place.role:
            raise InputError(f"'{place.role}' has no numbers of an instant", "write the name of the building")
        if reduction:
            hint = f"leave '{reduction}' out, and name the building and its storey or floor"
            raise InputError(f"'{reduction}' is not of a number at an instant", hint)
    else:
        dims = variables.VARIABLES[f"record_{name}" if name in OF_MOTIONS else name].dims
        has_building = "building" in dims
        has_level = "storey" in dims or "floor" in dims
        owner = "a motion" if name in OF_MOTIONS else "a time history"
        if reduction and not has_building and "link" not in dims:
            hint = f"write `{name}`; `over_motions:` tells what is taken over the motions"
            raise InputError(f"{name} is one number of {owner}, without a {reduction} one", hint)
    if not has_building and (place.building is not None or place.role or place.level):
        raise InputError(f"{name} belongs to {owner}, not to a building", f"leave the {_say_place(place)} out")
    if place.level and not has_level:
        raise InputError(f"{name} belongs to a building, not to a storey or floor", f"leave '{place.level}' out")


def _say_place(place: Places) -> str:
    """Return the kind of the place of a building that a phrase names."""
    return "building" if place.building is not None or place.role else place.level.split()[0]


@dataclass
class Places:
    """The places of a phrase, as it names them."""

    building: int | None = None
    case: int | None = None
    analysis: int | None = None
    motion: int | None = None
    law: str = ""
    role: str = ""
    level: str = ""
    line: str | None = None


def parse_places(match: re.Match[str], name: str, scope: Scope) -> Places:
    """Return the places behind `in` of a phrase.  Raises InputError."""
    places = Places()
    if match["in"] is None:
        return places
    buildings = scope.buildings
    written = [each[1] for each in re.finditer(rf"\s+({scope.place_pattern})", match["places"])]
    unknown = re.split(r"[-+*/(),<>=\[]", match.string[match.end("places") :])[0].strip()[:40]
    is_link = name in (*LINK, *LINK_FACTS) and not (name == SHEAR_DEMAND and scope.of_limits)
    of_line = bool(written) and written[-1].startswith("line ")  # no building stands behind it
    if not written or of_line:
        if is_link and not scope.cases:
            raise InputError(f"{name} belongs to links, not to a building", f"write `{name}`: of all links")
        asked = re.match(r"line\s+([0-9]+)", unknown or " ".join(written[-1:]))
        if asked is not None:
            hint = f"write `{name} in line {asked[1]} of {buildings[0]}`"
            raise InputError(f"line {asked[1]} of which building?", hint)
        if several := _list_places_of_type(unknown, buildings):
            repeated = several[0].rpartition("-")[0]
            hint = f"write {' or '.join(f'`{name} in {each}`' for each in several)}"
            raise InputError(f"'{repeated}' stands at {len(several)} places of the group", hint)
        every = {kind: names for kind, names in scope.names.items() if names and kind != _LAW}
        kinds = ", ".join(every).replace(", motion", " or motion")
        raise InputError(
            f"no {kinds} '{unknown}' in the {'group' if len(every) == 1 else 'study'}",
            nearest(unknown, [each for names in every.values() for each in names]),
        )
    for each in written:
        _take_place(places, each, scope)
    if places.law and name in _HISTORY_OF_LINKS:
        raise InputError(f"{name} is of all links of a case, not of one law", "leave the links out")
    if places.law and not is_link:
        raise InputError(f"{name} belongs to no link", "leave the links out")
    if is_link and (places.building is not None or places.role or places.level):
        raise InputError(f"{name} belongs to links, not to a building", f"write `{name}`: of all links")
    if places.line is not None and places.building is None:
        raise InputError(
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


def _take_place(places: Places, written: str, scope: Scope) -> None:
    """Add one place of a phrase to those before it.  Raises InputError."""
    first, _, rest = written.partition(" ")
    if first == "line" and rest:
        places.line = rest.split()[0]
    elif first in ("storey", "floor") and rest.isdigit():
        if places.level:
            raise InputError(f"'{written}' is a second {first}", f"write one {first}")
        places.level = written
    elif written in (STIFFEST, SOFTER):
        if places.role or places.building is not None:
            raise InputError(f"'{written}' is a second building", "write one building")
        places.role = written
    elif (law := written.removesuffix(" links")) != written:
        if places.law:
            raise InputError(f"'{written}' is a second law of links", "write one law")
        places.law = law
    else:
        kinds = [kind for kind in _KINDS if kind != _LAW and written in scope.names[kind]]
        if not kinds and first in _KINDS:
            kinds, written = [first], rest
        if len(kinds) > 1:
            said = " and ".join(f"a {kind}" for kind in kinds)
            raise InputError(f"'{written}' is {said}", f"write `{kinds[0]} {written}` or `{kinds[1]} {written}`")
        kind = kinds[0]
        if written not in scope.names[kind]:
            raise InputError(f"no {kind} '{written}' in the study", nearest(written, scope.names[kind]))
        if getattr(places, kind) is not None or (kind == "building" and places.role):
            raise InputError(f"'{written}' is a second {kind}", f"write one {kind}")
        place = scope.names[kind].index(written)
        setattr(places, kind, ABSENT if kind == "motion" and place >= len(scope.motions) else place)


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
    """Return the point of the sweep and the instant in the brackets of a phrase.  Raises InputError."""
    written: dict[str, str] = {}
    instant = None
    for part in [] if text is None else text.split(","):
        key, sign, value = (each.strip() for each in part.partition("="))
        if sign:
            written[key] = value
        elif instant is None:
            instant = _parse_instant(key)
        else:
            raise InputError(f"[{text}] has two instants", "write one")
    return tuple({**dict(scope.point), **dict(find_point(written, scope.axes))}.items()), instant


def find_point(written: Mapping[str, str], axes: Sequence[Axis]) -> tuple[tuple[int, int], ...]:
    """Return the numbers of the axes of some swept keys, with the place of their values on each.

    written : values as people write them, by key

    Raises
    ------
    InputError : a key is not swept, or does not take the value, or takes it more than once
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
            raise InputError(message, f"it has: {'; '.join(points)[:300]}")
        point.append((number, at[0]))
    known = [name for axis in axes for name in axis.names]
    for key in written:
        if key not in known:
            raise InputError(f"'{key}' is not swept", nearest(key, known))
    return tuple(point)


def _parse_instant(text: str) -> Instant:
    """Return an instant as people write it.  Raises InputError."""
    match = _INSTANT.match(text)
    if match is None or not text or (match["side"] and not (match["kind"] or match["most"])):
        raise InputError(f"[{text}] is not an instant", _INSTANT_HINT)
    delay = 0.0
    if match["time"]:
        try:
            delay = float(INSTANT_TIME.read(match["time"]))
        except PydanticCustomError:
            raise InputError(f"[{text}]: '{match['time']}' is not a time", _INSTANT_HINT) from None
        delay = -delay if match["side"] == "before" else delay
    if match["most"]:
        if match["quantity"] not in HISTORY or match["quantity"] == "time":
            message = f"[{text}]: no quantity '{match['quantity']}' over time"
            raise InputError(message, nearest(match["quantity"], HISTORY))
        end = _parse_instant(match["end"]) if match["end"] else None
        return Instant(match["most"], 0, match["quantity"], delay, match["part"] or "", end)
    if match["kind"]:
        return Instant(match["kind"], int(match["number"]), "", delay)
    return Instant("time", 0, "", delay)


def _check_line(number: str | None, name: str, of_lines: Sequence[str]) -> int:
    """Return the number of the frame line of a quantity or limit, from 1; 0 where it names none.  Raises
    InputError: lines do not have the quantity, or there is no line 0.

    of_lines : quantities that lines have
    """
    if number is None:
        return 0
    if name not in of_lines:
        hint = f"write one of {', '.join(of_lines)}, or leave the line out"
        raise InputError(f"frame lines have no {name}", hint)
    if int(number) < 1:
        raise InputError("there is no line 0", "the first is `line 1`, as the plan lists them")
    return int(number)


def _check_level(written: str, is_of_floors: bool, owner: str) -> int:
    """Return the number of a storey or floor.  Raises InputError: it is the other of the two, or 0.

    written : e.g. `storey 2`
    owner : quantity of the storey or floor, in words
    """
    word, number = written.split()
    kind = "floor" if is_of_floors else "storey"
    if word != kind:
        raise InputError(f"{owner} belongs to a {kind}", f"write `{kind} {number}`")
    if int(number) < 1:
        raise InputError(f"there is no {kind} 0", f"the lowest is `{kind} 1`")
    return int(number)


_MIXED = "?"
"""Unit of numbers whose parts have different ones."""


def _compile_node(node: ast.expr, quantities: Sequence[TableQuantity]) -> tuple[str | None, Work]:
    """Return the unit of a part of an expression, None of a plain number, and the function that computes it.  Raises
    InputError."""
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
                raise InputError(f"{name} takes {'two values or more' if name in _SEVERAL else 'one value'}")
            return _compile_operation(_FUNCTIONS[name], inner, quantities, name)
    raise InputError("only numbers of the tables, + - * /, brackets, max, min, abs, sqrt, log and exp are understood")


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

"""Results that are hardly plausible, each with its likely cause: ductilities, drifts, accelerations, penetrations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.errors import Issue
from pounding_cli.model.scene import Analysis
from pounding_cli.numbers import Unit, count_histories
from pounding_cli.units import GRAVITY
from pounding_cli.variables import ALONE_VARIABLES, MIN_TWIST

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

MAX_DUCTILITY = 10.0
"""Ductility that few buildings reach before they fail [-]."""

MAX_DRIFT_RATIO = 0.05
"""Interstorey drift beyond which most storeys have lost their strength [-]."""

MAX_ACCELERATION = 5.0 * GRAVITY
"""Total floor acceleration beyond which it is that of a blow [m/s2]."""

_COLLAPSE = "collapse"
"""Effect of scenes in which a storey that drifts too far ends the run."""

_ACCELERATION = Unit("g", GRAVITY, "m/s2")
_PERCENT = Unit("%", 0.01)
_LENGTH = Unit("cm", 0.01, "m")

_PLACES = {"building": "{}", "storey": "storey {}", "line": "line {}", "floor": "floor {}", "link": "{}",
           "record": "{}", "case": "{}", "analysis": "{}"}  # fmt: skip


@dataclass(frozen=True)
class Place:
    """Place of a value: the index on every dimension of its variable, and the value in words."""

    index: Mapping[str, int]
    text: str


def implausible_results(results: ResultTables, hidden: Sequence[str] = ()) -> list[Issue]:
    """Return a note for every kind of result that is hardly plausible: the largest, where it stands, and why.

    hidden : swept keys whose values are left out, of samples
    """
    checks = {
        "ductility": _describe_ductility,
        "drift": _describe_drift,
        "acceleration": _describe_acceleration,
        "penetration": _describe_penetration,
    }
    return [
        Issue((), sentence, code=code) for code, describe in checks.items() for sentence in describe(results, hidden)
    ]


def _describe_ductility(results: ResultTables, hidden: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the largest ductility demand of inelastic analyses, if it is above `MAX_DUCTILITY`."""
    is_inelastic = [name == Analysis.INELASTIC for name in results.names("analysis")]
    values = _keep_along(_without_walls(results, "mu"), results.arrays["mu"].dims, "analysis", is_inelastic)
    place = _find_largest(results, "mu", values, MAX_DUCTILITY, Unit(), hidden)
    if place is None:
        return
    cause = "check its yield level, and unit and scale of the motions"
    building = _building_of_study(results, results.names("building")[place.index["building"]])
    code = building.get("yield") or {}
    if building.get("yield_shear") is None and str(code.get("code", "")).startswith("UBC"):
        cause = f"yield levels of the working stress of the {code['code']} give such ductilities"
        if code.get("overstrength") == 1.0:
            cause += "; real buildings are stronger, see `yield: {overstrength: ...}`"
    yield (
        f"Hardly plausible: a ductility of {place.text}. It is far beyond the range of the storey law, as few "
        f"buildings reach {MAX_DUCTILITY:g}: {cause}."
    )


def _describe_drift(results: ResultTables, hidden: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the largest interstorey drift, if it is above `MAX_DRIFT_RATIO`: that of an edge of the plan
    where floors twist."""
    name = "edge_drift_ratio" if "edge_drift_ratio" in results.arrays else "drift_ratio"
    values = _without_walls(results, name)
    place = _find_largest(results, name, values, MAX_DRIFT_RATIO, _PERCENT, hidden)
    if place is None:
        return
    building = _building_of_study(results, results.names("building")[place.index["building"]])
    cause = "check unit and scale of the motions, masses and stiffnesses"
    is_inelastic = results.names("analysis")[place.index["analysis"]] == Analysis.INELASTIC
    missing = [] if building.get("p_delta") else ["`p_delta: true`"]
    if building.get("collapse") is None and not _simulates(results, _COLLAPSE, place.index):
        missing.append("`collapse:`")
    if is_inelastic and missing:
        cause = f"what then decides is left out: write {' and '.join(missing)}; or {cause}"
    limit = _PERCENT.text(MAX_DRIFT_RATIO)
    drift = f"an interstorey drift{' at an edge of the plan' if _does_twist(results, place.index) else ''}"
    yield f"Hardly plausible: {drift} of {place.text}. Most storeys lose their strength below {limit}: {cause}."


def _describe_acceleration(results: ResultTables, hidden: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the largest floor acceleration, if it is above `MAX_ACCELERATION`."""
    values = _without_walls(results, "acceleration")
    place = _find_largest(results, "acceleration", values, MAX_ACCELERATION, _ACCELERATION, hidden)
    if place is None:
        return
    limit = _ACCELERATION.text(MAX_ACCELERATION)
    if _value_at(results, ALONE_VARIABLES["acceleration"], place.index) > MAX_ACCELERATION:
        cause = "the building alone has as much: check unit and scale of the motions"
    else:
        cause = "it grows with the root of the contact stiffness, which is unknown, and lasts for milliseconds"
    yield f"Hardly plausible: a floor acceleration of {place.text}. Beyond {limit} it is that of a blow: {cause}."


def _describe_penetration(results: ResultTables, hidden: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the largest penetration of floors that strike, if it is beyond the thinner slab."""
    arrays = results.arrays
    if "link" not in arrays or "slab" not in arrays:
        return
    dims = arrays["max_closing"].dims
    kinds = arrays["kind"]
    is_contact = np.vectorize(results.is_contact, otypes=[bool])(kinds.values)
    thinner = _spread_to(_find_thinner_slabs(results), (*arrays["slab"].dims[:-1], "link"), dims)
    gaps = _spread_to(arrays["gap"].values, arrays["gap"].dims, dims)
    contacts = _spread_to(is_contact, kinds.dims, dims)
    penetration = np.where(contacts, arrays["max_closing"].values - gaps, np.nan)
    with np.errstate(invalid="ignore"):
        too_far = np.where(penetration > thinner, penetration, np.nan)
    if not np.isfinite(too_far).any():
        return
    index = _index_of_largest(too_far, dims)
    text = f"{_LENGTH.text(float(np.nanmax(too_far)), 3)} ({_format_place(results, index, hidden)})"
    least = np.broadcast_to(thinner, too_far.shape)[tuple(index.values())]
    yield (
        f"Hardly plausible: floors that pass through each other by {text}, more than a slab of "
        f"{_LENGTH.text(float(least), 3)} is thick: the contact is too soft. "
        "Write `impact: {stiffness: 20 x stiffest storey}`."
    )


def _find_thinner_slabs(results: ResultTables) -> np.ndarray:
    """Return the thinner slab at the ends of every link [m], over the swept axes of slabs and the links; NaN where the
    study writes none. A wall has no slab: the building at the other end decides."""
    slab = results.values("slab")
    slab = np.where(slab > 0, slab, np.nan)
    names = results.names("building")
    ends = []
    for end in ("link_left", "link_right"):
        places = [names.index(str(name)) for name in results.values(end)]
        is_wall = np.array([names[place] in results.walls for place in places], bool)
        ends.append(np.where(is_wall, np.nan, slab[..., places]))
    return np.fmin(*ends)


# Arrays


def _without_walls(results: ResultTables, name: str) -> np.ndarray:
    """Return the values of a variable, NaN for walls."""
    is_frame = [building not in results.walls for building in results.names("building")]
    return _keep_along(results.values(name), results.arrays[name].dims, "building", is_frame)


def _keep_along(values: np.ndarray, dims: Sequence[str], dim: str, is_kept: Sequence[bool]) -> np.ndarray:
    """Return values with NaN at the places of one dimension that are not kept."""
    return np.where(_spread_to(np.array(is_kept), (dim,), dims), values, np.nan)


def _spread_to(values: np.ndarray, dims: Sequence[str], to: Sequence[str]) -> np.ndarray:
    """Return an array over some dimensions with those of another one, of length 1 where it lacks them."""
    order = sorted(range(len(dims)), key=lambda place: to.index(dims[place]))
    sizes = dict(zip(dims, values.shape, strict=True))
    return values.transpose(order).reshape([sizes.get(dim, 1) for dim in to])


def _find_largest(
    results: ResultTables, name: str, values: np.ndarray, limit: float, unit: Unit, hidden: Sequence[str]
) -> Place | None:
    """Return the place of the largest value of a variable; None where none is above a limit.

    values : of the variable, NaN where it does not count
    """
    is_above = np.nan_to_num(values, nan=-np.inf) > limit
    if not is_above.any():
        return None
    index = _index_of_largest(values, results.arrays[name].dims)
    line = _find_line(results, index) if name == "mu" else None
    if line is not None:
        name = "line_mu"
        index["line"] = line
    words = [_format_place(results, index, hidden)]
    alone = _value_of_alone(results, name, index)
    if np.isfinite(alone):
        words.append(f"{unit.text(alone, 3)} alone")
    count = int(is_above.any(axis=(-2, -1)).sum())
    words.append(f"above {unit.text(limit)} in {count_histories(count)}")
    return Place(index, f"{unit.text(float(np.nanmax(values)), 3)} ({'; '.join(filter(None, words))})")


def _value_of_alone(results: ResultTables, name: str, index: Mapping[str, int]) -> float:
    """Return a variable of the building alone at one place; NaN where it is not known."""
    if not name.endswith("drift_ratio"):
        return _value_at(results, ALONE_VARIABLES[name], index)
    length = name.removesuffix("_ratio")
    drift = _value_at(results, length, index)
    return _value_at(results, f"{length}0", index) * _value_at(results, name, index) / drift


def _does_twist(results: ResultTables, index: Mapping[str, int]) -> bool:
    """Return whether the floor above a storey turns."""
    if "twist" not in results.arrays:
        return False
    return _value_at(results, "twist", {**index, "floor": index["storey"]}) > MIN_TWIST


def _find_line(results: ResultTables, index: Mapping[str, int]) -> int | None:
    """Return the frame line along the row with the largest ductility demand of a storey; None of one whose floors do
    not twist."""
    if not _does_twist(results, index):
        return None
    along = results.arrays["line_street"]
    is_along = np.isfinite(along.values[tuple(index[dim] for dim in along.dims[:-1])])
    demands = results.arrays["line_mu"]
    of_lines = np.where(is_along, demands.values[tuple(index[dim] for dim in demands.dims[:-1])], np.nan)
    return int(np.nanargmax(of_lines)) if np.isfinite(of_lines).any() else None


def _value_at(results: ResultTables, name: str, index: Mapping[str, int]) -> float:
    array = results.arrays[name]
    return float(array.values[tuple(index[dim] for dim in array.dims)])


def _simulates(results: ResultTables, effect: str, index: Mapping[str, int]) -> bool:
    """Return whether an effect is simulated in the scene at a place."""
    array = results.arrays["effects"]
    return effect in str(array.values[tuple(index[dim] for dim in array.dims)]).splitlines()


def _index_of_largest(values: np.ndarray, dims: Sequence[str]) -> dict[str, int]:
    """Return the index of the largest value on every dimension."""
    index = np.unravel_index(int(np.nanargmax(values)), values.shape)
    return {dim: int(number) for dim, number in zip(dims, index, strict=True)}


def _format_place(results: ResultTables, index: Mapping[str, int], hidden: Sequence[str]) -> str:
    """Return a place in words: "stiff, storey 1, elcentro, touching, elastic, cases.gap.gap = 5 cm".

    index : of the place on the dimensions of a variable
    """
    words = []
    for dim, form in _PLACES.items():
        names = results.names(dim) if dim in index else []
        is_obvious = dim in ("record", "case", "analysis") and len(names) == 1
        if names and not is_obvious:
            words.append(form.format(names[index[dim]]))
    for keys in results.swept:
        if keys[0] in index:
            visible = [key for key in keys if key not in hidden]
            words += [f"{key} = {results.value_label(key, results.axes[key][index[keys[0]]])}" for key in visible]
    return ", ".join(words)


def _building_of_study(results: ResultTables, place: str) -> dict[str, Any]:
    """Return what the study says of the building at a place of the group."""
    number = results.study_data["places"].index(place)
    return dict(results.study_data["buildings"][results.study_data["group"][number]])

"""Results that are hardly plausible, each with its likely cause: ductilities, drifts, accelerations, penetrations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.laws import link_symbol
from pounding_cli.model.scene import Analysis
from pounding_cli.numbers import Unit, count_histories
from pounding_cli.units import GRAVITY
from pounding_cli.variables import ALONE_VARIABLES

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.results.results import ResultTables

MAX_DUCTILITY = 10.0
"""Ductility that few buildings reach before they fail [-]."""

MAX_DRIFT_RATIO = 0.05
"""Interstorey drift beyond which most storeys have lost their strength [-]."""

MAX_ACCELERATION = 5.0 * GRAVITY
"""Total floor acceleration beyond which it is that of a blow [m/s2]."""

_ACCELERATION = Unit("g", GRAVITY, "m/s2")
_PERCENT = Unit("%", 0.01)
_LENGTH = Unit("cm", 0.01, "m")

_PLACES = {"building": "{}", "storey": "storey {}", "floor": "floor {}", "link": "{}", "record": "{}", "case": "{}",
           "analysis": "{}"}  # fmt: skip


def implausible_results(results: ResultTables, hidden: Sequence[str] = ()) -> list[str]:
    """Return a sentence for every kind of result that is hardly plausible: the largest, where it stands, and why.

    hidden : swept keys whose values are not told, of samples
    """
    data = results.data
    if results.walls:
        data = data.drop_sel(building=list(results.walls))
    describe_all = (_describe_ductility, _describe_drift, _describe_acceleration, _describe_penetration)
    return [sentence for describe in describe_all for sentence in describe(results, data, hidden)]


def _describe_ductility(results: ResultTables, data: xr.Dataset, hidden: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the largest ductility demand of inelastic analyses, if it is above `MAX_DUCTILITY`."""
    inelastic = data.sel(analysis=[each for each in data["analysis"].values if each == Analysis.INELASTIC])
    found = _largest(results, inelastic, "mu", MAX_DUCTILITY, Unit(), hidden)
    if found is None:
        return
    text, place, _ = found
    cause = "check its yield level, and unit and scale of the motions"
    building = _building_of_study(results, place["building"])
    code = building.get("yield") or {}
    if building.get("yield_shear") is None and str(code.get("code", "")).startswith("UBC"):
        cause = f"yield levels of the working stress of the {code['code']} give such ductilities"
        if code.get("overstrength") == 1.0:
            cause += "; real buildings are stronger, see `yield: {overstrength: ...}`"
    yield f"Hardly plausible: a ductility of {text}. Few buildings reach {MAX_DUCTILITY:g}: {cause}."


def _describe_drift(results: ResultTables, data: xr.Dataset, hidden: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the largest interstorey drift, if it is above `MAX_DRIFT_RATIO`."""
    found = _largest(results, data, "drift_ratio", MAX_DRIFT_RATIO, _PERCENT, hidden)
    if found is None:
        return
    text, place, _ = found
    building = _building_of_study(results, place["building"])
    cause = "check unit and scale of the motions, masses and stiffnesses"
    if place["analysis"] == Analysis.INELASTIC and not (building.get("p_delta") and building.get("collapse")):
        cause = "what then decides is left out: write `p_delta: true` and `collapse:`; or " + cause
    limit = _PERCENT.text(MAX_DRIFT_RATIO)
    yield f"Hardly plausible: an interstorey drift of {text}. Most storeys lose their strength below {limit}: {cause}."


def _describe_acceleration(results: ResultTables, data: xr.Dataset, hidden: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the largest floor acceleration, if it is above `MAX_ACCELERATION`."""
    found = _largest(results, data, "acceleration", MAX_ACCELERATION, _ACCELERATION, hidden)
    if found is None:
        return
    text, _, alone = found
    limit = _ACCELERATION.text(MAX_ACCELERATION)
    if alone > MAX_ACCELERATION:
        cause = "the building alone has as much: check unit and scale of the motions"
    else:
        cause = "it grows with the root of the contact stiffness, which is unknown, and lasts for milliseconds"
    yield f"Hardly plausible: a floor acceleration of {text}. Beyond {limit} it is that of a blow: {cause}."


def _describe_penetration(results: ResultTables, data: xr.Dataset, hidden: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the largest penetration of floors that strike, if it is beyond the thinner slab."""
    if "link" not in data.dims or "slab" not in data:
        return
    slab = data["slab"].where(data["slab"] > 0)  # 0: the study writes none
    left, right = (
        slab.sel(building=_known(data, name)).drop_vars("building").rename(building="link")
        for name in ("link_left", "link_right")
    )
    thinner: Any = np.fmin(left, right)
    is_contact = data["kind"].copy(
        data=np.vectorize(lambda kind: link_symbol(kind) == "gap", otypes=[bool])(data["kind"])
    )
    beyond = (data["max_closing"] - data["gap"]).where(is_contact)
    too_far = beyond.where(beyond > thinner)
    if not bool(too_far.notnull().any()):
        return
    at = _index_of_largest(too_far)
    text = f"{_LENGTH.text(float(too_far.max()), 3)} ({_where(results, data.isel(at), at, hidden)})"
    limits = thinner.broadcast_like(too_far).transpose(*too_far.dims).values
    least = _LENGTH.text(limits.flat[int(np.nanargmax(too_far.values))], 3)
    yield (
        f"Hardly plausible: floors that pass through each other by {text}, more than a slab of {least} is thick: "
        "the contact is too soft. Write `impact: {stiffness: 20 x stiffest storey}`."
    )


def _known(data: xr.Dataset, name: str) -> Any:
    """Return the buildings at one end of the links; of a wall, which has no slab, the building at the other."""
    other = {"link_left": "link_right", "link_right": "link_left"}[name]
    known = set(data["building"].values)
    ends = zip(data[name].values, data[other].values, strict=True)
    return [end if end in known else beside for end, beside in ends]


def _largest(
    results: ResultTables, data: xr.Dataset, name: str, limit: float, unit: Unit, hidden: Sequence[str]
) -> tuple[str, dict[str, Any], float] | None:
    """Return the largest value of a variable in words, its building and analysis, and the value of the building alone;
    None where none is above a limit.

    data : without walls
    """
    values = data[name].load()
    if not values.size or not (values > limit).any():
        return None
    at = _index_of_largest(values)
    here = data.isel(at)
    words = [_where(results, here, at, hidden)]
    alone = _of_alone(here, name)
    if np.isfinite(alone):
        words.append(f"{unit.text(alone, 3)} alone")
    count = int((values > limit).any(values.dims[-2:]).sum())
    words.append(f"above {unit.text(limit)} in {count_histories(count)}")
    text = f"{unit.text(float(values.max()), 3)} ({'; '.join(filter(None, words))})"
    return text, {dim: here[dim].item() for dim in ("building", "analysis")}, alone


def _of_alone(data: xr.Dataset, name: str) -> float:
    """Return a variable of the building alone at one place; NaN where it is not known."""
    if name == "drift_ratio":
        return float(data["drift0"] * data["drift_ratio"] / data["drift"])
    return float(data[ALONE_VARIABLES[name]])


def _index_of_largest(values: xr.DataArray) -> dict[Any, int]:
    """Return the index of the largest value on every dimension."""
    at = np.unravel_index(int(np.nanargmax(values.values)), values.shape)
    return {dim: int(index) for dim, index in zip(values.dims, at, strict=True)}


def _where(results: ResultTables, here: xr.Dataset, at: dict[Any, int], hidden: Sequence[str]) -> str:
    """Return a place in words: "stiff, storey 1, elcentro, touching, elastic, cases.gap.gap = 5 cm".

    here : the variables at the place; at : its index on the dimensions that say where it is
    """
    single = {dim for dim in ("record", "case", "analysis") if len(results.data[dim]) == 1}
    words = [form.format(here[dim].item()) for dim, form in _PLACES.items() if dim in at and dim not in single]
    for keys in results.swept:
        if keys[0] in at:
            named = [key for key in keys if key not in hidden]
            words += [f"{key} = {results.value_label(key, results.axes[key][at[keys[0]]])}" for key in named]
    return ", ".join(words)


def _building_of_study(results: ResultTables, place: str) -> dict[str, Any]:
    """Return what the study says of the building at a place of the group."""
    number = results.resolved["places"].index(place)
    return dict(results.resolved["buildings"][results.resolved["group"][number]])

"""A plan and its responses as arrays: all of a results file but its histories and the tables of answers."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli import __version__, variables
from pounding_cli.laws import link_symbol
from pounding_cli.laws.apart import Apart
from pounding_cli.laws.formula import WRITTEN_LAWS
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.building import Building
from pounding_cli.model.links import link_label
from pounding_cli.model.scene import Analysis
from pounding_cli.model.wall import Wall
from pounding_cli.numbers import pluralize
from pounding_cli.results.arrays import Array, ResultArrays
from pounding_cli.results.file import FORMAT, FORMAT_VERSION, unit_attributes
from pounding_cli.results.responses import (
    TEXTS,
    Responses,
    iter_section_points,
    max_lines,
    max_storeys,
    solution_key,
    solver_version,
)
from pounding_cli.solver.response import DONE, Flag
from pounding_cli.variables import LINE_RATIO_VARIABLES, RATIO_VARIABLES, STOREY_DIMS, VARIABLES, Variable

if TYPE_CHECKING:
    from pounding_cli.study.run_plan import Plan

_SOFTWARE = ("numpy", "scipy", "numba", "h5py", "xarray")

Arrays = dict[str, np.ndarray]
"""Variables over the swept axes and their own dimensions."""


def build_arrays(plan: Plan, solved: Responses) -> ResultArrays:
    """Return the results of a plan, over the swept axes, case, analysis, record, building, storey, floor and link.

    Rows whose scene nobody asked for have no numbers, and no status.
    """
    axes = tuple(axis.names[0] for axis in plan.axes)
    declared = [
        v
        for v in (*variables.RESPONSE_VARIABLES, *variables.SCENE_VARIABLES, *variables.LINK_VARIABLES)
        if _has_values(plan, v)
    ]
    facts = _facts(plan, axes)
    arrays = {v.name: getattr(plan.links, v.name) for v in declared if v in variables.LINK_VARIABLES}
    arrays |= _responses(plan, solved, declared)
    if max_lines(plan):
        _fill_untwisted(arrays, axes, facts)
    with np.errstate(all="ignore"):
        height = _spread_fact(facts["height"], axes, STOREY_DIMS)
        for v in declared:
            if v.ratio:
                value, base = (arrays[name] for name in v.ratio)
                arrays[v.name] = value / np.where(base > 0, base, np.nan)
            elif v.formula is not None:
                arrays[v.name] = v.formula({**arrays, "height": height})
        _add_statistics(arrays, solved.values["error_estimate"][plan.numbers[..., 1:]])
    _flag(plan, solved, arrays)
    found = facts | {name: Array((*axes, *VARIABLES[name].dims), array) for name, array in arrays.items()}
    for name, each in found.items():
        attrs: dict[str, Any] = {"units": VARIABLES[name].unit} if VARIABLES[name].unit else {}
        attrs["long_name"] = VARIABLES[name].text
        if name in variables.DISPLAY_QUANTITIES:
            attrs |= unit_attributes(plan.study.unit(variables.DISPLAY_QUANTITIES[name]))
        found[name] = Array(each.dims, each.values, attrs)
    beside = {v.name: found.pop(v.name) for v in variables.RECORD_VARIABLES}
    return ResultArrays(found | _study(plan), _coordinates(plan) | beside, _attributes(plan, solved))


def _has_values(plan: Plan, v: Variable) -> bool:
    """Return whether a variable has values in a study: some have no links, few have links that strike columns."""
    if v.name in variables.COLUMN_VARIABLES:
        return any(place.is_on_columns for place in plan.links.places)
    if v.name in variables.INCLINED_VARIABLES:
        return bool((plan.links.facing == 0.0).any())
    if v.name in (*variables.PLACED_VARIABLES, *variables.PLAN_VARIABLES) or v in variables.TWIST_VARIABLES:
        return max_lines(plan) > 0
    return "link" not in v.dims or bool(plan.links.places)


def _responses(plan: Plan, solved: Responses, declared: list[Variable]) -> Arrays:
    """Return the variables that responses have themselves."""
    scene = plan.numbers[..., 0]
    alone = plan.numbers[..., 1:]
    digests = np.array([digest.tobytes().hex() for digest in plan.digests] + [""], object)
    fallen_storey = np.nan_to_num(solved.values["building.collapse_storey"]).astype(np.int64)
    arrays = Arrays()
    for v in declared:
        if v.of:
            whole = solved.values[v.of].copy()
            whole[~_is_of_whole_motion(plan, solved, v)] = np.nan
            arrays[v.name] = whole[alone, 0] if v.alone else whole[scene]
        elif v.name in ("collapsed", "collapsed0"):
            arrays[v.name] = fallen_storey[alone, 0] if v.alone else fallen_storey[scene]
        elif v.name == "collapse_time":
            arrays[v.name] = np.fmin.reduce(solved.values["building.collapse_time"][scene], axis=-1)
        elif v.name in TEXTS:
            arrays[v.name] = solved.texts[v.name][scene]
        elif v.name == "scene":
            arrays[v.name] = np.where(solved.is_known[scene], digests[scene], "")
        elif v.name in solved.values:
            array = solved.values[v.name][scene]
            arrays[v.name] = np.nan_to_num(array).astype(np.int64) if v.kind == "i" else array
    return arrays


def _is_of_whole_motion(plan: Plan, solved: Responses, v: Variable) -> np.ndarray:
    """Return where the peaks of a variable are of whole motions, shape (scenes + 1, buildings or links).

    A collapse ends the motion of the buildings that links join to it. One of a building alone stands at place 0.
    """
    if "link" not in v.dims:
        return solved.is_whole
    left = np.array([place.left for place in plan.links.places])
    return solved.is_whole[:, left] & solved.is_whole[:, left + 1]


def _add_statistics(arrays: Arrays, errors_alone: np.ndarray) -> None:
    """Enter the statistics of all ratios over the motions.

    errors_alone : of the buildings alone [-], shape (swept axes, SCENE_DIMS, buildings)
    """
    # a ratio is at most as wrong as both of its peaks together, and a mean as the mean of these
    errors = errors_alone + arrays["error_estimate"][..., None]
    for name in (*RATIO_VARIABLES, *LINE_RATIO_VARIABLES):
        if name not in arrays:
            continue
        sizes = arrays[name].shape[arrays["status"].ndim + 1 :]  # and lines, which stand side by side
        ratios = arrays[name].reshape(*arrays[name].shape[: -len(sizes)], -1)
        measures = _statistics(ratios, errors[..., None], arrays["sensitivity"][..., None, None])
        for measure, array in measures.items():
            arrays[f"{name}_{measure}"] = array.reshape(*array.shape[:-1], *sizes)


def _statistics(ratio: np.ndarray, errors: np.ndarray, sensitivities: np.ndarray) -> Arrays:
    """Return the measures of `variables.STATISTIC_VARIABLES` of a ratio over the motions, its third last dimension.

    Standard deviations are with n - 1 (NaN of one motion); error and sensitivity of the mean are over the motions that
    were assessed, NaN where none was.

    errors, sensitivities : of the ratios, relative [-]
    """

    def total(array: np.ndarray) -> np.ndarray:
        return np.nansum(array, axis=-3)

    count = (~np.isnan(ratio)).sum(axis=-3)
    size = abs(ratio)
    mean = total(ratio) / count
    error = size * errors
    change = size * sensitivities
    return {
        "mean": mean,
        "std": np.sqrt(total((ratio - mean[..., None, :, :]) ** 2) / np.where(count > 1, count - 1, np.nan)),
        "min": np.fmin.reduce(ratio, axis=-3),
        "max": np.fmax.reduce(ratio, axis=-3),
        "count": count,
        "mean_error": total(error) / (~np.isnan(error)).sum(axis=-3),
        "mean_sensitivity": total(change) / total(np.where(np.isnan(change), np.nan, size)),
    }


def _spread_fact(fact: Array, axes: tuple[str, ...], dims: tuple[str, ...]) -> np.ndarray:
    """Return a variable of buildings over the swept axes and some dimensions, of length 1 where it does not change."""
    missing = [place for place, dim in enumerate((*axes, *dims)) if dim not in fact.dims]
    return np.expand_dims(fact.values, missing)


def _fill_untwisted(arrays: Arrays, axes: tuple[str, ...], facts: Mapping[str, Array]) -> None:
    """Enter what lines, edges and floors come to where floors do not twist: lines along the row and edges have the
    drift of their storey, and lines their part of its shear. Buildings without a plan have edges, too, but no lines."""
    with np.errstate(invalid="ignore"):
        stiffness = _spread_fact(facts["line_stiffness"], axes, variables.LINE_DIMS)
        is_along = ~np.isnan(_spread_fact(facts["line_street"], axes, variables.LINE_DIMS))
        of_storey = _spread_fact(facts["stiffness"], axes, STOREY_DIMS)[..., None]
        share = np.where(is_along, stiffness / of_storey, 0.0)
        line = np.where(np.isnan(stiffness), np.nan, is_along)
        is_twistable = ~np.isnan(_spread_fact(facts["plan_low"], axes, variables.BUILDING_DIMS))[..., None]
        for suffix in ("", "0"):
            drift = arrays[f"drift{suffix}"]
            untwisted = {
                f"twist{suffix}": 0.0 * np.where(is_twistable, drift, np.nan),
                f"edge_drift_low{suffix}": drift,
                f"edge_drift_high{suffix}": drift,
                f"line_V{suffix}": arrays[f"V{suffix}"][..., None] * share * np.where(np.isnan(line), np.nan, 1.0),
                f"line_mu{suffix}": arrays[f"mu{suffix}"][..., None] * line,
                f"line_drift{suffix}": drift[..., None] * line,
            }
            if not suffix:
                untwisted["line_residual_drift"] = arrays["residual_drift"][..., None] * line
            for name, values in untwisted.items():
                arrays[name] = np.where(np.isnan(arrays[name]), values, arrays[name])


# Flags


def _flag(plan: Plan, solved: Responses, found: Arrays) -> None:
    """Add to the flags of scenes: buildings that gave no baseline, ratios to zero, columns beyond their strength."""
    status = solved.texts["status"]

    def add(where: Any, flag: Flag) -> None:
        is_first = found["flags"][where] == ""
        texts = {"flags": flag.code, "flag_details": flag.detail, "flag_severity": repr(flag.severity)}
        for name, text in texts.items():
            found[name][where] = np.where(is_first, text, found[name][where] + "\n" + text)

    for place, name in enumerate(plan.buildings):
        of_alone = np.where(solved.is_known[plan.numbers[..., 0]], status[plan.numbers[..., 1 + place]], "")
        for word in sorted({*of_alone.ravel().tolist()} - {DONE, ""}):
            add(of_alone == word, Flag("baseline", f"{name} alone: {word}"))
    for name in RATIO_VARIABLES:
        base = VARIABLES[name].ratio[1]
        zero = (found[base] == 0).any(axis=(-2, -1))
        if base == "mu0":  # no storey of an elastic analysis yields: nobody asks for its ductility
            zero &= np.array([each == Analysis.INELASTIC for each in plan.analyses])[:, None]
        add(zero, Flag("zero-baseline", f"{base} = 0"))
    if "shear_demand" not in found:
        return
    is_loaded = found["contact_time"] > 0  # columns that yield by themselves have 1 anyway
    is_blow = find_contacts(plan, found["kind"])[..., None, None, :]  # the same in all analyses and motions
    for words, is_meant in (("by a blow", is_blow), ("by a link", ~is_blow)):
        demand = np.where(is_loaded & is_meant, found["shear_demand"], np.nan)
        for at in np.argwhere((demand > 1).any(axis=-1)):
            detail, worst = _describe_overload(plan, demand[tuple(at)])
            add(tuple(at[:, None]), Flag("columns", f"{detail}, {words}", worst))


def find_contacts(plan: Plan, kinds: np.ndarray) -> np.ndarray:
    """Return where floors strike each other across a link, of an array of names of laws; False where there is none."""
    own_laws = plan.study.spec.laws

    def is_contact(kind: str) -> bool:
        symbol = WRITTEN_LAWS[own_laws[kind].acts].symbol if kind in own_laws else link_symbol(kind)
        return kind not in ("", Apart.name) and symbol == LinkLaw.symbol

    return np.vectorize(is_contact, otypes=[bool])(kinds)


def _describe_overload(plan: Plan, demand: np.ndarray) -> tuple[str, float]:
    """Return in words where the columns of a scene are loaded beyond their strength, and the largest demand [-].

    demand : of the columns at every link, above 1 at some; NaN where none are loaded
    """
    storeys = {plan.links.places[link].struck_storey for link in np.flatnonzero(demand > 1).tolist()}
    worst = int(np.nanargmax(demand))
    building, storey = plan.links.places[worst].struck_storey
    more = f", and {pluralize(len(storeys) - 1, 'more storey')}" if len(storeys) > 1 else ""
    where = f"{plan.buildings[building]} storey {storey}"
    return f"{where}, {demand[worst]:.3g} times their share of the yield shear{more}", float(demand[worst])


# Coordinates, buildings and motions


def _coordinates(plan: Plan) -> dict[str, Array]:
    found = {}
    for axis in plan.axes:
        for column, name in enumerate(axis.names):
            given = [value[column] for value in axis.values]
            is_numeric = all(isinstance(value, int | float) and not isinstance(value, bool) for value in given)
            array = np.array(given, float) if is_numeric else np.array(list(map(str, given)), object)
            text = f"swept with {axis.names[0]}" if column else f"swept: {name}"
            written = axis.units[column] if is_numeric else replace(axis.units[column], si="")
            found[name] = Array((axis.names[0],), array, {"long_name": text} | unit_attributes(written))
    storeys = np.arange(1, max_storeys(plan) + 1)
    places = plan.links.places
    names = plan.buildings
    values: dict[str, Any] = {
        "case": plan.cases, "analysis": plan.analyses, "record": plan.records, "building": names,
        "storey": storeys, "floor": storeys,
    }  # fmt: skip
    if lines := max_lines(plan):
        values["line"] = np.arange(1, lines + 1)
    if places:
        left, left_floor, right_floor, *_ = zip(*places, strict=True)
        values |= {
            "link": [link_label(names, place) for place in places],
            "link_left": [names[place] for place in left],
            "link_right": [names[place + 1] for place in left],
            "link_floor": np.array(left_floor),
            "link_right_floor": np.array(right_floor),
        }
    for name, each in values.items():
        unit, text = variables.COORDINATE_VARIABLES[name]
        array = each if isinstance(each, np.ndarray) else np.array(each, object)
        found[name] = Array((name.split("_")[0],), array, ({"units": unit} if unit else {}) | {"long_name": text})
    return found


def _facts(plan: Plan, axes: tuple[str, ...]) -> dict[str, Array]:
    """Return the variables of buildings and motions, over the axes that change them."""
    study = plan.study
    storeys = max_storeys(plan)
    lines = max_lines(plan)
    building_variables = tuple(v for v in variables.BUILDING_VARIABLES if _has_values(plan, v))
    separations = study.separations()

    def over(section: str, declared: tuple[Variable, ...], value: Callable[[Any], dict[str, Any]]) -> dict[str, Array]:
        """Return what `value` gives at all combinations of the values of the axes that change a section."""
        touched = study.axes_changing(section)
        sizes = [len(plan.axes[k].values) for k in touched]
        at_points = [value(at) for at in iter_section_points(plan, section)]
        found = {}
        for v in declared:
            array = np.array([values[v.name] for values in at_points], object if v.kind == "s" else float)
            found[v.name] = array.reshape(*sizes, *array.shape[1:])
        changing = list[str]()
        for axis in (axes[k] for k in touched):  # without those that change nothing after all
            place = len(changing)
            if all(_is_constant(array, place) for array in found.values()):
                found = {name: array.take(0, place) for name, array in found.items()}
            else:
                changing.append(axis)
        return {v.name: Array((*changing, *v.dims), found[v.name]) for v in declared}

    def group(point: Any) -> dict[str, Any]:
        row = study.group(point).buildings
        found: dict[str, Any] = {
            "period": [building.periods[0] for building in row],
            "base_shear_ratio": [building.base_shear_ratio for building in row],
            "slab": [building.slab for building in row],
            "separation": separations.value_at(point),
        }
        for name in ("mass", "height", "stiffness", "yield_shear"):
            found[name] = np.full((len(row), storeys), np.nan)
            for values, building in zip(found[name], row, strict=True):
                known = building.storey_property(name) if isinstance(building, Wall) else getattr(building, name)
                values[: building.storeys] = known
        return found | (_describe_plans(row, storeys, lines) if lines else {})

    def motions(point: Any) -> dict[str, Any]:
        uses = [study.motion_uses(point)[name] for name in plan.records]
        return {
            v.name: [getattr(use, v.name.removeprefix("record_")) for use in uses] for v in variables.RECORD_VARIABLES
        }

    return over("buildings", building_variables, group) | over("records", variables.RECORD_VARIABLES, motions)


def _describe_plans(row: Sequence[Building], storeys: int, lines: int) -> dict[str, np.ndarray]:
    """Return `variables.PLAN_VARIABLES` of a row of buildings, NaN where there is nothing.

    storeys, lines : most of a building
    """
    plan_names = ("plan_low", "plan_high", "plan_centre")
    found = {name: np.full(len(row), np.nan) for name in plan_names}
    found |= {name: np.full((len(row), storeys), np.nan) for name in ("inertia", "torsional_stiffness")}
    found["stiffness_centre"] = np.full((len(row), storeys), np.nan)
    found |= {name: np.full((len(row), lines), np.nan) for name in ("line_street", "line_x")}
    found |= {name: np.full((len(row), storeys, lines), np.nan) for name in ("line_stiffness", "line_yield_shear")}
    for place, building in enumerate(row):
        plan = building.plan
        if plan is None:
            continue
        found["plan_low"][place] = plan.street + plan.low
        found["plan_high"][place] = plan.street + plan.high
        found["plan_centre"][place] = plan.street
        found["inertia"][place, : plan.storeys] = plan.inertia
        found["torsional_stiffness"][place, : plan.storeys] = plan.torsional_stiffness
        found["stiffness_centre"][place, : plan.storeys] = plan.street + plan.eccentricity
        for number, line in enumerate(plan.all_lines):
            if number < len(plan.lines):
                found["line_street"][place, number] = plan.street + line.arm
            else:
                found["line_x"][place, number] = line.arm
            found["line_stiffness"][place, : plan.storeys, number] = line.stiffness
            found["line_yield_shear"][place, : plan.storeys, number] = line.yield_shear
    return found


def _is_constant(array: np.ndarray, axis: int) -> bool:
    """Return whether an array is the same all along an axis; NaN is the same as NaN."""
    first = np.broadcast_to(array.take([0], axis), array.shape)
    return np.array_equal(first, array, equal_nan=array.dtype.kind == "f")


# The study and the program


def _study(plan: Plan) -> dict[str, Array]:
    """Return the study in texts."""
    study = plan.study
    match = study.spectrum_match()
    resolved = json.dumps(study.to_plain_data(), default=str, sort_keys=True)
    texts = {
        "study_text": (study.text, "study as written"),
        "study_resolved": (resolved, "study with every default, SI; JSON"),
        "study_warnings": (
            json.dumps([each.to_data() for each in study.warnings]),
            "what pound check says of it; JSON",
        ),
    }
    if match is not None:
        texts["study_spectrum"] = json.dumps(asdict(match)), "spectra of the motions against their target; JSON"
    return {name: Array((), np.array(text, object), {"long_name": about}) for name, (text, about) in texts.items()}


def _attributes(plan: Plan, solved: Responses) -> dict[str, Any]:
    there = solved.is_known
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "title": plan.study.title,
        "assumed_heights": json.dumps(plan.study.assumed_heights()),
        "swept": json.dumps([list(axis.names) for axis in plan.axes]),
        "solution_key": solution_key(plan),
        "accuracy": plan.accuracy,
        "method": plan.method,
        "methods": json.dumps(sorted(set(solved.texts["method"][there].tolist()))),
        **({} if plan.time_step is None else {"time_step": plan.time_step}),
        "scenes": int(there.sum()),
        "scenes_failed": int((there & ~solved.has_result).sum()),
        "solver_seconds": float(np.nansum(solved.values["seconds"])),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        **_software(),
    }


@cache
def _software() -> dict[str, Any]:
    """Return the versions of the software that results rest on."""
    found = {
        "pounding_cli": __version__,
        "solver": solver_version(),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "machine": platform.machine(),
        "cores": os.cpu_count() or 0,
        **{name: metadata.version(name) for name in _SOFTWARE},
    }
    return {f"software_{name}": value for name, value in found.items()}

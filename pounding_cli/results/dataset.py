"""A plan and its responses as one xarray.Dataset: all of a results file but its histories and the tables of answers."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable
from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import cache, partial
from importlib import metadata
from typing import Any

import numpy as np
import xarray as xr

from pounding_cli.model.links import columns_struck, ends_on_columns, link_label
from pounding_cli.model.scene import Analysis
from pounding_cli.model.wall import Wall
from pounding_cli.numbers import counted
from pounding_cli.results.file import unit_attributes
from pounding_cli.results.keys import FORMAT, FORMAT_VERSION, package_version, solution_key, solver_version
from pounding_cli.results.solved import SENTENCES, TEXTS, Solved, most_storeys, points
from pounding_cli.results.statistics import statistics
from pounding_cli.solver.response import COLLAPSED, DONE
from pounding_cli.study.plan import Plan
from pounding_cli.variables import (
    BUILDINGS,
    COORDINATES,
    LINKS,
    OF_COLUMNS,
    RECORDS,
    RESPONSES,
    SCENES,
    VARIABLES,
    WRITTEN,
)

_SOFTWARE = ("numpy", "scipy", "numba", "h5py", "xarray")

Variables = dict[str, xr.Variable]

_variable = partial(
    xr.Variable, fastpath=True
)  # otherwise Dask is loaded, where it is installed, to see that it has no part


def dataset(plan: Plan, solved: Solved) -> xr.Dataset:
    """What a plan came to, over the swept axes, case, analysis, record, building, storey, floor and link; rows whose
    scene nobody asked for have no numbers, and no status."""
    axes = tuple(axis.names[0] for axis in plan.axes)
    found = _links(plan, axes) | _facts(plan, axes)
    found |= _responses(plan, solved, axes, found["height"])
    found |= statistics(found, solved.values["error_estimate"][plan.numbers[..., 1:]])
    for name, v in found.items():
        unit = {"units": VARIABLES[name].unit} if VARIABLES[name].unit else {}
        v.attrs = {**unit, "long_name": VARIABLES[name].text}
    for name, quantity in WRITTEN.items():
        if name in found:
            found[name].attrs |= unit_attributes(plan.study.unit(quantity))
    beside = {v.name: found.pop(v.name) for v in RECORDS}
    coords = _coordinates(plan, solved.values["building.shear"].shape[-1]) | beside
    return xr.Dataset(found | _study(plan), coords, _attributes(plan, solved))


def _responses(plan: Plan, solved: Solved, axes: tuple[str, ...], height: xr.Variable) -> Variables:
    """The variables of RESPONSES and SCENES."""
    rows = plan.numbers.reshape(-1, plan.numbers.shape[-1])
    scene, alone = rows[:, 0], rows[:, 1:]
    found: Variables = {}

    def put(name: str, array: np.ndarray) -> None:
        found[name] = _variable((*axes, *VARIABLES[name].dims), array.reshape(*plan.shape, *array.shape[1:]))

    done = solved.done.reshape(-1)
    for v in RESPONSES:
        if not v.of or not _has(plan, v.name, v.dims):
            continue
        whole = solved.values[v.of]
        whole = np.where(done.reshape(-1, *(1,) * (whole.ndim - 1)), whole, np.nan)  # peaks are of whole motions
        put(
            v.name,
            np.stack([whole[alone[:, b], 0] for b in range(alone.shape[1])], axis=1) if v.alone else whole[scene],
        )
    for name, at in (("collapsed", scene[:, None]), ("collapsed0", alone)):
        building, storey = (solved.values[f"collapse_{what}"][at] for what in ("building", "storey"))
        mine = building == (np.arange(alone.shape[1]) if name == "collapsed" else 0)
        put(name, np.where(mine, storey, 0).astype(np.int64) + np.zeros(alone.shape, np.int64))
    for v in SCENES:
        if v.name in (*TEXTS, *SENTENCES):
            put(v.name, solved.texts(v.name)[scene])
        elif v.name == "scene":
            digests = [digest.tobytes().hex() for digest in plan.digests] + [""]
            put(v.name, np.where(solved.there[scene], np.array(digests, object)[scene], ""))
        else:
            values = solved.values[v.name][scene]
            put(v.name, np.nan_to_num(values).astype(np.int64) if v.kind == "i" else values)
    flags = found["flags"].values.reshape(-1)
    _flag_baselines(flags, plan, solved, scene, alone)
    _add_formulas(found, plan, flags, height)
    if "shear_demand" in found:
        _flag_columns(flags, plan, found)
    return found


def _has(plan: Plan, name: str, dims: tuple[str, ...]) -> bool:
    """Whether a variable says anything in a study: some have no links, few have links that strike columns."""
    if name in OF_COLUMNS:
        return any(map(ends_on_columns, plan.links.places))
    return "link" not in dims or bool(plan.links.places)


def _add_formulas(found: Variables, plan: Plan, flags: np.ndarray, height: xr.Variable) -> None:
    """Ratios, and what else follows from other variables; ratios that are refused are flagged."""
    for v in RESPONSES:
        if v.ratio:
            value, base = (found[name] for name in v.ratio)
            with np.errstate(all="ignore"):
                ratio = np.where(base.values > 0, value.values / base.values, np.nan)
            found[v.name] = _variable(base.dims, ratio)
            zero = (base.values == 0).any(axis=(-2, -1))
            if v.ratio[1] == "mu0":  # no storey of an elastic analysis yields: nobody asks for its ductility
                zero &= np.array([each == Analysis.INELASTIC for each in plan.analyses])[:, None]
            _flag(flags, zero.ravel(), f"{v.ratio[1]} = 0: ratio refused")
        elif v.formula is not None and _has(plan, v.name, v.dims):
            axes = tuple(axis.names[0] for axis in plan.axes)
            with np.errstate(all="ignore"):
                found[v.name] = _variable((*axes, *v.dims), v.formula({n: each.values for n, each in found.items()}))
    drift = found["drift"]
    heights = height.set_dims(drift.sizes).transpose(*drift.dims)
    found["drift_ratio"] = _variable(drift.dims, drift.values / heights.values)


def _flag_baselines(flags: np.ndarray, plan: Plan, solved: Solved, scene: np.ndarray, alone: np.ndarray) -> None:
    """Say in a scene's flags which building gave no baseline."""
    status = solved.texts("status")
    for place, building in enumerate(plan.buildings):
        here = np.where(solved.there[scene], status[alone[:, place]], "")
        for word in np.unique(here[(here != DONE) & (here != "")].astype(str)):
            said = " collapsed, its ratios are left out" if word == COLLAPSED else f": {word}, ratios refused"
            _flag(flags, here == word, f"{building} alone{said}")


def _flag_columns(flags: np.ndarray, plan: Plan, found: Variables) -> None:
    """Say in a scene's flags which columns a blow takes beyond their strength."""
    demand, impacts = (found[name].values.reshape(flags.size, -1) for name in ("shear_demand", "impacts"))
    demand = np.where(impacts > 0, demand, np.nan)  # a storey that yields has 1 by itself
    for row in np.flatnonzero((demand > 1).any(axis=-1)).tolist():
        struck = [columns_struck(plan.links.places[link]) for link in np.flatnonzero(demand[row] > 1).tolist()]
        worst = int(np.nanargmax(demand[row]))
        building, storey = columns_struck(plan.links.places[worst])
        more = len(set(struck)) - 1
        sentence = (
            f"columns overloaded by a blow: {plan.buildings[building]} storey {storey}, {demand[row, worst]:.3g} times "
            f"their share of the yield shear" + (f", and {counted(more, 'more storey')}" if more else "")
        )
        flags[row] = f"{flags[row]}\n{sentence}" if flags[row] else sentence


def _flag(flags: np.ndarray, where: np.ndarray, sentence: str) -> None:
    for place in np.flatnonzero(where).tolist():
        flags[place] = f"{flags[place]}\n{sentence}" if flags[place] else sentence


def _coordinates(plan: Plan, storeys: int) -> dict[str, xr.Variable]:
    found: dict[str, xr.Variable] = {}
    for axis in plan.axes:
        for column, name in enumerate(axis.names):
            values = [value[column] for value in axis.values]
            is_numeric = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
            array = np.array(values, float) if is_numeric else np.array(list(map(str, values)), object)
            text = f"swept with {axis.names[0]}" if column else f"swept: {name}"
            unit = axis.unit(column)
            attrs = {"long_name": text} | unit_attributes(unit if is_numeric else replace(unit, si=""))
            found[name] = _variable(axis.names[0], array, attrs)
    names = {"case": plan.cases, "analysis": plan.analyses, "record": plan.records, "building": plan.buildings}
    arrays = {name: (name, np.array(values, object)) for name, values in names.items()}
    arrays |= {name: (name, np.arange(1, storeys + 1)) for name in ("storey", "floor")}
    if plan.links.places:
        left, left_floor, right_floor, _ = zip(*plan.links.places, strict=True)
        of_links = {
            "link": np.array([link_label(plan.buildings, place) for place in plan.links.places], object),
            "link_left": np.array([plan.buildings[place] for place in left], object),
            "link_right": np.array([plan.buildings[place + 1] for place in left], object),
            "link_floor": np.array(left_floor),
            "link_right_floor": np.array(right_floor),
        }
        arrays |= {name: ("link", array) for name, array in of_links.items()}
    for name, (dim, array) in arrays.items():
        si, text = COORDINATES[name]
        found[name] = _variable(dim, array, ({"units": si} if si else {}) | {"long_name": text})
    return found


def _links(plan: Plan, axes: tuple[str, ...]) -> Variables:
    """Laws, gaps and ends of links by point and case."""
    names = (v.name for v in LINKS if _has(plan, v.name, v.dims))
    return {name: _variable((*axes, "case", "link"), getattr(plan.links, name)) for name in names}


def _facts(plan: Plan, axes: tuple[str, ...]) -> Variables:
    """Buildings and motions, over the axes that change them."""
    study, storeys = plan.study, most_storeys(plan)

    def over(section: str, dims: dict[str, tuple[str, ...]], value: Callable[[Any], dict[str, Any]]) -> Variables:
        """What `value` says at every combination of the values of the axes that touch a section of the study."""
        touched = [k for k, mine in enumerate(study.touching(section)) if mine]
        each = [value(at) for at in points(plan, section)]
        arrays = {name: np.array([one[name] for one in each]) for name in dims}
        sizes = [len(plan.axes[k].values) for k in touched]
        found = {
            name: _variable((*(axes[k] for k in touched), *own), arrays[name].reshape(*sizes, *arrays[name].shape[1:]))
            for name, own in dims.items()
        }
        for axis in (axes[k] for k in touched):  # without those that change nothing after all
            first = {name: v.isel({axis: 0}) for name, v in found.items()}
            if all(first[name].set_dims(v.sizes).transpose(*v.dims).equals(v) for name, v in found.items()):
                found = first
        return found

    def group(point: Any) -> dict[str, Any]:
        placed = study.group(point)
        assert placed is not None  # the study was validated at every point
        row = placed.buildings
        found: dict[str, Any] = {
            "period": np.array([building.periods[0] for building in row]),
            "base_shear_ratio": np.array([building.base_shear_ratio for building in row]),
            "slab": np.array([building.slab for building in row]),
            "separation": study.separations(point),
        }
        for name in ("mass", "height", "stiffness", "yield_shear"):
            found[name] = np.full((len(row), storeys), np.nan)
            for values, building in zip(found[name], row, strict=True):
                known = building.known(name) if isinstance(building, Wall) else getattr(building, name)
                values[: building.storeys] = known
        return found

    def motions(point: Any) -> dict[str, Any]:
        uses = [study.motions(point)[name].use for name in plan.records]
        kinds = {v.name: object if v.kind == "s" else float for v in RECORDS}
        return {
            name: np.array([getattr(use, name.removeprefix("record_")) for use in uses], kind)
            for name, kind in kinds.items()
        }

    buildings = over("buildings", {v.name: v.dims for v in BUILDINGS}, group)
    return buildings | over("records", {v.name: v.dims for v in RECORDS}, motions)


def _study(plan: Plan) -> Variables:
    """The study in texts."""
    study, match = plan.study, plan.study.spectrum_match()
    texts = {
        "study_text": (study.text, "study as written"),
        "study_resolved": (
            json.dumps(study.resolved(), default=str, sort_keys=True),
            "study with every default, SI; JSON",
        ),
        "study_warnings": (json.dumps([vars(each) for each in study.warnings]), "what pound check says of it; JSON"),
    }
    if match is not None:
        texts["study_spectrum"] = json.dumps(asdict(match)), "spectra of the motions against their target; JSON"
    return {name: _variable((), np.array(text, object), {"long_name": about}) for name, (text, about) in texts.items()}


def _attributes(plan: Plan, solved: Solved) -> dict[str, Any]:
    there = solved.there
    found = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "workflow": plan.workflow,
        "title": plan.study.title,
        "assumed_heights": json.dumps(plan.study.assumed_heights()),
        "swept": json.dumps([list(axis.names) for axis in plan.axes]),
        "solution_key": solution_key(plan),
        "accuracy": plan.accuracy,
        "method": plan.method,
        "methods": json.dumps(sorted(set(solved.texts("method")[there].tolist()))),
        **({} if plan.time_step is None else {"time_step": plan.time_step}),
        "scenes": int(there.sum()),
        "scenes_failed": int((there & ~solved.ended).sum()),
        "solver_seconds": float(np.nansum(solved.values["seconds"])),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    software = {
        "pounding_cli": package_version(),
        "solver": solver_version(),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "machine": platform.machine(),
        "cores": os.cpu_count() or 0,
        **_versions(),
    }
    return found | {f"software_{name}": value for name, value in software.items()}


@cache
def _versions() -> dict[str, str]:
    """Of the packages that results rest on."""
    return {name: metadata.version(name) for name in _SOFTWARE}

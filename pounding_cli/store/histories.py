"""The group `/histories` of a results file: what chosen scenes did over time (docs/histories.md)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.solver.histories import ENERGIES, History
from pounding_cli.store.structure import check_links, expect, refused, strings
from pounding_cli.texts import plain
from pounding_cli.variables import COORDINATES, PLACE

if TYPE_CHECKING:
    from pounding_cli.study import Plan, Row

GROUP = "histories"
FORMER = "former"
"""Scenes over time that the study does not have any more, in the form of `/histories` without units and dimensions."""

FIELDS = {
    "ground_acceleration": (("time",), "m/s2", "ground acceleration"),
    "ground_displacement": (("time",), "m", "ground acceleration integrated twice from rest, no baseline correction"),
    "displacement": (("time", "building", "floor"), "m", "floor displacement relative to the ground"),
    "total_acceleration": (("time", "building", "floor"), "m/s2", "floor acceleration, ground included"),
    "drift": (("time", "building", "storey"), "m", "storey drift"),
    "shear": (("time", "building", "storey"), "N", "storey shear, without damping force"),
    "sway": (("time", "building"), "m", "translation of the foundation"),
    "rocking": (("time", "building"), "rad", "rotation of the foundation"),
    "link_force": (("time", "link"), "N", "link force, pulling negative"),
    "closing": (("time", "link"), "m", "closing of the two ends of a link, gap not subtracted"),
    "energy_input": (("time",), "J", "energy put in by the ground so far"),
    "energy_kinetic": (("time",), "J", "kinetic energy"),
    "energy_stored": (("time",), "J", "elastic energy in storeys and foundations"),
    "energy_damping": (("time",), "J", "energy lost in structural damping so far"),
    "energy_hysteresis": (("time",), "J", "energy lost in yielding storeys so far"),
    "energy_links": (("time",), "J", "energy the links took so far, stored or lost"),
}
"""Dataset -> dimensions, unit, meaning."""

_ADDED = ("closing",)
"""What files of before do not have."""

_FACTS = ("number", "scene", "every", "times")
"""What is known of a kept scene besides its place."""


@dataclass(frozen=True)
class Kept:
    """A row of the study over time, every `every` seconds."""

    row: Row
    every: float
    history: History


def place_of(plan: Plan, row: Row) -> dict[str, Any]:
    """Case, analysis, record and swept values of a row, as a kept scene has them for attributes."""
    place: dict[str, Any] = {"case": row.case, "analysis": row.analysis, "record": row.record}
    for axis, number in zip(plan.axes, row.point, strict=True):
        place |= dict(zip(axis.names, axis.values[number], strict=True))
    return place


def write_histories(file: h5py.File, plan: Plan, histories: Iterable[Kept | h5py.Group]) -> None:
    """Write kept scenes one after the other, each under the attributes that say which it is.

    Groups of a former file go to `/former` as they are: scenes that the study had before.
    """
    for each in histories:
        if isinstance(each, h5py.Group):
            parent = file.require_group(FORMER)
            name = str(len(parent))
            # Without attributes, which refer to other places of the former file.
            each.file.copy(each, parent, name, without_attrs=True)
            parent[name].attrs.update(each.attrs)
        else:
            place = place_of(plan, each.row) | {"scene": each.row.scene, "every": each.every}
            write_history(file, place, each.history)


def write_history(file: h5py.File, place: Mapping[str, Any], history: History) -> None:
    """Write one kept scene as `/histories/<n>`, n from 0.

    Parameters
    ----------
    file : a results file whose coordinates (building, storey, floor, link) are written
    place : case, analysis, record, the swept values, scene and every, as attributes
    history : of the scene; links that the file does not know are left out
    """
    labels = list(strings(file["link"])) if "link" in file else []
    known = [number for number, label in enumerate(history.links) if label in labels]
    columns = [labels.index(history.links[number]) for number in known]
    parent = file.require_group(GROUP)
    group = parent.create_group(str(len(parent)))
    group.attrs.update(place)
    scales = {"time": _scale(group, "time", history.time, "s", "time since the motion began")}
    for dim in ("building", "storey", "floor", "link"):
        if dim in file:  # links: no case may have one
            scales[dim] = _scale(group, dim, file[dim][()], *COORDINATES[dim])
    for name, (dims, unit, text) in FIELDS.items():
        values = _values(history, name)
        if values is None or not all(dim in scales for dim in dims):
            continue
        whole = np.full([scales[dim].size for dim in dims], np.nan, np.float32)
        if dims == ("time", "link"):
            whole[:, columns] = values[:, known]
        else:
            whole[tuple(slice(size) for size in values.shape)] = values
        chunks = (max(1, whole.shape[0]), *(1 for _ in dims[1:]))  # one series is read without the others
        dataset = group.create_dataset(name, data=whole, chunks=chunks, compression="gzip", shuffle=True)
        dataset.attrs.update({"units": unit, "long_name": text})
        for number, dim in enumerate(dims):
            dataset.dims[number].attach_scale(scales[dim])


def stored_groups(file: h5py.File) -> list[h5py.Group]:
    """Every scene over time that a results file has, first those of its study in the order of its tables."""
    return [group[number] for name in (GROUP, FORMER) if name in file for group in [file[name]]
            for number in sorted(group, key=int)]  # fmt: skip


def kept_places(file: h5py.File) -> list[dict[str, Any]]:
    """Every kept scene of the study in the order of the tables: attributes, its `number`, how many `times` it has."""
    places = []
    groups = file.get(GROUP, {})
    for number in sorted(groups, key=int):
        check_links(groups[number])
        facts = {name: _plain(value) for name, value in groups[number].attrs.items()}
        places.append(facts | {"number": int(number), "times": groups[number]["time"].size})
    return places


def chosen_place(places: Sequence[dict[str, Any]], wanted: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The one of `kept_places` whose attributes are `wanted`; `name`: what errors call the file.

    Raises
    ------
    InputError : there is none, or more than one
    """
    if not places:
        hint = "add `keep: histories` to the study and run it again; what is solved stays"
        raise InputError(Problem("keeps no histories", hint, name))
    meant = [facts for facts in places if all(same_value(facts.get(key), value) for key, value in wanted.items())]
    if len(meant) == 1:
        return meant[0]
    said = ", ".join(f"{key} {value}" for key, value in wanted.items())
    shown = [_in_words(facts) for facts in (meant or places)]
    listed = "; ".join(shown[:12]) + (f"; ... {len(shown)} in all" if len(shown) > 12 else "")
    what = (f"keeps {len(meant)} histories" if meant else "keeps no history") + (f" of {said}" if said else "")
    raise InputError(Problem(what, f"{'say which of' if meant else 'kept are'}: {listed}", name))


def read_history(group: h5py.Group) -> History:
    """A kept scene; links in the file's order, NaN where the scene has none.  Raises InputError: it does not fit."""
    forms, here = check_links(group), group.name.strip("/")
    sizes = {dim: group[dim].size for dim in ("time", "building", "storey", "floor", "link") if dim in group}
    for name, (dims, _, _) in FIELDS.items():
        if all(dim in sizes for dim in dims) and (name in group or name not in _ADDED):
            expect(forms, f"{here}/{name}", tuple(sizes[dim] for dim in dims), "f")
    beside = group.file if group.parent.name == f"/{GROUP}" else group  # scenes of before have links of before
    for dim in ("building", "storey", "floor", "link"):
        if (dim in group) != (dim in beside):
            raise refused(f"{here}/{dim}", "is missing" if dim in beside else "is not in the file")
        if dim in group and not np.array_equal(group[dim][()], beside[dim][()]):
            raise refused(f"{here}/{dim}", "is not that of the file")
    texts = {dim: tuple(strings(group[dim])) if dim in group else () for dim in ("building", "link")}
    time = group["time"][()]
    if not (np.isfinite(time).all() and (np.diff(time) > 0).all()):
        raise refused(f"{here}/time", "does not go on")
    known = [name for name in FIELDS if name in group or name not in _ADDED]
    arrays = {name: group[name][()] if name in group else np.empty((time.size, 0), np.float32) for name in known}
    for name, values in arrays.items():  # NaN: the building has no such storey
        if np.isinf(values).any():
            raise refused(f"{here}/{name}", "is not finite")
    energy = {name: arrays.pop(f"energy_{name}") for name in ENERGIES}
    return History(time=time, **arrays, energy=energy, buildings=texts["building"], links=texts["link"])


def _in_words(facts: Mapping[str, Any]) -> str:
    swept = [f"{key} = {value}" for key, value in facts.items() if key not in (*PLACE, *_FACTS)]
    return ", ".join((*swept, *(facts[key] for key in PLACE)))


def same_value(one: Any, other: Any) -> bool:
    """Whether two values of a swept key or two names are the same."""
    if isinstance(one, float) and isinstance(other, int | float):
        return abs(one - other) <= 1e-9 * max(abs(one), abs(other))
    return one == other


def _plain(value: Any) -> Any:
    value = value.item() if isinstance(value, np.generic) else value
    return plain(value) if isinstance(value, str) else value


def _values(history: History, name: str) -> np.ndarray | None:
    kind = name.removeprefix("energy_")
    return getattr(history, name) if kind == name else history.energy[kind]


def _scale(group: h5py.Group, name: str, values: np.ndarray, unit: str, text: str) -> h5py.Dataset:
    dtype = h5py.string_dtype() if values.dtype == object else values.dtype
    dataset = group.create_dataset(name, data=values, dtype=dtype)
    dataset.attrs["long_name"] = text
    if unit:
        dataset.attrs["units"] = unit
    dataset.make_scale(name)
    return dataset

"""Chosen scenes over time: the groups `histories/<n>` of a results file, a Dataset each (docs/histories.md)."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
from pounding_cli.results.file import groups, opened
from pounding_cli.results.keys import solution_key
from pounding_cli.study.plan import Plan, Row
from pounding_cli.texts import plain
from pounding_cli.variables import PLACE

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.solver.histories import History

GROUP = "histories"

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
"""Variable -> dimensions, unit, meaning."""

WORTH_TELLING = 20
"""So many scenes to run for their histories take some seconds, and the user is told."""

_FACTS = ("number", "scene", "every", "times")
"""What is known of a kept scene besides its place."""


def kept_histories(
    plan: Plan, found: xr.Dataset, output: Path, tell: Callable[[str], None], replace: bool = False
) -> Iterator[xr.Dataset]:
    """The histories of the rows that a plan keeps, in the order of the tables; those of rows whose scene failed are
    left out.

    Parameters
    ----------
    found : the Dataset of the plan
    output : a former results file, whose histories serve again where the same solver made them
    tell : told of a run between output times that fails although the scene's own was done
    replace : drop what a former file keeps and this study does not ask for

    Raises
    ------
    InputError : the former file keeps histories that this study does not ask for
    """
    former: dict[tuple[str, float], tuple[dict[str, Any], xr.Dataset]] = {}
    with contextlib.suppress(InputError):  # missing, damaged, of an older program
        for facts, data in _stored(output):
            former[facts["scene"], facts["every"]] = facts, data
    asked = [place_of(plan, row) for row in plan.kept]
    lost = sum(not any(_agrees(facts, place) for place in asked) for facts, _ in former.values())
    if lost and not replace:
        what = f"the output keeps {counted(lost, 'history', 'histories')} that this run would drop"
        hint = "write `keep` in the study to make them again, name another file with -o, or use --replace"
        raise InputError(Problem(what, hint, str(output)))
    if former and _key_of(output) != solution_key(plan):
        former = {}
    return _made(plan, found, former, tell)


def _made(
    plan: Plan,
    found: xr.Dataset,
    former: Mapping[tuple[str, float], tuple[dict, xr.Dataset]],
    tell: Callable[[str], None],
) -> Iterator[xr.Dataset]:
    status = found["status"].values
    names = (plan.cases, plan.analyses, plan.records)
    digests = {row.scene: plan.digests[row.scene].tobytes().hex() for row in plan.kept}
    missing = sum((digest, plan.every) not in former for digest in digests.values())
    if missing >= WORTH_TELLING:
        tell(f"running {missing} scenes for their histories")
    for row in plan.kept:
        at = (*row.point, *(known.index(name) for known, name in zip(names, row[1:4], strict=True)))
        if status[at] != "done":
            continue
        data = former.get((digests[row.scene], plan.every), ({}, None))[1]
        if data is None or not _fits(data, found):
            from pounding_cli.solver.histories import history  # here: a finished study needs no numba

            try:
                data = _dataset(history(plan.scene(row.scene), plan.accuracy, plan.every), found)
            except InputError as error:
                tell(f"{row.case}, {row.analysis}, {row.record}: {error}")
                continue
        data.attrs = place_of(plan, row) | {"scene": digests[row.scene], "every": plan.every}
        yield data


def place_of(plan: Plan, row: Row) -> dict[str, Any]:
    """Case, analysis, record and swept values of a row, as a kept scene has them for attributes."""
    place: dict[str, Any] = {"case": row.case, "analysis": row.analysis, "record": row.record}
    for axis, number in zip(plan.axes, row.point, strict=True):
        place |= dict(zip(axis.names, axis.values[number], strict=True))
    return place


def _dataset(history: History, found: xr.Dataset) -> xr.Dataset:
    """A history over the coordinates of a results file; links that the file does not know are left out."""
    import xarray as xr

    names = ("building", "storey", "floor", "link")
    coords = {name: found[name].variable for name in names if name in found.coords}
    coords["time"] = xr.Variable(
        ("time",), history.time, {"units": "s", "long_name": "time since the motion began"}, fastpath=True
    )
    labels = found["link"].values.tolist() if "link" in coords else []
    known = [number for number, label in enumerate(history.links) if label in labels]
    columns = [labels.index(history.links[number]) for number in known]
    data = {}
    for name, (dims, unit, text) in FIELDS.items():
        kind = name.removeprefix("energy_")
        values = getattr(history, name) if kind == name else history.energy[kind]
        if values is None or not all(dim in coords for dim in dims):
            continue
        whole = np.full([coords[dim].size for dim in dims], np.nan, np.float32)
        if dims == ("time", "link"):
            whole[:, columns] = values[:, known]
        else:
            whole[tuple(slice(size) for size in values.shape)] = values
        data[name] = xr.Variable(dims, whole, {"units": unit, "long_name": text}, fastpath=True)
    return xr.Dataset(data, coords)


def _fits(data: xr.Dataset, found: xr.Dataset) -> bool:
    """Whether a history of a former file stands over the same coordinates."""
    names = ("building", "storey", "floor", "link")
    return all(
        (name in data) == (name in found.coords)
        and (
            name not in data
            or data[name].equals(found[name].drop_vars([each for each in found[name].coords if each != name]))
        )
        for name in names
    )


def _key_of(output: Path) -> str:
    with opened(output) as found:
        return str(found.attrs["solution_key"])


def _stored(path: Path) -> Iterator[tuple[dict[str, Any], xr.Dataset]]:
    """Every kept scene of a file: its attributes with its `number` and how many `times` it has, and its Dataset.

    Raises InputError, see `file.opened`.
    """
    opened(path).close()
    for number in sorted(groups(path, GROUP), key=int):
        with opened(path, f"{GROUP}/{number}") as data:
            facts = {str(name): _plain(value) for name, value in data.attrs.items() if name != "coordinates"}
            yield facts | {"number": int(number), "times": data["time"].size}, data.load()


def kept_places(path: Path) -> list[dict[str, Any]]:
    """Every kept scene of a file in the order of the tables: its attributes, `number` and `times`.

    Raises InputError, see `file.opened`.
    """
    return [facts for facts, _ in _stored(path)]


def chosen_place(places: Sequence[dict[str, Any]], wanted: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The one of `kept_places` whose attributes are `wanted`; `name`: what errors call the file.

    Raises
    ------
    InputError : there is none, or more than one
    """
    if not places:
        hint = "add `keep: histories` to the study and run it again; what is solved stays"
        raise InputError(Problem("keeps no histories", hint, name))
    meant = [facts for facts in places if _agrees(facts, wanted)]
    if len(meant) == 1:
        return meant[0]
    said = ", ".join(f"{key} {value}" for key, value in wanted.items())
    shown = [_in_words(facts) for facts in (meant or places)]
    listed = "; ".join(shown[:12]) + (f"; ... {len(shown)} in all" if len(shown) > 12 else "")
    what = (f"keeps {len(meant)} histories" if meant else "keeps no history") + (f" of {said}" if said else "")
    raise InputError(Problem(what, f"{'say which of' if meant else 'kept are'}: {listed}", name))


def read_history(path: Path, number: int) -> History:
    """A kept scene; links in the file's order, NaN where the scene has none.  Raises InputError, see `file.opened`."""
    from pounding_cli.solver.histories import ENERGIES, History  # here: numba takes a while to load

    with opened(path, f"{GROUP}/{number}") as data:
        none = np.empty((data.sizes["time"], 0), np.float32)
        arrays = {name: data[name].values if name in data else none for name in FIELDS}
        names = {dim: tuple(data[dim].values.tolist()) if dim in data else () for dim in ("building", "link")}
        energy = {name: arrays.pop(f"energy_{name}") for name in ENERGIES}
        time = data["time"].values
    return History(time=time, **arrays, energy=energy, buildings=names["building"], links=names["link"])


def _in_words(facts: Mapping[str, Any]) -> str:
    swept = [f"{key} = {value}" for key, value in facts.items() if key not in (*PLACE, *_FACTS)]
    return ", ".join((*swept, *(facts[key] for key in PLACE)))


def _agrees(facts: Mapping[str, Any], place: Mapping[str, Any]) -> bool:
    """Whether a kept scene stands at a place, numbers to nine digits."""
    return all(name in facts and _same(facts[name], value) for name, value in place.items())


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, int | float):
        return abs(one - other) <= 1e-9 * max(abs(one), abs(other))
    return bool(one == other)


def _plain(value: Any) -> Any:
    value = value.item() if isinstance(value, np.generic) else value
    return plain(value) if isinstance(value, str) else value

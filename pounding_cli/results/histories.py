"""Scenes over time: the groups `histories/<n>` of a results file, a Dataset each (docs/histories.md), and a history as
a person looks at it: in a line, as tables, as curves."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.numbers import pluralize
from pounding_cli.results.arrays import Array, ResultArrays
from pounding_cli.results.responses import Row, solution_key
from pounding_cli.solver.response import DONE

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from pounding_cli.study.run_plan import Plan


COORDINATES = ("time", "building", "storey", "floor", "line", "link")
"""Coordinates of a history; lines are those of floors that twist."""

ENERGIES = ("input", "kinetic", "stored", "damping", "hysteresis", "links")
LARGEST = (
    *("displacement", "drift", "total_acceleration", "shear"),
    *("twist", "line_drift", "line_shear", "closing", "link_force"),
)
"""Quantities whose largest values are told, as far as a history has them."""


def _series(name: str, text: str) -> property:
    """Return a property that gives a variable of the dataset as an array; `text` : its meaning, shape and unit."""
    return property(lambda history: history.dataset[name].values, doc=text)


class History:
    """The response of a scene over time; NaN where a floor, storey, frame line or link does not exist.

    Attributes
    ----------
    dataset : everything over time, building, floor, storey and link, with units (docs/histories.md)
    """

    time = _series("time", "Time since the motion began [s], shape (times,).")
    ground_acceleration = _series("ground_acceleration", "Ground acceleration [m/s2], shape (times,).")
    ground_displacement = _series(
        "ground_displacement", "Ground displacement from rest, without baseline correction [m], shape (times,)."
    )
    displacement = _series(
        "displacement", "Floor displacements relative to the ground [m], shape (times, buildings, floors)."
    )
    total_acceleration = _series(
        "total_acceleration", "Floor accelerations, ground included [m/s2], shape (times, buildings, floors)."
    )
    drift = _series("drift", "Storey drifts [m], shape (times, buildings, storeys).")
    shear = _series("shear", "Storey shears, without damping force [N], shape (times, buildings, storeys).")
    twist = _series(
        "twist", "Rotations of floors that twist [rad], shape (times, buildings, floors); of scenes where some do."
    )
    line_drift = _series(
        "line_drift", "Drifts of frame lines in their planes [m], shape (times, buildings, storeys, lines); likewise."
    )
    line_shear = _series(
        "line_shear",
        "Shears of frame lines, without damping force [N], shape (times, buildings, storeys, lines); likewise.",
    )
    sway = _series("sway", "Translations of the foundations [m], shape (times, buildings).")
    rocking = _series("rocking", "Rotations of the foundations [rad], shape (times, buildings).")
    base_force = _series(
        "base_force", "Forces of springs or isolators under the bases, undamped [N], shape (times, buildings)."
    )
    link_force = _series("link_force", "Link forces, pulling negative [N], shape (times, links).")
    closing = _series("closing", "Closings of the ends of links, gap not subtracted [m], shape (times, links).")
    energy_input = _series("energy_input", "Energy put in by the ground so far [J], shape (times,).")
    energy_kinetic = _series("energy_kinetic", "Kinetic energy [J], shape (times,).")
    energy_stored = _series("energy_stored", "Elastic energy in storeys and foundations [J], shape (times,).")
    energy_damping = _series("energy_damping", "Energy lost in structural damping so far [J], shape (times,).")
    energy_hysteresis = _series("energy_hysteresis", "Energy lost in yielding storeys so far [J], shape (times,).")
    energy_links = _series("energy_links", "Energy the links took so far, stored or lost [J], shape (times,).")

    def __init__(self, dataset: xr.Dataset) -> None:
        self.dataset = dataset

    @property
    def buildings(self) -> tuple[str, ...]:
        """Names, left to right."""
        return tuple(self.dataset["building"].values.tolist())

    @property
    def links(self) -> tuple[str, ...]:
        """Names in the order of the tables."""
        return tuple(self.dataset["link"].values.tolist())

    @property
    def energy(self) -> dict[str, np.ndarray]:
        """Energies by kind [J], shape (times,) each; the first is the sum of the others."""
        return {kind: self.dataset[f"energy_{kind}"].values for kind in ENERGIES}

    def frame(self, quantity: str = "displacement") -> pd.DataFrame:
        """One quantity over time, a column each for the floors, storeys, frame lines or links that there are.

        Parameters
        ----------
        quantity : displacement, total_acceleration (columns: building and floor); drift, shear (building and storey);
            where floors twist, twist (building and floor), line_drift, line_shear (building, storey and line);
            link_force, closing (link); sway, rocking, base_force (building); ground_acceleration, ground_displacement;
            energy

        The index is the time [s]; the unit stands in `frame.attrs["units"]`.

        Raises
        ------
        InputError : no such quantity
        """
        import pandas as pd

        known = [*(str(name) for name in self.dataset if not str(name).startswith("energy_")), "energy"]
        if quantity not in known:
            raise InputError(f"no quantity '{quantity}' in a history", f"write one of {', '.join(known)}")
        array = self.dataset["energy_input" if quantity == "energy" else quantity]
        if quantity == "energy":
            frame = pd.DataFrame(self.energy, array.get_index("time")).rename_axis(columns="kind")
        else:
            flat = array.stack(place=array.dims[1:]) if array.ndim > 2 else array  # noqa: PD013 (of xarray)
            frame = pd.DataFrame(flat.to_pandas())
        frame = frame.dropna(axis=1, how="all")
        frame.attrs = {"units": array.attrs["units"]}
        return frame

    def plot(
        self,
        *quantities: str,
        level: int | None = None,
        between: tuple[float, float] | None = None,
    ) -> list[Axes]:
        """Curves over time, one panel a quantity: displacements, closings and link forces unless others are named.

        Parameters
        ----------
        quantities : as in `frame`
        level : floor or storey that is drawn of every building and link; the highest one unless given
        between : the part that is drawn [s]; all unless given

        Returns the axes of the panels.

        Raises
        ------
        InputError : no such quantity or level
        """
        import matplotlib.pyplot as plt

        has_links = not self.frame("link_force").empty
        chosen = quantities or ("displacement", *(("closing", "link_force") if has_links else ()))
        figure, panels = plt.subplots(len(chosen), sharex=True, squeeze=False, layout="constrained")
        figure.set_size_inches(7.0, 1.0 + 1.8 * len(chosen))
        for ax, name in zip(panels[:, 0], chosen, strict=True):
            frame = self._curves(name, level).loc[slice(*between or (None, None))]
            of = f"{name.replace('_', ' ')} [{frame.attrs['units']}]"
            frame.set_axis([_label(column, frame) for column in frame], axis=1).plot(
                ax=ax, lw=1.2, grid=True, xlabel="time [s]", ylabel=of
            )
        return list(panels[:, 0])

    def _curves(self, quantity: str, level: int | None) -> pd.DataFrame:
        """Return the columns of a quantity that are drawn: one floor or storey a building with all its frame lines, the
        links of one floor a pair."""
        frame = self.frame(quantity)
        places: list[Any] = list(frame.columns)
        if frame.columns.names == ["link"]:
            parts = [label.rpartition(" floor ") for label in places]
            places = [(pair, floors.split(",")[0].split("|")[0]) for pair, _, floors in parts]
        elif frame.columns.nlevels == 1:
            return frame
        top = {of: number for of, number, *_ in places}  # the highest number comes last
        kept = [str(number) == str(level or top[of]) for of, number, *_ in places]
        if not any(kept):
            raise InputError(f"{quantity}: there is nothing at level {level}", "give an existing floor")
        return frame.loc[:, kept]

    def largest(self) -> pd.DataFrame:
        """The largest value of every quantity in every building and over the links, where it is and when [s].

        Without regard to sign, except of closings. Between the output times values may be larger: the peaks in the
        tables of a results file are located there too.
        """
        import pandas as pd

        found = {}
        for name in LARGEST:
            if name not in self.dataset:
                continue
            frame = self.frame(name)
            unit = frame.attrs["units"]
            if name != "closing":
                frame = frame.abs()
            whole = [frame]
            if frame.columns.nlevels > 1:
                whole = [frame[[each]] for each in self.buildings if each in frame.columns.get_level_values(0)]
            for part in whole if not frame.empty else ():
                column = part.max().idxmax()
                found[name, _label(column, part)] = part[column].max(), unit, part[column].idxmax()
        frame = pd.DataFrame.from_dict(found, orient="index", columns=["largest", "unit", "time"])
        return frame.set_axis(pd.MultiIndex.from_tuples(found, names=["quantity", "where"]))

    def __repr__(self) -> str:
        time = self.time
        links = self.frame("link_force").shape[1]
        step = f" every {1000 * time[1]:.4g} ms" if time.size > 1 else ""
        said = f"{pluralize(links, 'link')}; {time[-1]:.4g} s{step}, {pluralize(time.size, 'time')}"
        return f"History({', '.join(self.buildings)}; {said})"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<p>{escape(repr(self))}</p>{self.largest().to_html(float_format='{:.4g}'.format)}"


def _label(column: Any, frame: pd.DataFrame) -> str:
    """Return a column in words: "soft, floor 5", "soft, storey 5, line 1"."""
    if not isinstance(column, tuple):
        return str(column)
    levels = zip(frame.columns.names[1:], column[1:], strict=True)
    return ", ".join([str(column[0]), *(f"{level} {number}" for level, number in levels)])


def to_arrays(history: Mapping[str, Any], over: Mapping[str, np.ndarray] | None = None) -> ResultArrays:
    """Return a history of `solver.histories` as arrays; its names may be those of other arrays.

    over : coordinates in place of its own; NaN where it has none of a name
    """
    data = {name: Array(*each) for name, each in history.items()}
    coordinates = {name: data.pop(name) for name in COORDINATES if name in data}
    for dim, wanted in (over or {}).items():
        if dim not in coordinates:  # lines, where no floor of the scene twists
            continue
        own = coordinates[dim].values.tolist()
        names = wanted.tolist()
        known = [place for place, name in enumerate(names) if name in own]
        coordinates[dim] = Array((dim,), wanted)
        for name, each in data.items():
            if dim in each.dims:
                mine = np.moveaxis(each.values, each.dims.index(dim), 0)
                whole = np.full((len(names), *mine.shape[1:]), np.nan)
                whole[known] = mine[[own.index(names[place]) for place in known]]
                data[name] = Array(each.dims, np.moveaxis(whole, 0, each.dims.index(dim)), each.attrs)
    return ResultArrays(data, coordinates, {})


class HistoryStore(Protocol):
    """A place that keeps histories as rows, by the digest of their scene; `batch.cache.Cache` is one."""

    def iter_rows(self, key: str, digests: Sequence[bytes]) -> Iterator[dict[bytes, Row]]:
        """Yield the rows that are there, some at a time."""

    def store(self, key: str, rows: Mapping[bytes, Row]) -> None:
        """Keep rows by digest."""


MAX_STORED_HISTORY = 1 << 23
"""Bytes of a history beyond which it is not kept for the next run, but solved again."""


STORED_HISTORY = b"history "
"""Stands before the digest of a scene whose history is kept, so that it is not counted among solved scenes."""


def history_key(plan: Plan) -> str:
    """Return what two histories of one scene share exactly when they are the same."""
    return f"{solution_key(plan)} | history every {plan.every!r}"


def encode_history(history: Mapping[str, Any]) -> Row:
    """Return a history of `solver.histories` as a row: names, dimensions and texts as JSON, and its numbers."""
    heads = []
    parts = []
    for name, (dims, values, attrs) in history.items():
        array = np.asarray(values)
        is_text = array.dtype.kind in "OU"
        head = {"name": name, "dims": dims, "attrs": attrs, "shape": array.shape}
        head |= {"texts": array.tolist()} if is_text else {"type": array.dtype.str}
        heads.append(head)
        parts += [] if is_text else [array.tobytes()]
    return json.dumps(heads), b"".join(parts)


def decode_history(row: Row) -> dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, Any]]]:
    """Return the history of a row of `encode_history`."""
    heads = json.loads(row[0])
    numbers = row[1]
    history = {}
    begin = 0
    for head in heads:
        if "texts" in head:
            array = np.array(head["texts"], object)
        else:
            count = math.prod(head["shape"])
            array = np.frombuffer(numbers, head["type"], count, begin).reshape(head["shape"])
            begin += array.nbytes
        history[head["name"]] = tuple(head["dims"]), array, head["attrs"]
    return history


def iter_kept_histories(
    plan: Plan, arrays: ResultArrays, tell: Callable[[str], None], store: HistoryStore
) -> Iterator[tuple[tuple[int, ...], ResultArrays]]:
    """Yield the index of every row that a plan keeps, in the order of the tables, with its history over the coordinates
    of its arrays; rows whose scene failed are left out.

    tell : told of a run between output times that fails although the scene's own was done
    store : of histories of earlier runs, which are not solved again
    """
    digests = [STORED_HISTORY + plan.digests[row.scene].tobytes() for row in plan.kept]
    key = history_key(plan)
    known = {digest: row for rows in store.iter_rows(key, digests) for digest, row in rows.items()}
    over = {name: arrays.coordinates[name].values for name in COORDINATES[1:] if name in arrays.coordinates}
    for row in plan.kept:
        place: dict[str, Any] = {"case": row.case, "analysis": row.analysis, "record": row.record}
        names = (plan.cases, row.case), (plan.analyses, row.analysis), (plan.records, row.record)
        at = *row.point, *(known.index(name) for known, name in names)
        if arrays.data["status"].values[at] != DONE:
            continue
        for axis, number in zip(plan.axes, row.point, strict=True):
            place |= dict(zip(axis.names, axis.values[number], strict=True))
        digest = STORED_HISTORY + plan.digests[row.scene].tobytes()
        try:
            whole = decode_history(known[digest]) if digest in known else _solve(plan, row.scene)
        except InputError as error:
            tell(f"{row.case}, {row.analysis}, {row.record}: {error}")
            continue
        if digest not in known:
            encoded = encode_history(whole)
            if len(encoded[1]) <= MAX_STORED_HISTORY:
                store.store(key, {digest: encoded})
        history = to_arrays(whole, over)
        data = {
            name: Array(each.dims, each.values.astype(np.float32), each.attrs) for name, each in history.data.items()
        }
        attributes = place | {"scene": plan.digests[row.scene].tobytes().hex(), "every": plan.every}
        yield at, ResultArrays(data, history.coordinates, attributes)


def _solve(plan: Plan, number: int) -> Mapping[str, Any]:
    """Return the history of a scene of a plan.  Raises InputError: the run did not end."""
    from pounding_cli.solver.histories import solve_history  # here: a study without any needs no numba

    whole = solve_history(plan.scene(number), plan.accuracy, plan.every)
    return {
        name: (dims, values if name in COORDINATES else values.astype(np.float32), attrs)
        for name, (dims, values, attrs) in whole.items()
    }

"""The tables of rows of buildings in a results file, each read when it is asked for; swept axes first."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.solver.response import COLLAPSED
from pounding_cli.store.files import opened
from pounding_cli.store.flagged import counts_of_flags, flagged_scenes
from pounding_cli.store.structure import strings
from pounding_cli.variables import (
    FLOOR,
    FORMERLY,
    LINK,
    LINKS,
    OF_COLUMNS,
    PLACE,
    RATIOS,
    RESPONSES,
    SCENES,
    STOREY,
    VARIABLES,
)

if TYPE_CHECKING:
    import pandas as pd

_STOREY, _FLOOR, _OF_LINKS = (
    tuple(v.name for v in RESPONSES if v.dims == dims and v.name not in OF_COLUMNS) for dims in (STOREY, FLOOR, LINK)
)
_LINK_FACTS = ("left", "right", "floor")
_LINK = ("kind", "gap", *_OF_LINKS)
_FACTS_OF_LINKS = tuple(variable.name for variable in LINKS)
_SCENE = tuple(v.name for v in SCENES if v.name not in ("orders", "scene"))
_ACCURACY = (
    "status", "method", "accuracy", "time_step", "error_estimate", "sensitivity",
    "energy_residual",
    "steps", "events", "orders", "seconds",
)  # fmt: skip
_RECORD = ("source", "digest", "scale", "window", "pga", "arias")
_MEASURES = ("mean", "mean_error", "mean_sensitivity", "std", "min", "max")


class RowTables:
    """The tables of rows of buildings (docs/results.md).

    path : the file
    swept : the keys of every axis; more than one where they move together
    axes : swept key -> its values (SI)
    tables : names of the tables that the file has
    resolved : the study with every default filled in, SI
    """

    path: Path
    swept: list[list[str]]
    axes: dict[str, list[Any]]
    tables: Any
    resolved: Any
    _cut = ""
    """The dimension of which only the first place is read; none unless it is set."""

    def storey(self) -> pd.DataFrame:
        """Storey shears [N], ductilities [-], drifts [m] with and without neighbours, and their ratios."""
        return self._levels("storey", _STOREY)

    def floor(self) -> pd.DataFrame:
        """Floor accelerations [m/s2] with and without neighbours, their ratio, displacements [m]."""
        return self._levels("floor", _FLOOR)

    def link(self) -> pd.DataFrame:
        """Per link: law, gap [m], impacts, peak force [N], closing [m], impulse [N s], contact time [s]."""
        with self._opened("link") as file:
            if "link" not in file:
                return frame_of(
                    {name: [] for name in (*self.axes, *PLACE, "link", *_LINK_FACTS, *_LINK, "right_floor")}
                )
            dims = (*self._dims, *PLACE, "link")
            shape = self._shape(file["impacts"])
            facts = {name: self._spread(self._values(file[f"link_{name}"]), shape) for name in _LINK_FACTS}
            columns = self._index(file, dims, shape) | facts
            columns |= {name: self._by_scene(file, name, shape).ravel() for name in _held(file, _LINK)}
            columns["right_floor"] = self._spread(self._values(file["link_right_floor"]), shape)
            solved = self._spread(self._solved(file)[..., None], shape)
            for name in OF_COLUMNS if OF_COLUMNS[0] in file else ():
                columns[name] = self._by_scene(file, name, shape).ravel()
        frame = frame_of(columns)
        return frame[(frame["kind"] != "") & solved].reset_index(drop=True)

    def struck(self) -> pd.DataFrame:
        """Per row of columns that a slab strikes between floors: building, storey, height of the blow over that of the
        storey [-], who strikes with which floor, shears below and above the blow [N], the larger over the columns'
        share of the yield shear [-], blows, largest force [N]. No row where no slab strikes columns.
        """
        link = self.link()
        link = link if OF_COLUMNS[0] in link.columns else link.iloc[:0].assign(**dict.fromkeys(OF_COLUMNS, np.nan))
        link = link[link["shear_below"].notna()].reset_index(drop=True)
        is_left = link["link"].astype(str).str.contains(", left")
        place = list(link.columns[: list(link.columns).index("link")])
        sides = {
            "building": ("left", "right"), "storey": ("floor", "right_floor"), "at": ("left_at", "right_at"),
            "by": ("right", "left"), "by_floor": ("right_floor", "floor"),
        }  # fmt: skip
        found = {name: np.where(is_left, link[left], link[right]) for name, (left, right) in sides.items()}
        return link[place].assign(**found, **link[["gap", *OF_COLUMNS[2:], "impacts", "peak_force"]])

    def _by_scene(self, file: h5py.File, name: str, shape: tuple[int, ...]) -> np.ndarray:
        """A variable of links; one of LINKS is the same for every analysis and record."""
        array = self._values(file[name])
        if name not in _FACTS_OF_LINKS:
            return array
        at = len(self._dims) + 1
        return np.broadcast_to(np.expand_dims(array, (at, at + 1)), shape)

    def scene(self) -> pd.DataFrame:
        """Per scene: outcome, cost, errors, effects and flags (several in one cell: one a line)."""
        with self._opened("scene") as file:
            shape = self._shape(file["status"])
            columns = self._index(file, (*self._dims, *PLACE), shape)
            columns |= {name: self._asked(file, name).ravel() for name in _SCENE}
        frame = frame_of(columns)
        return frame[frame["status"] != ""].reset_index(drop=True)

    def flagged(self) -> pd.DataFrame:
        """Which scenes are flagged and why: swept keys, case, analysis, record, flag, detail, meaningless; no row where
        nothing is.

        flag : what is flagged; detail : where and by how much; meaningless : whether the flag takes the meaning from
        all numbers of its scene (a connector that closes more than its gap), or is worth knowing beside them.
        `flag_groups_of(results.scene())` sums them up by case and analysis.
        """
        return flagged_scenes(self.scene())

    def accuracy(self) -> pd.DataFrame:
        """Per scene what its accuracy cost: asked and estimated error [-], sensitivity [-], how both were found,
        energy left open [-], steps, events, Taylor orders, seconds in the solver.
        """
        with self._opened("accuracy") as file:
            shape = self._shape(file["status"])
            columns = self._index(file, (*self._dims, *PLACE), shape)
            columns |= {name: self._asked(file, name).ravel() for name in _ACCURACY}
        frame = frame_of(columns)
        return frame[frame["status"] != ""].reset_index(drop=True)

    def _asked(self, file: h5py.File, name: str) -> np.ndarray:
        """A variable of SCENES, as `FORMERLY` where the file is of before, NaN or no text where it has none."""
        if not VARIABLES[name].always and name not in file:
            shape = file["status"].shape
            return np.full(shape, "", object) if VARIABLES[name].kind == "s" else np.full(shape, np.nan)
        if name in file or name not in FORMERLY:
            return self._values(file[name])
        asked = "accuracy" if self.resolved.get("time_step") is None else "time_step"
        return self._values(file[FORMERLY[name]]) * (1.0 if name == asked else np.nan)

    def summary(self) -> pd.DataFrame:
        """Statistics over the records of every ratio [-] with error and sensitivity of its mean; floor i stands with
        storey i.

        Standard deviations are with n - 1; `records_used` counts the records with a V_ratio, `records_flagged` those
        whose scene carries a flag, `records_meaningless` those whose numbers mean nothing (`flagged`),
        `records_collapsed` those in whose scene a storey collapsed.
        """
        with self._opened("summary") as file:
            dims = (*self._dims, "case", "analysis", "building", "storey")
            shape = self._shape(file["V_ratio_mean"])
            columns = self._index(file, dims, shape)
            for ratio in RATIOS:
                for measure in _MEASURES:
                    columns[f"{ratio}_{measure}"] = self._values(file[f"{ratio}_{measure}"]).ravel()
            columns["records_used"] = self._values(file["V_ratio_count"]).ravel()
            collapsed = (self._values(file["status"]) == COLLAPSED).sum(axis=-1)
            counts = counts_of_flags(self._values(file["flags"])) | {"records_collapsed": collapsed}
            for name, count in counts.items():
                columns[name] = self._spread(count[..., None, None], shape)
            there = self._there(file, 2)
        return frame_of(columns)[there].reset_index(drop=True)

    def records(self) -> pd.DataFrame:
        """Per motion: real or stand-in, digest, scale [-], window [s], peak [m/s2], Arias [m/s] as used.

        Swept axes that change a motion come first.
        """
        with self._opened("records") as file:
            scale = file["record_scale"]
            columns = self._index(file, tuple(_dimensions(scale)), self._shape(scale))
            return frame_of(columns | {name: self._values(file[f"record_{name}"]).ravel() for name in _RECORD})

    @cached_property
    def buildings(self) -> pd.DataFrame:
        """Per building and storey: place from 1 at the left, mass [kg], height [m], stiffness [N/m],
        yield shear [N], fundamental period [s], base-shear ratio V/W [-] (infinite for storeys that never yield),
        thickness of the slabs [m] (not in files of before), the code's separation from the next building [m].

        Swept axes that change a building come first.
        """
        with self._opened("buildings") as file:
            dims = tuple(_dimensions(file["mass"]))
            shape = self._shape(file["mass"])
            columns = self._index(file, dims, shape)
            storey = columns.pop("storey")
            places = np.arange(1, shape[-2] + 1)[:, None]
            columns |= {"place": np.broadcast_to(places, shape).ravel(), "storey": storey}
            for name in ("mass", "height", "stiffness", "yield_shear"):
                columns[name] = self._values(file[name]).ravel()
            for name in _held(file, ("period", "base_shear_ratio", "slab", "separation")):
                columns[name] = np.broadcast_to(self._values(file[name])[..., None], shape).ravel()
        frame = frame_of(columns)
        return frame[frame["mass"].notna()].reset_index(drop=True)

    @contextmanager
    def _opened(self, table: str) -> Iterator[h5py.File]:
        """The file, open for one of its tables of rows of buildings.  Raises InputError: it has none of them."""
        if table not in self.tables:
            raise InputError(Problem(f"has no table {table}", f"it has: {', '.join(self.tables)}", str(self.path)))
        with opened(self.path) as file:
            yield file

    def _values(self, dataset: h5py.Dataset) -> np.ndarray:
        """The values of a variable, of the first sample where this is of that alone."""
        values = strings(dataset) if h5py.check_string_dtype(dataset.dtype) else None
        if not self._cut:
            return dataset[()] if values is None else values
        at = tuple(slice(0, 1) if dim == self._cut else slice(None) for dim in _dimensions(dataset))
        return dataset[at] if values is None else values[at]

    def _shape(self, dataset: h5py.Dataset) -> tuple[int, ...]:
        cut = self._cut
        return tuple(
            1 if cut and dim == cut else size for dim, size in zip(_dimensions(dataset), dataset.shape, strict=True)
        )

    @property
    def _dims(self) -> tuple[str, ...]:
        return tuple(names[0] for names in self.swept)

    def _levels(self, level: str, names: tuple[str, ...]) -> pd.DataFrame:
        with self._opened(level) as file:
            shape = self._shape(file[names[0]])
            columns = self._index(file, (*self._dims, *PLACE, "building", level), shape)
            columns |= {name: self._values(file[name]).ravel() for name in _held(file, names)}
            there = self._there(file, 3) & self._spread(self._solved(file)[..., None, None], shape)
        return frame_of(columns)[there].reset_index(drop=True)

    def _solved(self, file: h5py.File) -> np.ndarray:
        """Which rows have a scene: a workflow need not ask for all."""
        return self._values(file["status"]) != ""

    def _there(self, file: h5py.File, between: int) -> np.ndarray:
        """Which rows stand for a storey that exists; `between` dimensions lie between axes and building."""
        kept = _dimensions(file["mass"])
        there = np.isfinite(self._values(file["mass"]))
        for number, dim in enumerate(self._dims):
            if dim not in kept:
                there = np.expand_dims(there, number)
        there = np.expand_dims(there, tuple(range(len(self._dims), len(self._dims) + between)))
        sizes = {dim: len(self.axes[dim]) for dim in self._dims}
        of_place = tuple(file[dim].size for dim in ("case", "analysis", "record")[:between])
        return np.broadcast_to(there, (*sizes.values(), *of_place, *there.shape[-2:])).ravel()

    def _index(self, file: h5py.File, dims: tuple[str, ...], shape: tuple[int, ...]) -> dict[str, np.ndarray]:
        """The columns that say where a value stands; a zipped axis gives one for each of its keys."""
        zipped = {names[0]: names for names in self.swept}
        columns = {}
        for number, dim in enumerate(dims):
            across = [1] * len(shape)
            across[number] = shape[number]
            for name in zipped.get(dim, [dim]):
                columns[name] = np.broadcast_to(self._values(file[name]).reshape(across), shape).ravel()
        return columns

    @staticmethod
    def _spread(values: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
        return np.broadcast_to(values, shape).ravel()


def _held(file: h5py.File, names: tuple[str, ...]) -> tuple[str, ...]:
    """Without those that files of before, or of other studies, do not have."""
    return tuple(name for name in names if name in file or VARIABLES[name].always)


def _dimensions(dataset: h5py.Dataset) -> list[str]:
    """The dimension of every place of a variable; of a coordinate its own name."""
    return [_name(dim[0]) if len(dim) else _name(dataset) for dim in dataset.dims]


def _name(dataset: h5py.Dataset) -> str:
    return dataset.name.lstrip("/")


def frame_of(columns: dict[str, Any]) -> pd.DataFrame:
    import pandas as pd  # here, so that `pound run` on a finished study need not load it

    return pd.DataFrame(columns)

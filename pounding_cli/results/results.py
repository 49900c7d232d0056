"""A results file read back: tidy tables, swept axes first."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import TypeAdapter

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit, counted
from pounding_cli.records.scaling import SpectrumMatch
from pounding_cli.results.file import kept, opened, plain_value, read_table, written
from pounding_cli.results.flags import counts_of_flags, flagged_scenes
from pounding_cli.results.histories import History
from pounding_cli.results.tables import ANSWERS, TABLES, Column, Table, column_of
from pounding_cli.solver.response import COLLAPSED
from pounding_cli.texts import plain, plain_tree
from pounding_cli.variables import FLOOR, LINK, OF_COLUMNS, PLACE, RATIOS, RESPONSES, SCENES, STOREY, VARIABLES, WRITTEN

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_OVER = {
    dims: [v.name for v in RESPONSES if v.dims == dims and v.name not in OF_COLUMNS] for dims in (STOREY, FLOOR, LINK)
}
_SCENE = [v.name for v in SCENES if v.name not in ("orders", "scene")]
_ACCURACY = [
    "status", "method", "accuracy", "time_step", "error_estimate", "sensitivity", "energy_residual", "steps", "events",
    "orders", "seconds",
]  # fmt: skip
_RECORD = ["source", "digest", "scale", "window", "pga", "arias"]
_DIMS = {
    "building": ("building",), "case": ("case",), "analysis": ("analysis", "analyses"), "record": ("motion",),
}  # fmt: skip
_MEASURES = ("mean", "mean_error", "mean_sensitivity", "std", "min", "max")


class Results:
    """The tables of one results file (docs/results.md), each read when asked for.

    Attributes
    ----------
    path : the file
    title, study_text : the study as written
    workflow : the command that wrote it
    answers : the tables that this command added
    resolved, resolved_text : the study with every default filled in (SI), as a mapping and as JSON
    swept : the keys of every axis; more than one where they move together
    axes : swept key -> its values (SI); keys of one axis (zipped) have the same length
    units : column -> the unit the study wrote it in, to show values to people: swept keys, gaps, accelerations
    assumed_heights : the buildings whose storey heights the study leaves to their default
    warnings : what `pound check` says of the study: what is unlikely, and floors that meet nothing
    methods : the methods that solved the scenes, buildings alone included
    attrs : the file's own facts (accuracy, method, counts, times) and the software it was made with
    data : all of it as xarray has it, read as it is asked for
    """

    def __init__(self, path: Path) -> None:
        self.path = Path(path)
        self.data: xr.Dataset = opened(self.path)
        try:
            self._start()
        except (KeyError, ValueError, TypeError, AttributeError) as error:
            what = f"does not hold what results hold ({error})"
            hint = "give the file that pound run wrote, or run the study again"
            raise InputError(Problem(what, hint, str(self.path))) from error

    def _start(self) -> None:
        data = self.data
        needed = {v.name for v in VARIABLES.values() if v.always and LINK[-1] not in v.dims}
        if missing := sorted(needed - set(data.variables)):
            raise ValueError(f"no {', '.join(missing)}")
        self.attrs = {str(name): plain_value(value) for name, value in data.attrs.items() if name != "coordinates"}
        self.title, self.workflow = str(self.attrs["title"]), str(self.attrs["workflow"])
        self.answers = tuple(json.loads(self.attrs.get("answers", "[]")))
        self.study_text, self.resolved_text = (str(data[name].item()) for name in ("study_text", "study_resolved"))
        self.warnings = tuple(Problem(**each) for each in json.loads(str(data["study_warnings"].item())))
        self.assumed_heights: tuple[str, ...] = tuple(map(plain, json.loads(self.attrs["assumed_heights"])))
        self.methods: tuple[str, ...] = tuple(json.loads(self.attrs["methods"]))
        self.swept: list[list[str]] = json.loads(self.attrs["swept"])
        keys = [name for names in self.swept for name in names]
        self.axes: dict[str, list[Any]] = {name: list(map(plain_value, data[name].values.tolist())) for name in keys}
        self.units: dict[str, Unit] = {name: written(data[name].attrs) for name in keys}
        self.units |= {name.removeprefix("record_"): written(data[name].attrs) for name in WRITTEN if name in data}

    @cached_property
    def resolved(self) -> dict[str, Any]:
        """The study with every default filled in, SI."""
        return plain_tree(json.loads(self.resolved_text))

    def axis_label(self, key: str) -> str:
        """A swept key with the unit the study wrote it in: "cases.gap.gap [cm]"."""
        return self.units[key].label(key)

    def value_label(self, key: str, value: Any) -> str:
        """A value of a swept key (SI, as in the tables) as people read it: "5 cm"; texts as they are."""
        return self.units[key].text(value)

    @cached_property
    def spectrum_match(self) -> SpectrumMatch | None:
        """The spectra of the motions as used against the target they were scaled to; None where there is none."""
        if "study_spectrum" not in self.data:
            return None
        return TypeAdapter(SpectrumMatch).validate_json(str(self.data["study_spectrum"].item()))

    # Tables

    @property
    def tables(self) -> tuple[str, ...]:
        """Names of the tables that the file has."""
        return (*TABLES, *self.answers)

    def table(self, name: str) -> pd.DataFrame:
        """A table by its name (`tables`: storey, floor, link, struck, base, scene, flagged, accuracy, summary, records,
        buildings), or one of `answers`.  Raises InputError: there is no such table."""
        if name not in TABLES:
            return self.answer(name).frame.copy()
        found = getattr(self, name)
        return found() if callable(found) else found

    def answer(self, name: str) -> Table:
        """One of the tables of `answers`.  Raises InputError: the file has no such table."""
        if name not in self.answers:
            command = next((each for each, tables in ANSWERS.items() if name in tables), "")
            hint = f"write it with: pound {command} STUDY" if command else f"it has: {', '.join(self.tables)}"
            raise InputError(Problem(f"has no table {name}", hint, str(self.path)))
        return read_table(self.path, name)

    def column(self, table: str, name: str) -> Column:
        """What a column of a table means, and the unit that people read it in: that of the study, otherwise SI."""
        if table in self.answers:
            return self.answer(table).columns[name]
        found = column_of(name, table)
        return replace(found, unit=self.units[name]) if name in self.units else found

    def storey(self, *columns: str) -> pd.DataFrame:
        """Storey shears [N], ductilities [-], drifts [m] with and without neighbours, and their ratios; all unless some
        are named."""
        return self._scenes(("building", "storey"), columns or _OVER[STOREY], self._there)

    def floor(self, *columns: str) -> pd.DataFrame:
        """Floor accelerations [m/s2] with and without neighbours, their ratio, displacements [m]; all unless some are
        named."""
        return self._scenes(("building", "floor"), columns or _OVER[FLOOR], self._there)

    def link(self, *columns: str) -> pd.DataFrame:
        """Per link: law, gap [m], impacts, peak force [N], closing [m], impulse [N s], contact time [s]; all unless
        some are named."""
        names = ["link_left", "link_right", "link_floor", "kind", "gap", *_OVER[LINK], "link_right_floor"]
        names = list(columns) or [*names, *(name for name in OF_COLUMNS if name in self.data)]
        if "link" not in self.data:
            import pandas as pd

            frame = pd.DataFrame(columns=[*self.axes, *PLACE, "link", *names])
        else:
            frame = self._scenes(("link",), names, lambda dims: self._over("kind", dims) != "")
        return frame.rename(columns=lambda name: str(name).removeprefix("link_"))

    def base(self) -> pd.DataFrame:
        """Per scene and building whose base moves: sway [m], rocking [rad], displacement of its isolators [m]."""
        names = [name for name in ("sway", "rocking", "isolator_displacement") if name in self.data]
        moves = lambda dims: np.any([self._over(name, dims) > 0 for name in names], axis=0)  # noqa: E731
        return self._scenes(("building",), names, moves)

    def struck(self) -> pd.DataFrame:
        """Per row of columns that a slab strikes between floors: building, storey, height of the blow over that of the
        storey [-], who strikes with which floor, shears below and above the blow [N], the larger over the columns'
        share of the yield shear [-], blows, largest force [N]. No row where no slab strikes columns.
        """
        import pandas as pd

        sides = {
            "building": ("left", "right"), "storey": ("floor", "right_floor"), "at": ("left_at", "right_at"),
            "by": ("right", "left"), "by_floor": ("right_floor", "floor"),
        }  # fmt: skip
        place, more = [*self.axes, *PLACE], ["gap", *OF_COLUMNS[2:], "impacts", "peak_force"]
        if OF_COLUMNS[0] not in self.data:
            return pd.DataFrame(columns=[*place, *sides, *more])
        link = self.link()
        link = link[link["shear_below"].notna()].reset_index(drop=True)
        is_left = link["link"].astype(str).str.contains(", left")
        found = {name: np.where(is_left, link[left], link[right]) for name, (left, right) in sides.items()}
        return link[place].assign(**found, **link[more])

    def scene(self) -> pd.DataFrame:
        """Per scene: outcome, cost, errors, effects and flags (several in one cell: one a line)."""
        return self._scene.copy()

    @cached_property
    def _scene(self) -> pd.DataFrame:
        return self._scenes((), _SCENE)

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
        return self._scenes((), _ACCURACY)

    def summary(self) -> pd.DataFrame:
        """Statistics over the records of every ratio [-] with error and sensitivity of its mean; floor i stands with
        storey i.

        Standard deviations are with n - 1; `records_used` counts the records with a V_ratio, `records_flagged` those
        whose scene carries a flag, `records_meaningless` those whose numbers mean nothing (`flagged`),
        `records_collapsed` those in whose scene a storey collapsed.
        """
        import xarray as xr

        data, places = self.data, (*self._dims, "case", "analysis")
        names = [f"{ratio}_{measure}" for ratio in RATIOS for measure in _MEASURES]
        found = {}
        for name in (*names, "V_ratio_count"):
            v = data[name].variable
            found[name] = xr.Variable([str(dim).replace("floor", "storey") for dim in v.dims], v.values)
        found["records_used"] = found.pop("V_ratio_count")
        flags, status = (data[name].transpose(*places, "record").values for name in ("flags", "status"))
        counts = counts_of_flags(flags) | {"records_collapsed": (status == COLLAPSED).sum(axis=-1)}
        found |= {name: xr.Variable(places, count) for name, count in counts.items()}
        dims = (*places, "building", "storey")
        return self._frame(list(found), dims, self._there(dims), found)

    def records(self) -> pd.DataFrame:
        """Per motion: real or stand-in, digest, scale [-], window [s], peak [m/s2], Arias [m/s] as used.

        Swept axes that change a motion come first.
        """
        dims = [dim for dim in (*self._dims, "record") if dim in self.data["record_scale"].dims]
        frame = self._frame([f"record_{name}" for name in _RECORD], dims)
        return frame.rename(columns=lambda name: str(name).removeprefix("record_"))

    @cached_property
    def buildings(self) -> pd.DataFrame:
        """Per building and storey: place from 1 at the left, mass [kg], height [m], stiffness [N/m],
        yield shear [N], fundamental period [s], base-shear ratio V/W [-] (infinite for storeys that never yield),
        thickness of the slabs [m], the code's separation from the next building [m].

        Swept axes that change a building come first.
        """
        names = ["mass", "height", "stiffness", "yield_shear", "period", "base_shear_ratio", "slab", "separation"]
        dims = [dim for dim in (*self._dims, "building", "storey") if dim in self.data["mass"].dims]
        frame = self._frame(names, dims, ~np.isnan(self._over("height", dims)))  # walls have no mass
        places = {name: place for place, name in enumerate(self.data["building"].values.tolist(), start=1)}
        frame.insert(list(frame.columns).index("storey"), "place", frame["building"].map(places))
        return frame

    # Scenes over time

    def histories(self) -> pd.DataFrame:
        """Which scenes are kept over time: swept keys, case, analysis, record, number, scene, every [s], times."""
        return self._kept.copy()

    @cached_property
    def _kept(self) -> pd.DataFrame:
        import pandas as pd

        return pd.DataFrame(kept(self.path), columns=[*self.axes, *PLACE, "number", "scene", "every", "times"])

    def history(
        self, case: str | None = None, analysis: str | None = None, record: str | None = None, **swept: Any
    ) -> History:
        """One scene over time; what tells it from the other kept ones must be given.

        Parameters
        ----------
        case, analysis, record : names
        swept : values of swept keys, e.g. `**{"cases.gap.gap": 0.05}`

        Raises
        ------
        InputError : no kept scene, or more than one, is meant
        """
        given = {"case": case, "analysis": analysis, "record": record, **swept}
        given = {key: value for key, value in given.items() if value is not None}
        places = self._kept.to_dict("records")
        meant = [place for place in places if all(_same(place.get(key), value) for key, value in given.items())]
        if len(meant) == 1:
            return History(opened(self.path, f"histories/{meant[0]['number']}").load())
        said = " of " + ", ".join(f"{key} {value}" for key, value in given.items()) if given else ""
        hint = "say which of those that Results.histories() lists"
        if not places:
            said, hint = "", "add `keep: histories` to the study and run it again; what is solved stays"
        raise InputError(Problem(f"keeps {len(meant) or 'no'} histories{said}", hint, str(self.path)))

    def first_sample(self) -> Results:
        """The same with the last swept axis cut to its first point; tables of `answers` stay whole."""
        return self.at({self._dims[-1]: 0})

    def at(self, index: Mapping[str, int]) -> Results:
        """The same with some swept axes, by their first key, cut to one point; tables of `answers` stay whole."""
        found = copy.copy(self)
        for name in ("buildings", "_scene"):  # of the whole
            found.__dict__.pop(name, None)
        found.data = self.data.isel({dim: [place] for dim, place in index.items()})
        cut = {name: index[names[0]] for names in self.swept if names[0] in index for name in names}
        found.axes = {k: [v[cut[k]]] if k in cut else v for k, v in self.axes.items()}
        return found

    # In a notebook

    @property
    def dataset(self) -> xr.Dataset:
        """Every variable of the file over the swept axes, case, analysis, record, building, storey, floor and link,
        with units and meanings; read into memory when it is first asked for."""
        return self.data.load()

    def __repr__(self) -> str:
        said = []
        for dim, words in _DIMS.items():
            names = self.data[dim].values.tolist()
            said.append(counted(len(names), *words) + (f" ({', '.join(names)})" if len(names) <= 5 else ""))
        if self.axes:
            said.append("swept " + ", ".join(f"{key} ({len(values)})" for key, values in self.axes.items()))
        failed = f" ({self.attrs['scenes_failed']} failed)" if self.attrs["scenes_failed"] else ""
        said.append(f"{counted(self.attrs['scenes'], 'scene')}{failed}")
        return f"Results({self.title!r}: {', '.join(said)}; {self.path})"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self))}</p>{self._worst().to_html(float_format='{:.3f}'.format, max_rows=40)}"

    def _worst(self) -> pd.DataFrame:
        """The largest mean ratio over the storeys and the sweep by case and building; columns analysis and ratio."""
        means = [f"{ratio}_mean" for ratio in RATIOS]
        return self.summary().pivot_table(means, ["case", "building"], "analysis", "max", sort=False)

    # Frames

    @property
    def _dims(self) -> tuple[str, ...]:
        return tuple(names[0] for names in self.swept)

    def _scenes(
        self, inner: tuple[str, ...], names: Sequence[str], wanted: Callable[[Sequence[str]], np.ndarray] | None = None
    ) -> pd.DataFrame:
        """Variables of scenes over `inner`, where there is a scene (a question need not ask for all) and as `wanted`
        says of the dimensions."""
        dims = (*self._dims, *PLACE, *inner)
        rows = self._over("status", dims) != ""
        return self._frame(names, dims, rows if wanted is None else rows & wanted(dims))

    def _over(self, name: str, dims: Sequence[str]) -> np.ndarray:
        """A variable at every row over `dims`."""
        return self._ravelled(self.data[name].variable, dims)

    def _ravelled(self, v: xr.Variable, dims: Sequence[str]) -> np.ndarray:
        return v.set_dims({dim: self.data.sizes[dim] for dim in dims}).transpose(*dims).values.ravel()

    def _there(self, dims: Sequence[str]) -> np.ndarray:
        """Which rows over `dims` stand for a storey, or its floor, that exists."""
        return np.isfinite(self._ravelled(self.data["mass"].rename(storey=dims[-1]).variable, dims))

    def _frame(
        self,
        names: Sequence[str],
        dims: Sequence[str],
        rows: np.ndarray | None = None,
        more: Mapping[str, xr.Variable] | None = None,
    ) -> pd.DataFrame:
        """Variables over `dims`, which come first as columns; an axis gives one for each of its keys.

        rows : which are wanted of all rows; every one unless given
        more : variables that the file does not have
        """
        import pandas as pd

        variables: dict[Any, xr.Variable] = dict(self.data.variables) | dict(more or {})
        sizes = [self.data.sizes[dim] for dim in dims]
        at = np.arange(math.prod(sizes)) if rows is None else np.flatnonzero(rows)
        place: dict[Any, np.ndarray] = dict(zip(dims, np.unravel_index(at, sizes), strict=True))
        keys = [key for key in self.axes if set(variables[key].dims) <= set(dims)]
        found: dict[str, Any] = {}
        for name in (*keys, *(dim for dim in dims if dim not in self._dims), *names):
            v = variables[name]
            if v.ndim == 1:  # texts that repeat are made once
                found[name] = pd.Series(v.values).array.take(place[v.dims[0]])
            else:
                found[name] = self._ravelled(v, dims)[at]
        return pd.DataFrame(found)


def _same(one: Any, other: Any) -> bool:
    """Whether two values of a key are the same, numbers to nine digits."""
    if isinstance(one, float) and isinstance(other, int | float):
        return math.isclose(one, other, rel_tol=1e-9)
    return bool(one == other)

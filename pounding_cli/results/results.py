"""A results file read back: tidy tables, swept axes first."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping, Sequence
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
from pounding_cli.results.file import groups, opened, plain_value, read_table, written
from pounding_cli.results.flags import counts_of_flags, flagged_scenes
from pounding_cli.results.histories import History, chosen_place, kept_places, read_history
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
        if missing := [
            v.name for v in VARIABLES.values() if v.always and LINK[-1] not in v.dims and v.name not in data
        ]:
            raise ValueError(f"no {', '.join(missing)}")
        self.attrs = {str(name): plain_value(value) for name, value in data.attrs.items() if name != "coordinates"}
        self.title, self.workflow = str(self.attrs["title"]), str(self.attrs["workflow"])
        there = groups(self.path, "answer")
        self.answers = tuple(name for name in json.loads(self.attrs.get("answers", "[]")) if name in there)
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

    def storey(self) -> pd.DataFrame:
        """Storey shears [N], ductilities [-], drifts [m] with and without neighbours, and their ratios."""
        return self._levels("storey", _OVER[STOREY])

    def floor(self) -> pd.DataFrame:
        """Floor accelerations [m/s2] with and without neighbours, their ratio, displacements [m]."""
        return self._levels("floor", _OVER[FLOOR])

    def link(self) -> pd.DataFrame:
        """Per link: law, gap [m], impacts, peak force [N], closing [m], impulse [N s], contact time [s]."""
        facts = ["link_left", "link_right", "link_floor"]
        names = ["kind", "gap", *_OVER[LINK], "link_right_floor", *(name for name in OF_COLUMNS if name in self.data)]
        if "link" not in self.data:
            import pandas as pd

            columns = [*self.axes, *PLACE, "link", *facts, *names]
            return pd.DataFrame({name.removeprefix("link_"): [] for name in columns})
        frame = self._frame([*facts, *names, "status"], (*self._dims, *PLACE, "link"))
        frame.columns = [str(name).removeprefix("link_") for name in frame]
        return frame[(frame["kind"] != "") & (frame["status"] != "")].drop(columns="status").reset_index(drop=True)

    def base(self) -> pd.DataFrame:
        """Per scene and building whose base moves: sway [m], rocking [rad], displacement of its isolators [m]."""
        names = ["sway", "rocking", *(["isolator_displacement"] if "isolator_displacement" in self.data else [])]
        frame = self._solved(self._frame([*names, "status"], (*self._dims, *PLACE, "building")))
        return frame[(frame[names] > 0).any(axis=1)].drop(columns="status").reset_index(drop=True)

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

    def scene(self) -> pd.DataFrame:
        """Per scene: outcome, cost, errors, effects and flags (several in one cell: one a line)."""
        return self._scene.copy()

    @cached_property
    def _scene(self) -> pd.DataFrame:
        return self._solved(self._frame(_SCENE, (*self._dims, *PLACE)))

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
        return self._solved(self._frame(_ACCURACY, (*self._dims, *PLACE)))

    def summary(self) -> pd.DataFrame:
        """Statistics over the records of every ratio [-] with error and sensitivity of its mean; floor i stands with
        storey i.

        Standard deviations are with n - 1; `records_used` counts the records with a V_ratio, `records_flagged` those
        whose scene carries a flag, `records_meaningless` those whose numbers mean nothing (`flagged`),
        `records_collapsed` those in whose scene a storey collapsed.
        """
        import xarray as xr

        data, places = self.data, (*self._dims, "case", "analysis")
        names = {f"{ratio}_{measure}": f"{ratio}_{measure}" for ratio in RATIOS for measure in _MEASURES}
        found = {}
        for name, source in (names | {"records_used": "V_ratio_count"}).items():
            v = data[source].variable
            found[name] = xr.Variable([str(dim).replace("floor", "storey") for dim in v.dims], v.values)
        flags, status = (data[name].transpose(*places, "record").values for name in ("flags", "status"))
        counts = counts_of_flags(flags) | {"records_collapsed": (status == COLLAPSED).sum(axis=-1)}
        found |= {name: xr.Variable(places, count) for name, count in counts.items()}
        dims = (*places, "building", "storey")
        return self._frame(list(found), dims, found)[self._there(dims)].reset_index(drop=True)

    def records(self) -> pd.DataFrame:
        """Per motion: real or stand-in, digest, scale [-], window [s], peak [m/s2], Arias [m/s] as used.

        Swept axes that change a motion come first.
        """
        return self._records.copy()

    @cached_property
    def _records(self) -> pd.DataFrame:
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
        frame = self._frame(names, dims)
        places = {name: place for place, name in enumerate(self.data["building"].values.tolist(), start=1)}
        frame.insert(list(frame.columns).index("storey"), "place", frame["building"].map(places))
        return frame[frame["height"].notna()].reset_index(drop=True)

    # Scenes over time

    def histories(self) -> pd.DataFrame:
        """Which scenes are kept over time: swept keys, case, analysis, record, number, scene, every [s], times."""
        import pandas as pd

        names = (*self.axes, *PLACE, "number", "scene", "every", "times")
        return pd.DataFrame({name: [row[name] for row in self._kept] for name in names})

    @cached_property
    def _kept(self) -> list[dict[str, Any]]:
        return kept_places(self.path)

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
        wanted = {k: v for k, v in given.items() if v is not None}
        return read_history(self.path, chosen_place(self._kept, wanted, str(self.path))["number"])

    def first_sample(self) -> Results:
        """The same with the last swept axis cut to its first point; tables of `answers` stay whole."""
        return self.at({self._dims[-1]: 0})

    def at(self, index: Mapping[str, int]) -> Results:
        """The same with some swept axes, by their first key, cut to one point; tables of `answers` stay whole."""
        found = copy.copy(self)
        for kept in ("buildings", "_scene", "_records"):  # of the whole
            found.__dict__.pop(kept, None)
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

    def _levels(self, level: str, names: list[str]) -> pd.DataFrame:
        dims = (*self._dims, *PLACE, "building", level)
        frame = self._frame([*names, "status"], dims)
        there = self._there(dims) & (frame["status"] != "").to_numpy()
        return frame[there].drop(columns="status").reset_index(drop=True)

    def _solved(self, frame: pd.DataFrame) -> pd.DataFrame:
        """The rows that have a scene: a question need not ask for all."""
        return frame[frame["status"] != ""].reset_index(drop=True)

    def _there(self, dims: Sequence[str]) -> np.ndarray:
        """Which rows over `dims` stand for a storey, or its floor, that exists."""
        mass = self.data["mass"].rename(storey=dims[-1]).variable
        sizes = {dim: self.data.sizes[dim] for dim in dims}
        return np.isfinite(mass.set_dims(sizes).transpose(*dims).values).ravel()

    def _frame(
        self, names: Sequence[str], dims: Sequence[str], more: Mapping[str, xr.Variable] | None = None
    ) -> pd.DataFrame:
        """Variables over `dims`, which come first as columns; an axis gives one for each of its keys.

        more : variables that the file does not have
        """
        import pandas as pd

        variables: dict[Any, xr.Variable] = dict(self.data.variables) | dict(more or {})
        sizes = {dim: self.data.sizes[dim] for dim in dims}
        keys = [key for key in self.axes if set(variables[key].dims) <= set(dims)]
        columns = (*keys, *(dim for dim in dims if dim not in self._dims), *names)
        return pd.DataFrame({name: variables[name].set_dims(sizes).transpose(*dims).values.ravel() for name in columns})

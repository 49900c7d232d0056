"""A results file read back: tidy tables, swept axes first."""

from __future__ import annotations

import copy
import json
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit
from pounding_cli.records.suite import SpectrumMatch
from pounding_cli.solve.histories import History
from pounding_cli.solve.response import COLLAPSED
from pounding_cli.store.answers import Answer, largest, read_table, table_names
from pounding_cli.store.columns import meaning
from pounding_cli.store.files import opened
from pounding_cli.store.flagged import counts_of_flags, flagged_scenes
from pounding_cli.store.histories import GROUP, chosen_place, kept_places, read_history
from pounding_cli.store.solutions import stored_methods
from pounding_cli.store.structure import strings
from pounding_cli.store.swept import written
from pounding_cli.texts import plain, plain_tree
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
    WRITTEN,
)
from pounding_cli.workflows import WORKFLOWS

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
    "status", "method", "accuracy", "time_step", "error_estimate", "sensitivity", "energy_residual",
    "steps", "events", "orders", "seconds",
)  # fmt: skip
_RECORD = ("source", "digest", "scale", "window", "pga", "arias")
_STUDY: dict[str, type] = {"buildings": dict, "cases": dict, "group": list, "records": dict}
"""What a resolved study is made of."""
_MEASURES = ("mean", "mean_error", "mean_sensitivity", "std", "min", "max")


def open_results(path: str | Path) -> Results:
    """The results of a study.

    Raises
    ------
    InputError : no such file, not a results file of this program, or of another format version
    """
    return Results(Path(path))


class Results:
    """The tables of one results file (docs/results.md), each read when asked for.

    Attributes
    ----------
    path : the file
    title, study_text : the study as written
    workflow : the command that wrote it, a key of WORKFLOWS
    answers : the tables that this command added
    resolved, resolved_text : the study with every default filled in (SI), as a mapping and as JSON
    axes : swept key -> its values (SI); keys of one axis (zipped) have the same length
    units : column -> the unit the study wrote it in, to show values to people: swept keys, gaps, accelerations
    warnings : what `pound check` says of the study: what is unlikely, and floors that meet nothing
    attrs : the file's own facts (accuracy, method, counts, times) and the software it was made with
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._kept: tuple[object, list[dict[str, Any]]] | None = None
        self._answers: dict[str, Answer] = {}
        self._cut = ""
        with opened(path) as file:
            software = {f"software_{name}": _plain(value) for name, value in file["software"].attrs.items()}
            self.attrs: dict[str, Any] = {
                name: _plain(value) for name, value in file.attrs.items() if name != "coordinates"
            } | software
            self.title = str(self.attrs["title"])
            self.workflow = str(self.attrs.get("workflow", "run"))
            if self.workflow not in WORKFLOWS:
                what = f"holds the answer of another program's `pound {self.workflow}`"
                raise InputError(Problem(what, f"this one has: {', '.join(WORKFLOWS)}"))
            self.answers = table_names(file)
            self.study_text: str = strings(file["study/text"])
            self.resolved_text: str = strings(file["study/resolved"])
            warnings = strings(file["study/warnings"]) if "warnings" in file["study"] else "[]"
            self.warnings = tuple(Problem(**each) for each in json.loads(warnings))
            self._swept: list[list[str]] = json.loads(self.attrs["swept"])
            self.axes: dict[str, list[Any]] = {
                name: self._values(file[name]).tolist() for names in self._swept for name in names
            }
            self.units: dict[str, Unit] = {name: written(file[name]) for name in self.axes}
            self.units |= {name.removeprefix("record_"): written(file[name]) for name in WRITTEN if name in file}

    @cached_property
    def resolved(self) -> dict[str, Any]:
        """The study with every default filled in, SI."""
        try:
            found = plain_tree(json.loads(self.resolved_text))
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict) or not all(isinstance(found.get(k, kind()), kind) for k, kind in _STUDY.items()):
            raise InputError(Problem("its study/resolved is no study", "run the study again", str(self.path)))
        return found

    def axis_label(self, key: str) -> str:
        """A swept key with the unit the study wrote it in: "cases.gap.gap [cm]"."""
        return self.units[key].label(key)

    def value_label(self, key: str, value: Any) -> str:
        """A value of a swept key (SI, as in the tables) as people read it: "5 cm"; texts as they are."""
        return self.units[key].text(value)

    @cached_property
    def spectrum_match(self) -> SpectrumMatch | None:
        """The spectra of the motions as used against the target they were scaled to; None where there is none."""
        with opened(self.path) as file:
            if "spectrum" not in file["study"]:
                return None
            text = strings(file["study/spectrum"])
        try:
            return SpectrumMatch.of_dict(json.loads(text))
        except (ValueError, KeyError, TypeError, AttributeError):
            problem = Problem("its study/spectrum is no match of spectra", "run the study again", str(self.path))
            raise InputError(problem) from None

    @cached_property
    def methods(self) -> tuple[str, ...]:
        """The methods that solved the scenes, buildings alone included: keys of `solve.METHODS`."""
        with opened(self.path) as file:
            return stored_methods(file)

    def storey(self) -> pd.DataFrame:
        """Storey shears [N], ductilities [-], drifts [m] with and without neighbours, and their ratios."""
        return self._levels("storey", _STOREY)

    def floor(self) -> pd.DataFrame:
        """Floor accelerations [m/s2] with and without neighbours, their ratio, displacements [m]."""
        return self._levels("floor", _FLOOR)

    def link(self) -> pd.DataFrame:
        """Per link: law, gap [m], impacts, peak force [N], closing [m], impulse [N s], contact time [s]."""
        with opened(self.path) as file:
            if "link" not in file:
                return _frame({name: [] for name in (*self.axes, *PLACE, "link", *_LINK_FACTS, *_LINK, "right_floor")})
            dims = (*self._dims, *PLACE, "link")
            shape = self._shape(file["impacts"])
            facts = {name: self._spread(self._values(file[f"link_{name}"]), shape) for name in _LINK_FACTS}
            columns = self._index(file, dims, shape) | facts
            columns |= {name: self._by_scene(file, name, shape).ravel() for name in _held(file, _LINK)}
            columns["right_floor"] = self._spread(self._values(file["link_right_floor"]), shape)
            solved = self._spread(self._solved(file)[..., None], shape)
            for name in OF_COLUMNS if OF_COLUMNS[0] in file else ():
                columns[name] = self._by_scene(file, name, shape).ravel()
        frame = _frame(columns)
        return frame[(frame["kind"] != "") & solved].reset_index(drop=True)

    def _by_scene(self, file: h5py.File, name: str, shape: tuple[int, ...]) -> np.ndarray:
        """A variable of links; one of LINKS is the same for every analysis and record."""
        array = self._values(file[name])
        if name not in _FACTS_OF_LINKS:
            return array
        at = len(self._dims) + 1
        return np.broadcast_to(np.expand_dims(array, (at, at + 1)), shape)

    def scene(self) -> pd.DataFrame:
        """Per scene: outcome, cost, errors, effects and flags (several in one cell: one a line)."""
        with opened(self.path) as file:
            shape = self._shape(file["status"])
            columns = self._index(file, (*self._dims, *PLACE), shape)
            columns |= {name: self._asked(file, name).ravel() for name in _SCENE}
        frame = _frame(columns)
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
        """Per scene what its accuracy cost: asked and estimated error [-], sensitivity [-], energy left open [-],
        steps, events, Taylor orders, seconds in the solver.
        """
        with opened(self.path) as file:
            shape = self._shape(file["status"])
            columns = self._index(file, (*self._dims, *PLACE), shape)
            columns |= {name: self._asked(file, name).ravel() for name in _ACCURACY}
        frame = _frame(columns)
        return frame[frame["status"] != ""].reset_index(drop=True)

    def _asked(self, file: h5py.File, name: str) -> np.ndarray:
        """A variable of SCENES, as `FORMERLY` where the file is of before, NaN where it has none."""
        if not VARIABLES[name].always and name not in file:
            return np.full(file["status"].shape, np.nan)
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
        with opened(self.path) as file:
            dims = (*self._dims, "case", "analysis", "building", "storey")
            shape = self._shape(file["V_ratio_mean"])
            columns = self._index(file, dims, shape)
            for ratio in RATIOS:
                for measure in _MEASURES:
                    columns[f"{ratio}_{measure}"] = self._values(file[f"{ratio}_{measure}"]).ravel()
            columns["records_used"] = self._values(file["V_ratio_count"]).ravel()
            collapsed = (self._values(file["status"]) == COLLAPSED).sum(axis=-1)  # fault: collapses-counted
            counts = counts_of_flags(self._values(file["flags"])) | {"records_collapsed": collapsed}
            for name, count in counts.items():
                columns[name] = self._spread(count[..., None, None], shape)
            there = self._there(file, 2)
        return _frame(columns)[there].reset_index(drop=True)

    def records(self) -> pd.DataFrame:
        """Per motion: real or stand-in, digest, scale [-], window [s], peak [m/s2], Arias [m/s] as used.

        Swept axes that change a motion come first.
        """
        with opened(self.path) as file:
            scale = file["record_scale"]
            columns = self._index(file, tuple(_dimensions(scale)), self._shape(scale))
            return _frame(columns | {name: self._values(file[f"record_{name}"]).ravel() for name in _RECORD})

    def histories(self) -> pd.DataFrame:
        """Which scenes are kept over time: swept keys, case, analysis, record, number, scene, every [s], times."""
        names = (*self.axes, *PLACE, "number", "scene", "every", "times")
        return _frame({name: [row[name] for row in self._places()] for name in names})

    def _places(self) -> list[dict[str, Any]]:
        """`kept_places`, looked for again when the file has changed: whoever reads all histories asks once for each."""
        found = self.path.stat() if self.path.exists() else None  # `opened` says what is wrong
        state = found and (found.st_ino, found.st_size, found.st_mtime_ns)
        if self._kept is None or self._kept[0] != state:
            with opened(self.path) as file:
                self._kept = state, kept_places(file)
        return self._kept[1]

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
        number = chosen_place(self._places(), wanted, str(self.path))["number"]
        with opened(self.path) as file:
            return read_history(file[f"{GROUP}/{number}"])

    @cached_property
    def buildings(self) -> pd.DataFrame:
        """Per building and storey: place from 1 at the left, mass [kg], height [m], stiffness [N/m],
        yield shear [N], fundamental period [s], base-shear ratio V/W [-] (infinite for storeys that never yield),
        thickness of the slabs [m] (not in files of before), the code's separation from the next building [m].

        Swept axes that change a building come first.
        """
        with opened(self.path) as file:
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
        frame = _frame(columns)
        return frame[frame["mass"].notna()].reset_index(drop=True)

    def table(self, name: str) -> pd.DataFrame:
        """A table by its name: storey, floor, link, scene, flagged, accuracy, summary, records, buildings, or one of
        `answers`."""
        if name in self.answers or any(name in workflow.shows for workflow in WORKFLOWS.values()):
            return self.answer(name).frame.copy()
        found = getattr(self, name)
        return found() if callable(found) else found

    def answer(self, name: str) -> Answer:
        """One of the tables of `answers`.

        Raises
        ------
        InputError : the file has no such table
        """
        if name not in self._answers:
            self._answers[name] = self.answer_head(name)
        return self._answers[name]

    def answer_head(self, name: str, rows: int | None = None) -> Answer:
        """The first rows of one of the tables of `answers`, which may be long.  Raises as `answer`."""
        with opened(self.path) as file:
            if name not in table_names(file):
                hint = f"write it with: pound {name} STUDY -o FILE.h5"
                raise InputError(Problem(f"has no table {name}", hint, str(self.path)))
            return read_table(file, name, rows)

    def largest_in_answer(self, name: str, column: str) -> float:
        """The largest number in a column of one of the tables of `answers`; NaN where it has none."""
        with opened(self.path) as file:
            return largest(file, name, column)

    def meaning(self, table: str, column: str) -> tuple[str, str]:
        """Unit (SI; "1" for a pure number, "" for text and swept keys) and meaning of a column of a table."""
        return self.answer(table).meanings[column] if table in self.answers else meaning(table, column)

    def first_sample(self) -> Results:
        """The same with the last swept axis cut to its first point; tables of `answers` stay whole."""
        found = copy.copy(self)
        found.__dict__.pop("buildings", None)
        found._cut = self._dims[-1]
        found.axes = {k: v[:1] if k in self._swept[-1] else v for k, v in self.axes.items()}
        return found

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
        return tuple(names[0] for names in self._swept)

    def _levels(self, level: str, names: tuple[str, ...]) -> pd.DataFrame:
        with opened(self.path) as file:
            shape = self._shape(file[names[0]])
            columns = self._index(file, (*self._dims, *PLACE, "building", level), shape)
            columns |= {name: self._values(file[name]).ravel() for name in _held(file, names)}
            there = self._there(file, 3) & self._spread(self._solved(file)[..., None, None], shape)
        return _frame(columns)[there].reset_index(drop=True)

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
        zipped = {names[0]: names for names in self._swept}
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


def _plain(value: Any) -> Any:
    value = value.item() if isinstance(value, np.generic) else value
    return plain(value) if isinstance(value, str) else value


def _frame(columns: dict[str, Any]) -> pd.DataFrame:
    import pandas as pd  # here, so that `pound run` on a finished study need not load it

    return pd.DataFrame(columns)

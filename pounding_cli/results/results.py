"""A results file read back: tidy tables, swept axes first."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.laws import link_symbol
from pounding_cli.laws.apart import Apart
from pounding_cli.laws.formula import WRITTEN_LAWS
from pounding_cli.laws.law import LinkLaw
from pounding_cli.numbers import NOTHING, Unit, count_histories, format_number, pluralize
from pounding_cli.results.arrays import Array, ResultArrays
from pounding_cli.results.columns import TABLES, column_of
from pounding_cli.results.file import list_histories, open_arrays, plain_value, read_table, read_unit
from pounding_cli.results.flags import flagged_scenes, is_void
from pounding_cli.results.histories import History
from pounding_cli.solver.response import COLLAPSED
from pounding_cli.tables import Column, Table
from pounding_cli.texts import escape_controls, escape_controls_in_tree
from pounding_cli.variables import (
    COLUMN_VARIABLES,
    DISPLAY_QUANTITIES,
    FLOOR_DIMS,
    INCLINED_VARIABLES,
    LINE_VARIABLES,
    LINK_DIMS,
    RATIO_VARIABLES,
    RESPONSE_VARIABLES,
    SCENE_DIMS,
    SCENE_VARIABLES,
    STOREY_DIMS,
    VARIABLES,
)

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from pounding_cli.records.scaling import SpectrumMatch

_OVER = {
    dims: [v.name for v in RESPONSE_VARIABLES if v.dims == dims and v.name not in COLUMN_VARIABLES]
    for dims in (STOREY_DIMS, FLOOR_DIMS, LINK_DIMS)
}
_SCENE = [v.name for v in SCENE_VARIABLES if v.name not in ("orders", "scene")]
_ACCURACY = [
    "status", "method", "accuracy", "time_step", "error_estimate", "sensitivity", "energy_residual", "steps", "events",
    "orders", "seconds",
]  # fmt: skip
_RECORD = ["source", "digest", "scale", "window", "pga", "arias"]
_BUILDING = ["mass", "height", "stiffness", "yield_shear", "period", "base_shear_ratio", "slab", "separation"]
_PLAN = ["plan_low", "plan_high", "plan_centre", "stiffness_centre", "inertia", "torsional_stiffness"]
_LINE = ["line_street", "line_x", *(v.name for v in LINE_VARIABLES), "line_stiffness", "line_yield_shear"]
_BASE = ["sway", "rocking", "isolator_displacement"]
_MEASURES = ("mean", "mean_error", "mean_sensitivity", "std", "min", "max")

RowFilter = Mapping[str, Callable[[Any], Any]]
"""Variable -> function of its values that tells which rows are wanted."""

_SOLVED: RowFilter = {"status": lambda status: status != ""}
"""A question need not ask for all scenes."""


class ResultTables:
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
    arrays : all of its variables, read as they are asked for
    """

    def __init__(self, path: Path, arrays: ResultArrays | None = None, answers: Iterable[Table] | None = None) -> None:
        """Open a results file, or take what is written to it.

        arrays, answers : what is written, instead of what the file holds
        """
        self.path = Path(path)
        self.arrays = open_arrays(self.path) if arrays is None else arrays
        self._answers = {table.name: table for table in answers or ()}
        try:
            self._read_attributes()
        except (KeyError, ValueError, TypeError, AttributeError) as error:
            what = f"does not hold what results hold ({error})"
            hint = "give the file that pound run wrote, or run the study again"
            raise InputError(Issue((), what, hint, file=str(self.path))) from error

    def _read_attributes(self) -> None:
        arrays = self.arrays
        needed = {v.name for v in VARIABLES.values() if v.always and LINK_DIMS[-1] not in v.dims}
        if missing := sorted(name for name in needed if name not in arrays):
            raise ValueError(f"no {', '.join(missing)}")
        self.attrs = {str(name): plain_value(value) for name, value in arrays.attrs.items()}
        self.title = str(self.attrs["title"])
        self.workflow = str(self.attrs.get("workflow", "run"))
        self.answers = tuple(json.loads(self.attrs.get("answers", "[]")))
        self.study_text = str(arrays["study_text"].values.item())
        self.resolved_text = str(arrays["study_resolved"].values.item())
        self.warnings = tuple(Issue((), **each) for each in json.loads(str(arrays["study_warnings"].values.item())))
        self.assumed_heights: tuple[str, ...] = tuple(map(escape_controls, json.loads(self.attrs["assumed_heights"])))
        self.methods: tuple[str, ...] = tuple(json.loads(self.attrs["methods"]))
        self.swept: list[list[str]] = json.loads(self.attrs["swept"])
        keys = [name for names in self.swept for name in names]
        self.axes: dict[str, list[Any]] = {name: list(map(plain_value, arrays[name].values.tolist())) for name in keys}
        self.units: dict[str, Unit] = {name: read_unit(arrays[name].attrs) for name in keys}
        self.units |= {
            name.removeprefix("record_"): read_unit(arrays[name].attrs) for name in DISPLAY_QUANTITIES if name in arrays
        }

    @cached_property
    def study_data(self) -> dict[str, Any]:
        """The study with every default filled in, SI."""
        return escape_controls_in_tree(json.loads(self.resolved_text))

    @property
    def accepted(self) -> frozenset[str]:
        """The codes of the notes that the study silences."""
        return frozenset(self.study_data.get("accept") or ())

    @cached_property
    def walls(self) -> tuple[str, ...]:
        """The walls of the group, by place."""
        places = zip(self.study_data["places"], self.study_data["group"], strict=True)
        return tuple(place for place, name in places if self.study_data["buildings"][name].get("wall"))

    def value_label(self, key: str, value: Any) -> str:
        """Return a value of a swept key (SI, as in the tables) as people read it: "5 cm"; texts as they are."""
        return self.units[key].text(value)

    def link_symbol(self, kind: str) -> str:
        """Return the symbol of a law of links in pictures (`LinkLaw.symbol`), also of a law that the study writes.

        kind : name of the law, as the table of links has it
        """
        written = (self.study_data.get("laws") or {}).get(kind)
        return WRITTEN_LAWS[written["acts"]].symbol if written else link_symbol(kind)

    def is_contact(self, kind: str) -> bool:
        """Return whether floors strike each other across links of a law."""
        return kind not in ("", Apart.name) and self.link_symbol(kind) == LinkLaw.symbol

    @cached_property
    def spectrum_match(self) -> SpectrumMatch | None:
        """The spectra of the motions as used against the target they were scaled to; None where there is none."""
        if "study_spectrum" not in self.arrays:
            return None
        from pydantic import TypeAdapter  # here: few studies scale to a spectrum

        from pounding_cli.records.scaling import SpectrumMatch

        return TypeAdapter(SpectrumMatch).validate_json(str(self.arrays["study_spectrum"].values.item()))

    @cached_property
    def data(self) -> xr.Dataset:
        """All variables as xarray has them, read as they are asked for."""
        return self.arrays.to_dataset()

    def values(self, name: str) -> np.ndarray:
        """Return the values of a variable, over its dimensions."""
        return self.arrays[name].values

    def names(self, dim: str) -> list[str]:
        """Return what there is along a dimension (case, analysis, record, building), in the order of the file."""
        return list(map(str, self.arrays[dim].values.tolist()))

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
        table = getattr(self, name)
        return table() if callable(table) else table

    def answer(self, name: str) -> Table:
        """One of the tables of `answers`.  Raises InputError: the file has no such table."""
        if name not in self.answers:
            raise InputError(
                Issue((), f"has no table {name}", f"it has: {', '.join(self.tables)}", file=str(self.path))
            )
        if name not in self._answers:
            self._answers[name] = read_table(self.path, name)
        return self._answers[name]

    def column(self, table: str, name: str) -> Column:
        """Return what a column of a table means, and the unit that people read it in."""
        if table in self.answers:
            return self.answer(table).column(name)
        return column_of(name, self.units, table)

    def storey(self, *columns: str) -> pd.DataFrame:
        """Storey shears [N], ductilities [-], drifts [m] with and without neighbours, and their ratios; all unless some
        are named."""
        return self._build_frame(
            columns or self._list_kept(_OVER[STOREY_DIMS]),
            (*SCENE_DIMS, "building", "storey"),
            {"mass": np.isfinite, **_SOLVED},
        )

    def floor(self, *columns: str) -> pd.DataFrame:
        """Floor accelerations [m/s2] with and without neighbours, their ratio, displacements [m]; all unless some are
        named."""
        return self._build_frame(
            columns or self._list_kept(_OVER[FLOOR_DIMS]),
            (*SCENE_DIMS, "building", "floor"),
            {"mass": np.isfinite, **_SOLVED},
        )

    def line(self, *columns: str) -> pd.DataFrame:
        """Shear [N], ductility [-] and drift [m] of every frame line of buildings with a plan, with and without
        neighbours, their ratios, and its place, stiffness and yield shear; all unless some are named. No row where no
        building has a plan."""
        names = [f"line_{name}" for name in columns] or _LINE
        places = (*SCENE_DIMS, "building", "storey", "line")
        if "line" not in self.arrays:
            import pandas as pd

            return pd.DataFrame(columns=[*self.axes, *places, *(name.removeprefix("line_") for name in names)])
        frame = self._build_frame(names, places, {"line_stiffness": np.isfinite, **_SOLVED})
        return frame.rename(columns=lambda name: str(name).removeprefix("line_"))

    def link(self, *columns: str) -> pd.DataFrame:
        """Per link: law, gap [m], impacts, peak force [N], closing [m], impulse [N s], contact time [s]; all unless
        some are named. Where floors twist, street: the place of its left end along it [m]."""
        names = ["link_left", "link_right", "link_floor", "kind", "gap", *_OVER[LINK_DIMS], "link_right_floor"]
        names[3:3] = self._list_kept(["street"])
        further = (*COLUMN_VARIABLES, *INCLINED_VARIABLES, "left_arm", "right_arm")
        names = list(columns) or [*names, *self._list_kept(further)]
        if "link" not in self.arrays:
            import pandas as pd

            return pd.DataFrame(columns=[*self.axes, *SCENE_DIMS, "link", *(n.removeprefix("link_") for n in names)])
        frame = self._build_frame(names, (*SCENE_DIMS, "link"), {"kind": lambda kind: kind != "", **_SOLVED})
        return frame.rename(columns=lambda name: str(name).removeprefix("link_"))

    def base(self) -> pd.DataFrame:
        """Per scene and building whose base moves: sway [m], rocking [rad], displacement of its isolators [m]."""
        names = self._list_kept(_BASE)
        frame = self._build_frame(names, (*SCENE_DIMS, "building"), _SOLVED)
        return frame[(frame[names] > 0).any(axis=1)].reset_index(drop=True)

    def struck(self) -> pd.DataFrame:
        """Per row of columns that a link ends on between floors, such as the blow of a slab: building, storey, height
        of the end over that of the storey [-], building and floor of the other end, law of the link, gap [m], shears
        below and above the end [N], the larger over the columns' share of the yield shear [-], blows, largest force
        [N], time with a force [s]; where floors twist the place of the link along the street [m], as `link` has it. No
        row where no link ends on columns.
        """
        sides = {
            "building": ("left", "right"), "storey": ("floor", "right_floor"), "at": ("left_at", "right_at"),
            "by": ("right", "left"), "by_floor": ("right_floor", "floor"),
        }  # fmt: skip
        link = self.link()
        link = link.reindex(columns=[*dict.fromkeys([*link.columns, *COLUMN_VARIABLES])])
        link = link[link["shear_below"].notna()].reset_index(drop=True)
        is_left = link["left_at"] < 1.0
        by_side = {name: link[left].where(is_left, link[right]) for name, (left, right) in sides.items()}
        names = ["gap", *COLUMN_VARIABLES[2:], "impacts", "peak_force", "kind", "contact_time"]
        frame = link[[*self.axes, *SCENE_DIMS]].assign(**by_side, **link[names])
        for name in self._list_kept(["street"]):
            frame.insert(list(frame.columns).index("at") + 1, name, link[name])
        return frame

    def struck_links(self) -> pd.DataFrame:
        """Swept keys, case, analysis, record, law and impacts of every link across which floors struck."""
        link = self.link("kind", "impacts")
        return link[link["kind"].map(self.is_contact).astype(bool) & (link["impacts"] > 0)]

    def scene(self) -> pd.DataFrame:
        """Return per scene: outcome, cost, errors, effects and flags (several in one cell: one a line)."""
        return self._scene.copy()

    @cached_property
    def _scene(self) -> pd.DataFrame:
        return self._build_frame(_SCENE, SCENE_DIMS, _SOLVED)

    def flagged(self) -> pd.DataFrame:
        """Return which scenes are flagged and why; no row where nothing is.

        Columns: swept keys, case, analysis, record, code, flag, detail, severity, meaningless.

        code : of its entry in the catalogue of notes (`pound explain CODE`); flag : its title, what is flagged;
        detail : where and by how much; severity : larger where a flag of its code is worse, NaN where its code does not
        compare; meaningless : whether the flag takes the meaning from all numbers of its scene (a connector that closes
        more than its gap), or is worth knowing beside them.
        `flag_groups_of(results.scene())` sums them up by case and analysis.
        """
        return flagged_scenes(self.scene())

    def accuracy(self) -> pd.DataFrame:
        """Return per scene what its accuracy cost: asked and estimated error [-], sensitivity [-], how both were found,
        energy left open [-], steps, events, Taylor orders, seconds in the solver.
        """
        return self._build_frame(_ACCURACY, SCENE_DIMS, _SOLVED)

    def summary(self) -> pd.DataFrame:
        """Statistics over the records of every ratio [-] with error and sensitivity of its mean; floor i stands with
        storey i.

        Standard deviations are with n - 1; `records_used` counts the records with a V_ratio, `records_flagged` those
        whose scene carries a flag, `records_meaningless` those whose numbers mean nothing (`flagged`),
        `records_collapsed` those in which a storey collapsed, of the building or of one that links join to it.
        """
        names = [*(f"{ratio}_{measure}" for ratio in RATIO_VARIABLES for measure in _MEASURES), "V_ratio_count"]
        frame = self._build_frame(names, ("case", "analysis", "building", "storey"), {"mass": np.isfinite})
        place = [*self.axes, "case", "analysis"]
        scenes = self._build_frame(["flags"], SCENE_DIMS)
        counts = scenes[place].assign(
            records_flagged=scenes["flags"] != "",
            records_meaningless=scenes["flags"].map(is_void),
        )
        counts = counts.groupby(place, sort=False).sum()
        collapses = self._count_collapses()
        frame = frame.rename(columns={"V_ratio_count": "records_used"}).merge(counts, on=place)
        return frame.merge(collapses, on=[*place, "building"])

    def _count_collapses(self) -> pd.DataFrame:
        """Return by building the records in which a collapse ended its motion, in the column `records_collapsed`."""
        place = [*self.axes, "case", "analysis", "building"]
        buildings = self._build_frame(["sway"], (*SCENE_DIMS, "building"))
        buildings = buildings.merge(self._build_frame(["status"], SCENE_DIMS))
        is_ended = (buildings["status"] == COLLAPSED) & buildings["sway"].isna()
        return buildings[place].assign(records_collapsed=is_ended).groupby(place, sort=False).sum().reset_index()

    def records(self) -> pd.DataFrame:
        """Return per motion: real or stand-in, digest, scale [-], window [s], peak [m/s2], Arias [m/s] as used.

        Swept axes that change a motion come first.
        """
        frame = self._build_frame([f"record_{name}" for name in _RECORD], ("record",))
        return frame.rename(columns=lambda name: str(name).removeprefix("record_"))

    @cached_property
    def buildings(self) -> pd.DataFrame:
        """Per building and storey: place from 1 at the left, mass [kg], height [m], stiffness [N/m],
        yield shear [N], fundamental period [s], base-shear ratio V/W [-] (infinite for storeys that never yield),
        thickness of the slabs [m], the code's separation from the next building [m]; where a building has a plan, its
        edges along the street, centre of mass and centre of stiffness [m], rotary inertia [kg m2] and torsional
        stiffness beside its frame lines [N m].

        Swept axes that change a building come first.
        """
        names = [*_BUILDING, *self._list_kept(_PLAN)]
        frame = self._build_frame(names, ("building", "storey"), {"height": np.isfinite})  # walls have no mass
        places = {name: place for place, name in enumerate(self.names("building"), start=1)}
        frame.insert(list(frame.columns).index("storey"), "place", frame["building"].map(places))
        return frame

    # Scenes over time

    def histories(self) -> pd.DataFrame:
        """Return which scenes are kept over time.

        Columns: swept keys, case, analysis, record, number, scene, every [s], times.
        """
        import pandas as pd

        return pd.DataFrame(
            list_histories(self.path), columns=[*self.axes, *SCENE_DIMS, "number", "scene", "every", "times"]
        )

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
        conditions = {"case": case, "analysis": analysis, "record": record, **swept}
        conditions = {key: value for key, value in conditions.items() if value is not None}
        histories = list_histories(self.path)
        matches = [
            history
            for history in histories
            if all(_is_same_value(history.get(key), value) for key, value in conditions.items())
        ]
        if len(matches) == 1:
            return History(open_arrays(self.path, f"histories/{matches[0]['number']}").to_dataset().load())
        where = " of " + ", ".join(f"{key} {value}" for key, value in conditions.items()) if conditions else ""
        hint = "say which of those that Results.histories() lists"
        if not histories:
            where = ""
            hint = "add `keep: histories` to the study and run it again; what is solved stays"
        raise InputError(Issue((), f"keeps {len(matches) or 'no'} histories{where}", hint, file=str(self.path)))

    def first_sample(self) -> ResultTables:
        """Return the same with the last swept axis cut to its first point; tables of `answers` stay whole."""
        return self.cut({self.swept[-1][0]: 0})

    def cut(self, index: Mapping[str, int]) -> ResultTables:
        """Return the same with some swept axes cut to one point, by their first key.

        Tables of `answers` stay whole.
        """
        part = copy.copy(self)
        for name in ("buildings", "_scene", "data"):  # of the whole
            part.__dict__.pop(name, None)
        part.arrays = self.arrays.cut(index)
        places = {name: index[names[0]] for names in self.swept if names[0] in index for name in names}
        part.axes = {key: [values[places[key]]] if key in places else values for key, values in self.axes.items()}
        return part

    # In a notebook

    @property
    def dataset(self) -> xr.Dataset:
        """Every variable of the file over the swept axes, case, analysis, record, building, storey, floor and link,
        with units and meanings; read into memory when it is first asked for."""
        return self.data.load()

    def __repr__(self) -> str:
        words = {
            "building": ("building",),
            "case": ("case",),
            "analysis": ("analysis", "analyses"),
            "record": ("motion",),
        }
        parts = []
        for dim, word in words.items():
            names = self.names(dim)
            parts.append(pluralize(len(names), *word) + (f" ({', '.join(names)})" if len(names) <= 5 else ""))
        if self.axes:
            parts.append("swept " + ", ".join(f"{key} ({len(values)})" for key, values in self.axes.items()))
        failed = f" ({self.attrs['scenes_failed']} failed)" if self.attrs["scenes_failed"] else ""
        parts.append(f"{count_histories(self.attrs['scenes'])}{failed}")
        return f"Results({self.title!r}: {', '.join(parts)}; {self.path})"

    def _repr_html_(self) -> str:
        """With the largest mean ratio over the storeys and the sweep by case and building."""
        means = [f"{ratio}_mean" for ratio in RATIO_VARIABLES]
        worst = self.summary().pivot_table(means, ["case", "building"], "analysis", "max", sort=False)
        return f"<p>{escape(repr(self))}</p>{worst.to_html(float_format=format_number, na_rep=NOTHING, max_rows=40)}"

    def _list_kept(self, names: Iterable[str]) -> list[str]:
        """Return those of some variables that the file has: some come with plans, columns or joints alone."""
        return [name for name in names if name in self.arrays]

    def _build_frame(
        self, names: Sequence[str], places: tuple[str, ...], row_filter: RowFilter | None = None
    ) -> pd.DataFrame:
        """Return variables over the swept axes that change them and `places`, which come first as columns.

        An axis gives a column for each of its keys.  What is known of a storey is known of its floor.
        """
        import pandas as pd

        row_filter = row_filter or {}
        variables = {name: self.arrays[name] for name in (*self.axes, *places, *names, *row_filter)}
        changing = {dim for name in (*names, *row_filter) for dim in variables[name].dims}
        dims = (*(keys[0] for keys in self.swept if keys[0] in changing), *places)
        all_sizes = self.arrays.sizes
        sizes = {dim: all_sizes[dim] for dim in dims}

        level = "storey" if "storey" in dims else "floor"

        def column(v: Array) -> np.ndarray:
            own = [level if dim in ("storey", "floor") else dim for dim in v.dims]
            order = sorted(range(len(own)), key=lambda place: dims.index(own[place]))
            shape = [sizes[dim] if dim in own else 1 for dim in dims]
            spread = v.values.transpose(order).reshape(shape)
            return np.broadcast_to(spread, tuple(sizes.values())).ravel()

        rows = np.all([is_wanted(column(variables[name])) for name, is_wanted in row_filter.items()], axis=0)
        at = np.flatnonzero(np.broadcast_to(rows, math.prod(sizes.values())))
        place: dict[Any, np.ndarray] = dict(zip(dims, np.unravel_index(at, tuple(sizes.values())), strict=True))
        keys = [key for key in self.axes if variables[key].dims[0] in dims]
        columns: dict[str, Any] = {}
        for name in (*keys, *places, *names):
            v = variables[name]  # texts that repeat are made once
            columns[name] = pd.Series(v.values).array.take(place[v.dims[0]]) if len(v.dims) == 1 else column(v)[at]
        return pd.DataFrame(columns)


def _describe_columns(names: Sequence[str]) -> str:
    """Return a section of a docstring with unit and meaning of every column."""
    columns = [(name.removeprefix("line_"), VARIABLES[name]) for name in names if name in VARIABLES]
    lines = [f"{name} : {v.text} [{v.unit if v.unit != '1' else '-'}]".replace(" []", "") for name, v in columns]
    return "".join(f"\n        {line}" for line in ("", "Columns", "-------", *lines)) + "\n        "


for _table, _columns in {
    ResultTables.storey: _OVER[STOREY_DIMS],
    ResultTables.floor: _OVER[FLOOR_DIMS],
    ResultTables.line: _LINE,
    ResultTables.link: ("kind", "gap", *_OVER[LINK_DIMS]),
    ResultTables.base: _BASE,
    ResultTables.scene: _SCENE,
    ResultTables.accuracy: _ACCURACY,
}.items():
    _table.__doc__ = f"{_table.__doc__}{_describe_columns(_columns)}"


def _is_same_value(one: Any, other: Any) -> bool:
    """Return whether two values of a key are the same, numbers to nine digits."""
    if isinstance(one, float) and isinstance(other, int | float):
        return math.isclose(one, other, rel_tol=1e-9)
    return bool(one == other)

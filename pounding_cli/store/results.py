"""A results file read back: tidy tables, swept axes first."""

from __future__ import annotations

import copy
import json
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit
from pounding_cli.records.scaling import SpectrumMatch
from pounding_cli.solver.histories import History
from pounding_cli.store.answers import Answer, largest, read_table, table_names
from pounding_cli.store.columns import TABLES, meaning
from pounding_cli.store.files import opened
from pounding_cli.store.histories import GROUP, chosen_place, kept_places, read_history
from pounding_cli.store.row_tables import RowTables, frame_of
from pounding_cli.store.solutions import stored_methods
from pounding_cli.store.structure import strings
from pounding_cli.store.swept import assumed_heights, written
from pounding_cli.texts import plain, plain_tree
from pounding_cli.variables import PLACE, WRITTEN
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    import pandas as pd

_STUDY: dict[str, type] = {"buildings": dict, "cases": dict, "group": list, "records": dict}
"""What a resolved study is made of."""


def open_results(path: str | Path) -> Results:
    """The results of a study.

    Raises
    ------
    InputError : no such file, not a results file of this program, or of another format version
    """
    return Results(Path(path))


class Results(RowTables):
    """The tables of one results file (docs/results.md), each read when asked for.

    Attributes
    ----------
    path : the file
    title, study_text : the study as written
    workflow : the command that wrote it, a key of WORKFLOWS
    answers : the tables that this command added
    resolved, resolved_text : the study with every default filled in (SI), as a mapping and as JSON
    swept : the keys of every axis; more than one where they move together
    axes : swept key -> its values (SI); keys of one axis (zipped) have the same length
    units : column -> the unit the study wrote it in, to show values to people: swept keys, gaps, accelerations
    assumed_heights : the buildings whose storey heights the study leaves to their default
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
            self.assumed_heights = assumed_heights(file)
            self.warnings = tuple(Problem(**each) for each in json.loads(warnings))
            self.swept: list[list[str]] = json.loads(self.attrs["swept"])
            self.axes: dict[str, list[Any]] = {
                name: self._values(file[name]).tolist() for names in self.swept for name in names
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
            raise InputError(Problem("its study/resolved is not a study", "run the study again", str(self.path)))
        return found

    def axis_label(self, key: str) -> str:
        """A swept key with the unit the study wrote it in: "cases.gap.gap [cm]"."""
        return self.units[key].label(key)

    def value_label(self, key: str, value: Any) -> str:
        """A value of a swept key (SI, as in the tables) as people read it: "5 cm"; texts as they are."""
        return self.units[key].text(value)

    def point_label(self, index: Sequence[int]) -> str:
        """A point of the sweep in words and the units of the study, from its index on every axis."""
        keys = ((name, place) for names, place in zip(self.swept, index, strict=True) for name in names)
        return ", ".join(f"{name} = {self.value_label(name, self.axes[name][place])}" for name, place in keys)

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
            problem = Problem("its study/spectrum is not a match of spectra", "run the study again", str(self.path))
            raise InputError(problem) from None

    @cached_property
    def methods(self) -> tuple[str, ...]:
        """The methods that solved the scenes, buildings alone included: keys of `solve.METHODS`."""
        with opened(self.path) as file:
            return stored_methods(file)

    def histories(self) -> pd.DataFrame:
        """Which scenes are kept over time: swept keys, case, analysis, record, number, scene, every [s], times."""
        names = (*self.axes, *PLACE, "number", "scene", "every", "times")
        return frame_of({name: [row[name] for row in self._places()] for name in names})

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

    @property
    def tables(self) -> tuple[str, ...]:
        """Names of the tables that the file has."""
        return (*TABLES, *self.answers)

    def table(self, name: str) -> pd.DataFrame:
        """A table by its name: storey, floor, link, struck, scene, flagged, accuracy, summary, records, buildings, or
        one of `answers`."""
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
                command = next((each.name for each in WORKFLOWS.values() if name in each.shows), name)
                hint = f"write it with: pound {command} STUDY -o FILE.h5"
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
        found.axes = {k: v[:1] if k in self.swept[-1] else v for k, v in self.axes.items()}
        return found


def _plain(value: Any) -> Any:
    value = value.item() if isinstance(value, np.generic) else value
    return plain(value) if isinstance(value, str) else value

"""A street: its pairs of neighbours, and the study of each pair."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import pluralize
from pounding_cli.reading import shorten_path
from pounding_cli.study.construct.motions import MotionReader
from pounding_cli.study.schema.quantity import ACCELERATION
from pounding_cli.study.text.file import Items, Map, Mark, dump_yaml

if TYPE_CHECKING:
    from pounding_cli.questions.gap.question import Gap
    from pounding_cli.study import Study

LEFT, RIGHT = "left", "right"
"""The two buildings of every pair, and their names in its study."""

CASE = "gap"
"""The one case of the study of a pair."""

MIN_PGA = 0.05
"""Peak ground acceleration down to which the hazard curve of rows that give points of it goes [g]."""

COUNTED_RATE = 0.01
"""Annual rate at the lowest intensity of a hazard curve below which much of what closes a gap may not be counted."""


@dataclass(frozen=True)
class Cell:
    """A cell of the table.

    text : with the unit of its heading
    mark : its line and column
    """

    text: str
    mark: Mark


@dataclass(frozen=True)
class Settings:
    """The settings that hold for all rows.

    motions : of the catalogue, or files
    duration : how much of each motion is used, as a study writes it
    levels : peak ground accelerations to which the motions are scaled, as a study writes them
    neighbours : how many buildings each neighbour may be
    hazard : hazard curve of rows without one, as a study writes it: a mapping or a file; "" without one
    zone : of rows without one; "" without one
    return_period : of `pga` in rows without one [years]
    slope : exponent k of the hazard curve of rows that give one point of it [-]
    separator, decimal, thousands : how cells are written (`records.Declaration`); "" as of a motion without them
    """

    motions: tuple[str, ...] = ("elcentro", "taft", "eureka", "olympia", "parkfield")
    duration: str = "10 s"
    levels: tuple[str, ...] = ("0.1 g", "0.3 g", "0.8 g")
    neighbours: int = 20
    hazard: str = ""
    zone: str = ""
    return_period: float = 475.0
    slope: float = 3.0
    separator: str = ""
    decimal: str = ""
    thousands: str = ""


@dataclass(frozen=True, eq=False)
class NeighbourPair:
    """A row of the table.

    line : where it stands
    name : of the pair
    buildings : what is written of both, as a study has it
    names : of both buildings; "" without
    gap : [m]
    written_gap, hazard : as a study has them, with their places
    """

    line: int
    name: str
    buildings: Map
    names: tuple[str, str]
    gap: float
    written_gap: Cell
    hazard: Any
    hazard_mark: Mark

    @cached_property
    def buildings_key(self) -> str:
        """The key that tells pairs of different buildings apart."""
        return dump_yaml(self.buildings)

    @cached_property
    def hazard_key(self) -> str:
        """The key that tells different hazard curves apart."""
        return dump_yaml(self.hazard)


@dataclass(frozen=True, eq=False)
class Street:
    """A table of neighbours.

    path : the file
    text : as written
    pairs : in the order of their rows
    settings : what holds for all rows
    """

    path: Path
    text: str
    pairs: Sequence[NeighbourPair]
    settings: Settings = field(default_factory=Settings)

    @cached_property
    def _reader(self) -> MotionReader:
        """The reader of the motions, which all pairs have in common."""
        return MotionReader(self.path.resolve().parent)

    def find_warnings(self) -> list[Issue]:
        """Return the warnings of all pairs, each once.

        Raises InputError: with everything wrong in the studies of the pairs, so that none is refused once others are
        solved.
        """
        from pounding_cli.questions.gap.question import Gap

        warnings: dict[str, Issue] = {}
        problems: dict[str, Issue] = {}
        checked_pairs = set()
        checked_hazards = set()
        for pair in self.pairs:
            key = (pair.buildings_key, pair.hazard_key, pair.gap)
            if key in checked_pairs:
                continue
            checked_pairs.add(key)
            try:
                study = self.build_study(pair)
                if pair.hazard_key not in checked_hazards:
                    checked_hazards.add(pair.hazard_key)
                    warnings |= _warn_high_begin(Gap(study), pair)
            except InputError as refused:
                problems |= {str(problem): problem for problem in refused.issues}
            else:
                warnings |= {str(warning): warning for warning in study.warnings}
        if problems:
            raise InputError(list(problems.values()))
        for warning in self._warn_known_once():
            warnings[str(warning)] = warning
        return list(warnings.values())

    def list_taken(self) -> list[str]:
        """Return what was taken of each file of a hazard curve, a sentence each.  Raises InputError."""
        from pounding_cli.questions.gap.question import Gap

        pairs = {pair.hazard_key: pair for pair in self.pairs if isinstance(pair.hazard, str) or "file" in pair.hazard}
        return list(dict.fromkeys(each for pair in pairs.values() for each in Gap(self.build_study(pair)).taken))

    def _warn_known_once(self) -> Iterator[Issue]:
        """Yield a warning of every building of two rows of which one alone has what was measured."""
        for pair, next_pair in pairwise(self.pairs):
            if not pair.names[1] or pair.names[1] != next_pair.names[0]:
                continue
            here = set(next_pair.buildings[LEFT])
            there = set(pair.buildings[RIGHT])
            if here != there:
                known = " and ".join(sorted(here ^ there))
                message = f"'{pair.names[1]}' has its {known} in one of the rows {pair.line} and {next_pair.line} alone"
                hint = "write what is known of a building in both rows, as left and as right"
                yield Issue((), message, hint, file=shorten_path(self.path), line=next_pair.line, column=1)

    def build_study(self, pair: NeighbourPair) -> Study:
        """Return the study of a pair, whose text is followed by the table as comments.

        Raises InputError: with rows and columns of the table, or the options of the command.
        """
        from pounding_cli.questions import study_model
        from pounding_cli.study.load import build_study

        tree = self._build_tree(pair)
        text = self.format_study(pair) + "".join(f"# {line}\n" for line in self.text.splitlines())
        study = build_study(self.path, text, tree, study_model(), reader=self._reader)
        return replace(study, title=f"{self.path.name}: {pluralize(len(self.pairs), 'pair')} of neighbours")

    def format_study(self, pair: NeighbourPair) -> str:
        """Return the text of the study of a pair, which `pound gap` runs."""
        return dump_yaml(self._build_tree(pair), flow=False) + "\n"

    def _build_tree(self, pair: NeighbourPair) -> Map:
        """Return the study of a pair, with the places of its values in the table."""
        settings = self.settings
        row: Mark = (pair.line, 1)
        levels = mark_list(settings.levels, ("--levels", 0))
        motions = mark_list(settings.motions, ("--motions", 0))
        scale = mark_map({"pga": settings.levels[0]}, ("--levels", 0))
        records = mark_map({"use": motions, "duration": settings.duration}, ("--duration", 0))
        records["scale"] = scale
        records.marks["use"] = (motions.mark, motions.mark)
        records.marks["scale"] = (scale.mark, scale.mark)
        joint = mark_map({"link": "pounding", "gap": pair.written_gap.text}, pair.written_gap.mark)
        gap = mark_map({"hazard": pair.hazard}, pair.hazard_mark)
        return mark_map(
            {
                "title": f"{self.path.name}: {pair.name}",
                "records": records,
                "buildings": pair.buildings,
                "group": mark_list((LEFT, RIGHT), row),
                "cases": mark_map({CASE: joint}, row),
                "analyses": mark_list(("inelastic",), row),
                "sweep": mark_map({"records.scale.pga": levels}, ("--levels", 0)),
                "gap": gap,
                "estimate": "none",
            },
            row,
        )


def _warn_high_begin(question: Gap, pair: NeighbourPair) -> dict[str, Issue]:
    """Return a warning of a hazard curve that begins with shaking so rare that weaker one may close a gap as well."""
    assert question.hazard is not None
    lowest = float(question.hazard.edges[0])
    rate = float(question.hazard.rate(np.array([lowest]))[0])
    if lowest == 0.0 or rate >= COUNTED_RATE:
        return {}
    pga = f"{lowest / ACCELERATION.read('1 g'):.3g} g"
    message = f"the hazard curve begins at {pga}, exceeded {rate:.2g} times a year: weaker shaking is not counted"
    line, column = pair.hazard_mark
    hint = f"give it points down to {MIN_PGA:g} g"
    if isinstance(line, int):
        warning = Issue((), message, hint, file=str(question.study.file), line=line, column=column)
    else:
        warning = Issue((), message, hint, file=str(line))
    return {str(warning): warning}


def mark_map(values: Mapping[str, Any], mark: Mark) -> Map:
    """Return a mapping whose values stand at one place, unless they have places of their own."""
    marks = {name: (mark, getattr(value, "mark", mark)) for name, value in values.items()}
    return Map(values, mark, marks)


def mark_list(values: Sequence[Any], mark: Mark) -> Items:
    return Items(values, mark, [mark] * len(values))

"""Which scenes carry which flag, and whether it makes their numbers meaningless: for whoever shows a case."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pounding_cli.numbers import Unit, counted
from pounding_cli.solver.outcome import is_meaningless
from pounding_cli.solver.response import OUTCOMES

if TYPE_CHECKING:
    import pandas as pd

MOST_NAMED = 6
"""Points of a sweep whose flagged scenes are named; of more, the number is."""


class SceneFlags(NamedTuple):
    """A scene with its flags, one a line; `point` is its point of the sweep in words, "" where nothing is swept."""

    point: str
    case: str
    analysis: str
    record: str
    flags: str


@dataclass(frozen=True)
class FlagGroup:
    """The scenes of one case and analysis that carry one flag.

    flag : what is flagged, e.g. "infill compressed beyond its thickness"
    detail : where and by how much, of the first such scene; "" where the flag says nothing more
    meaningless : whether the numbers of these scenes mean nothing
    count, of : flagged scenes, and all of that case and analysis
    scenes : the flagged ones in words, e.g. "elcentro, taft"
    """

    case: str
    analysis: str
    flag: str
    detail: str
    meaningless: bool
    count: int
    of: int
    scenes: str

    def __str__(self) -> str:
        where = f"{self.case}, {self.analysis}, {self.count} of {counted(self.of, 'scene')} ({self.scenes})"
        example = f" (e.g. {self.detail})" if self.count > 1 else f": {self.detail}"
        return f"{where}: {self.flag}{example if self.detail else ''}"


def flag_groups(scenes: Iterable[SceneFlags]) -> tuple[FlagGroup, ...]:
    """What is flagged, case by case and analysis by analysis, meaningless first.

    scenes : all of them, unflagged ones too, each case and analysis in the order they shall appear
    """
    of: dict[tuple[str, str], int] = {}
    records: dict[str, None] = {}
    flagged: dict[tuple[str, str, str], dict[tuple[str, str], str]] = {}
    for scene in scenes:
        place = (scene.case, scene.analysis)
        of[place] = of.get(place, 0) + 1
        records[scene.record] = None
        for flag, detail in parted(scene.flags):
            flagged.setdefault((*place, flag), {}).setdefault((scene.point, scene.record), detail)
    groups = [
        FlagGroup(
            case,
            analysis,
            flag,
            next(iter(found.values())),
            is_meaningless(flag),
            len(found),
            of[case, analysis],
            _named(found, of[case, analysis], len(records)),
        )
        for (case, analysis, flag), found in flagged.items()
    ]
    order = {place: number for number, place in enumerate(of)}
    return tuple(sorted(groups, key=lambda group: (not group.meaningless, order[group.case, group.analysis])))


def flag_groups_of(scene: pd.DataFrame, units: Mapping[str, Unit] | None = None) -> tuple[FlagGroup, ...]:
    """`flag_groups` of a table of scenes (`Results.scene()`), or of some of its rows.

    units : of the swept keys, to name points by (`Results.units`); SI unless given
    """
    swept, written = _swept(scene), units or {}
    points = [
        ", ".join(f"{name} = {written.get(name, Unit()).text(row[name])}" for name in swept)
        for row in scene[[*swept, "flags"]].to_dict("records")  # of no column pandas 2 makes no rows
    ]
    columns = (scene[name] for name in ("case", "analysis", "record", "flags"))
    return flag_groups(map(SceneFlags._make, zip(points, *columns, strict=True)))


def failed_scenes(scene: pd.DataFrame) -> pd.DataFrame:
    """The rows of a table of scenes that have no result; a collapse is one."""
    return scene[~scene["status"].isin(OUTCOMES)]


def flagged_scenes(scene: pd.DataFrame) -> pd.DataFrame:
    """One row a flag of a scene, as `Results.flagged()`, of a table of scenes or of some of its rows."""
    import pandas as pd

    place = [*_swept(scene), "case", "analysis", "record"]
    rows = [
        (*where, flag, detail, is_meaningless(flag))
        for *where, flags in scene[[*place, "flags"]].itertuples(index=False, name=None)
        for flag, detail in parted(flags)
    ]
    found = pd.DataFrame(rows, columns=[*place, "flag", "detail", "meaningless"])
    return found.astype({"meaningless": bool})


def counts_of_flags(flags: np.ndarray) -> dict[str, np.ndarray]:
    """Records flagged and records whose numbers have no meaning, over axes, case and analysis.

    flags : those of every scene, one a line; over axes, case, analysis and record
    """
    flagged = np.array([bool(cell) for cell in flags.flat]).reshape(flags.shape)
    worthless = np.array([any(map(is_meaningless, cell.splitlines())) for cell in flags.flat]).reshape(flags.shape)
    return {"records_flagged": flagged.sum(axis=-1), "records_meaningless": worthless.sum(axis=-1)}


def parted(flags: str) -> Iterator[tuple[str, str]]:
    """What is flagged and the detail behind its colon, of the flags of one scene, one a line."""
    for line in flags.splitlines():
        flag, _, detail = line.partition(": ")
        yield flag, detail


def _swept(scene: pd.DataFrame) -> list[str]:
    return list(scene.columns[: list(scene.columns).index("case")])


def _named(found: Iterable[tuple[str, str]], of: int, records: int) -> str:
    """Points and records in words: "all", "elcentro, taft", "gap = 0.1: elcentro; gap = 0.2: all motions"."""
    points: dict[str, list[str]] = {}
    for point, record in found:
        points.setdefault(point, []).append(record)
    if sum(map(len, points.values())) == of and of > 1:
        return "all"
    words = []
    for point, names in points.items():
        named = "all motions" if point and len(names) == records > 1 else ", ".join(names)
        words.append(f"{point}: {named}" if point else named)
    more = len(words) - MOST_NAMED
    return "; ".join(words[:MOST_NAMED]) + (f"; and {counted(more, 'more point')}" if more > 0 else "")

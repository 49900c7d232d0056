"""Which scenes carry which flag, and whether it makes their numbers meaningless: for whoever shows a case."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from pounding_cli.numbers import Unit, counted
from pounding_cli.solver.outcome import is_meaningless
from pounding_cli.solver.response import OUTCOMES

if TYPE_CHECKING:
    import pandas as pd

MOST_NAMED = 6
"""Flagged scenes that are named; of more, the number is."""


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
        where = f"{self.case}, {self.analysis}, {self.count} of {counted(self.of, 'row')} ({self.scenes})"
        example = f" (e.g. {self.detail})" if self.count > 1 else f": {self.detail}"
        return f"{where}: {self.flag}{example if self.detail else ''}"


def parted(flags: str) -> list[tuple[str, str]]:
    """What is flagged and the detail behind its colon, of the flags of one scene, one a line."""
    parts = (line.partition(": ") for line in flags.splitlines())
    return [(flag, detail) for flag, _, detail in parts]


@lru_cache(maxsize=1024)
def is_void(flags: str) -> bool:
    """Whether one of the flags of a scene takes the meaning from its numbers."""
    return any(map(is_meaningless, flags.splitlines()))


def flagged_scenes(scene: pd.DataFrame) -> pd.DataFrame:
    """One row a flag of a scene, as `Results.flagged()`, of a table of scenes or of some of its rows."""
    import pandas as pd

    place = [*_swept(scene), "case", "analysis", "record"]
    rows = [
        (*where, flag, detail, is_void(flag))
        for *where, flags in scene[[*place, "flags"]].itertuples(index=False, name=None)
        for flag, detail in parted(flags)
    ]
    return pd.DataFrame(rows, columns=[*place, "flag", "detail", "meaningless"]).astype({"meaningless": bool})


def flag_groups_of(scene: pd.DataFrame, units: Mapping[str, Unit] | None = None) -> tuple[FlagGroup, ...]:
    """What is flagged in a table of scenes (`Results.scene()`) or in some of its rows, meaningless first.

    units : of the swept keys, to name points by (`Results.units`); SI unless given
    """
    swept, units, groups = _swept(scene), units or {}, []
    flagged = flagged_scenes(scene).drop_duplicates([*swept, "case", "analysis", "record", "flag"])
    of = scene.groupby(["case", "analysis"], sort=False).size()
    place: Any
    for place, rows in flagged.groupby(["case", "analysis", "flag"], sort=False):
        case, analysis, flag = place
        points = [
            ", ".join([*(f"{key} = {units.get(key, Unit()).text(row[key])}" for key in swept), row["record"]])
            for row in rows.head(MOST_NAMED).to_dict("records")
        ]
        count, whole, first = len(rows), int(of[case, analysis]), rows.iloc[0]
        more = [f"and {count - MOST_NAMED} more"] * (count > MOST_NAMED)
        said = "all" if count == whole > 1 else ("; " if swept else ", ").join([*points, *more])
        groups.append(FlagGroup(case, analysis, flag, first["detail"], bool(first["meaningless"]), count, whole, said))
    order = list(of.index)
    return tuple(sorted(groups, key=lambda group: (not group.meaningless, order.index((group.case, group.analysis)))))


def failed_scenes(scene: pd.DataFrame) -> pd.DataFrame:
    """The rows of a table of scenes that have no result; a collapse is one."""
    return scene[~scene["status"].isin(OUTCOMES)]


def _swept(scene: pd.DataFrame) -> list[str]:
    return list(scene.columns[: list(scene.columns).index("case")])

"""Flags of scenes, summed up by case and analysis, and whether they make the numbers meaningless."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pounding_cli.errors import Issue
from pounding_cli.notes import NOTES
from pounding_cli.numbers import Unit, pluralize
from pounding_cli.results.responses import decode_flags
from pounding_cli.solver.response import OUTCOMES

if TYPE_CHECKING:
    import pandas as pd

MOST_NAMED = 6
"""Flagged scenes that are named; of more, the number is."""

MAX_DETAILS = 3
"""Details that are quoted of flags of a kind whose severities do not compare."""


@dataclass(frozen=True)
class FlagGroup:
    """The scenes of one case and analysis that carry flags of one code.

    code : its entry in the catalogue of notes
    detail : where and by how much, of the worst of them; of flags that do not compare what they say; "" where they say
        nothing more
    worst : the scene of that detail in words; "" where flags do not compare
    severity : the largest, NaN where flags do not compare
    meaningless : whether the numbers of these scenes mean nothing
    count, of : flagged scenes, and all of that case and analysis
    scenes : the flagged ones in words, e.g. "elcentro, taft"
    """

    case: str
    analysis: str
    code: str
    detail: str
    worst: str
    severity: float
    meaningless: bool
    count: int
    of: int
    scenes: str

    @property
    def flag(self) -> str:
        """What is flagged, in words."""
        return NOTES[self.code].title

    def to_issue(self, mark: str = "") -> Issue:
        """Return what is flagged as a note; mark : that tables put at numbers without meaning, "" of none."""
        head = "Not meaningful" + (f" ({mark}): " if mark else ": ") if self.meaningless else ""
        return Issue((), f"{head}{self}.", code=self.code)

    def __str__(self) -> str:
        where = f"{self.case}, {self.analysis}, {self.count} of {pluralize(self.of, 'row')} ({self.scenes})"
        if not self.detail:
            return f"{where}: {self.flag}"
        if self.count > 1 and self.worst:
            return f"{where}: {self.flag}; the worst, {self.worst}: {self.detail}"
        return f"{where}: {self.flag}: {self.detail}"


def is_void(codes: str) -> bool:
    """Return whether one of the flags of a scene takes the meaning from its numbers; codes : one a line."""
    return not all(NOTES[code].can_be_accepted for code in codes.splitlines())


def flagged_scenes(scene: pd.DataFrame) -> pd.DataFrame:
    """Return one row a flag of a scene, as `Results.flagged()`, of a table of scenes or of some of its rows."""
    import pandas as pd

    place = [*_swept_keys(scene), "case", "analysis", "record"]
    rows = []
    texts = ["flags", "flag_details", "flag_severity"]
    for *where, codes, details, severities in scene[[*place, *texts]].itertuples(index=False, name=None):
        for each in decode_flags(codes, details, severities):
            rows.append((*where, each.code, each.title, each.detail, each.severity, each.is_meaningless))
    columns = [*place, "code", "flag", "detail", "severity", "meaningless"]
    return pd.DataFrame(rows, columns=columns).astype({"severity": float, "meaningless": bool})


def flag_groups_of(scene: pd.DataFrame, units: Mapping[str, Unit] | None = None) -> tuple[FlagGroup, ...]:
    """Return what is flagged in a table of scenes (`Results.scene()`) or in some of its rows, meaningless first.

    units : of the swept keys, to name points by (`Results.units`); SI unless given
    """
    swept = _swept_keys(scene)
    flagged = flagged_scenes(scene)
    totals = scene.groupby(["case", "analysis"], sort=False).size()
    groups = list[FlagGroup]()
    place: Any
    for place, rows in flagged.groupby(["case", "analysis", "code"], sort=False):
        case, analysis, code = place
        flagged_points = rows.drop_duplicates([*swept, "record"])
        count = len(flagged_points)
        total = int(totals[case, analysis])
        named = [point_label(row, swept, units or {}) for row in flagged_points.head(MOST_NAMED).to_dict("records")]
        if count > MOST_NAMED:
            named.append(f"and {count - MOST_NAMED} more")
        scenes = "all" if count == total > 1 else ("; " if swept else ", ").join(named)
        detail, worst, severity = _find_worst(rows, swept, units or {})
        meaningless = bool(rows["meaningless"].iloc[0])
        groups.append(FlagGroup(case, analysis, code, detail, worst, severity, meaningless, count, total, scenes))
    order = list(totals.index)
    return tuple(sorted(groups, key=lambda group: (not group.meaningless, order.index((group.case, group.analysis)))))


def _find_worst(rows: pd.DataFrame, swept: list[str], units: Mapping[str, Unit]) -> tuple[str, str, float]:
    """Return detail, scene in words and severity of the worst of some flags of one kind; of flags that do not compare
    what they say, without a scene."""
    if rows["severity"].notna().any():
        worst = rows.iloc[int(rows["severity"].argmax())].to_dict()
        return worst["detail"], point_label(worst, swept, units), float(worst["severity"])
    details = list(dict.fromkeys(rows["detail"]))
    shown = details[:MAX_DETAILS]
    if len(details) > MAX_DETAILS:
        shown.append(f"and {len(details) - MAX_DETAILS} more")
    return "; ".join(filter(None, shown)), "", math.nan


def point_label(row: Mapping[Any, Any], swept: list[str], units: Mapping[str, Unit]) -> str:
    """Return the point of the sweep and the motion of a scene in words."""
    values = [f"{key} = {units.get(key, Unit()).text(row[key])}" for key in swept]
    return ", ".join([*values, row["record"]])


def failed_scenes(scene: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of a table of scenes that have no result; a collapse is one."""
    return scene[~scene["status"].isin(OUTCOMES)]


def _swept_keys(scene: pd.DataFrame) -> list[str]:
    return list(scene.columns[: list(scene.columns).index("case")])

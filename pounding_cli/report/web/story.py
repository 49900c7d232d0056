"""What the page says in words and small tables: key numbers, what was simulated and dropped, trust, versions."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from pounding_cli.model.effects import EXPECTED, others
from pounding_cli.model.links import APART
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.evidence import Evidence, Tables, names, split
from pounding_cli.report.verdicts import Judgement, Verdict
from pounding_cli.store.flagged import failed_scenes

MOST_REASONS = 4
"""Reasons shown for one effect; further ones are counted."""
MOST_FAILURES = 50
"""Failed runs named on the page."""

MEASURED = {
    "error_estimate": "numerical error, relative",
    "sensitivity": "sensitivity",
    "energy_residual": "energy imbalance over the input",
}


@dataclass(frozen=True)
class Tile:
    """One number at the head of the page: what it is, the number, where it stands."""

    label: str
    number: str
    where: str
    tone: str = ""


@dataclass(frozen=True)
class Grid:
    """A small table: head, rows of texts, the columns (from 0) that hold numbers."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    numeric: Sequence[int] = field(default_factory=tuple)


def digits(value: float, count: int = 4) -> str:
    """A number with `count` digits as text: 1.234, 12.34, 3.100×10⁻⁹; a dash for none."""
    if not math.isfinite(value):
        return "–"
    mantissa, power = f"{value:.{count - 1}e}".split("e")
    size = int(power)
    if value == 0:
        return "0"
    if -3 <= size < 6:
        return f"{value:.{max(count - 1 - size, 0)}f}".replace("-", "−")
    return f"{mantissa}×10{str(size).translate(_RAISED)}".replace("-", "−")


_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def tiles(evidence: Evidence, judgements: Sequence[Judgement], scene: pd.DataFrame) -> list[Tile]:
    """Link force at the point shown; numerical error, sensitivity and runs of all `scene`s; the paper's claims."""
    failed = len(failed_scenes(scene))
    found = [Tile("Runs", str(len(scene)), f"{failed} failed" if failed else "all done", "bad" if failed else "")]
    error = scene["error_estimate"].dropna()
    number = digits(error.max(), 2) if len(error) else "not measured"
    where = f"relative, largest of {counted(len(error), 'run')}" if len(error) else "the study says estimate: none"
    found.append(Tile("Numerical error", number, where))
    sensitivity = scene["sensitivity"].dropna()
    if len(sensitivity):
        row = scene.iloc[int(scene["sensitivity"].argmax())]
        where = ", ".join(_placed(row, scene, evidence.units))
        found.append(Tile("Largest sensitivity", digits(sensitivity.max(), 3), where))
    force = evidence.link["peak_force"].dropna()
    if len(force):
        row = evidence.link.iloc[int(evidence.link["peak_force"].argmax())]
        where = f"{row['case']}, {row['analysis']}, {row['record']}: {row['link']}"
        found.append(Tile("Largest link force", f"{digits(force.max() / 1e3)} kN", where))
    if judgements:
        count = Counter(judgement.verdict for judgement in judgements)
        words = [f"{verdict}: {count[verdict]}" for verdict in Verdict if count[verdict]]
        found.append(Tile("The paper's claims", f"{count[Verdict.HOLDS]} of {len(judgements)} hold", ", ".join(words)))
    return found


def _placed(row: Any, scene: pd.DataFrame, units: Mapping[str, Unit]) -> list[str]:
    """The point, case, analysis and motion of a scene in words, in the units of the study."""
    keys = [str(key) for key in scene.columns[: list(scene.columns).index("status")]]
    return [f"{key} = {units[key].text(row[key])}" if key in units else str(row[key]) for key in keys]


def cases(evidence: Evidence) -> Grid:
    """Every case with its links in words."""
    unit = evidence.unit("gap")
    rows = []
    for case in evidence.cases:
        links = evidence.link[evidence.link["case"] == case].drop_duplicates("link")
        between = links[links["kind"] != APART]
        counted = Counter((row["kind"], row["gap"]) for row in between.to_dict("records"))
        words = [f"{count} × {kind}, gap {unit.text(gap)}" for (kind, gap), count in counted.items()]
        where = _floors(between)
        rows.append([case, "; ".join(words) or "none: the buildings stand alone", where])
    return Grid(("case", "links", "at floors"), rows)


def _floors(links: pd.DataFrame) -> str:
    floors = sorted(
        {
            str(left) if left == right else f"{left}|{right}"
            for left, right in zip(links["floor"], links["right_floor"], strict=True)
        },
        key=lambda name: [int(part) for part in name.split("|")],
    )  # fmt: skip
    if len(floors) > 8 and all(name.isdigit() for name in floors):
        return f"{floors[0]} to {floors[-1]}, {len(floors)} in all"
    return ", ".join(floors) or "–"


def effects(scene: pd.DataFrame) -> Grid:
    """The effects: in how many runs each was simulated, in how many dropped, and why; those that no run has and nobody
    expects in one row."""
    kept: Counter[str] = Counter()
    dropped: dict[str, Counter[str]] = {}
    for cell in scene["effects"]:
        kept.update(_head(line) for line in split(cell))
    for cell in scene["dropped"]:
        for line in split(cell):
            effect, _, reason = line.partition(": ")
            dropped.setdefault(effect, Counter())[reason] += 1
    rows = []
    names = dict.fromkeys((*kept, *dropped))
    told = [effect for effect in names if kept[effect] or effect in EXPECTED]
    for effect in told:
        reasons = dropped.get(effect, Counter())
        words = [
            f"{reason} ({count})" if len(reasons) > 1 else reason for reason, count in reasons.most_common(MOST_REASONS)
        ]
        more = len(reasons) - MOST_REASONS
        if more > 0:
            words.append(f"and {counted(more, 'further reason')}")
        rows.append([effect, str(kept[effect] or "–"), str(sum(reasons.values()) or "–"), "; ".join(words)])
    if rest := others([effect for effect in names if effect not in told]):
        rows.append(["all others", "–", str(len(scene)), rest])
    return Grid(("effect", "simulated in", "left out in", "reason"), rows, (1, 2))


def _head(line: str) -> str:
    """The effect a line of `effects` names; what was measured of it may follow a colon."""
    return line.partition(": ")[0]


def trust(scene: pd.DataFrame) -> Grid:
    """Median and largest of what was measured of the runs' accuracy, case by case."""
    columns = [column for column in MEASURED if column in scene.columns and scene[column].notna().any()]
    rows = []
    for case in names(scene["case"]):
        for analysis in names(scene["analysis"]):
            here = scene[(scene["case"] == case) & (scene["analysis"] == analysis)]
            if here.empty:
                continue
            cells = [case, analysis, str(len(here))]
            for column in columns:
                sizes = here[column].abs().dropna()
                cells += [digits(sizes.median(), 2), digits(sizes.max(), 2)] if len(sizes) else ["–", "–"]
            cells += [f"{here[column].sum():.0f}" for column in ("steps", "events")]
            rows.append([*cells, digits(1e3 * here["seconds"].mean(), 3)])
    head = ["case", "analysis", "runs"]
    for column in columns:
        head += [f"{MEASURED[column]}: median", "largest"]
    head += ["steps", "events", "solver time a run [ms]"]
    return Grid(head, rows, range(2, len(head)))


def failures(scene: pd.DataFrame, units: Mapping[str, Unit]) -> Grid:
    """The runs that did not end, with the advice; `units`: of the swept keys."""
    failed = failed_scenes(scene)
    rows = [
        [", ".join(_placed(row, scene, units)), row["status"], row["advice"]]
        for row in failed.head(MOST_FAILURES).to_dict("records")
    ]
    if len(failed) > MOST_FAILURES:
        rows.append([f"and {len(failed) - MOST_FAILURES} more", "", ""])
    return Grid(["run", "status", "advice"], rows)


def motions(evidence: Evidence) -> Grid:
    """The motions as used."""
    unit = evidence.unit("acceleration")
    rows = []
    for row in evidence.records.to_dict("records"):
        measures = (row["scale"], row["window"], unit.number(row["pga"]), row["arias"])
        rows.append([row["record"], row["source"], *map(digits, measures), str(row["digest"])[:12]])
    peak = f"peak as used [{unit.name}]"
    head = ("motion", "source", "scale [–]", "duration [s]", peak, "Arias intensity [m/s]", "digest")
    return Grid(head, rows, (2, 3, 4, 5))


def versions(results: Tables) -> Grid:
    """What made the file: software, machine, when, how long."""
    attrs = dict(results.attrs)
    rows = [
        [name.removeprefix("software_"), str(value)] for name, value in attrs.items() if name.startswith("software_")
    ]
    for name in ("created", "method", "accuracy", "engine", "workers", "scenes", "scenes_failed", "solver_seconds"):
        if name in attrs:
            value = attrs[name]
            rows.append([name.replace("_", " "), digits(value, 3) if isinstance(value, float) else str(value)])
    return Grid(("what", "version or value"), rows)


def verdict_tone(verdict: Any) -> str:
    """Class of a verdict's badge."""
    return {Verdict.HOLDS: "good", Verdict.PARTLY: "part", Verdict.FAILS: "bad"}.get(verdict, "none")

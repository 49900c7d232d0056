"""The sections behind every answer: its limits, motions, what was simulated, accuracy, tables, study."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.errors import Issue
from pounding_cli.laws import link_laws
from pounding_cli.laws.apart import Apart
from pounding_cli.model.effects import NOTHING_ECCENTRIC, TWIST_OF_FLOORS, DroppedEffect, summarize_effects
from pounding_cli.model.links import BASE
from pounding_cli.numbers import NOTHING, Unit, count_histories, format_number, join_limited, pluralize
from pounding_cli.report.document import Picture, Section
from pounding_cli.report.evidence import Evidence, describe_motions, find_written_value, format_point
from pounding_cli.report.plans import has_plans
from pounding_cli.results.columns import column_of
from pounding_cli.results.flags import failed_scenes, flag_groups_of
from pounding_cli.results.responses import decode_dropped
from pounding_cli.tables import Table, table_of_texts

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

_TITLES = {
    "summary": "Means over the motions", "storey": "Storeys", "floor": "Floors", "line": "Frame lines", "link": "Links",
    "struck": "Struck columns", "scene": "Outcomes", "flagged": "Flags", "records": "Motions", "buildings": "Buildings",
}  # fmt: skip
"""The tables of scenes that a report has, and what they are called."""

_COMMAND_OF_STUDY = {"screen": "gap"}
"""Command that wrote a file -> the command that takes the study in it, where that is another one."""

STIFFNESS_KEY = "impact.stiffness"

ADVICE = (
    "Floor accelerations and link forces of floors that strike grow with the square root of the impact stiffness, "
    "which is unknown. Sweep it to see the effect: `impact.stiffness: {values: [5 x stiffest storey, 20 x stiffest "
    "storey, 100 x stiffest storey], middle: 20 x stiffest storey}`."
)
"""What is said where floors strike and the impact stiffness has one value."""


def describe_scope(results: ResultTables, evidence: Evidence, is_sampled: bool) -> str:
    """Return in one line what was computed.

    evidence : the point of the sweep that the answer and its figures are about
    is_sampled : whether the points are samples
    """
    points = len(results.scene()[list(results.axes)].drop_duplicates()) if results.axes else 1
    parts = [
        pluralize(len(evidence.group), "building"),
        pluralize(len(evidence.cases), "case"),
        " and ".join(evidence.analyses),
        pluralize(len(evidence.records), "motion"),
    ]
    if points > 1:
        parts.append(pluralize(points, "different sample") if is_sampled else f"{points} points of a sweep")
    return f"{', '.join(parts)}: {pluralize(len(results.scene()), 'row')}."


def build_background(results: ResultTables, evidence: Evidence, is_sampled: bool) -> list[Section]:
    """Return the sections that stand behind every answer: limits, motions, what was simulated, tables, study.

    is_sampled : whether the points are samples, whose tables of scenes say nothing by themselves
    """
    tables = [results.answer(name) for name in results.answers]
    for name in ("records",) if is_sampled else tuple(_TITLES):
        frame = results.table(name)
        if len(frame) or name not in ("line", "struck", "flagged"):
            tables.append(table_of_results(results, name, frame))
    where = (
        "All rows with all digits, in SI units: `tables/` beside this page, `pound show FILE.h5 TABLE --format csv`."
    )
    return [
        *_build_limits(results),
        _build_motions(results, evidence),
        _build_simulated(results, evidence),
        Section("Tables", [where], tables, folded=True),
        _build_study(results),
    ]


def table_of_results(results: ResultTables, name: str, frame: pd.DataFrame) -> Table:
    """Return rows of a table of a results file with what is known of their columns."""
    columns = [column_of(str(each), results.units, name) for each in frame.columns]
    return Table(name, frame, columns, _TITLES.get(name, name.capitalize()))


def tell_notes(notes: Iterable[Issue | str], accepted: Collection[str]) -> list[str]:
    """Return notes in words; of those with a code that the study accepts only that they are left out."""
    told = [str(each) for each in notes if isinstance(each, str) or each.code not in accepted]
    if accepted:
        told.append(f"Left out, as the study accepts them (`accept:`): {', '.join(sorted(accepted))}.")
    return told


def list_advice(results: ResultTables) -> list[Issue]:
    """Return what a reader should know of the study: heights that it does not write, dashpots of infills and
    connectors, an impact stiffness of one value."""
    notes = []
    if results.assumed_heights:
        message = f"Heights of {', '.join(results.assumed_heights)}: 3 m, as the study writes no height."
        notes.append(Issue((), message, code="heights"))
    notes += [Issue((), sentence, code="dashpots") for sentence in _describe_dashpots(results)]
    if STIFFNESS_KEY not in results.axes and len(results.struck_links()):
        notes.append(Issue((), ADVICE, code="stiffness"))
    return notes


def _describe_dashpots(results: ResultTables) -> list[str]:
    """Return the damping ratios of infills and connectors, case by case, where no axis of the sweep changes them."""
    if any(key.split(".")[-1] in ("damping_ratio", "restitution") for key in results.axes):
        return []
    cases: dict[tuple[float, float], list[str]] = {}
    for name, case in results.study_data["cases"].items():
        for link in case["links"]:
            law = link_laws().get(link["link"])
            if law is not None and not law.subtracts_gap and "damping_ratio" in link:
                names = cases.setdefault((link["damping_ratio"], link["restitution"]), [])
                names += [name] if name not in names else []
    return [
        f"Dashpots of infills and connectors ({join_limited(names)}): damping ratio {100 * ratio:.3g} %, that of a "
        f"restitution of {restitution:.3g}; the key is `damping_ratio`."
        for (ratio, restitution), names in cases.items()
    ]


def _build_limits(results: ResultTables) -> list[Section]:
    warned = [
        replace(
            each,
            message=f"{each.message}." + (f" Line {each.line} of the study: {each.hint}." if each.line else ""),
            hint="",
            file="",
        )
        for each in results.warnings
    ]
    sentences = tell_notes([*warned, *list_advice(results)], results.accepted)
    return [Section("What limits these numbers", sentences)] if sentences else []


def _build_motions(results: ResultTables, evidence: Evidence) -> Section:
    frame, point = _motions_as_written(results)
    columns = [
        replace(column_of(str(name), results.units), label="motion" if name == "record" else "") for name in frame
    ]
    said, pictures = [describe_motions(evidence.records), *_varied_motions(results, point)], []
    if (match := results.spectrum_match) is not None:
        said.append(match.words)
        from pounding_cli.report.motions import draw_spectra  # with matplotlib; a terminal does not need it

        draw = partial(draw_spectra, match, results.title, evidence.unit("acceleration"))
        text = "The target, the mean of the spectra of the motions as used, and each of them."
        pictures.append(Picture("target-spectrum", "Target spectrum", text, draw))
    at = f" at {format_point(results, point)}" if point else ""
    return Section("Motions", said, [Table("", frame, columns, f"Ground motions as used{at}")], pictures)


def _motions_as_written(results: ResultTables) -> tuple[pd.DataFrame, dict[str, Any]]:
    """Return the motions as used where the keys that change them have the values that the study writes, and these
    values by key; a key of which the study writes none has its first value.

    A written intensity need not be one of those that are swept, since most ways to scale are in proportion to it.
    """
    from pounding_cli.study.schema.records import (
        INTENSITY_KEYS,
        scales_in_proportion,
    )  # here: a terminal prints results without a study

    frame, point = results.records(), dict[str, Any]()
    columns = ["record", "source", "scale", "window", "pga", "arias", "digest"]
    for keys in results.swept:
        of_axis = [key for key in keys if key in frame]  # of some keys that move together the motions do not depend
        keys = [key for key in of_axis if key.startswith("records")] or of_axis
        if not keys:
            continue
        swept = frame[keys].drop_duplicates()
        written = {key: find_written_value(results, key) for key in keys}
        is_written = (swept == pd.Series(written)).all(axis=1)
        values = swept[is_written].iloc[0] if is_written.any() else swept.iloc[0]
        frame = frame[(frame[keys] == values).all(axis=1)]
        point |= {key: values[key] for key in keys}
        (key, *others), value = keys, written[keys[0]]
        is_alone = not (is_written.any() or others) and isinstance(value, float)
        if is_alone and key in INTENSITY_KEYS and scales_in_proportion(key, _target_code(results)):
            factor = value / point[key]
            frame = frame.assign(**{name: frame[name] * factor for name in ("scale", "pga")}, digest="")
            frame["arias"] *= factor**2
            point[key] = value
    frame = frame[columns].drop_duplicates("record", ignore_index=True)
    return frame.assign(digest=frame["digest"].str[:12]), point


def _target_code(results: ResultTables) -> str | None:
    """Return the code of the target spectrum that the study writes; None without one."""
    scale = results.study_data["records"]["scale"]
    target = scale.get("target") if isinstance(scale, dict) else None
    return target.get("code") if isinstance(target, dict) else None


def _varied_motions(results: ResultTables, point: Mapping[str, Any]) -> list[str]:
    """Return in a sentence over which values that were solved the study varies its motions; nothing where it does not.

    point : swept keys that change a motion
    """
    ranges = []
    for key in point:
        values = results.scene()[key].unique()
        ends = [results.value_label(key, each) for each in (values.min(), values.max())]
        if isinstance(values[0], str):
            ranges.append(f"{key}: {join_limited(map(str, values))}")
        else:
            ranges.append(f"{key} from {ends[0]} to {ends[1]}")
    return [f"The motions are varied: {'; '.join(ranges)}."] if ranges else []


def _build_simulated(results: ResultTables, evidence: Evidence) -> Section:
    scene = results.scene()
    histories = count_histories(int(results.attrs["scenes"]))
    said = [
        f"{pluralize(len(scene), 'row')} of {histories}: each different one is solved once, buildings alone included."
    ]
    said += _open_gaps(scene)
    tables, failed = [_build_cases(evidence), _build_effects(scene, has_plans(evidence))], failed_scenes(scene)
    if len(failed):
        said.append("The means and tables leave failed rows out.")
        rows = [
            [format_row_place(row, results.units), row["status"], row["advice"]] for row in failed.to_dict("records")
        ]
        tables.insert(0, table_of_texts("Rows that failed", ("row", "status", "advice"), rows))
    flags = flag_groups_of(scene, results.units)
    notes = [each.to_issue() for each in flags if each.code not in results.accepted]
    return Section("What was simulated", said, tables, notes=[*map(str, notes)] or ["No row raised a flag."])


def format_row_place(row: Mapping[Any, Any], units: Mapping[str, Unit]) -> str:
    """Return the point, case, analysis and motion of a row in words, in the units of the study."""
    place = {key: value for key, value in row.items() if key in units or key in ("case", "analysis", "record")}
    return ", ".join(f"{k} = {units[k].text(v)}" if k in units else str(v) for k, v in place.items())


def _build_cases(evidence: Evidence) -> Table:
    """Return the table of cases with their links in words."""
    unit, rows = evidence.unit("gap"), []
    links = evidence.link[evidence.link["kind"] != Apart.name].drop_duplicates(["case", "link"])
    for case in evidence.cases:
        mine = links[links["case"] == case]
        kinds = Counter(zip(mine["kind"], mine["gap"], strict=True))
        words = [f"{count} × {kind}, gap {unit.text(gap)}" for (kind, gap), count in kinds.items()]
        pairs = sorted(set(zip(mine["floor"], mine["right_floor"], strict=True)))
        floors = ", ".join(str(left or BASE) if left == right else f"{left}|{right}" for left, right in pairs)
        rows.append([case, "; ".join(words) or "none: the buildings stand alone", floors or NOTHING])
    return table_of_texts("Cases", ("case", "links", "at floors"), rows)


def _build_effects(scene: pd.DataFrame, tells_twist: bool) -> Table:
    """Return the table of effects: in how many rows each was simulated or left out, and why.

    tells_twist : whether buildings have plans, so that a row may leave their twist out
    """
    kept = Counter(line for cell in scene["effects"] for line in cell.splitlines())
    dropped = Counter(_dropped_effects(scene))
    untwisted = sum(bool(cell) and TWIST_OF_FLOORS not in cell.splitlines() for cell in scene["effects"])
    if tells_twist and untwisted:
        dropped[DroppedEffect(TWIST_OF_FLOORS, NOTHING_ECCENTRIC)] = untwisted
    rows = [
        [name, str(here or NOTHING), str(out or NOTHING), why]
        for name, here, out, why in summarize_effects(kept, dropped)
    ]
    return table_of_texts("Effects simulated and left out", ("effect", "simulated in", "left out in", "reason"), rows)


def _dropped_effects(scene: pd.DataFrame) -> Iterator[DroppedEffect]:
    """Yield the effects that runs left out, one entry a run."""
    texts = scene[["dropped", "dropped_links", "dropped_reasons"]]
    for cells in texts.itertuples(index=False, name=None):
        yield from decode_dropped(*cells)


def _open_gaps(scene: pd.DataFrame) -> list[str]:
    """Return for every pair of neighbours in how many runs their gap stays open, so that their links never act."""
    runs = Counter(each.links for each in _dropped_effects(scene) if each.links)
    of_all = f"of {pluralize(len(scene), 'run')}, in which no force acts across it"
    return [f"{neighbours}: the gap never closes in {count} {of_all}." for neighbours, count in runs.items()]


def _build_study(results: ResultTables) -> Section:
    """Return the section of the study as written, software and machine."""
    rows = [[k.removeprefix("software_"), str(v)] for k, v in results.attrs.items() if k.startswith("software_")]
    for name in ("created", "method", "accuracy", "engine", "workers", "scenes", "scenes_failed", "solver_seconds"):
        if (value := results.attrs.get(name)) is not None:
            rows.append([name.replace("_", " "), format_number(value, 3) if isinstance(value, float) else str(value)])
    command = _COMMAND_OF_STUDY.get(results.workflow, results.workflow)
    said = [f"Save the study as `STUDY.yaml`; `pound {command} STUDY.yaml` runs it again."]
    return Section(
        "Study and versions", said, [table_of_texts("Software and run", ("what", "value"), rows)], widget="study"
    )


def describe_accuracy(scene: pd.DataFrame, units: Mapping[str, Unit]) -> str:
    """Return how far the numbers go, in one line: rows, numerical error, sensitivity and energy balance."""
    failed = len(failed_scenes(scene))
    parts = [f"{pluralize(len(scene), 'row')}, {f'{failed} failed' if failed else 'all done'}."]
    errors = scene["error_estimate"].dropna()
    if len(errors):
        assessed = "" if len(errors) == len(scene) else f" ({len(errors)} of {pluralize(len(scene), 'row')} assessed)"
        parts.append(f"Numerical error: at most {format_number(errors.max(), 1)}{assessed}.")
    else:
        parts.append("Numerical error and sensitivity: not estimated (`estimate: none`).")
    if scene["sensitivity"].notna().any():
        row = scene.iloc[int(scene["sensitivity"].argmax())]
        size = format_number(row["sensitivity"], 2)
        parts.append(
            f"Sensitivity to a small change of the motion: up to {size} ({format_row_place(row.to_dict(), units)})."
        )
    residual = scene["energy_residual"].abs().max()
    if np.isfinite(residual):
        parts.append(f"Energy balance: closes to {format_number(residual, 1)} of the input.")
    return " ".join(parts)

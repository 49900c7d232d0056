"""The tables that a run prints: peak responses with their places, and mean ratios to the buildings alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.model.scene import Analysis
from pounding_cli.numbers import NOTHING, count_histories, pluralize
from pounding_cli.questions.run.twist import CONTACT_MARK, format_length, replace_by_lines
from pounding_cli.report.evidence import MARK, RESPONSES, Evidence, list_acting_keys
from pounding_cli.results.columns import column_of
from pounding_cli.results.flags import failed_scenes, flag_groups_of, flagged_scenes
from pounding_cli.results.plausible import MAX_DUCTILITY
from pounding_cli.study.display import key_words
from pounding_cli.tables import Column, Row, Table

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

BEYOND_MARK = "‡"
"""Stands behind a ductility far beyond the range of the storey law."""

SAME_CLOSING = 1e-6
"""Part of a closing [-] within which two are one: those of a contact and a joint of the same two floors."""

PEAKS = "Peak responses and where they occur"


@dataclass(frozen=True)
class Peak:
    """A quantity whose largest value a run prints.

    name : of its column in the table of peaks
    label : heading
    of : column of results that has its unit
    rows : of all storeys, floors or struck columns, with a column `name`; their column `part`, where they have it, says
        in which part of a floor that twists the value stands: "line 1", "high edge"
    level : "storey" or "floor"
    """

    name: str
    label: str
    of: str
    rows: pd.DataFrame
    level: str = "storey"


def build_peaks_table(results: ResultTables) -> Table:
    """Return the peak responses of every case and analysis, over buildings, storeys, motions and points of the sweep.

    A row has, for every quantity NAME, the value NAME, that of the same place of the building alone NAME_alone, and
    the place NAME_building, NAME_level, NAME_part, NAME_record and NAME_point.
    """
    scene = results.scene()
    histories = scene[["case", "analysis"]].drop_duplicates().reset_index(drop=True)
    frame = histories.set_index(["case", "analysis"])
    quantities = [peak for peak in _list_quantities(results, scene) if peak.rows[peak.name].notna().any()]
    void = _place_index(results, _meaningless_rows(scene))
    struck = _place_index(results, results.struck_links())
    columns = []
    for peak in quantities:
        places = _find_places(results, peak)
        places[f"{peak.name}_is_void"] = _place_index(results, places).isin(void)
        is_blow = peak.name == "acceleration"
        places[f"{peak.name}_is_blow"] = _place_index(results, places).isin(struck) & is_blow
        places = places.set_index(["case", "analysis"])
        frame = frame.join(places[[name for name in places if str(name).startswith(peak.name)]])
        columns.append(_peak_column(results, peak))
    gaps = _find_gaps(results)
    if len(gaps):
        frame = frame.join(gaps)
        columns.append(_gap_column(results))
    frame = frame.join(_count_flags(scene))
    if frame["flags"].notna().any():
        columns.append(Column("flags", "rows that failed or are flagged", write=_format_flags))
    frame = frame.reset_index()
    frame["is_void"] = frame["case"].isin(set(_meaningless_rows(scene)["case"]))
    places_of_rows = [Column("case", "case of the study", write=_format_case), column_of("analysis")]
    return Table("", frame, [*places_of_rows, *columns], _caption_of_peaks(results))


def build_means_table(evidence: Evidence) -> Table:
    """Return the mean ratios to the building alone of every case and building: at the roof, and in the storey where
    the mean is largest, with the mean ductility demands there; and the largest mean ductility demand."""
    rows = []
    for case, building in product(evidence.cases, evidence.buildings_without_walls):
        row: dict[str, Any] = {"case": evidence.mark_case(case), "building": building}
        for analysis, ratio in RESPONSES:
            means = mean_ratios(evidence, case, analysis, building, ratio)
            row[f"{ratio}_top"] = means.iloc[-1] if len(means) else np.nan
            row[f"{ratio}_largest"] = means.max() if len(means) else np.nan
            row[f"{ratio}_storey"] = means.idxmax() if len(means) else np.nan
        rows.append(row | _find_mean_demands(evidence, case, building, row["mu_ratio_storey"]))
    frame = pd.DataFrame(rows)
    columns = [column_of("case"), column_of("building")]
    words = []
    for analysis, ratio in RESPONSES:
        if frame[f"{ratio}_top"].notna().any():
            columns += _mean_columns(ratio)
            words.append(f"{column_of(ratio).label} {analysis}")
    if frame["mu_ratio_top"].notna().any():
        columns += _demand_columns()
    motions = len(evidence.records)
    over = f"mean of {motions} motions" if motions > 1 else "1 motion"
    point = f" at {evidence.label}" if evidence.label else ""
    return Table("", frame, columns, f"Ratios to the same building alone, {over}{point}: {', '.join(words)}")


def _find_mean_demands(evidence: Evidence, case: str, building: str, governing_storey: float) -> dict[str, float]:
    """Return the mean ductility demands of a building over the motions.

    Keys: mu and mu0, in the storey where the ratio of both is largest; mu_largest and mu_storey, over all storeys.

    governing_storey : from 1; NaN where there is none
    """
    place = {"case": case, "analysis": Analysis.INELASTIC, "building": building}
    names = ("mu", "mu0", "mu_largest", "mu_storey")
    if not np.isfinite(governing_storey):
        return dict.fromkeys(names, np.nan)
    has_ratio = np.isfinite(evidence.values("mu_ratio", **place))
    is_counted = has_ratio.any(axis=1)  # motions under which both are known
    mu = evidence.values("mu", **place)[is_counted].mean(axis=0)
    mu0 = evidence.values("mu0", **place)[is_counted].mean(axis=0)
    storey = int(governing_storey) - 1
    largest = int(np.nanargmax(mu))
    return dict(zip(names, (mu[storey], mu0[storey], mu[largest], largest + 1), strict=True))


def mean_ratios(evidence: Evidence, case: str, analysis: str, building: str, ratio: str) -> pd.Series:
    """Return the mean over the motions of a ratio to the building alone, by storey; empty where there is none.

    ratio : "V_ratio" or "mu_ratio"
    """
    if analysis not in evidence.analyses:
        return pd.Series(dtype=float)
    mean = evidence.values(f"{ratio}_mean", case=case, analysis=analysis, building=building)
    return pd.Series(mean, index=evidence.results.values("storey")).dropna()


# Peaks


def _list_quantities(results: ResultTables, scene: pd.DataFrame) -> Iterator[Peak]:
    edges = ["edge_drift_low", "edge_drift_high", "edge_drift", "edge_drift0", "edge_drift_ratio"]
    has_edges = "edge_drift" in results.arrays
    names = ["mu", "mu0", "mu_ratio", "V_ratio", "drift", "drift0", "drift_ratio", *edges * has_edges]
    storey = _without_walls(results, results.storey(*names))  # no more: sweeps may be long
    demand = replace_by_lines(results, storey)
    is_inelastic = demand["analysis"] == Analysis.INELASTIC
    yield Peak("mu", "μ", "mu", demand.assign(mu=demand["mu"].where(is_inelastic), mu_alone=demand["mu0"]))
    ratio = demand["mu_ratio"].where(is_inelastic, demand["V_ratio"])
    yield Peak("ratio", _ratio_label(scene["analysis"].unique().tolist()), "mu_ratio", demand.assign(ratio=ratio))
    yield _find_drifts(storey, "edge_drift" if has_edges else "drift")
    floor = _without_walls(results, results.floor("acceleration"))
    yield Peak("acceleration", "acceleration", "acceleration", floor, "floor")
    struck = _without_walls(results, results.struck())
    loaded = struck[struck["contact_time"] > 0]
    has_joints = not loaded["kind"].map(results.is_contact).all()
    label = "loaded columns" if has_joints else "struck columns"
    yield Peak("struck_columns", label, "shear_demand", loaded.assign(struck_columns=loaded["shear_demand"]))


def _find_drifts(storey: pd.DataFrame, name: str) -> Peak:
    """Return the drifts of storeys over their height, with those of the buildings alone.

    name : "drift", or "edge_drift" where floors twist, which says at which edge it is largest
    """
    drift = storey[name].where(storey[name] > 0)
    drifts = storey.rename(columns={"drift": "drift_length"})
    drifts = drifts.assign(
        drift=storey[f"{name}_ratio"], drift_alone=storey[f"{name}_ratio"] * storey[f"{name}0"] / drift
    )
    if name == "edge_drift":
        low = storey["edge_drift_low"]
        high = storey["edge_drift_high"]
        edge = np.where(high > low, "high edge", "low edge")
        drifts["part"] = np.where(np.isclose(low, high, rtol=1e-9), "", edge)
    return Peak("drift", "drift", "drift_ratio", drifts)


def _ratio_label(analyses: Sequence[str]) -> str:
    if len(analyses) > 1:
        return "μ/μ₀ (V/V₀ elastic)"
    return "V/V₀" if analyses == [Analysis.ELASTIC] else "μ/μ₀"


def _without_walls(results: ResultTables, frame: pd.DataFrame) -> pd.DataFrame:
    return frame[~frame["building"].isin(results.walls)]


def _find_places(results: ResultTables, peak: Peak) -> pd.DataFrame:
    """Return the rows of the largest values, one a case and analysis, with the columns that the table of peaks has."""
    name = peak.name
    values = peak.rows[name].dropna()
    keys = [peak.rows[key][values.index] for key in ("case", "analysis")]
    rows = peak.rows.loc[values.groupby(keys, sort=False).idxmax()]
    points = [_format_point(results, row) for row in rows.to_dict("records")]
    places: dict[str, Any] = {
        f"{name}_building": rows["building"],
        f"{name}_level": rows[peak.level],
        f"{name}_part": rows.get("part", ""),
        f"{name}_record": rows["record"],
        f"{name}_point": points,
    }
    kept = [*results.axes, "case", "analysis", "record", name]
    kept += [f"{name}_alone"] if f"{name}_alone" in rows else []
    return rows[kept].assign(**places)


def _format_point(results: ResultTables, row: Row) -> str:
    """Return the point of the sweep of a row: "gap = 5 cm"; "" where nothing is swept that its case depends on."""
    keys = list_acting_keys(results, row["case"])
    words = [key_words(key) for key in results.axes]
    labels = {key: word if words.count(word) == 1 else key for key, word in zip(results.axes, words, strict=True)}
    return ", ".join(f"{labels[key]} = {results.value_label(key, row[key])}" for key in keys)


def _peak_column(results: ResultTables, peak: Peak) -> Column:
    name = peak.name
    of = column_of(peak.of, results.units)
    has_motions = len(results.names("record")) > 1
    number = Column(name, of.text, of.unit, peak.label, digits=3)

    def write(row: Row) -> str:
        if not np.isfinite(row[name]):
            return NOTHING
        marks = [MARK] if row[f"{name}_is_void"] else []
        marks += [CONTACT_MARK] if row[f"{name}_is_blow"] else []
        marks += [BEYOND_MARK] if name == "mu" and row[name] > MAX_DUCTILITY else []
        text = " ".join([number.format(row[name]), *marks])
        alone = row.get(f"{name}_alone", np.nan)
        return f"{text} (alone {number.format(alone)})" if np.isfinite(alone) else text

    def write_place(row: Row) -> str:
        if not np.isfinite(row[name]):
            return ""
        place = [row[f"{name}_building"], f"{peak.level} {row[f'{name}_level']:.0f}"]
        place += [row[f"{name}_part"]] if row[f"{name}_part"] else []
        place += [row[f"{name}_record"]] if has_motions else []
        return "\n".join(filter(None, (", ".join(place), row[f"{name}_point"])))

    return Column(name, of.text, of.unit, peak.label, digits=3, write=write, below=write_place)


def _place_index(results: ResultTables, rows: pd.DataFrame) -> pd.MultiIndex:
    """Return the time histories of some rows: point of the sweep, case, analysis and motion."""
    return pd.MultiIndex.from_frame(rows[[*results.axes, "case", "analysis", "record"]])


def _meaningless_rows(scene: pd.DataFrame) -> pd.DataFrame:
    """Return the flags that take the meaning from the numbers of a scene."""
    flagged = flagged_scenes(scene)
    return flagged[flagged["meaningless"]]


def _caption_of_peaks(results: ResultTables) -> str:
    parts = ["buildings", "storeys", *(["motions"] if len(results.names("record")) > 1 else [])]
    parts += ["points of the sweep"] if results.axes else []
    return f"{PEAKS}: largest over {', '.join(parts[:-1])} and {parts[-1]}"


# Gaps and flags


def _find_gaps(results: ResultTables) -> pd.DataFrame:
    """Return by case and analysis the link that closes closest to its gap, or furthest beyond it.

    Of a contact and a joint of the same two floors it is the contact. A joint between floors that do not face each
    other has no gap between its ends; it stands here only where the case has no other link.

    joint : kind of the joint that closes as far as that, "" where none does
    crosses_gap : whether there is a gap between the ends of the link
    has_contact : whether floors of the case may strike
    histories, struck : number of time histories, and of those in which some floors of the case strike
    street : place of the link along it, NaN where all links of the case stand at one place
    """
    has_inclined = "facing" in results.arrays
    has_places = "street" in results.arrays
    link = results.link("kind", "gap", "max_closing", "impacts", *["facing"] * has_inclined, *["street"] * has_places)
    if link.empty:
        return pd.DataFrame()
    link["is_contact"] = link["kind"].map(results.is_contact).astype(bool)
    link["crosses_gap"] = (link["facing"] == 1.0) | link["is_contact"] if has_inclined else True
    rows: dict[tuple[str, str], dict[str, Any]] = {}
    place: Any
    for place, here in link[link["max_closing"].notna()].groupby(["case", "analysis"], sort=False):
        across_gap = here[here["crosses_gap"]]
        candidates = across_gap if len(across_gap) else here
        beyond = candidates["max_closing"] - candidates["gap"]
        furthest = candidates[beyond >= beyond.max() - SAME_CLOSING * candidates["max_closing"].abs()]
        worst = furthest.iloc[int(furthest["is_contact"].argmax())]
        keys = list_acting_keys(results, place[0])
        is_struck = here.groupby([*keys, "record"], sort=False)["impacts"].max() > 0
        rows[place] = {
            "closing": worst["max_closing"],
            "gap": worst["gap"],
            "kind": worst["kind"],
            "joint": next(iter(furthest["kind"][~furthest["is_contact"]]), ""),
            "crosses_gap": worst["crosses_gap"],
            "has_contact": here["is_contact"].any(),
            "struck": int(is_struck.sum()),
            "histories": len(is_struck),
            "street": worst["street"] if has_places and here["street"].max() > here["street"].min() else np.nan,
        }
    names = ["closing", "gap", "kind", "joint", "crosses_gap", "has_contact", "struck", "histories", "street"]
    frame = pd.DataFrame.from_dict(rows, orient="index", columns=names)
    frame.index = pd.MultiIndex.from_tuples(frame.index, names=["case", "analysis"])
    return frame


def _gap_column(results: ResultTables) -> Column:
    """Return the column of gaps: floors that strike by their penetration, all others by their closing of the gap.

    Below it stands in how many time histories floors strike, and which joint closes as far.
    """
    unit = results.units.get("gap") or results.units["max_closing"]
    number = Column("closing", unit=unit, digits=3)

    def write(row: Row) -> str:
        if not np.isfinite(row["closing"]):
            return NOTHING
        beyond = row["closing"] - row["gap"]
        if beyond > 0 and results.is_contact(row["kind"]):
            return f"penetration {number.format(beyond)} {unit.name}"
        if not row["crosses_gap"]:
            return f"closes {number.format(row['closing'])} {unit.name}"
        return f"closes {number.format(row['closing'])} of {unit.text(row['gap'])}"

    def write_below(row: Row) -> str:
        if not np.isfinite(row["closing"]):
            return ""
        along = f", at {format_length(row['street'])} along the street" if np.isfinite(row["street"]) else ""
        lines = [write_contact(row)] if row["has_contact"] else []
        is_told = row["closing"] > row["gap"] or not row["has_contact"]
        lines += [write_joint(row)] if row["joint"] and is_told else []
        return "\n".join(lines) + along

    def write_contact(row: Row) -> str:
        if not row["struck"]:
            return "no contact"
        count = int(row["histories"])
        histories = count_histories(count) if results.axes else pluralize(count, "motion")
        gap = f", gap {unit.text(row['gap'])}" if row["closing"] > row["gap"] else ""
        return f"contact in {row['struck']:.0f} of {histories}{gap}"

    def write_joint(row: Row) -> str:
        words = [row["joint"]]
        if not row["crosses_gap"]:
            words.append("ends at different heights")
        beyond = row["closing"] - row["gap"]
        if beyond > 0:
            words.append(f"{number.format(beyond)} {unit.name} beyond the gap")
        return ", ".join(words)

    label = "gap"  # without a unit, which the cells have
    return Column("closing", "largest closing of two floors", label=label, write=write, below=write_below)


def _count_flags(scene: pd.DataFrame) -> pd.DataFrame:
    """Return by case and analysis how many of its rows failed or are flagged, and the kinds of flags."""
    groups = flag_groups_of(scene)
    rows = {}
    place: Any
    for place, here in scene.groupby(["case", "analysis"], sort=False):
        counts = {group.flag: group.count for group in groups if (group.case, group.analysis) == place}
        if lost := len(failed_scenes(here)):
            counts = {f"{lost} failed": lost} | counts
        rows[place] = {
            "flags": max(counts.values()) if counts else np.nan,
            "flag_kinds": "; ".join(counts),
            "rows": len(here),
        }
    frame = pd.DataFrame.from_dict(rows, orient="index", columns=["flags", "flag_kinds", "rows"])
    frame.index = pd.MultiIndex.from_tuples(frame.index, names=["case", "analysis"])
    return frame


def _format_flags(row: Row) -> str:
    if not np.isfinite(row["flags"]):
        return NOTHING
    return f"{row['flags']:.0f} of {row['rows']:.0f}\n{row['flag_kinds']}"


def _format_case(row: Row) -> str:
    return f"{row['case']} {MARK}" if row["is_void"] else str(row["case"])


# Means


def _mean_columns(ratio: str) -> list[Column]:
    """Return the columns of a mean ratio: at the top, and in the storey where it is largest."""
    label = column_of(ratio).label
    text = f"mean of {ratio} over the motions"
    return [
        Column(f"{ratio}_top", f"{text}, top storey", label=f"{label} at top", optional=True),
        Column(f"{ratio}_largest", f"{text}, largest of all storeys", label=f"{label} largest"),
        Column(f"{ratio}_storey", "storey of that largest mean", label="in storey", digits=0),
    ]


def _demand_columns() -> list[Column]:
    """Return the columns of mean ductility demands: where their ratio is largest, and where they are largest."""
    return [
        Column("mu", "mean of mu over the motions, in the storey of the largest mean of mu_ratio", label="μ there"),
        Column("mu0", "mean of mu0 over the motions, in that storey", label="μ₀ there"),
        Column("mu_largest", "mean of mu over the motions, largest of all storeys", label="μ largest"),
        Column("mu_storey", "storey of that largest mean", label="in storey", digits=0),
    ]

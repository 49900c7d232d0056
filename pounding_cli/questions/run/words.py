"""What a run says: the answer in sentences, its tables, and what a reader should know of the numbers."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.laws import link_symbol
from pounding_cli.numbers import NOTHING, count_histories, format_number, pluralize
from pounding_cli.report.background import advice, trust
from pounding_cli.report.evidence import MARK, RESPONSES, Evidence, motion_sentence, nominal
from pounding_cli.results.columns import column_of
from pounding_cli.results.flags import failed_scenes, flag_groups_of, flagged_scenes
from pounding_cli.study.display import key_words
from pounding_cli.tables import Table, table_of_texts

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables


def list_tables(results: ResultTables) -> list[Table]:
    """Return the tables that a terminal prints."""
    return [largest(results, results.scene()), means(nominal(results))]


def list_sentences(results: ResultTables) -> list[str]:
    """Return the answer in sentences."""
    return sentences(nominal(results))


def list_notes(results: ResultTables) -> list[str]:
    """Return how far the numbers go, and what a reader should know of them."""
    return notes(results, nominal(results), results.scene())


def mean_ratios(shown: Evidence, case: str, analysis: str, building: str, ratio: str) -> pd.Series:
    """Return the mean over the motions of a ratio to the building alone, by storey; empty where there is none.

    ratio : "V_ratio" or "mu_ratio"
    """
    if analysis not in shown.analyses:
        return pd.Series(dtype=float)
    values = shown.values(ratio, case=case, analysis=analysis, building=building)
    known = np.isfinite(values)
    mean = np.where(known, values, 0.0).sum(axis=0) / np.where(known.any(axis=0), known.sum(axis=0), np.nan)
    return pd.Series(mean, index=shown.results.values("storey")).dropna()


def sentences(shown: Evidence) -> list[str]:
    """What the run means: between which cases the mean ratios of the main building lie."""
    said = []
    for analysis, ratio in RESPONSES:
        means = {case: mean_ratios(shown, case, analysis, shown.main, ratio) for case in shown.cases}
        known = sorted((case for case, of in means.items() if len(of)), key=lambda case: means[case].max())
        ends = [
            f"{format_number(means[case].max(), 3)} ({case}, storey {means[case].idxmax()})"
            for case in dict.fromkeys([*known[:1], *known[-1:]])
        ]
        if ends:
            said.append(f"{column_of(ratio).label} {analysis} {'from ' * (len(ends) > 1)}{' to '.join(ends)}")
    where = f" at {shown.label}" if shown.label else ""
    over = f", mean of {pluralize(len(shown.records), 'motion')}" if len(shown.records) > 1 else ""
    return [f"{shown.main}{where}{over}, largest over the height: {'; '.join(said)}."] if said else []


def notes(results: ResultTables, shown: Evidence, scene: pd.DataFrame) -> list[str]:
    """How far the numbers go, and what a reader should know of them."""
    said = [
        f"{trust(scene, results.units)} {motion_sentence(shown.records)}",
        "μ: ductility; over alone: μ/μ₀ of inelastic, V/V₀ of elastic storeys, to the building alone under the same "
        "motion; alone: the same storey of the building alone under the same motion; drift in % of the storey height. "
        "Of a gap the largest approach of two floors; beyond it they are in contact, and the penetration, which the "
        "impact stiffness governs, is how far they press into each other.",
    ]
    if len(shown.cases) > len(shown.plotted):
        said.append(f"Figures show {len(shown.plotted)} of the {len(shown.cases)} cases.")
    for group in flag_groups_of(scene, results.units):
        said.append(f"{f'Not meaningful ({MARK})' if group.meaningless else 'Note'}: {group}.")
    return [*said, *advice(results)]  # warnings are printed before a run


def largest(results: ResultTables, scene: pd.DataFrame) -> Table:
    """The largest demand, ratio to the building alone, drift, acceleration, closing and shear of struck columns of
    every case and analysis over buildings, storeys, motions and points of the sweep, each with its place."""
    struck, analyses = results.struck(), scene["analysis"].unique().tolist()
    columns = ["mu", "mu0", "mu_ratio", "V_ratio", "drift", "drift0", "drift_ratio"]
    storey = results.storey(*columns)  # no more: sweeps may be long
    inelastic = storey["analysis"] == "inelastic"
    storey["mu_ratio"] = storey["mu_ratio"].where(inelastic, storey.pop("V_ratio"))
    storey["mu"] = storey["mu"].where(inelastic)
    drift = storey.pop("drift")
    storey["drift_ratio0"] = storey["drift_ratio"] * storey.pop("drift0") / drift.where(drift > 0)
    both = "μ/μ₀ (V/V₀ elastic)" if len(analyses) > 1 else "V/V₀" if analyses == ["elastic"] else "μ/μ₀"
    wanted = {
        "μ": (storey, "mu"),
        both: (storey, "mu_ratio"),
        "drift": (storey, "drift_ratio"),
        "acceleration": (results.floor("acceleration"), "acceleration"),
        "struck columns": (struck[struck["impacts"] > 0] if len(struck) else struck, "shear_demand"),
    }
    flagged = flagged_scenes(scene)
    flagged = flagged[flagged["meaningless"]]
    void = pd.MultiIndex.from_frame(flagged[[*results.axes, "case", "analysis", "record"]])
    wanted = {head: (frame[~frame["building"].isin(results.walls)], name) for head, (frame, name) in wanted.items()}
    cells = {head: _cells(results, name, frame, void) for head, (frame, name) in wanted.items() if name in frame}
    table = pd.DataFrame(cells | {"gap": _gaps(results), "flags": _flags(scene)})
    order = pd.MultiIndex.from_frame(scene[["case", "analysis"]].drop_duplicates())
    table = table.reindex(order).dropna(axis=1, how="all").fillna(NOTHING).reset_index()
    marked = set(zip(flagged["case"], flagged["analysis"], strict=True))
    places = zip(table["case"], table["analysis"], strict=True)
    table["case"] = [f"{place[0]} {MARK}" if place in marked else place[0] for place in places]
    return _table_of_records("Largest of all time histories, and where", table.to_dict("records"))


def _cells(results: ResultTables, name: str, frame: pd.DataFrame, void: pd.MultiIndex) -> dict[tuple[str, str], str]:
    """By case and analysis the largest number as people read it, with that of the building alone where there is one,
    MARK where it means nothing, and below it where it stands."""
    how, found = column_of(name, results.units), {}
    values = frame[name].dropna()
    largest = values.groupby([frame[key][values.index] for key in ("case", "analysis")], sort=False).idxmax()
    level = "floor" if "floor" in frame else "storey"
    several = len(results.data["record"]) > 1
    words = [key_words(key) for key in results.axes]
    named = {key: said if words.count(said) == 1 else key for key, said in zip(results.axes, words, strict=True)}
    for row in frame.loc[largest].to_dict("records"):
        where = [row["building"], f"{level} {row[level]}", *([row["record"]] if several else [])]
        point = ", ".join(f"{said} = {results.value_label(key, row[key])}" for key, said in named.items())
        mark = f" {MARK}" if tuple(row[key] for key in void.names) in void else ""
        number = f"{format_number(row[name] / how.unit.factor, 3)} {how.unit.name}".rstrip() + mark
        alone = row.get(f"{name}0")
        if alone is not None:
            number += f" (alone {format_number(alone / how.unit.factor, 3)})"
        found[row["case"], row["analysis"]] = "\n".join(filter(None, (number, ", ".join(where), point)))
    return found


def _gaps(results: ResultTables) -> dict[tuple[str, str], str]:
    """Return by case and analysis how far the link closes that comes closest to its gap or goes furthest beyond.

    Floors that strike are told by their penetration beyond the gap, all others by their closing of the gap.
    """
    link, found = results.link("kind", "gap", "max_closing", "impacts"), dict[tuple[str, str], str]()
    if link.empty:
        return found
    unit = results.units.get("gap") or results.units["max_closing"]
    place: Any
    for place, here in link[link["max_closing"].notna()].groupby(["case", "analysis"], sort=False):
        row = here.iloc[int((here["max_closing"] - here["gap"]).argmax())]
        struck = here.groupby([*results.axes, "record"], sort=False)["impacts"].max() > 0
        all_histories = count_histories(len(struck)) if results.axes else pluralize(len(struck), "motion")
        closing = row["max_closing"]
        beyond = f"{format_number(unit.number(closing - row['gap']), 3)} {unit.name}"
        number = f"{format_number(unit.number(closing), 3)} of {unit.text(row['gap'])}"
        below = "no contact"
        if link_symbol(row["kind"]) != "gap":
            below = f"{row['kind']}, {beyond} beyond the gap" if closing > row["gap"] else row["kind"]
        elif closing > row["gap"]:
            number = f"penetration {beyond}"
            below = f"contact in {struck.sum()} of {all_histories}, gap {unit.text(row['gap'])}"
        elif struck.any():
            below = f"contact in {struck.sum()} of {all_histories}"
        found[place] = f"{number}\n{below}"
    return found


def _flags(scene: pd.DataFrame) -> dict[tuple[str, str], str]:
    """By case and analysis how many rows failed or are flagged."""
    found, groups = {}, flag_groups_of(scene)
    place: Any
    for place, here in scene.groupby(["case", "analysis"], sort=False):
        mine = {group.flag: group.count for group in groups if (group.case, group.analysis) == place}
        if lost := len(failed_scenes(here)):
            mine = {f"{lost} failed": lost} | mine
        if mine:
            found[place] = f"{max(mine.values())} of {len(here)}\n{'; '.join(mine)}"
    return found


def means(shown: Evidence) -> Table:
    """The largest mean ratio to the building alone of every case and building, with its storey."""
    rows = []
    for case, building in product(shown.cases, shown.built):
        row: dict[str, Any] = {"case": shown.marked(case), "building": building}
        for analysis, ratio in RESPONSES:
            of, name = mean_ratios(shown, case, analysis, building, ratio), f"{column_of(ratio).label} {analysis}"
            row[f"{name}, roof"] = format_number(of.iloc[-1]) if len(of) else np.nan
            row[f"{name}, largest (storey)"] = f"{format_number(of.max())} ({of.idxmax()})" if len(of) else np.nan
        rows.append(row)
    frame = pd.DataFrame(rows).dropna(axis=1, how="all").fillna(NOTHING)
    at = f" at {shown.label}" if shown.label else ""
    what = f"Ratios to the building alone, mean of {pluralize(len(shown.records), 'motion')}{at}"
    return _table_of_records(what, frame.to_dict("records"))


def _table_of_records(caption: str, rows: list[dict[Any, Any]]) -> Table:
    heads = list(rows[0]) if rows else []
    return table_of_texts(caption, heads, [list(row.values()) for row in rows])

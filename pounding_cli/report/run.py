"""The report of `pound run`: the largest values of every case and where they stand, figures, claims."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import pandas as pd

from pounding_cli.laws import drawn
from pounding_cli.numbers import counted, listed
from pounding_cli.report.background import background, frame_of, limits, trust
from pounding_cli.report.claims import claim_sections
from pounding_cli.report.document import Report, Section
from pounding_cli.report.evidence import MARK, Evidence, nominal, points
from pounding_cli.report.explorer import explored
from pounding_cli.report.figures import RESPONSES, drawn_part, main_building, profiles
from pounding_cli.report.player import players
from pounding_cli.report.sweep import Asked, sweep_pictures
from pounding_cli.report.table import NOTHING, column_of, digits, from_rows
from pounding_cli.results.flags import flag_groups_of, flagged_scenes
from pounding_cli.results.tables import Table
from pounding_cli.solver.response import NEVER_CLOSES, OUTCOMES

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

TABLES = ("summary", "storey", "floor", "link", "struck", "scene", "flagged", "records", "buildings")
"""The tables of scenes that a report has."""


def run_report(results: Results, asked: Asked | None = None) -> Report:
    """What the results of a run say.

    Raises
    ------
    InputError : something asked for over the sweep is not there
    """
    shown = nominal(results)
    part = drawn_part(shown)
    return Report(
        **frame_of(results, shown, results.scene()),
        answer=Section(
            "", sentences(shown), [largest(results), means(shown)], profiles(part)[:1], notes(results, shown)
        ),
        more=partial(_more, results, part, asked),
    )


def _more(results: Results, shown: Evidence, asked: Asked | None) -> list[Section]:
    evidences, swept = points(results), sweep_pictures(results, shown, asked)
    looked = explored(results, shown)
    scenes = players(results, evidences)
    keep = f"keep: {{histories: {{cases: [{shown.cases[0]}], records: [{shown.records['record'].iloc[0]}]}}}}"
    none = f"This results file has no histories. To see moving buildings, add `{keep}` to the study and run it again."
    left = "" if len(scenes) in (0, len(results.histories())) else f"{len(scenes)} of the kept scenes are here."
    return [
        *([Section("Over the sweep", pictures=swept)] if swept else []),
        Section("Look around", widget="explorer", data=looked),
        Section("Moving buildings", [left or (none if not scenes else "")], widget="player", data={"scenes": scenes}),
        *claim_sections(results, shown.label),
        Section("Figures", pictures=profiles(shown)[1:]),
        *background(results, shown, results.scene(), TABLES),
    ]


def sentences(shown: Evidence) -> list[str]:
    """What the run means: between which cases the mean ratios of the main building lie."""
    building, said = main_building(shown), []
    for analysis, ratio, _ in RESPONSES:
        largest = {case: shown.means(case, analysis, building, ratio) for case in shown.cases}
        known = sorted((case for case, of in largest.items() if len(of)), key=lambda case: largest[case].max())
        ends = [
            f"{digits(largest[case].max(), 3)} ({case}, storey {largest[case].idxmax()})"
            for case in dict.fromkeys([*known[:1], *known[-1:]])
        ]
        if ends:
            said.append(f"{column_of(ratio).label} {analysis} {'from ' * (len(ends) > 1)}{' to '.join(ends)}")
    where = f" at {shown.label}" if shown.label else ""
    over = f", mean of {counted(len(shown.records), 'motion')}" if len(shown.records) > 1 else ""
    return [f"{building}{where}{over}, largest over the height: {'; '.join(said)}."] if said else []


def notes(results: Results, shown: Evidence) -> list[str]:
    """How far the numbers go, and what a reader should know of them."""
    sources = shown.records.drop_duplicates("record").groupby("source", sort=False)["record"].agg(list)
    said = [
        f"{trust(results.scene(), results.units)} Motions, "
        f"{'; '.join(f'{source}: {listed(named)}' for source, named in sources.items())}.",
        "μ: ductility; over alone: μ/μ₀ of inelastic, V/V₀ of elastic storeys, to the building alone under the same "
        "motion; drift in % of the storey height; closing: largest approach of two floors, which touch beyond the gap.",
    ]
    if results.assumed_heights:
        said.append(f"Heights of {', '.join(results.assumed_heights)}: 3 m, as the study writes no height.")
    if len(shown.cases) > len(drawn_part(shown).cases):
        said.append(f"Figures show {len(drawn_part(shown).cases)} of the {len(shown.cases)} cases.")
    never = int(results.scene()["dropped"].str.contains(NEVER_CLOSES, regex=False).sum())
    if never:
        which = counted(never, "run has a gap that never closes", "runs have a gap that never closes")
        said.append(f"{which}: of scenes that differ in such gaps alone, one was simulated.")
    for group in flag_groups_of(results.scene(), results.units):
        said.append(f"{f'Not meaningful ({MARK})' if group.meaningless else 'Note'}: {group}.")
    limited = limits(results)
    return [*said, *(limited.sentences[len(results.warnings) :] if limited else [])]


def largest(results: Results) -> Table:
    """The largest demand, ratio to the building alone, drift, acceleration, closing and shear of struck columns of
    every case and analysis over buildings, storeys, motions and points of the sweep, each with its place."""
    scene, storey = results.scene(), results.storey()
    struck = results.struck()
    ratio = storey["mu_ratio"].where(storey["analysis"] == "inelastic", storey["V_ratio"])
    analyses = list(dict.fromkeys(scene["analysis"]))
    both = "μ/μ₀ (V/V₀ elastic)" if len(analyses) > 1 else "V/V₀" if analyses == ["elastic"] else "μ/μ₀"
    wanted: dict[str, tuple[pd.DataFrame, str]] = {
        "μ": (storey[storey["analysis"] == "inelastic"], "mu"),
        both: (storey.assign(mu_ratio=ratio), "mu_ratio"),
        "drift": (storey, "drift_ratio"),
        "acceleration": (results.floor(), "acceleration"),
        "struck columns": (struck if struck.empty else struck[struck["impacts"] > 0], "shear_demand"),
    }
    void = flagged_scenes(scene)
    void = void[void["meaningless"]].drop_duplicates([*results.axes, "case", "analysis", "record"])
    rows: dict[tuple[str, str], dict[str, str]] = {
        (case, analysis): {"case": case, "analysis": analysis}
        for case in dict.fromkeys(scene["case"])
        for analysis in analyses
    }
    for head, (frame, name) in wanted.items():
        if name not in frame or frame[name].isna().all():
            continue
        known = frame[frame[name].notna()]
        for row in known.loc[known.groupby(["case", "analysis"], sort=False)[name].idxmax()].to_dict("records"):
            rows[row["case"], row["analysis"]][head] = _cell(results, name, row, void)
    _closing(results, rows)
    _flags(scene, rows)
    heads = [head for head in ("case", "analysis", *wanted, "closing / gap", "flags")
             if any(head in cells for cells in rows.values())]  # fmt: skip
    table = [[cells.get(head, NOTHING) for head in heads] for cells in rows.values()]
    return from_rows("Largest of all runs, and where", heads, table)


def means(shown: Evidence) -> Table:
    """The largest mean ratio to the building alone of every case and building, with its storey."""
    rows = []
    for case in shown.cases:
        for building in shown.group:
            cells = [shown.marked(case), building]
            for analysis, ratio, _ in RESPONSES:
                of = shown.means(case, analysis, building, ratio)
                cells += (
                    [digits(of.iloc[-1], 4), f"{digits(of.max(), 4)} ({of.idxmax()})"] if len(of) else [NOTHING] * 2
                )
            rows.append(cells)
    heads = ["case", "building"]
    for analysis, ratio, _ in RESPONSES:
        heads += [f"{column_of(ratio).label} {analysis}, roof", "largest (storey)"]
    over = counted(len(shown.records), "motion")
    table = from_rows(
        f"Ratios to the building alone, mean of {over}{f' at {shown.label}' * bool(shown.label)}", heads, rows
    )
    empty = [place for place in range(2, len(heads)) if (table.frame[place] == NOTHING).all()]
    return replace(table, frame=table.frame.drop(columns=empty))


def _cell(results: Results, name: str, row: Mapping[Any, Any], void: pd.DataFrame) -> str:
    """A number as people read it, MARK where it means nothing, and below it where it stands."""
    level = "floor" if "floor" in row else "storey"
    where = [row["building"], f"{level} {row[level]}"]
    where += [row["record"]] if len(results.records()["record"].unique()) > 1 else []
    point = ", ".join(f"{key} = {results.value_label(key, row[key])}" for key in results.axes)
    place = [*results.axes, "case", "analysis", "record"]
    empty = len(void) and (void[place] == [row[key] for key in place]).all(axis=1).any()
    how = column_of(name, results.units)
    unit = f" {how.unit.name}" if how.unit.name else ""
    number = f"{digits(row[name] / how.unit.factor, 3)}{unit}{f' {MARK}' if empty else ''}"
    return "\n".join([number, ", ".join(where), *([point] if point else [])])


def _closing(results: Results, rows: Mapping[tuple[str, str], dict[str, str]]) -> None:
    """The largest closing of the link that comes closest to its gap or goes furthest beyond."""
    link = results.link()
    link = link[link["max_closing"].notna()]
    unit = results.units.get("gap") or results.units["max_closing"]
    place = [*results.axes, "case", "analysis", "record"]
    struck = link.groupby(place, sort=False, as_index=False)["impacts"].max()
    worst = (link["max_closing"] - link["gap"]).groupby([link["case"], link["analysis"]], sort=False).idxmax()
    for row in link.loc[worst].to_dict("records"):
        here = struck[(struck["case"] == row["case"]) & (struck["analysis"] == row["analysis"])]["impacts"] > 0
        contact = f"contact in {here.sum()} of {counted(len(here), 'run')}" if here.any() else "no contact"
        number = f"{digits(unit.number(row['max_closing']), 3)} / {unit.text(row['gap'])}"
        said = contact if drawn(row["kind"]) == "gap" else str(row["kind"])
        rows[row["case"], row["analysis"]]["closing / gap"] = f"{number}\n{said}"


def _flags(scene: pd.DataFrame, rows: Mapping[tuple[str, str], dict[str, str]]) -> None:
    """How many runs failed or are flagged; a case with numbers that mean nothing is marked."""
    flags = flag_groups_of(scene)
    place: Any
    for place, here in scene.groupby(["case", "analysis"], sort=False):
        case, analysis = place
        cells, mine = rows[case, analysis], [g for g in flags if (g.case, g.analysis) == (case, analysis)]
        said = [group.flag for group in mine]
        lost = int((~here["status"].isin(OUTCOMES)).sum())
        said = [f"{lost} failed"] * (lost > 0) + said
        if any(group.meaningless for group in mine):
            cells["case"] = f"{case} {MARK}"
        if said:
            cells["flags"] = f"{max([lost, *(g.count for g in mine)])} of {len(here)}\n{'; '.join(said)}"

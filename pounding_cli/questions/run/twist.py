"""Tables of buildings whose floors twist: their frame lines, the edges of their floors, and contact by place along the
street."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.model.links import BASE
from pounding_cli.model.scene import Analysis
from pounding_cli.report.evidence import Evidence
from pounding_cli.results.columns import column_of
from pounding_cli.tables import Column, FormatRow, Row, Table
from pounding_cli.variables import MIN_TWIST, SCENE_DIMS

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

CONTACT_MARK = "*"
"""Stands behind an acceleration or a force that the contact stiffness governs."""


def does_twist(evidence: Evidence, building: str) -> bool:
    """Return whether floors of a building twist in any time history, with its neighbours or alone."""
    if "twist" not in evidence.results.arrays:
        return False
    turns = [evidence.values(name, building=building) for name in ("twist", "twist0")]
    return bool((np.nan_to_num(turns) > MIN_TWIST).any())


def does_twist_anywhere(results: ResultTables, building: str) -> bool:
    """Return whether floors of a building twist in any time history at any point of the sweep."""
    if "twist" not in results.arrays:
        return False
    place = results.names("building").index(building)
    turns = [results.values(name)[..., place, :] for name in ("twist", "twist0")]
    return bool((np.nan_to_num(turns) > MIN_TWIST).any())


def line_values(evidence: Evidence, name: str, building: str, **places: str) -> np.ndarray:
    """Return a variable of the frame lines of a building, NaN of those across the row, shape (..., storeys, lines)."""
    is_along = np.isfinite(evidence.values("line_street", building=building))
    return np.where(is_along, evidence.values(name, building=building, **places), np.nan)


def has_lines_across(evidence: Evidence, building: str) -> bool:
    """Return whether a building has frame lines across the row, which resist the twist alone."""
    return "line_x" in evidence.results.arrays and bool(np.isfinite(evidence.values("line_x", building=building)).any())


def keep_lines_along(results: ResultTables, name: str) -> np.ndarray:
    """Return a variable of frame lines over all its dimensions, NaN of lines across the row."""
    array = results.arrays[name]
    line_street = results.arrays["line_street"]
    shape = [size if dim in line_street.dims else 1 for dim, size in zip(array.dims, array.shape, strict=True)]
    return np.where(np.isfinite(line_street.values.reshape(shape)), array.values, np.nan)


def format_length(value: float) -> str:
    """Return a length in metres as it is written."""
    return f"{round(value, 2) + 0.0:g} m".replace("-", "−")


def replace_by_lines(results: ResultTables, storey: pd.DataFrame) -> pd.DataFrame:
    """Return rows of storeys, those of floors that twist replaced by rows of their frame lines along the row.

    storey : swept keys, case, analysis, record, building, storey, V_ratio, mu, mu0, mu_ratio; other columns are left
        out of lines

    The column `part` has the line in words, "" of storeys whose floors do not twist.
    """
    if "line" not in results.arrays:
        return storey.assign(part="")
    keys = [*results.axes, *SCENE_DIMS, "building"]
    turns = results.floor("twist", "twist0")
    twisting = turns[(turns[["twist", "twist0"]] > MIN_TWIST).any(axis=1)][keys].drop_duplicates()
    lines = results.line("V_ratio", "mu", "mu0", "mu_ratio", "street")
    lines = lines[lines["street"].notna()].merge(twisting, on=keys)
    lines["part"] = "line " + lines["line"].astype(str)
    others = storey.merge(twisting, on=keys, how="left", indicator="side")
    others = others[others["side"] == "left_only"].drop(columns="side").assign(part="")
    return pd.concat([others, lines], ignore_index=True) if len(lines) else others


def list_twist_tables(evidence: Evidence) -> list[Table]:
    """Return the tables of buildings that twist and of contact by place; none where nothing twists."""
    twisting = [name for name in evidence.buildings_without_walls if does_twist(evidence, name)]
    if not twisting:
        return []
    tables = [
        _build_line_table(evidence, twisting),
        _build_edge_table(evidence, twisting),
        _build_place_table(evidence),
    ]
    return [table for table in tables if len(table.frame)]


# Frame lines


def _build_line_table(evidence: Evidence, twisting: list[str]) -> Table:
    """Return the mean responses of the frame lines of buildings that twist, each in the storey where it is largest."""
    rows = [
        row
        for case, analysis, building in product(evidence.cases, evidence.analyses, twisting)
        for row in _iter_lines(evidence, case, analysis, building)
    ]
    columns = [
        *(column_of(name) for name in ("case", "analysis", "building")),
        Column("line", "frame line", below=_format_line_place),
        replace(_with_alone("V", "V"), optional=True),
        _with_storey("V_ratio", "V/V₀"),
        _with_alone("mu", "μ"),
        _with_storey("mu_ratio", "μ/μ₀"),
        replace(_with_alone("drift_ratio", "drift"), optional=True),
    ]
    frame = pd.DataFrame(rows)
    if len(frame):
        columns = [column for column in columns if column.name not in frame or frame[column.name].notna().any()]
    caption = f"Frame lines of floors that twist: largest of all storeys{_over_motions(evidence, frame)}"
    return Table("", frame, columns, caption)


def _iter_lines(evidence: Evidence, case: str, analysis: str, building: str) -> Iterator[dict[str, Any]]:
    """Yield a row for every frame line of a building: the largest means over the motions of all storeys, the same
    storey alone, and the storeys of the largest ratios."""
    place = {"case": case, "analysis": analysis, "building": building}
    is_known = _find_known_motions(evidence, place)
    if not is_known.any():
        return
    means = {
        name: evidence.values(f"line_{name}", **place)[is_known].mean(axis=0)
        for name in ("V", "V0", "mu", "mu0", "drift", "drift0", "drift_ratio")
    }
    means |= {name: evidence.values(f"line_{name}_mean", **place) for name in ("V_ratio", "mu_ratio")}
    if analysis == Analysis.ELASTIC:
        for name in ("mu", "mu0", "mu_ratio"):
            means[name] = np.full_like(means[name], np.nan)
    with np.errstate(invalid="ignore"):
        drift = np.where(means["drift"] > 0, means["drift"], 1)
        means["drift_ratio0"] = means["drift_ratio"] * means["drift0"] / drift
    along = evidence.values("line_street", building=building)
    across = evidence.values("line_x", building=building)
    for number in np.flatnonzero(np.isfinite(along) | np.isfinite(across)).tolist():
        row: dict[str, Any] = {
            "case": evidence.mark_case(case),
            "analysis": analysis,
            "building": building,
            "line": number + 1,
            "street": along[number],
            "x": across[number],
            "motions": int(is_known.sum()),
        }
        for name in ("V", "V_ratio", "mu", "mu_ratio", "drift_ratio"):
            by_storey = means[name][:, number]
            known = np.isfinite(by_storey).any()
            storey = int(np.nanargmax(by_storey)) if known else 0
            row |= {name: by_storey[storey] if known else np.nan, f"{name}_storey": storey + 1}
            if f"{name}0" in means:
                row[f"{name}_alone"] = means[f"{name}0"][storey, number]
        yield row


def _find_known_motions(evidence: Evidence, place: dict[str, str]) -> np.ndarray:
    """Return under which motions a building in a case and analysis has numbers, with its neighbours and alone."""
    drifts = [evidence.values(name, **place) for name in ("drift", "drift0")]
    return np.logical_and.reduce([np.isfinite(drift).any(axis=1) for drift in drifts])


def _format_line_place(row: Row) -> str:
    """Return the place of a frame line: along the street, or of one across the row from the centre of mass."""
    if np.isfinite(row["street"]):
        return f"at {format_length(row['street'])}"
    return f"across, x {format_length(row['x'])}"


def _with_alone(name: str, label: str) -> Column:
    """Return the column of a response, that of the building alone below it."""
    of = column_of(f"line_{name}")
    number = Column(name, of.text, of.unit, label, digits=3)

    def write_alone(row: Row) -> str:
        alone = row[f"{name}_alone"]
        return f"alone {number.format(alone)}" if np.isfinite(alone) else ""

    return Column(name, of.text, of.unit, label, digits=3, below=write_alone)


def _with_storey(name: str, label: str) -> Column:
    """Return the column of a ratio, its storey below it."""

    def write_storey(row: Row) -> str:
        return f"storey {row[f'{name}_storey']:.0f}" if np.isfinite(row[name]) else ""

    of = column_of(f"line_{name}")
    return Column(name, of.text, of.unit, label, digits=3, below=write_storey)


# Edges


def _build_edge_table(evidence: Evidence, twisting: list[str]) -> Table:
    """Return the mean drifts at the edges and the centre of mass of buildings that twist, and their twist; each the
    largest of all storeys or floors."""
    rows = []
    for case, analysis, building in product(evidence.cases, evidence.analyses, twisting):
        place = {"case": case, "analysis": analysis, "building": building}
        is_known = _find_known_motions(evidence, place)
        if not is_known.any():
            continue
        height = evidence.values("height", building=building)
        row: dict[str, Any] = {**place, "case": evidence.mark_case(case), "motions": int(is_known.sum())}
        for name in ("edge_drift_low", "drift", "edge_drift_high", "twist"):
            scale = 1.0 if name == "twist" else height
            for state in ("", "0"):
                values = evidence.values(f"{name}{state}", **place)[is_known].mean(axis=0) / scale
                if name == "twist":
                    values = np.where(values <= MIN_TWIST, 0.0, values)
                row[f"{name}{state}"] = np.nanmax(values)
        rows.append(row)
    drift = column_of("edge_drift_ratio").unit
    twist = column_of("twist").unit

    def build_column(name: str, label: str, unit: Any) -> Column:
        number = Column(name, column_of(name).text, unit, label, digits=3)

        def write_alone(row: Row) -> str:
            return f"alone {number.format(row[f'{name}0'])}" if np.isfinite(row[f"{name}0"]) else ""

        return Column(name, number.text, unit, label, digits=3, below=write_alone)

    columns = [
        *(column_of(name) for name in ("case", "analysis", "building")),
        build_column("edge_drift_low", "low edge", drift),
        replace(build_column("drift", "centre", drift), optional=True),
        build_column("edge_drift_high", "high edge", drift),
        build_column("twist", "twist", twist),
    ]
    frame = pd.DataFrame(rows)
    caption = (
        "Drift of floors that twist at the edges of the plan and at the centre of mass: largest of all storeys"
        f"{_over_motions(evidence, frame)}"
    )
    return Table("", frame, columns, caption)


# Contact by place


def _build_place_table(evidence: Evidence) -> Table:
    """Return contacts, forces and closings of every case by place along the street, over all floors and motions."""
    force_column = column_of("peak_force")
    number = Column("peak_force", force_column.text, force_column.unit, digits=3)

    def write_force(row: Row) -> str:
        return f"{number.format(row['peak_force'])}{f' {CONTACT_MARK}' if row['is_blow'] else ''}"

    def below(name: str) -> FormatRow:
        return lambda row: str(row[name])

    closing_column = column_of("max_closing", evidence.results.units)
    columns = [
        *(column_of(name) for name in ("case", "analysis")),
        Column("pair", "buildings", label="between", below=below("kind_below")),
        Column("street", "place along the street", column_of("street").unit, "along street"),
        Column("contacts", "number of contacts of all floors", label="contacts", write=_format_contacts, is_right=True),
        Column("peak_force", number.text, number.unit, "force", write=write_force, below=below("force_floors")),
        Column(
            "max_closing", closing_column.text, closing_column.unit, "closing", digits=3,
            below=below("closing_floors"), optional=True,
        ),
    ]  # fmt: skip
    many = len(evidence.names("record")) > 1
    over = "contacts of all floors, force and closing the largest of all floors"
    if many:
        over = "contacts the mean of the motions, force and closing the largest of all floors and motions"
    point = f", at {evidence.label}" if evidence.label else ""
    frame = pd.DataFrame(_list_places(evidence))
    return Table("", frame, columns, f"Contact by place along the street: {over}{point}")


def _list_places(evidence: Evidence) -> list[dict[str, Any]]:
    """Return a row for every place along the street of two neighbours that are linked at several places, and for every
    kind of link there."""
    link = evidence.link
    if "street" not in link or link.empty:
        return []
    link = link.assign(street=link["street"].round(6))
    pair_keys = ["case", "analysis", "left", "right"]
    rows = []
    keys = [*pair_keys, "street", "kind"]
    for place, here in link.groupby(keys, sort=False, dropna=False):  # a base does not turn: NaN
        if np.isfinite(here["peak_force"]).any():
            values = zip(keys, place, strict=True)
            rows.append(dict(values) | _summarize_place(evidence, here))
    streets: dict[tuple[Any, ...], set[str]] = {}
    kinds: dict[tuple[Any, ...], set[str]] = {}
    for row in rows:
        pair = tuple(row[key] for key in pair_keys)
        streets.setdefault(pair, set()).add(str(row["street"]))
        kinds.setdefault(pair, set()).add(row["kind"])
    shown_rows = []
    for row in rows:
        pair = tuple(row[key] for key in pair_keys)
        if len(streets[pair]) > 1:
            row["kind_below"] = row["kind"] if len(kinds[pair]) > 1 else ""
            shown_rows.append(row)
    return shown_rows


def _summarize_place(evidence: Evidence, links: pd.DataFrame) -> dict[str, Any]:
    """Return contacts, the largest force and the largest closing of the links at one place along the street."""
    force = links.iloc[int(links["peak_force"].argmax())]
    closing = links.iloc[int(links["max_closing"].argmax())]
    acts = force["peak_force"] > 0
    contacts = links.groupby("record", sort=False)["impacts"].sum(min_count=1).mean()
    return {
        "pair": f"{force['left']}|{force['right']}",
        "contacts": np.nan if evidence.results.link_symbol(str(force["kind"])) == "bar" else contacts,
        "peak_force": force["peak_force"],
        "force_floors": _format_floors(force) if acts else "",
        "max_closing": closing["max_closing"],
        "closing_floors": _format_floors(closing),
        "is_blow": evidence.results.is_contact(force["kind"]) and acts,
    }


def _format_contacts(row: Row) -> str:
    """Return a number of contacts as it is written; a link that joins its floors at any closing has none."""
    return f"{row['contacts']:.1f}".removesuffix(".0") if np.isfinite(row["contacts"]) else "–"


def _format_floors(link: Any) -> str:
    """Return the floors that a link joins: "floor 3", "floors 3|2" where they differ, "base" of bases."""
    if link["floor"] == link["right_floor"]:
        return f"floor {link['floor']}" if link["floor"] else BASE
    return f"floors {link['floor']}|{link['right_floor']}"


def _over_motions(evidence: Evidence, frame: pd.DataFrame) -> str:
    """Return what the means are over, and the point of a sweep, as they stand in captions.

    frame : with a column `motions`, their number
    """
    motions = len(evidence.names("record"))
    is_complete = len(frame) == 0 or frame["motions"].min() == motions
    mean = f", mean of {motions} motions"
    if not is_complete:
        mean = f", mean of those of {motions} motions that have numbers"
    if motions == 1:
        mean = ""
    return f"{mean}{f', at {evidence.label}' if evidence.label else ''}"

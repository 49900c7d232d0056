"""The demands of a building as Pelicun reads them: a column a demand, a row a scene, units below the heading."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pounding_cli.errors import InputError
from pounding_cli.model.effects import RESIDUAL_DRIFTS
from pounding_cli.numbers import pluralize
from pounding_cli.results.flags import point_label
from pounding_cli.texts import escape_formula_list

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.results.results import ResultTables

UNITS = {"PFA": "mps2", "PID": "rad", "RID": "rad"}
"""Demands by Pelicun's names with their units: peak floor acceleration, peak and residual interstorey drift ratio."""


def demands(results: ResultTables, rows: pd.DataFrame, direction: int = 1) -> tuple[pd.DataFrame, int]:
    """Return the demand table of one building in one case and analysis, and the number of scenes that are left out.

    Left out are scenes that failed or in which a storey collapsed, of the building or of one that links join to it,
    since Pelicun takes the probability of collapse apart, and scenes without residual drifts (a flag of them has the
    reason).

    Parameters
    ----------
    results : results file
    rows : those of its table `storey` that are wanted; every point of the sweep and motion among them is a row
    direction : Pelicun's number of the direction in which the buildings move

    The rows stand in the order of the study, each under the name of its point and motion: Pelicun numbers the rows
    itself and takes any names.  The columns are called TYPE-FLOOR-DIRECTION: `PFA-0-1` is the peak acceleration of the
    ground, `PID-2-1` the drift of the second storey over its height (Zsarnoczay, A. and Deierlein, G. G. (2020).
    PELICUN - A computational framework for estimating damage, loss and community resilience. 17th World Conference on
    Earthquake Engineering).  Where floors twist, PID is that of the edge of the plan where it is larger, RID that of
    the frame line along the row where it is largest, and PFA that of the centre of mass.

    Raises
    ------
    InputError : no rows, or those of more than one building, case or analysis; a file without residual drifts
    """
    import pandas as pd

    rows = rows[~rows["building"].isin(results.walls)]
    for name in ("case", "analysis", "building"):
        there = list(dict.fromkeys(rows[name]))
        if len(there) != 1:
            hint = f"name one by --{name}: {', '.join(map(str, there))}" if there else "name others"
            raise InputError(f"Pelicun takes one {name}, not {len(there)}", hint)
    if rows["residual_drift"].isna().all():  # else they are asked for, or elastic storeys have none
        _refuse_without_residual_drifts(results)
    scene = [*results.axes, "record"]
    points = rows[scene].drop_duplicates()  # in the order of the study, which a pivot table does not keep
    keys = [*scene, "case", "analysis", "building", "storey"]
    rows = rows.merge(results.floor("acceleration").rename(columns={"floor": "storey"}), on=keys)
    over_height = (rows["drift_ratio"] / rows["drift"]).fillna(0.0)  # 1 / height
    residual_drift = rows["residual_drift"].abs()
    if "edge_drift_ratio" in rows:
        lines = results.line("residual_drift", "street")
        lines = lines[lines["street"].notna()].assign(of_line=lines["residual_drift"].abs())
        largest = lines.groupby(keys, sort=False)["of_line"].max()
        of_line = rows.merge(largest.reset_index(), on=keys, how="left")["of_line"]
        residual_drift = residual_drift.where(of_line.isna() | residual_drift.isna(), of_line)
    rows = rows.assign(
        PFA=rows["acceleration"],
        PID=rows["edge_drift_ratio" if "edge_drift_ratio" in rows else "drift_ratio"],
        RID=residual_drift * over_height,
    )
    wide = rows[rows["RID"].notna()].pivot_table(list(UNITS), scene, "storey")
    wide.columns = [f"{kind}-{storey}-{direction}" for kind, storey in wide.columns.to_list()]  # type: ignore[str-unpack]
    wide = points.merge(wide.reset_index(), on=scene)
    records = results.records()
    ground = wide[scene].merge(records[[*(key for key in scene if key in records), "pga"]], how="left")
    labels = [point_label(row, list(results.axes), results.units) for row in wide[scene].to_dict("records")]
    demand = wide.drop(columns=scene).set_axis(escape_formula_list(labels))
    demand.insert(0, f"PFA-0-{direction}", ground["pga"].to_numpy())
    units = {name: UNITS[name.split("-")[0]] for name in demand.columns}
    return pd.concat([pd.DataFrame(units, index=["Units"]), demand]), len(points) - len(demand)


def _refuse_without_residual_drifts(results: ResultTables) -> None:
    """Raise InputError where the study of a file asks for no residual drifts, which Pelicun reads."""
    effects = results.scene()["effects"]
    if not effects.map(lambda cell: RESIDUAL_DRIFTS in cell.splitlines()).any():
        wrong = f"{results.path}: the residual drifts that Pelicun reads were not found, since the study asks for none"
        raise InputError(wrong, "add `residual_drift: true` to the study and run it again")


def describe_left_out(count: int, of: int) -> str:
    """Return a sentence on the scenes that are left out and what to do about them."""
    verb = "is" if count == 1 else "are"
    sentence = f"{count} of {pluralize(of, 'scene')} collapsed, failed or have no residual drift and {verb} left out"
    return f"{sentence} (pound show FILE flagged): give Pelicun the share that collapsed as probability of collapse"

"""Runs the golden studies and compares their tables with the stored ones."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pandas as pd
import yaml
from click.testing import CliRunner

import pounding_cli as pound
from pounding_cli.cli.main import cli
from tests.golden import motions

HERE = Path(__file__).parent
STUDIES = {path.stem: path for path in sorted((HERE / "studies").glob("*.yaml"))}
TABLES = HERE / "tables"
WORKFLOWS = {
    "gap": "gap",
    "gap-codes": "gap",
    "fragility": "fragility",
    "stripes": "fragility",
    "cloud": "fragility",
    "struck-columns": "fragility",
    "sensitivity": "sensitivity",
    "morris": "sensitivity",
    "statements": "sensitivity",
    "optimise": "optimise",
    "optimise-worst": "optimise",
}
"""The question of each study; `pound run` of the others."""
POINTS = {"fig5": "connector", "fig8": "wall"}
"""Commands that solve points of their own; they write their table as CSV."""

SCENES = ("storey", "floor", "link", "scene", "flagged", "records", "buildings")
"""Tables of every study of scenes; those of the answers are added, and of `SUMMARISED` the summary."""
SUMMARISED = {"fig6", "bracket", "collapse"}
KEPT_OVER_TIME = {"histories", "twist"}
LEFT_OUT = {"fragility_curves", "optimise_points", "sensitivity_samples"}
"""Long tables from which the others follow."""

WORK = ["seconds", "steps", "events", "orders", "method", "accuracy", "time_step", "points", "scenes", "histories"]
PROSE = [
    "says",
    "bound",
    "estimated",
    "effects",
    "dropped",
    "dropped_links",
    "dropped_reasons",
    "advice",
    "flag",
    "flags",
    "flag_details",
    "flag_severity",
    "detail",
    "severity",
    "digest",
]
"""Columns about the work done instead of its result, and texts that may be worded otherwise."""
NOISE = ("error", "sensitivity", "residual")
"""Columns with one of these words are sizes of errors; `residual_drift` is a result."""

LOOSE = {"contact_time": 1e-4, "impulse": 1e-4} | dict.fromkeys(("value", "place", "good_from", "good_to"), 1e-3)
"""Relative tolerance of columns that grazing contacts amplify, and of the place of an optimum, which is flat."""
ANSWERS = 1e-6
"""Tolerance of answers, at least: statistics amplify the errors of the scenes; and of histories, kept in 4 bytes."""
BESIDE = {
    "residual_drift": "drift",
    "displacement_max": "displacement",
    "displacement_min": "displacement",
    "energy_kinetic": "energy_input",
    "energy_stored": "energy_input",
    "energy_damping": "energy_input",
    "energy_hysteresis": "energy_input",
    "energy_links": "energy_input",
}
"""Columns whose errors are relative to the largest value of another one."""


def accuracy(name: str) -> float:
    """What the study asks for; that of `pound run` unless it says."""
    return float(yaml.safe_load(STUDIES[name].read_text()).get("accuracy", 1e-6))


def solved(name: str, folder: Path) -> dict[str, pd.DataFrame]:
    """The tables of a study, solved in `folder` with the motions that come with the program."""
    study = folder / f"{name}.yaml"
    shutil.copy(STUDIES[name], study)
    (folder / "figures").mkdir()
    for figure in ("fig6", "fig7"):  # whose statements others have
        shutil.copy(HERE.parents[1] / "configs" / f"{figure}.yaml", folder / "figures")
    if name == "motions":
        motions.write(folder)
    if name in POINTS:
        done = CliRunner().invoke(cli, [POINTS[name], str(study), "-o", str(folder / f"{name}.h5"), "-q"])
        assert done.exit_code == 0, done.output
        frame = pd.read_csv(folder / name / "tables" / f"{POINTS[name]}.csv")
        return {POINTS[name]: frame[columns(frame)]}
    workflow = WORKFLOWS.get(name, "run")
    with patch.dict(os.environ, {"POUND_HOME": str(folder), "POUND_RECORDS": ""}):
        results = pound.run(study, folder / f"{name}.h5", workflow=workflow, engine="serial")
    named = [table for table in results.tables if table in (*SCENES, *results.answers) and table not in LEFT_OUT]
    found = {table: results.table(table) for table in named}
    if workflow != "run":  # the scenes are those of any run; their number tells what was solved
        found = {table: frame for table, frame in found.items() if table in results.answers}
    elif name in SUMMARISED:
        found["summary"] = results.table("summary")
    if name == "twist":
        found["line"] = results.table("line")
    if name in KEPT_OVER_TIME:
        found["kept"] = results.histories().drop(columns=["number", "scene"])
        found["history"] = over_time(results.history())
    if results.warnings:
        found["warnings"] = pd.DataFrame({"line": [each.line for each in results.warnings]})
    return {table: frame[columns(frame)] for table, frame in found.items() if len(frame)}


def over_time(history: pound.History) -> pd.DataFrame:
    """Every quantity of a history, a column for each of its places."""
    frames = []
    quantities = ["displacement", "total_acceleration", "drift", "shear", "link_force", "closing", "sway", "energy"]
    if "twist" in history.dataset:
        quantities += ["twist", "line_drift", "line_shear"]
    for quantity in quantities:
        frame = history.frame(quantity)
        named = [" ".join(map(str, each)) if isinstance(each, tuple) else str(each) for each in frame.columns]
        frames.append(frame.set_axis([f"{quantity} {each}" for each in named], axis=1))
    return pd.concat(frames, axis=1).reset_index()


def columns(frame: pd.DataFrame) -> list[str]:
    """The columns that are compared."""
    kept = []
    for name in map(str, frame.columns):
        noise = any(word in name for word in NOISE) and name != "residual_drift"
        if not noise and name not in WORK + PROSE:
            kept.append(name)
    return kept


def stored(name: str) -> dict[str, pd.DataFrame]:
    """The tables kept for a study."""
    return {path.name.split(".")[1]: pd.read_csv(path) for path in sorted(TABLES.glob(f"{name}.*.csv"))}


def renew(name: str, found: dict[str, pd.DataFrame]) -> None:
    """Keep these tables in place of the ones before."""
    for old in TABLES.glob(f"{name}.*.csv"):
        old.unlink()
    for table, frame in found.items():
        frame.to_csv(TABLES / f"{name}.{table}.csv", index=False, float_format="%.10g", lineterminator="\n")


def differences(name: str, found: dict[str, pd.DataFrame]) -> list[str]:
    """What differs from the stored tables, in words; columns and tables that they do not have are not compared."""
    kept = stored(name)
    told = [] if kept else [f"{name}: nothing is stored"]
    for table, old in kept.items():
        if table not in found:
            told.append(f"{name}.{table}: is missing")
        else:
            loose = name in (*WORKFLOWS, *POINTS) or table == "history"
            tolerance = max(10 * accuracy(name), ANSWERS if loose else 0.0)
            told += [f"{name}.{table}: {each}" for each in between(old, found[table], tolerance)]
    return told


def between(old: pd.DataFrame, new: pd.DataFrame, tolerance: float) -> Iterator[str]:
    """What differs between two tables; numbers agree within `tolerance` of the largest of their column."""
    if len(old) != len(new):
        yield f"{len(new)} rows instead of {len(old)}"
        return
    for column in old.columns:
        if column not in new.columns:
            yield f"column {column} is missing"
        elif not all(pd.api.types.is_numeric_dtype(each[column]) for each in (old, new)):
            pairs = zip(texts(old[column]), texts(new[column]), strict=True)
            wrong = [f"'{b}' from '{a}'" for a, b in pairs if a != b]
            if wrong:
                yield f"{column}: {len(wrong)} texts differ, as {wrong[0]}"
        else:
            beside = BESIDE.get(column, column)
            scale = largest(old[beside if beside in old.columns else column])
            a, b = old[column].to_numpy(float), new[column].to_numpy(float)
            with np.errstate(invalid="ignore"):
                off = np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, np.abs(a - b))
            bad = ~(off <= LOOSE.get(column, tolerance) * scale)
            if bad.any():
                worst = np.nanmax(off[bad], initial=0.0) / (scale or 1.0)
                yield f"{column}: {bad.sum()} of {len(a)} numbers differ, by {worst:.1e} of the largest"


def texts(values: pd.Series) -> list[str]:
    """A column as texts, empty where there is nothing."""
    return ["" if pd.isna(value) else str(value) for value in values]


def largest(values: pd.Series) -> float:
    """The largest finite size of a column; 0 where there is none."""
    sizes = np.abs(values.to_numpy(float))
    return float(np.max(sizes[np.isfinite(sizes)], initial=0.0))

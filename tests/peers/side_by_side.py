"""`python -m tests.peers.side_by_side`: three pairs that strike each other, by `pound` and by OpenSees, into
docs/published.md.

`pound` solves the studies of `pairs/*.yaml`; `opensees_pairs.py` has the same buildings written by hand for OpenSees.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pandas as pd
import yaml

import pounding_cli
from tests.bench.pages import ROOT, format_error, format_machine, format_time, table, write_block
from tests.bench.performance import solved

STUDIES = Path(__file__).parent / "pairs"
PAGE = ROOT / "docs" / "published.md"
BEGIN = "<!-- peers: begin -->"
END = "<!-- peers: end -->"

PAIRS = "elastic", "yielding", "twisting"
STEPS = (2e-4, 1e-4, 5e-5)
"""Time steps of OpenSees [s], each half of the one before."""
HEAD = " | ".join(
    ["", "`pound`", *(f"OpenSees, {1e3 * step:g} ms" for step in STEPS), "difference", "step error of OpenSees"]
)
"""The difference is that of the shortest step from `pound`; the step error is what halving to this step changed."""
UNITS = {"displacement": ("mm", 1e3), "drift": ("mm", 1e3), "rotation": ("mrad", 1e3), "": ("kN", 1e-3)}


def main() -> None:
    """Solve the pairs by both programs and write the table into the page."""
    from tests.peers.opensees_pairs import march

    load = os.getloadavg()[0]
    parts = []
    for name in PAIRS:
        found = [march(name, step) for step in STEPS]
        times = [run.seconds for run in found]
        rows = list_rows(solve_pair(name), [run.peaks for run in found])
        rows.append(["time", *map(format_time, [time_pair(name), *times]), "", ""])
        rows.append(["steps without a root, halved", "", *(str(run.halved) for run in found), "", ""])
        parts.append(f"**{name.capitalize()}** (`tests/peers/pairs/{name}.yaml`)\n\n{table(HEAD, rows)}")
    parts.append(f"Measured {format_machine(load)}, OpenSees {opensees_version()}.")
    write_block(PAGE, "\n" + "\n\n".join(parts) + "\n", BEGIN, END)
    print("\n\n".join(parts))


def solve_pair(name: str) -> dict[str, float]:
    """Return the peaks of a pair by `pound`, in SI, by the names of the rows; the last is the number of contacts."""
    with tempfile.TemporaryDirectory() as folder:
        results = pounding_cli.run(STUDIES / f"{name}.yaml", Path(folder) / "pair.h5", engine="serial")
        tables = {each: results.table(each) for each in ("storey", "floor", "link", "scene")}
        if "twist" in tables["floor"]:
            tables["line"] = results.table("line")
    (status,) = tables["scene"]["status"]
    assert status == "done", status
    return dict(_iter_peaks(tables))


def _iter_peaks(tables: Mapping[str, pd.DataFrame]) -> Iterator[tuple[str, float]]:
    """Yield the peaks of the tables of a scene in the order of the rows."""
    twists = "line" in tables
    for building, floors in tables["floor"].groupby("building"):
        roof = floors.iloc[-1]
        yield f"{building}, displacement of the roof", roof["displacement"]
        if twists:
            yield f"{building}, rotation of the roof", roof["twist"]
    resisting = tables["line" if twists else "storey"]
    for row in resisting.to_dict("records"):
        where = f"line {row['line']}, storey {row['storey']}" if twists else f"storey {row['storey']}"
        yield f"{row['building']}, drift of {where}", row["drift"]
    for row in tables["storey"].query("storey == 1").to_dict("records"):
        yield f"{row['building']}, base shear", row["V"]
    yield "largest contact force", tables["link"]["peak_force"].max()
    yield "contacts", tables["link"]["impacts"].sum()


def list_rows(ours: Mapping[str, float], theirs: Sequence[Mapping[str, float]]) -> list[list[str]]:
    """Return a row for every peak: `pound`, OpenSees from the longest step to the shortest, and the differences.

    Raises
    ------
    ValueError : both programs do not have the same peaks
    """
    if any(set(each) != set(ours) for each in theirs):
        raise ValueError(f"peaks are not the same ones: {set(ours) ^ set(theirs[-1])}")
    rows = []
    for name, value in ours.items():
        values = [value, *(each[name] for each in theirs)]
        if name == "contacts":
            rows.append([name, *(f"{each:.0f}" for each in values), f"{values[-1] - value:.0f}", ""])
            continue
        unit, factor = next(of for word, of in UNITS.items() if word in name)
        off = abs(values[-1] / value - 1), abs(values[-2] / values[-1] - 1)
        rows.append([f"{name} [{unit}]", *(f"{factor * each:.5g}" for each in values), *map(format_error, off)])
    return rows


def time_pair(name: str) -> float:
    """Return the time of a pair in the solver [s], the least of several runs, without its error estimate."""
    study = yaml.safe_load((STUDIES / f"{name}.yaml").read_text(encoding="utf-8"))
    scenes = solved({**study, "estimate": "none"}).set_index("case")
    return float(scenes.loc["gap", "seconds"])


def opensees_version() -> str:
    """Return the version of OpenSees."""
    import openseespy.opensees as ops

    return str(ops.version())


if __name__ == "__main__":
    main()

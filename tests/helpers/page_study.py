"""Small results whose numbers are known beforehand, for the page's tests."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from pounding_cli.batch import run_plan
from pounding_cli.laws.connector import Connector
from pounding_cli.report.build import write_report
from pounding_cli.solve.histories import ENERGIES, History
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response
from pounding_cli.store import open_results
from pounding_cli.store.histories import write_history
from pounding_cli.study import expand, load_study
from tests.helpers.sealing import edited
from tests.helpers.two_buildings import FOUR_CASES

STUDY = FOUR_CASES.replace("Two small buildings", "Two buildings <known> & small")
FACTOR = {"touching": 1.5, "gap": 1.25, "infill": 1.4, "connected": 1.3}
"""V/V0 of storey 1 of every case; storey s has (1 + s) / 2 times that, a gap 10 % more for each cm beyond the first."""
PEAKS = {"weak": 1.0, "strong": 4.0}
"""Peak ground acceleration of the motions [m/s2]; V0 is 1e6 N times it."""
KEPT = (("touching", "elastic"), ("connected", "elastic"))
"""Scenes whose histories most tests keep."""

DT = 0.002
CONTACTS = {1: (0.5, 1e6), 2: (1.2, 4e6)}
"""Of the kept scenes: floor -> when it is struck hardest [s], force [N]; triangles of 10 ms."""


def known(scene, accuracy=1e-6, method="taylor", **_):
    """Peaks by the formulas above; runs of `infill` under `strong` fail."""
    kind, gap = (scene.links[0].kind, scene.links[0].gap) if scene.links else ("", 0)
    case = {"pounding": "gap" if gap else "touching", "infill": "infill", "connector": "connected"}.get(str(kind), "")
    factor = FACTOR.get(case, 1.0) * (1 + 10 * (gap - 0.01) if case == "gap" else 1)
    lost = case == "infill" and scene.motion.pga > 2
    found = []
    for building in scene.buildings:
        level = np.arange(1, building.storeys + 1)
        one = scene.motion.pga * np.ones(building.storeys)
        rise = factor * (1 + level) / 2 if case else 1.0
        fields = {"shear": 1e6 * rise * one, "drift": 0.01 * one, "ductility": rise * one, "acceleration": one}
        found.append(_building(building.storeys, fields))
    method = "taylor" if method == "auto" else method  # a response names the method that solved it
    n = len(scene.links)
    number = np.arange(1, n + 1, dtype=float)
    links = LinkResponse(number, 1e6 * number, 0.005 * number, number, number)
    status, advice = ("event bound reached", "loosen the accuracy") if lost else ("done", "")
    flags = (f"{Connector.beyond_gap}: stiff | soft, floor 2, by 2 mm",) if case == "connected" else ()
    return Response(tuple(found), links, status, advice, method, accuracy, 10, 1, 1e-4, flags=flags)


def refuse(scene, **_):
    """No scene ends."""
    raise ArithmeticError("no scene of this study ends")


def _building(storeys: int, fields: dict[str, np.ndarray]) -> BuildingResponse:
    zero = np.zeros(storeys)
    return BuildingResponse(
        fields["shear"], fields["drift"], fields["ductility"], fields["acceleration"], 2 * zero, zero, zero
    )


def motion_of(buildings: tuple[str, ...], links: tuple[str, ...], storeys: int) -> History:
    """2 s: floor j of building b moves by 10 mm x j x (b + 1) sin(2 pi t); floors strike as in CONTACTS."""
    time = DT * np.arange(1001)
    wave = np.sin(2 * np.pi * time)
    move = 0.01 * wave[:, None, None] * np.arange(1, storeys + 1) * np.arange(1, len(buildings) + 1)[None, :, None]
    force = np.zeros((time.size, len(links)))
    for number, label in enumerate(links):
        at, peak = CONTACTS.get(int(label.split()[-1]), (0.0, 0.0))
        force[:, number] = peak * np.clip(1 - np.abs(time - at) / 0.005, 0, None)
    flat = np.zeros((time.size, len(buildings)))
    drift = np.diff(move, axis=2, prepend=0)
    nothing = np.zeros_like(time)
    return History(
        time=time, ground_acceleration=2 * np.cos(2 * np.pi * time), ground_displacement=nothing, displacement=move,
        total_acceleration=move, drift=drift, shear=drift, sway=flat, rocking=flat, link_force=force,
        energy=dict.fromkeys(ENERGIES, nothing), buildings=buildings, links=links,
    )  # fmt: skip


def report(
    folder: Path,
    extra: str = "",
    kept: Sequence[tuple[str, str]] = (),
    formats: tuple[str, ...] = (),
    solve: Callable = known,
    claims: bool = True,
    renamed: dict[str, str] | None = None,
    group: str = "stiff, soft",
) -> Path:
    """Run STUDY with `extra` lines, keep scenes of the cases and analyses `kept`, write the report into `folder`.

    renamed : cases by other names, as only a forged results file has them
    """
    t = np.arange(0.0, 0.5, 0.01)
    for name, peak in PEAKS.items():
        wave = peak / 9.80665 * np.clip(1 - np.abs(t - 0.1) / 0.05, 0, None)  # its peak is a sample
        np.savetxt(folder / f"{name}.txt", np.column_stack([t, wave]))
    text = STUDY if claims else STUDY.replace("claims: fig6\n", "")
    text = text.replace("group: [stiff, soft]", f"group: [{group}]")
    (folder / "study.yaml").write_text(text + extra)
    results = folder / "study.h5"
    plan = replace(expand(load_study(folder / "study.yaml")), all_effects=True)  # `solve` answers whole scenes only
    run_plan(plan, results, solve=solve, workers=1)
    with edited(results) as file:
        labels = tuple(file["link"].asstr()[:])
        for case, analysis in kept:
            place = {"case": case, "analysis": analysis, "record": "strong", "scene": f"{case}-{analysis}", "every": DT}
            write_history(file, place, motion_of(("stiff", "soft"), labels, 3))
        if renamed:
            file["case"][...] = [renamed[name] for name in file["case"].asstr()[:]]
            resolved = json.loads(file["study/resolved"].asstr()[()])
            resolved["cases"] = {renamed[name]: case for name, case in resolved["cases"].items()}
            file["study/resolved"][()] = json.dumps(resolved)
    write_report(open_results(results), folder, formats)
    return folder

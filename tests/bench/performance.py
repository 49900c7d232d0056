"""The table of docs/performance.md: what scenes, commands and sweeps cost."""

from __future__ import annotations

import os
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

import pounding_cli
from tests.bench.pages import POUND, ROOT, format_time, table

RUNS = 7

PAIR: dict[str, Any] = {
    "records": {"use": ["elcentro"], "duration": "10 s"},
    "buildings": {
        "stiff": {"storeys": 5, "period": "0.36 s", "collapse": "never"},
        "soft": {"like": "stiff", "period": "0.60 s"},
    },
    "group": ["stiff", "soft"],
    "cases": {"linked": {"link": "pounding", "gap": "0 cm"}},
    "analyses": ["elastic"],
    "accuracy": 1e-6,
    "estimate": "none",
}

IMPACT = {"restitution": 0.5, "hertz_stiffness": "4.344e11 N/m^1.5", "penetration": "1.053 mm"}
BETWEEN = {
    "connector": {"stiffness": "1/5 mean storey of stiff"},
    "damper": {"damping_coefficient": "2 MN s/m"},
    "infill": {},
    "maxwell": {"damping_coefficient": "2 MN s/m", "stiffness": "100 kN/mm"},
    "friction": {"slip_force": "200 kN"},
    "viscous": {"force_at_1_m_s": "500 kN", "exponent": 0.5},
}
DETERIORATION = {"capping_ductility": 6.0, "post_capping_slope": 0.05, "residual_strength": 0.4}
STOREYS = {
    "bilinear": {}, "peak-oriented": {}, "imk-peak-oriented": DETERIORATION,
    "imk-pinching": {**DETERIORATION, "pinching_force": 0.4, "pinching_drift": 0.5}, "bouc-wen": {},
}  # fmt: skip
SWAY = {"mass": "200 t", "sway_stiffness": "2000 kN/mm", "sway_damping": "20 MN s/m"}
ROCKING = {"inertia": "1e7 kg m2", "rocking_stiffness": "1e5 MN m", "rocking_damping": "100 MN m s"}


def measure_performance() -> str:
    """Return the table of what scenes of the figures, laws, growing rows and whole commands cost."""
    rows = [row for measure in (figures, laws, growth, program, sweep) for row in measure()]
    return table("what | time", rows)


def solved(study: dict[str, Any] | Path) -> pd.DataFrame:
    """The scenes of a study with the least `seconds` of several runs."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(RUNS):
            output = Path(folder) / f"{number}.h5"
            found.append(pounding_cli.run(study, output, engine="serial").table("scene"))
    scenes = found[0].assign(seconds=pd.concat([each["seconds"] for each in found], axis=1).min(axis=1))
    wrong = scenes[scenes["status"] != "done"]
    if len(wrong):
        raise RuntimeError(f"scenes were not solved: {wrong}")
    return scenes


def pair(analysis: str = "elastic", storeys: dict[str, Any] | None = None, **keys: Any) -> pd.Series:
    """The linked scene of two buildings with these keys: its seconds, steps and events."""
    study = yaml.safe_load(yaml.safe_dump({**PAIR, "analyses": [analysis], **keys}))
    if storeys:
        study["buildings"]["stiff"].update(storeys)
    scenes = solved(study)
    return scenes[scenes["case"] == "linked"].iloc[0]


def figures() -> Iterator[list[str]]:
    """Scenes of the paper's figures."""
    for name in ("fig6", "fig7"):
        scenes = solved(ROOT / "configs" / f"{name}.yaml")
        seconds = scenes.loc[(scenes["case"] != "alone") & (scenes["seconds"] > 0), "seconds"]  # 0: shown without a run
        yield [f"a scene of `configs/{name}.yaml`, median of {len(seconds)}", format_time(seconds.median())]


def laws() -> Iterator[list[str]]:
    """The touching pair of `PAIR` under every law; the first of each kind is the simplest."""
    contacts = {
        law: pair(impact={"law": law, **IMPACT})
        for law in ("kelvin-voigt", "hertz", "hertz-damp", "jankowski", "bilinear")
    }
    links = {
        law: pair(
            cases={"linked": {"link": law, "gap": "5 cm", **keys, **({} if law == "infill" else {"floors": [3, 5]})}}
        )
        for law, keys in BETWEEN.items()
    }
    storeys = {law: pair("inelastic", {"storey_law": law, **keys}) for law, keys in STOREYS.items()}
    storeys["bilinear with P-Delta"] = pair("inelastic", {"p_delta": True})
    bases = {
        "sway": pair("inelastic", {"foundation": SWAY}),
        "sway and rocking": pair("inelastic", {"foundation": {**SWAY, **ROCKING}}),
    }
    for kind, found in (
        ("contacts, elastic", contacts),
        ("between the floors, elastic", links),
        ("storeys", storeys),
        ("bases", bases),
    ):
        yield [kind, ", ".join(f"{law} {format_time(scene['seconds'])}" for law, scene in found.items())]


def growth() -> Iterator[list[str]]:
    """Elastic pairs and rows that grow."""
    for what, values, scene in (
        ("storeys a building, touching", (5, 20, 100), row_of),
        ("buildings in a row, 1 cm apart", (2, 5, 20), lambda n: row_of(buildings=n, gap="1 cm")),
        ("buildings in a row, touching", (2, 5, 20), lambda n: row_of(buildings=n)),
        ("accuracy, touching", (1e-3, 1e-6, 1e-9, 1e-12), lambda accuracy: row_of(accuracy=accuracy)),
    ):
        yield [what, ", ".join(f"{value:g}: {format_time(scene(value)['seconds'])}" for value in values)]


def program() -> Iterator[list[str]]:
    """Commands by the clock, start of Python included."""
    fig6 = ["run", "configs/fig6.yaml"]
    with tempfile.TemporaryDirectory() as folder:
        started(*fig6, "-o", f"{folder}/first.h5")
        warm = min(started(*fig6, "-o", f"{folder}/{number}.h5") for number in range(RUNS))
        help_time = min(started("--help") for _ in range(RUNS))
        cold = started(*fig6, "-o", f"{folder}/cold.h5", NUMBA_CACHE_DIR=f"{folder}/cache")
    yield ["`pound --help`", format_time(help_time)]
    yield ["`pound run configs/fig6.yaml`", f"{format_time(warm)}; first run ever, which compiles: {format_time(cold)}"]


def started(*words: str, **environment: str) -> float:
    """Seconds of `pound` with these words, by the clock."""
    begin = time.perf_counter()
    subprocess.run([*POUND, *words], cwd=ROOT, env={**os.environ, **environment}, check=True, capture_output=True)
    return time.perf_counter() - begin


def row_of(storeys: int = 5, buildings: int = 2, gap: str = "0 cm", accuracy: float = 1e-6) -> pd.Series:
    """Buildings of 0.072 s and 0.12 s a storey, turn and turn about, with links at every floor."""
    names = [f"b{number}" for number in range(buildings)]
    made = {
        name: {"storeys": storeys, "period": f"{(0.072, 0.12)[number % 2] * storeys:g} s", "collapse": "never"}
        for number, name in enumerate(names)
    }
    link = {"link": "pounding", "gap": gap}
    return pair(buildings=made, group=names, cases={"linked": link}, accuracy=accuracy)


def sweep() -> Iterator[list[str]]:
    """Ten thousand scenes of 2 s by `pound run`, restitution against gap."""
    study = {**PAIR, "records": {"use": ["elcentro"], "duration": "2 s"}}
    gaps = [f"{gap} m" for gap in evenly(0, 0.04, 1000)]
    study["sweep"] = {"impact.restitution": evenly(0.3, 0.7, 10), "cases.linked.gap": gaps}
    with tempfile.TemporaryDirectory() as folder:
        path, output = Path(folder) / "sweep.yaml", Path(folder) / "sweep.h5"
        path.write_text(yaml.safe_dump(study, sort_keys=False), encoding="utf-8")
        begin = time.perf_counter()
        process = subprocess.Popen(
            [*POUND, "run", str(path), "-o", str(output)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        memory, wall = largest_memory(process), time.perf_counter() - begin
        if process.returncode:
            raise RuntimeError(f"pound run ended with {process.returncode}")
        size = output.stat().st_size
    told = f"{format_time(wall)}, {memory / 1e6:.0f} MB in all processes, a file of {size / 1e6:.0f} MB"
    yield ["a sweep of 10,000 points, 2 s of motion", told]


def evenly(low: float, high: float, count: int) -> list[float]:
    return [round(low + (high - low) * place / (count - 1), 9) for place in range(count)]


def largest_memory(process: subprocess.Popen) -> int:
    """Largest memory of a process and all below it until it ends, shared pages counted once [bytes] (Linux)."""
    largest = 0
    while process.poll() is None:
        total, libraries, waiting = 0, 0, [process.pid]
        while waiting:
            proc = Path(f"/proc/{waiting.pop()}")
            try:
                memory = dict(line.split(":") for line in (proc / "smaps_rollup").read_text().splitlines()[1:])
                status = dict(line.split(":", 1) for line in (proc / "status").read_text().splitlines())
                waiting += [int(c) for t in (proc / "task").iterdir() for c in (t / "children").read_text().split()]
            except OSError:  # ended meanwhile
                continue
            total += sum(1024 * int(memory[name].split()[0]) for name in ("Pss_Anon", "Pss_Shmem"))
            libraries = max(libraries, 1024 * int(status.get("RssFile", "0").split()[0]))
        largest = max(largest, total + libraries)
        time.sleep(0.2)
    return largest

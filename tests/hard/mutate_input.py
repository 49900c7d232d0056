"""Mutations of studies and motion files: `python -m tests.hard.mutate_input --tries 1000` counts what comes of them.

Each is accepted or refused with a sentence, within the time and memory of `guarded`; a traceback, a hang or a crash
is a fault, and its input is kept. Seed and number name an input, so that any can be made again.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pounding_cli as pound
from tests.adapter import scenes
from tests.helpers import motion_layouts as layouts

from .guarded import guarded

STUDY = """\
title: Two buildings
records:
  use: [elcentro, taft, {file: motion.txt, dt: 0.02 s, unit: g}]
  duration: 2 s
  scale: {spectrum: mean, target: {0.1 s: 0.8 g, 2 s: 0.2 g}, from: 0.2 s, to: 1.2 s, at_least: 90 %}
buildings:
  stiff: {storeys: 3, period: 0.36 s, mass: [200 t, 200 t, 150 t], height: 3 m, taper: 1/3, damping: 5 %,
          yield: {code: UBC-1991, zone: 0.4, soil: 1.2, Rw: 12}, hardening: 0.05}
  soft: {like: stiff, period: 0.60 s, yield: {base_shear: 0.1 W, distribution: uniform, overstrength: 2},
         foundation: {mass: 100 t, sway_stiffness: 1e9 N/m, inertia: 1000 t m2, rocking_stiffness: 5e9 N m}}
group: [stiff, soft]
impact: {stiffness: 20 x stiffest storey, restitution: 0.5}
cases:
  gap: {link: pounding, gap: 5 cm}
  con: {gap: 5 cm, links: [{link: connector, floors: [1, 3]}, {link: none, floors: 2}, {link: pounding, floors: rest}]}
analyses: [elastic, inelastic]
accuracy: 1e-6
keep: {histories: {cases: [gap], where: {impact.restitution: 0.5}}}
sweep:
  impact.restitution: [0.4, 0.5]
  buildings.soft.period: {from: 0.5 s, to: 0.7 s, count: 3}
"""
PLANS = """\
title: Floors that twist
records: {use: [elcentro], duration: 2 s}
buildings:
  corner:
    mass: [200 t, 180 t]
    height: 3 m
    plan:
      width: 20 m
      inertia: [8.0e6 kg m2, 7.0e6 kg m2]
      torsional_stiffness: [4.0e9 N m, 3.0e9 N m]
      lines:
        - {y: -7 m, stiffness: [120 kN/mm, 100 kN/mm], yield_shear: [600 kN, 500 kN]}
        - {y: 6 m, stiffness: [70 kN/mm, 60 kN/mm], yield_shear: never}
      across: [{x: 4 m, stiffness: [70 kN/mm, 60 kN/mm]}, {x: -4 m, stiffness: [70 kN/mm, 60 kN/mm]}]
  soft: {storeys: 2, period: 0.6 s,
         plan: {width: 16 m, depth: 12 m, shift: 3 m, centre_of_mass: 1 m, eccentricity: 10 %, frequency_ratio: 1.1}}
  next: {like: soft, plan: {accidental: 5 %, twist: always,
                            lines: [{y: -6 m, stiffness: 60 %}, {y: 6 m, stiffness: rest}]}}
group: [corner, soft, next]
impact: {stiffness: 20 x stiffest storey, restitution: 0.5}
cases:
  gap: {link: pounding, gap: 5 cm}
  con:
    gap: 5 cm
    links: [{link: connector, places: [0 m, 4 m], shares: [30 %, rest]}, {link: pounding, places: [[1 m, -2 m]]}]
analyses: [elastic, inelastic]
sweep:
  buildings.soft.plan.eccentricity: [0 %, 10 %]
  buildings.corner.plan.lines.0.y: {from: -7 m, to: -5 m, count: 2}
"""
HEADER = "# dt: 0.02 s\n# unit: g\n"
ODD = (
    "", " ", "\t", "\n", "{", "}", "[", "]", ": ", "- ", "? ", "&a ", "*a", "#", "'", '"', "|", ">", "%", "!!int ",
    "<<: ", "null",
    "true", "nan", ".inf", "-1", "0", "1e308", "1e-308", "9" * 400, "1_0", "\uff11", "0,5", "\x00", "\x1b[31m",
    "\u202e", "\ufeff", "../", "/dev/zero", "*", "**/*", "s**9**9", "x" * 5000, " " * 5000, "{a: " * 40, "0.1 0.2 ",
    "NPTS= 4000, DT= .005 SEC", "UNCORRECTED ACCELEROGRAM DATA", "(8f10.3)", "(Format v01.20 with 13 text lines)",
)  # fmt: skip


def mutated(data: bytes, seed: int) -> bytes:
    """A few changes: bits, bytes and lines dropped, doubled, moved, cut off; odd words put in."""
    choose = random.Random(seed)
    for _ in range(choose.choice((1, 1, 1, 2, 4))):
        place, length = choose.randrange(len(data) + 1), choose.choice((1, 1, 2, 5, 20))
        lines = data.splitlines(keepends=True)
        kind = choose.randrange(8)
        if kind == 0 and place < len(data):
            data = data[:place] + bytes([data[place] ^ 1 << choose.randrange(8)]) + data[place + 1 :]
        elif kind == 1:
            data = data[:place] + data[place + length :]
        elif kind == 2:
            data = data[:place] + data[place : place + length] * choose.choice((2, 3, 1000)) + data[place + length :]
        elif kind == 3 and lines:
            number = choose.randrange(len(lines))
            moved = lines.pop(number)
            lines.insert(choose.randrange(len(lines) + 1), moved * choose.choice((0, 1, 2)))
            data = b"".join(lines)
        elif kind == 4:
            data = data[:place]
        elif kind == 5:
            data = data[:place] + choose.choice(ODD).encode() + data[place + choose.choice((0, length)) :]
        elif kind == 6 and any(byte in b"0123456789" for byte in data):
            digits = [number for number, byte in enumerate(data) if byte in b"0123456789"]
            place = choose.choice(digits)
            data = data[:place] + choose.choice((b"0", b"9", b"00", b".", b"-", b"e")) + data[place + 1 :]
        else:
            words = data.split(b" ")
            one, other = choose.randrange(len(words)), choose.randrange(len(words))
            words[one] = words[other]
            data = b" ".join(words)
    return data


def study(path: Path) -> None:
    """What `pound check` does."""
    found = pound.load_study(path)
    if math.prod(len(axis.values) for axis in found.axes) < 100:
        list(scenes(path))


def originals(folder: Path) -> dict[str, list[tuple[str, bytes, Callable[[Path], object]]]]:
    """By sort: names, contents and what reads them; the motion that the study names is in the folder."""
    motion = HEADER + "\n".join(f"{0.1 * (-1) ** n / (1 + n):.5f}" for n in range(150)) + "\n"
    (folder / "motion.txt").write_text(motion)
    pairs = "t [s]; a [cm/s2]\n" + "".join(f"{n * 0.02:.2f}; {50 * math.sin(n):.3f}\n" for n in range(150))
    peer = "PEER NGA\nX, 1/1/2000, Y, 90\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 100, DT= .0200 SEC\n"
    peer += "".join("".join(f"{math.sin(n + k) / 50:15.7E}" for k in range(5)) + "\n" for n in range(0, 100, 5))
    knet = "Origin Time 2000/01/01\nSampling Freq(Hz)  100Hz\nScale Factor      3920(gal)/6170270\n"
    knet += "Duration Time(s)  2\nDir.              N-S\n" + "Lat.  35.0\n" * 11 + "Memo.\n"
    knet += "".join(" ".join(f"{int(5000 * math.sin(n + k)):8d}" for k in range(8)) + "\n" for n in range(0, 200, 8))
    samples = [round(50 * math.sin(n), 1) for n in range(60)]
    header = "site, acceleration in g\n60 0.02\n" + "".join(f"{value / 300:.5f}\n" for value in samples)
    words = "Pas de temps : 0,02 s\nAccélération (cm/s²)\n" + "".join(
        f"{value:.1f}\n".replace(".", ",") for value in samples
    )
    motions = {
        "column.txt": motion,
        "pairs.csv": pairs,
        "peer.AT2": peer,
        "knet.NS": knet,
        "geonet.V2A": layouts.geonet_component(samples),
        "asa.txt": layouts.asa([samples]),
        "header.txt": header,
        "words.txt": words,
    }
    declared = {
        "pairs.csv": {"unit": "cm/s2", "time": 1},
        "header.txt": {"unit": "g", "dt": 0.02, "skip": 2},
        "words.txt": {"unit": "cm/s2", "dt": 0.02, "decimal": ","},
    }
    files = [(name, text.encode(), partial(pound.motion, **declared.get(name, {}))) for name, text in motions.items()]
    files.append(("utf16.txt", pairs.encode("utf-16"), partial(pound.motion, **declared["pairs.csv"])))
    studies = [("study.yaml", STUDY.encode(), study), ("plans.yaml", PLANS.encode(), study)]
    return {"studies": studies, "motions": files}


def hunt(sort: str, tries: int, seed: int, keep: Path | None = None) -> Counter[str]:
    """How many mutations of a sort came to what; what faults is written to `keep`."""
    found: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sources = originals(folder)[sort]
        for file, data, work in sources:  # sound, and what they import is there before the first process is split off
            (folder / file).write_bytes(data)
            work(folder / file)
        for number in range(seed, seed + tries):
            file, data, work = sources[number % len(sources)]
            path = folder / file
            path.write_bytes(mutated(data, number))
            said = guarded(lambda work=work, path=path: work(path))
            outcome = said.partition(":")[0]
            found[outcome] += 1
            if outcome not in ("done", "refused") and keep is not None:
                keep.mkdir(parents=True, exist_ok=True)
                (keep / f"{sort}-{number}-{file}").write_bytes(path.read_bytes())
                print(f"{sort} {number}: {said[:300]}", flush=True)
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tries", type=int, default=1000, help="mutations of every sort")
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--keep", type=Path, default=Path("results/mutations"), help="folder for inputs that fault")
    options = parser.parse_args()
    faults = 0
    for sort in ("studies", "motions"):
        found = hunt(sort, options.tries, options.seed, options.keep)
        print(f"{sort}: {dict(found.most_common())}", flush=True)
        faults += sum(found.values()) - found["done"] - found["refused"]
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

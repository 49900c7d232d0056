"""Random scenes in bulk: `python -m tests.hard.fuzz --scenes 100000` keeps every failing study in a folder."""

from __future__ import annotations

import argparse
import os
import re
import sys
import time
from collections import Counter
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

from .generate import studies
from .make_motions import FOLDER
from .verdict import TWIST, Tally, faults_in

FOUND = Path(__file__).parent / "found"
MOST_KEPT = 8
"""Studies kept of each kind of fault."""
BATCH = 500


def kind_of(fault: str) -> str:
    """A fault without its place and numbers, so that equal ones are known as such."""
    return re.sub(r"[-+]?\d[\d.e+-]*", "N", fault.split(": ", 1)[-1])


class Hunt:
    """Runs studies, counts what came of them and keeps those that failed."""

    def __init__(self, keep: Path) -> None:
        self.keep = keep
        self.tally = Tally()
        self.kinds: Counter[str] = Counter()
        self.kept: Counter[str] = Counter()
        keep.mkdir(parents=True, exist_ok=True)

    def attempt(self, text: str) -> None:
        """One study; a failing one is written to the folder, its faults as comments on top."""
        path = self.keep / "now.yaml"
        path.write_text(text, encoding="utf-8")
        faults = faults_in(path, self.tally)
        kinds = {kind_of(fault) for fault in faults}
        self.kinds.update(kind_of(fault) for fault in faults)
        new = sorted(kind for kind in kinds if self.kept[kind] < MOST_KEPT)
        if new:
            self.kept.update(new)
            head = "".join(f"# {fault}\n" for fault in faults)
            if text.startswith(TWIST):  # which stays on the first line
                twist, _, text = text.partition("\n")
                head = f"{twist}\n{head}"
            word = re.sub(r"[^a-z]+", "-", new[0].lower()).strip("-")[:40]
            moved = text.replace(str(FOLDER), os.path.relpath(FOLDER, self.keep))
            (self.keep / f"{word}-{self.tally.studies}.yaml").write_text(head + moved, encoding="utf-8")

    def summary(self) -> str:
        t = self.tally
        return (
            f"{t.scenes} scenes of {t.studies} studies, {t.twisting} that twist, {t.refused} refused; "
            f"outcomes {dict(t.outcomes)}; worst energy residual {t.worst_residual:.1e} ({t.over} above 1e-8); "
            f"slowest scene {t.slowest:.2f} s; faults {dict(self.kinds)}"
        )


def run(scenes: int, start: int, keep: Path) -> Hunt:
    """Hunt until so many scenes have run; batches of one seed each, so that any can be repeated."""
    hunt = Hunt(keep)
    batch, begin = start, time.perf_counter()
    while hunt.tally.scenes < scenes:

        @seed(batch)
        @settings(
            max_examples=BATCH, deadline=None, database=None, phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )  # fmt: skip
        @given(studies())
        def one(text: str) -> None:
            if hunt.tally.scenes < scenes:
                hunt.attempt(text)

        one()
        batch += 1
        print(f"[{time.perf_counter() - begin:.0f} s, seed {batch - 1}] {hunt.summary()}", flush=True)
    (keep / "now.yaml").unlink(missing_ok=True)
    return hunt


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=100_000, help="how many scenes")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first batch")
    parser.add_argument("--keep", type=Path, default=FOUND, help="folder for failing studies")
    options = parser.parse_args()
    hunt = run(options.scenes, options.seed, options.keep)
    return 1 if hunt.kinds else 0


if __name__ == "__main__":
    sys.exit(main())

"""Estimated errors against true ones over random scenes: `python -m tests.hard.estimates --scenes 2000`; `--touching`:
over a sweep of three buildings in touch or nearly, whose contacts hand errors on most.

The true error is the largest difference of any number from a run of the whole scene at 1e-12. An estimate may be at
most ten times below it where it matters: above a tenth of the accuracy asked. A bound may never be below it. Exit code
1 if one is, or if a scene misses the accuracy by its own estimate without a flag."""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from pounding_cli.batch.attempt import Task
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.solve.assess import difference
from pounding_cli.solve.response import BOUNDED
from pounding_cli.solve.tangent import ILL_CONDITIONED
from pounding_cli.study import expand, load_study

from .random_scenes import random_scene

TRUTH = 1e-12
BELOW = 10.0
"""By so much an estimate may be below the true error."""


@dataclass
class Tally:
    """What came of the scenes.

    mattered : scenes whose true error is above a tenth of the accuracy
    missed, flagged : those that miss the accuracy by their own estimate, or have none; those of them that say so
    below : (true error over estimate, words) of those that mattered
    bounded : scenes whose error is bounded by their tangent
    low : words of those of them whose true error is above the bound
    """

    scenes: int = 0
    done: int = 0
    mattered: int = 0
    missed: int = 0
    flagged: int = 0
    below: list[tuple[float, str]] = field(default_factory=list)
    bounded: int = 0
    low: list[str] = field(default_factory=list)

    @property
    def broken(self) -> list[str]:
        """Scenes whose estimate is too low."""
        return [words for ratio, words in self.below if ratio > BELOW] + self.low

    def summary(self) -> str:
        """The counts in a paragraph, the worst estimates a line each."""
        worst = sorted(self.below, reverse=True)[:10]
        return "\n".join(
            (
                f"{self.scenes} scenes, {self.done} done; true errors above a tenth of the accuracy: {self.mattered}; "
                f"above it by their own estimate: {self.missed}, flagged {self.flagged}; "
                f"estimates more than {BELOW:g} times too low: {len(self.broken)}; bounded by their tangent: "
                f"{self.bounded}, with a true error above the bound: {len(self.low)}",
                *(words for _, words in worst),
            )
        )


TOUCHING = """\
records: {use: [elcentro, taft, parkfield], duration: 8 s}
buildings:
  a: {storeys: 4, period: 0.36 s, yield: {code: UBC-1991}}
  b: {like: a, period: 0.60 s}
  c: {like: a, period: 0.50 s}
group: [a, b, c]
cases:
  gap: {link: pounding, gap: 2 cm}
sweep:
  buildings.b.period: [0.45 s, 0.5 s, 0.61 s, 0.7 s, 0.9 s]
  impact.restitution: [0.3, 0.65, 0.8, 0.95]
  cases.gap.gap: [0 cm, 0.2 cm, 0.5 cm, 1 cm, 2 cm]
"""
"""600 rows of three buildings, a fifth of them in touch."""

Numbered = tuple[int, tuple[Scene, float]]
"""A scene by its number, and the accuracy asked of it."""


def touching_scenes() -> Iterator[Numbered]:
    """The rows of the sweep."""
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder, "touching.yaml")
        study.write_text(TOUCHING, encoding="utf-8")
        rows = (scene for scene in expand(load_study(study)).scenes.values() if scene.links)
        yield from enumerate((scene, 1e-6) for scene in rows)


def random_scenes(numbers: Iterable[int]) -> Iterator[Numbered]:
    """The random scenes of these numbers."""
    return ((number, random_scene(number)) for number in numbers)


def look_at(scenes: Iterable[Numbered]) -> Tally:
    """Solve scenes as a run does, every one assessed."""
    tally = Tally()
    for number, (scene, accuracy) in scenes:
        found = Task(solve, accuracy, "auto", estimate="all")(scene)
        tally.scenes += 1
        if tally.scenes % 100 == 0:
            print(tally.summary(), flush=True)
        truth = solve(scene, TRUTH, all_effects=True)
        if found.status != "done" or truth.status != "done":
            continue
        tally.done += 1
        estimate, error = found.error_estimate, difference(found, truth)
        if not estimate <= accuracy:
            tally.missed += 1
            tally.flagged += any("less accurate than asked" in f or "no error estimate" in f for f in found.flags)
        bounded = found.estimated == BOUNDED
        tally.bounded += bounded
        if error > 0.1 * accuracy or (bounded and error > estimate):
            sort = "ill-conditioned" if found.sensitivity > ILL_CONDITIONED else "well-conditioned"
            words = (
                f"scene {number}: asked {accuracy:.0e}, estimate {estimate:.1e}, true error {error:.1e}, {sort}, "
                f"sensitivity {found.sensitivity:.1e}"
            )
            if bounded and error > estimate:
                tally.low.append(words)
            if error > 0.1 * accuracy:
                tally.mattered += 1
                tally.below.append((error / max(estimate, 1e-300), words))
    return tally


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=2000, help="how many scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--touching", action="store_true", help="the sweep of three buildings instead")
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.scenes)
    tally = look_at(touching_scenes() if options.touching else random_scenes(numbers))
    print(tally.summary())
    return int(bool(tally.broken) or tally.missed != tally.flagged)


if __name__ == "__main__":
    sys.exit(main())

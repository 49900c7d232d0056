"""The catalogue of hard scenes: `scenes/*.yaml`, each a study file whose head says what it must show.

The comment at the head of a file is prose, then one line `# expect: {...}` with what differs from the defaults below.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import yaml

DECIMAL = "residual", "sensitive", "peak_force", "max_closing", "chance"
"""Keys whose numbers are decimal: YAML takes 1e-8 for a word."""

SCENES = Path(__file__).parent / "scenes"


@dataclass(frozen=True)
class Expectation:
    """What the scenes of one study must come to.

    residual : largest energy residual, relative to the input [-]
    sensitive : 0, or what a change of 1e-6 in the motion moves a peak by [-]; the peaks are then held to that figure
    steps : most steps of one scene
    impacts : least closings of links in each linked scene, all links together
    independent : whether the independent integrator of tests/reference can afford the scenes
    """

    residual: float = 1e-8
    sensitive: float = 0.0
    steps: int = 2000
    impacts: int = 1
    independent: bool = False


@dataclass(frozen=True)
class HardStudy:
    """One file of the catalogue."""

    path: Path
    shows: str
    expect: Expectation

    @property
    def name(self) -> str:
        return self.path.stem


def read(path: Path) -> HardStudy:
    """One file.  Raises ValueError where its head does not say what it shows and expects."""
    shows, given = expectation_of(path, {field.name for field in fields(Expectation)})
    return HardStudy(path, shows, Expectation(**given))


def expectation_of(path: Path, known: set[str]) -> tuple[str, dict[str, Any]]:
    """Return what the head of a study says that it shows, and what it expects.

    Raises ValueError where it says neither, or expects something that is not known.
    """
    head = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("# "):
            break
        head.append(line[2:])
    if len(head) < 2 or not head[-1].startswith("expect: "):
        raise ValueError(f"{path}: begin with a comment that says what it shows, then `# expect: {{...}}`")
    given = yaml.safe_load(head[-1])["expect"]
    unknown = set(given) - known
    if unknown:
        raise ValueError(f"{path}: nothing is known of {sorted(unknown)}")
    numbers = {key: float(value) if key in DECIMAL else value for key, value in given.items()}
    return " ".join(head[:-1]), numbers


def studies() -> list[HardStudy]:
    """All files, by name."""
    return [read(path) for path in sorted(SCENES.glob("*.yaml"))]

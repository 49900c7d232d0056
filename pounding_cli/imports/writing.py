"""Write the study of an imported building: plain YAML with the source of every number."""

from __future__ import annotations

import json
import re
import textwrap
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import date

import numpy as np

from pounding_cli.imports.building import ImportedBuilding
from pounding_cli.numbers import join_limited
from pounding_cli.texts import escape_controls

STAND_IN = "neighbour"
"""Name of the wall that stands beside an imported building until its neighbour is written."""

YAML_WIDTH = 115
"""Characters of a line of the study."""


@dataclass(frozen=True)
class PlanSize:
    """The size of a plan, which no table of a frame program gives.

    width : across the row [m]
    depth : along the row [m]
    frequency_ratio : first frequency of the twist over that along the row [-]
    """

    width: float
    depth: float
    frequency_ratio: float


def clean_name(text: str) -> str:
    """Return the name of a building for a study from any text: its letters, of any alphabet, and digits."""
    name = re.sub(r"[\W_]+", "-", unicodedata.normalize("NFC", text)).strip("-").lower()
    if not name or name in ("y", "n", "yes", "no", "on", "off", "true", "false", "null", STAND_IN):
        return f"building-{name}".strip("-")
    return name if name[0].isalpha() else f"building-{name}"


def format_study(
    name: str,
    building: ImportedBuilding,
    command: str,
    digests: Iterable[tuple[str, str]],
    plan: PlanSize | None = None,
) -> str:
    """Return the text of a study with an imported building beside a wall that stands in for its neighbour.

    command : that reads the tables, without its file
    digests : name and SHA-256 of every file that was read
    """
    lines = [f"# Written by `{command}` on {date.today().isoformat()}, from"]
    lines += [f"#   {escape_controls(file)}, SHA-256 {digest}" for file, digest in digests]
    for note in building.notes:
        lines += _comment(note)
    lines += [
        "",
        f"title: {json.dumps(name.replace('-', ' ').capitalize(), ensure_ascii=False)}",
        "",
        "records: {use: [elcentro, taft, parkfield]}    # stand-ins: name your own (docs/how-to/own-motions.md)",
        "",
        "buildings:",
        f"  {name}:",
        *_comment(f"from the ground up: {join_limited(building.names)}", 4),
        *_format_list("height", building.height, "m", 1.0),
        *_format_list("mass", building.mass, "t", 1e3),
    ]
    assert building.stiffness is not None
    lines += _format_list("stiffness", building.stiffness, "kN/mm", 1e6)
    lines += _format_strength(building)
    lines += _format_plan(building, plan)
    lines += [
        f"  {STAND_IN}: {{wall: fixed}}    # stands in: write the building beside it here",
        "",
        f"group: [{name}, {STAND_IN}]",
        "",
        "cases:",
        "  gap: {link: pounding, gap: 5 cm}    # no table has the gap: write yours",
    ]
    if building.yield_shear is None:
        lines += ["", "analyses: [elastic]    # with yield shears also inelastic"]
    return "\n".join(lines) + "\n"


def _format_strength(building: ImportedBuilding) -> list[str]:
    """Return the lines of yield shears and hardening."""
    if building.yield_shear is None:
        return [
            "    yield_shear: never    # these tables have no strength: write one for each storey, e.g. [900 kN, ...]"
        ]
    lines = _format_list("yield_shear", building.yield_shear, "kN", 1e3)
    if building.hardening is not None:
        lines += _format_list("hardening", building.hardening, "", 1.0)
    return lines


def _format_plan(building: ImportedBuilding, plan: PlanSize | None) -> list[str]:
    """Return the lines of the plan, or a comment that says what it needs; none where no table has eccentricities."""
    if building.eccentricity is None:
        return []
    weighted = mean_eccentricity(building)
    if plan is None:
        text = (
            f"plan: the eccentricity is {weighted:.4g} m (centre of stiffness from centre of mass, mean of the "
            "floors); they twist once --width, --depth and --frequency-ratio are given, or a plan is written here "
            "(docs/how-to/twist.md)"
        )
        return _comment(text, 4)
    return [
        "    plan:",
        *_comment("the middle of the width is taken as the centre of mass; write `centre_of_mass` where it is not", 6),
        f"      width: {plan.width:.7g} m",
        f"      depth: {plan.depth:.7g} m",
        f"      eccentricity: {100 * weighted / plan.width:.6g} %    # {weighted:.6g} m, mean of the floors",
        f"      frequency_ratio: {plan.frequency_ratio:.6g}",
    ]


def mean_eccentricity(building: ImportedBuilding) -> float:
    """Return the eccentricity of all floors, weighted by their masses [m]."""
    assert building.eccentricity is not None
    return float(np.average(building.eccentricity, weights=building.mass))


def _format_list(key: str, values: Sequence[float] | np.ndarray, unit: str, factor: float) -> list[str]:
    """Return the lines of a key of a building with a list from the ground up."""
    words = [f"{value / factor:.8g} {unit}".strip() for value in values]
    opening = f"    {key}: ["
    wrapped = textwrap.wrap(
        ", ".join(word.replace(" ", "\N{NO-BREAK SPACE}") for word in words), YAML_WIDTH - len(opening)
    )
    wrapped = [line.replace("\N{NO-BREAK SPACE}", " ") for line in wrapped]
    indent = " " * len(opening)
    lines = [opening + wrapped[0], *(indent + line for line in wrapped[1:])]
    return [*lines[:-1], lines[-1] + "]"]


def _comment(text: str, indent: int = 0) -> list[str]:
    """Return the lines of a comment."""
    return textwrap.wrap(
        escape_controls(text).replace("\n", " ").replace("\t", " "),
        YAML_WIDTH,
        initial_indent=" " * indent + "# ",
        subsequent_indent=" " * indent + "#   ",
    )

"""Floors that face no floor: of neighbours whose storeys differ only the floors at one elevation can touch."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from pounding_cli.model.building import Building
from pounding_cli.numbers import counted
from pounding_cli.study.buildings import FLOOR_TOLERANCE
from pounding_cli.study.problems import Path, Problems, Tree


def unmet(left: Building, right: Building, common: Sequence[tuple[int, int]]) -> tuple[list[int], list[int]]:
    """Floors of `left` and of `right`, from 1, beside which the neighbour stands without a floor.

    Floors above the neighbour's roof have nothing beside them and are left out.
    """
    found = []
    for side, (one, other) in enumerate(((left, right), (right, left))):
        top = float(other.elevation[-1]) + FLOOR_TOLERANCE
        met = {pair[side] for pair in common}
        found.append([n for n, at in enumerate(one.elevation.tolist(), 1) if at <= top and n not in met])
    return found[0], found[1]


def tell(
    group: Sequence[Building], common: Sequence[Sequence[tuple[int, int]]], root: Tree, path: Path, notes: Problems
) -> None:
    """Note the floors of every pair of neighbours that meet nothing."""
    for place, ((left, right), pairs) in enumerate(zip(pairwise(group), common, strict=True)):
        floors = unmet(left, right, pairs)
        if not any(floors):
            continue
        alone = " and ".join(
            f"{_floors(missing)} of {building.name}"
            for building, missing in zip((left, right), floors, strict=True)
            if missing
        )
        meets = ", ".join(f"{one}" if one == other else f"{one} with {other}" for one, other in _some(pairs))
        count = sum(map(len, floors))
        notes.at(
            root,
            (*path, place + 1),
            f"{left.name} and {right.name} meet at {counted(len(pairs), 'floor')} only ({meets}): {alone} "
            f"{'meets' if count == 1 else 'meet'} no floor and {'is' if count == 1 else 'are'} simulated as never "
            "touching",
            "a floor that strikes a column is not modelled: give both the same `height:`, or read the results as those "
            "of buildings that touch nowhere else",
        )


def _floors(numbers: Sequence[int]) -> str:
    """Floors in words: `floor 3`, `floors 1 to 6`, `floors 1, 2 and 4 to 6`."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [word for run in runs for word in ([f"{run[0]} to {run[-1]}"] if len(run) > 2 else map(str, run))]
    listed = ", ".join(words[:-1]) + (" and " if len(words) > 1 else "") + words[-1]
    return f"floor{'s' if len(numbers) > 1 else ''} {listed}"


def _some(pairs: Sequence[tuple[int, int]], most: int = 6) -> list[tuple[int | str, int | str]]:
    return [*pairs[:most], *([("...", "...")] if len(pairs) > most else [])]

"""Which floors of neighbours can touch, and which are left out: those that strike columns of which nothing is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from pounding_cli.model.building import Building
from pounding_cli.model.meetings import Strike, meetings
from pounding_cli.numbers import counted
from pounding_cli.study.file import Problems, Steps

COLUMNS = (
    "or write `columns:`, what part of a storey's stiffness and yield shear the columns have that the other's slab "
    "strikes, e.g. `columns: 20 %`"
)
"""What to write where slabs strike columns."""


def facing(left: Building, right: Building) -> tuple[tuple[tuple[int, int], ...], tuple[Strike, ...]]:
    """Floors of `left` and `right`, from 1, that meet, and slabs that strike columns whose share of the storey is
    known."""
    floors, strikes = meetings(left, right)
    return floors, tuple(strike for strike in strikes if (left, right)[strike.side].columns is not None)


def left_out(left: Building, right: Building) -> tuple[list[int], list[int]]:
    """Floors of `left` and of `right`, from 1, whose slabs strike columns of which nothing is known."""
    found: tuple[list[int], list[int]] = [], []
    for strike in meetings(left, right)[1]:
        if (left, right)[strike.side].columns is None:
            found[1 - strike.side].append(strike.slab)
    return found


def tell(
    group: Sequence[Building], common: Sequence[Mapping[int, int]], root: Any, path: Steps, notes: Problems
) -> None:
    """Note the floors of every pair of neighbours that are left out."""
    for place, ((left, right), pairs) in enumerate(zip(pairwise(group), common, strict=True)):
        floors = left_out(left, right)
        if not any(floors):
            continue
        strikers = [(own, building) for own, building in zip(floors, (left, right), strict=True) if own]
        struck = [building.name for own, building in zip(floors, (right, left), strict=True) if own]
        alone = " and ".join(f"{_floors(own)} of {building.name}" for own, building in strikers)
        meets = ", ".join(
            f"{one}" if one == other else f"{one} with {other}" for one, other in _some(list(pairs.items()))
        )
        where = f"{counted(len(pairs), 'floor')} only ({meets})" if pairs else "no floor"
        count = sum(map(len, floors))
        notes.at(
            root,
            (*path, place + 1),
            f"{left.name} and {right.name} meet at {where}: {alone} "
            f"{'meets' if count == 1 else 'meet'} no floor and {'is' if count == 1 else 'are'} simulated as never "
            "touching",
            f"give both the same `height:`, a `slab:` thick enough to meet, {COLUMNS} in {' and '.join(struck)}; "
            "as it stands the results are those of buildings that touch nowhere else",
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


def meetings_in_words(group: Sequence[Building]) -> list[str]:
    """Every meeting of neighbours, a line each from the ground up: slabs that meet, slabs that strike columns, and
    blows that are left out. Floors of one number that meet one above the other share a line."""
    lines = []
    for left, right in pairwise(group):
        floors, strikes = meetings(left, right)
        found = [(float(left.elevation[i - 1]), "", (i, j)) for i, j in floors]
        for strike in strikes:
            columns, slab = (left, right)[strike.side], (right, left)[strike.side]
            height = float(slab.elevation[strike.slab - 1])
            said = f"floor {strike.slab} of {slab.name} strikes columns of {columns.name} in storey {strike.storey}"
            where = f"at {100 * strike.at:.3g} % of its height"
            if columns.columns is None:
                said = f"left out: {said}, {where}; write `columns:` in {columns.name}"
            else:
                said = f"{said}, {where}, {100 * columns.columns:.3g} % of the storey"
            found.append((height, said, (0, 0)))
        lines += [f"{left.name}|{right.name}  {line}" for line in _from_the_ground(found)]
    return lines


def _from_the_ground(found: list[tuple[float, str, tuple[int, int]]]) -> list[str]:
    """Lines by height; `found`: height [m], what is said, or "" for the pair of floors that meet."""
    lines: list[str] = []
    run: list[tuple[float, int]] = []
    for height, said, (one, other) in [*sorted(found), (0.0, "end", (0, 0))]:
        if run and not (said == "" and one == other == run[-1][1] + 1):
            heights = f"{run[0][0]:g} m" if len(run) == 1 else f"{run[0][0]:g} to {run[-1][0]:g} m"
            first, last = run[0][1], run[-1][1]
            both = f"floors {first} to {last} meet those of the same number"
            lines.append(f"{heights}: {both if first < last else f'floor {first} meets floor {first}'}")
            run = []
        if said == "" and one == other:
            run.append((height, one))
        elif said == "":
            lines.append(f"{height:g} m: floor {one} meets floor {other}")
        elif said != "end":
            lines.append(f"{height:g} m: {said}")
    return lines

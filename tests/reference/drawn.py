"""The shear of a law of storeys along a path of drifts: its branches and guards, without a solver."""

from __future__ import annotations

import itertools
import operator
from typing import Any

import numpy as np

from pounding_cli.laws.law import Guard, Quantity
from pounding_cli.laws.program import MEMORIES, Expression, Operation
from pounding_cli.laws.storey import StoreyLaw


def value_of(what: Expression, given: tuple[float, ...], known: dict[int, Any]) -> float:
    """An expression of drift, rate and memories; a part that it holds many times is worked out once."""
    if id(what) not in known:
        parts = [value_of(part, given, known) for part in what.parts]
        a, b, c = what.numbers
        if what.operation is None:
            value = given[what.register]
        elif what.operation is Operation.LINEAR:
            value = a * parts[0] + b * parts[1] + c
        elif what.operation is Operation.PRODUCT:
            value = a * parts[0] * parts[1]
        else:
            value = a * parts[0] ** b if parts[0] > 0 else 0.0
        known[id(what)] = value
    return known[id(what)]


def shears(law: StoreyLaw, path: np.ndarray) -> np.ndarray:
    """Shear [N] at every drift [m] of a path from zero, straight in between."""
    branches = {branch.name: branch for branch in law.branches()}
    on = law.branches()[0]
    kept = [*law.memories_at_rest, *[0.0] * (MEMORIES - len(law.memories_at_rest))]
    drift, found = 0.0, []

    def met(guard: Guard, end: float) -> float | None:
        """The drift between here and `end` at which a guard ends the branch."""
        ahead = 1.0 if end > drift else -1.0
        if guard.quantity is Quantity.RATE:
            return drift if guard.side * ahead < 0 else None
        at = guard.at + guard.of_memory * kept[guard.memory]
        if guard.quantity is Quantity.FORCE:
            still, stiffness = on.at(0.0, *kept), on.at(1.0, *kept) - on.at(0.0, *kept)
            at = -still / stiffness
        if guard.side * ahead > 0 or guard.side * (end - at) >= 0:
            return None
        return at if ahead * (at - drift) > 0 else drift

    for end in path:
        for _ in range(20):
            if end == drift:
                break
            ends = [(abs(at - drift), at, guard) for guard in on.guards if (at := met(guard, end)) is not None]
            if not ends:
                break
            _, drift, guard = min(ends, key=operator.itemgetter(0))
            known: dict[int, Any] = {}
            new = [(number, value_of(what, (drift, 0.0, *kept), known)) for number, what in guard.sets]
            for number, value in new:
                kept[number] = value
            on = branches[guard.to]
        drift = end
        found.append(float(on.at(drift, *kept)))
    return np.array(found)


def cycles(amplitudes, step: float) -> np.ndarray:
    """Drifts [m] of cycles to each amplitude and back, in steps."""
    corners = [0.0, *(sign * each for each in amplitudes for sign in (1.0, -1.0))]
    pieces = [np.linspace(a, b, max(2, round(abs(b - a) / step) + 1))[1:] for a, b in itertools.pairwise(corners)]
    return np.concatenate(pieces)

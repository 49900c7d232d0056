"""What a run keeps over time."""

from __future__ import annotations

from numba import njit

from pounding_cli.solver.dispatch import smooth_force
from pounding_cli.solver.options import CALLED
from pounding_cli.solver.series import line_force


@njit(**CALLED)
def keep(dofs, elements, r, room, watch):
    """Keep the state at the end of the step as that of the next output time."""
    t = r.output
    r.output += 1
    on_links = on_drags = 0.0
    for i in range(r.n):
        d = dofs[i]
        watch.dofs[t, i, 0], watch.dofs[t, i, 1], watch.dofs[t, i, 2] = d.u1, d.v1, d.a1
        watch.storeys[t, i] = elements[i].work
    for e in range(r.m):
        el = elements[e]
        f = line_force(el, el.v1, el.r1) if el.acts else 0.0
        if room is not None:
            if el.smooth and el.acts:
                f += smooth_force(el, el.v1, el.r1, room.formulas[el.formula])
        if e < r.n:
            f -= el.c * el.r1
        elif e < r.n + r.drags:
            on_drags += el.work
        else:
            on_links += el.work
        watch.elements[t, e, 0], watch.elements[t, e, 1] = el.v1, f
    watch.energy[t, 0], watch.energy[t, 1], watch.energy[t, 2] = r.input, r.drag + r.dashpots + on_drags, on_links

"""The functions of the laws, compiled: those of an element are chosen by its kind, its place in `laws.BEHAVIOURS`."""

from __future__ import annotations

import functools
import math
import types
from collections.abc import Callable
from typing import Any

from numba import njit

from pounding_cli.laws import BEHAVIOURS
from pounding_cli.laws.formula import WRITTEN_BEHAVIOUR, evaluate_operations
from pounding_cli.solver.options import CALLED, PART

WRITTEN_KIND = BEHAVIOURS.index(WRITTEN_BEHAVIOUR)
"""Kind of the elements whose force is a formula of the study."""


@functools.cache
def _compile_function(function: Callable, is_part: bool) -> Any:
    """Return a function of a law, and those of the laws that it calls, compiled.

    is_part : as a part of its callers, instead of one that is called
    """
    scope = dict(function.__globals__)
    for name in function.__code__.co_names:
        called = scope.get(name)
        if isinstance(called, types.FunctionType) and called.__module__.startswith("pounding_cli.laws"):
            scope[name] = _compile_function(called, is_part)
    copy = types.FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
    return njit(**(PART if is_part else CALLED))(copy)


def _build_choice(name: str, arguments: str, is_part: bool) -> Any:
    """Return a function that calls the one of the element's kind, of those that the behaviours name so.

    Its text is written here, because a function that is compiled cannot choose from a list of others.

    Parameters
    ----------
    name : of a field of `Behaviour`
    arguments : of the function, the element first
    is_part : as of `_compile_function`
    """
    functions = {}
    lines = [f"def choose({arguments}):"]
    for kind, behaviour in enumerate(BEHAVIOURS):
        function = getattr(behaviour, name)
        if function is not None:
            functions[f"of_{kind}"] = _compile_function(function, is_part)
            lines += [f"    if e.kind == {kind}:", f"        return of_{kind}({arguments})"]
    lines.append(f"    return {list(functions)[-1]}({arguments})")
    exec("\n".join(lines), functions)
    return njit(**PART)(functions["choose"])


_next_branch = _build_choice("next_branch", "e, guard", is_part=False)
_force = _build_choice("force", "e, v, r", is_part=True)
history_rate = _build_choice("history_rate", "e, r, h", is_part=True)
_written_force = njit(**PART)(evaluate_operations)


@njit(**CALLED)
def next_branch(e, guard):
    """Put element e, which meets a guard, on its next branch; what it carries of P-Delta goes with the stiffness."""
    _next_branch(e, guard)
    e.stiffness = e.k - e.load


@njit(**PART)
def compute_line_force(e, v, r):
    """Return the force of the line, cubic or relaxing force of a branch [N] at v [m] and v' = r [m/s]."""
    if e.relaxation > 0.0:
        return e.h[0]
    f = e.k * v + e.c * r + e.f0
    if e.cubic != 0.0:
        f += e.cubic * v**3 + e.root * math.sqrt(e.k + 3.0 * e.cubic * v * v) * r
    return f


@njit(**PART)
def compute_force(e, v, r, formula):
    """Return the force of an element [N], with a smooth one too, at v [m] and v' = r [m/s].

    It is called inside loops and takes records alone: the references to an array would be counted at every call.
    """
    f = compute_line_force(e, v, r)
    return f + compute_smooth_force(e, v, r, formula) if e.smooth else f


@njit(**PART)
def compute_smooth_force(e, v, r, formula):
    """Return the force of a law without a Taylor series [N], beside that of its line, at v [m] and v' = r [m/s]."""
    return _written_force(formula, v, r) if e.kind == WRITTEN_KIND else _force(e, v, r)

"""Reports: what a results file says, as one object (`report`) that a terminal, a page and a notebook show."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING

from pounding_cli.errors import InputError, Problem

if TYPE_CHECKING:
    from pounding_cli.report.document import Report
    from pounding_cli.report.sweep import Asked
    from pounding_cli.results.results import ResultTables


def report(results: ResultTables, asked: Asked | None = None) -> Report:
    """Return the report of a results file.

    Parameters
    ----------
    results : of any command
    asked : of `pound run` over a sweep: which figures are drawn; the usual ones unless given

    Raises
    ------
    InputError : what is asked for is not there, or the file has no figures over a sweep
    """
    module = importlib.import_module(f"pounding_cli.report.{results.workflow}")
    make: Callable[..., Report] = getattr(module, f"{results.workflow}_report")
    if asked is None:
        return make(results)
    if reason := find_no_sweep(results):
        message = f"there are no figures over a sweep to choose: {reason}"
        raise InputError(Problem(message, "leave `asked` out", str(results.path)))
    return make(results, asked)


def find_no_sweep(results: ResultTables) -> str:
    """Return why a results file has no figures over a sweep; "" where it has some."""
    if results.workflow != "run":
        return f"the file holds the answer of `pound {results.workflow}`"
    return "" if results.axes else "its study sweeps nothing"

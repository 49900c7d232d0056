"""Reports: what a results file says, as one object (`report`) that a terminal, a page and a notebook show."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pounding_cli.report.document import Report
    from pounding_cli.results.results import Results


def report(results: Results, **asked: Any) -> Report:
    """The report of a results file.

    asked : of a run, what is drawn over the sweep (`sweep.Asked`)

    Raises
    ------
    InputError : what is asked for is not there
    """
    module = importlib.import_module(f"pounding_cli.report.{results.workflow}")
    make = getattr(module, f"{results.workflow}_report")
    return make(results, **asked) if results.workflow == "run" else make(results)

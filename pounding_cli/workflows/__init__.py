"""The questions that `pound` answers: what each asks of a study, solves and says.

Everything of a question stands in its modules; here is only what is known of all of them without importing them."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from pounding_cli.errors import InputError, Problem

if TYPE_CHECKING:
    from pounding_cli.workflows.workflow import Workflow

TITLES = {
    "run": "Run a study and print its summary.",
    "gap": "Find how wide the gap must be.",
    "fragility": "Find how likely limits are passed.",
    "sensitivity": "Find which uncertain keys matter most.",
    "optimise": "Find the best values of keys.",
}
"""Every question, by the name of its command, with its line in `pound --help`."""


def workflow_of(name: str) -> type[Workflow]:
    """The class of a question by its name.  Raises InputError: there is none."""
    if name not in TITLES:
        raise InputError(Problem(f"there is no workflow {name}", f"write one of {', '.join(TITLES)}"))
    module = "workflow" if name == "run" else name
    return getattr(importlib.import_module(f"pounding_cli.workflows.{module}"), name.capitalize())

"""The Python API: studies, single scenes, results and histories as a person at a prompt or in a notebook uses them.

Nothing is imported until it is asked for.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pounding_cli.api.histories import History
    from pounding_cli.api.results import Results
    from pounding_cli.api.scenes import building, history, motion, scene
    from pounding_cli.api.studies import load_study, open_results, run
    from pounding_cli.errors import InputError
    from pounding_cli.laws.infill import Infill
    from pounding_cli.laws.joints import Connector
    from pounding_cli.laws.pounding import Pounding
    from pounding_cli.model.building import Building
    from pounding_cli.model.links import Link
    from pounding_cli.model.scene import Scene
    from pounding_cli.records.motion import Motion
    from pounding_cli.solver.response import Response
    from pounding_cli.solver.solve import solve
    from pounding_cli.study import Study

__all__ = [
    "Building",
    "Connector",
    "History",
    "Infill",
    "InputError",
    "Link",
    "Motion",
    "Pounding",
    "Response",
    "Results",
    "Scene",
    "Study",
    "building",
    "history",
    "load_study",
    "motion",
    "open_results",
    "run",
    "scene",
    "solve",
]

_HOMES = {
    "Building": "model.building",
    "Connector": "laws.joints",
    "History": "api.histories",
    "Infill": "laws.infill",
    "InputError": "errors",
    "Link": "model.links",
    "Motion": "records.motion",
    "Pounding": "laws.pounding",
    "Response": "solver.response",
    "Results": "api.results",
    "Scene": "model.scene",
    "Study": "study.study",
    "building": "api.scenes",
    "history": "api.scenes",
    "load_study": "api.studies",
    "motion": "api.scenes",
    "open_results": "api.studies",
    "run": "api.studies",
    "scene": "api.scenes",
    "solve": "solver.solve",
}
"""Name -> the module below `pounding_cli` that holds it."""


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"pounding_cli.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'pounding_cli.api' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

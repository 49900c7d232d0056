"""Batch studies of earthquake pounding between adjacent buildings.

Everything public is here: `import pounding_cli as pound`, then `pound.run(...)`, `pound.scene(...)`. Names are imported
when they are first used, so that importing the package stays quick.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pounding_cli.api.results import Results as Results
    from pounding_cli.api.scenes import building as building
    from pounding_cli.api.scenes import history as history
    from pounding_cli.api.scenes import motion as motion
    from pounding_cli.api.scenes import scene as scene
    from pounding_cli.api.standing import Standing as Standing
    from pounding_cli.api.standing import explain_run as explain_run
    from pounding_cli.api.studies import load_study as load_study
    from pounding_cli.api.studies import open_results as open_results
    from pounding_cli.api.studies import run as run
    from pounding_cli.errors import InputError as InputError
    from pounding_cli.laws.infill import Infill as Infill
    from pounding_cli.laws.joints import Connector as Connector
    from pounding_cli.laws.pounding import Pounding as Pounding
    from pounding_cli.model.building import Building as Building
    from pounding_cli.model.links import Link as Link
    from pounding_cli.model.scene import Scene as Scene
    from pounding_cli.records.motion import Motion as Motion
    from pounding_cli.results.histories import History as History
    from pounding_cli.solver.response import Response as Response
    from pounding_cli.solver.solve import solve as solve
    from pounding_cli.study.study import Study as Study

__version__ = "0.1.0"

_OFFERED = {
    "api.results": ("Results",),
    "api.scenes": ("building", "history", "motion", "scene"),
    "api.standing": ("Standing", "explain_run"),
    "api.studies": ("load_study", "open_results", "run"),
    "errors": ("InputError",),
    "laws.joints": ("Connector",),
    "laws.infill": ("Infill",),
    "laws.pounding": ("Pounding",),
    "model.building": ("Building",),
    "model.links": ("Link",),
    "model.scene": ("Scene",),
    "records.motion": ("Motion",),
    "results.histories": ("History",),
    "solver.response": ("Response",),
    "solver.solve": ("solve",),
    "study.study": ("Study",),
}
"""Module below this package -> the names of it that are offered here."""

_HOMES = {name: module for module, names in _OFFERED.items() for name in names}

__all__ = ["__version__", *sorted(_HOMES)]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"pounding_cli.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'pounding_cli' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__} - {"Any", "TYPE_CHECKING", "importlib"})

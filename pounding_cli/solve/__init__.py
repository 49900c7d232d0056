"""From a scene to its response: arrays, methods, accuracy."""

from __future__ import annotations

from pounding_cli.solve.assess import assess
from pounding_cli.solve.methods import METHODS, is_compiled, solve
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response

__all__ = ["METHODS", "BuildingResponse", "LinkResponse", "Response", "assess", "is_compiled", "solve"]

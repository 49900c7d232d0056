"""From a scene to its response: arrays, methods, accuracy.

Calling this package calls its `solve`: as a subpackage it takes the place of the function of the same name in
`pounding_cli`, so `pounding_cli.solve(scene)` means the same before and after anything was imported from here.
"""

from __future__ import annotations

import inspect
import sys
import types
from typing import Any

from pounding_cli.methods import METHODS
from pounding_cli.solve.assess import assess
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response
from pounding_cli.solve.run import solve

__all__ = ["METHODS", "BuildingResponse", "LinkResponse", "Response", "assess", "solve"]


class _Callable(types.ModuleType):
    """This package, as the function `solve` where it is called."""

    __signature__ = inspect.signature(solve)

    def __call__(self, *arguments: Any, **options: Any) -> Response:
        return solve(*arguments, **options)


sys.modules[__name__].__class__ = _Callable

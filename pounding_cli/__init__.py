"""Batch studies of earthquake pounding between adjacent buildings.

Everything public is here: `import pounding_cli as pound`, then `pound.run(...)`, `pound.scene(...)`. Names are imported
when they are first used, so that importing the package stays quick.
"""

from typing import TYPE_CHECKING, Any

from pounding_cli.api import __all__ as _offered

if TYPE_CHECKING:
    from pounding_cli.api import *  # noqa: F403

__version__ = "0.1.0"
__all__ = ["__version__", *_offered]


def __getattr__(name: str) -> Any:
    if name in __all__:
        from pounding_cli import api

        return getattr(api, name)
    raise AttributeError(f"module 'pounding_cli' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__} - {"Any", "TYPE_CHECKING", "_offered"})

"""Batch studies of earthquake pounding between adjacent buildings.

Nothing heavy is imported here: `from pounding_cli import load_study, run, open_results` loads what it needs on use.
"""

__version__ = "0.1.0"
__all__ = ["__version__", "load_study", "open_results", "run"]


def __getattr__(name: str):
    if name in {"load_study", "run", "open_results"}:
        from pounding_cli import api

        return getattr(api, name)
    raise AttributeError(f"module 'pounding_cli' has no attribute {name!r}")

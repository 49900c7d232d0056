"""Many scenes, one writer: engines, progress, resume.

The solver is imported only when `run_plan` is asked for, so that progress can be told before.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pounding_cli.batch.outcome import Failure, Outcome

if TYPE_CHECKING:
    from pounding_cli.batch.runner import finished, run_plan

__all__ = ["Failure", "Outcome", "finished", "run_plan"]


def __getattr__(name: str) -> Any:
    if name in ("finished", "run_plan"):
        from pounding_cli.batch import runner

        return getattr(runner, name)
    raise AttributeError(f"module 'pounding_cli.batch' has no attribute {name!r}")

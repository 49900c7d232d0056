"""Many scenes, one writer: engines, progress, resume."""

from __future__ import annotations

from pounding_cli.batch.outcome import Failure, Outcome
from pounding_cli.batch.runner import run_plan

__all__ = ["Failure", "Outcome", "run_plan"]

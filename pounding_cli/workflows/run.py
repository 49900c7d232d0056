"""`pound run`: all scenes of a study."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pounding_cli.study import Plan, Study, expand
from pounding_cli.workflows.workflow import Found, Workflow

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver


class Run(Workflow):
    """Every scene of a study, and no table beyond those that every file has."""

    name = "run"

    def plan(self, study: Study) -> Plan:
        """All scenes."""
        return expand(study)

    def run(self, study: Study, solver: Solver) -> Found:
        """What all scenes did."""
        plan = self.plan(study)
        return Found(plan, solver.dataset(plan), [])


ASKED = Run()

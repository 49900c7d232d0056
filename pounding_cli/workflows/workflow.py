"""What every question is made of."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.solve import Solver
    from pounding_cli.results.tables import Table
    from pounding_cli.study import Plan, Study


@dataclass(frozen=True, eq=False)
class Found:
    """What a question came to.

    plan : of all scenes that tables are about
    dataset : what these did
    tables : the answer
    """

    plan: Plan
    dataset: xr.Dataset
    tables: list[Table]


class Workflow(ABC):
    """One kind of question; `name` is its command, and its section of a study file."""

    name: ClassVar[str]

    def check(self, study: Study) -> Any:
        """What a study asks.  Raises InputError where it asks what it cannot answer."""
        return None

    @abstractmethod
    def plan(self, study: Study) -> Plan:
        """The scenes that may be wanted, as far as is known before anything is solved.  Raises InputError as
        `check`."""

    def first(self, plan: Plan) -> np.ndarray:
        """The numbers of the scenes that are wanted in any case."""
        return np.arange(len(plan))

    @abstractmethod
    def run(self, study: Study, solver: Solver) -> Found:
        """The answer.  After an interruption it is asked again, and what was solved comes from the cache.

        Raises
        ------
        InputError : as `check`; the cache cannot be written
        """

    def goes_on(self, study: Study) -> bool:
        """Whether results decide what else is solved."""
        return False

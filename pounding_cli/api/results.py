"""Results with their main figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pounding_cli.errors import InputError
from pounding_cli.results.results import ResultTables

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Results(ResultTables):
    __doc__ = ResultTables.__doc__

    def plot(self, building: str | None = None) -> list[Axes]:
        """The main figure of a building: V/V0 elastic and mu/mu0 inelastic, storey by storey.

        Of a sweep it shows the largest mean over the storeys: as curves over one swept key, as maps over two.

        Parameters
        ----------
        building : by place in the group; the one of `report: {building: ...}`, else the stiffest, unless given

        Returns the axes of the panels.

        Raises
        ------
        InputError : no such building
        """
        from matplotlib import pyplot as plt

        from pounding_cli.report.evidence import find_nominal
        from pounding_cli.report.figures import response
        from pounding_cli.report.sweep import SweepChoice, list_sweep_pictures

        evidence = find_nominal(self)
        name = building or evidence.main_building
        if name not in evidence.group:
            raise InputError(f"no building '{name}' in these results", f"there are {', '.join(evidence.group)}")
        has_sweep = any(len(values) > 1 for values in self.axes.values())
        swept = list_sweep_pictures(self, evidence, SweepChoice(places={"building": name})) if has_sweep else []
        figure = swept[0].draw() if swept else response(evidence, name)
        plt.figure(FigureClass=lambda *_, **__: figure)  # type: ignore[arg-type]  # pyplot shows it from here on
        return [ax for ax in figure.axes if ax.get_title(loc="left")]

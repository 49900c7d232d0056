"""Results as a person looks at them: in a line, as a table, as an xarray Dataset, as a figure."""

from __future__ import annotations

from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

from pounding_cli.api.histories import History
from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
from pounding_cli.results import results

if TYPE_CHECKING:
    import pandas as pd
    import xarray
    from matplotlib.axes import Axes

_SHOWN = {"elastic": "V_ratio", "inelastic": "mu_ratio"}
_DIMS = {
    "building": ("building",),
    "case": ("case",),
    "analysis": ("analysis", "analyses"),
    "record": ("motion",),
}


class Results(results.Results):
    """The tables of a results file, and views of the whole of it."""

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """Every variable of the file over the swept axes, case, analysis, record, building, storey, floor and link,
        with units and meanings; read into memory when it is first asked for.
        """
        return self.data.load()

    def history(
        self, case: str | None = None, analysis: str | None = None, record: str | None = None, **swept: Any
    ) -> History:
        """One scene over time; what tells it from the other kept ones must be given.

        Parameters
        ----------
        case, analysis, record : names
        swept : values of swept keys, e.g. `**{"cases.gap.gap": 0.05}`

        Raises
        ------
        InputError : no kept scene, or more than one, is meant
        """
        return History.of(super().history(case, analysis, record, **swept))

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

        from pounding_cli.report.evidence import nominal
        from pounding_cli.report.figures import response
        from pounding_cli.report.style import drawn_on
        from pounding_cli.report.sweep import Asked, sweep_pictures

        shown = nominal(self)
        name = building or shown.main
        if name not in shown.group:
            raise InputError(Problem(f"no building '{name}' in these results", f"there are {', '.join(shown.group)}"))
        with drawn_on(plt.figure()):
            swept = sweep_pictures(self, shown, Asked(places={"building": name}))
            figure = swept[0].draw() if swept else response(shown, name)
        return [ax for ax in figure.axes if ax.get_xlabel()]

    def __repr__(self) -> str:
        names = {dim: self.data[dim].values.tolist() for dim in _DIMS}
        parts = [
            counted(len(names[dim]), *words) + (f" ({', '.join(names[dim])})" if len(names[dim]) <= 5 else "")
            for dim, words in _DIMS.items()
        ]
        if self.axes:
            parts.append("swept " + ", ".join(f"{key} ({len(values)})" for key, values in self.axes.items()))
        failed = f" ({self.attrs['scenes_failed']} failed)" if self.attrs["scenes_failed"] else ""
        scenes = counted(self.attrs["scenes"], "scene") + failed
        return f"Results({self.title!r}: {', '.join((*parts, scenes))}; {self.path})"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self))}</p>{self._worst().to_html(float_format='{:.3f}'.format, max_rows=40)}"

    def _worst(self) -> pd.DataFrame:
        """The largest mean ratio over the storeys and the sweep by case and building; columns analysis and ratio."""
        import pandas as pd

        summary = self.summary()
        order = [list(dict.fromkeys(summary[name])) for name in ("case", "building")]
        rows = pd.MultiIndex.from_product(order, names=["case", "building"])
        parts = {}
        for analysis, of_analysis in summary.groupby("analysis", sort=False):
            grouped = of_analysis.groupby(["case", "building"])
            for ratio in (_SHOWN[str(analysis)], "acceleration_ratio"):
                parts[analysis, ratio] = grouped[f"{ratio}_mean"].max().reindex(rows)
        return pd.DataFrame(parts).rename_axis(columns=["largest mean", ""])

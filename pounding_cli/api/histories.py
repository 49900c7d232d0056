"""A history as a person looks at it: in a line, as tables over time, as an xarray Dataset, as curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
from pounding_cli.results.histories import FIELDS
from pounding_cli.solver import histories
from pounding_cli.solver.histories import ENERGIES

if TYPE_CHECKING:
    import pandas as pd
    import xarray
    from matplotlib.axes import Axes

QUANTITIES: dict[str, tuple[tuple[str, ...], str, str]] = {
    **{name: meaning for name, meaning in FIELDS.items() if not name.startswith("energy_")},
    "energy": (("time", "kind"), "J", "energy put in, held and lost so far"),
}
"""What `frame` and `plot` can show -> dimensions, unit, meaning."""


class History(histories.History):
    """What a scene does over time; `frame`, `dataset` and `plot` leave out floors and links that do not exist."""

    closing: np.ndarray

    @classmethod
    def of(cls, history: histories.History) -> History:
        """The same history, to look at."""
        return cls(**{field.name: getattr(history, field.name) for field in fields(histories.History)})

    def frame(self, quantity: str = "displacement") -> pd.DataFrame:
        """One quantity over time, a column each for the floors, storeys or links that there are.

        Parameters
        ----------
        quantity : displacement, total_acceleration (columns: building and floor); drift, shear (building and storey);
            link_force, closing (link); sway, rocking (building); ground_acceleration, ground_displacement; energy

        The index is the time [s]; the unit stands in `frame.attrs["units"]`.

        Raises
        ------
        InputError : no such quantity
        """
        import pandas as pd

        (_, *dims), unit, text = _meaning(quantity)
        if quantity == "energy":
            values = np.stack([self.energy[kind] for kind in ENERGIES], axis=1)
        else:
            values = getattr(self, quantity).reshape(self.time.size, -1)
        columns: Any
        if not dims:
            columns = pd.Index([quantity])
        elif len(dims) == 2:
            numbers = range(1, self.displacement.shape[2] + 1)
            columns = pd.MultiIndex.from_product([self.buildings, numbers], names=dims)
        else:
            named = {"building": self.buildings, "link": self.links, "kind": ENERGIES}
            columns = pd.Index(named[dims[0]], name=dims[0])
        frame = pd.DataFrame(values, index=pd.Index(self.time, name="time"), columns=columns)
        frame = frame.loc[:, ~np.isnan(values).all(axis=0)]
        frame.attrs = {"units": unit, "long_name": text}
        return frame

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """Everything over time, building, floor, storey and link, with units; NaN where a floor does not exist."""
        import xarray

        numbers = np.arange(1, self.displacement.shape[2] + 1)
        names = {"building": list(self.buildings), "link": list(self.links), "kind": list(ENERGIES)}
        values = {name: getattr(self, name) for name in QUANTITIES if name != "energy"}
        values["energy"] = np.stack([self.energy[kind] for kind in ENERGIES], axis=1)
        about = {name: {"units": unit, "long_name": text} for name, (_, unit, text) in QUANTITIES.items()}
        return xarray.Dataset(
            {name: (QUANTITIES[name][0], array, about[name]) for name, array in values.items()},
            {"time": ("time", self.time, {"units": "s"}), "floor": numbers, "storey": numbers, **names},
        )

    def plot(
        self,
        *quantities: str,
        level: int | None = None,
        between: tuple[float, float] | None = None,
        axes: Axes | Sequence[Axes] | None = None,
    ) -> list[Axes]:
        """Curves over time, one panel a quantity: displacements, closings and link forces unless others are named.

        Parameters
        ----------
        quantities : as in `frame`
        level : floor or storey that is drawn of every building and link; the highest one unless given
        between : the part that is drawn [s]; all unless given
        axes : as many as there are quantities; new ones, one above the other, unless given

        Returns the axes.

        Raises
        ------
        InputError : no such quantity; a number of axes other than that of the quantities
        """
        import matplotlib.pyplot as plt

        chosen = quantities or tuple(q for q in ("displacement", "closing", "link_force") if self._has(q))
        frames = [self._curves(name, level) for name in chosen]
        given: Any = axes
        if given is None:
            shape = (7.0, 1.0 + 1.8 * len(chosen))
            given = plt.subplots(len(chosen), 1, sharex=True, figsize=shape, layout="constrained")[1]
        panels = list(np.atleast_1d(np.asarray(given, dtype=object)).ravel())
        if len(panels) != len(chosen):
            hint = f"give {counted(len(chosen), 'axis', 'axes')}, one a quantity: {', '.join(chosen)}"
            raise InputError(Problem(f"{counted(len(panels), 'axis', 'axes')} for {len(chosen)} quantities", hint))
        for ax, name, frame in zip(panels, chosen, frames, strict=True):
            part = frame if between is None else frame.loc[between[0] : between[1]]
            for column in part.columns:
                ax.plot(part.index, part[column], label=_label(column, part.columns.names), lw=1.2)
            ax.set_ylabel(f"{name.replace('_', ' ')} [{frame.attrs['units']}]")
            ax.grid(alpha=0.3)
            if len(part.columns) > 1 or part.columns.names[0] is not None:
                ax.legend(fontsize="small")
        panels[-1].set_xlabel("time [s]")
        return panels

    def __repr__(self) -> str:
        step = f" every {1000 * self.time[1]:.4g} ms" if self.time.size > 1 else ""
        return (
            f"History({', '.join(self.buildings)}; {counted(self._there().sum(), 'link')}; "
            f"{self.time[-1]:.4g} s{step}, {counted(self.time.size, 'time')})"
        )

    def _repr_html_(self) -> str:
        from html import escape

        return f"<p>{escape(repr(self))}</p>{self.largest().to_html(float_format='{:.4g}'.format)}"

    def largest(self) -> pd.DataFrame:
        """The largest value of every quantity in every building and over the links, where it is and when [s].

        Without regard to sign, except of closings. Between the output times values may be larger: the peaks in the
        tables of a results file are located there too.
        """
        import pandas as pd

        rows = []
        for name in ("displacement", "drift", "total_acceleration", "shear", "closing", "link_force"):
            frame = self.frame(name)
            if frame.empty:
                continue
            frame = frame if name == "closing" else frame.abs()
            whole = [frame] if "link" in frame.columns.names else [frame[[b]] for b in self.buildings]
            for part in whole:
                column = part.max().idxmax()
                where = _label(column, part.columns.names)
                rows.append((name, where, part[column].max(), QUANTITIES[name][1], part[column].idxmax()))
        return pd.DataFrame(rows, columns=["quantity", "where", "largest", "unit", "time"]).set_index(
            ["quantity", "where"]
        )

    def _there(self) -> np.ndarray:
        """Which links the scene has, shape (m,)."""
        return np.isfinite(self.link_force[0]) if self.time.size else np.zeros(len(self.links), bool)

    def _has(self, quantity: str) -> bool:
        return bool(self._there().any()) or "link" not in QUANTITIES[quantity][0]

    def _curves(self, quantity: str, level: int | None) -> pd.DataFrame:
        """What is drawn of a quantity: one floor or storey a building, one link a pair."""
        frame = self.frame(quantity)
        dims = QUANTITIES[quantity][0][1:]
        kept: list[Any]
        if len(dims) == 2:
            there: list[Any] = list(frame.columns)
            top = dict(there)  # the highest number comes last
            kept = [(building, number) for building, number in there if number == (level or top[building])]
        elif dims == ("link",):
            ends = dict(zip(self.links, histories.link_ends(self.buildings, self.links), strict=True))
            highest = {ends[label][0]: ends[label][1] for label in frame.columns}  # the highest comes last
            kept = [label for label in frame.columns if ends[label][1] == (level or highest[ends[label][0]])]
        else:
            return frame
        if not kept:
            raise InputError(Problem(f"{quantity}: there is nothing at level {level}", "give an existing floor"))
        part = frame.loc[:, kept]
        part.attrs = frame.attrs
        return part


def _meaning(quantity: str) -> tuple[tuple[str, ...], str, str]:
    if quantity not in QUANTITIES:
        raise InputError(Problem(f"no quantity '{quantity}' in a history", f"write one of {', '.join(QUANTITIES)}"))
    return QUANTITIES[quantity]


def _label(column: Any, names: Sequence[Any]) -> str:
    """A column in words: "soft, floor 5"."""
    return f"{column[0]}, {names[1]} {column[1]}" if isinstance(column, tuple) else str(column)

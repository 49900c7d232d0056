"""Scenes over time: the groups `histories/<n>` of a results file, a Dataset each (docs/histories.md), and a history as
a person looks at it: in a line, as tables, as curves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
from pounding_cli.solver.response import DONE
from pounding_cli.study.plan import Plan

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from pounding_cli.solver import histories as solver

FIELDS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "ground_acceleration": (("time",), "m/s2", "ground acceleration"),
    "ground_displacement": (("time",), "m", "ground acceleration integrated twice from rest, no baseline correction"),
    "displacement": (("time", "building", "floor"), "m", "floor displacement relative to the ground"),
    "total_acceleration": (("time", "building", "floor"), "m/s2", "floor acceleration, ground included"),
    "drift": (("time", "building", "storey"), "m", "storey drift"),
    "shear": (("time", "building", "storey"), "N", "storey shear, without damping force"),
    "sway": (("time", "building"), "m", "translation of the foundation"),
    "rocking": (("time", "building"), "rad", "rotation of the foundation"),
    "base_force": (("time", "building"), "N", "force of springs or isolators under the base, without damping force"),
    "link_force": (("time", "link"), "N", "link force, pulling negative"),
    "closing": (("time", "link"), "m", "closing of the two ends of a link, gap not subtracted"),
    "energy_input": (("time",), "J", "energy put in by the ground so far"),
    "energy_kinetic": (("time",), "J", "kinetic energy"),
    "energy_stored": (("time",), "J", "elastic energy in storeys and foundations"),
    "energy_damping": (("time",), "J", "energy lost in structural damping so far"),
    "energy_hysteresis": (("time",), "J", "energy lost in yielding storeys so far"),
    "energy_links": (("time",), "J", "energy the links took so far, stored or lost"),
}
"""Variable -> dimensions, unit, meaning."""

ENERGIES = tuple(name.removeprefix("energy_") for name in FIELDS if name.startswith("energy_"))

QUANTITIES = (*(name for name in FIELDS if not name.startswith("energy_")), "energy")
"""What `frame` and `plot` can show."""


class History:
    """What a scene does over time; NaN where a floor, storey or link does not exist.

    dataset : everything over time, building, floor, storey and link, with units (docs/histories.md).  Its variables are
        attributes too, as arrays: `history.drift`, shape (times, buildings, storeys) [m]
    buildings, links : names, left to right; `left|right floor j`
    energy : of every kind (input, kinetic, stored, damping, hysteresis, links), shape (times,) [J]
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self.dataset = dataset

    @classmethod
    def of(cls, history: solver.History) -> History:
        """The same, to look at."""
        import xarray as xr

        numbers = np.arange(1, history.displacement.shape[2] + 1)
        coords = {
            "time": ("time", history.time, {"units": "s", "long_name": "time since the motion began"}),
            "building": np.array(history.buildings, object),
            "storey": numbers,
            "floor": numbers,
            "link": np.array(history.links, object),
        }
        data = {}
        for name, (dims, unit, text) in FIELDS.items():
            of = name.removeprefix("energy_")
            values = getattr(history, name) if of == name else history.energy[of]
            data[name] = (dims, values, {"units": unit, "long_name": text})
        return cls(xr.Dataset(data, coords))

    def __getattr__(self, name: str) -> np.ndarray:
        if name != "time" and name not in FIELDS:
            raise AttributeError(f"a history has no {name!r}")
        return self.dataset[name].values

    @property
    def buildings(self) -> tuple[str, ...]:
        """Names, left to right."""
        return tuple(self.dataset["building"].values.tolist())

    @property
    def links(self) -> tuple[str, ...]:
        """Names in the order of the tables."""
        return tuple(self.dataset["link"].values.tolist())

    @property
    def energy(self) -> dict[str, np.ndarray]:
        """Of every kind, shape (times,) [J]; the first is the sum of the others."""
        return {kind: getattr(self, f"energy_{kind}") for kind in ENERGIES}

    def frame(self, quantity: str = "displacement") -> pd.DataFrame:
        """One quantity over time, a column each for the floors, storeys or links that there are.

        Parameters
        ----------
        quantity : displacement, total_acceleration (columns: building and floor); drift, shear (building and storey);
            link_force, closing (link); sway, rocking, base_force (building); ground_acceleration, ground_displacement;
            energy

        The index is the time [s]; the unit stands in `frame.attrs["units"]`.

        Raises
        ------
        InputError : no such quantity
        """
        import pandas as pd

        if quantity not in QUANTITIES:
            said = f"no quantity '{quantity}' in a history"
            raise InputError(Problem(said, f"write one of {', '.join(QUANTITIES)}"))
        array = self.dataset["energy_input" if quantity == "energy" else quantity]
        if quantity == "energy":
            frame = pd.DataFrame(self.energy, array.get_index("time")).rename_axis(columns="kind")
        else:
            flat = array.stack(place=array.dims[1:]) if array.ndim == 3 else array  # noqa: PD013 (of xarray)
            frame = pd.DataFrame(flat.to_pandas())
        frame = frame.dropna(axis=1, how="all")
        frame.attrs = {"units": array.attrs["units"]}
        return frame

    def plot(
        self,
        *quantities: str,
        level: int | None = None,
        between: tuple[float, float] | None = None,
    ) -> list[Axes]:
        """Curves over time, one panel a quantity: displacements, closings and link forces unless others are named.

        Parameters
        ----------
        quantities : as in `frame`
        level : floor or storey that is drawn of every building and link; the highest one unless given
        between : the part that is drawn [s]; all unless given

        Returns the axes of the panels.

        Raises
        ------
        InputError : no such quantity or level
        """
        import matplotlib.pyplot as plt

        has_links = not self.frame("link_force").empty
        chosen = quantities or ("displacement", *(("closing", "link_force") if has_links else ()))
        figure, panels = plt.subplots(len(chosen), sharex=True, squeeze=False, layout="constrained")
        figure.set_size_inches(7.0, 1.0 + 1.8 * len(chosen))
        for ax, name in zip(panels[:, 0], chosen, strict=True):
            frame = self._curves(name, level)
            frame = frame if between is None else frame.loc[between[0] : between[1]]
            for column in frame.columns:
                ax.plot(frame.index, frame[column], label=_label(column, frame), lw=1.2)
            ax.set_ylabel(f"{name.replace('_', ' ')} [{frame.attrs['units']}]")
            ax.grid(alpha=0.3)
            ax.legend(fontsize="small")
        ax.set_xlabel("time [s]")
        return list(panels[:, 0])

    def _curves(self, quantity: str, level: int | None) -> pd.DataFrame:
        """What is drawn of a quantity: one floor or storey a building, one link a pair."""
        frame = self.frame(quantity)
        places: list[Any] = list(frame.columns)
        if frame.columns.names == ["link"]:
            parts = [label.rpartition(" floor ") for label in places]
            places = [(pair, floors.split(",")[0].split("|")[0]) for pair, _, floors in parts]
        elif frame.columns.nlevels == 1:
            return frame
        top = dict(places)  # the highest number comes last
        kept = [str(number) == str(level or top[of]) for of, number in places]
        if not any(kept):
            raise InputError(Problem(f"{quantity}: there is nothing at level {level}", "give an existing floor"))
        return frame.loc[:, kept]

    def largest(self) -> pd.DataFrame:
        """The largest value of every quantity in every building and over the links, where it is and when [s].

        Without regard to sign, except of closings. Between the output times values may be larger: the peaks in the
        tables of a results file are located there too.
        """
        import pandas as pd

        rows = []
        for name in ("displacement", "drift", "total_acceleration", "shear", "closing", "link_force"):
            frame = self.frame(name)
            frame = frame if name == "closing" else frame.abs()
            whole = [frame] if frame.columns.nlevels == 1 else [frame[[b]] for b in self.buildings]
            for part in whole if not frame.empty else ():
                column = part.max().idxmax()
                largest = part[column].max(), FIELDS[name][1], part[column].idxmax()
                rows.append((name, _label(column, part), *largest))
        found = pd.DataFrame(rows, columns=["quantity", "where", "largest", "unit", "time"])
        return found.set_index(["quantity", "where"])

    def __repr__(self) -> str:
        time, links = self.time, self.frame("link_force").shape[1]
        step = f" every {1000 * time[1]:.4g} ms" if time.size > 1 else ""
        said = f"{counted(links, 'link')}; {time[-1]:.4g} s{step}, {counted(time.size, 'time')}"
        return f"History({', '.join(self.buildings)}; {said})"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<p>{escape(repr(self))}</p>{self.largest().to_html(float_format='{:.4g}'.format)}"


def _label(column: Any, frame: pd.DataFrame) -> str:
    """A column in words: "soft, floor 5"."""
    return f"{column[0]}, {frame.columns.names[1]} {column[1]}" if isinstance(column, tuple) else str(column)


def kept_histories(plan: Plan, found: xr.Dataset, tell: Callable[[str], None]) -> Iterator[xr.Dataset]:
    """The histories of the rows that a plan keeps, in the order of the tables, over the coordinates of its Dataset;
    those of rows whose scene failed are left out.

    tell : told of a run between output times that fails although the scene's own was done
    """
    over = {name: found[name].values for name in ("building", "storey", "floor", "link") if name in found.coords}
    for row in plan.kept:
        place: dict[str, Any] = {"case": row.case, "analysis": row.analysis, "record": row.record}
        at = dict(zip((axis.names[0] for axis in plan.axes), row.point, strict=True))
        if found["status"].sel(place).isel(at).item() != DONE:
            continue
        for axis, number in zip(plan.axes, row.point, strict=True):
            place |= dict(zip(axis.names, axis.values[number], strict=True))
        from pounding_cli.solver.histories import history  # here: a study without any needs no numba

        try:
            whole = History.of(history(plan.scene(row.scene), plan.accuracy, plan.every)).dataset
        except InputError as error:
            tell(f"{row.case}, {row.analysis}, {row.record}: {error}")
            continue
        digest = plan.digests[row.scene].tobytes().hex()
        yield whole.astype(np.float32).reindex(over).assign_attrs(place | {"scene": digest, "every": plan.every})

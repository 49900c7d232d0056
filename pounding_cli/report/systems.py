"""The report of `pound connector` and `pound wall` files: figures, numbers, claims on Figs 4, 5 and 8."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import pandas as pd

from pounding_cli.report.columns import Shown
from pounding_cli.report.connector_figures import connector_claims, draw_connector, point_label
from pounding_cli.report.style import FORMATS, unwritable
from pounding_cli.report.wall_claims import mesh_convergence, wall_claims
from pounding_cli.report.wall_figures import draw_wall
from pounding_cli.report.web import write_system_page
from pounding_cli.store.files import kind_of, opened_kind
from pounding_cli.store.swept import axes_of, coordinate
from pounding_cli.store.swept import written as unit_of
from pounding_cli.texts import cells

_READ = {
    "N": ("kN", 1e-3),
    "s": ("ms", 1e3),
    "N s": ("kN s", 1e-3),
    "N m": ("kN m", 1e-3),
    "N/m2": ("N/mm²", 1e-6),
    "1": ("–", 1.0),
}
"""SI unit -> the unit that numbers are read in, and its factor."""

_LABELS = {
    "peak1": "largest |R1|", "at1": "at Ω/ω10", "peak2": "largest |R2|", "at2": "at Ω/ω10",
    "frequency_low": "lower coupled frequency/ω10", "frequency_high": "higher coupled frequency/ω10",
    "p": "p = ω20/ω10",
}  # fmt: skip

_HEADINGS = {
    "history": "Contact force, speed of the striker, energy, and stress at the struck face",
    "accuracy": "Error of the peaks against processor time",
}

_ANCHOR = {"connector": "peak1", "wall": "peak_force"}
"""A variable that lies over the swept dimensions alone."""


def numbers(path: Path) -> pd.DataFrame:
    """Every number of the sweep, one row a point, swept keys first [SI]."""
    kind = kind_of(path)
    with opened_kind(path, kind) as file:
        axes = axes_of(file, _ANCHOR[kind])
        names = [name for name, item in file.items() if _over_axes(item, axes, file[_ANCHOR[kind]].shape)]
        rows: list[dict[str, Any]] = []
        for point in product(*(range(n) for n in file[_ANCHOR[kind]].shape)):
            row: dict[str, Any] = {axis: coordinate(file, axis)[place] for axis, place in zip(axes, point, strict=True)}
            row |= {name: float(file[name][point]) for name in names}
            rows.append(row)
    return pd.DataFrame(rows)


def write_system_report(
    path: Path, folder: Path, formats: Sequence[str] = FORMATS, with_page: bool = True
) -> list[Path]:
    """Write figures (none where `formats` is empty), numbers.csv and report.html; returns the files.

    Raises `InputError` for a file that neither `pound connector` nor `pound wall` wrote, or a folder that refuses.
    """
    kind = kind_of(path)
    with opened_kind(path, kind if kind in _ANCHOR else "wall") as file:
        title, study = str(file.attrs["title"]), str(file.attrs["study"])
    written: list[Path] = []
    if formats:
        draw = draw_connector if kind == "connector" else draw_wall
        written += draw(path, folder, tuple(formats))
    claims = connector_claims(path) if kind == "connector" else wall_claims(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        found = numbers(path)
        cells(found).to_csv(folder / "numbers.csv", index=False)
        written.append(folder / "numbers.csv")
        if with_page:
            convergence = mesh_convergence(path) if kind == "wall" else []
            drawn = sorted((f for f in written if f.suffix == ".png"), key=lambda file: file != _main(written))
            figures = {file: _heading(path, kind, file.stem) for file in drawn}
            looks = _looks(path, kind)
            written.append(write_system_page(title, study, folder, claims, convergence, figures, found, looks))
    except OSError as error:
        raise unwritable(folder, error) from error
    return written


def _looks(path: Path, kind: str) -> dict[str, Shown]:
    """How the page shows the columns of `numbers`: swept keys in the units of the study, others in usual ones."""
    with opened_kind(path, kind) as file:
        swept = {name: unit_of(file[name]) for name in axes_of(file, _ANCHOR[kind])}
        looks = {name: Shown(name, unit.name, 1 / unit.factor) for name, unit in swept.items()}
        for name, item in file.items():
            if isinstance(item, h5py.Dataset) and name not in looks and "long_name" in item.attrs:
                unit = str(item.attrs["units"])
                label = _LABELS.get(name, name.replace("_", " "))
                looks[name] = Shown(label, *_READ.get(unit, (unit, 1.0)), str(item.attrs["long_name"]))
    return looks


def _heading(path: Path, kind: str, stem: str) -> str:
    """The heading of a figure by its file name."""
    if kind == "connector":
        return "Largest displacements over those alone, against the frequency of the ground"
    what = stem.removeprefix(f"{path.stem}-")
    if what in _HEADINGS:
        return _HEADINGS[what]
    with opened_kind(path, kind) as file:
        axes = axes_of(file, _ANCHOR[kind])
        if what == "stress":
            return "Stress in the wall"
        if what.startswith("stress-"):
            return f"Stress in the wall, {point_label(file, axes, tuple(map(int, what.split('-')[1:])))}"
        key = next((axis for axis in axes if axis.replace(".", "-") == what), what)
    return f"Peaks against {key}"


def _main(files: Sequence[Path]) -> Path | None:
    """The figure the page begins with: of a wall the stresses at the last point of the sweep, else the first."""
    drawn = [file for file in files if file.suffix == ".png"]
    return next((file for file in reversed(drawn) if "-stress" in file.stem), drawn[0] if drawn else None)


def _over_axes(item: Any, axes: tuple[str, ...], shape: tuple[int, ...]) -> bool:
    """Whether a variable lies over the swept dimensions and no other."""
    if not isinstance(item, h5py.Dataset) or item.is_scale or item.shape != shape or item.dtype.kind != "f":
        return False
    return tuple(dim[0].name.rsplit("/", 1)[-1] for dim in item.dims if len(dim)) == axes

"""The report of `pound connector` and `pound wall` files: figures, numbers, claims on Figs 4, 5 and 8."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import pandas as pd

from pounding_cli.report.connector_figures import connector_claims, draw_connector
from pounding_cli.report.style import FORMATS, unwritable
from pounding_cli.report.wall_claims import mesh_convergence, wall_claims
from pounding_cli.report.wall_figures import draw_wall
from pounding_cli.report.web import write_system_page
from pounding_cli.store.files import kind_of, opened_kind
from pounding_cli.store.swept import axes_of, coordinate
from pounding_cli.texts import cells, write_markdown

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
    """Write figures (none where `formats` is empty), numbers.csv, summary.md and report.html; returns the files.

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
    lines = [f"# {title}", "", "| point | the paper says | found | holds |", "|---|---|---|---|"]
    for claim in claims:
        words = [str(claim[key]).replace("|", "\\|") for key in ("point", "paper", "found")]
        lines.append(f"| {' | '.join(words)} | {'yes' if claim['holds'] else 'no'} |")
    for figure in written:
        if figure.suffix == ".png":
            lines += ["", f"![{figure.stem}]({figure.name})"]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        found = numbers(path)
        cells(found).to_csv(folder / "numbers.csv", index=False)
        write_markdown(folder / "summary.md", lines)
        written += [folder / "numbers.csv", folder / "summary.md"]
        if with_page:
            convergence = mesh_convergence(path) if kind == "wall" else []
            figures = sorted(written, key=lambda file: file != _main(written))
            written.append(write_system_page(title, study, folder, claims, convergence, figures, found))
    except OSError as error:
        raise unwritable(folder, error) from error
    return written


def _main(files: Sequence[Path]) -> Path | None:
    """The figure the page begins with: of a wall the stresses at the last point of the sweep, else the first."""
    drawn = [file for file in files if file.suffix == ".png"]
    return next((file for file in reversed(drawn) if "-stress" in file.stem), drawn[0] if drawn else None)


def _over_axes(item: Any, axes: tuple[str, ...], shape: tuple[int, ...]) -> bool:
    """Whether a variable lies over the swept dimensions and no other."""
    if not isinstance(item, h5py.Dataset) or item.is_scale or item.shape != shape or item.dtype.kind != "f":
        return False
    return tuple(dim[0].name.rsplit("/", 1)[-1] for dim in item.dims if len(dim)) == axes

"""Motion files of every format that a study may name, written beside a copy of the study."""

from __future__ import annotations

from pathlib import Path

from tests.helpers import motion_layouts as layouts

IN_G = layouts.samples(0.3)
IN_CM = layouts.samples(300.0)
IN_M = layouts.samples(3.0)
TIMES = [layouts.DT * place for place in range(layouts.COUNT)]


def lines(*columns: list[float], between: str = " ") -> str:
    """Columns of numbers with five decimals."""
    return "".join(between.join(f"{value:.5f}" for value in row) + "\n" for row in zip(*columns, strict=True))


FILES = {
    "g.AT2": layouts.at2(IN_G),
    "cosmos.V1c": layouts.cosmos_channel(IN_CM),
    "csmip.V2": layouts.csmip_v2_channel(IN_CM)
    + layouts.csmip_v2_channel(layouts.samples(200.0, seed=1.3), channel=2, label="180 Deg"),
    "smc.smc": layouts.smc(IN_CM),
    "knet.EW": layouts.knet([round(1e6 * value) + 8009 for value in IN_G]),
    "esm.ASC": layouts.esm(IN_CM),
    "pairs.txt": "t [s]; a [cm/s2]\n" + lines(TIMES, IN_CM, between="; "),
    "decimal.csv": lines(TIMES, IN_CM, between=";").replace(".", ","),
    "table.txt": lines(TIMES, IN_G, IN_M),
    "values.dat": lines(layouts.samples(300.0)),
    "rows.dat": layouts.rows(IN_M, "10.5f", 8),
    "folder/one.txt": "# unit: g\n" + lines(TIMES, IN_G),
    "folder/two.txt": "time [s] acc [g]\n" + lines(TIMES, layouts.samples(0.2, seed=1.1)),
}


def write(folder: Path) -> None:
    """All of them."""
    for name, text in FILES.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)

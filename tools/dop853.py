"""Writes the coefficients of DOP853 as SciPy has them to `pounding_cli/solver/dop853.json`, which loads a hundred times
as fast as `scipy.integrate`: `python tools/dop853.py`."""

from __future__ import annotations

import json
from pathlib import Path

from scipy.integrate import DOP853

FILE = Path(__file__).parents[1] / "pounding_cli" / "solver" / "dop853.json"


def coefficients() -> dict[str, list]:
    """Every table of DOP853 under its name in SciPy."""
    return {name: getattr(DOP853, name).tolist() for name in ("A", "A_EXTRA", "B", "C", "C_EXTRA", "D", "E3", "E5")}


if __name__ == "__main__":
    FILE.write_text("{\n" + ",\n".join(f'"{k}": {json.dumps(v)}' for k, v in coefficients().items()) + "\n}\n")

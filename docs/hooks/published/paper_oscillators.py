"""Two connected oscillators beside Figs 4 and 5 of the paper."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from typing import Any

import h5py
import numpy as np
from comparison import GALLERY, Entry, Row, compare


def compare_paper_oscillators(solved: Any) -> Iterator[Row]:
    """Yield the frequencies of its Fig. 4 beside the roots of their equation, and the statement on its Fig. 5."""
    p, k = 0.6, 0.2
    middle = (1 + k + p**2 + k) / 2
    spread = sqrt(((1 + k) - (p**2 + k)) ** 2 / 4 + k**2)
    low, high = solved.written().iloc[0][["frequency_low", "frequency_high"]]
    why = "Fig. 4 by formula"
    yield compare("lower frequency over that of the first alone", sqrt(middle - spread), low, ".4f", why)
    yield compare("higher frequency", sqrt(middle + spread), high, ".4f", why)
    with h5py.File(solved.file) as file:
        frequencies, first, second = (file[name][()] for name in ("frequency", "R1", "R2"))
    rises = frequencies[(first[0] > 1) & (second[0] > 1)]
    jump = int(np.argmax(np.diff(rises)))
    bands = f"{rises[0]:.2f} to {rises[jump]:.2f} and {rises[jump + 1]:.2f} to {rises[-1]:.2f}"
    yield Row(
        "one displacement rises where the other falls (Fig. 5)",
        '"whenever"',
        f"but for {bands} times the frequency of the first",
        f"{100 * len(rises) / len(frequencies):.0f} % of the frequencies",
        "it holds for the signed ratios of undamped systems, whose sum is constant, not for largest displacements",
    )


ENTRY = Entry(compare_paper_oscillators, "connector", GALLERY)

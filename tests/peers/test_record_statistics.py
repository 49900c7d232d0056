"""Statistics over the records against pandas, on ratios that differ from record to record."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from pounding_cli.store.statistics import over_records


@pytest.mark.parametrize("missing", [0, 1, 3, 4])
def test_against_pandas(missing):
    """Mean, deviation (n - 1), extremes and number, NaN left out. Fails if the deviation divides by n."""
    ratios = np.random.default_rng(7).lognormal(size=(3, 5, 2))
    ratios[1, :missing, 0] = np.nan
    found = over_records(ratios, axis=1)
    for i in range(3):
        for j in range(2):
            series = pd.Series(ratios[i, :, j])
            for name in ("mean", "std", "min", "max", "count"):
                assert found[name][i, j] == pytest.approx(getattr(series, name)(), rel=1e-13, nan_ok=True), name

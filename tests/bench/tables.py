"""The tables `storey` and `scene` made by xarray beside those of `Results`: the same numbers, and the time of each:
`python -m tests.bench.tables FILE.h5`."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import xarray

from pounding_cli.api import open_results
from pounding_cli.store.files import opened_dataset

TRIES = 3


def storey(data: xarray.Dataset, names: list[str]) -> pd.DataFrame:
    """The table by xarray; of a storey that exists, in a scene that was asked for."""
    dims = [str(dim) for dim in data[names[0]].dims]
    there = ((data["mass"] > 0) & (data["status"] != "")).broadcast_like(data[names[0]]).transpose(*dims)
    return data[names].to_dataframe(dim_order=dims)[there.to_numpy().ravel()].reset_index()


def scene(data: xarray.Dataset, names: list[str]) -> pd.DataFrame:
    """The table by xarray."""
    frame = data[names].to_dataframe(dim_order=[str(dim) for dim in data["status"].dims])
    return frame[frame["status"] != ""].reset_index()


def least(work: Callable[[], object]) -> float:
    """Processor time, the least of several tries [s]."""
    times = []
    for _ in range(TRIES):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


def main(path: Path) -> None:
    results = open_results(path)

    def by_xarray(make: Callable[[xarray.Dataset, list[str]], object], names: list[str]) -> object:
        with opened_dataset(path) as data:
            return make(data, names)

    alone = least(lambda: open_results(path)), least(lambda: by_xarray(lambda data, _: data, []))
    print(f"open: {alone[0]:.3f} s, by xarray {alone[1]:.3f} s")
    for name, make in (("storey", storey), ("scene", scene)):
        own = results.table(name)
        names = [column for column in own if column in results.dataset.data_vars]
        other = by_xarray(make, names)
        assert isinstance(other, pd.DataFrame)
        for column in names:
            one, two = own[column].to_numpy(), other[column].to_numpy()
            assert np.array_equal(one, two, equal_nan=one.dtype.kind == "f"), column
        times = least(lambda name=name: results.table(name)), least(lambda make=make, n=names: by_xarray(make, n))
        print(f"{name}, {len(own)} rows: {times[0]:.3f} s, by xarray {times[1]:.3f} s")


if __name__ == "__main__":
    main(Path(sys.argv[1]))

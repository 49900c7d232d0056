"""The results file of `pound connector`: both ratios over frequency, their peaks, the coupled frequencies."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pounding_cli.connector.findings import Findings, find
from pounding_cli.connector.oscillators import Oscillators, response_ratios
from pounding_cli.store.swept import create, write_array, write_axes, write_head, write_scale
from pounding_cli.study.system_study import SystemStudy


def write_connector(study: SystemStudy[Oscillators], path: Path) -> list[Findings]:
    """Compute every point of a study and write it; returns what was found at each point, in its order.

    Over the swept dimensions and `frequency` (Omega / omega10): R1, R2 (sizes), R1_real, R1_imag, ...;
    over the swept dimensions: peak1, at1, peak2, at2, frequency_low, frequency_high (over omega10);
    bands in which both ratios exceed one: both_above (band, edge), padded with NaN.
    """
    shape = tuple(len(axis.nodes) for axis in study.axes)
    low, high, count = study.spec.frequencies.low, study.spec.frequencies.high, study.spec.frequencies.points
    ratio = np.linspace(low, high, count)
    found = [find(p.model, low, high, max(count, 4001)) for p in study.points]
    curves = np.array([response_ratios(p.model, ratio * p.model.omega10) for p in study.points])
    with create(path) as file:
        write_head(file, "connector", study, path)
        dims = write_axes(file, study.axes, [(p.index, p.values) for p in study.points])
        write_scale(file, "frequency", ratio, "1")
        for which in (0, 1):
            name = f"R{which + 1}"
            what = f"displacement of system {which + 1}, connected over alone"
            values = curves[:, which].reshape(*shape, ratio.size)
            for suffix, part in (("", np.abs(values)), ("_real", values.real), ("_imag", values.imag)):
                write_array(file, name + suffix, part, (*dims, "frequency"), "1", what)
        for name in ("peak1", "at1", "peak2", "at2"):
            values = np.array([getattr(f, name) for f in found]).reshape(shape)
            what = "largest ratio of system " if name.startswith("peak") else "Omega / omega10 at the peak of system "
            write_array(file, name, values, dims, "1", what + name[-1])
        for place, name in enumerate(("frequency_low", "frequency_high")):
            values = np.array([f.frequencies[place] for f in found]).reshape(shape)
            write_array(file, name, values, dims, "1", "coupled frequency over omega10")
        values = np.array([p.model.p for p in study.points]).reshape(shape)
        write_array(file, "p", values, dims, "1", "omega20 / omega10")
        most = max((len(f.both_above) for f in found), default=0)
        bands = np.full((len(found), most, 2), np.nan)
        for place, f in enumerate(found):
            bands[place, : len(f.both_above)] = f.both_above
        write_scale(file, "band", np.arange(most, dtype=float), "1")
        write_scale(file, "edge", np.arange(2, dtype=float), "1")
        what = "bands of Omega / omega10 in which both ratios exceed one"
        write_array(file, "both_above", bands.reshape(*shape, most, 2), (*dims, "band", "edge"), "1", what)
    return found

"""The readers of motion files against gmprocess (USGS) and ObsPy, which read the same formats with code of their own.

Neither is a dependency (gmprocess with all it needs is 1.8 GB), nor locked: `pip install gmprocess` and run this file.
"""

from pathlib import Path

import numpy as np
import pytest

import pounding_cli as pound
from tests.helpers import motion_layouts as layouts

CM = layouts.samples(60.0, 200)
COUNTS = [round(40000 * np.sin(0.3 * i) * np.exp(-0.02 * i)) + 8009 for i in range(200)]
FILES = {
    "knet": ("knet", "read_knet", "TST0010601020304.NS", layouts.knet(COUNTS)),
    "esm": ("esm", "read_esm", "XX.TST..HNE.ASC", layouts.esm(CM)),
    "smc": ("smc", "read_smc", "test.smc", layouts.smc(CM)),
    "cosmos": ("cosmos", "read_cosmos", "test.V2c", layouts.cosmos_channel(CM)),
    "csmip V2": ("dmg", "read_dmg", "test.V2", layouts.csmip_v2_channel(CM)),
}


@pytest.mark.parametrize("name", FILES)
def test_gmprocess_reads_the_same_motion(tmp_path: Path, name: str) -> None:
    pytest.importorskip("gmprocess")
    module, function, file, text = FILES[name]
    path = tmp_path / file
    path.write_text(text)
    read = getattr(__import__(f"gmprocess.io.{module}.core", fromlist=[function]), function)
    trace = read(str(path))[0][0]
    own = pound.motion(path)
    assert own.dt == pytest.approx(trace.stats.delta, rel=1e-9)
    theirs = np.asarray(trace.data, dtype=float) * 0.01  # gmprocess gives cm/s2
    if name == "knet":  # and leaves the recorder's offset in
        theirs = theirs - theirs.mean()
    assert own.acceleration == pytest.approx(theirs, rel=1e-9, abs=1e-12)


def test_obspy_reads_the_same_knet_motion(tmp_path: Path) -> None:
    obspy = pytest.importorskip("obspy")
    path = tmp_path / "TST0010601020304.NS"
    path.write_text(layouts.knet(COUNTS))
    trace = obspy.read(str(path), format="KNET")[0]
    own = pound.motion(path)
    assert own.dt == pytest.approx(trace.stats.delta)
    theirs = trace.data * trace.stats.calib  # ObsPy's factor gives m/s2
    assert own.acceleration == pytest.approx(theirs - theirs.mean(), rel=1e-9, abs=1e-12)

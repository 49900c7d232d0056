"""Results in programs that are not Python, where Octave and the HDF5 tools are installed (Debian: octave, hdf5-tools).

HDFView and MATLAB are not here: h5dump and Octave stand in for them.
"""

from __future__ import annotations

import re
import shutil
import subprocess

import h5py
import numpy as np
import pytest
from pages import ROOT, blocks

PAGE = ROOT / "docs" / "how-to" / "other-programs.md"

TWO = """\
records: {use: [elcentro, taft], duration: 3 s}
estimate: none
buildings:
  stiff: {storeys: 5, period: 0.36 s}
  soft: {storeys: 3, period: 0.60 s}
group: [stiff, soft]
cases:
  touching: {link: pounding, gap: 0 cm}
sweep: {impact.restitution: [0.4, 0.6]}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with results/pair.h5: shorter buildings padded, a swept axis with a dot in its name."""
    from pounding_cli import run

    folder = tmp_path_factory.mktemp("programs")
    (folder / "pair.yaml").write_text(TWO)
    run(folder / "pair.yaml", folder / "results" / "pair.h5", engine="serial")
    return folder


def ran(folder, *command: str) -> str:
    if shutil.which(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed")
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


def recipe(word: str) -> str:
    (block,) = [block for block in blocks(PAGE) if block.word == word]
    return block.text


def test_octave_reads_numbers_in_reverse_order(folder):
    """The page's recipe, then one number by its place."""
    script = (
        recipe("octave")
        + "printf('%.17g\\n', ratio(5, 1, 2, 1, 1, 2)); printf('%g ', size(ratio)); printf('%d', data.storey);"
    )
    worst, one, shape_storeys = ran(folder, "octave", "--no-gui", "--quiet", "--eval", script).splitlines()
    with h5py.File(folder / "results" / "pair.h5") as file:
        ratio = file["V_ratio"][()]
    assert float(worst) == pytest.approx(np.nanmax(ratio), abs=1e-6)
    assert float(one) == ratio[1, 0, 0, 1, 0, 4]
    shape, storeys = shape_storeys.rsplit(" ", 1)
    assert [int(size) for size in shape.split()] == list(ratio.shape[::-1])
    assert storeys == "12345"


def test_the_hdf5_tools_show_numbers_units_and_names(folder):
    listed = ran(folder, "h5ls", "results/pair.h5")
    assert re.search(r"^V_ratio +Dataset \{2, 1, 2, 2, 2, 5\}$", listed, flags=re.MULTILINE)
    dumped = ran(folder, "h5dump", "-d", "/V_ratio", "-s", "0,0,0,0,0,0", "-c", "1,1,1,1,1,5", "results/pair.h5")
    shown = [float(n) for n in re.findall(r"(?<=[ ,])\d+\.\d+", dumped.split("DATA {")[1].split("}")[0])]
    with h5py.File(folder / "results" / "pair.h5") as file:
        assert shown == pytest.approx(file["V_ratio"][0, 0, 0, 0, 0], rel=1e-5)
    assert '"N"' in ran(folder, "h5dump", "-a", "/V/units", "results/pair.h5")
    assert '"touching"' in ran(folder, "h5dump", "-d", "/case", "results/pair.h5")

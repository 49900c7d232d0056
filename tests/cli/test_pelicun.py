"""`pound export --pelicun`: the demands of a building by Pelicun's names and units."""

from __future__ import annotations

import os
import subprocess

import numpy as np
import pandas as pd
import pytest

from pounding_cli import open_results

from .conftest import TWO

STUDY = TWO.replace("[elcentro, taft]", "[taft, elcentro]") + "residual_drift: true\nsweep: {records.scale: [2, 1]}\n"
"""Motions and scales not in order."""
ONE = ("--case", "gap", "--analysis", "inelastic", "--building", "soft")


def test_the_demands_of_a_building(folder, pound):
    assert pound("run", "two.yaml", "-o", "r.h5")[0] == 0
    code, out, _ = pound("export", "r.h5", "--pelicun", *ONE, "-o", "d.csv")
    assert code == 0
    assert "wrote d.csv" in out
    table = pd.read_csv("d.csv", index_col=0)
    units, rows = table.loc["Units"], table.drop(index="Units").astype(float)
    assert list(rows.index) == [f"records.scale = {scale}, {name}" for scale in (2, 1) for name in ("taft", "elcentro")]
    assert list(rows) == ["PFA-0-1", *(f"{kind}-{floor}-1" for kind in ("PFA", "PID", "RID") for floor in (1, 2))]
    assert units.to_dict() == {name: "mps2" if name.startswith("PFA") else "rad" for name in rows}
    storey, floor = open_results("r.h5").storey(), open_results("r.h5").floor()
    mine = [frame[(frame.case == "gap") & (frame.analysis == "inelastic") & (frame.building == "soft")]
            for frame in (storey, floor)]  # fmt: skip
    np.testing.assert_allclose(rows["PID-2-1"], mine[0][mine[0].storey == 2]["drift_ratio"], rtol=1e-12)
    np.testing.assert_allclose(rows["PFA-1-1"], mine[1][mine[1].floor == 1]["acceleration"], rtol=1e-12)
    np.testing.assert_allclose(rows["RID-1-1"], mine[0][mine[0].storey == 1]["residual_drift"].abs() / 3.0, rtol=1e-9)
    np.testing.assert_allclose(rows["PFA-0-1"], open_results("r.h5").records()["pga"], rtol=1e-12)
    code, _, _ = pound("export", "r.h5", "--pelicun", *ONE, "--where", "records.scale=2", "-o", "one.csv")
    assert code == 0
    assert len(pd.read_csv("one.csv")) == 3


def test_without_a_sweep_a_row_is_called_by_its_motion(folder, pound):
    (folder / "two.yaml").write_text(STUDY[: STUDY.index("sweep:")])
    pound("run", "two.yaml", "-o", "r.h5")
    assert pound("export", "r.h5", "--pelicun", *ONE, "-o", "d.csv")[0] == 0
    assert pd.read_csv("d.csv", index_col=0).index.tolist() == ["Units", "taft", "elcentro"]


def test_a_file_without_residual_drifts_is_refused(folder, pound):
    (folder / "two.yaml").write_text(TWO)
    pound("run", "two.yaml", "-o", "r.h5")
    storeys = open_results("r.h5").storey()
    is_elastic = storeys["analysis"] == "elastic"
    assert storeys["residual_drift"][~is_elastic].isna().all()
    assert (storeys["residual_drift"][is_elastic] == 0.0).all()
    code, _, err = pound("export", "r.h5", "--pelicun", *ONE, "-o", "d.csv")
    assert code == 2
    assert "residual_drift: true" in err
    assert not (folder / "d.csv").exists()


def test_what_is_not_one_building_is_refused(folder, pound):
    pound("run", "two.yaml", "-o", "r.h5")
    code, _, err = pound("export", "r.h5", "--pelicun", "--case", "gap", "--analysis", "inelastic")
    assert code == 2
    assert "one building, not 2" in err
    code, _, err = pound("export", "r.h5", "--case", "gap")
    assert code == 2
    assert "--pelicun" in err


@pytest.mark.skipif("PELICUN_PYTHON" not in os.environ, reason="needs Pelicun in an environment of its own: make peers")
def test_pelicun_reads_it(folder, pound):
    """PELICUN_PYTHON is the Python of an environment with Pelicun, which takes an older pandas than this program."""
    pound("run", "two.yaml", "-o", "r.h5")
    pound("export", "r.h5", "--pelicun", *ONE, "-o", "d.csv")
    code = (
        "from pelicun.assessment import Assessment; a = Assessment({'PrintLog': False}); "
        "a.demand.load_sample('d.csv'); print(a.demand.sample.shape)"
    )
    done = subprocess.run([os.environ["PELICUN_PYTHON"], "-c", code], capture_output=True, text=True, check=True)
    assert "(4, 7)" in done.stdout

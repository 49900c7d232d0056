"""`pound export`: what it says it wrote is there; what it cannot write is refused."""

from __future__ import annotations

import subprocess
import sys

import pandas as pd
import pytest

import pounding_cli
from tests.helpers.two_buildings import known

SOLVE = known


@pytest.fixture
def exported(folder, pound):
    """`pound export r.h5 ...` after a run."""
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    return lambda *arguments: pound("export", "r.h5", *arguments)


def test_all_tables_go_to_a_folder_beside_the_file(folder, exported):
    code, out, err = exported()
    assert (code, err) == (0, "")
    assert out.splitlines()[0] == "wrote r-csv/storey.csv"
    assert sorted(line.removeprefix("wrote ") for line in out.splitlines()) == sorted(
        str(path.relative_to(folder)) for path in (folder / "r-csv").iterdir()
    )


def test_the_end_of_the_name_says_the_format(folder, exported):
    code, out, _ = exported("storey", "-o", "s.parquet")
    assert (code, out) == (0, "wrote s.parquet\n")
    exact = pounding_cli.open_results("r.h5").storey()
    pd.testing.assert_frame_equal(pd.read_parquet("s.parquet"), exact)


def test_a_contradiction_is_refused(exported):
    code, out, err = exported("--format", "excel", "-o", "s.csv")
    assert (code, out) == (2, "")
    assert "s.csv is not a name for excel\n    end it in .xlsx" in err


@pytest.mark.skipif(sys.platform == "win32", reason="no ulimit there")
@pytest.mark.parametrize("output", ["out.csv", "out", "out.nc", "out.parquet"])
def test_a_disk_that_is_full_is_one_sentence_and_leaves_nothing_half_written(folder, pound, output):
    """The limit on a file's size stands for the disk: writes fail in the middle, as they do there. (It would also hold
    for the temporary files that Excel's writer makes elsewhere.)"""
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    main = "import sys; from pounding_cli.cli.main import main; main()"
    table = "storey" if output.endswith((".csv", ".parquet")) else ""
    shell = f"ulimit -f 2; '{sys.executable}' -c '{main}' export r.h5 {table} -o {output}"
    found = subprocess.run(["bash", "-c", shell], capture_output=True, text=True, check=False)
    assert found.returncode == 2
    assert "cannot be written: " in found.stderr
    assert "File too large" in found.stderr
    assert "Traceback" not in found.stderr
    assert len(found.stderr.splitlines()) == 2
    assert not [path for path in folder.rglob("*") if "part" in path.name or (path.name == output and path.is_file())]

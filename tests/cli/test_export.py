"""`pound export`: what it says it wrote is there; what it cannot write is refused."""

from __future__ import annotations

import pandas as pd
import pytest
from test_run import folder, known, pound  # noqa: F401  (fixtures)

import pounding_cli


@pytest.fixture
def exported(folder, pound):  # noqa: F811
    """`pound export r.h5 ...` after a run."""
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    return lambda *arguments: pound("export", "r.h5", *arguments)


def test_all_tables_go_to_a_folder_beside_the_file(folder, exported):  # noqa: F811
    code, out, err = exported()
    assert (code, err) == (0, "")
    assert out.splitlines()[0] == "wrote r-csv/storey.csv"
    assert sorted(line.removeprefix("wrote ") for line in out.splitlines()) == sorted(
        str(path.relative_to(folder)) for path in (folder / "r-csv").iterdir()
    )


def test_the_end_of_the_name_says_the_format(folder, exported):  # noqa: F811
    code, out, _ = exported("storey", "-o", "s.parquet")
    assert (code, out) == (0, "wrote s.parquet\n")
    exact = pounding_cli.open_results("r.h5").storey()
    pd.testing.assert_frame_equal(pd.read_parquet("s.parquet"), exact)


def test_a_contradiction_is_refused(exported):
    code, out, err = exported("--format", "excel", "-o", "s.csv")
    assert (code, out) == (2, "")
    assert "s.csv is not a name for excel\n    end it in .xlsx" in err

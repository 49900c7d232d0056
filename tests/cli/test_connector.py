"""`pound connector` from study file to results file, figure and claims."""

from __future__ import annotations

import os
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from pounding_cli.cli.connector import command
from pounding_cli.errors import InputError
from pounding_cli.report.connector_figures import connector_claims
from pounding_cli.store.seal import Sealed
from pounding_cli.study.connector_study import load_connector_study

FIG5 = Path(__file__).parents[2] / "configs" / "fig5.yaml"


def run(*arguments):
    return CliRunner().invoke(command, [str(a) for a in arguments], catch_exceptions=False)


def test_figure_5(tmp_path):
    out = tmp_path / "fig5.h5"
    result = run(FIG5, "-o", out)
    assert result.exit_code == 0
    assert "|R1| at most 3.980 at Omega/omega10 = 0.701" in result.output
    assert "0.652-0.772, 1.086-1.163" in result.output
    assert "\ndamping = 5 %\n" in result.output
    assert (tmp_path / "fig5.png").stat().st_size > 10_000
    assert "system 1" in (tmp_path / "fig5.svg").read_text()
    with xr.open_dataset(out, engine="h5netcdf") as data:
        assert data["R1"].dims == ("damping", "frequency")
        assert float(data["peak2"].sel(damping=0.10)) == pytest.approx(2.40, abs=0.01)
        identity = data["R1_real"] + data["R2_real"], data["R1_imag"] + data["R2_imag"]
        assert float(abs(identity[0] - 2).max()) < 1e-12
        assert float(abs(identity[1]).max()) < 1e-12
    claims = connector_claims(out)
    assert [c["holds"] for c in claims] == [True, False, True, False]


def test_no_sweep_general_masses_and_no_bands(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text(
        "title: other\nfirst: {mass: 100 t, stiffness: 20 kN/mm, damping: 2 %}\n"
        "second: {mass: 300 t, period: 0.9 s}\nconnector: {stiffness: 0 N/m, damping_ratio: 0.1}\n"
    )
    result = run(study, "-o", tmp_path / "a.h5", "--no-figures")
    assert "both ratios exceed 1 in: nowhere" in result.output
    assert "(alone: 1, 0.4937)" in result.output  # (2 pi / 0.9) / sqrt(20e6 / 100e3)
    with xr.open_dataset(tmp_path / "a.h5", engine="h5netcdf") as data:
        assert float(data["peak1"]) == pytest.approx(1.0, abs=1e-12)
    assert not (tmp_path / "a.png").exists()


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("title: t\nsecond: {frequncy_ratio: 0.6}\n", 2, "frequncy_ratio"),
        ("title: t\ndamping: 3 m\n", 2, "3 m"),
        ("title: t\nsecond: {mass: 1 t}\n", 2, "no frequency"),
        ("title: t\nsecond: {period: 1 s, frequency_ratio: 0.5}\n", 2, "cannot both"),
        ("title: t\nsweep: {dampng: [1 %]}\n", 2, "dampng"),
        ("title: t\nsweep:\n  damping: 5 %\n", 3, "not a list"),
        ("title: t\nsweep:\n  damping: [5 %, -1]\n", 3, "damping"),
        ("title: t\nsweep: {frequencies.low: [0.1, 0.2]}\n", 2, "cannot be an axis"),
        ("title: t\nsweep: {first: [1, 2]}\n", 2, "whole section"),
        ("title: t\nfrequencies: {low: 2, high: 1}\n", 2, "not below"),
        ("title: t\nconnector: {stiffness: soft}\n", 2, "soft"),
    ],
)
def test_refused(tmp_path, text, line, words):
    study = tmp_path / "bad.yaml"
    study.write_text(text)
    with pytest.raises(InputError) as refused:
        run(study)
    assert any(words in str(p) and p.line == line and p.hint for p in refused.value.problems), str(refused.value)


def test_the_connector_in_newtons_and_with_a_dashpot_of_its_own(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text(
        "title: t\nfirst: {mass: 1 kg, stiffness: 4 N/m}\nsecond: {mass: 2 kg, stiffness: 6 N/m}\n"
        "sweep:\n  - {connector.stiffness: [3 N/m, 1/2 k1]}\n"
    )
    pairs = [point.model for point in load_connector_study(study).points]
    assert [pair.stiffness for pair in pairs] == [3.0, 2.0]
    assert pairs[0].p == pytest.approx(np.sqrt(3.0 / 4.0))
    study.write_text("title: t\nconnector: {dashpot: 5 kN s/m}\nfirst: {damping: 1 %}\nsecond: {frequency_ratio: 2}\n")
    pair = load_connector_study(study).points[0].model
    assert (pair.dashpot, pair.zeta1, pair.zeta2) == (5000.0, 0.01, 0.05)
    study.write_text("title: t\nconnector: {damping_ratio: 0.1}\nsecond: {frequency_ratio: 2}\n")
    pair = load_connector_study(study).points[0].model
    assert pair.dashpot == pytest.approx(0.2 * np.sqrt(pair.stiffness * 100e3))


def test_an_older_file_is_named_as_such_and_a_cut_one_as_damaged(tmp_path):
    """Files of older versions said no version and had no checksums."""
    older, cut = tmp_path / "older.h5", tmp_path / "cut.h5"
    for path in (older, cut):
        run(FIG5, "-o", path, "--no-figures", "-q")
        with Sealed(path) as sealed:
            size = sealed.size
        os.truncate(path, size)
    with h5py.File(older, "r+") as file:
        del file.attrs["format_version"]
    with pytest.raises(InputError, match=r"older format version 2 .* no checksums") as refused:
        connector_claims(older)
    assert "pound connector STUDY" in refused.value.problems[0].hint
    with pytest.raises(InputError, match="is damaged: its checksums are missing"):
        connector_claims(cut)
    assert run(FIG5, "-o", older, "--no-figures").exit_code == 0
    assert connector_claims(older)

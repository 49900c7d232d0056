"""`pound sensitivity`: what it prints, its page, and a bad question."""

from __future__ import annotations

import math

from pounding_cli.store import open_results

STUDY = """\
title: Two small buildings
records: {use: [elcentro, taft], duration: 3 s}
buildings:
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, storeys: 1, period: 0.5 s}
group: [A, B]
cases: {near: {link: pounding, gap: 3 mm}}
analyses: [inelastic]
estimate: none
uncertain:
  motion: any
  impact.restitution: {uniform: {from: 0.4, to: 0.65}}
  buildings.B.period: {lognormal: {median: 0.5 s, spread: 0.1}}
sensitivity: {outputs: [largest mu in A, max_closing], samples: 8}
"""


def test_prints_indices_and_reports_them(pound, tmp_path):
    code, out, _ = pound("sensitivity", "two.yaml")
    assert code == 0
    table = open_results(tmp_path / "results" / "two-sensitivity.h5").table("sensitivity")
    row = table[(table["output"] == "largest mu in A") & (table["key"] == "motion")].iloc[0]
    assert f"{row['total']:.2f} ({row['total_low']:.2f} to {row['total_high']:.2f})" in out
    assert "max_closing [m]" in out
    low, error = row["at_low"], row["at_low_error"]
    decimals = 1 - math.floor(math.log10(error))
    assert f" {low:.{decimals}f} ± {error:.{decimals}f} " in out
    assert "95 % interval of 1000 bootstrap draws of the 40 samples" in out
    code, out, _ = pound("report", "results/two-sensitivity.h5", "-q")
    assert code == 0
    folder = tmp_path / "results" / "two-sensitivity"
    for figure in ("sensitivity.png", "sensitivity-samples.png"):
        assert (folder / figure).stat().st_size > 10_000
    assert "decided most by motion; with its interactions it explains" in (folder / "report.html").read_text(
        encoding="utf-8"
    )
    assert sorted(path.name for path in (folder / "tables").iterdir()) == [
        "records.csv", "sensitivity.csv", "sensitivity_outputs.csv", "sensitivity_samples.csv",
    ]  # fmt: skip
    assert "Saltelli" in pound("cite", "results/two-sensitivity.h5")[1]


def test_a_range_without_a_unit_is_refused_at_its_place(pound, tmp_path):
    (tmp_path / "two.yaml").write_text(STUDY.replace("median: 0.5 s", "median: 0.5"))
    code, _, err = pound("sensitivity", "two.yaml")
    assert code == 2
    assert "two.yaml:13:44: 'buildings.B.period': 0.5 has no unit" in err
    assert not (tmp_path / "results").exists()

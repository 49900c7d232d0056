"""`pound optimise`: what it prints, its page, and a bad question."""

from __future__ import annotations

from pounding_cli.store import open_results

STUDY = """\
title: Two small buildings
records: {use: [elcentro, taft], duration: 3 s}
buildings:
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, storeys: 1, period: 0.5 s}
group: [A, B]
cases:
  joined:
    gap: 3 cm
    link: [pounding, {link: connector, stiffness: 1/5 mean storey of A, damping_ratio: 0.1}]
analyses: [elastic]
optimise:
  least: largest V_ratio
  over:
    cases.joined.link.1.stiffness: {from: 0.01 x mean storey of A, to: 1 x mean storey of A, spacing: log}
    cases.joined.link.1.damping_ratio: {from: 0, to: 0.95}
    impact.restitution: {choice: [0.4, 0.65]}
  population: 8
  generations: 4
  slice_points: 5
  map_points: 5
"""


def test_prints_the_optimum_and_reports_it(pound, tmp_path):
    code, out, _ = pound("optimise", "two.yaml")
    assert code == 0
    table = open_results(tmp_path / "results" / "two-optimise.h5").table("optimise")
    row = table.iloc[0]
    assert f"Least of largest V_ratio: {row['optimum']:.5g} ± {row['error']:.1g}" in out
    assert 0 < row["error"] < 1e-5
    assert f"with the study as written: {row['as_written']:.5g}" not in out  # the file says no e
    assert f"{row['value']:.4g}" in out
    assert "cases.joined.link.1.stiffness [x mean storey of A]" in out
    assert "The search ended after 4 generations" in out
    assert f"{row['points']} points; scenes:" in out
    code, out, _ = pound("report", "results/two-optimise.h5", "-q")
    assert code == 0
    folder = tmp_path / "results" / "two-optimise"
    assert (folder / "optimise.png").stat().st_size > 10_000
    assert "Least of largest V_ratio" in (folder / "report.html").read_text(encoding="utf-8")
    assert sorted(path.name for path in (folder / "tables").iterdir()) == [
        "optimise.csv", "optimise_points.csv", "records.csv",
    ]  # fmt: skip
    assert "Storn" in pound("cite", "results/two-optimise.h5")[1]


def test_the_study_as_written_stands_beside(pound, tmp_path):
    text = STUDY.replace("analyses:", "impact: {restitution: 0.65}\nanalyses:")
    (tmp_path / "two.yaml").write_text(text)
    code, out, _ = pound("optimise", "two.yaml")
    assert code == 0
    row = open_results(tmp_path / "results" / "two-optimise.h5").table("optimise").iloc[0]
    assert row["as_written"] >= row["optimum"]
    assert f"with the study as written: {row['as_written']:.5g}" in out


def test_a_range_without_a_unit_is_refused_at_its_place(pound, tmp_path):
    choice = "impact.restitution: {choice: [0.4, 0.65]}"
    (tmp_path / "two.yaml").write_text(STUDY.replace(choice, "cases.joined.gap: {from: 1 cm, to: 3}"))
    code, _, err = pound("optimise", "two.yaml")
    assert code == 2
    assert "two.yaml:17:40: 'cases.joined.gap': 3 has no unit" in err
    assert not (tmp_path / "results").exists()

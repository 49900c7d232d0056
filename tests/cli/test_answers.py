"""`pound fragility` and `pound sensitivity`: what they print is in their tables, and their pages are written."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import pounding_cli
from pounding_cli.numbers import format_number
from pounding_cli.questions.optimise import search
from pounding_cli.questions.reports import build_report

STUDY = """\
title: Two small buildings
records: {use: [elcentro, taft, olympia, parkfield], duration: 3 s, scale: {pga: 0.1 g}}
buildings:
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, storeys: 1, period: 0.5 s}
group: [A, B]
cases: {near: {link: pounding, gap: 3 mm}}
analyses: [inelastic]
estimate: none
sweep: {records.scale.pga: {from: 0.05 g, to: 1 g, step: 0.05 g}}
fragility: {limits: [mu > 4, contact]}
"""

UNCERTAIN = """\
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


def test_fragility_curves(folder, pound):
    """The search finds the same first passing levels as the plain grid, and prints the medians of the table."""
    code, out, err = pound("fragility", "two.yaml")
    assert (code, "warning" in err) == (0, False)
    results = pounding_cli.open_results("results/two-fragility.h5")
    curves = results.table("fragility")
    fitted = curves[curves["median"].notna() & (curves["state"] == "with pounding")].iloc[0]
    assert f"{fitted['median'] / 9.80665:.3g} g" in " ".join(out.split())
    assert f"{fitted['median'] / 9.80665:.3g} (" not in out
    assert "No interval for fewer than 5 motions" in out
    assert "Intensity measure: peak ground acceleration." in out
    found = results.table("fragility_motions")
    grid = pounding_cli.run("two.yaml", "grid.h5", engine="serial").storey()
    key, checked = "records.scale.pga", 0
    for state, column in (("with pounding", "mu"), ("alone", "mu0")):
        peaks = grid.groupby(["building", "record", key], observed=True)[column].max()
        for row in found[(found["limit"] == "mu > 4") & (found["state"] == state)].to_dict("records"):
            of_motion = peaks.loc[row["building"], row["record"]]
            above = of_motion[of_motion > 4]
            assert row["passed"] == pytest.approx(above.index.min() if len(above) else np.inf)
            checked += 1
    assert checked == 16
    assert pound("report", "results/two-fragility.h5", "-q", "--format", "png")[0] == 0
    written = Path("results/two-fragility")
    assert (written / "fragility-inelastic.png").stat().st_size > 10_000
    assert f"{fitted['median'] / 9.80665:.3g}" in (written / "report.html").read_text(encoding="utf-8")
    assert "Baker" in pound("cite", "results/two-fragility.h5")[1]


def test_motions_of_the_page_are_those_of_the_study(folder, pound):
    """Fails if they are those of some intensity that the search solved, as the lowest."""
    rows = {}
    for name, values in (("on", "[0.05 g, 0.1 g, 1 g]"), ("off", "[0.05 g, 0.2 g, 1 g]")):
        text = STUDY.replace("{from: 0.05 g, to: 1 g, step: 0.05 g}", values).replace("mu > 4", "mu > 400")
        (folder / "two.yaml").write_text(text)
        assert pound("fragility", "two.yaml", "-o", f"{name}.h5")[0] == 0
        pound("report", f"{name}.h5", "-q", "--no-figures", "-o", name)
        page = Path(name, "report.html").read_text(encoding="utf-8").replace("\u00a0", " ")
        assert "The motions are varied: records.scale.pga from 0.05 g to 1 g." in page
        table = page[page.index("Ground motions as used at records.scale.pga = 0.1 g") :]
        rows[name] = [
            re.findall("<td[^>]*>([^<]*)", row)[:5] for row in table[: table.index("</table>")].split("</tr>")
        ]
    assert [row[3] for row in rows["on"] if row] == ["0.1000"] * 4  # peak [g]
    assert rows["on"] == rows["off"]


def test_a_ratio_of_one_is_no_difference(folder, pound):
    """Fails if floors that never meet are said to differ by chance."""
    (folder / "two.yaml").write_text(STUDY.replace("gap: 3 mm", "gap: 5 m").replace("[mu > 4, contact]", "[mu > 4]"))
    out = " ".join(pound("fragility", "two.yaml", "-o", "r.h5")[1].split())
    assert "A, ductility above 4: no overlap of intensities at which motions hold and at which they pass" in out
    assert "(median capacity 0.100 to 0.200 g), alone and with pounding." in out
    assert "B, ductility above 4: pounding makes no difference in three digits (median capacity 0.209 g)." in out
    assert "not significant" not in out
    assert "times as strong" not in out


def test_sensitivity_indices(folder, pound):
    Path("uncertain.yaml").write_text(UNCERTAIN)
    code, out, _ = pound("sensitivity", "uncertain.yaml")
    assert code == 0
    table = pounding_cli.open_results("results/uncertain-sensitivity.h5").table("sensitivity")
    for row in table[table["output"] == "largest mu in A"].to_dict("records"):
        ends = [row[name] if abs(row[name]) >= 0.0005 else 0.0 for name in ("total", "total_low", "total_high")]
        total, low, high = (format_number(end, 3) for end in ends)
        assert f"{total} ({low} to {high})" in out
    assert pound("report", "results/uncertain-sensitivity.h5", "-q", "--format", "png")[0] == 0
    written = Path("results/uncertain-sensitivity")
    assert (written / "sensitivity.png").stat().st_size > 10_000
    assert {path.name for path in (written / "tables").iterdir()} >= {"sensitivity.csv", "sensitivity_samples.csv"}
    assert "Saltelli" in pound("cite", "results/uncertain-sensitivity.h5")[1]


def test_an_index_of_rounding_is_zero(folder, pound, monkeypatch):
    """Fails if what differs by rounding is shown as 3.00×10⁻¹⁷ (−1.00×10⁻¹⁶ to 2.00×10⁻¹⁶)."""
    Path("uncertain.yaml").write_text(UNCERTAIN)
    pound("sensitivity", "uncertain.yaml", "-q")
    results = pounding_cli.open_results("results/uncertain-sensitivity.h5")
    answer = results.answer
    kept = answer("sensitivity")
    kept.frame.loc[kept.frame["key"] == "impact.restitution", ["first", "first_low", "first_high"]] = (
        3e-17,
        -1e-16,
        2e-16,
    )
    monkeypatch.setattr(results, "answer", lambda name: kept if name == "sensitivity" else answer(name))
    table = build_report(results).answer.tables[0]
    cells = {row[0]: dict(zip(table.heads(), row, strict=True)) for row in table.cells()}
    assert cells["impact.restitution"]["first order"] == "0 (0 to 0)"


def test_probabilities_of_statements(folder, pound):
    """Those of a statement are counted over the independent samples, with the interval of Clopper and Pearson."""
    asked = "outputs: [largest mu in A], probabilities: [largest mu in A > 1, impacts > 0]"
    Path("likely.yaml").write_text(UNCERTAIN.replace("outputs: [largest mu in A, max_closing]", asked))
    code, out, _ = pound("sensitivity", "likely.yaml")
    results = pounding_cli.open_results("results/likely-sensitivity.h5")
    samples = results.table("sensitivity_samples")
    samples = samples[samples["independent"] == 1]
    first, second = results.table("sensitivity_probabilities").to_dict("records")
    passed = int((samples["output largest mu in A"] > 1).sum())
    assert (code, len(samples), first["statement"]) == (0, 16, "largest mu in A > 1")
    assert 0 < passed < 16
    assert first["probability"] == passed / 16
    low, high = stats.beta.ppf(0.025, passed, 17 - passed), stats.beta.ppf(0.975, passed + 1, 16 - passed)
    assert (first["probability_low"], first["probability_high"]) == pytest.approx((low, high), rel=1e-9)
    assert f"{first['probability']:.3g}" in out
    assert second["probability"] == samples["output impacts > 0"].mean()


def test_a_point_that_is_refused_ends_a_search():
    def refuses(points, rough):
        raise pounding_cli.InputError("this point is not sound")

    with pytest.raises(pounding_cli.InputError, match="not sound"):
        search.Search(refuses, [0, 0]).run()


def test_bad_questions_are_refused_and_write_nothing(folder, pound):
    Path("two.yaml").write_text(STUDY.replace("contact]", "acceleration > 1]"))
    Path("uncertain.yaml").write_text(UNCERTAIN.replace("0.5 s, spread", "0.5, spread"))
    for command, study, place in (("fragility", "two", "11:30"), ("sensitivity", "uncertain", "13:44")):
        code, out, err = pound(command, f"{study}.yaml")
        assert (code, out) == (2, "")
        assert re.search(rf"{study}\.yaml:{place}: ", err)
    assert not Path("results").exists()

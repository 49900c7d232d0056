"""The first table of `pound run`: largest demand, ratio, drift and struck columns, each with its place."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pounding_cli import open_results
from tests.adapter import Scope, parse_limit, response, sketch

STUDY = """\
title: Slabs against columns
records: {use: [{file: weak.txt}, {file: strong.txt}], duration: whole, scale: 1.0}
buildings:
  low: {storeys: 2, period: 0.3 s, height: 3 m}
  high: {storeys: 2, period: 0.5 s, height: [3 m, 4 m], columns: 20 %}
group: [low, high]
cases: {touching: {link: pounding, gap: 1 cm}, wide: {link: pounding, gap: 9 cm}}
"""
PLAIN = """\
title: No heights
records: {use: [{file: strong.txt}], duration: whole, scale: 1.0}
buildings:
  low: {storeys: 2, period: 0.3 s}
  high: {like: low, period: 0.5 s}
group: [low, high]
cases: {touching: {link: pounding, gap: 1 cm}}
"""


def solve(scene, accuracy=1e-6, method="taylor", **_):
    """Linked, `low` has the largest ratio (storey 2, 3 times mu0 = 1) and `high` the largest ductility (storey 1, 8);
    drifts of `high` are 4 cm in both storeys, and its columns carry 34 times their share where the slab strikes."""
    strong, count = scene.motion.pga > 2, len(scene.links)
    storeys = tuple(building.storeys for building in scene.buildings)
    peaks = response.no_peaks(storeys, count)
    for name in (*response.STOREYS, *response.LINKS):
        peaks[name] = 1.0
    peaks["shear"], peaks["displacement_min"], peaks["residual_drift"] = 1e6, -1.0, 0.0
    for place, building in enumerate(scene.buildings):
        is_high = building.name.startswith("high")
        mu = np.array([6.0, 4.0] if is_high else [0.5, 1.0]) * (1.0 if strong else 0.5)
        if count:
            mu = mu + (np.array([2.0, 0.0]) if is_high else np.array([0.0, 2.0]))
        peaks["ductility"][place], peaks["drift"][place] = mu, 0.04 if is_high else 0.01
    peaks["impacts"] = 0.0 if count and scene.links[0].gap > 0.05 else 3.0
    peaks["contact_time"] = 0.01 * peaks["impacts"]
    for at, link in enumerate(scene.links):
        if link.columns:
            shears = 1e5 + at, 2e5 + at, 34.0 if strong else 1.2
            peaks["shear_below"][at], peaks["shear_above"][at], peaks["demand"][at] = shears
    closings = peaks["max_closing"]
    return response.Response(peaks, storeys, "done", "", "taylor", accuracy, 1, 1, 1e-4, closing_to_rest=closings)


SOLVE = solve


def first_table(out: str) -> str:
    """What `pound run` prints before the means."""
    return out[out.index("Peak responses") : out.index("Ratios to the same")]


def cells_of(table: str, case: str, analysis: str, count: int = 2) -> list[list[str]]:
    """The lines of a row, `count` in all, each parted at wide spaces."""
    lines = table.splitlines()
    begin = next(at for at, line in enumerate(lines) if line.split()[:1] == [case])
    row = next(at for at in range(begin, len(lines)) if analysis in lines[at].split())
    return [[cell for cell in line.split("  ") if cell.strip()] for line in lines[row : row + count]]


def test_the_largest_demand_stands_beside_the_largest_ratio_each_with_its_place(pound):
    table = first_table(pound("run", "two.yaml")[1])
    numbers, places = cells_of(table, "touching", "inelastic")
    assert [cell.strip() for cell in numbers[2:7] if "*" not in cell] == [
        "8.00 (alone 6.00)", "5.00", "1.33 (alone 1.33)", "34.0",
    ]  # fmt: skip
    assert [cell.strip() for cell in places if "floor" not in cell][:4] == [
        "high, storey 1, strong", "low, storey 2, weak", "high, storey 1, weak", "high, storey 2, strong",
    ]  # fmt: skip


def test_beyond_the_gap_floors_are_in_contact_and_below_it_they_approach(pound):
    """The largest closing is 1 m in both cases (see `solve`), here of gaps of 1 cm and 1.2 m. Fails if a penetration
    stands where an approach does, or the reverse."""
    Path("two.yaml").write_text(STUDY.replace("9 cm", "1.2 m"))
    table = first_table(pound("run", "two.yaml")[1])
    touching, wide = ([" ".join(line) for line in cells_of(table, case, "inelastic")] for case in ("touching", "wide"))
    assert "penetration 99.0 cm" in touching[0]
    assert "contact in 2 of 2 motions, gap 1 cm" in touching[1]
    assert "closes 100 of 120 cm" in wide[0]
    assert "no contact" in wide[1]


def test_a_joint_beside_a_contact_hides_no_contact(pound):
    """They close alike (see `solve`): both are told, whichever stands first, but not a joint within the gap. Fails if
    the cell names the connector alone."""
    both = "{link: pounding}", "{link: connector, stiffness: 1 kN/mm}"
    cases = ", ".join(
        f"{case}: {{gap: {gap}, links: [{', '.join(links)}]}}"
        for case, gap, links in (("first", "1 cm", both), ("last", "1 cm", both[::-1]), ("wide", "1.2 m", both))
    )
    Path("two.yaml").write_text(f"{STUDY.partition('cases:')[0]}cases: {{{cases}}}\n")
    table = first_table(pound("run", "two.yaml")[1])
    for case in ("first", "last"):
        lines = [" ".join(line) for line in cells_of(table, case, "inelastic", 3)]
        assert "penetration 99.0 cm" in lines[0]
        assert "contact in 2 of 2 motions, gap 1 cm" in lines[1]
        assert "connector, 99.0 cm beyond the gap" in lines[2]
    assert "connector" not in str(cells_of(table, "wide", "inelastic"))


def test_columns_that_no_slab_struck_are_neither_shown_nor_flagged(pound):
    out = pound("run", "two.yaml", "-o", "r.h5")[1]
    assert cells_of(first_table(out), "wide", "inelastic")[0][6].strip() == "–"
    said = "columns overloaded; the worst, strong: high storey 2, 34 times their share of the yield shear"
    assert said in " ".join(out.split())  # not the first scene, weak: 1.2 times
    flagged = open_results("r.h5").flagged()
    assert flagged.groupby("record")["severity"].first().to_dict() == {"strong": 34.0, "weak": 1.2}
    assert set(flagged["case"]) == {"touching"}
    assert set(flagged["code"]) == {"columns"}
    assert flagged["detail"].str.endswith(", by a blow").all()
    assert not flagged["meaningless"].any()


def test_struck_columns_have_a_table_with_building_and_storey(pound):
    pound("run", "two.yaml", "-o", "r.h5")
    struck = open_results("r.h5").struck()
    here = struck[(struck["case"] == "touching") & (struck["record"] == "strong") & (struck["analysis"] == "elastic")]
    (row,) = here.to_dict("records")
    assert (row["building"], row["storey"], row["by"], row["by_floor"]) == ("high", 2, "low", 2)
    assert (row["at"], row["shear_demand"], row["impacts"]) == (0.75, 34.0, 3)
    code, out, _ = pound("show", "r.h5", "struck", "--building", "high", "--where", "storey=2", "--format", "csv")
    assert code == 0
    assert out.splitlines()[0].startswith("case,analysis,record,building,storey,at,by,by_floor,gap,")


def test_a_study_without_struck_columns_has_no_such_column(pound, folder):
    (folder / "two.yaml").write_text(PLAIN)
    out = pound("run", "two.yaml", "-o", "r.h5")[1]
    assert "struck" not in out
    assert open_results("r.h5").struck().empty


def test_drift_ratio_is_a_column_that_follows_the_heights_of_a_sweep(pound, folder):
    (folder / "two.yaml").write_text(
        STUDY + "sweep: {buildings.low.height: [2.5 m, 5 m], cases.touching.gap: [1 cm, 2 cm]}\n"
    )
    pound("run", "two.yaml", "-o", "r.h5")
    storey = open_results("r.h5").storey()
    low = storey[storey["building"] == "low"]
    assert low["drift_ratio"].to_numpy() == pytest.approx(0.01 / low["buildings.low.height"].to_numpy())
    high = storey[storey["building"] == "high"]
    assert high.groupby("storey")["drift_ratio"].unique().map(list).to_dict() == {1: [0.04 / 3], 2: [0.01]}


def test_heights_that_the_study_leaves_to_their_default_are_said(pound, folder):
    said = "low, high: 3 m, as the study writes no height"
    assert said not in pound("run", "two.yaml", "-o", "r.h5")[1]
    (folder / "two.yaml").write_text(PLAIN)
    assert said in pound("run", "two.yaml", "-o", "r2.h5")[1]


def test_a_number_without_meaning_is_marked_where_it_is_the_largest(pound):
    def void(scene, **more):
        flags = (response.Flag("struck", "connector of low | high, floor 1, by 3 mm"),) if scene.links else ()
        return replace(solve(scene, **more), flags=flags)

    table = first_table(pound("run", "two.yaml", solve=void)[1])
    assert "8.00 † (alone 6.00)" in table
    assert "5.00 †" in table


@pytest.mark.parametrize("limit", ["drift_ratio > 2 %", "drift_ratio > 0.02"])
def test_a_limit_of_the_drift_ratio_is_one_of_the_drift_in_parts_of_the_height(limit):
    scope = Scope(("stiff", "soft"))
    assert replace(parse_limit(limit, scope), text="") == replace(parse_limit("drift > 2 %", scope), text="")


def test_the_first_table_of_the_page_says_where_the_largest_values_stand(pound, folder):
    pound("run", "two.yaml", "-o", "r.h5")
    pound("report", "r.h5", "-o", "page", "--no-figures")
    page = (folder / "page" / "report.html").read_text()
    row = next(each for each in page.split("</tr>") if ">touching<" in each and "<td>inelastic" in each)
    cells = re.findall(r'<td>([^<]*)<span class="where">([^<]*)</span>', row)
    assert ("8.00 (alone 6.00)", "high, storey 1, strong") in cells  # ductility, though the largest ratio is elsewhere
    assert ("5.00", "low, storey 2, weak") in cells
    assert ("1.33 (alone 1.33)", "high, storey 1, weak") in cells
    assert ("34.0", "high, storey 2, strong") in cells
    assert (folder / "page" / "tables" / "struck.csv").is_file()


def test_the_sketch_is_to_scale_and_says_which_heights_are_assumed(pound, folder):
    pound("run", "two.yaml", "-o", "r.h5")
    pound("report", "r.h5", "-o", "page", "--no-figures")
    storeys = [patch.get_height() for patch in sketch(open_results("r.h5")).axes[0].patches[:4]]
    assert np.array(storeys) / storeys[0] == pytest.approx([1, 1, 1, 4 / 3], rel=1e-2)
    assert "writes no height" not in (folder / "page/report.html").read_text()
    (folder / "two.yaml").write_text(PLAIN)
    pound("run", "two.yaml", "-o", "r2.h5")
    pound("report", "r2.h5", "-o", "page2", "--no-figures")
    page = (folder / "page2/report.html").read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    assert "Heights of low, high: 3 m, as the study writes no height." in page


def test_sensitivity_says_the_case_in_every_line_though_there_is_one(pound, folder):
    (folder / "two.yaml").write_text(
        PLAIN + "uncertain:\n  cases.touching.gap: {uniform: {from: 1 cm, to: 5 cm}}\n"
        "  impact.restitution: {uniform: {from: 0.4, to: 0.6}}\nanalyses: [inelastic]\n"
        "sensitivity: {outputs: [mu in low, drift_ratio in high], samples: 8}\n"
    )
    code, out, _ = pound("sensitivity", "two.yaml", "-o", "r.h5")
    assert code == 0
    for output in ("μ in low", "drift ratio in high"):
        lines = [line for line in out.splitlines() if output in line]
        assert len(lines) == 1
        assert all(f"{output} (case touching, inelastic" in line for line in lines)

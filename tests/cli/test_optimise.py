"""`pound optimise`: what it prints, its page, the study that it writes, and a bad question."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import yaml

import pounding_cli
from pounding_cli import open_results
from pounding_cli.numbers import format_number
from pounding_cli.questions.optimise.words import list_notes
from pounding_cli.questions.reports import build_report
from pounding_cli.results.results import ResultTables
from pounding_cli.study import load_study_file
from pounding_cli.study.text.file import parse
from pounding_cli.tables import Table
from tests.night import NIGHTLY

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
    links: [pounding, {link: connector, stiffness: 1/5 mean storey of A, damping_ratio: 0.1}]
analyses: [elastic]
optimise:
  least: largest V_ratio
  over:
    cases.joined.links.1.stiffness: {from: 0.01 x mean storey of A, to: 1 x mean storey of A, spacing: log}
    cases.joined.links.1.damping_ratio: {from: 0, to: 0.95}
    impact.restitution: {choice: [0.4, 0.65]}
  population: 8
  generations: 4
  slice_points: 5
"""


def test_prints_the_optimum_and_reports_it(pound, tmp_path):
    code, out, _ = pound("optimise", "two.yaml")
    assert code == 0
    table = open_results(tmp_path / "results" / "two-optimise.h5").table("optimise")
    row = table.iloc[0]
    text = " ".join(out.split())
    assert text.startswith("Two small buildings The best values are stiffness of joined ")
    assert f": largest V/V₀ {format_number(row['optimum'], 5)} ± {format_number(row['error'], 1)} in place of " in text
    assert "% lower (mean of 2 motions)." in text
    assert 0 < row["error"] < 1e-5
    assert f" in place of {format_number(row['as_written'], 5)} as written" in text  # though the file says no e
    assert f"{row['value']:.4g}" in out
    assert "\n cases.joined.links.1.stiffness " in out
    assert "\n [x mean storey of A]" in out
    assert "The search ended before the points of a generation were nearly as good" in out
    assert re.search(r"Time histories: \d+ solved, 0 reused, 0 failed", out)
    code, out, _ = pound("report", "results/two-optimise.h5", "-q", "--format", "png")
    assert code == 0
    folder = tmp_path / "results" / "two-optimise"
    assert (folder / "optimise.png").stat().st_size > 10_000
    assert "The best values are stiffness of joined" in (folder / "report.html").read_text(encoding="utf-8")
    assert sorted(path.name for path in (folder / "tables").iterdir()) == [
        "optimise.csv", "optimise_design.csv", "optimise_points.csv", "records.csv",
    ]  # fmt: skip
    assert "Storn" in pound("cite", "results/two-optimise.h5")[1]


@NIGHTLY
def test_the_study_as_written_stands_beside(pound, tmp_path):
    text = STUDY.replace("analyses:", "impact: {restitution: 0.65}\nanalyses:")
    (tmp_path / "two.yaml").write_text(text)
    code, out, _ = pound("optimise", "two.yaml")
    assert code == 0
    row = open_results(tmp_path / "results" / "two-optimise.h5").table("optimise").iloc[0]
    assert row["as_written"] >= row["optimum"]
    assert f" in place of {format_number(row['as_written'], 5)} as written" in " ".join(out.split())


def test_a_range_without_a_unit_is_refused_at_its_place(pound, tmp_path):
    choice = "impact.restitution: {choice: [0.4, 0.65]}"
    (tmp_path / "two.yaml").write_text(STUDY.replace(choice, "cases.joined.gap: {from: 1 cm, to: 3}"))
    code, _, err = pound("optimise", "two.yaml")
    assert code == 2
    assert "two.yaml:17:40: " in err
    assert "3 has no unit" in err
    assert not (tmp_path / "results").exists()


# The best study

FEW = """\
# Two buildings.
title: Two small buildings   # its title
records: {use: [weak.txt, strong.txt], scale: 1}
buildings:
  # left to right
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, storeys: 1, period: 0.5 s}   # the soft one
group: [A, B]
# What stands between them.
cases:
  joined:
    gap: 3 mm   # narrow
    links:
      - pounding   # both
      - link: connector
        stiffness: 1/5 mean storey of A
        damping_ratio: 0.1
        floors:
          - 1   # the lower one
  other: {link: pounding, gap: 1 cm}
optimise:
  least: largest drift
  case: joined
  analysis: inelastic
  over:
    cases.joined.gap: {choice: [3 mm, 4.5 mm]}   # a comment
    cases.joined.links.1.stiffness: {choice: [1/5 mean storey of A, 1/50 mean storey of A]}
    KEY: {choice: [FIRST, SECOND]}
"""


def few(key: str, first: str, second: str) -> str:
    return FEW.replace("KEY", key).replace("FIRST", first).replace("SECOND", second)


def test_the_best_study_runs_to_the_numbers_that_were_told(pound):
    """Fails if a value is rounded on its way into the file, or if a number of another case, point or motion is told."""
    Path("two.yaml").write_text(
        STUDY.replace("  B: {like: A,", "  B: {like: A, # soft\n     ").replace("A]", "A]  # here")
    )
    text = Path("two.yaml").read_text()
    code, out, _ = pound("optimise", "two.yaml", "--write", "best.yaml")
    assert code == 0
    assert "Best study: best.yaml; simulate it with: pound run best.yaml" in out
    best = Path("best.yaml").read_text()
    assert best != text
    assert re.findall("#.*", best) == re.findall("#.*", text)
    code, out, err = pound("check", "best.yaml")
    assert (code, err) == (0, "")
    results = open_results("results/two-optimise.h5")
    optimum = results.table("optimise").iloc[0]
    design = results.table("optimise_design").set_index("quantity")
    assert design.loc["largest V_ratio", "optimum"] == optimum["optimum"]
    assert design.loc["largest V_ratio", "as_written"] == optimum["as_written"]
    for study, column in (("best", "optimum"), ("two", "as_written")):
        assert pound("run", f"{study}.yaml", "-q", "-o", f"{study}.h5")[0] == 0
        run = open_results(f"{study}.h5")
        storey, floor, link = run.storey(), run.floor(), run.link()
        shear = storey.groupby(["building", "storey"])["V_ratio"].mean()
        assert optimum[column] == shear.max()
        for name in "AB":
            here, moved = storey[storey["building"] == name], floor[floor["building"] == name]
            assert design.loc[f"largest V_ratio in {name}", column] == here["V_ratio"].max()
            assert design.loc[f"largest drift in {name}", column] == here["drift"].max()
            assert design.loc[f"largest acceleration in {name}", column] == moved["acceleration"].max()
        for name in ("peak_force", "max_closing"):
            assert design.loc[f"largest {name}", column] == link[name].max()
        assert design.loc["contacts, all motions", column] == link["impacts"].sum()
        contact = link.groupby("record")["impacts"].sum() > 0
        assert design.loc["time histories with contact", column] == contact.sum()
        assert design.loc["time histories with contact", "of"] == len(contact) == 2
        flagged = run.flagged()
        for flag, rows in flagged.groupby("flag"):
            assert design.loc[f"time histories flagged: {flag}", column] == len(rows)
        assert (design.loc[[name for name in design.index if "flagged" in name], column] > 0).sum() == flagged[
            "flag"
        ].nunique()


@pytest.mark.parametrize(
    ("sought", "unit"), [("largest drift in B", "mm"), ("1 / largest drift in B", ""), ("sqrt(largest drift in B)", "")]
)
def test_only_a_variable_itself_is_told_in_its_unit(pound, sought, unit):
    """Fails if 1 / drift is told in mm."""
    text = few("impact.restitution", "0.4", "0.65").replace("least: largest drift", f"least: {sought}")
    Path("few.yaml").write_text(text)
    out = pound("optimise", "few.yaml")[1]
    number = re.search(r": [^:]*?([\d.]+)(?: ± [-\d.e×⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?(?: (\w+))? in place of ", " ".join(out.split()))
    value = open_results("results/few-optimise.h5").table("optimise")["optimum"].iloc[0]
    assert (float(number[1]), number[2] or "") == (pytest.approx(1e3 * value if unit else value, rel=1e-4), unit)


STRUCK = """\
title: Slabs against columns
records: {use: [elcentro, taft, parkfield], duration: 6 s}
buildings:
  low: {storeys: 2, period: 0.3 s, height: 3 m}
  high: {storeys: 3, period: 0.6 s, height: 4 m, columns: 20 %}
  moat: {wall: fixed}
group: [low, high, moat]
cases: {joined: {gap: 4 cm, link: pounding}}
analyses: [elastic]
estimate: none
optimise:
  least: largest peak_force
  over: {cases.joined.gap: {from: 5 mm, to: 3 cm}}
  population: 5
  generations: 1
  slice_points: 5
"""


def in_words(name: str) -> str:
    """Return a quantity of the design as people read it."""
    words = {"V_ratio": "V/V₀", "mu": "μ", "peak_force": "peak force", "shear_demand": "column shear over strength"}
    return " ".join(words.get(word, word) for word in name.split(" "))


def test_the_largest_is_the_largest_and_what_is_worse_is_said(pound):
    """Fails if a mean over the motions stands under "largest", if struck columns are left out, if a wall has rows, or
    if a demand that the optimum raises is passed over."""
    Path("struck.yaml").write_text(STRUCK)
    code, out, _ = pound("optimise", "struck.yaml", "--write", "best.yaml")
    assert code == 0
    design = open_results("results/struck-optimise.h5").table("optimise_design").set_index("quantity")
    assert not [name for name in design.index if "moat" in name]
    assert design["over_motions"].tolist() == ["mean"] + [""] * (len(design) - 1)
    table = out[out.index("What the buildings do (largest of 3 motions, unless said otherwise)") :]
    assert re.search(
        r"\n largest peak force .*\n mean of 3 motions\n depends on the contact stiffness\n contacts, all motions ",
        table,
    )
    for study, column in (("best", "optimum"), ("struck", "as_written")):
        assert pound("run", f"{study}.yaml", "-q", "-o", f"{study}.h5")[0] == 0
        run = open_results(f"{study}.h5")
        link, struck = run.link(), run.struck()
        demand = struck.loc[struck["impacts"] > 0, "shear_demand"].max()
        assert design.loc["largest shear_demand in high", column] == demand > 1
        assert design.loc["largest max_closing", column] == link["max_closing"].max()
        assert design.loc["largest max_closing", column] > link["gap"].min()  # there are contacts
    sentence = re.search(r"The optimum makes worse: (.*?)\. The optimum ", " ".join(out.split()))[1]
    losses = {re.split(r",| \(", each)[0] for each in sentence.split("; ")}
    others = design.iloc[1:].drop(index=["contacts, all motions", "largest max_closing"])
    grown = others[others["optimum"] > 1.01 * others["as_written"]]
    assert losses == {in_words(name) for name in grown.index} != set()


def test_the_page_says_what_is_left(pound, tmp_path):
    Path("few.yaml").write_text(few("impact.restitution", "0.4", "0.65"))
    code, out, _ = pound("optimise", "few.yaml")
    assert code == 0
    design = open_results("results/few-optimise.h5").table("optimise_design").set_index("quantity")
    left = int(design.loc["time histories with contact", "optimum"])
    said = f"contact is left in {left} of 2 time histories" if left else "no contact is left"
    assert f"At the optimum {said}; nothing is flagged." in out
    assert re.search(r"^ time histories with contact +\d of 2 +\d of 2 *$", out, re.MULTILINE)
    assert re.search(r"^ cases\.joined\.gap +[\d.]+ mm +3 mm ", out, re.MULTILINE)  # as the study writes it
    pound("report", "results/few-optimise.h5", "-q", "--format", "png")
    page = Path("results/few-optimise/report.html").read_text(encoding="utf-8").replace("\u00a0", " ")
    assert f"At the optimum {said}" in page
    assert "largest acceleration in B" in page
    assert "quantity" in pound("show", "results/few-optimise.h5", "optimise_design")[1]


@pytest.mark.parametrize(
    ("key", "first", "second", "place"),
    [
        ("impact.restitution", "0.4", "0.4000001", r"^impact: {restitution: 0\.4(000001)?}$"),
        ("buildings.B.mass", "150 t", "151 t", r"{mass: 15[01] t, .*}   # the soft one$"),
        ("buildings.B.yield.code", "UBC-1988", "UBC-1994", r"{yield: {code: UBC-19(88|94)}, .*}   # the soft one$"),
        ("cases.joined.links.1.floors", "[1]", "[1, 2]", r"^        floors: \[1(, 2)?\]   # the lower one$"),
        ("cases.joined.restitution", "0.5", "0.7", r"^    restitution: 0\.[57]\n    gap: [34](\.5)? mm   # narrow$"),
    ],
)
def test_keys_that_the_file_lacks_are_added_where_they_belong(pound, key, first, second, place):
    """Values from left-out keys, too: what is written there now is the default."""
    text = few(key, first, second)
    if key == "cases.joined.links.1.floors":
        text = text.replace("storeys: 1", "storeys: 2")
    Path("few.yaml").write_text(text)
    code, _, err = pound("optimise", "few.yaml", "-q", "--write", "best.yml")
    assert (code, err) == (0, "")
    best = Path("best.yml").read_text()
    assert re.search(place, best, re.MULTILINE), best
    assert best.count("#") == text.count("#")
    assert pound("check", "best.yml")[0] == 0
    pound("run", "best.yml", "-q", "-o", "best.h5")
    pound("run", "few.yaml", "-q", "-o", "few.h5")
    told = open_results("results/few-optimise.h5").table("optimise").iloc[0]
    for file, column in (("best.h5", "optimum"), ("few.h5", "as_written")):
        rows = open_results(file).storey().query("case == 'joined' and analysis == 'inelastic'")
        assert rows.groupby(["building", "storey"])["drift"].mean().max() == told[column]
    assert told["optimum"] <= told["as_written"] or "restitution" in key or key.endswith("mass")


@NIGHTLY
def test_as_written_stands_outside_the_ranges(pound):
    """A key whose default is another key's value, and one outside its range. Fails if as written means nearest."""
    over = "cases.other.restitution: {from: 0.3, to: 0.4}\n    buildings.B.period: {from: 0.2 s, to: 0.3 s}"
    text = FEW[: FEW.index("    cases.joined.gap: {choice")] + f"    {over}\n  population: 5\n  generations: 1\n"
    Path("few.yaml").write_text(text.replace("case: joined", "case: other") + "  slice_points: 5\n")
    code, _out, _ = pound("optimise", "few.yaml")
    assert code == 0
    results = open_results("results/few-optimise.h5")
    keys = results.table("optimise").set_index("key")
    assert keys.loc["buildings.B.period", "written"] == 0.5
    pound("run", "few.yaml", "-q", "-o", "few.h5")
    rows = open_results("few.h5").storey().query("case == 'other' and analysis == 'inelastic'")
    assert keys["as_written"].iloc[0] == rows.groupby(["building", "storey"])["drift"].mean().max()
    assert pound("report", "results/few-optimise.h5", "-q", "--format", "png")[0] == 0


@pytest.mark.parametrize("over", ["worst", "mean"])
def test_over_a_sweep(pound, over):
    """Fails if what is told is of the first point of the sweep, or of the wrong point of the search."""
    text = few("impact.restitution", "0.4", "0.65").replace(
        "analysis: inelastic", f"analysis: inelastic\n  over_sweep: {over}"
    )
    sweep = "sweep: {buildings.B.period: [0.4 s, 0.5 s], records.scale: [1, 3]}\n"
    Path("few.yaml").write_text(
        text.replace("least: largest drift", "least: largest drift\n  over_motions: largest") + sweep
    )
    assert pound("optimise", "few.yaml", "-q", "--write", "best.yaml")[0] == 0
    design = open_results("results/few-optimise.h5").table("optimise_design").set_index("quantity")
    for study, column in (("best", "optimum"), ("few", "as_written")):
        pound("run", f"{study}.yaml", "-q", "-o", f"{study}.h5")
        run, keys = open_results(f"{study}.h5"), ["buildings.B.period", "records.scale"]
        rows = run.storey().query("case == 'joined' and analysis == 'inelastic'")
        found = rows.groupby(keys)["drift"].max()
        whole = found.mean() if over == "mean" else found.max()
        assert design.loc["largest drift", column] == pytest.approx(whole, rel=1e-14)
        largest = rows[rows["building"] == "B"]["drift"].max()  # over the sweep too, whatever is sought
        assert design.loc["largest drift in B", column] == largest
        link = run.link().query("case == 'joined' and analysis == 'inelastic'")
        contact = link.groupby([*keys, "record"])["impacts"].sum() > 0
        assert design.loc["time histories with contact", [column, "of"]].tolist() == [contact.sum(), 8]


def test_many_buildings_and_no_links(pound):
    text = few("impact.restitution", "0.4", "0.65").replace("group: [A, B]", "group: [A, B, A, B, A]")
    Path("few.yaml").write_text(
        re.sub(r"cases:\n.*?  other: .*?\n", "cases: {joined: {link: none}}\n", text, flags=re.DOTALL)
    )
    text = (
        Path("few.yaml")
        .read_text()
        .replace("cases.joined.gap: {choice: [3 mm, 4.5 mm]}", "buildings.B.mass: {choice: [1 t, 2 t]}")
    )
    Path("few.yaml").write_text(re.sub(r".*links\.1\.stiffness.*\n", "", text))
    code, out, _ = pound("optimise", "few.yaml")
    assert code == 0
    assert "no contact is left" in out
    assert re.search(r"^ largest drift in A-1 +[\d.]+ m", out, re.MULTILINE)


def test_flags_are_counted_on_both_sides(pound):
    """A connector that closes more than its gap as written, and less at the optimum."""
    links = FEW[FEW.index("    links:") : FEW.index("  other:")]
    text = (
        few("impact.restitution", "0.4", "0.65")
        .replace(links, "    link: connector\n")
        .replace("[3 mm, 4.5 mm]", "[3 mm, 9 m]")
    )
    text = re.sub(r".*links\.1\.stiffness.*\n", "", text)
    Path("few.yaml").write_text(text)
    code, out, _ = pound("optimise", "few.yaml", "--write", "best.yaml")
    assert code == 0
    design = open_results("results/few-optimise.h5").table("optimise_design").set_index("quantity")
    pound("run", "few.yaml", "-q", "-o", "few.h5")
    flagged = open_results("few.h5").flagged().query("case == 'joined' and analysis == 'inelastic'")
    assert len(flagged) >= 1
    for flag, rows in flagged.groupby("flag"):
        assert design.loc[f"time histories flagged: {flag}", ["optimum", "as_written"]].tolist() == [0, len(rows)]
        assert re.search(rf"time histories flagged +0 of 2 +{len(rows)} of 2\n {flag}\n", out)
    assert "nothing is flagged" in out
    assert "gap: 9 m   # narrow" in Path("best.yaml").read_text()


def test_a_study_that_is_there_is_not_replaced_unless_told(pound):
    Path("few.yaml").write_text(few("impact.restitution", "0.4", "0.65"))
    Path("best.yaml").write_text("mine")
    code, _, err = pound("optimise", "few.yaml", "-q", "--write", "best.yaml")
    assert code == 2
    assert "best.yaml: is there already" in err
    assert "--replace" in err
    assert Path("best.yaml").read_text() == "mine"
    assert not Path("results").exists()
    assert pound("optimise", "few.yaml", "-q", "--write", "best.yaml", "--replace")[0] == 0
    assert Path("best.yaml").read_text().startswith("# Two buildings.")
    before = Path("few.yaml").read_text()
    for name in ("few.yaml", "./few.yaml"):
        code, _, err = pound("optimise", "few.yaml", "-q", "--write", name, "--replace")
        assert code == 2
        assert "the output is the file that this command reads" in err
        assert "--write" in err
    assert Path("few.yaml").read_text() == before


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("best.h5", "a study file ends in .yaml"),
        ("best", "a study file ends in .yaml"),
        ("folder.yaml", "the output is a folder"),
        ("weak.txt/best.yaml", "write it beside the study: motions are sought there"),
        ("elsewhere/best.yaml", "write it beside the study: motions are sought there"),
        ("other/best.yaml", "write it beside the study: motions are sought there"),
        ("a" * 300 + ".yaml", "cannot be written"),
    ],
)
def test_places_that_cannot_take_the_best_study_are_refused_first(pound, name, words):
    Path("few.yaml").write_text(few("impact.restitution", "0.4", "0.65"))
    Path("folder.yaml").mkdir()
    Path("other").mkdir()
    for motion in ("weak.txt", "strong.txt"):
        Path("other", motion).write_text(Path("weak.txt").read_text())
    code, out, err = pound("optimise", "few.yaml", "--write", name)
    assert (code, out) == (2, "")
    assert words in err
    assert "error: a fault" not in err
    assert not Path("results").exists()
    assert not Path("elsewhere").exists()


def test_a_study_with_an_anchor_at_a_value_is_written_anew(pound):
    text = (
        few("impact.restitution", "0.4", "0.65")
        .replace("gap: 3 mm ", "gap: &g 3 mm ")
        .replace("gap: 1 cm}", "gap: *g}")
    )
    Path("few.yaml").write_text(text)
    assert pound("optimise", "few.yaml", "-q", "--write", "best.yaml")[0] == 0
    cases = yaml.safe_load(Path("best.yaml").read_text())["cases"]
    assert cases["other"]["gap"] == "3 mm"
    assert cases["joined"]["gap"] in ("3 mm", "4.5 mm")


def test_a_study_whose_best_is_written_is_read_once(pound, monkeypatch):
    """So that what is written is what was solved, whatever has become of the file meanwhile."""
    read = []
    monkeypatch.setattr(
        "pounding_cli.study.load_study_file", lambda path, *model: read.append(path) or load_study_file(path, *model)
    )
    Path("few.yaml").write_text(few("impact.restitution", "0.4", "0.65"))
    assert pound("optimise", "few.yaml", "-q", "--write", "best.yaml")[0] == 0
    assert read == [Path("few.yaml")]


def test_no_optimum_writes_no_study(pound):
    text = few("impact.restitution", "0.4", "0.65").replace("least: largest drift", "least: sqrt(-1 - largest drift)")
    Path("few.yaml").write_text(text)
    code, _out, err = pound("optimise", "few.yaml", "--write", "best.yaml")
    assert code == 1
    assert "best.yaml is not written: there is no optimum" in err
    assert not Path("best.yaml").exists()


PLACES = """\
title: Where a damper stands
records: {use: [taft], duration: 4 s, scale: {pga: 0.3 g}}
buildings:
  corner: {storeys: 1, period: 0.3 s, plan: {width: 20 m, depth: 12 m, eccentricity: 8 %, frequency_ratio: 1.2}}
  soft: {like: corner, period: 0.6 s, plan: {width: 16 m, shift: 3 m, eccentricity: 0 %}}
group: [corner, soft]
cases: {damped: {link: damper, gap: 20 cm, damping_coefficient: 1 MN s/m, places: 1 m}}
analyses: [elastic]
estimate: none
"""


def test_the_best_place_of_a_link_is_that_of_a_scan(pound):
    """Fails if the searched place is not that of the link, or is measured from elsewhere."""
    over = "over: {cases.damped.places: {from: -5 m, to: 10 m}}, generations: 5, population: 6, slice_points: 5"
    search = f"optimise: {{least: edge_drift, {over}}}"
    Path("search.yaml").write_text(f"{PLACES}{search}\n")
    code, out, _ = pound("optimise", "search.yaml", "--write", "best.yaml")
    assert code == 0
    optimum = open_results("results/search-optimise.h5").table("optimise").iloc[0]
    assert f"The best place of damped is {optimum['value']:.4g} m: edge drift " in out
    Path("scan.yaml").write_text(f"{PLACES}sweep: {{cases.damped.places: {{from: -5 m, to: 10 m, step: 1 m}}}}\n")
    assert pound("run", "scan.yaml", "-q")[0] == 0
    scan = open_results("results/scan.h5").storey("edge_drift").groupby("cases.damped.places")["edge_drift"].max()
    assert scan.min() * (1 - 1e-2) < optimum["optimum"] < scan.min() * (1 + 1e-4) < 0.9 * scan.max()
    assert abs(optimum["value"] - scan.idxmin()) <= 1.0
    written = parse(Path("best.yaml").read_text(), "best.yaml")["cases"]["damped"]["places"]
    assert float(written.removesuffix(" m")) == pytest.approx(optimum["value"], rel=1e-12)


# Sentences, figures and notes, from tables with chosen numbers


def build_study(**changes) -> dict:
    """Return a study; keys of `optimise` among the changes are added to its section."""
    section = {
        "least": "largest drift in B",
        "over": {
            "cases.near.gap": {"from": "1 mm", "to": "9 mm"},
            "impact.restitution": {"choice": [0.4, 0.65]},
        },
        "population": 5, "generations": 1, "slice_points": 5,
    }  # fmt: skip
    study = {
        "title": "Two small buildings",
        "records": {"use": ["elcentro", "taft"], "duration": "3 s"},
        "buildings": {"A": {"storeys": 2, "period": "0.3 s"}, "B": {"like": "A", "storeys": 1, "period": "0.5 s"}},
        "group": ["A", "B"],
        "cases": {"near": {"link": "pounding", "gap": "3 mm"}},
        "impact": {"restitution": 0.65},
        "analyses": ["inelastic"],
        "estimate": "none",
    }
    study |= {key: value for key, value in changes.items() if key in study or key == "sweep"}
    further = {key: value for key, value in changes.items() if key not in study}
    return study | {"optimise": section | further}


@pytest.fixture(scope="module")
def shared_folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("optimise")


def ask(folder: Path, **changes) -> ResultTables:
    """Return the results of a study; time histories of those before are reused."""
    return pounding_cli.run(build_study(**changes), folder / "r.h5", workflow="optimise", engine="serial")


@pytest.fixture(scope="module")
def results(shared_folder) -> ResultTables:
    return ask(shared_folder)


def change(results: ResultTables, **edits) -> ResultTables:
    """Return results with other tables: name -> edit(frame) -> frame."""
    tables = []
    for name in results.answers:
        table = results.answer(name)
        frame = edits[name](table.frame.copy()) if name in edits else table.frame
        tables.append(Table(name, frame, table.columns, table.caption))
    return ResultTables(results.path, results.arrays, tables)


def set_optimum(results: ResultTables, direction: str, optimum: float, written: float) -> ResultTables:
    numbers = {"sought": f"{direction} largest drift in B", "optimum": optimum, "as_written": written, "error": np.nan}
    changed = change(results, optimise=lambda frame: frame.assign(**numbers, value=[0.004, np.nan], option=["", "0.4"]))
    changed.study_data["optimise"] |= {"least": None, "most": None, direction: "largest drift in B"}
    return changed


def first_sentence(results: ResultTables) -> str:
    return build_report(results).answer.sentences[0]


BETTER = "the study as written, outside what was searched, is better"


@pytest.mark.parametrize(
    ("direction", "optimum", "written", "words"),
    [
        ("least", 0.01, 0.02, "10.000 mm in place of 20.000 mm as written, 50 % lower"),
        ("most", 0.02, 0.01, "20.000 mm in place of 10.000 mm as written, 100 % higher"),
        ("least", 0.02, 0.01, f"20.000 mm in place of 10.000 mm as written, 100 % higher: {BETTER}"),
        ("most", 0.01, 0.02, f"10.000 mm in place of 20.000 mm as written, 50 % lower: {BETTER}"),
        ("least", 0.01, 0.01, "10.000 mm, as good as the study as written"),
        ("least", 0.01, np.nan, "10.000 mm; the study as written has no value"),
    ],
)  # fmt: skip
def test_the_first_sentence_compares_the_optimum_with_the_study_as_written(results, direction, optimum, written, words):
    """Fails if lower is said for higher, if the two numbers are swapped, or if a better study as written is hidden."""
    said = first_sentence(set_optimum(results, direction, optimum, written))
    best = "The best values are gap of near 4 mm, restitution 0.4"
    assert said == f"{best}: largest drift in B {words} (mean of 2 motions)."


def test_the_best_value_of_one_key_is_told_by_its_name(shared_folder):
    single = ask(shared_folder, over={"cases.near.gap": {"from": "1 mm", "to": "9 mm"}})
    edit = {"value": 0.0042, "optimum": 0.0105, "as_written": 0.0138, "error": 2e-6}
    said = first_sentence(change(single, optimise=lambda frame: frame.assign(**edit)))
    assert said == (
        "The best gap of near is 4.2 mm: largest drift in B 10.500 ± 0.002 mm in place of 13.800 mm as written, "
        "24 % lower (mean of 2 motions)."
    )


def set_design(results: ResultTables, **rows: tuple[float, float]) -> ResultTables:
    """Return results in which quantities have these values at the optimum and as written, all others 1 and 1."""

    def edit(frame):
        frame[["optimum", "as_written"]] = 1.0
        for name, values in rows.items():
            frame.loc[frame["quantity"] == name.replace("__", " "), ["optimum", "as_written"]] = values
        return frame

    return change(results, optimise_design=edit)


def test_what_the_optimum_makes_worse_is_larger_than_as_written(results):
    """Fails if what falls is called worse, or if the numbers are swapped."""
    rows = {
        "largest__drift__in__A": (0.02, 0.01),
        "largest__mu__in__B": (2.0, 5.0),
        "largest__V_ratio__in__B": (2.0, 2.01),
    }
    said = build_report(set_design(results, **rows)).answer.sentences[-1]
    assert said == "The optimum makes worse: largest drift in A, 20 mm in place of 10 mm."
    mirrored = {name: values[::-1] for name, values in rows.items()}
    said = build_report(set_design(results, **mirrored)).answer.sentences[-1]
    assert said == "The optimum makes worse: largest μ in B, 5 in place of 2."
    said = build_report(set_design(results)).answer.sentences[-1]
    assert "makes worse" not in said


@pytest.mark.parametrize(
    ("optimum", "written", "words"),
    [
        (0.0, 2.0, "no contact is left"), (2.0, 0.0, "contact is left in 2 of 2 time histories"),
        (1.0, 2.0, "contact is left in 1 of 2 time histories"),
        (np.nan, 2.0, "contacts are not known, since a run failed"),
    ],
)  # fmt: skip
def test_contacts_left_are_those_of_the_optimum(results, optimum, written, words):
    said = build_report(set_design(results, time__histories__with__contact=(optimum, written))).answer.sentences[1]
    assert said == f"At the optimum {words}; nothing is flagged."


def test_flags_are_those_of_the_optimum(results):
    def edit(frame, values):
        row = frame.iloc[0].to_dict() | {"quantity": "time histories flagged: slipped", "of": 2}
        frame.loc[len(frame)] = row | dict(zip(("optimum", "as_written"), values, strict=True))
        return frame

    for values, words in (((1, 0), "flagged: slipped."), ((0, 1), "nothing is flagged.")):
        flagged = change(results, optimise_design=lambda frame, values=values: edit(frame, values))
        assert build_report(flagged).answer.sentences[1].endswith(f"; {words}")


def test_the_figure_shows_optimum_points_and_line_in_their_units(results):
    """Fails if optimum and study as written are swapped, or if numbers in m stand on an axis in mm."""

    def edit_keys(frame):
        return frame.assign(
            value=[0.004, np.nan], option=["", "0.4"], written=[0.003, np.nan], written_option=["", "0.65"],
            good_from=[0.0035, np.nan], good_to=[0.005, np.nan], optimum=0.01, as_written=0.02,
        )  # fmt: skip

    def edit_points(frame):
        frame = frame.head(4)
        keys = {"cases.near.gap": [0.003, 0.004, 0.002, 0.004], "impact.restitution": ["0.65", "0.4", "0.4", "0.65"]}
        return frame.assign(**keys, value=[0.02, 0.01, 0.015, 0.012])

    drawn = change(results, optimise=edit_keys, optimise_points=edit_points)
    gap, restitution = build_report(drawn).figures()[0].draw().axes
    assert gap.get_ylabel().replace("\n", " ") == "largest drift in B [mm]"
    assert gap.get_xlabel().startswith("gap of near [mm]")

    def line(ax, label):
        (one,) = [each for each in ax.lines if each.get_label() == label]
        return [pytest.approx(np.asarray(each, float)) for each in (one.get_xdata(), one.get_ydata())]

    assert line(gap, "optimum") == [[4], [10]]
    assert line(gap, "as written") == [[3], [20]]
    assert line(gap, "through the optimum") == [[2, 4], [15, 10]]
    assert line(gap, "point tried") == [[3, 4, 2, 4], [20, 10, 15, 12]]
    (span,) = [patch for patch in gap.patches if patch.get_label() == "as good"]
    assert [span.get_x(), span.get_x() + span.get_width()] == pytest.approx([3.5, 5])
    options = [label.get_text() for label in restitution.get_xticklabels()]
    assert options == ["0.65", "0.4"]
    assert line(restitution, "optimum") == [[1], [10]]
    assert line(restitution, "as written") == [[0], [20]]
    assert sorted(zip(*(each.expected for each in line(restitution, "through the optimum")), strict=True)) == [
        (0, pytest.approx(12)), (1, pytest.approx(10))
    ]  # fmt: skip


@pytest.mark.parametrize("width", [80, 120, 200])
def test_tables_and_sentences_fit_the_terminal(results, width):
    text = "\n".join(build_report(results).summary.iter_lines(width))
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    assert re.search(r"^ quantity +at the optimum +as written$", text, re.MULTILINE)
    assert re.search(r"^ key +best +as written", text, re.MULTILINE)


CONTACT = "depend on the contact stiffness, which is unknown"
FAR = {"near": {"link": "pounding", "gap": "5 m"}}
ONE = {"records": {"use": ["taft"], "duration": "3 s"}}
GAP = {"cases.near.gap": {"from": "1 mm", "to": "9 mm"}}
JOINED = {"near": {"link": "connector", "gap": "3 mm", "stiffness": "1/5 mean storey of A"}}

NOTES = [
    ("The number sought is the mean of 2 motions, storey by storey", {}, ONE),
    ("The number sought is the largest of 2 motions", {"over_motions": "largest"}, {}),
    ("The numerical error is not known: no run near the optimum was assessed", {}, {"estimate": "all"}),
    (CONTACT, {}, {"cases": FAR, "over": {"buildings.B.mass": {"choice": ["100 t", "101 t"]}}}),
    (CONTACT, {}, {"over": {"impact.stiffness": {"choice": ["10 x stiffest storey", "20 x stiffest storey"]}}}),
    ("cases.near.gap is best at the end of its range", {"over": GAP, "least": "impacts - 1000 * max_closing"},
     {"over": {"impact.restitution": {"choice": [0.4, 0.65]}}}),
    ("write more `generations:`", {"over": GAP}, {"over": {"impact.restitution": {"choice": [0.4, 0.65]}}}),
    ("2 of 2 points have no value: a run failed or the quantity is undefined",
     {"least": "sqrt(0 - mu)", "over": {"impact.restitution": {"choice": [0.4, 0.65]}}}, {}),
    ("1 of 2 points was excluded: a link left the range in which its law has a meaning",
     {"cases": JOINED, "over": {"cases.near.gap": {"choice": ["3 mm", "9 m"]}}},
     {"cases": JOINED, "over": {"cases.near.gap": {"choice": ["8 m", "9 m"]}}}),
]  # fmt: skip


@pytest.mark.parametrize(("words", "raising", "other"), NOTES, ids=[f"{number}" for number in range(len(NOTES))])
def test_notes_stand_where_they_belong(shared_folder, words, raising, other):
    notes = [build_report(ask(shared_folder, **each)).answer.notes for each in (raising, other)]
    assert [any(words in note for note in each) for each in notes] == [True, False]


@pytest.mark.parametrize(("value", "is_at_end"), [(0.001, True), (0.009, True), (0.0089, False), (0.005, False)])
def test_a_key_at_either_end_of_its_range_is_named(results, value, is_at_end):
    edit = {"value": [value, np.nan], "range_from": [0.001, np.nan], "range_to": [0.009, np.nan], "good_from": value}
    notes = build_report(change(results, optimise=lambda frame: frame.assign(**edit))).answer.notes
    assert any("cases.near.gap is best at the end of its range: a better value may lie" in note for note in notes) == (
        is_at_end
    )
    if is_at_end:
        of_place = edit | {"key": ["cases.near.places", "impact.restitution"]}
        beyond = (
            "cases.near.places is best at the end of its range: a better place may lie beyond, if both floors reach"
        )
        notes = list_notes(change(results, optimise=lambda frame: frame.assign(**of_place)))
        assert any(beyond in note for note in notes)


def test_more_keys_than_are_drawn_are_counted(results):
    import pandas as pd

    for count, is_said in ((8, False), (9, True)):
        many = change(
            results, optimise=lambda frame, count=count: pd.concat([frame.head(1)] * count, ignore_index=True)
        )
        assert any(f"Figures show 8 of {count} keys" in note for note in build_report(many).answer.notes) == is_said


def test_only_contacts_make_numbers_depend_on_the_contact_stiffness(shared_folder):
    """Fails if a building whose floors do not strike carries the words, or an acceleration beside a blow lacks them."""
    words = "depends on the contact stiffness"
    three = {"buildings": build_study()["buildings"] | {"C": {"like": "A"}}, "group": ["A", "B", "C"]}
    links = [{"link": "pounding", "pair": 1}, {"link": "pounding", "pair": 2, "gap": "5 m"}]
    report = build_report(ask(shared_folder, **three, cases={"near": {"gap": "3 mm", "links": links}}, over=GAP))
    cells = {row[0].split("\n")[0]: words in row[0] for row in report.answer.tables[1].cells()}
    marked = {name for name, is_marked in cells.items() if is_marked}
    assert marked == {"largest acceleration in A", "largest acceleration in B", "largest peak force"}
    assert "largest acceleration in C" in cells


def test_the_optimum_meets_what_is_required(pound):
    """Without the requirement the gap may be narrow; each point of the search is checked against its own run."""
    text = few("impact.restitution", "0.4", "0.65").replace("cases.joined.gap: {choice: [3 mm, 4.5 mm]}", "GAP")
    text = text.replace("GAP", "cases.joined.gap: {choice: [3 mm, 4.5 mm, 6 mm, 9 mm]}")
    Path("few.yaml").write_text(text)
    assert pound("optimise", "few.yaml")[0] == 0
    keys = ["cases.joined.gap", "cases.joined.links.1.stiffness", "impact.restitution"]

    def find_largest_forces() -> dict[tuple[str, ...], float]:
        """Return the largest force of every point over links and motions, by the values of its keys."""
        force = open_results("results/few-optimise.h5").link("peak_force")
        force = force.query("case == 'joined' and analysis == 'inelastic'")
        largest = force.groupby(keys)["peak_force"].max()
        return {(f"{1e3 * gap:g} mm", str(k), str(e)): value for (gap, k, e), value in largest.items()}

    bound = round(float(np.median([*find_largest_forces().values()])) + 1, 1)
    required = f"least: largest drift\n  require: [peak_force < {bound:.1f} N, smallest mu in A > 0]"
    Path("few.yaml").write_text(text.replace("least: largest drift", required))
    code, out, _ = pound("optimise", "few.yaml", "--replace", "--write", "best.yaml")
    assert code == 0
    results = open_results("results/few-optimise.h5")
    row = results.table("optimise").iloc[0]
    points = results.table("optimise_points")
    largest = find_largest_forces()
    unmet = [largest[tuple(map(str, place))] >= bound for place in points[keys].to_numpy()]
    assert points["unmet"].tolist() == unmet
    assert 0 < sum(unmet) < len(unmet)
    assert row["unmet"] == sum(unmet)
    assert row["optimum"] == points.loc[points["unmet"] == 0, "value"].min()
    met = f"as do {len(unmet) - sum(unmet)} of {len(unmet)} points in all; the study as written do"
    assert met in " ".join(out.split())
    Path("few.yaml").write_text(text.replace("least: largest drift", "least: largest drift\n  require: mu < 0.001"))
    code, out, _ = pound("optimise", "few.yaml", "--replace", "-o", "none.h5", "--write", "none.yaml")
    assert "no point meets what is required: mu < 0.001, under every motion." in " ".join(out.split())
    assert not Path("none.yaml").exists()
    Path("few.yaml").write_text(text.replace("least: largest drift", "least: largest drift\n  require: shear < 1"))
    code, _, err = pound("optimise", "few.yaml", "-o", "bad.h5")
    assert code == 2
    assert "few.yaml:23:12:" in err
    assert "no quantity 'shear' is known" in err

"""A street screened: rates against `pound gap` and brute force, what decides, resuming, refusals by row and column."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

import pounding_cli
from pounding_cli.api.running import run_study
from pounding_cli.batch.progress import Progress
from pounding_cli.questions.screen.decide import find_decision, find_variance_shares
from pounding_cli.questions.screen.designs import find_design
from pounding_cli.questions.screen.figures import draw_street
from pounding_cli.questions.screen.question import Screen
from pounding_cli.questions.screen.street import Settings
from pounding_cli.questions.screen.street_table import read_street

HEADINGS = (
    "name,left type,left design,left year,left storeys,right type,right design,right storeys,right period [s],"
    "gap [cm],pga [g]\n"
)
ROWS = """\
mill,W2,,1950,2,RM1L,low-code,3,,2.5,0.3
mews,W2,,1950,2,RM1L,low-code,3,,6,0.15
yard,RM1L,low-code,,3,W2,pre-code,2,0.35,1,0.3
"""
STREET = HEADINGS + ROWS
SETTINGS = Settings(("elcentro", "taft", "parkfield"), "3 s", ("0.15 g", "0.5 g"), 6, zone="2B")
SCENES_OF_A_PAIR = 2 * 6 * 3


def write_street(folder: Path, text: str = STREET) -> Path:
    path = folder / "street.csv"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def screened(tmp_path_factory):
    """The street, its results and how often a scene was solved."""
    folder = tmp_path_factory.mktemp("street")
    street = read_street(write_street(folder), SETTINGS)
    outcome = run_study(Screen(street), folder / "street-screen.h5", engine="serial")
    return street, pounding_cli.open_results(outcome.path), outcome


@pytest.fixture(scope="module")
def of_mill(screened):
    """What `pound gap` says of the first pair, whose gap is to be that for its rate of contact."""
    street, results, _ = screened
    rate = results.table("screen").set_index("pair").loc["mill", "rate"]
    folder = results.path.parent
    text = street.format_study(street.pairs[0])
    (folder / "mill.yaml").write_text(text.replace("gap:\n  hazard", f"gap:\n  rate: {float(rate)!r}\n  hazard"))
    return pounding_cli.run(folder / "mill.yaml", folder / "mill.h5", workflow="gap", engine="serial")


def test_order_of_levels_is_of_no_account(screened, tmp_path):
    """Fails where closings are taken to rise with the levels as they are written."""
    _, results, _ = screened
    street = read_street(write_street(tmp_path), replace(SETTINGS, levels=("0.5 g", "0.15 g")))
    turned = run_study(Screen(street), tmp_path / "turned.h5", engine="serial").results
    assert turned is not None
    expected = results.table("screen")
    assert turned.answer("screen").frame["rate"].to_numpy() == pytest.approx(expected["rate"].to_numpy(), rel=1e-9)


def test_pairs_are_ranked_by_their_rate(screened):
    _, results, _ = screened
    table = results.table("screen")
    assert list(table["rank"]) == [1, 2, 3]
    assert table["rate"].is_monotonic_decreasing
    assert table["pair"].iloc[0] == "yard"
    assert table.set_index("pair").loc["mill", "left_design"] == "low-code"


def test_rate_is_that_of_gap(screened, of_mill):
    """`pound gap` finds the gap for the rate that the screen gives the gap. Fails if the median building counts."""
    row = screened[1].table("screen").set_index("pair").loc["mill"]
    (of_gap,) = of_mill.table("gap_rate").to_dict("records")
    assert of_gap["gap"] == pytest.approx(row["gap"], rel=1e-6)


def test_probability_and_rate_by_brute_force(screened, of_mill):
    """From all closings: lognormal at each level, Phi linear between them, integrated over the hazard step by step."""
    row = screened[1].table("screen").set_index("pair").loc["mill"]
    link = of_mill.link()
    drawn = link[link["buildings.left.archetype.sample"] > 0]
    keys = ["records.scale.pga", "buildings.left.archetype.sample", "record"]
    logs = np.log(drawn.pivot_table("max_closing", keys[1:], keys[0], "max").to_numpy())
    levels = np.array(sorted(set(drawn["records.scale.pga"]))) / 9.80665
    scores = (logs.mean(axis=0) - np.log(row["gap"])) / logs.std(axis=0, ddof=1)
    slope = np.diff(scores)[0] / np.diff(np.log(levels))[0]

    def probability(pga):
        below = scores[0] + (np.log(pga) - np.log(levels[0])) / logs.std(axis=0, ddof=1)[0]
        between = scores[0] + slope * (np.log(pga) - np.log(levels[0]))
        return norm.cdf(np.where(pga < levels[0], below, between))

    assert 0.05 < row["enough"] < 0.95
    assert row["enough"] == pytest.approx(1 - probability(0.3), rel=1e-9)
    pga = np.geomspace(0.05, 100, 400_000)
    exceeded = (0.3 / pga) ** 3 / 475
    middle = probability(np.sqrt(pga[1:] * pga[:-1]))
    assert row["rate"] == pytest.approx(float((middle * -np.diff(exceeded)).sum()), rel=1e-5)
    assert row["probability"] == pytest.approx(1 - np.exp(-50 * row["rate"]), rel=1e-12)


def test_street_is_drawn_to_scale(screened):
    """Each pair has two buildings and a gap between them, as high as the lower one."""
    _, results, _ = screened
    figure = draw_street(results.answer("screen").frame, results.title)
    boxes = figure.axes[0].patches
    assert [round(box.get_height(), 2) for box in boxes[:3]] == [7.32, 7.32, 9.15]
    assert len(boxes) == 9
    assert [text.get_text() for text in figure.axes[0].texts] == ["2", "3", "1"]


def test_low_buildings_are_seen_beside_a_tower(screened):
    """A storey has one height in all lines; the tower makes its line taller. Fails where every line is as high."""
    frame = pd.concat([screened[1].answer("screen").frame] * 2, ignore_index=True)
    frame["row"] = range(len(frame))
    frame.loc[0, "right_height"] = 90.0
    figure = draw_street(frame, "street")
    figure.draw_without_rendering()
    boxes = [ax.patches[0] for ax in figure.axes[:2]]
    scales = [box.get_window_extent().height / box.get_height() / figure.dpi for box in boxes]
    assert scales[0] == pytest.approx(scales[1], rel=0.01)
    assert 7.32 * scales[0] > 0.15  # inches
    assert figure.axes[0].bbox.height > 1.5 * figure.axes[1].bbox.height


def test_alike_pairs_share_their_histories(screened):
    """`mews` has the buildings of `mill`; of the worst pair the median buildings and those alone come on top."""
    _, results, outcome = screened
    scenes = results.scene()
    of_worst = int(results.attrs["scenes"])
    assert len(scenes) == 2 * 7 * 3
    assert outcome.done == SCENES_OF_A_PAIR + of_worst


def test_screen_resumes_after_it_was_stopped(tmp_path):
    class Stopping(Progress):
        def count_solved(self, done: int, failed: int) -> None:
            super().count_solved(done, failed)
            if self.done_count > SCENES_OF_A_PAIR:
                raise KeyboardInterrupt

    street = read_street(write_street(tmp_path), replace(SETTINGS, neighbours=4))
    stopping = Stopping()
    path = tmp_path / "s.h5"
    with pytest.raises(KeyboardInterrupt):
        run_study(Screen(street), path, engine="serial", progress=stopping)
    assert not path.exists()
    outcome = run_study(Screen(street), path, engine="serial")
    assert outcome.reused >= stopping.done_count > SCENES_OF_A_PAIR
    assert run_study(Screen(street), path, engine="serial").done == 0


def test_command_prints_the_answer_in_80_columns(pound, monkeypatch):
    write_street(Path())
    arguments = ["--motions", "elcentro,taft", "--duration", "3 s", "--neighbours", "3", "--zone", "2B"]
    code, out, err = pound("screen", "street.csv", *arguments, "--levels", "0.2 g, 0.5 g", "--engine", "serial")
    assert code == 0, err
    assert "of 3 pairs will probably strike within 50 years; the worst is yard (RM1L 3 and W2 2 storeys" in out
    results = pounding_cli.open_results("results/street-screen.h5")
    from pounding_cli.questions.screen.words import list_tables

    (table,) = list_tables(results)
    assert max(map(len, table.to_text(80).splitlines())) <= 80
    assert "enough" in table.to_text(80)
    code, out, _ = pound("report", "results/street-screen.h5", "-o", "page", "--no-figures")
    assert code == 0
    page = Path("page/report.html").read_text()
    assert "The worst pair" in page
    assert len(pd.read_csv("page/tables/screen.csv")) == 3
    code, out, _ = pound("screen", "street.csv", "--pair", "yard", "--zone", "2B")
    assert code == 0
    assert "period: 0.35 s" in out
    code, _, err = pound("screen", "street.csv", "--pair", "yart", "--zone", "2B")
    assert code == 2
    assert "did you mean" in err


REFUSED = [
    ("mill,W2", "mill,W9", "street.csv:2:6: 'W9' is not a building type of HAZUS"),
    ("RM1L,low-code,3,,2.5", "RM1L,high,3,,2.5", "street.csv:2:22: 'high' is not a design level"),
    ("2.5,0.3", "wide,0.3", "street.csv:2:34: 'wide' is not a number with a unit"),
    ("2.5,0.3", "2.5,0.3,1", "street.csv:2:1: the row has 12 cells below 11 headings"),
    ("gap [cm]", "gab [cm]", "street.csv:1:106: 'gab [cm]' is not a heading"),
    ("mews", "mill", "street.csv:3:1: 'mill' is the name of the pair in row 2 too"),
    ("1950,2,RM1L,low-code,3,,6", ",2,RM1L,low-code,3,,6", "street.csv:3:1: 'left design' and 'left year' are empty"),
    ("1950,2,RM1L,low-code,3,,6", "1950,two,RM1L,low-code,3,,6", "street.csv:3:15: "),
    ("0.35,1,0.3", "0.35 kN,1,0.3", "street.csv:4:37: period: '0.35 kN' is no period"),
    ("0.35,1,0.3", "0.35,1,", "street.csv:4:1: there is no hazard"),
    ("RM1L,low-code,,3,W2", "URML,high-code,,3,W2", "street.csv:4:11: HAZUS has no high-code design of URML"),
    ("gap [cm]", "gap", "street.csv:2:34: 2.5 has no unit"),
    ("pga [g]", "pga", "street.csv:2:38: 0.3 has no unit"),
    ("2.5,0.3", "2.5,30", "street.csv:2:38: 30 g is no peak ground acceleration"),
    ("mill,W2", "mill,C1", "'C1' is not a building type of HAZUS\n    did you mean 'C1L', 'C1M' or 'C1H'?"),
    ("mill,W2", "mill,C1X", "'C1X' is not a building type of HAZUS\n    did you mean 'C1M'?"),
]


@pytest.mark.parametrize(("old", "new", "message"), REFUSED)
def test_faults_are_told_by_row_and_column(pound, old, new, message):
    assert STREET.count(old) == 1
    write_street(Path(), STREET.replace(old, new))
    code, _, err = pound("screen", "street.csv", "--zone", "2B")
    assert code == 2
    assert message in err
    assert "Traceback" not in err


NAMED = "left name,left type,left design,left storeys,right name,right type,right design,right storeys,gap [cm],"
ONE = "A,C1M,low-code,5,B,C1L,low-code,3"


@pytest.mark.parametrize(
    ("last", "rows", "options", "message"),
    [
        ("pga [g]", [f"{ONE},4,0.3", "B,C1L,pre-code,3,C,C1L,low-code,3,4,0.3"], [], "'B' is another building here"),
        ("pga [g]", ["A,C1M,low-code,5,A,C1M,low-code,5,4,0.3"], [], "street.csv:2:1: 'A' is the name of both"),
        ("pga [g]", [f"{ONE},4,0.3"], ["--zone", "7"], "--zone: '7' is not a zone"),
        (
            "hazard",
            [f"{ONE},4,", 'A,C1M,low-code,5,C,C1L,low-code,3,4,"{0.1 g: 0.01, 0.2 g: 0.02}"'],
            ["--hazard", "{0.1 g: 0.02, 0.4 g: 1/475}"],
            "street.csv:3:37: this is not a hazard curve",
        ),
    ],
)
def test_a_later_row_is_refused_before_anything_is_solved(pound, last, rows, options, message):
    write_street(Path(), "\n".join([NAMED + last, *rows]) + "\n")
    code, out, err = pound("screen", "street.csv", "--motions", "elcentro", "--duration", "3 s", *options)
    assert (code, out) == (2, "")
    assert message in err
    assert not Path("results").exists()


def test_what_is_doubtful_of_any_row_is_told(tmp_path):
    """And commas are decimal signs where that is declared; else a number with one is refused at its place."""
    rows = [f"{ONE},4,0.3", "B,C1L,low-code,3,C,W1,low-code,9,2.5,0.3", "C,W1,low-code,9,D,W1,low-code,1,300,0.3"]
    table = "\n".join([NAMED + "pga [g]", *rows]).replace(",", ";").replace(".", ",") + "\n"
    with pytest.raises(pounding_cli.InputError) as refused:
        read_street(write_street(tmp_path, table), SETTINGS)
    assert [problem.line for problem in refused.value.issues] == [2, 3, 3, 4]
    assert "street.csv:3:34: '2,5' is not a number\n    give `--decimal ','` if it is 2.5" in str(refused.value)
    settings = replace(SETTINGS, levels=("0.2 g", "0.3"), decimal=",")
    street = read_street(write_street(tmp_path, table), settings)
    assert street.pairs[1].gap == pytest.approx(0.025)
    warnings = [str(warning) for warning in street.find_warnings()]
    assert any("street.csv:3:" in each and "right has 9 storeys, but W1" in each for each in warnings)
    assert any("street.csv:4:" in each and "gap is 3 m" in each for each in warnings)
    assert any("--levels" in each and "has no unit" in each for each in warnings)


def test_what_is_known_of_a_building_in_one_row_alone_is_told(tmp_path):
    head = NAMED.replace("gap [cm],", "right period [s],gap [cm],") + "pga [g]"
    path = write_street(
        tmp_path, "\n".join([head, f"{ONE},0.4,4,0.3", "B,C1L,low-code,3,C,C1L,low-code,3,,4,0.3"]) + "\n"
    )
    (warning,) = map(str, read_street(path, SETTINGS).find_warnings())
    assert "street.csv:3:1: 'B' has its period in one of the rows 2 and 3 alone" in warning


def test_accelerations_of_two_return_periods_go_on_below(tmp_path):
    """Fails where only shaking beyond the return period of 475 years is counted."""
    rows = [f"{ONE},4,0.2,0.4", f"{ONE.replace('A,', 'C,')},4,0.2,0.22"]
    path = write_street(tmp_path, "\n".join([NAMED + "pga 475 [g],pga 2475 [g]", *rows]) + "\n")
    slope = np.log(2475 / 475) / np.log(2.0)
    below = [0.25**-slope / 475, 4.0**3 / 475]  # the second row is steeper than k = 3
    for pair, expected in zip(read_street(path, SETTINGS).pairs, below, strict=True):
        assert pair.hazard["0.05 g"] == pytest.approx(expected, rel=1e-5)
        assert pair.hazard["0.2 g"] == pytest.approx(1 / 475)
        assert len(pair.hazard) == 3
    path.write_text(f"{NAMED}pga [g]\n{ONE},4,\n")
    street = read_street(path, replace(SETTINGS, hazard="{0.2 g: 1/475, 0.4 g: 1/2475}"))
    (warning,) = map(str, street.find_warnings())
    assert warning.startswith("--hazard: the hazard curve begins at 0.2 g, exceeded 0.0021 times a year")
    street = read_street(path, replace(SETTINGS, hazard="{0.05 g: 0.02, 0.4 g: 1/2475}"))
    assert street.find_warnings() == []


def test_signs_of_the_cells_are_declared(tmp_path):
    """But for names."""
    row = ONE.replace("A,", "1'200 A,", 1)
    table = f"{NAMED}pga [g]\n{row},1'200.5 mm,0.3\n".replace(",", "\t").replace("\tB\t", "\t7,5\t")
    street = read_street(write_street(tmp_path, table), replace(SETTINGS, thousands="'"))
    assert street.pairs[0].gap == pytest.approx(1.2005)
    assert street.pairs[0].names == ("1'200 A", "7,5")
    with pytest.raises(pounding_cli.InputError, match="is not a heading"):
        read_street(write_street(tmp_path, table), replace(SETTINGS, thousands="'", separator=";"))


def test_hazard_curves_of_files(tmp_path):
    """Columns are declared in the cell, beside the table or by the option; what was taken of each file is said once."""
    (tmp_path / "h.csv").write_text("0.05 0.02\n0.4 0.002\n")
    (tmp_path / "sites").mkdir()
    declared = "{file: h.csv, intensity: 1, unit: g, rate: 2}"
    text = f'{NAMED}hazard\n{ONE},4,"{declared}"\n{ONE.replace("A,", "C,")},4,\n'
    path = write_street(tmp_path / "sites", text)
    (tmp_path / "sites" / "h.csv").write_text("0.05 0.01\n0.4 0.001\n")
    street = read_street(path, replace(SETTINGS, hazard=declared.replace("h.csv", str(tmp_path / "h.csv"))))
    assert [pair.hazard["file"] for pair in street.pairs] == ["h.csv", "../h.csv"]
    near, far = street.list_taken()
    assert "annual rates from 0.01 to 0.001" in near
    assert "annual rates from 0.02 to 0.002" in far
    street = read_street(path, replace(SETTINGS, hazard=str(tmp_path / "h.csv")))
    with pytest.raises(
        pounding_cli.InputError, match=r"write `hazard: \{file: h.csv, intensity: 1, unit: g, rate: 2\}`"
    ):
        street.find_warnings()


def test_a_workbook_is_refused_as_a_table(pound):
    Path("street.xlsx").write_bytes(b"PK\x03\x04" + bytes(100))
    code, _, err = pound("screen", "street.xlsx")
    assert code == 2
    assert "export it as text, in UTF-8; give a table of neighbours" in err


def test_years_need_a_zone(pound):
    write_street(Path())
    code, _, err = pound("screen", "street.csv")
    assert code == 2
    assert "street.csv:2:10: a year gives a design level only with the seismic zone" in err


@pytest.mark.parametrize(
    ("type", "year", "zone", "design"),
    [
        ("C1M", 1940, "4", "pre-code"),
        ("C1M", 1941, "4", "moderate-code"),
        ("C1M", 1976, "4", "high-code"),
        ("C1M", 1976, "2B", "moderate-code"),
        ("C1M", 1960, "1", "pre-code"),
        ("W1", 1930, "3", "moderate-code"),
        ("URML", 1990, "4", "low-code"),
    ],
)
def test_years_give_design_levels(type, year, zone, design):
    assert find_design(type, year, zone) == design


def test_what_decides_is_what_moves_the_closings():
    """Of closings that a period makes, and a little noise; fails if chance is not taken off."""
    generator = np.random.default_rng(1)
    period, strength = generator.normal(size=(2, 30))
    closings = 0.5 * period[:, None] + 0.05 * generator.normal(size=(30, 5))
    shares = find_variance_shares(closings[None], {"period of the left": period, "strength of the left": strength})
    assert find_decision(shares)[0] == "period of the left"
    assert shares["period of the left"] > 0.6
    assert shares["strength of the left"] < 0.1
    assert shares["motion"] == pytest.approx(0.05**2 / 0.25, abs=0.01)
    noise = {f"{number}": generator.normal(size=30) for number in range(100)}
    chance = find_variance_shares(generator.normal(size=(1, 30, 1)), noise)
    assert np.mean([share for name, share in chance.items() if name != "motion"]) < 0.06

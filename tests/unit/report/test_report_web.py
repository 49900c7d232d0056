"""What the page carries: numbers, texts, points and series, before any browser reads them."""

from __future__ import annotations

import base64
import json
import re

import numpy as np
import pandas as pd
import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.numbers import Unit
from pounding_cli.report.build import nominal, write_report
from pounding_cli.report.claim_tables import judge_points
from pounding_cli.report.columns import shown
from pounding_cli.report.evidence import points
from pounding_cli.report.web import data as packing
from pounding_cli.report.web import motion, story, sweep
from pounding_cli.report.web.beside import accuracy_beside
from pounding_cli.report.web.page import _keys_as_code, _unbroken, write_page
from pounding_cli.solve.histories import ENERGIES, History
from tests.helpers.report_tables import LEVEL, MOTIONS, PUSH, make


def page_of(results, folder, figures=None) -> str:
    evidences = points(results)
    path = write_page(results, folder, figures or {}, evidences, nominal(evidences), judge_points(evidences))
    return path.read_text(encoding="utf-8")


def carried(text: str) -> dict:
    """The data a page carries."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    return json.loads(found.group(1))


def column(table: dict, key: str) -> list:
    """The cells of one column, texts as such."""
    one = next(one for one in table["columns"] if one["key"] == key)
    return [one["names"][code] for code in one["codes"]] if "codes" in one else one["values"]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.72749, "1.727"), (0.99999, "1.000"), (12.3456, "12.35"), (58930.4, "58930"), (0.001234, "0.001234"),
        (0.0, "0"), (-7.6, "−7.600"), (3.1e-9, "3.100×10⁻⁹"), (1.5e7, "1.500×10⁷"), (np.nan, "–"), (np.inf, "–"),
    ],
)  # fmt: skip
def test_digits(value, text):
    assert story.digits(value) == text


def test_a_number_breaks_before_its_brackets_alone():
    assert _unbroken("0.139 (0.11 to 0.176)").split(" ") == ["0.139", "(0.11\u00a0to\u00a00.176)"]


def test_columns_are_read_in_the_units_of_engineers():
    assert (shown("V").unit, shown("V").factor) == ("kN", 1e-3)
    assert (shown("drift0").unit, shown("drift0").factor) == ("mm", 1e3)
    assert (shown("height").unit, shown("height").factor) == ("m", 1.0)
    assert (shown("stiffness").unit, shown("stiffness").factor) == ("MN/m", 1e-6)
    assert (shown("V_ratio_mean").label, shown("V_ratio_mean").unit) == ("V/V₀ mean", "–")
    assert shown("acceleration").unit == "m/s²"
    assert shown("contact_time").unit == "ms"
    assert shown("storey").unit == ""
    assert shown("cases.infill_1_10.gap").label == "cases.infill_1_10.gap"
    assert shown("something_new").label == "something new"


def test_tables_carry_every_row_with_six_digits(tmp_path):
    results = make()
    tables = carried(page_of(results, tmp_path))["tables"]
    frame = results.storey()
    assert tables["storey"]["rows"] == tables["storey"]["total"] == len(frame) == 400
    assert column(tables["storey"], "case") == frame["case"].tolist()
    assert column(tables["storey"], "V") == pytest.approx((frame["V"] / 1e3).tolist(), rel=1e-5)
    np.testing.assert_allclose(column(tables["storey"], "mu_ratio"), frame["mu_ratio"], rtol=1e-5)


def test_missing_numbers_are_null_and_text_cannot_end_the_script(tmp_path):
    results = make(flags="</script><script>alert(1)</script> & <b>bold</b>")
    results.title = "Gap < 5 cm & <i>more</i>"
    results.storey().loc[3, "V"] = np.nan
    results.storey().loc[4, "V"] = np.inf
    text = page_of(results, tmp_path)
    assert column(carried(text)["tables"]["storey"], "V")[3:5] == [None, None]
    assert "alert(1)</script>" not in text
    assert "<h1>Gap &lt; 5 cm &amp; &lt;i&gt;more&lt;/i&gt;</h1>" in text
    assert "&lt;b&gt;bold&lt;/b&gt;" in text
    assert set(column(carried(text)["tables"]["scene"], "flags")) == {
        "</script><script>alert(1)</script> & <b>bold</b>"
    }


def test_error_and_sensitivity_of_the_scene_stand_beside_its_numbers():
    results = make(records=("elcentro", "taft"))
    scene = results.scene()
    scene["error_estimate"] = np.arange(1.0, 1 + len(scene))
    merged = packing.with_trust(results.storey(), scene, [])
    assert list(merged.columns[:7]) == [
        "case", "analysis", "record", "building", "storey", "error_estimate", "sensitivity",
    ]  # fmt: skip
    for row in merged.iloc[::37].to_dict("records"):
        here = (
            (scene["case"] == row["case"]) & (scene["analysis"] == row["analysis"]) & (scene["record"] == row["record"])
        )
        assert row["error_estimate"] == scene.loc[here, "error_estimate"].item()
    means = packing.with_trust(results.summary(), scene, [])
    assert means.loc[0, "error_estimate"] == 2.0  # the larger of the two motions


def test_errors_of_a_quantity_stand_right_after_it():
    frame = pd.DataFrame({"case": ["a"], "V": [1.0], "V_ratio": [2.0], "mu": [3.0]})
    frame = frame.assign(V_ratio_error=0.1, mu_error=0.2, V_ratio_sensitivity=0.3)
    found = packing.with_trust(frame, make().scene(), [])
    assert list(found.columns) == ["case", "V", "V_ratio", "V_ratio_error", "V_ratio_sensitivity", "mu", "mu_error"]


def test_long_sweeps_are_cut_to_points_with_the_shown_one_and_the_page_says_so(tmp_path, monkeypatch):
    values = [0.3, 0.35, 0.4, 0.47, 0.5, 0.6, 0.65, 0.7]
    axis, nominally = ("impact.restitution", values), {"impact": {"restitution": 0.47}}
    results = make(cases=("touching", "gap"), records=("taft",), axis=axis, resolved=nominally)
    rows = 2 * 2 * 2 * 5
    monkeypatch.setattr(packing, "MOST_ROWS", 4 * rows)
    text = page_of(results, tmp_path)
    data = carried(text)
    labels = [point["label"] for point in data["points"]]
    assert labels == [f"impact.restitution = {value}" for value in (0.3, 0.47, 0.6, 0.7)]
    assert data["shown"] == "impact.restitution = 0.47"
    assert data["tables"]["storey"]["rows"] == 4 * rows
    assert data["tables"]["storey"]["total"] == 8 * rows
    assert "This page has 4 of the 8 points" in text
    # The chart of the sweep has them all.
    assert [axis["values"] for axis in data["sweep"]["axes"]] == [values]


def row_of(found: dict, quantity: str, *place) -> dict:
    """Numbers of one quantity over the points, by case, analysis, building or pair, and level."""
    one = next(one for one in found["quantities"] if one["key"] == quantity)
    known = [found["names"][name] for name in ("case", "analysis", one["where"])]
    codes = [*(names.index(value) for names, value in zip(known, place, strict=False)), place[3]]
    number, size = one["rows"].index(codes), len(one["mean"]) // len(one["rows"])
    return {name: one[name][number * size : (number + 1) * size] for name in ("mean", "low", "high")}


def test_a_sweep_carries_every_quantity_place_by_place_with_its_spread(monkeypatch):
    results = make(cases=("touching", "connected", "gap"), axis=("impact.restitution", [0.4, 0.5, 0.65]))
    scene = results.scene()
    here = (scene["case"] == "connected") & (scene["analysis"] == "elastic") & (scene["impact.restitution"] == 0.5)
    scene.loc[here & scene["record"].isin(["taft", "eureka"]), "flags"] = (
        f"{Connector.beyond_gap}: stiff | soft, floor 3"
    )
    found = sweep.sweep_data(results, ["connected", "touching"])
    assert [one["key"] for one in found["quantities"]][:2] == ["V_ratio", "mu_ratio"]
    ratios = row_of(found, "V_ratio", "connected", "elastic", "stiff", 4)
    for name, factor in (("mean", np.mean(MOTIONS)), ("low", min(MOTIONS)), ("high", max(MOTIONS))):
        # Level of the case, 2 % more at storey 4, 10 % more a value.
        assert ratios[name] == pytest.approx([LEVEL["connected"] * factor * 1.02 * g for g in (1, 1.1, 1.2)], rel=1e-5)
    force = row_of(found, "peak_force", "connected", "inelastic", "stiff | soft", 5)
    assert force["mean"] == pytest.approx([1e3 * PUSH["connected"] * 5 * 1.2] * 3)  # in kN
    assert found["names"]["case"] == ["connected", "touching"]
    assert found["void"] == [
        {"case": "connected", "analysis": "elastic", "count": [0, 2, 0], "why": Connector.beyond_gap}
    ]  # fmt: skip
    assert sweep.sweep_data(make(), ["touching"]) is None


def test_a_large_sweep_loses_its_heights_first_and_then_points(monkeypatch):
    results = make(cases=("touching",), axis=("impact.restitution", [0.1, 0.2, 0.3, 0.4, 0.5]))
    whole = sweep.sweep_data(results, ["touching"])
    carried = sum(len(one["mean"]) for one in whole["quantities"])
    assert (whole["heights"], whole["thinned"]) == (True, 1)
    monkeypatch.setattr(sweep, "MOST_VALUES", 3 * carried - 1)
    flat = sweep.sweep_data(results, ["touching"])
    assert (flat["heights"], flat["thinned"]) == (False, 1)
    top = row_of(whole, "V_ratio", "touching", "elastic", "stiff", 5)  # ratios grow with the height
    assert row_of(flat, "V_ratio", "touching", "elastic", "stiff", 0) == top
    monkeypatch.setattr(sweep, "MOST_VALUES", 3 * sum(len(one["mean"]) for one in flat["quantities"]) - 1)
    thin = sweep.sweep_data(results, ["touching"])
    assert (thin["heights"], thin["thinned"]) == (False, 2)
    assert thin["axes"][0]["values"] == [0.1, 0.3, 0.5]
    assert row_of(thin, "V_ratio", "touching", "elastic", "stiff", 0)["mean"] == top["mean"][::2]


def test_axes_of_a_sweep_keep_keys_that_move_together_and_the_unit_of_the_study():
    results = make(cases=("touching",), axis=("cases.gap.gap", [0.01, 0.02]))
    for frame in results._frames.values():
        if "cases.gap.gap" in frame.columns:
            frame.insert(1, "k.y", 10 * frame["cases.gap.gap"])
    results.attrs = {"swept": json.dumps([["cases.gap.gap", "k.y"]])}
    results.units = {"cases.gap.gap": Unit("cm", 0.01, "m"), "k.y": Unit()}
    axis = sweep.sweep_data(results, ["touching"])["axes"][0]
    assert axis["label"] == "gap [cm] (cases.gap.gap), y (k.y)"
    assert axis["words"] == ["cases.gap.gap = 1 cm, k.y = 0.1", "cases.gap.gap = 2 cm, k.y = 0.2"]
    assert axis["values"] == [1, 2]


def test_swept_columns_and_points_are_in_the_unit_of_the_study(tmp_path):
    results = make(cases=("touching",), axis=("cases.gap.gap", [0.1 / 3, 0.07]))
    results.units = {"cases.gap.gap": Unit("cm", 0.01, "m")}
    data = carried(page_of(results, tmp_path))
    head = data["tables"]["storey"]["columns"][0]
    assert (head["label"], head["unit"]) == ("cases.gap.gap", "cm")
    points_there = [point["point"]["cases.gap.gap"] for point in data["points"]]
    assert points_there == list(dict.fromkeys(head["values"])) == [3.33333, 7]


def test_head_of_the_page_tells_the_largest_numbers():
    results = make(cases=("touching", "connected"))
    results.scene()["sensitivity"] = 3.0
    results.scene().loc[7, "sensitivity"] = 42.0
    evidence = points(results)[0]
    tiles = {tile.label: tile for tile in story.tiles(evidence, [], results.scene())}
    assert tiles["Numerical error"].number == "1.0×10⁻⁷"
    assert tiles["Largest sensitivity"].number == "42.0"
    row = results.scene().loc[7]
    assert tiles["Largest sensitivity"].where == f"{row['case']}, {row['analysis']}, {row['record']}"
    assert tiles["Runs"].where == "all done"
    assert tiles["Runs"].number == str(len(results.scene()))


def test_keys_in_sentences_are_set_as_code_and_markup_is_escaped():
    assert str(_keys_as_code("write `gap: 2 cm` <b>")) == "write <code>gap: 2 cm</code> &lt;b&gt;"


def test_drawing_of_the_group_says_how_strong_every_building_is(tmp_path):
    results = make()
    results.buildings.loc[results.buildings["building"] == "soft", "base_shear_ratio"] = np.inf
    text = page_of(results, tmp_path)
    assert ">V/W 0.100</text>" in text
    assert text.count("V/W 0.100") == 2  # drawn, and said to those who do not see it
    assert "V/W inf" not in text


def test_effects_are_counted_with_their_reasons():
    scene = pd.DataFrame(
        {
            "effects": ["damping\npounding links", "damping", "damping: 5 %"],
            "dropped": [
                "yielding storeys: elastic\nhertz links: none",
                "yielding storeys: strong\nP-Delta: no building has it",
                "infill links: none\ncollapse: no",
            ],
        }
    )
    rows = {row[0]: row[1:] for row in story.effects(scene).rows}
    assert rows["damping"] == ["3", "–", ""]
    assert rows["pounding links"] == ["1", "–", ""]
    assert rows["yielding storeys"] == ["–", "2", "elastic (1); strong (1)"]
    assert rows["P-Delta"] == ["–", "1", "no building has it"]
    assert rows["all others"] == [
        "–",
        "3",
        "nothing in the study calls for: collapse, links of the kinds hertz, infill",
    ]
    assert len(rows) == 5


class Kept:
    """Results that keep one scene."""

    def __init__(self, results, history):
        self.buildings, self._history = results.buildings, history

    def histories(self):
        return pd.DataFrame([{"case": "touching", "analysis": "elastic", "record": "taft"}])

    def history(self, **place):
        assert place == {"case": "touching", "analysis": "elastic", "record": "taft"}
        return self._history


def history(steps: int, links: tuple[str, ...], sway: float = 0.0) -> History:
    t = 0.01 * np.arange(steps)
    move = np.stack([np.outer(np.sin((b + 1) * t), np.arange(1, 6)) for b in range(2)], axis=1)
    force = np.zeros((steps, len(links)))
    force[7, 1] = -5e6
    still = np.zeros((steps, 2))
    return History(
        time=t, ground_acceleration=np.cos(t), ground_displacement=t, displacement=move, total_acceleration=move,
        drift=move, shear=move, sway=still + sway, rocking=still, link_force=force,
        energy=dict.fromkeys(ENERGIES, t), buildings=("stiff", "soft"), links=links,
    )  # fmt: skip


def series(scene: dict) -> np.ndarray:
    return np.frombuffer(base64.b64decode(scene["series"]), "<f4").reshape(-1, scene["count"])


def test_player_gets_ground_floors_and_links_in_this_order():
    results = make(cases=("touching", "gap"))
    labels = tuple(f"stiff|soft {floor}" for floor in range(1, 6))
    kept = history(50, labels)
    found = motion.players(Kept(results, kept), points(results))
    scene = found["scenes"][0]
    rows = series(scene)
    assert rows.shape == (1 + 5 + 5 + 5, 50)
    np.testing.assert_allclose(rows[0], np.cos(kept.time), rtol=1e-6)
    np.testing.assert_allclose(rows[1 + 2], 3 * np.sin(kept.time), rtol=1e-6)
    np.testing.assert_allclose(rows[6 + 4], 5 * np.sin(2 * kept.time), rtol=1e-6)
    assert rows[11 + 1].min() == -5e6
    assert scene["dt"] == pytest.approx(0.01)
    assert scene["buildings"][0]["yield"] == pytest.approx([1e6 / 1e9] * 5)
    assert [(link["left"], link["right"], link["floor"], link["drawn"]) for link in scene["links"]] == [
        (0, 1, floor, "gap") for floor in range(1, 6)
    ]


def test_player_carries_the_foundation_only_where_it_moves():
    results = make(cases=("touching",))
    labels = tuple(f"stiff|soft {floor}" for floor in range(1, 6))
    scene = motion.players(Kept(results, history(20, labels, sway=0.01)), points(results))["scenes"][0]
    rows = series(scene)
    assert len(rows) == 1 + 2 * (5 + 2) + 5
    np.testing.assert_allclose(rows[6], 0.01)


def test_thinned_series_lose_no_impact(monkeypatch):
    monkeypatch.setattr(motion, "MOST_STEPS", 10)
    results = make(cases=("touching",))
    kept = history(47, tuple(f"stiff|soft {floor}" for floor in range(1, 6)))
    scene = motion.players(Kept(results, kept), points(results))["scenes"][0]
    assert scene["stride"] == 5
    assert scene["dt"] == pytest.approx(0.05)
    rows = series(scene)
    assert rows.shape[1] == 10
    np.testing.assert_allclose(rows[1], np.sin(kept.time[::5]), rtol=1e-6)
    assert rows[11 + 1].tolist() == [0, -5e6, *[0] * 8]


def test_scenes_beyond_the_room_of_the_page_are_left_out(monkeypatch):
    results = make(cases=("touching",))
    kept = Kept(results, history(50, tuple(f"stiff|soft {floor}" for floor in range(1, 6))))
    frame = kept.histories()
    kept.histories = lambda: pd.concat([frame] * 3)
    monkeypatch.setattr(motion, "MOST_BYTES", 2 * 16 * 50 * 16 / 3 + 1)
    found = motion.players(kept, points(results))
    assert (found["kept"], len(found["scenes"])) == (3, 2)


def test_the_page_asks_nothing_of_any_network(tmp_path):
    text = page_of(make(), tmp_path)
    assert "default-src 'none'" in text
    assert re.findall(r'(?:src|href)="(?!data:|#)[^"]*"', text) == []
    assert "@import" not in text
    assert re.findall(r"https?://(?!www\.w3\.org/2000/svg)", text) == []


def test_a_page_can_be_left_out(tmp_path):
    write_report(make(), tmp_path, (), with_page=False)
    assert not (tmp_path / "report.html").exists()
    assert (tmp_path / "tables" / "storey.csv").exists()


def test_answer_of_accuracy_beside_the_results_is_taken_in_if_it_is_this_study(tmp_path):
    results = tmp_path / "fig6.h5"
    asked = accuracy_beside(results, "Fig. 6")
    assert asked.words == ()
    assert asked.command == f"pound accuracy fig6.yaml -o {tmp_path / 'fig6-accuracy'}"
    folder = tmp_path / "fig6-accuracy"
    folder.mkdir()
    lines = [
        "# What accuracy costs: Fig. 6",
        "",
        "- For 1 % use taylor.",
        "",
        "Reference: two.",
        "",
        "![a](b.png)",
        "x",
    ]
    (folder / "accuracy.md").write_text("\n".join(lines))
    header = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + (300).to_bytes(4, "big") + (200).to_bytes(4, "big")
    (folder / "accuracy-elastic.png").write_bytes(header)
    found = accuracy_beside(results, "Fig. 6")
    assert found.words == ("For 1 % use taylor.", "Reference: two.")
    assert [(picture.width, picture.height) for picture in found.pictures] == [(150, 100)]
    assert accuracy_beside(results, "Fig. 7").words == ()

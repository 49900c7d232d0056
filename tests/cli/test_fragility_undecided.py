"""`pound fragility` where a building collapses, what that leaves undecided, and where time histories fail."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from scipy.stats import lognorm

from pounding_cli import open_results
from pounding_cli.questions.fragility.hunt import next_levels
from pounding_cli.questions.reports import build_report as report
from tests.adapter import response
from tests.night import NIGHTLY

# A has a soft lower storey that collapses, and an upper one far too strong to yield much. B stays far from its limits.
STUDY = """\
title: A falls, B stands
records: {use: [elcentro, taft, olympia, parkfield], duration: 5 s, scale: {pga: 0.4 g}}
buildings:
  A:
    storeys: 2
    mass: 100 t
    height: 3 m
    stiffness: [4000 kN/m, 40000 kN/m]
    yield_shear: [100 kN, 4000 kN]
    hardening: 0
    p_delta: true
  B: {storeys: 2, period: 0.2 s, yield: {base_shear: 3 W}}
group: [A, B]
cases: {touching: {link: pounding, gap: 1 cm}}
analyses: [inelastic]
estimate: none
sweep: {records.scale.pga: {from: 0.1 g, to: 2 g, step: 0.1 g}}
fragility:
  limits:
    - collapse in A
    - mu in A > 4
    - mu in A > 30
    - mu in A storey 1 > 30
    - mu in A storey 2 > 4
    - mu in B > 12
    - acceleration in B > 60 g
"""
COLLAPSE, UPPER = "collapse in A", "mu in A storey 2 > 4"
B_MU, B_ACCELERATION = "mu in B > 12", "acceleration in B > 60 g"
OTHERS = (B_MU, B_ACCELERATION, UPPER)


def curves(path, state: str = "with pounding") -> pd.DataFrame:
    """Return the rows of one state by limit."""
    frame = open_results(path).table("fragility")
    return frame[frame["state"] == state].set_index("limit")


def test_a_building_does_not_inherit_the_collapse_of_its_neighbour_nor_a_storey_that_of_another(pound, folder):
    """Fails if a limit of B, or of the other storey of A, counts as passed where A collapses, or as held."""
    code, out, _ = pound("fragility", "two.yaml", "-o", "a.h5")
    assert code == 0
    table = curves("a.h5")
    alone = curves("a.h5", "alone")
    results = open_results("a.h5")
    assert 1 < table.loc[COLLAPSE, "median"] < 20  # 0.1 to 2 g: every motion brings A down
    for limit in OTHERS:
        curve = table.loc[limit]
        assert curve["outcome"] == "undecided"
        assert (curve["undecided_motions"], curve["motions"]) == (4, 4)
        assert np.isnan([curve["median"], curve["spread"], curve["ratio"]]).all()
        assert curve["undecided"] > 0
        assert curve["failed"] == 0
    for limit in (B_MU, B_ACCELERATION):
        assert alone.loc[limit, "outcome"] == "never passed"
        assert alone.loc[limit, "undecided_motions"] == alone.loc[limit, "undecided"] == 0
    motions = results.table("fragility_motions").set_index(["state", "limit", "record"]).loc["with pounding"]
    for record in ("elcentro", "taft", "olympia", "parkfield"):
        falls = motions.loc[COLLAPSE, record]
        for limit in OTHERS:
            mine = motions.loc[limit, record]
            assert (mine["held"], mine["passed"]) == (falls["held"], np.inf)  # known to hold until A comes down
    assert "undecided in 4 of 4 motions" in out
    assert "a collapse ended the time histories before the limit was passed" in " ".join(out.split())
    row = next(line for line in out.splitlines() if line.startswith(f" {B_ACCELERATION}") and "pounding" in line)
    assert row.split()[-1] == "–"  # the spread, behind a ratio that is empty
    assert row.split()[-2].replace(".", "").isdigit()  # the bound of the median
    assert pound("report", "a.h5", "--no-figures", "-q")[0] == 0
    assert (folder / "a" / "tables" / "flagged.csv").stat().st_size > 1000  # every collapse
    page = " ".join((folder / "a" / "report.html").read_text(encoding="utf-8").split())
    assert page.count("undecided in 4 of 4 motions") >= len(OTHERS)


def test_a_limit_is_sought_above_a_collapse(pound, folder):
    """A falls at weaker motions than B passes at, but B passes before it in stronger ones: what all intensities of
    stripes tell of this, `ida` finds."""
    text = STUDY[: STUDY.index("fragility")].replace("to: 2 g", "to: 4 g")
    found = {}
    for method in ("ida", "stripes"):
        (folder / "two.yaml").write_text(f"{text}fragility: {{method: {method}, limits: mu in B > 0.8}}\n")
        pound("fragility", "two.yaml", "-o", f"{method}.h5", "-q")
        found[method] = open_results(f"{method}.h5")
    stripes, ida = (found[method].table("fragility_motions") for method in ("stripes", "ida"))
    passes = (
        stripes[(stripes["demand"] > 1) & (stripes["state"] == "with pounding")].groupby("record")["intensity"].min()
    )
    assert len(passes) >= 2
    above = ida[ida["state"] == "with pounding"].set_index("record")["passed"]
    assert (above[passes.index] >= passes).all()
    assert np.isfinite(above[passes.index]).all()


def test_levels_below_a_pass_are_looked_at():
    """A motion passes at one level, holds above it, and passes again: only `fill` finds the first."""
    levels = np.arange(1.0, 41.0)
    demand = np.where((levels == 11) | (levels > 30), 1.5, levels / 32)
    for fill, first in ((0, 31.0), (30, 11.0)):
        seen: dict[int, float] = {}
        while new := next_levels(levels, seen, fill):
            seen |= {level: float(demand[level]) for level in new}
        assert min(levels[level] for level, each in seen.items() if each > 1) == first


def test_the_storey_that_collapsed_passes_every_limit_of_its_drift(pound):
    """Fails if the collapse of a storey leaves its own ductility undecided, or that of the building."""
    pound("fragility", "two.yaml", "-o", "a.h5", "-q")
    for state in ("with pounding", "alone"):  # ductility at the collapse is below 30
        table = curves("a.h5", state)
        falls = table.loc[COLLAPSE]
        for limit in ("mu in A > 30", "mu in A storey 1 > 30"):
            assert table.loc[limit, "median"] == falls["median"]
            assert table.loc[limit, "undecided"] == 0
        if state == "with pounding":
            assert table.loc["mu in A > 4", "high"] < falls["median"]


@pytest.mark.parametrize("method", ["stripes", "cloud"])
def test_other_methods_leave_the_same_undecided(pound, folder, method):
    """Fails if a stripe or a cloud counts a scene that A's collapse ended as one of B's."""
    text = STUDY.replace("fragility:\n", f"fragility:\n  method: {method}\n")
    (folder / "two.yaml").write_text(text.replace("{from: 0.1 g, to: 2 g, step: 0.1 g}", "[0.2 g, 1.5 g, 2 g]"))
    assert pound("fragility", "two.yaml", "-o", "a.h5", "-q")[0] == 0
    table, results = curves("a.h5"), open_results("a.h5")
    fell = (results.scene()["status"] == "collapsed").sum()
    assert fell >= 8
    motions = results.table("fragility_motions")
    motions = motions[motions["state"] == "with pounding"]
    for limit in OTHERS:
        assert table.loc[limit, "undecided"] == fell
        assert motions[motions["limit"] == limit]["demand"].isna().sum() == fell
        assert motions[motions["limit"] == limit]["undecided"].sum() == fell
    if method == "stripes":
        assert set(table.loc[list(OTHERS), "outcome"]) == {"undecided"}
        assert (motions[motions["limit"] == "mu in A storey 1 > 30"]["demand"] == np.inf).sum() == fell


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("method", ["ida", pytest.param("stripes", marks=NIGHTLY)])
def test_limits_that_are_never_passed_leave_the_figure_as_it_is(pound, folder, method):
    """Fails if a limit without a curve squeezes the panels, sets the axis of a limit that has curves, or writes over
    its neighbour, or if the caption is cut."""
    text = STUDY.replace("fragility:\n", f"fragility:\n  method: {method}\n")
    (folder / "two.yaml").write_text(text)
    pound("fragility", "two.yaml", "-o", "a.h5", "-q")
    assert pound("report", "a.h5", "--format", "png", "-q")[0] == 0
    results = open_results("a.h5")
    (picture,) = report(results).figures()
    figure = picture.draw()
    with mpl.rc_context({"savefig.dpi": 100}):
        figure.draw_without_rendering()
    width, height = figure.bbox.width, figure.bbox.height
    panels = {ax.get_title(loc="left"): ax for ax in figure.axes}
    assert len(panels) == len(figure.axes) == 7
    caption = figure.findobj(lambda each: getattr(each, "get_text", str)().startswith("Markers: "))
    assert "Kaplan" in caption[0].get_text() or method == "stripes"
    assert "Motions: stand-in: " in caption[0].get_text().replace("\n", " ")
    for text in (*caption, *(each for ax in panels.values() for each in ax.texts)):
        box = text.get_window_extent()
        assert 0 <= box.x0 < box.x1 <= width
        assert 0 <= box.y0 < box.y1 <= height
    medians = results.table("fragility").groupby("limit")["median"].max()
    for limit, ax in panels.items():
        assert ax.get_window_extent().height > 0.5 * height / 7
        assert ax.get_window_extent().width > 0.25 * width
        if np.isfinite(medians[limit]):
            assert ax.get_xlim()[1] < 5 * medians[limit] / 9.80665
        for text in ax.texts:
            assert text.get_window_extent().x0 > ax.get_window_extent().x0


def test_the_points_of_curves(pound, folder):
    """Fails if a point lies off its curve, or a curve that there is none of is told."""
    text = STUDY.replace("sweep: {", "sweep: {cases.touching.gap: [1 cm, 2 cm], ")
    (folder / "two.yaml").write_text(text)
    out = " ".join(pound("fragility", "two.yaml", "-o", "a.h5")[1].split())
    assert "A, collapse, at cases.touching.gap = 1 cm: the difference" in out
    assert ", at cases.touching.gap = 2 cm" not in out
    assert "The table has the other points of the sweep." in out
    results = open_results("a.h5")
    keys = ["cases.touching.gap", "analysis", "limit", "building", "case", "state"]
    table = results.table("fragility")
    points = results.table("fragility_curves").groupby(keys)
    checked = 0
    for row in table.to_dict("records"):
        place = tuple(row[key] for key in keys)
        if np.isnan(row["median"]):
            assert place not in points.groups
            continue
        of_curve = points.get_group(place)
        x = of_curve["intensity"].to_numpy()
        assert len(x) == len(np.unique(x)) >= 100
        likely = lognorm.cdf(x, row["spread"], scale=row["median"])
        assert of_curve["probability"].to_numpy() == pytest.approx(likely, abs=1e-9)
        assert of_curve[["probability_low", "probability_high"]].isna().all(axis=None)  # of four motions
        assert of_curve["probability"].max() > 0.9
        checked += 1
    assert checked == 2 * 2 * 4


def solve_or_fail(fails: str):
    """Return a solver in which ductilities are 4 times the peak acceleration in g, and the linked scenes of a motion
    fail."""

    def solve(scene, accuracy=1e-6, method="taylor", **_):
        storeys = tuple(building.storeys for building in scene.buildings)
        peaks = response.no_peaks(storeys, len(scene.links))
        is_failed = bool(scene.links) and scene.motion.name == fails
        if not is_failed:
            for name in (*response.STOREYS, *response.LINKS):
                peaks[name] = 1.0
            for place, count in enumerate(storeys):
                peaks["ductility"][place] = np.full(count, 4 * scene.motion.pga / 9.80665)
        status = "too many steps" if is_failed else "done"
        closings = peaks["max_closing"]
        return response.Response(peaks, storeys, status, "", "taylor", accuracy, 1, 1, 1e-4, closing_to_rest=closings)

    return solve


@pytest.mark.parametrize("fails", ["taft", ""])
def test_failed_time_histories_are_counted_where_there_are_some(pound, folder, fails):
    """Fails if a failed time history counts as one that holds or passes, or the note on it is lost or always there."""
    text = STUDY[: STUDY.index("fragility:")]
    (folder / "two.yaml").write_text(f"{text}fragility: {{method: stripes, limits: mu in B > 4}}\n")
    code, out, _ = pound("fragility", "two.yaml", "-o", "a.h5", solve=solve_or_fail(fails))
    assert code == (1 if fails else 0)
    assert ("20 time histories failed: counted neither as holding nor as passing." in out) == bool(fails)
    assert ("failed: counted" in out) == bool(fails)
    for state, failed in (("with pounding", 20 if fails else 0), ("alone", 0)):
        row = curves("a.h5", state).loc["mu in B > 4"]
        assert (row["histories"], row["failed"]) == (80, failed)
        assert (row["low"] / 9.80665, row["high"] / 9.80665) == pytest.approx((1.0, 1.1))

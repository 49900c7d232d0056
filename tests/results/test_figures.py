"""The data in the axes of figures, of the explorer and of the player: unit, order, row, and ends of whiskers."""

from __future__ import annotations

import base64
from collections.abc import Iterator

import numpy as np
import pytest
from matplotlib import colors
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.container import ErrorbarContainer
from matplotlib.patches import Rectangle

import pounding_cli
from pounding_cli.laws import is_damper, link_laws
from pounding_cli.numbers import Unit
from pounding_cli.records.code_spectra import build_asce7
from pounding_cli.records.motion import Motion, spectrum
from pounding_cli.records.scaling import SpectrumMatch, TargetSpectrum
from pounding_cli.report import figures, motions, sweep, widgets
from pounding_cli.report.evidence import find_nominal
from pounding_cli.report.style import PAGE, drawing_for, looks

STUDY = """\
title: Small
records: {use: [elcentro, taft, parkfield], duration: 3 s}
buildings:
  stiff: {storeys: 3, period: 0.3 s, mass: 200 t, height: 3 m, slab: 30 cm}
  soft: {storeys: 2, period: 0.5 s, mass: 200 t, height: [3 m, 6 m], slab: 20 cm}
group: [stiff, soft]
cases:
  gap: {link: pounding, gap: 5 mm}
  connected: {link: connector, gap: 50 cm, stiffness: 5 kN/mm}
  infill: {link: infill, gap: 5 mm, stiffness: 20 kN/mm}
analyses: [elastic, inelastic]
estimate: none
"""
ISOLATED = """\
title: Isolated
records: {use: [elcentro], duration: 3 s}
buildings:
  fixed: {storeys: 2, period: 0.3 s, mass: 200 t}
  isolated: {like: fixed, foundation: {mass: 200 t, isolation: {radius: 3.1 m, friction: 6 %, capacity: 30 cm}}}
group: [fixed, isolated]
cases: {near: {link: pounding, gap: 1 cm}}
analyses: [elastic]
estimate: none
keep: histories
"""
CASES = ["gap", "connected", "infill"]
GAPS = [7, 5, 6]  # [mm], in the order of the study
FURTHER = {
    "plain": "keep: {histories: {cases: [connected], analyses: [inelastic], records: [taft]}}\n",
    "curves": f"sweep: {{cases.gap.gap: [{', '.join(f'{gap} mm' for gap in GAPS)}]}}\n",
    "maps": "sweep: {cases.connected.stiffness: [50 kN/mm, 0.5 kN/mm, 40 kN/mm], impact.restitution: [0.6, 0.4]}\n",
}


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """`solved(name)`: the results of a study."""
    made: dict[str, pounding_cli.Results] = {}

    def solve(name: str) -> pounding_cli.Results:
        if name not in made:
            path = tmp_path_factory.mktemp(name) / "study.yaml"
            study = ISOLATED if name == "isolated" else STUDY + FURTHER[name]
            path.write_text(study.replace("gap: 50 cm", "gap: 1 cm") if name == "maps" else study)
            made[name] = pounding_cli.run(path, path.with_suffix(".h5"), engine="serial")
        return made[name]

    return solve


def find_panels(figure) -> dict[str, Axes]:
    """The panels of a figure by their titles, from left to right and from the top."""
    return {ax.get_title(loc="left"): ax for ax in figure.axes if ax.get_title(loc="left")}


def iter_profiles(ax: Axes) -> Iterator[tuple[str, np.ndarray, np.ndarray, np.ndarray]]:
    """Case (by colour), values, heights and ends of the whiskers of every line of a panel."""
    case_of = {look.color: case for case, look in looks(CASES).items()}
    for container in (each for each in ax.containers if isinstance(each, ErrorbarContainer)):
        line, _, (bars,) = container.lines
        segments = np.array(bars.get_segments())
        assert segments[:, 0, 1] == pytest.approx(line.get_ydata())  # each at its own height
        yield case_of[line.get_color()], line.get_xdata(), line.get_ydata(), segments[:, :, 0]


# profiles over the height


@pytest.mark.parametrize(
    ("draw", "table", "level", "panels"),
    [
        (figures.response, "storey", "storey", {"elastic": ("V_ratio", "V/V₀"), "inelastic": ("mu_ratio", "μ/μ₀")}),
        (figures.accelerations, "floor", "floor", {
            "elastic": ("acceleration_ratio", "floor acceleration over that alone"),
            "inelastic": ("acceleration_ratio", "floor acceleration over that alone")}),
    ],
)  # fmt: skip
@pytest.mark.parametrize("building", ["stiff", "soft"])
def test_profiles_have_the_means_and_the_extremes_of_every_case(solved, draw, table, level, panels, building):
    """Fails if whiskers are swapped, cases, analyses or buildings are mixed up, or storeys are upside down."""
    results = solved("plain")
    figure = draw(find_nominal(results), building)
    drawn = find_panels(figure)
    assert list(drawn) == [analysis.capitalize() for analysis in panels]  # elastic is left
    places = [ax.get_subplotspec().colspan.start for ax in drawn.values()]
    assert places == [0, 1]
    rows = results.table(table)
    for (analysis, (quantity, label)), ax in zip(panels.items(), drawn.values(), strict=True):
        assert ax.get_xlabel() == label
        assert ax.get_ylabel() == level
        low, top = ax.get_ylim()
        assert low < top
        assert [text.get_text() for text in ax.get_yticklabels()] == ["1", "2", "3"][: 3 if building == "stiff" else 2]
        here = rows[(rows["analysis"] == analysis) & (rows["building"] == building)]
        spread = here.groupby(["case", level])[quantity].agg(["mean", "min", "max"])
        profiles = list(iter_profiles(ax))
        assert [case for case, *_ in profiles] == CASES
        for case, values, heights, ends in profiles:
            assert np.round(heights).tolist() == spread.loc[case].index.tolist()
            assert values == pytest.approx(spread.loc[case]["mean"].to_numpy())
            assert ends == pytest.approx(spread.loc[case][["min", "max"]].to_numpy())
            assert (ends[:, 1] - values).tolist() != pytest.approx((values - ends[:, 0]).tolist())  # not symmetric
        assert [1, 1] in [list(line.get_xdata()) for line in ax.lines]
    legend = next(ax.get_legend() for ax in figure.axes if ax.get_legend())
    keys = {text.get_text(): line.get_color() for text, line in zip(legend.texts, legend.legend_handles, strict=True)}
    assert keys == {case: look.color for case, look in looks(CASES).items()}


def test_a_caption_says_what_an_acceleration_of_a_contact_depends_on(solved):
    """Of floors that strike; not where no floor strikes, nor of shears. Fails if the sentence is lost, or on all."""
    said = "depend on the contact stiffness"
    plain = find_nominal(solved("plain"))
    lonely = find_nominal(solved("plain"))
    assert said in figures.accelerations(plain, "soft").get_label()
    assert said not in figures.response(plain, "soft").get_label()
    links = lonely.link
    object.__setattr__(lonely, "link", links.assign(impacts=0))
    assert said not in figures.accelerations(lonely, "soft").get_label()
    for quantity, is_said in (("acceleration", True), ("peak_force", True), ("drift", False)):
        (picture, *_) = sweep.list_sweep_pictures(
            solved("curves"), find_nominal(solved("curves")), sweep.SweepChoice((quantity,))
        )
        assert (said in picture.draw().get_label()) == is_said


# over a sweep


@pytest.mark.parametrize(
    ("quantity", "label", "factor"), [("drift", "drift [mm]", 1e-3), ("V", "V [kN]", 1e3), ("V_ratio", "V/V₀", 1.0)]
)
def test_curves_have_the_means_and_deviations_in_the_units_of_their_axes(solved, quantity, label, factor):
    """Fails if values are in SI on an axis in mm, points are not in the order of the axis, or a band is too wide."""
    results = solved("curves")
    choice = sweep.SweepChoice((quantity,), {"building": "soft", "storey": "2"})
    (picture,) = sweep.list_sweep_pictures(results, find_nominal(results), choice)
    panels = find_panels(picture.draw())
    assert list(panels) == ["Elastic", "Inelastic"]
    rows = results.storey().query("building == 'soft' and storey == 2")
    case_of = {look.color: case for case, look in looks(CASES).items()}
    for analysis, ax in zip(("elastic", "inelastic"), panels.values(), strict=True):
        assert ax.get_ylabel() == label
        assert ax.get_xlabel().splitlines() == ["gap [mm]", "cases.gap.gap"]
        here = rows[rows["analysis"] == analysis].groupby(["case", "cases.gap.gap"])[quantity]
        mean, std = here.mean() / factor, here.std() / factor
        lines = [line for line in ax.lines if line.get_color() in case_of and len(line.get_xdata()) == len(GAPS)]
        bands = [each for each in ax.collections if isinstance(each, PolyCollection)]
        assert [case_of[line.get_color()] for line in lines] == CASES
        for line, band in zip(lines, bands, strict=True):
            case = case_of[line.get_color()]
            assert line.get_xdata() == pytest.approx(sorted(GAPS))
            assert line.get_ydata() == pytest.approx(mean[case].to_numpy())
            assert colors.to_hex(band.get_facecolor()[0]) == colors.to_hex(line.get_color())
            corners = band.get_paths()[0].vertices
            for gap, middle, half in zip(sorted(GAPS), mean[case], std[case], strict=True):
                heights = corners[np.isclose(corners[:, 0], gap), 1]
                assert (heights.min(), heights.max()) == pytest.approx((middle - half, middle + half))


def test_a_curve_has_the_place_where_the_mean_is_largest(solved):
    """Of all storeys where none is chosen. Fails if it is the mean of the largest values, or the first storey."""
    results = solved("curves")
    pictures = sweep.list_sweep_pictures(results, find_nominal(results), sweep.SweepChoice(("drift",)))
    for building, picture in zip(("stiff", "soft"), pictures, strict=True):
        ax = find_panels(picture.draw())["Inelastic"]
        rows = results.storey().query(f"building == '{building}' and analysis == 'inelastic' and case == 'infill'")
        means = rows.groupby(["cases.gap.gap", "storey"])["drift"].mean().unstack()
        (line,) = [line for line in ax.lines if line.get_color() == looks(CASES)["infill"].color]
        assert line.get_ydata() == pytest.approx(1e3 * means.max(axis=1).to_numpy())


def test_cells_of_maps_stand_at_their_values(solved):
    """Fails if axes are swapped or turned around, a number is that of another cell, or another cell is hatched."""
    results = solved("maps")
    pictures = sweep.list_sweep_pictures(results, find_nominal(results))
    assert [picture.name for picture in pictures] == ["stiff-map", "soft-map"]
    stiffnesses, restitutions = [0.5, 40, 50], [0.4, 0.6]
    void = find_void(results)
    for building, picture in zip(("stiff", "soft"), pictures, strict=True):
        panels = find_panels(picture.draw())
        assert list(panels) == [f"{case}, {analysis}" for analysis in ("elastic", "inelastic") for case in CASES]
        for title, ax in panels.items():
            case, _, analysis = title.partition(", ")
            quantity = "V_ratio" if analysis == "elastic" else "mu_ratio"
            rows = results.storey()
            rows = rows[(rows["case"] == case) & (rows["analysis"] == analysis) & (rows["building"] == building)]
            means = rows.groupby(["impact.restitution", "cases.connected.stiffness", "storey"])[quantity].mean()
            wanted = means.groupby(["impact.restitution", "cases.connected.stiffness"]).max().unstack().to_numpy()
            (mesh,) = [each for each in ax.collections if isinstance(each, QuadMesh)]
            assert np.asarray(mesh.get_array()).reshape(2, 3) == pytest.approx(wanted)
            cells = mesh.get_coordinates()
            assert (cells[0, 0].tolist(), cells[-1, -1].tolist()) == ([0.5, 0.5], [3.5, 2.5])
            texts = {text.get_position(): text.get_text() for text in ax.texts}
            assert set(texts) == {(column, row) for column in (1, 2, 3) for row in (1, 2)}
            for (column, row), text in texts.items():
                assert float(text) == pytest.approx(wanted[row - 1, column - 1], rel=6e-3)
            hatched = {tuple(np.round(cell.mean(axis=0)).astype(int)) for cell in _iter_hatched(ax)}
            assert hatched == {
                (stiffnesses.index(stiffness) + 1, restitutions.index(restitution) + 1)
                for of_case, of_analysis, stiffness, restitution in void
                if (of_case, of_analysis) == (case, analysis)
            }
        bottom = panels["gap, inelastic"]
        assert [text.get_text() for text in bottom.get_xticklabels()] == [f"{stiffness:g}" for stiffness in stiffnesses]
        assert [text.get_text() for text in bottom.get_yticklabels()] == [str(each) for each in restitutions]
        assert bottom.get_xlabel().startswith("stiffness of connected [kN/mm]")
        assert bottom.get_ylabel().startswith("restitution")


def find_void(results) -> dict[tuple[str, str, float, float], int]:
    """Case, analysis, stiffness [kN/mm] and restitution of the runs that are not meaningful; how many motions."""
    flagged = results.table("flagged").query("meaningless")
    keys = ["case", "analysis", "cases.connected.stiffness", "impact.restitution"]
    counts = flagged.groupby(keys)["record"].nunique()
    found = {(case, analysis, stiffness / 1e6, each): n for (case, analysis, stiffness, each), n in counts.items()}
    assert {case for case, *_ in found} == {"connected"}
    assert {stiffness for _, _, stiffness, _ in found} == {0.5}  # not the same transposed
    return found


def _iter_hatched(ax: Axes) -> Iterator[np.ndarray]:
    """Yield the corners of every hatched cell."""
    for patch in ax.patches:
        assert patch.get_hatch()
        corners = patch.get_path().vertices
        yield from (corners[place : place + 4] for place in range(0, len(corners), 5))


# isolators, motions, spectra, the group


def test_loops_of_isolators_are_in_cm_and_meganewtons(solved):
    results = solved("isolated")
    (picture,) = figures.list_loops(find_nominal(results))
    (ax,) = find_panels(picture.draw()).values()
    assert ax.get_title(loc="left") == "isolated"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("displacement of the base [cm]", "force of the isolators [MN]")
    history = results.history()
    (line,) = ax.lines
    assert line.get_xdata() == pytest.approx(100 * history.sway[:, 1])
    assert line.get_ydata() == pytest.approx(1e-6 * history.base_force[:, 1])
    assert np.ptp(line.get_xdata()) > 0.1


def test_a_motion_is_drawn_in_the_units_of_its_axes():
    """A sine of 2 m/s2 and pi rad/s, whose integrals are known. Fails if g, m/s or m are mixed up."""
    time = np.arange(0.0, 4.0005, 0.001)
    motion = Motion("sine", 0.001, 2.0 * np.sin(np.pi * time))
    axes = motions.draw_motion(motion, "A sine").axes
    labels = [ax.get_ylabel() for ax in axes]
    assert labels == [
        "acceleration [g]", "velocity [m/s]", "displacement [m]", "Husid [-]", "pseudo-acceleration [g], 5 %",
    ]  # fmt: skip
    lines = [ax.lines[0] for ax in axes]
    for line in lines[:4]:
        assert line.get_xdata() == pytest.approx(time)
    acceleration, velocity, displacement, husid = (line.get_ydata() for line in lines[:4])
    assert acceleration == pytest.approx(2.0 / 9.80665 * np.sin(np.pi * time), abs=1e-6)
    speed = 2.0 / np.pi * (1.0 - np.cos(np.pi * time))
    assert velocity == pytest.approx(speed, abs=1e-5)
    assert displacement == pytest.approx(2.0 / np.pi * (time - np.sin(np.pi * time) / np.pi), abs=1e-5)
    assert (husid[0], husid[2000], husid[-1]) == pytest.approx((0.0, 0.5, 1.0), abs=1e-6)
    periods, values = lines[4].get_data()
    assert values == pytest.approx(spectrum(motion, periods) / 9.80665)
    assert periods[np.argmax(values)] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(("unit", "factor"), [(Unit("g", 9.80665), 9.80665), (Unit("m/s²"), 1.0)])
def test_spectra_are_drawn_in_the_unit_of_the_study(unit, factor):
    """Fails if the target is in another unit than the motions, or the mean is another line."""
    target = TargetSpectrum((0.1, 1.0), (8.0, 2.0), 0.2, 0.8)
    periods = np.geomspace(0.1, 1.6, 5).tolist()
    spectra = {"one": [1.0, 2.0, 3.0, 2.0, 1.0], "two": [3.0, 6.0, 5.0, 4.0, 2.0]}
    match = SpectrumMatch(target, 0.9, "Scaled.", periods, spectra)
    (ax,) = motions.draw_spectra(match, "t", unit).axes
    assert ax.get_ylabel() == f"pseudo-acceleration [{unit.name}], 5 % damping"
    first, second, mean, wanted, least = ax.lines
    for line, values in ((first, spectra["one"]), (second, spectra["two"]), (mean, [2.0, 4.0, 4.0, 3.0, 1.5])):
        assert line.get_xdata() == pytest.approx(periods)
        assert line.get_ydata() == pytest.approx(np.array(values) / factor)
    assert [line.get_label() for line in (mean, wanted, least)] == ["mean of 2", "target", "0.9 of the target"]
    assert (wanted.get_ydata()[0], wanted.get_ydata()[-1]) == pytest.approx((8.0 / factor, 2.0 / factor))
    assert least.get_ydata() == pytest.approx(0.9 * target.ordinates / factor)
    (shaded,) = ax.patches
    assert (shaded.get_extents().transformed(ax.transData.inverted()).intervalx) == pytest.approx((0.2, 0.8))


def test_the_spectrum_of_a_code_is_drawn_with_its_name_and_its_corners():
    """Fails if it is drawn beyond the axis, or the line cuts a corner: 0.5 s and 1 s are no periods of the fit."""
    name = "ASCE 7-16, SDS 0.8 g, SD1 0.4 g, TL 8 s"
    code = build_asce7(0.8 * 9.80665, 0.4 * 9.80665, 8.0)
    target = TargetSpectrum(code.periods, code.values, 0.2, 0.8, 0.05, code.straight_in_period, code.name)
    match = SpectrumMatch(target, 0.9, "Scaled.", [0.05, 1.6], {"one": [1.0, 1.0]})
    (ax,) = motions.draw_spectra(match, "t", Unit("g", 9.80665)).axes
    *_, wanted, least = ax.lines
    assert wanted.get_label() == name
    periods, ordinates = wanted.get_data()
    assert (periods[0], periods[-1]) == pytest.approx((0.05, 1.6))
    for period, ordinate in {0.05: 0.56, 0.1: 0.8, 0.5: 0.8, 1.6: 0.25}.items():
        assert ordinates[np.isclose(periods, period, rtol=1e-12)].item() == pytest.approx(ordinate)
    assert least.get_ydata()[least.get_xdata() == 0.5].item() == pytest.approx(0.72)


def test_the_group_is_drawn_to_scale(solved):
    """Three storeys of 3 m beside one of 3 m and one of 6 m. Fails if a storey is drawn with another height."""
    evidence = find_nominal(solved("plain"))
    ax = figures.draw_sketch(evidence).axes[0]
    boxes = [patch for patch in ax.patches if isinstance(patch, Rectangle)]
    storeys = [box for box in boxes if box.get_linewidth() > 0]
    slabs = [box for box in boxes if box.get_linewidth() == 0]
    unit = storeys[0].get_height() / 3.0  # of a metre
    for left, heights, face, slab in ((0, [3, 3, 3], "black", 0.3), (1, [3, 6], "white", 0.2)):
        middle = np.mean([box.get_x() for box in storeys])
        mine = [box for box in storeys if (box.get_x() > middle) == bool(left)]
        assert [box.get_height() / unit for box in mine] == pytest.approx(heights)
        assert [box.get_y() / unit for box in mine] == pytest.approx([sum(heights[:n]) for n in range(len(heights))])
        assert {colors.to_hex(box.get_facecolor()) for box in mine} == {colors.to_hex(face)}
        plates = [box for box in slabs if (box.get_x() > middle) == bool(left)]
        assert [box.get_height() / unit for box in plates] == pytest.approx([slab] * len(heights))
        centres = [(box.get_y() + box.get_height() / 2) / unit for box in plates]
        assert centres == pytest.approx(np.cumsum(heights))
    assert [text.get_text() for text in ax.texts] == ["stiff\nT = 0.30 s", "soft\nT = 0.50 s"]


def test_figures_for_a_page_leave_out_what_the_page_has(solved):
    """Title, caption and group; the data are the same. Fails if the panels differ, or a caption is lost."""
    evidence = find_nominal(solved("plain"))
    own = figures.response(evidence, "soft")
    with drawing_for(PAGE):
        shown = figures.response(evidence, "soft")
    assert own.get_suptitle()
    assert own.get_supxlabel()
    assert (shown.get_suptitle(), shown.get_supxlabel()) == ("", "")
    assert own.get_label() == shown.get_label() != ""
    assert any(ax.patches for ax in own.axes)
    assert not any(ax.patches for ax in shown.axes)
    for one, other in zip(find_panels(own).values(), find_panels(shown).values(), strict=True):
        for (case, values, heights, ends), (same, *numbers) in zip(
            iter_profiles(one), iter_profiles(other), strict=True
        ):
            assert case == same
            for number, drawn in zip((values, heights, ends), numbers, strict=True):
                assert drawn == pytest.approx(number)


# what the scripts of the page draw


def read_explored(drawn: dict, quantity: str, kind: str, **at: int) -> float | None:
    """A number of the explorer by its place, as the script of the page finds it."""
    (found,) = [each for each in drawn["quantities"] if each["key"] == quantity]
    motion_count = len(drawn["motions"]) if kind == "mean" else 1
    sizes = [len(drawn["cases"]), motion_count, len(drawn["analyses"]), len(found["places"]), len(found["levels"])]
    sizes += [len(axis["values"]) for axis in drawn["axes"]]
    places = [at["case"], at["motion"], at["analysis"], at["place"], at["level"]]
    places += [at[f"axis{number}"] for number in range(len(drawn["axes"]))]
    return found[kind][int(np.ravel_multi_index(places, sizes))]


@pytest.mark.parametrize(("quantity", "label", "factor"), [("drift", "drift [mm]", 1e-3), ("V_ratio", "V/V₀", 1.0)])
def test_the_explorer_has_every_number_at_its_place(solved, quantity, label, factor):
    """Fails if two dimensions are exchanged, low and high are, or a number is in SI under a label in mm."""
    results = solved("maps")
    drawn = widgets.build_explorer_data(results, find_nominal(results))
    (found,) = [each for each in drawn["quantities"] if each["key"] == quantity]
    assert found["label"] == label
    assert drawn["motions"] == ["mean", "elcentro", "taft", "parkfield"]
    assert [axis["values"] for axis in drawn["axes"]] == [[50, 0.5, 40], [0.6, 0.4]]
    assert [axis["label"] for axis in drawn["axes"]] == [
        "stiffness of connected [kN/mm] (cases.connected.stiffness)", "restitution (impact.restitution)",
    ]  # fmt: skip
    rows = results.storey()
    for row in rows.sample(60, random_state=1).to_dict("records"):
        place = {
            "case": drawn["cases"].index(row["case"]),
            "analysis": drawn["analyses"].index(row["analysis"]),
            "place": found["places"].index(row["building"]),
            "level": found["levels"].index(row["storey"]),
            "axis0": drawn["axes"][0]["values"].index(round(1e-6 * row["cases.connected.stiffness"], 9)),
            "axis1": drawn["axes"][1]["values"].index(row["impact.restitution"]),
        }
        motion = drawn["motions"].index(row["record"])
        assert read_explored(drawn, quantity, "mean", motion=motion, **place) == pytest.approx(
            row[quantity] / factor, rel=1e-4
        )
        keys = ["case", "analysis", "building", "storey", "cases.connected.stiffness", "impact.restitution"]
        same = rows[(rows[keys] == [row[key] for key in keys]).all(axis=1)][quantity] / factor
        for kind, number in (("mean", same.mean()), ("low", same.min()), ("high", same.max())):
            assert read_explored(drawn, quantity, kind, motion=0, **place) == pytest.approx(number, rel=1e-4)


def test_the_explorer_has_the_links_of_each_floor(solved):
    """Fails if the closing is that of another floor or case, or void runs are told of another point."""
    results = solved("maps")
    drawn = widgets.build_explorer_data(results, find_nominal(results))
    (found,) = [each for each in drawn["quantities"] if each["key"] == "max_closing"]
    assert (found["label"], found["where"], found["level"]) == ("largest closing [mm]", "pair", "floor")
    assert found["places"] == ["stiff | soft"]
    means = results.link().groupby(["case", "analysis", "floor", "cases.connected.stiffness", "impact.restitution"])
    for (case, analysis, floor, stiffness, restitution), closing in (1e3 * means["max_closing"].mean()).items():
        place = {
            "case": drawn["cases"].index(case),
            "analysis": drawn["analyses"].index(analysis),
            "place": 0,
            "level": found["levels"].index(floor),
            "axis0": drawn["axes"][0]["values"].index(round(1e-6 * stiffness, 9)),
            "axis1": drawn["axes"][1]["values"].index(restitution),
        }
        assert read_explored(drawn, "max_closing", "mean", motion=0, **place) == pytest.approx(closing, rel=1e-4)
    void = find_void(results)
    drawn_void = np.reshape(drawn["void"], (3, 2, 3, 2))
    for place in np.ndindex(drawn_void.shape):
        case, analysis, stiffness, restitution = place
        where = (
            CASES[case],
            drawn["analyses"][analysis],
            *(axis["values"][number] for axis, number in zip(drawn["axes"], (stiffness, restitution), strict=True)),
        )
        assert drawn_void[place] == void.get(where, 0)


def test_the_player_has_the_history_of_its_scene(solved):
    """Fails if floors, buildings or links are exchanged, or a yield drift is that of another storey."""
    results = solved("plain")
    (scene,) = widgets.build_player_scenes(results)
    history = results.history(case="connected", analysis="inelastic", record="taft")
    series = np.frombuffer(base64.b64decode(scene["series"]), dtype="<f4").reshape(-1, scene["count"])
    wanted = [history.ground_acceleration]
    wanted += [history.displacement[:, 0, floor] for floor in range(3)]
    wanted += [history.displacement[:, 1, floor] for floor in range(2)]
    wanted += [history.link_force[:, link] for link in range(2)]
    assert np.abs(history.link_force).max(axis=0).min() > 0
    assert len(series) == len(wanted)
    for drawn, number in zip(series, wanted, strict=True):
        assert drawn == pytest.approx(np.asarray(number, np.float32))
    assert scene["dt"] == pytest.approx(history.time[1])
    assert scene["acceleration"]["factor"] * 9.80665 == pytest.approx(
        1.0 if scene["acceleration"]["unit"] == "g" else 9.80665
    )
    buildings = results.table("buildings")
    for drawn in scene["buildings"]:
        rows = buildings[buildings["building"] == drawn["name"]]
        assert drawn["heights"] == pytest.approx(rows["height"].to_list())
        assert drawn["yield"] == pytest.approx((rows["yield_shear"] / rows["stiffness"]).to_list(), rel=1e-4)
        assert drawn["slab"] == pytest.approx(rows["slab"].iloc[0])
    links = results.link().query("case == 'connected' and analysis == 'inelastic' and record == 'taft'")
    assert [link["floor"] for link in scene["links"]] == links["floor"].to_list()
    assert [link["right_floor"] for link in scene["links"]] == links["right_floor"].to_list()
    assert {(link["left"], link["right"], link["drawn"]) for link in scene["links"]} == {(0, 1, "bar")}
    assert [link["damper"] for link in scene["links"]] == [False, False]  # connectors
    assert {name for name in link_laws() if is_damper(name)} == {"damper", "maxwell", "viscous"}
    assert [link["gap"] for link in scene["links"]] == pytest.approx(links["gap"].to_list())

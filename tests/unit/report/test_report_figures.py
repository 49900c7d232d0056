"""The figures: what is drawn is what the tables say, and no text stands on another."""

from __future__ import annotations

from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from pounding_cli.errors import InputError
from pounding_cli.report import figures, inset
from pounding_cli.report.evidence import points
from pounding_cli.report.style import caption, looks, new_figure, save
from tests.helpers.figures import assert_no_overlap, panels
from tests.helpers.report_tables import CASES, make

ALL = tuple(CASES)
FOUR = {"report": {"plot": ["touching", "gap", "infill", "connected"]}}


def test_response_draws_mean_and_extremes_of_every_case():
    figure = figures.response(points(make())[0], "stiff")
    elastic, inelastic = panels(figure)
    means = {line.get_label(): line for line in elastic.containers}
    assert set(means) == set(CASES) - {"infill_1_10", "infill_1_100"}
    data, _, bars = means["gap"].lines
    storeys = np.arange(1, 6)
    np.testing.assert_allclose(data.get_xdata(), 1.2 * (1 + 0.02 * (storeys - 3)), rtol=1e-12)
    np.testing.assert_allclose(data.get_ydata(), storeys, atol=0.1)
    whisker = bars[0].get_segments()[2][:, 0]  # storey 3: the motions run from 0.92 to 1.12 of the mean
    np.testing.assert_allclose(whisker, [1.2 * 0.92, 1.2 * 1.12], rtol=1e-12)
    inelastic_gap = next(c for c in inelastic.containers if c.get_label() == "gap").lines[0]
    np.testing.assert_allclose(inelastic_gap.get_xdata()[2], 1.2 * 1.2, rtol=1e-12)
    assert list(elastic.get_yticks()) == [1, 2, 3, 4, 5]


def test_plot_of_the_study_chooses_the_cases_and_small_multiples_show_all():
    evidence = points(make(cases=ALL, resolved=FOUR))[0]
    drawn = [c.get_label() for c in panels(figures.response(evidence, "stiff"))[0].containers]
    assert drawn == FOUR["report"]["plot"]
    many = figures.small_multiples(evidence, "stiff")
    assert [ax.get_title(loc="left") for ax in panels(many)] == [*ALL, *ALL]
    assert "stiff-cases" in figures.draw_all(evidence)
    assert "stiff-cases" not in figures.draw_all(points(make())[0])


def test_building_of_the_study_comes_first():
    assert next(iter(figures.draw_all(points(make())[0]))) == "stiff-response"
    chosen = make(resolved={"report": {"building": "soft"}})
    assert next(iter(figures.draw_all(points(chosen)[0]))) == "soft-response"


def test_group_drawing_fills_the_plotted_building_only():
    figure = figures.response(points(make(group=("soft-1", "stiff", "soft-2"), storeys={"soft-2": 3}))[0], "stiff")
    blocks = figure.axes[0].patches
    assert len(blocks) == 13
    filled = {round(block.get_x(), 2) for block in blocks if block.get_facecolor()[:3] == (0, 0, 0)}
    assert len(filled) == 1
    assert sum(block.get_facecolor()[:3] == (0, 0, 0) for block in blocks) == 5
    labels = [text.get_text() for text in figure.axes[0].texts]
    assert labels == ["T = 0.60 s", "T = 0.36 s", "T = 0.60 s"]


def test_accelerations_are_drawn_over_alone_and_over_touching():
    axes = panels(figures.accelerations(points(make())[0], "stiff"))
    assert len(axes) == 4
    over_alone = {c.get_label(): c.lines[0].get_xdata()[0] for c in axes[0].containers}
    over_touching = {c.get_label(): c.lines[0].get_xdata()[0] for c in axes[2].containers}
    assert over_alone["infill"] == pytest.approx(2.0)
    assert over_touching["infill"] == pytest.approx(2 / 12)
    assert "touching" not in over_touching


def test_connectors_on_floors_apart_are_not_joined_by_a_line():
    axes = panels(figures.link_forces(points(make())[0]))
    lines = {c.get_label(): c.lines[0] for c in axes[0].containers}
    assert lines["connected"].get_linestyle() == "None"
    np.testing.assert_allclose(lines["connected"].get_ydata(), [3, 5], atol=0.1)
    # 12 MN a floor touching, motions from 1.0 to 1.4 of it: mean 1.2.
    np.testing.assert_allclose(lines["touching"].get_xdata(), 12 * 1.2 * np.arange(1, 6), rtol=1e-12)


@pytest.mark.parametrize(
    ("sources", "words"),
    [
        ({}, "stand-in motions"),
        ({"taft": "real"}, "real: taft; stand-in: elcentro, eureka, olympia, parkfield"),
    ],
)
def test_every_figure_says_which_motions_it_stands_on(sources, words):
    evidence = points(make(cases=ALL, sources=sources))[0]
    for figure in figures.draw_all(evidence).values():
        assert words in figure.get_supxlabel().replace("\n", " ")


@pytest.mark.parametrize(
    "results",
    [
        make(cases=ALL, sources={"taft": "real"}),
        make(group=("soft-1", "stiff", "soft-2"), storeys={"soft-2": 3}),
        make(storeys={"stiff": 20}),
    ],
    ids=["six cases", "three buildings", "twenty storeys"],
)
def test_no_text_stands_on_another(results):
    evidence = points(results)[0]
    for figure in figures.draw_all(evidence).values():
        assert_no_overlap(figure)


def test_cases_differ_in_colour_marker_and_line_together():
    given = looks([*ALL, "one", "two"])
    assert len({look.color for look in given.values()}) == 8
    assert len({look.marker for look in given.values()}) == 8
    assert given["touching"] == looks(["touching"])["touching"]


def test_colours_of_the_four_cases_are_apart_in_grey():
    rgb = [np.array(mpl.colors.to_rgb(look.color)) for look in looks(ALL[:4]).values()]
    grey = sorted(float(colour @ [0.2126, 0.7152, 0.0722]) for colour in rgb)
    assert min(np.diff(grey)) > 0.07


def test_saving_gives_all_formats_and_the_same_bytes_again(tmp_path):
    evidence = points(make())[0]
    first, second = (save({"a": figures.response(evidence, "stiff")}, tmp_path / name) for name in ("one", "two"))
    assert [path.suffix for path in first] == [".png", ".svg", ".pdf"]
    for one, two in zip(first, second, strict=True):
        assert one.stat().st_size > 5000
        assert one.read_bytes() == two.read_bytes()


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(InputError, match="cannot write the report") as refused:
        save({}, tmp_path / "taken")
    assert "-o FOLDER" in refused.value.problems[0].hint


def test_figures_of_an_analysis_of_which_no_run_ended_have_an_empty_panel():
    results = make(cases=ALL)
    for frame, columns in ((results.storey(), ["V_ratio", "mu_ratio"]), (results.floor(), ["acceleration_ratio"])):
        frame.loc[frame["analysis"] == "elastic", columns] = np.nan
    lost, drawn = panels(figures.response(points(results)[0], "stiff"))
    assert lost.containers == []
    assert len(drawn.containers) == len(ALL)
    assert set(figures.draw_all(points(results)[0])) >= {"stiff-response", "stiff-accelerations", "stiff-cases"}


def test_a_case_whose_numbers_mean_nothing_is_grey_and_explained():
    results = make(cases=ALL)
    scene = results.scene()
    here = (scene["case"] == "connected") & (scene["analysis"] == "elastic") & (scene["record"] == "taft")
    scene.loc[here, "flags"] = (
        "connector closes more than the gap, so the floors would have struck: stiff | soft, floor 5, by 3 mm"
    )
    evidence = points(results)[0]
    for name, figure in figures.draw_all(evidence).items():
        words = figure.get_supxlabel().replace("\n", " ")
        assert "† connected, elastic, 1 of 5 scenes (taft): connector closes more than the gap" in words, name
        assert_no_overlap(figure)
    response = figures.response(evidence, "stiff")
    legend = [text.get_text() for ax in response.axes if ax.get_legend() for text in ax.get_legend().get_texts()]
    assert "connected †" in legend
    assert "gap" in legend
    elastic, inelastic = ({c.get_label(): c.lines[0].get_color() for c in ax.containers} for ax in panels(response))
    assert elastic["connected"] == "0.6"
    assert elastic["gap"] == inelastic["gap"] != "0.6"
    assert inelastic["connected"] != "0.6"


@pytest.mark.parametrize("title", [r"$\frac{1}$", "$$", "5 $ and 6 $_"])
def test_a_title_that_is_no_formula_is_shown_as_it_is(tmp_path, title):
    figure = Figure()
    figure.suptitle(title)
    assert [path.name for path in save({"drawn": figure}, tmp_path, ["png"])] == ["drawn.png"]
    assert figure.get_suptitle() == title


def test_storeys_of_several_heights_are_drawn_to_one_scale():
    """With the points where slabs strike columns. Fails if a storey has the height of another, or a point stands on the
    wrong side or at a floor."""
    heights = {"low": [3.0, 3.0], "high": [4.0, 2.0, 3.0]}
    rows = [(name, n + 1, h) for name, own in heights.items() for n, h in enumerate(own)]
    storeys = pd.DataFrame(rows, columns=["building", "storey", "height"]).assign(V=1.0, slab=0.3)
    link = {"link": "x", "left": "low", "right": "high", "floor": 1, "right_floor": 1, "left_at": 1.0, "right_at": 0.75}
    evidence = SimpleNamespace(
        storey=storeys, buildings=storeys, group=("low", "high"), periods={"low": 0.3, "high": 0.5},
        link=pd.DataFrame([link]),
    )  # fmt: skip
    ax = Figure().add_subplot()
    inset.draw_group(ax, evidence, ("high",))
    blocks = [patch for patch in ax.patches if patch.get_linewidth() > 0]
    scale = inset.STOREY / 3.0  # of the mean storey
    assert [block.get_height() / scale for block in blocks] == pytest.approx([3, 3, 4, 2, 3])
    assert len(ax.patches) - len(blocks) == 5
    ((x, y),) = ax.lines[0].get_xydata()
    assert (x, y / scale) == pytest.approx((inset.WIDTH + inset.SPACE, 3.0))


@pytest.mark.parametrize("width", [3.0, 5.5, 12.0])
@pytest.mark.parametrize("text", ["Of the motions, 90 % pass MMMM and WWW. " * 6, "m" * 300, "iii lll. " * 40])
def test_a_caption_fits_its_figure(text, width):
    """Fails if wide letters make a line longer than the figure."""
    figure = new_figure(width, 2.0)
    caption(figure, text)
    figure.draw_without_rendering()
    box = figure.findobj(lambda each: getattr(each, "get_text", str)().startswith(text[:3]))[0].get_window_extent()
    assert 0 < box.x0 < box.x1 < figure.bbox.width

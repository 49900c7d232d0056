"""The page on costs says what was measured, and what measures is itself right."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

from pounding_cli.kernels import plain_step
from pounding_cli.study import expand, load_study

from . import batch, growth, modal, page, removal, sampling, scenes, sweep


@pytest.mark.parametrize("name", [*page.tables(page.read())])
def test_page_says_what_was_kept(name):
    """Every table on the page is made from the kept file. Fails if either is changed by hand."""
    begin, end = page.marks(name)
    shown = page.PAGE.read_text(encoding="utf-8").partition(begin)[2].partition(end)[0]
    assert shown.strip("\n") == page.tables(page.read())[name]


def test_slope_and_verdict():
    """Times of 3 n^1.3. Fails if the slope is that of the last two values or the verdict is turned round."""
    values = np.array([5.0, 10.0, 40.0])
    found = growth.judged(values, list(3 * values**1.3), 1.31, False)
    assert found["slope"] == pytest.approx(1.3, rel=1e-12)
    assert found["met"]
    assert not growth.judged(values, list(3 * values**1.3), 1.29, False)["met"]
    assert not growth.judged(values, [1.0, 9.0, 4.1], 4.0, True)["met"]


def test_three_peers_of_a_building_alone_agree():
    """Filters, scipy's simulation and steps in numpy. Fails if one holds the ground between samples."""
    scene = scenes.touching("elastic").alone(0)
    expected = modal.filtered(scene, 2)()
    for march in (modal.simulated, modal.stepped):
        for mine, theirs in zip(march(scene, 2)(), expected, strict=True):
            assert mine == pytest.approx(theirs, rel=1e-9)


def test_peaks_of_the_peers_come_nearer_with_finer_points():
    """To those between the samples, as the square of the distance. Fails if the peers solve another building."""
    from pounding_cli.solve import solve

    scene = scenes.touching("elastic").alone(0)
    exact = scenes.shears(solve(scene, 1e-9))
    coarse, fine = (scenes.error(modal.filtered(scene, parts)()[0], exact) for parts in (2, 32))
    assert fine < 1e-5
    assert fine < coarse / 30


def test_the_study_of_a_sweep_is_sound(tmp_path):
    """Fails if a key of the study is refused or an axis has another length."""
    study = tmp_path / "sweep.yaml"
    study.write_text(sweep.STUDY.format(first=sweep.numbers(0.3, 0.7, 3), second=sweep.numbers(0.0, 0.04, 4)))
    assert len(expand(load_study(study)).rows) == 12


def test_the_study_of_a_batch_is_sound(tmp_path):
    """Fails if a key of the study is refused or scenes are missing: 20 periods must give the 3,726 of the page."""
    study = tmp_path / "batch.yaml"
    study.write_text(batch.study_text(20, "none"))
    assert len(expand(load_study(study)).scenes) == 3726


def test_what_a_batch_costs_a_scene():
    """Fails if the solver's time counts as overhead, if overhead counts as estimates, or if workers are mixed up."""
    rows = [
        {"estimate": estimate, "workers": workers, "scenes": 10, "solver": 2.0, "core": core, "wall": wall}
        for estimate, workers, core, wall in (
            ("none", 1, 3.0, 3.0), ("none", 2, 4.0, 2.0), ("all", 1, 9.0, 9.0), ("all", 2, 9.5, 6.0)
        )
    ]  # fmt: skip
    found = batch.parts(rows)
    assert (found["solver"], found["overhead"], found["estimates"]) == pytest.approx((0.2, 0.1, 0.6))
    assert found["default_over_none"] == pytest.approx(3.0)
    assert found["two_workers"] == pytest.approx({"none": 1.5, "all": 1.5})


def test_what_is_left_out_is_in_the_kernel():
    """Fails if a part of the kernel has another name by now: then the profile has to follow."""
    for functions in removal.PARTS.values():
        assert all(hasattr(plain_step, name) for name in functions), functions


def test_what_is_sampled_is_in_the_kernel():
    """Fails if a function moved or has another name by now: then its time would be counted elsewhere."""
    for starts in sampling.GROUPS.values():
        for module, _, name in (start.partition(".") for start in starts):
            functions = vars(importlib.import_module(f"pounding_cli.kernels.{module}"))
            assert any(function.startswith(name) for function in functions), (module, name)

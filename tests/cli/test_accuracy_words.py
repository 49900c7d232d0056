"""`pound accuracy`: the method named, the costs of the others, tables at three widths, the data of the diagram."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

from pounding_cli.methods import METHODS
from pounding_cli.questions.accuracy import Measurement, build_report
from pounding_cli.questions.accuracy.figures import LOOKS, MIN_ERROR, draw_errors
from pounding_cli.questions.accuracy.tables import ERRORS
from pounding_cli.questions.accuracy.words import describe_cheapest, list_notes, list_sentences, list_tables
from pounding_cli.solver.work_precision import QUANTITIES, WorkPrecision

PLACES = [
    {"case": case, "analysis": "elastic", "record": record}
    for case in ("touching", "gap")
    for record in ("elcentro", "taft")
]
"""The time histories."""


def run(place: dict[str, str], method: str, setting: float, **numbers: Any) -> dict[str, Any]:
    """A run as `measure` has it."""
    errors = {f"error_{quantity}": numbers.pop("error", 1e-6) for quantity in QUANTITIES}
    usual = {
        "status": "done", "seconds": 2e-3, "seconds_noise": 0.0, "steps": 10, "events": 1, "impacts": 3,
        "impacts_reference": 3, "energy_residual": 1e-9, "advice": "",
    }  # fmt: skip
    return {**place, "method": method, "setting": setting, **usual, **errors, **numbers}


def measured(runs: list[dict[str, Any]], references: int = len(PLACES), impacts: int = 0) -> Measurement:
    """A measurement with these runs, of whose time histories so many have a reference."""
    agreed = {quantity: (number + 1) * 1e-12 for number, quantity in enumerate(QUANTITIES)} | {"impacts": impacts}
    return Measurement("t", "pound accuracy t.yaml", WorkPrecision(runs, [p | agreed for p in PLACES[:references]], []))


def settings(**costs: tuple[float, float, float]) -> pd.DataFrame:
    """A row a method: setting, seconds, error; solved on one time history."""
    rows = [
        {"method": method.replace("_", "-"), "setting": setting, "seconds": seconds, "seconds_noise": 0.0,
         "error": error, "solved": 1}
        for method, (setting, seconds, error) in costs.items()
    ]  # fmt: skip
    return pd.DataFrame(rows)


@pytest.mark.parametrize(
    ("costs", "wanted", "sentence"),
    [
        (
            {"taylor": (1e-6, 2e-3, 1e-7), "dop853": (1e-6, 8e-3, 1e-7), "newmark": (1e-3, 9e-3, 0.5)},
            1e-2,
            "For an error of at most 1 % use taylor with accuracy 1e-06: 2.00 ms per time history. The others: dop853 "
            "8.00 ms (1e-06). Not reached by newmark down to time step 0.001 s.",
        ),
        (
            {"taylor": (1e-6, 8e-3, 1e-7), "dop853": (1e-6, 2e-3, 1e-7), "newmark": (1e-3, 9e-3, 0.5)},
            1e-2,
            "For an error of at most 1 % use dop853 with accuracy 1e-06: 2.00 ms per time history. The others: taylor "
            "8.00 ms (1e-06). Not reached by newmark down to time step 0.001 s.",
        ),
        (
            {"taylor": (1e-6, 8e-3, 1e-2), "newmark": (1e-3, 2e-3, 1e-7)},
            1e-4,
            "For an error of at most 0.01 % use newmark with time step 0.001 s: 2.00 ms per time history. Not reached "
            "by taylor down to accuracy 1e-06.",
        ),
        (
            {"taylor": (1e-6, 8e-3, 0.5)},
            1e-3,
            "For an error of at most 0.1 %: no setting that was tried reaches it on every time history.",
        ),
    ],
)
def test_the_cheapest_method_is_named(costs, wanted, sentence):
    """The second is the mirror image of the first. Fails if the dearer or the less accurate one is named."""
    assert describe_cheapest(settings(**costs), wanted, 1) == sentence


def test_a_method_is_not_reached_down_to_the_finest_setting_of_all_time_histories():
    """Fails if a setting that the budget left out on one time history, or the coarsest, is named."""
    frame = settings(taylor=(1e-6, 2e-3, 1e-7), newmark=(1e-3, 1e-3, 0.5)).assign(solved=2)
    finer = [frame.iloc[[1]].assign(setting=step, solved=solved) for step, solved in ((1e-4, 2), (1e-5, 1))]
    told = describe_cheapest(pd.concat([frame, *finer]), 1e-3, 2)
    assert told.endswith("Not reached by newmark down to time step 0.0001 s.")
    told = describe_cheapest(pd.concat([frame.iloc[[0]], finer[1]]), 1e-3, 2)
    assert told.endswith("Not reached by newmark down to time step 1e-05 s.")


def test_a_setting_that_failed_somewhere_is_not_named():
    runs = [run(place, "taylor", 1e-6, seconds=4e-3) for place in PLACES]
    runs += [run(place, "newmark", 1e-3, seconds=1e-3) for place in PLACES[:3]]
    lost = {"status": "no root", "advice": "take a shorter step", "impacts": np.nan}
    runs.append(run(PLACES[3], "newmark", 1e-3, error=np.nan, seconds=1e-4, **lost))
    measurement = measured(runs)
    sentences = list_sentences(measurement)
    assert [text.partition(" use ")[0] for text in sentences] == [
        f"For an error of at most {each} %" for each in ("1", "0.1", "0.01")
    ]
    assert all("use taylor" in text and "Not reached by newmark" in text for text in sentences)
    notes = "\n".join(list_notes(measurement))
    assert "Failed: newmark at 0.001 s: no root on 1 time history (take a shorter step)." in notes
    shown, every = list_tables(measurement)
    cells = {row[0]: row[1:] for row in shown.cells()}
    assert cells["taylor"][:5] == ["1e-06", "4.000", "1.0×10⁻⁶", "4", "0"]
    assert cells["newmark"][:5] == ["0.001 s", "1.000", "1.0×10⁻⁶", "3, 1 failed", "0"]  # of those solved alone
    assert list(every.frame["status"]).count("no root") == 1


def test_time_histories_with_other_impacts_are_counted():
    runs = [run(place, "taylor", 1e-6, impacts=3 + (place["record"] == "taft")) for place in PLACES]
    shown, _ = list_tables(measured(runs))
    assert shown.frame["miscounted"].tolist() == [2]
    assert "whose impact count differs from the reference" in " ".join(list_notes(measured(runs)))


@pytest.mark.parametrize(
    ("impacts", "words"), [(0, "the impact counts agree"), (1, "the impact counts differ in 4 time histories")]
)
def test_how_well_the_reference_is_known(impacts, words):
    (note,) = [text for text in list_notes(measured([], impacts=impacts)) if text.startswith("Reference: ")]
    differences = "storey shear 1.0×10⁻¹², ductility 2.0×10⁻¹², floor acceleration 3.0×10⁻¹², link force 4.0×10⁻¹²"
    assert note.endswith(f"at most: {differences}; {words}.")


def test_no_reference_at_all_is_said():
    """Fails with a traceback if a measurement without runs is not foreseen."""
    report = build_report(measured([], references=0))
    assert report.answer.sentences == ["No method can be judged: the reference failed on every time history."]
    assert "No time history has a reference." in report.answer.notes
    assert report.sections[0].pictures == []


@pytest.mark.parametrize("width", [80, 120, 200])
def test_the_table_of_methods_fits_the_terminal(width):
    """Fails if a heading is cut, or a column that is left out goes without a word."""
    runs = [run(place, method, 1e-4, error=3.2e-8) for place in PLACES for method in METHODS]
    shown, _ = list_tables(measured(runs))
    text = shown.to_text(width)
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    for head in shown.heads():
        assert head in " ".join(text.split())


def test_errors_are_drawn_against_time_in_milliseconds():
    """Columns are cases, rows quantities; a point is the mean time and the largest error over the motions. Fails if a
    quantity, a case or a method stands in the place of another."""
    runs = []
    for number, place in enumerate(PLACES):
        for method, factor in (("taylor", 1.0), ("newmark", 10.0)):
            for setting in (1e-2, 1e-4):
                seconds = factor * (1 + number) * 1e-3
                row = run(place, method, setting, seconds=seconds)
                errors = {name: factor * setting * (1 + q) * (1 + number) for q, name in enumerate(ERRORS)}
                runs.append(row | errors)
    runs.append(run(PLACES[0], "dop853", 1e-2, status="no end", error=np.nan))
    runs.append(run(PLACES[0], "central-difference", 1e-3, error=1e-20))
    figure = draw_errors(measured(runs), "elastic")
    axes = np.array(figure.axes).reshape(len(ERRORS), 2)
    assert [ax.get_title() for ax in axes[0]] == ["touching", "gap"]
    assert [ax.get_ylabel() for ax in axes[:, 0]] == [f"error of {label}" for label in ERRORS.values()]
    assert {ax.get_xlabel() for ax in axes[-1]} == {"time per time history [ms]"}
    assert {(ax.get_xscale(), ax.get_yscale()) for ax in axes.flat} == {("log", "log")}
    for column, (mean, largest) in enumerate([(1.5, 2), (3.5, 4)]):  # of the runs of both motions
        for q in range(len(ERRORS)):
            lines = {line.get_label(): line for line in axes[q, column].lines}
            assert set(lines) == {METHODS[name].title for name in ("taylor", "newmark")} | (
                {METHODS["central-difference"].title} if column == 0 else set()
            )  # that which did not end is not drawn
            for method, factor in (("taylor", 1.0), ("newmark", 10.0)):
                line = lines[METHODS[method].title]
                np.testing.assert_allclose(line.get_xdata(), [factor * mean] * 2)
                np.testing.assert_allclose(line.get_ydata(), factor * largest * (1 + q) * np.array([1e-2, 1e-4]))
                assert (line.get_color(), line.get_marker()) == (LOOKS[method].color, LOOKS[method].marker)
            (grey,) = axes[q, column].patches
            assert grey.get_y() + grey.get_height() == pytest.approx((1 + q) * 1e-12)
    rounding = {line.get_label(): line for line in axes[0, 0].lines}[METHODS["central-difference"].title]
    assert rounding.get_ydata() == [MIN_ERROR]

"""The first sentences of `pound run`: which building gains, which loses, by how much, where, and when there is none.

The solver is replaced: every response with links is that of the building alone times a factor.
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from pounding_cli import open_results
from tests.adapter import Connector, response

STUDY = """\
title: Words
records: {use: [{file: weak.txt}, {file: strong.txt}], duration: whole, scale: 1.0}
buildings:
  low: {storeys: 2, period: 0.3 s, height: 3 m}
  high: {storeys: 2, period: 0.5 s, height: 3 m}
group: [low, high]
cases: {touching: {link: pounding, gap: 1 cm}}
analyses: [elastic]
estimate: none
"""

APART = STUDY.replace("0.5 s", "0.52 s")
"""Buildings of their own, as neighbours that never meet are solved once for all studies that a process runs."""

Factors = dict[str, list[list[float]]]


def solver(factors: Factors, impacts: float = 3.0, **changes):
    """Return a solver by which pounding multiplies shears and ductilities.

    factors : building -> under the weak and the strong motion, storey by storey
    changes : further fields of responses with links
    """

    def solve(scene, accuracy=1e-6, method="taylor", **_):
        storeys = tuple(building.storeys for building in scene.buildings)
        count = len(scene.links)
        peaks = response.no_peaks(storeys, count)
        for name in (*response.STOREYS, *response.LINKS):
            peaks[name] = 1.0
        peaks["displacement_min"], peaks["residual_drift"] = -1.0, 0.0
        is_strong = scene.motion.pga > 2
        for place, building in enumerate(scene.buildings):
            factor = np.array(factors.get(building.name, [[1.0], [1.0]])[is_strong]) if count else 1.0
            for name in ("shear", "ductility"):
                peaks[name][place] = 2.0 * factor
        peaks["impacts"], peaks["peak_force"] = impacts, 1e5 * (impacts > 0)
        peaks["max_closing"] = 1.0 if impacts else 0.006 if is_strong else 0.004
        closings = peaks["max_closing"]
        made = response.Response(peaks, storeys, "done", "", "taylor", accuracy, 1, 1, 1e-4, closing_to_rest=closings)
        return replace(made, **changes) if count else made

    return solve


def answer_of(pound, factors: Factors, study: str = STUDY, **options) -> str:
    """The sentences of a run, in one line."""
    from pathlib import Path

    Path("two.yaml").write_text(study)
    _, out, err = pound("run", "two.yaml", "-o", "r.h5", "--replace", solve=solver(factors, **options))
    assert "Traceback" not in err
    lines = out.splitlines()
    end = next((place for place, line in enumerate(lines) if line.startswith("Peak responses")), len(lines))
    return " ".join(" ".join(lines[1:end]).split())


UP = {"low": [[1.1, 1.0], [1.5, 1.0]], "high": [[0.9, 0.8], [0.7, 0.6]]}
DOWN = {name: [[1 / value for value in row] for row in rows] for name, rows in UP.items()}
SWAPPED = {"low": UP["high"], "high": UP["low"]}


@pytest.mark.parametrize(
    ("factors", "sentences"),
    [
        (
            UP,
            [
                "Case touching raises the elastic storey shears of low by up to 30 % (storey 1, mean of 2 motions; "
                "largest 50 %, strong).",
                "Case touching lowers the elastic storey shears of high by up to 30 % (mean of 2 motions; no motion "
                "raises them).",
            ],
        ),
        (
            DOWN,
            [
                "Case touching lowers the elastic storey shears of low by up to 21 % (mean of 2 motions; no motion "
                "raises them).",
                "Case touching raises the elastic storey shears of high by up to 46 % (storey 2, mean of 2 motions; "
                "largest 67 %, strong).",
            ],
        ),
        (
            SWAPPED,
            [
                "Case touching lowers the elastic storey shears of low by up to 30 %",
                "Case touching raises the elastic storey shears of high by up to 30 % (storey 1, mean of 2 motions; "
                "largest 50 %, strong).",
            ],
        ),
        (
            {"low": [[0.6, 1.0], [1.2, 1.0]]},
            [
                "lowers the elastic storey shears of low by up to 10 % (mean of 2 motions; but largest rise 20 %, "
                "storey 1, strong)"
            ],
        ),
        (
            {"low": [[1.0, 3.0], [1.0, 2.2]]},
            [
                "raises the elastic storey shears of low up to 2.6-fold (storey 2, mean of 2 motions; largest 3-fold, "
                "weak)."
            ],
        ),
        (
            {"low": [[1.0, 1.001], [1.0, 1.002]]},
            ["Case touching changes the elastic storey shears of low by less than 0.5 %."],
        ),
    ],
)  # fmt: skip
def test_a_rise_is_no_fall_and_the_number_is_that_of_the_table(pound, folder, factors, sentences):
    """Two results that are mirror images: alone and with pounding swapped, or the buildings."""
    answer = answer_of(pound, factors)
    for sentence in sentences:
        assert sentence in answer


def test_elastic_is_told_by_shears_and_inelastic_by_ductilities(pound, folder):
    answer = answer_of(pound, UP, STUDY.replace("[elastic]", "[elastic, inelastic]"))
    assert "raises the elastic storey shears of low by up to 30 %" in answer
    assert "raises the ductility demands of low by up to 30 %" in answer
    answer = answer_of(pound, UP, STUDY.replace("[elastic]", "[inelastic]"))
    assert "storey shears" not in answer
    assert "lowers the ductility demands of high by up to 30 %" in answer


def test_one_motion_has_no_mean(pound, folder):
    answer = answer_of(pound, UP, STUDY.replace("{file: weak.txt}, ", ""))
    assert "Case touching raises the elastic storey shears of low by up to 50 % (storey 1)." in answer
    assert "lowers the elastic storey shears of high by up to 40 % (by 30 % or more in every storey)." in answer
    assert "mean" not in answer


def test_the_main_building_comes_first(pound, folder):
    assert answer_of(pound, UP).index("of low") < answer_of(pound, UP).index("of high")
    answer = answer_of(pound, UP, STUDY + "report: {building: high}\n")
    assert answer.index("of high") < answer.index("of low")


def test_floors_that_never_touch(pound, folder):
    answer = answer_of(pound, {}, APART, impacts=0.0)
    assert answer == (
        "The floors never touch: every building responds as it does alone. The closest approach closes 0.6 cm of a gap "
        "of 1 cm (case touching, low|high floor 1, strong)."
    )


def test_a_case_without_links_is_alone(pound, folder):
    study = APART.replace("touching: {link: pounding, gap: 1 cm}", "free: {link: none}")
    assert "no link" in answer_of(pound, {}, study, impacts=0.0).lower()


def test_the_case_that_changes_most_comes_first(pound, folder):
    """Cases by their gap: the wider, the larger the factor."""

    def solve(scene, accuracy=1e-6, method="taylor", **more):
        factor = 1.0 + 10 * scene.links[0].gap if scene.links else 1.0
        return solver({"low": [[factor, 1.0]] * 2, "high": [[1 / factor, 1.0]] * 2})(scene, accuracy, method, **more)

    gaps = {"a": 1, "b": 4, "c": 2, "d": 3, "e": 5, "f": 6}
    for count, low, high in (
        (
            3,
            "Case b raises the elastic storey shears of low by up to 40 % (storey 1, mean of 2 motions; largest 40 %, "
            "weak), c by up to 20 %, a by up to 10 %.",
            "Case b lowers the elastic storey shears of high by up to 29 % (mean of 2 motions; no motion raises them), "
            "c by up to 17 %, a by up to 9.1 %.",
        ),
        (6, "largest 60 %, weak), 5 others by 10 % (a) to 50 % (e).", "5 others by 9.1 % (a) to 33 % (e)."),
    ):
        cases = ", ".join(f"{name}: {{link: pounding, gap: {gap} cm}}" for name, gap in list(gaps.items())[:count])
        study = STUDY.replace("touching: {link: pounding, gap: 1 cm}", cases)
        (folder / "two.yaml").write_text(study)
        answer = " ".join(pound("run", "two.yaml", "-o", "r.h5", "--replace", solve=solve)[1].split())
        assert low in answer
        assert high in answer


def test_the_case_that_is_best_for_the_worse_building_comes_first(pound, folder):
    """The wider the gap, the better for low and the worse for high; of d the numbers mean nothing."""
    beyond = response.Flag("struck", "connector of low | high, floor 1, by 3 mm")
    overloaded = response.Flag("columns", "low storey 1, 2 times, by a blow")
    factors = {0.01: (1.6, 1.1), 0.02: (1.3, 1.2), 0.03: (1.0, 1.25), 0.04: (0.5, 0.5)}

    def solve(scene, accuracy=1e-6, method="taylor", **more):
        gap = round(scene.links[0].gap, 3) if scene.links else 0.0
        low, high = factors.get(gap, (1.0, 1.0))
        made = solver({"low": [[low, 1.0]] * 2, "high": [[1.0, high]] * 2})(scene, accuracy, method, **more)
        flags = {0.03: (overloaded,), 0.04: (beyond,)}.get(gap, ())
        return replace(made, flags=flags) if scene.links else made

    cases = "a: {link: pounding, gap: 1 cm}, b: {link: pounding, gap: 2 cm}, c: {link: pounding, gap: 3 cm}, "
    cases += "d: {link: connector, gap: 4 cm, stiffness: 1 kN/mm}"
    study = STUDY.replace("touching: {link: pounding, gap: 1 cm}", cases).replace("[elastic]", "[elastic, inelastic]")
    (folder / "two.yaml").write_text(study)
    out = pound("run", "two.yaml", solve=solve)[1]
    answer = " ".join(out.split())
    details = "(high, storey 2; flagged: columns overloaded; next b, {}; last a, {})"
    ratios = details.format("1.30", "1.60")
    assert answer.startswith(
        f"Words Case c is best for the worse building by elastic mean V/V₀ 1.25 {ratios}, inelastic mean μ/μ₀ 1.25 "
        f"{ratios}, inelastic mean μ 2.50 {details.format('2.60', '3.20')}."
    )
    means = open_results("results/two.h5").storey("mu").query("analysis == 'inelastic' and case == 'b'")
    largest = means.groupby(["building", "storey"])["mu"].mean().groupby("building").max()
    for name in ("low", "high"):
        row = re.search(rf"^ b +{name} .*$", out, re.MULTILINE)
        assert float(row[0].split()[-2]) == largest[name]


def test_at_a_point_of_a_sweep(pound, folder):
    """The rise grows with the gap: the answer is about the first value, and the sweep about the last."""

    def solve(scene, accuracy=1e-6, method="taylor", **more):
        factor = 1.0 + 10 * scene.links[0].gap if scene.links else 1.0
        return solver({"low": [[factor, 1.0]] * 2})(scene, accuracy, method, **more)

    (folder / "two.yaml").write_text(STUDY + "sweep: {cases.touching.gap: [1 cm, 3 cm, 5 cm]}\n")
    answer = " ".join(pound("run", "two.yaml", solve=solve)[1].split())
    assert "At cases.touching.gap = 1 cm: case touching raises the elastic storey shears of low by up to 10 %" in answer
    assert (
        "Over the sweep the elastic storey shears of low rise most at cases.touching.gap = 5 cm: by up to 50 % (case "
        "touching, storey 1, mean of 2 motions)."
    ) in answer

    def falling(scene, accuracy=1e-6, method="taylor", **more):
        return solver({"low": [[0.5, 0.9]] * 2})(scene, accuracy, method, **more)

    answer = " ".join(pound("run", "two.yaml", "-o", "falling.h5", solve=falling)[1].split())
    assert "Nowhere in the sweep do the elastic storey shears of low rise." in answer


def test_a_sweep_of_another_case_is_no_place_of_a_case(pound, folder):
    """Fails if a case that the sweep leaves as it is has its largest response at a point of it, or counts its motions
    once a point."""

    def solve(scene, accuracy=1e-6, method="taylor", **more):
        factor = {0: 1.0, 0.01: 1.4}.get(round(scene.links[0].gap, 4) if scene.links else 0, 1.2)
        return solver({"low": [[factor, 1.0]] * 2})(scene, accuracy, method, **more)

    other = STUDY.replace("gap: 1 cm}", "gap: 1 cm}, wide: {link: pounding, gap: 2 cm}")
    (folder / "two.yaml").write_text(other + "sweep: {cases.wide.gap: [2 cm, 3 cm, 5 cm]}\n")
    answer = " ".join(pound("run", "two.yaml", solve=solve)[1].split())
    assert (
        "the elastic storey shears of low rise most in case touching, which the sweep does not change: by up to 40 % "
        "(storey 1, mean of 2 motions)."
    ) in answer
    peaks = answer.partition("Peak responses")[2].partition("Ratios to")[0]
    touching, wide = peaks.partition(" wide elastic ")[::2]
    assert "of 2 time histories, gap 1 cm" in touching
    assert "gap of wide = " not in touching
    assert "of 6 time histories" in wide
    assert "gap of wide = " in wide


def test_nothing_solved_and_some_failed(pound, folder):
    answer = answer_of(pound, UP, status="stalled")
    assert answer.startswith("All time histories failed: there is no result to show.")
    assert "touching raises" not in answer


def test_collapses_come_first_with_and_without_pounding(pound, folder):
    study = STUDY.replace("height: 3 m}\ngroup", "height: 3 m, collapse: 10 %}\ngroup").replace("elastic", "inelastic")
    usual = solver(UP)

    def solve(scene, accuracy=1e-6, method="taylor", **more):
        made = usual(scene, accuracy, method, **more)
        if not scene.links:
            return made
        made.peaks["collapse_storey"], made.peaks["collapse_time"] = (0.0, 1.0), 0.2
        return replace(made, status="collapsed", flags=(response.Flag("collapse", "high storey 1, at 0.2 s", -0.2),))

    (folder / "two.yaml").write_text(study)
    answer = " ".join(pound("run", "two.yaml", solve=solve)[1].split())
    assert answer.startswith(
        "Words high collapses (inelastic; of 2 motions) under 2 in case touching, and under 0 alone"
    )
    assert "responds as it does alone" not in answer


def test_numbers_without_meaning_are_told(pound, folder):
    flag = response.Flag("struck", "connector of low | high, floor 1, by 3 mm")
    study = STUDY.replace("cases: {", "cases: {joined: {link: connector, gap: 1 cm, stiffness: 1 kN/mm}, ")
    (folder / "two.yaml").write_text(study)
    usual = solver(UP)

    def solve(scene, accuracy=1e-6, method="taylor", **more):
        made = usual(scene, accuracy, method, **more)
        is_joined = bool(scene.links) and isinstance(scene.links[0].law, Connector)
        return replace(made, flags=(flag,)) if is_joined else made

    out = " ".join(pound("run", "two.yaml", solve=solve)[1].split())
    assert f"† Case joined, elastic: the numbers mean nothing under 2 of 2 motions, as {flag.title}." in out
    assert "joined raises" not in out
    assert "Case touching raises the elastic storey shears of low by up to 30 %" in out


def test_a_wall_has_no_sentence(pound, folder):
    study = STUDY.replace("group: [low, high]", "  rock: {wall: fixed}\ngroup: [rock, high]")
    answer = answer_of(pound, UP, study)
    assert "of rock" not in answer


def test_an_acceleration_of_a_blow_is_marked_and_explained(pound, folder):
    out = pound_output(pound, impacts=3.0)
    assert "0.102 *" in out
    assert "* Floor accelerations and link forces of floors that strike" in out
    (folder / "two.yaml").write_text(APART)
    out = pound_output(pound, impacts=0.0)
    assert "0.102 *" not in out
    assert "* Floor accelerations" not in out


def pound_output(pound, impacts: float) -> str:
    return pound("run", "two.yaml", "-o", "r.h5", "--replace", solve=solver({}, impacts=impacts))[1]


@pytest.mark.parametrize(("ductility", "is_beyond"), [(4.9, False), (5.1, True)])
def test_a_ductility_far_beyond_the_law_is_marked(pound, folder, ductility, is_beyond):
    study = STUDY.replace("[elastic]", "[inelastic]")
    (folder / "two.yaml").write_text(study)
    factors = {"high": [[ductility, 1.0]] * 2}
    out = pound("run", "two.yaml", solve=solver(factors))[1]
    assert (f"{2 * ductility:#.3g} ‡ (alone 2.00)" in out) == is_beyond
    assert ("far beyond the range of the storey law: read it as failure" in out) == is_beyond


def test_a_case_without_links_beside_others_is_not_compared(pound, folder):
    answer = answer_of(pound, UP, STUDY.replace("cases: {", "cases: {free: {link: none}, "))
    assert "free" not in answer
    assert "Case touching raises the elastic storey shears of low by up to 30 %" in answer

"""Every flag of a time history: a study that raises it and one that does not, in the table and in what is printed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pounding_cli import open_results
from pounding_cli.api.running import run_study
from pounding_cli.api.studies import load_study
from pounding_cli.laws import link_laws
from pounding_cli.laws.formula import WRITTEN_LAWS
from pounding_cli.notes import NOTES
from pounding_cli.questions.run import Run
from pounding_cli.solver import estimate as estimates
from pounding_cli.solver import solve as solver

STUDY = """\
title: Flags
records: {use: [elcentro], duration: 3 s}
buildings:
  stiff: {storeys: 2, period: 0.3 s, height: 3 m, columns: 20 %}
  soft: {like: stiff, period: 0.5 s}
group: [stiff, soft]
cases:
  one: CASE
analyses: [inelastic]
estimate: none
residual_drift: true
"""
WIDE = "{link: pounding, gap: 50 cm}"
TOUCHING = "{link: pounding, gap: 0 cm}"


SOLVE_ALL = solver.solve_all


def joint(law: str, gap: str, keys: str = "") -> str:
    return f"{{link: {law}, gap: {gap}{', ' + keys if keys else ''}}}"


def written(acts: str, gap: str) -> str:
    laws = f"laws: {{own: {{force: k*v, parameters: {{k: 1 kN/m}}, acts: {acts}}}}}\n"
    return f"{{link: own, gap: {gap}}}\nLAWS{laws}"


def beside(gap: str, *links: str) -> str:
    return f"{{gap: {gap}, links: [{', '.join(links)}]}}"


SOFT_INFILL = "{link: infill, stiffness: 10 kN/m}"
CONNECTOR = "{link: connector, stiffness: 10 kN/m}"

KINDS: dict[str, tuple[str, str, str, bool]] = {
    "infill": (
        "crushed", joint("infill", "1 mm", "stiffness: 10 kN/m"), joint("infill", "50 cm", "stiffness: 10 kN/m"), False,
    ),
    "infill beside a striking link": (
        "crushed", beside("1 mm", SOFT_INFILL, "pounding"), beside("50 cm", SOFT_INFILL, "pounding"), False,
    ),
    "connector": (
        "struck", joint("connector", "1 mm", "stiffness: 10 kN/m"),
        joint("connector", "50 cm", "stiffness: 10 kN/m"), True,
    ),
    "connector beside a striking link": (
        "struck", joint("connector", "1 mm", "stiffness: 10 kN/m"), beside("1 mm", CONNECTOR, "pounding"), True,
    ),
    "connector beside a link that strikes at another floor": (
        "struck",
        beside("1 mm", "{link: connector, stiffness: 10 kN/m, floors: [1]}", "{link: pounding, floors: [2]}"),
        beside("50 cm", "{link: connector, stiffness: 10 kN/m, floors: [1]}", "{link: pounding, floors: [2]}"), True,
    ),
    "connector between floors of different heights": (
        "struck",
        joint("connector", "1 mm", "stiffness: 10 kN/m, floors: [[1, 2]], distance: 2 m"),
        beside("1 mm", "{link: connector, stiffness: 10 kN/m, floors: [[1, 2]], distance: 2 m}", "pounding"), True,
    ),
    "damper": (
        "struck",
        joint("damper", "1 mm", "damping_coefficient: 1 kN s/m"),
        joint("damper", "50 cm", "damping_coefficient: 1 kN s/m"),
        True,
    ),
    "viscous": (
        "struck",
        joint("viscous", "1 mm", "force_at_1_m_s: 1 kN, exponent: 0.5"),
        joint("viscous", "50 cm", "force_at_1_m_s: 1 kN, exponent: 0.5"), True,
    ),
    "maxwell": (
        "struck",
        joint("maxwell", "1 mm", "damping_coefficient: 1 kN s/m"),
        joint("maxwell", "50 cm", "damping_coefficient: 1 kN s/m"),
        True,
    ),
    "friction": (
        "struck",
        joint("friction", "1 mm", "slip_force: 1 kN"), joint("friction", "50 cm", "slip_force: 1 kN"), True,
    ),
    "material of the study": (
        "crushed", written("compression", "1 mm"), written("compression", "50 cm"), False,
    ),
    "joint of the study": (
        "struck", written("always", "1 mm"), written("always", "50 cm"), True,
    ),
    "passing floors": (
        "passing",
        "{link: pounding, gap: 0 cm, stiffness: 1 N/m}\nMORErecords.scale: {pga: 9 g}", TOUCHING, False,
    ),
}  # fmt: skip
"""Flag of a link -> its code, a case that raises it, one that does not, and whether it takes all meaning."""


def write_study(case: str, **changes: str) -> Path:
    """Write a study of one case; after the case may stand laws of the study."""
    case, _, laws = case.partition("\nLAWS")
    case, _, more = case.partition("\nMORE")
    text = STUDY.replace("CASE", case) + laws
    if more:
        text = text.replace("duration: 3 s}", "duration: 3 s, scale: {pga: 9 g}}")
    for before, after in changes.items():
        assert before.replace("_", " ") in text
        text = text.replace(before.replace("_", " "), after)
    Path("two.yaml").write_text(text)
    return Path("two.yaml")


def check_flag(pound, code: str, *, is_raised: bool, meaningless: bool = False) -> None:
    """Run the study, and check the flag in the table and in what is printed."""
    exit_code, out, err = pound("run", "two.yaml", "-o", "r.h5", "--replace")
    assert exit_code in (0, 1), err
    flagged = open_results("r.h5").flagged()
    rows = flagged[flagged["code"] == code]
    assert (len(rows) > 0) == is_raised, flagged.to_string()
    assert (f"[{code}]" in out) == is_raised
    assert (NOTES[code].title in " ".join(out.split())) == is_raised
    assert set(rows["meaningless"]) <= {meaningless}
    if is_raised:
        word = "Not meaningful (†): " if meaningless else ""
        assert f"[{code}] {word}one, inelastic" in out


@pytest.mark.parametrize("kind", KINDS)
def test_flags_of_links(pound, folder, kind):
    flag, raising, quiet, meaningless = KINDS[kind]
    write_study(raising)
    check_flag(pound, flag, is_raised=True, meaningless=meaningless)
    write_study(quiet)
    check_flag(pound, flag, is_raised=False)


def test_every_flag_of_a_law_has_a_row_here():
    flags = {name: law.beyond_gap for name, law in {**link_laws(), **WRITTEN_LAWS}.items() if law.beyond_gap}
    told = {"compression": "material of the study", "always": "joint of the study"}
    assert flags == {name: KINDS[told.get(name, name)][0] for name in flags}


ISOLATION = "foundation: {mass: 200 t, isolation: {radius: 3.1 m, friction: 6 %, capacity: CAPACITY}}"


@pytest.mark.parametrize(
    ("flag", "raising", "quiet"),
    [
        (
            "isolators",
            {"period:_0.5_s": f"period: 0.5 s, {ISOLATION.replace('CAPACITY', '1 mm')}"},
            {"period:_0.5_s": f"period: 0.5 s, {ISOLATION.replace('CAPACITY', '90 cm')}"},
        ),
        ("collapse", {"columns:_20_%": "collapse: 0.1 %"}, {"columns:_20_%": "collapse: 90 %"}),
        (
            "baseline",
            {"period:_0.5_s": "period: 0.5 s, collapse: 0.1 %"},
            {"period:_0.5_s": "period: 0.5 s, collapse: 90 %"},
        ),
        ("residual-drift", {"columns:_20_%": "damping: 0 %"}, {"columns:_20_%": "damping: 5 %"}),
    ],
)
def test_flags_of_buildings(pound, folder, flag, raising, quiet):
    write_study(WIDE, **raising)
    check_flag(pound, flag, is_raised=True)
    write_study(WIDE, **quiet)
    check_flag(pound, flag, is_raised=False)


def test_columns_overloaded_by_a_blow(pound, folder):
    heights = {"period:_0.5_s": "period: 0.5 s, height: [2 m, 3 m]"}
    write_study(TOUCHING, **heights)
    check_flag(pound, "columns", is_raised=True)
    write_study(WIDE, **heights)
    check_flag(pound, "columns", is_raised=False)


def edited_solver(edit):
    """Return a solver whose responses are changed by `edit(scene, response, accuracy)`."""

    def solve(scene, accuracy=1e-6, method="taylor", **settings):
        return edit(scene, SOLVE_ALL([scene], accuracy, method, **settings)[0], accuracy)

    return solve


@pytest.mark.parametrize(
    ("flag", "status", "names"),
    [
        ("soft alone: stalled", "stalled", ()),
        ("V0 = 0", "done", ("shear",)),
        ("mu0 = 0", "done", ("ductility",)),
        ("acceleration0 = 0", "done", ("acceleration",)),
    ],
)
def test_flags_of_buildings_alone_that_give_no_ratio(pound, folder, flag, status, names):
    """The solver of `soft` by itself fails, or gives a building that does not move."""

    def edit(scene, response, accuracy):
        if scene.links or scene.buildings[0].name != "soft":
            return response
        peaks = response.peaks.copy()
        for name in names:
            peaks[name][:] = 0.0
        return replace(response, status=status, peaks=peaks)

    write_study(WIDE)
    code, out, _ = pound("run", "two.yaml", "-o", "raised.h5", solve=edited_solver(edit))
    assert code == (status != "done")
    flagged = open_results("raised.h5").flagged()
    assert flag in set(flagged["detail"])
    assert flag in " ".join(out.split())
    code, out, _ = pound(
        "run", "two.yaml", "-o", "quiet.h5", solve=edited_solver(lambda scene, response, accuracy: response)
    )
    assert flag not in set(open_results("quiet.h5").flagged()["detail"])


@pytest.mark.parametrize("is_raised", [True, False])
def test_a_time_history_that_is_solved_once_more_is_flagged(pound, folder, monkeypatch, is_raised):
    """The solver fails at the accuracy asked and comes to an end at a finer one. Fails if nobody is told."""
    usual = solver.solve_all

    def solve_all(scenes, accuracy, method, **settings):
        responses = usual(scenes, accuracy, method, **settings)
        if accuracy < 1e-7 or not is_raised:
            return responses
        return [replace(each, status="stalled") for each in responses]

    class FinerRun(Run):
        @property
        def plan(self):
            return replace(super().plan, harder=True)

    monkeypatch.setattr(solver, "solve_all", solve_all)
    outcome = run_study(FinerRun(load_study(write_study(WIDE))), Path("r.h5"), engine="serial")
    assert not outcome.failures
    flagged = outcome.results.flagged()
    again = flagged[flagged["code"] == "retried"]
    assert (len(again) == 1) == is_raised
    assert set(again["detail"]) <= {"stalled at first"}


@pytest.mark.parametrize(
    ("flag", "constants"),
    [
        ("sensitive", {"ILL_CONDITIONED": 0.0}),
        ("error", {"find_difference": lambda one, other: 1e-3}),
        ("no-error", {"find_difference": lambda one, other: np.nan}),
    ],
)
def test_flags_of_the_estimate(pound, folder, monkeypatch, flag, constants):
    write_study(TOUCHING, **{"estimate:_none": "estimate: all"})
    check_flag(pound, flag, is_raised=False)
    for name, value in constants.items():
        monkeypatch.setattr(estimates, name, value)
    Path("r.h5.cache").unlink()
    check_flag(pound, flag, is_raised=True)


def test_time_steps_that_are_cut_in_half(pound, folder):
    steps = {"estimate:_none": "estimate: none\nmethod: newmark\ntime_step: 2 ms"}
    write_study(TOUCHING, **steps, **{"storeys:_2": "storeys: 3", "duration:_3_s": "duration: 5 s"})
    check_flag(pound, "halved-steps", is_raised=True)
    write_study(WIDE, **steps)
    check_flag(pound, "halved-steps", is_raised=False)

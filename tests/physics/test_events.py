"""Where runs go wrong first: contacts that begin, graze or coincide, peaks between steps, parameters at their ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import pounding_cli as pound
from tests.adapter import Scene, difference, solve
from tests.hard.random_scenes import random_scene
from tests.physics.cases import CAPPED, IMPACT, PINCHED, ROCK, SWAY, formula, shake
from tests.physics.test_closed_forms import M1, M2, REDUCED, still, storey
from tests.reference.closed_forms import kelvin_voigt

POUNDING = {"link": "pounding", "gap": 0.0}
FIXED_STEPS = "newmark", "central-difference"
TO_COLUMNS = {"link": "damper", "damping_coefficient": 1e6, "floors": [[2, "1 + 40 %"]], "distance": 2.0}


def pair(case: Mapping[str, Any] = POUNDING, ground: np.ndarray | None = None, **keys: Any) -> Scene:
    """Two buildings of three storeys."""
    common = {"storeys": 3, "yield": {"overstrength": 2.0}} | keys.pop("building", {})
    buildings = [common | {"period": 0.36}, common | {"period": 0.60}]
    usual = {"analysis": "elastic", "more": {"impact": IMPACT}} | keys
    return Scene(buildings, shake(0.8) if ground is None else ground, 0.02, case, **usual)


def test_a_blow_within_one_step_of_the_motion() -> None:
    """A slow swing reaches the gap half-way between two samples, 0.2 s apart, and would be back before the second.
    Fails if contact is looked for at the ends of steps."""
    swing, omega, xi, stiff = 0.05, 2 * math.pi, 0.2154538, 2e15
    case = {"link": "pounding", "gap": 0.9 * swing}
    scene = Scene(
        (storey(M1, M1 * omega**2), storey(M2, 1e-3)), np.zeros(4), 0.2, case,
        more={"impact": {"stiffness": stiff, "damping_ratio": xi}}, start=([[-swing], [0.0]], [[0.0], [0.0]]),
    )  # fmt: skip
    run = solve(scene, 1e-9)
    blow = kelvin_voigt(stiff, xi, REDUCED, swing * omega * math.sqrt(1 - 0.9**2))
    assert run.impacts.tolist() == [1]
    assert run.peak_force[0] == pytest.approx(blow.peak_force, rel=1e-3)


def test_a_gap_that_never_closes_never_presses() -> None:
    """Two swings of equal frequency, one of them at rest, 0.1 mm short of the gap. Fails if the gap is ignored."""
    two, case = (storey(M1, M1 * 400.0), storey(M2, M2 * 400.0)), {"link": "pounding", "gap": 0.0301}
    run = solve(Scene(two, case=case, start=([[0.0], [0.0]], [[0.6], [0.0]]), **still(1.0)), 1e-12)
    assert run.max_closing[0] == pytest.approx(0.03, rel=1e-10)
    assert run.impacts.tolist() == run.peak_force.tolist() == run.contact_time.tolist() == [0.0]


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("push", [1.0, -1.0])
def test_floors_in_touch_press_from_the_start_or_not_at_all(push: float, accuracy: float) -> None:
    """Fifth floors at rest close by a t^12 to begin with: lost in the last digits of their displacements for
    milliseconds. Fails if contact begins where a double first tells it."""
    tower = {"storeys": 5, "mass": 2e5, "rayleigh": {"alpha": 0.0, "beta": 0.0}}
    two = tower | {"stiffness": [8e8] * 5}, tower | {"stiffness": [2e8] * 5}
    run = solve(Scene(two, np.full(21, push), 1e-3, POUNDING | {"floors": [5]}), accuracy)
    assert run.contact_time[0] == pytest.approx(0.02 if push > 0 else 0.0, rel=1e-12)
    assert run.peak_force[0] > 0 or push < 0
    assert run.impacts.tolist() == [1.0 if push > 0 else 0.0]


def test_floors_in_touch_count_contacts_that_are_no_rounding() -> None:
    """Nearly rigid links between five floors in touch: in the first milliseconds they press and part by less than
    1e-20 m. Accuracies that round otherwise count the same contacts. Fails if such partings count."""
    row = [{"storeys": 5, "period": period, "rayleigh": {"alpha": 0.5, "beta": 0.002}} for period in (0.36, 0.60)]
    impact = {"impact": {"stiffness": "5000 x stiffest storey", "restitution": 0.9}}
    counts = [
        solve(Scene(row, shake(0.3), 0.02, POUNDING, analysis="elastic", more=impact), accuracy).impacts.tolist()
        for accuracy in (1e-8, 1e-9, 1e-10, 1e-11)
    ]
    assert counts[0] == counts[1] == counts[2] == counts[3]


def test_floors_in_touch_that_part_inside_a_step_have_not_pressed_since_the_start() -> None:
    """A random scene whose floors part and meet again within its first step. Fails if the time that they are apart
    counts as contact."""
    scene, _ = random_scene(1534)
    coarse, fine = solve(scene, 1e-6), solve(scene, 1e-12)
    assert coarse.contact_time == pytest.approx(fine.contact_time, rel=1e-5)
    assert coarse.impacts.tolist() == fine.impacts.tolist()


@pytest.mark.parametrize("foundation", ["fixed", SWAY | ROCK], ids=["fixed", "moving"])
@pytest.mark.parametrize("analysis", ["elastic", "inelastic"])
@pytest.mark.parametrize("link", ["pounding", "hertz", "infill"])
def test_identical_buildings_never_press(link: str, analysis: str, foundation: Any) -> None:
    """In touch, and equal to the last bit. Fails if a building rounds otherwise than its neighbour."""
    building = {"storeys": 5, "period": 0.36, "foundation": foundation}
    case = {"link": link, "gap": 0.05 if link == "infill" else 0.0}
    case |= {"hertz_stiffness": 2e9} if link == "hertz" else {}
    linked = solve(Scene([building] * 2, shake(1.5), 0.02, case, analysis), 1e-9)
    alone = solve(Scene([building], shake(1.5), 0.02, {}, analysis), 1e-9)
    for found, of_one in ((linked.shear, alone.shear), (linked.drift, alone.drift)):
        assert found[: of_one.size].tolist() == found[of_one.size :].tolist()
        assert found == pytest.approx(np.tile(of_one, 2), rel=1e-12)  # another kernel may round otherwise
    assert linked.peak_force.tolist() == linked.impulse.tolist() == [0.0] * 5


def test_events_at_one_instant() -> None:
    """Equal buildings on both sides of a third yield and strike at the same instants, or all but. Fails if steps of
    1e-17 s between them leave false peaks, or one of the events is lost."""
    kinds = {"storeys": 3, "period": 0.60}, {"storeys": 3, "period": 0.36}
    scene = Scene([kinds[i % 2] for i in range(3)], shake(1.2, 6.0), 0.02, POUNDING, "inelastic", {"impact": IMPACT})
    coarse, fine = solve(scene, 1e-6), solve(scene, 1e-11)
    assert difference(coarse, fine) <= 1e-6
    assert coarse.impacts.tolist() == fine.impacts.tolist()
    assert abs(fine.energy["residual"]) < 1e-12


def test_a_thousand_times_as_heavy() -> None:
    """Same drifts, forces x 1000. Fails if a dashpot goes as s sqrt(m'), or a tolerance is in newtons."""

    def scaled(by: float) -> Scene:
        base = {name: value * by for name, value in (SWAY | ROCK).items()}
        building = {"mass": 2e5 * by, "foundation": base, "yield_shear": [3e6 * by, 2e6 * by, 1e6 * by], "storeys": 3}
        impact = {"impact": {"stiffness": 2e10 * by, "restitution": 0.5}}
        two = building | {"period": 0.36}, building | {"period": 0.60}
        return Scene(two, shake(0.8), 0.02, POUNDING, "inelastic", impact)

    light, heavy = solve(scaled(1.0), 1e-12), solve(scaled(1000.0), 1e-12)
    assert heavy.shear == pytest.approx(1000 * light.shear, rel=1e-9)
    assert heavy.peak_force == pytest.approx(1000 * light.peak_force, rel=1e-8)
    for name in ("ductility", "acceleration", "displacement_max", "contact_time"):
        assert getattr(heavy, name) == pytest.approx(getattr(light, name), rel=1e-9), name


@pytest.mark.parametrize("case", [POUNDING, {"link": "connector", "gap": 0.05, "stiffness": 1.5e8}])
def test_elastic_buildings_in_touch_are_linear_in_the_motion(case: Mapping[str, Any]) -> None:
    """Fails if contact needs more than v > 0."""
    one, two = (solve(pair(case, times * shake(0.8)), 1e-12) for times in (1.0, 2.0))
    assert two.shear == pytest.approx(2 * one.shear, rel=1e-9)
    assert two.acceleration == pytest.approx(2 * one.acceleration, rel=1e-9)
    assert two.impacts.tolist() == one.impacts.tolist()


def test_links_side_by_side_add_up() -> None:
    """Two springs are as stiff as their sum. Fails if a floor keeps one of its links."""
    halves = {"gap": 0.05, "links": [{"link": "connector", "stiffness": k, "damping_ratio": 0.0} for k in (3e7, 5e7)]}
    whole = {"gap": 0.05, "link": "connector", "stiffness": 8e7, "damping_ratio": 0.0}
    one, two = (solve(pair(case, analysis="inelastic"), 1e-12) for case in (halves, whole))
    assert difference(one, two, ("shear", "drift", "acceleration", "residual_drift")) < 1e-9
    assert one.peak_force[::2] + one.peak_force[1::2] == pytest.approx(two.peak_force, rel=1e-9)


def test_peaks_under_a_ramp() -> None:
    """Undamped under a_g = s t from rest: u = -s (t - sin(w t) / w) / w^2, total acceleration s (t - sin(w t) / w). Its
    largest speed lies within the one sample. Fails if peaks are those at samples."""
    omega, slope, t = 40.0, 3.0, 0.3
    one = storey(2e5, 2e5 * omega**2)
    run = solve(Scene((one,), slope * np.array([0.0, t]), t, tail=0.5), 1e-12)
    u = -slope * (t - math.sin(omega * t) / omega) / omega**2
    v = -slope * (1 - math.cos(omega * t)) / omega**2
    reach = math.hypot(u, v / omega)  # free vibration in the tail
    assert run.displacement_max[0] == pytest.approx(reach, rel=1e-10)
    assert run.displacement_min[0] == pytest.approx(-max(reach, -u), rel=1e-10)
    assert run.drift[0] * 2e5 * omega**2 == pytest.approx(run.shear[0], rel=1e-12)


@pytest.mark.parametrize("case", [POUNDING, {}], ids=["linked", "alone"])
def test_peaks_between_spikes(case: Mapping[str, Any]) -> None:
    """Samples that jump at random, 50 ms apart: the peaks are those of a history 500 times as fine. Fails if a turn
    between two samples is missed."""
    spikes = np.random.default_rng(5).normal(size=30) * 3.0
    spikes[0] = 0.0
    scene = replace(pair(case, spikes), dt=0.05)
    run, kept = solve(scene, 1e-10), pound.history(scene.built, every=1e-4, accuracy=1e-10)
    for name, over_time in (
        ("drift", np.abs(kept.drift)), ("acceleration", np.abs(kept.total_acceleration)),
        ("displacement_max", kept.displacement), ("shear", np.abs(kept.shear)),
    ):  # fmt: skip
        found, peak = over_time.max(axis=0).ravel(), getattr(run, name)
        assert (found <= peak * (1 + 1e-8)).all(), name
        assert found == pytest.approx(peak, rel=1e-3), name


def test_it_gives_back_what_it_took_in() -> None:
    """Undamped oscillators whose period is the time step of the motion are at rest again at every sample. Fails if what
    is missing is measured by what is left, which is next to nothing."""
    one = storey(2e5, 2e5 * (2 * math.pi / 0.02) ** 2)
    run = solve(Scene((one, one), shake(1.0), 0.02, POUNDING), 1e-9)
    assert run.status == "done"
    assert abs(run.energy["residual"]) < 1e-8


EXTREMES: dict[str, tuple[Mapping[str, Any], Mapping[str, Any]]] = {
    f"pounding {s:g}, e {e:g}{', cut' * cut}": (
        {"link": "pounding", "gap": gap, "tension_cut": cut}, {"impact": {"stiffness": s, "restitution": e}},
    )
    for s, e, gap, cut in (
        (1.0, 0.5, 0.0, False), (1e13, 0.5, 0.0, False), (2e9, 1.0, 0.0, False), (2e9, 0.01, 1e-3, True),
    )
} | {
    f"{law} {k:g}, e {e:g}": ({"link": law, "gap": gap, "hertz_stiffness": k, "restitution": e}, {})
    for law in ("hertz-damp", "jankowski")
    for k, e, gap in ((1e4, 0.5, 0.0), (1e14, 0.5, 1e-3), (2e9, 0.01, 0.0), (2e9, 1.0, 0.0), (2e9, 1 - 1e-9, 0.0))
} | {
    f"bilinear {k:g}, {depth:g} m, e {e:g}": (
        {"link": "bilinear", "gap": 0.0, "hertz_stiffness": k, "penetration": depth, "restitution": e}, {},
    )
    for k, depth, e in ((2e9, 2e-3, 1.0), (2e9, 1e-6, 0.5), (2e9, 0.1, 0.5), (1e14, 1e-4, 0.5), (2e9, 2e-3, 0.24))
} | {
    f"infill {d:g} m, {k:g} to {s:g}": (
        {"link": "infill", "gap": d, "stiffness": k}, {"impact": {"stiffness": s, "restitution": 0.5}},
    )
    for d, k, s in ((1e-5, 1.5e8, 2e10), (0.02, 1e8, 1.0001e8), (1e-3, 1e4, 1e13))
} | {
    f"{link} {sorted(keys.values())}": ({"links": ["pounding", {"link": link, **keys}], "gap": 0.0}, {})
    for link, keys in (
        ("connector", {"stiffness": 1e13}), ("damper", {"damping_coefficient": 1e9}),
        ("maxwell", {"stiffness": 1e4, "damping_coefficient": 1e9}),
        ("maxwell", {"stiffness": 1e12, "damping_coefficient": 1e9}),
        ("friction", {"stiffness": 1e12, "slip_force": 1e5}), ("friction", {"stiffness": 1e4, "slip_force": 1e9}),
        ("viscous", {"force_at_1_m_s": 1e5, "exponent": 0.3}), ("viscous", {"force_at_1_m_s": 1e7, "exponent": 0.999}),
    )
} | {
    "formula, soft to hard": (
        {"link": "own", "gap": 0.0}, formula("k*v + k3*v**3", "compression", k="1 N/m", k3="1e15 N/m^3"),
    ),
}  # fmt: skip


@pytest.mark.parametrize(("case", "more"), EXTREMES.values(), ids=EXTREMES)
def test_links_at_the_ends_of_their_ranges(case: Mapping[str, Any], more: Mapping[str, Any]) -> None:
    """Two accuracies agree and the energy closes. Fails if a branch is left and entered in a loop, or a parameter at
    its end is a division by zero."""
    scene = pair(case, shake(1.0, dt=0.04)[:26], analysis="inelastic", more=more or {"impact": IMPACT})
    coarse, fine = (solve(replace(scene, dt=0.04), a, bounds=(50_000, 50_000)) for a in (1e-6, 1e-10))
    assert coarse.status == fine.status == "done"
    assert abs(coarse.energy["residual"]) < 1e-8
    assert difference(coarse, fine, ("drift", "shear", "acceleration", "residual_drift")) <= 1e-6


IMK = CAPPED | {"storey_law": "imk-peak-oriented"}
HARD_STOREYS: dict[str, Mapping[str, Any]] = {
    "without hardening": {"hardening": 0.0},
    "hardly any strength": {"yield_shear": [1.0, 1.0, 1.0]},
    "imk, falls at once": IMK | {"capping_ductility": 1.0, "residual_strength": 0.0},
    "imk, a cliff": IMK | {"post_capping_slope": 1e6},
    "imk, spent at once": IMK | {
        f"{mode}_capacity": 0.01 for mode in ("strength", "capping", "unloading", "reloading")
    },
    "imk, pinched to nothing": CAPPED | PINCHED | {"storey_law": "imk-pinching", "pinching_force": 1e-3},
    "bouc-wen, sharp": {"storey_law": "bouc-wen", "wen_exponent": 20},
    "bouc-wen, one way": {"storey_law": "bouc-wen", "wen_exponent": 1, "wen_gamma": -1.0},
    "peak-oriented, hardly any strength": {"storey_law": "peak-oriented", "yield_shear": [1e3, 1e3, 1e3]},
    "p-delta, hardly any stiffness": {"p_delta": [1e8, 1e2, 1e2], "collapse": "never"},
}  # fmt: skip


@pytest.mark.parametrize("building", HARD_STOREYS.values(), ids=HARD_STOREYS)
def test_storeys_at_the_ends_of_their_ranges(building: Mapping[str, Any]) -> None:
    """Fails if a storey that yields from the first instant takes steps of its yield drift for ever, or one that has
    spent its energy stops a run."""
    scene = pair(analysis="inelastic")
    keys = [{k: v for k, v in b.items() if k != "yield" or "yield_shear" not in building} for b in scene.buildings]
    run = solve(replace(scene, buildings=[each | building for each in keys]), 1e-7, bounds=(300_000, 60_000))
    assert run.status == "done"
    assert abs(run.energy["residual"]) < 1e-8


@pytest.mark.parametrize("number", [number for number in range(24) if number not in (7, 9, 11, 15, 21, 22)])
def test_random_rows_know_their_error(number: int) -> None:
    """One to six buildings, from tame to hostile, but those that take a second. Fails if an estimate is ten times below
    the true error."""
    scene, accuracy = random_scene(number)
    run, truth = solve(scene, accuracy, estimate=True), solve(scene, 1e-12)
    if "done" not in (run.status, truth.status):
        assert run.status == truth.status
        return
    error = difference(run, truth)
    assert error <= max(10 * run.error, 0.1 * accuracy)
    assert run.error <= accuracy or run.flags


class TestCollapse:
    """A storey that comes down ends a run."""

    @staticmethod
    def falling(ground: np.ndarray, case: Mapping[str, Any], **more: Any) -> Scene:
        """A weak building beside a firm one."""
        weak = {"storeys": 3, "period": 0.9, "yield": {"overstrength": 0.4}, "p_delta": True, "hardening": 0.0}
        firm = {"storeys": 3, "period": 0.4, "yield": {"overstrength": 4.0}}
        scene = Scene([weak, firm], ground, 0.02, case, "inelastic", {"impact": IMPACT}, **more)
        return scene if case else replace(scene, buildings=[weak])

    @pytest.mark.parametrize("case", [{}, {"link": "pounding", "gap": 0.0}, {"link": "infill", "gap": 0.02}], ids=str)
    def test_two_accuracies_name_the_same(self, case: Mapping[str, Any]) -> None:
        """Fails if a contact keeps a collapse from being seen, or it is looked for at the ends of steps."""
        scene = self.falling(shake(6.0, 8.0, 3), case)
        coarse, fine = solve(scene, 1e-7, estimate=True), solve(scene, 1e-11)
        assert coarse.status == fine.status == "collapsed"
        assert coarse.place == fine.place
        assert coarse.place[0] == 0
        assert coarse.time == pytest.approx(fine.time, rel=1e-7)
        assert coarse.drift.max() == pytest.approx(0.3, rel=1e-9)
        assert difference(coarse, fine) <= max(10 * coarse.error, 1e-9)
        assert abs(fine.energy["residual"]) < 1e-11

    def test_in_the_first_step(self) -> None:
        """Fails if what is passed in the first step of all is seen in the second."""
        one = storey(yield_shear=[3e5], hardening=0.0, collapse=0.01)
        run = solve(Scene((one,), np.array([1e4, 1e4, 0.0]), 0.01, analysis="inelastic"), 1e-9)
        assert run.status == "collapsed"
        assert run.drift[0] == pytest.approx(0.03, rel=1e-10)
        assert 0 < run.time < 0.01

    def test_elastic_storeys_stand(self) -> None:
        """Fails if an elastic analysis ends so, or a passed drift is told where `collapse: never` is written."""
        scene = self.falling(shake(6.0, 8.0, 3), {})
        assert solve(replace(scene, analysis="elastic"), 1e-7).status == "done"
        never = [each | {"collapse": "never"} for each in scene.buildings]
        assert solve(replace(scene, buildings=never), 1e-7).status == "done"

    def test_chain_of_ten(self) -> None:
        """The last building of ten comes down. Fails if the others are run on, or back, to another time."""
        scene = self.falling(shake(6.0, 8.0, 3), {"link": "pounding", "gap": 0.02})
        weak, firm = scene.buildings
        ten = replace(scene, buildings=[weak if place == 9 else firm for place in range(10)])
        coarse, fine = solve(ten, 1e-7), solve(ten, 1e-10)
        assert coarse.status == fine.status == "collapsed"
        assert coarse.place == fine.place
        assert coarse.place[0] == 9
        assert difference(coarse, fine) < 1e-5

    def test_a_building_that_cannot_stand_is_refused(self) -> None:
        """Fails if a storey without stiffness under its weight, or a base that overturns, is run."""
        for keys in (
            {"p_delta": [2e7 * 3.0]},
            {"p_delta": [3e7], "foundation": {"inertia": 1e6, "rocking_stiffness": 1e7}},
        ):
            with pytest.raises(pound.InputError, match=r"stiffness|overturns"):
                assert Scene((storey(**keys),), np.zeros(3), 0.02).built


class TestFixedSteps:
    """Newmark and central differences."""

    @pytest.mark.parametrize("method", FIXED_STEPS)
    def test_second_order(self, method: str) -> None:
        """Where nothing jumps. Fails if beta or gamma is off, or the ground is held constant over a step."""
        case = {"link": "connector", "gap": 0.05, "stiffness": 1.5e8}
        scene = pair(case, shake(1.0), building={"foundation": SWAY | ROCK})
        exact, errors = solve(scene, 1e-12), []
        for parts in (32, 64, 128):
            run = solve(scene, method=method, time_step=0.02 / parts)
            errors.append(difference(run, exact, ("end", "end_velocity")))
        assert np.log2(errors[0] / errors[2]) / 2 == pytest.approx(2.0, abs=0.1)

    @pytest.mark.parametrize("method", FIXED_STEPS)
    @pytest.mark.parametrize(
        ("case", "building"),
        [
            (POUNDING, {}), ({"link": "infill", "gap": 0.01}, {}), (POUNDING, {"foundation": SWAY}),
            ({"link": "none"}, {"storey_law": "peak-oriented"}), ({"link": "none"}, {"p_delta": True}),
            ({"links": ["pounding", {"link": "damper", "damping_coefficient": 1e6}], "gap": 0.004}, {}),
            ({"links": ["pounding", TO_COLUMNS], "gap": 0.004}, {"columns": 0.2}),
            ({"link": "infill", "gap": 0.004, "law": "printed", "floors": [[2, "1 + 40 %"]]}, {"columns": 0.2}),
        ],
        ids=str,
    )  # fmt: skip
    def test_they_come_near(self, method: str, case: Mapping[str, Any], building: Mapping[str, Any]) -> None:
        """Fails if a method leaves out a link law, a gap, a foundation, P-Delta or a branch."""
        scene = pair(case, building=building, analysis="inelastic")
        exact, near = solve(scene, 1e-10), solve(scene, method=method, time_step=1e-5)
        assert near.status == "done"
        assert near.drift == pytest.approx(exact.drift, rel=5e-3)
        assert near.shear == pytest.approx(exact.shear, rel=5e-3)
        assert near.max_closing == pytest.approx(exact.max_closing, rel=5e-3, abs=2e-5)
        assert near.shear_below == pytest.approx(exact.shear_below, rel=5e-3)
        assert near.shear_above == pytest.approx(exact.shear_above, rel=5e-3)

    def test_stability(self) -> None:
        """A step above the limit, links closed, is not run, and one below what the advice says is. Fails if the limit
        forgets that links close."""
        scene = pair({"link": "pounding", "gap": 0.02}, more={"impact": {"stiffness": 2e12, "restitution": 0.5}})
        run = solve(scene, method="central-difference", time_step=0.02)
        assert run.status == "unstable step"
        assert np.isnan(run.shear).all()
        omega = math.sqrt(2e12 * 2 / 2e5)
        assert solve(scene, method="central-difference", time_step=1.0 / omega).status == "done"

    def test_a_matrix_without_an_inverse(self) -> None:
        """A spring that pushes floors apart takes from them just what their inertia and their storeys give in this
        step: M + h^2/4 K is singular to the last digit. Fails if that is an error of the program."""
        step, mass = 2.0**-6, 2.0**17
        pushed = formula("-k*v", "always", k=f"{4 * mass / step**2!r} N/m")
        two = [storey(mass, 4 * mass / step**2)] * 2
        ground = np.linspace(0.0, 1.0, 9)
        scene = Scene(
            two, ground, step, {"link": "own", "gap": 0.05}, more=pushed, start=([[0.01], [0.0]], [[0.0]] * 2)
        )
        run = solve(scene, method="newmark", time_step=step)
        assert run.status == "no root"
        assert np.isnan(run.shear).all()

    @pytest.mark.parametrize("settings", [
        {"method": "euler"}, {"method": "newmark"}, {"method": "newmark", "time_step": 0.0},
        {"method": "newmark", "time_step": math.nan}, {"method": "taylor", "time_step": 1e-4},
    ])  # fmt: skip
    def test_refused_settings(self, settings: Mapping[str, Any]) -> None:
        """A method that there is not, a step that is missing, too many, or no number above zero."""
        with pytest.raises(pound.InputError):
            solve(pair(), **settings)

"""Floors that twist, against an integrator of its own, closed forms, and the symmetries of their equations."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import minimize_scalar

from pounding_cli import Motion, Scene
from pounding_cli.laws.pounding import Pounding, damping_ratio
from pounding_cli.model.scene import Analysis
from pounding_cli.model.wall import Wall
from tests.adapter import Building, FloorPlan, Link, Run, solve
from tests.physics.cases import shake
from tests.physics.references import FIELDS, TWISTING, read
from tests.physics.twisting import DT, ROWS, building, line, referenced_scenes, soft, stiff
from tests.reference.closed_forms import kelvin_voigt
from tests.reference.exponential import march

SCENES = referenced_scenes()
STILL = np.zeros(6)
OF_FLOORS = "shear", "drift", "acceleration", "displacement_max", "displacement_min", "end", "end_velocity"
FREE = 1e-3
"""Stiffness of a line that does not hold a floor [N/m]."""


def lines_by_storey(scene: Scene, values: np.ndarray) -> np.ndarray:
    """Return values of the reference, line by line, storey by storey within each line, as `solve` has them."""
    found = []
    for each in scene.buildings:
        count = each.storeys * (1 if each.plan is None else len(each.plan.all_lines))
        if each.plan is not None:
            found.append(values[:count].reshape(-1, each.storeys).T.ravel())
        values = values[count:]
    return np.concatenate(found)


def values_of(run: Run) -> dict[str, np.ndarray]:
    """Return the numbers of a run by the names of FIELDS and TWISTING; those of a building without a plan left out."""
    edges = [run.edge_drift_low, run.edge_drift_high]
    values = {name: getattr(run, name) for name in FIELDS if name not in ("columns", "work")}
    values |= {
        "columns": np.ravel([run.shear_below, run.shear_above], "F"),
        "work": np.array([run.energy["input"], run.energy["damping"]]),
        "line_shear": run.line_shear,
        "line_drift": run.line_drift,
        "edge_drift": np.concatenate([edge[~np.isnan(edge)] for edge in edges]),
        "twist": run.twist[~np.isnan(run.twist)],
        "turns": run.end_twist,
        "turn_rate": run.end_twist_rate,
    }
    return values


@pytest.mark.parametrize("name", SCENES)
def test_agrees_with_an_independent_integrator(name: str) -> None:
    """Every peak of storeys, lines, edges, floors and links, the end, impulses, durations and counts. Fails on any
    other place, force, mass, branch or event."""
    scene, expected = SCENES[name](), read(f"twist; {name}")
    run = solve(scene, 1e-12)
    found = values_of(run)
    moves = np.concatenate([np.full(b.storeys, not isinstance(b, Wall) or b.moves) for b in scene.buildings])
    largest = max(np.abs(expected[field]).max() for field in ("displacement_max", "displacement_min"))
    for field in (*FIELDS, *TWISTING):
        wanted, own = expected[field], found[field]
        if field.startswith("line_"):
            wanted = lines_by_storey(scene, wanted)
        if field in OF_FLOORS:
            wanted, own = wanted[moves], own[moves]  # a wall that moves as the ground does has no numbers
        size = largest if field.startswith("displacement") else np.abs(wanted).max(initial=0.0)
        np.testing.assert_allclose(own, wanted, rtol=0, atol=1e-7 * size + 1e-14, err_msg=field)
    assert abs(run.energy["residual"]) < 1e-12


@pytest.mark.parametrize("name", ROWS)
def test_closes_its_energy(name: str) -> None:
    """At the usual accuracy; sinks only take. Fails if a dashpot, a line or the work of P-Delta is left out."""
    run = solve(SCENES[name](), 1e-6)
    assert run.status == "done"
    assert abs(run.energy["residual"]) < 1e-9
    assert min(run.energy[sink] for sink in ("damping", "hysteresis", "links")) >= -1e-9 * run.energy["input"]


def plate(name: str, mass: float, across: float, along: float, **more: np.ndarray) -> Building:
    """Return a rectangular floor that hardly anything holds."""
    lines = (line("1", -1.0, FREE, storeys=1), line("2", 1.0, FREE, storeys=1))
    inertia = np.array([mass * (across**2 + along**2) / 12])
    plan = FloorPlan(inertia, lines, np.array([FREE]), low=-across / 2, high=across / 2)
    return building(name, np.array([mass]), plan, alpha=0.0, beta=0.0, **more)


def run_from(scene: Scene, displacements: Sequence[Sequence[float]], rates: Sequence[Sequence[float]]) -> Run:
    """Return the run of a scene from these displacements and rates: floors, then rotations, a list a building."""
    start = [np.array(each, float) for each in displacements], [np.array(each, float) for each in rates]
    return solve(scene, 1e-12, initial=start)


def at_rest(buildings: Sequence[Building], links: Sequence[Link] = (), samples: np.ndarray = STILL) -> Scene:
    """Return a scene of elastic buildings on still ground, or on these accelerations at steps of DT."""
    motion = Motion("ground", DT, samples)
    return Scene(tuple(buildings), tuple(links), motion, Analysis.ELASTIC, residual_drift=False)


class TestBlows:
    """Of plates that nothing holds."""

    def test_plate_on_a_wall(self) -> None:
        """A plate of 200 t, 30 m by 20 m, struck 10 m off its centre at 0.5 m/s, restitution 0.5. Fails if a contact
        has another mass."""
        mass, speed, y, e = 2e5, 0.5, 10.0, 0.5
        inertia = mass * (30.0**2 + 20.0**2) / 12
        effective = 1 / (1 / mass + y**2 / inertia)
        contact_at = Link(0, 1, 1, Pounding(0.0, 2e9, damping_ratio(e)), left_y=y)
        scene = at_rest((plate("plate", mass, 30.0, 20.0), Wall.build("wall")), [contact_at])
        run = run_from(scene, [[0.0, 0.0], [0.0]], [[speed, 0.0], [0.0]])
        blow = kelvin_voigt(2e9, damping_ratio(e), effective, speed)
        assert (inertia, effective) == pytest.approx((21.67e6, 104.0e3), rel=2e-4)
        assert run.impacts.tolist() == [1]
        assert run.impulse == pytest.approx([(1 + e) * effective * speed], rel=1e-8)
        assert run.impulse == pytest.approx([78.0e3], rel=1e-4)
        assert run.contact_time == pytest.approx([blow.time], rel=1e-8)
        assert run.peak_force == pytest.approx([max(blow.peak_force, blow.pull)], rel=1e-8)
        assert run.max_closing == pytest.approx([blow.compression], rel=1e-8)
        turning = (1 + e) * effective * speed * y / inertia
        assert run.end_twist_rate == pytest.approx([turning], rel=1e-8)
        assert run.end_twist_rate == pytest.approx([0.0360], rel=1e-4)
        assert run.end_velocity[0] == pytest.approx(speed - (1 + e) * effective * speed / mass, rel=1e-8)
        assert run.end_velocity[0] == pytest.approx(0.11, rel=1e-3)
        assert run.energy["links"] == pytest.approx(effective * speed**2 * (1 - e**2) / 2, rel=1e-8)
        assert run.energy["links"] == pytest.approx(9.75e3, rel=1e-4)
        assert abs(run.energy["residual"]) < 1e-9

    @pytest.mark.parametrize(("e", "left_y", "right_y"), [(0.3, 6.0, -4.0), (0.65, -9.0, 0.0), (1.0, 2.5, 7.5)])
    def test_two_plates(self, e: float, left_y: float, right_y: float) -> None:
        """The places part at e times the speed at which they met; both momenta are kept. Fails if a place's lever has
        another sign on one side."""
        left, right = plate("left", 2e5, 20.0, 14.0), plate("right", 3e5, 18.0, 10.0)
        link = Link(0, 1, 1, Pounding(0.0, 2e9, damping_ratio(e)), left_y=left_y, right_y=right_y)
        rates = [0.4, 0.03], [-0.1, 0.02]
        run = run_from(at_rest((left, right), [link]), [[0.0, 0.0]] * 2, rates)
        before = (rates[0][0] - left_y * rates[0][1]) - (rates[1][0] - right_y * rates[1][1])
        assert before > 0
        u, turn = run.end_velocity, run.end_twist_rate
        after = (u[0] - left_y * turn[0]) - (u[1] - right_y * turn[1])
        assert after == pytest.approx(-e * before, rel=1e-8)
        masses = np.array([2e5, 3e5])
        inertias = np.array([left.plan.inertia[0], right.plan.inertia[0]])
        start = np.array(rates)
        assert masses @ u == pytest.approx(masses @ start[:, 0], rel=1e-8)
        centres = np.array([-left_y, -right_y])  # along the street, from the place where they meet

        def spin(rate: np.ndarray, turning: np.ndarray) -> float:
            return float(inertias @ turning - masses @ (rate * centres))

        assert spin(u, turn) == pytest.approx(spin(start[:, 0], start[:, 1]), rel=1e-8)
        assert abs(run.energy["residual"]) < 1e-9


M, K = 2e5, 8e7


def one_storey(ratio: float, eccentricity: float, damped: bool = False) -> tuple[Building, float]:
    """Return a storey of two lines, and the radius of gyration of its floor [m].

    ratio : of the frequencies of twist about the centre of mass and along the row, each without the other
    eccentricity : of the centre of stiffness over the radius of gyration
    """
    radius = math.sqrt((20.0**2 + 14.0**2) / 12)
    arm = 6.0
    share = 0.5 * (1 + eccentricity * radius / arm)
    lines = line("1", -arm, (1 - share) * K, storeys=1), line("2", arm, share * K, storeys=1)
    torsion = ratio**2 * K * radius**2 - K * arm**2
    assert torsion > 0
    plan = FloorPlan(np.array([M * radius**2]), lines, np.array([torsion]), low=-10.0, high=10.0)
    factors = {"alpha": 0.4, "beta": 2e-3} if damped else {"alpha": 0.0, "beta": 0.0}
    return building("storey", np.array([M]), plan, **factors), radius


class TestVibrations:
    """Of elastic buildings alone."""

    @pytest.mark.parametrize(("ratio", "eccentricity"), [*itertools.product((1.05, 1.2, 1.5), (0.05, 0.3, 0.5))])
    def test_eccentric_storey(self, ratio: float, eccentricity: float) -> None:
        """The system of the studies of torsional coupling (Kan & Chopra 1977, J. Struct. Div. ASCE 103(4), 805-819):
        (w_n / w_x)^2 = (1 + R^2) / 2 -+ sqrt((1 - R^2)^2 / 4 + (e / r)^2), R the ratio of the frequencies; let go from
        a displacement, and its edges to the largest of the sum of both modes. Fails if a line has another lever."""
        each, radius = one_storey(ratio, eccentricity)
        half, root = (1 + ratio**2) / 2, math.hypot((1 - ratio**2) / 2, eccentricity)
        squares = K / M * np.array([half - root, half + root])
        # in (u, r theta) the stiffness is K [[1, -e / r], [-e / r, R^2]]
        shapes = np.array([[eccentricity * K / M] * 2, K / M - squares])
        shapes /= np.linalg.norm(shapes, axis=0)
        start, omegas, duration = 0.01, np.sqrt(squares), 2.0
        scene = at_rest([each], samples=np.zeros(round(duration / DT) + 1))
        run = run_from(scene, [[start, 0.0]], [[0.0, 0.0]])
        parts = shapes * (shapes[0] * start)

        def motion(weights: np.ndarray, t: np.ndarray | float) -> np.ndarray:
            return (weights @ parts) @ np.cos(np.multiply.outer(omegas, t))

        assert run.end[0] == pytest.approx(motion(np.array([1.0, 0.0]), duration), rel=1e-8, abs=1e-10)
        assert run.end_twist[0] * radius == pytest.approx(motion(np.array([0.0, 1.0]), duration), rel=1e-8, abs=1e-10)
        places = {"edge_drift_low": -10.0, "edge_drift_high": 10.0}
        for name, y in places.items():
            weights = np.array([1.0, -y / radius])
            largest = largest_of(lambda t, w=weights: motion(w, t), duration)
            assert getattr(run, name)[0] == pytest.approx(largest, rel=1e-8)
        assert run.twist[0] == pytest.approx(
            largest_of(lambda t: motion(np.array([0.0, 1.0 / radius]), t), duration), rel=1e-8
        )
        assert abs(run.energy["residual"]) < 1e-9

    def test_torsionally_flexible_storey(self) -> None:
        """w_theta / w_x = 0.7 with one line beside the centre of mass. Fails if the lines across have another share."""
        radius = math.sqrt((20.0**2 + 14.0**2) / 12)
        for eccentricity in (0.1, 0.4):
            y = eccentricity * radius
            plan = FloorPlan(
                np.array([M * radius**2]), (line("1", y, K, storeys=1),), np.array([(0.49 * radius**2 - y * y) * K])
            )
            each = building("storey", np.array([M]), plan, alpha=0.0, beta=0.0)
            stiffness = np.array([[K, -K * y], [-K * y, 0.49 * K * radius**2]])
            squares, shapes = eigh(stiffness, np.diag([M, M * radius**2]))
            run = run_from(at_rest([each], samples=np.zeros(101)), [[0.01, 0.0]], [[0.0, 0.0]])
            end = shapes @ (np.cos(np.sqrt(squares) * 2.0) * (shapes.T @ (M * np.array([0.01, 0.0]))))
            assert run.end[0] == pytest.approx(end[0], rel=1e-8)
            assert run.end_twist[0] == pytest.approx(end[1], rel=1e-8)
            assert abs(run.energy["residual"]) < 1e-9

    @pytest.mark.parametrize("p_delta", [False, True])
    def test_storeys_by_the_exponential_of_their_matrix(self, p_delta: bool) -> None:
        """Three storeys with damping under ground motion, with a heavy load on their columns. Fails if a damping force
        of twist or of lines is left out, or P-Delta acts on another radius."""
        loads = {"gravity_load": np.array([3e7, 2e7, 1e7]), "collapse": np.inf} if p_delta else {}
        each = soft(np.inf, 3, **loads)
        scene = at_rest([each], samples=shake(2.0))
        run = solve(scene, 1e-12)
        _, q, rate = march(scene)
        size = np.abs(q[:, :3]).max()
        np.testing.assert_allclose(run.end, q[-1, :3], rtol=0, atol=1e-8 * size)
        np.testing.assert_allclose(run.end_twist, q[-1, 3:], rtol=0, atol=1e-8 * np.abs(q[:, 3:]).max())
        np.testing.assert_allclose(run.end_velocity, rate[-1, :3], rtol=0, atol=1e-8 * np.abs(rate[:, :3]).max())
        np.testing.assert_allclose(run.end_twist_rate, rate[-1, 3:], rtol=0, atol=1e-8 * np.abs(rate[:, 3:]).max())

    def test_proportional_lines(self) -> None:
        """Storeys whose lines, twists and masses have one ratio move as the product of the modes of the row and of a
        single floor. Fails if a storey of a line acts on other floors."""
        arms, ratio, n = (-6.0, 7.0), 0.4, 3
        column = np.array([1.0, 0.8, 0.6])
        mass = np.array([2e5, 1.6e5, 1.2e5])
        square = 40.0
        lines = tuple(
            line(str(y), y, share * K * column, storeys=n) for y, share in zip(arms, (ratio, 1 - ratio), strict=True)
        )
        torsion = 20.0 * K * column
        each = building("storeys", mass, FloorPlan(square * mass, lines, torsion), alpha=0.0, beta=0.0)
        run = run_from(at_rest([each], samples=np.zeros(101)), [[0.01, 0.02, 0.03, 0.0, 0.0, 0.0]], [np.zeros(6)])
        chain = np.diag(column + np.append(column[1:], 0.0)) - np.diag(column[1:], 1) - np.diag(column[1:], -1)
        rows, modes = eigh(chain, np.diag(mass))
        moment = ratio * arms[0] + (1 - ratio) * arms[1]
        twisting = ratio * arms[0] ** 2 + (1 - ratio) * arms[1] ** 2 + 20.0
        floor, shapes = eigh(np.array([[1.0, -moment], [-moment, twisting]]), np.diag([1.0, square]))
        end = np.zeros((2, n))
        for (a, mode), (b, shape) in itertools.product(
            zip(rows, modes.T, strict=True), zip(floor, shapes.T, strict=True)
        ):
            begin = mode @ (mass * np.array([0.01, 0.02, 0.03])) * shape[0]
            end += begin * math.cos(math.sqrt(K * a * b) * 2.0) * np.outer(shape, mode)
        np.testing.assert_allclose(run.end, end[0], rtol=0, atol=1e-8 * 0.03)
        np.testing.assert_allclose(run.end_twist, end[1], rtol=0, atol=1e-8 * 0.03)


def largest_of(function, duration: float) -> float:
    """Return the largest size of a function of time between 0 and the duration."""
    t = np.linspace(0.0, duration, 4001)
    values = np.abs(function(t))
    best = t[int(values.argmax())]
    step = t[1]
    bounds = max(0.0, best - step), min(duration, best + step)
    found = minimize_scalar(lambda x: -abs(float(function(x))), bounds=bounds, options={"xatol": 1e-12})
    return max(float(values.max()), -float(found.fun))


def turned_about_x(scene: Scene) -> Scene:
    """Return the scene seen from below: y changes its sign."""
    return replace(
        scene,
        buildings=tuple(
            each if each.plan is None else replace(each, plan=flipped(each.plan)) for each in scene.buildings
        ),
        links=tuple(replace(link, left_y=-link.left_y, right_y=-link.right_y) for link in scene.links),
    )


def flipped(plan: FloorPlan) -> FloorPlan:
    """Return a plan with the other sign of y."""
    lines = tuple(replace(each, place=-each.place) for each in plan.lines)
    return replace(plan, lines=lines, low=-plan.high, high=-plan.low)


def turned_about_y(scene: Scene) -> Scene:
    """Return the scene seen from the other side of the street: x changes its sign, y does not."""
    last = len(scene.buildings) - 2
    links = [
        replace(
            link, left=last - link.left, left_floor=link.right_floor, right_floor=link.left_floor,
            left_at=link.right_at, right_at=link.left_at, left_y=link.right_y, right_y=link.left_y,
        )
        for link in scene.links
    ]  # fmt: skip
    motion = replace(scene.motion, acceleration=-scene.motion.acceleration)
    return replace(scene, buildings=tuple(reversed(scene.buildings)), links=tuple(links), motion=motion)


MIRRORED = (
    "elastic", "bilinear", "peak-oriented", "imk, pinched", "lines across that yield", "p-delta", "three buildings",
    "sway and rocking", "friction",
)  # fmt: skip


class TestSymmetries:
    """Scenes that are one scene seen otherwise, or a limit of another."""

    @pytest.mark.parametrize("name", MIRRORED)
    def test_turned_about_x(self, name: str) -> None:
        """Rotations change their signs, edges change places, and nothing else does. Fails on any lever that has one
        sign for both sides."""
        scene = SCENES[name]()
        one, other = solve(scene, 1e-10), solve(turned_about_x(scene), 1e-10)
        for field in (
            "shear",
            "drift",
            "line_drift",
            "acceleration",
            "end",
            "peak_force",
            "impulse",
            "twist",
            "impacts",
        ):
            own, wanted = getattr(other, field), getattr(one, field)
            np.testing.assert_allclose(own, wanted, rtol=1e-9, atol=1e-9 * np.nanmax(np.abs(wanted)), err_msg=field)
        np.testing.assert_allclose(other.end_twist, -one.end_twist, rtol=0, atol=1e-9 * np.abs(one.end_twist).max())
        np.testing.assert_allclose(other.edge_drift_low, one.edge_drift_high, rtol=1e-9)
        assert one.events == other.events

    @pytest.mark.parametrize("name", MIRRORED)
    def test_turned_about_y(self, name: str) -> None:
        """Seen from the other side of the street. Fails if the left end of a link acts otherwise than the right one."""
        scene = SCENES[name]()
        one, other = solve(scene, 1e-10), solve(turned_about_y(scene), 1e-10)
        assert other.peak_force == pytest.approx(one.peak_force, rel=1e-9)
        assert other.impacts.tolist() == one.impacts.tolist()
        counts = [each.storeys for each in scene.buildings]
        back = np.concatenate(np.split(np.arange(sum(counts)), np.cumsum(counts)[:-1])[::-1])
        for field in ("shear", "drift", "twist", "edge_drift_low", "edge_drift_high"):
            assert getattr(other, field) == pytest.approx(getattr(one, field)[back], rel=1e-9, nan_ok=True), field

    def test_symmetric_lines_yield_together(self) -> None:
        """A symmetric plan under a symmetric load gives the numbers of floors that do not twist; its lines yield at one
        instant. Fails if rounding turns a floor."""
        pair = line("1", -6.0, 4e7, 2.5e5), line("2", 6.0, 4e7, 2.5e5)
        plan = FloorPlan(np.full(2, 1e7), pair, np.full(2, 1e9), low=-8.0, high=8.0)
        each = building("even", np.full(2, 2e5), plan)
        motion = Motion("shake", DT, shake(2.0, 5.0))
        scene = Scene((each,), (), motion, Analysis.INELASTIC, residual_drift=False)
        run = solve(scene, 1e-10)
        plain = solve(replace(scene, buildings=(replace(each, plan=None),)), 1e-10)
        assert plain.ductility.max() > 3
        assert run.twist.max() < 1e-15
        assert run.events == 2 * plain.events
        for field in ("shear", "drift", "acceleration", "displacement_max", "displacement_min"):
            np.testing.assert_allclose(getattr(run, field), getattr(plain, field), rtol=1e-10, err_msg=field)
        for name in ("input", "damping", "hysteresis"):
            assert run.energy[name] == pytest.approx(plain.energy[name], rel=1e-10)
        assert run.line_drift.reshape(2, 2)[:, 0].tolist() == run.line_drift.reshape(2, 2)[:, 1].tolist()

    def test_stiff_in_torsion(self) -> None:
        """Lines across the row that hardly turn give floors that do not twist: what is left falls with their stiffness.
        Contacts have no dashpots, whose masses are those of floors free to turn. Fails if the torsional stiffness acts
        elsewhere."""
        left, right = stiff(1.0), soft(1.0)
        motion = Motion("shake", DT, shake(2.0, 5.0))
        law = Pounding(0.004, 1e9, 0.0)
        links = Link(0, 1, 1, law, left_y=-3.0, right_y=4.0), Link(0, 2, 2, law, left_y=6.0, right_y=1.0)
        factors = 1e4, 1e5

        def run(factor: float) -> Run:
            plans = (
                replace(each.plan, torsional_stiffness=factor * each.plan.torsional_stiffness)
                if factor < math.inf
                else None
                for each in (left, right)
            )
            buildings = [replace(each, plan=plan) for each, plan in zip((left, right), plans, strict=True)]
            placed = links if factor < math.inf else tuple(replace(link, left_y=0.0, right_y=0.0) for link in links)
            return solve(Scene(tuple(buildings), placed, motion, Analysis.ELASTIC, residual_drift=False), 1e-9)

        limit = run(math.inf)
        off = [np.abs(run(factor).drift / limit.drift - 1).max() for factor in factors]
        assert off[1] < 3e-5
        assert off[1] == pytest.approx(0.1 * off[0], rel=0.2)

    def test_little_eccentricity(self) -> None:
        """Twist falls with the eccentricity, and what it does to drifts with its square. Fails if something turns
        floors that are not eccentric."""

        def run(e: float) -> Run:
            lines = line("1", -6.0 + e, 4e7), line("2", 6.0 + e, 4e7)
            plan = FloorPlan(np.full(2, 1e7), lines, np.full(2, 1e9), low=-8.0, high=8.0)
            return solve(at_rest([building("even", np.full(2, 2e5), plan)], samples=shake(2.0)), 1e-12)

        none, little, more = run(0.0), run(0.01), run(0.02)
        assert none.twist.max() == 0.0
        assert more.twist == pytest.approx(2 * little.twist, rel=1e-3)
        assert more.drift - none.drift == pytest.approx(4 * (little.drift - none.drift), rel=1e-3)

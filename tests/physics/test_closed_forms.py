"""Blows of free masses, throws of single storeys and vibrations of linear buildings whose answers are known."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import DOP853
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import gamma

import pounding_cli
from tests.adapter import Connector, Run, Scene, solve
from tests.physics.cases import ROCK, SWAY, formula, shake
from tests.reference.branches import jankowski_damping
from tests.reference.closed_forms import bilinear_throw, infill_compression, kelvin_voigt, oscillator_under_ramp
from tests.reference.exponential import march

M1, M2, V0, GAP = 2e5, 3e5, 0.6, 0.01
REDUCED = M1 * M2 / (M1 + M2)
M, K, VY, H = 2e5, 2e7, 3e5, 3.0
DY = VY / K


def storey(mass: float = M, stiffness: float = K, **keys: Any) -> dict[str, Any]:
    """A building of one storey, undamped and elastic unless `keys` say otherwise."""
    usual = {"storeys": 1, "mass": mass, "stiffness": [stiffness], "height": H, "yield_shear": "never"}
    return usual | {"rayleigh": {"alpha": 0.0, "beta": 0.0}} | keys


def still(duration: float) -> dict[str, Any]:
    """Ground at rest."""
    return {"ground": np.zeros(round(duration / 0.02) + 1), "dt": 0.02}


def blow(case: Mapping[str, Any], more: Mapping[str, Any], speed: float = V0, duration: float = 0.4) -> Run:
    """Two masses with hardly any springs; the left one comes with a speed [m/s]."""
    masses = storey(M1, 1e-3), storey(M2, 1e-3)
    start = [[0.0], [0.0]], [[speed], [0.0]]
    return solve(Scene(masses, case={"gap": GAP, **case}, more=more, start=start, **still(duration)), 1e-12)


Known = dict[str, float]
"""What comes of a blow: "rebound" over V0, and peaks by their names, "pressed" beyond the gap."""


def of_kelvin_voigt(s: float, e: float, cut: bool) -> Known:
    xi = -math.log(e) / math.hypot(math.pi, math.log(e))
    known = kelvin_voigt(s, xi, REDUCED, V0, cut)
    return {"rebound": known.rebound, "pressed": known.compression, "contact_time": known.time} | (
        {"peak_force": known.peak_force} if known.peak_force > known.pull or cut else {"peak_force": known.pull}
    )


def of_hertz(k: float) -> Known:
    """m' v0^2 / 2 = k v^2.5 / 2.5, and how long that lasts."""
    deepest = (2.5 * REDUCED * V0**2 / (2 * k)) ** 0.4
    lasts = 4 * math.sqrt(math.pi) * gamma(0.4) / (5 * gamma(0.9)) * deepest / V0
    return {"rebound": 1.0, "pressed": deepest, "peak_force": k * deepest**1.5, "contact_time": lasts}


def of_infill(s_mat: float, s_imp: float, printed: bool) -> Known:
    """Undamped: it is pressed through and gives all back, continuous; as printed the force falls at v = d on the way
    back as it jumped on the way in."""
    energy = REDUCED * V0**2 / 2
    return {"rebound": 1.0, "max_closing": infill_compression(energy, s_mat, s_imp, GAP, printed)}


def of_bilinear(k: float, depth: float, e: float, a: float = 0.1) -> tuple[float, Known]:
    """The speed of the blow for which the contact is laid out, and what comes of it: e, its depth and its force."""
    effective = k * math.sqrt(depth)
    lost = effective * depth**2 * (1 - e**2) / (1 + e**2)
    k1 = effective + lost / (a * depth**2)
    k2 = (effective * depth - k1 * a * depth) / (depth * (1 - a))
    limit, beyond = a * depth, depth - a * depth
    speed = math.sqrt((k1 * limit**2 + 2 * k1 * limit * beyond + k2 * beyond**2) / REDUCED)
    return speed, {"rebound": e, "pressed": depth, "peak_force": k * depth**1.5}


def hertz_rebound(zeta: float) -> float:
    """e of ln((1 + zeta) / (1 - e zeta)) = zeta (1 + e) [-]."""
    return brentq(lambda e: math.log((1 + zeta) / (1 - e * zeta)) - zeta * (1 + e), 1e-3, min(1, 0.999 / zeta))


def jankowski_rebound(xi: float) -> float:
    """With s = v^1.25 the approach is that of a damped oscillator of ratio sqrt(0.8) xi as far as it turns; the rebound
    is what its spring then holds [-]."""
    b = math.sqrt(0.8) * xi
    damped = math.sqrt(1 - b * b)
    turning = math.atan2(damped, b) / damped
    return math.exp(-b * turning) * math.sin(damped * turning) / damped


S, KH = 2e9, 2e9
PLAIN = {"stiffness": S, "restitution": 0.5}
UNDAMPED = PLAIN | {"restitution": 1.0}
BILINEAR = {"link": "bilinear", "hertz_stiffness": KH, "penetration": 0.01}
OWN = {"link": "own"}
BLOWS: dict[str, tuple[Mapping[str, Any], Mapping[str, Any], float, Known]] = {
    **{
        f"kelvin-voigt {e}{', cut' * cut}": (
            {"link": "pounding", "tension_cut": cut}, {"impact": PLAIN | {"restitution": e}}, V0,
            of_kelvin_voigt(S, e, cut),
        )
        for e in (0.5, 0.8, 0.9) for cut in (False, True)
    },
    "hertz": ({"link": "hertz", "hertz_stiffness": KH}, {}, V0, of_hertz(KH)),
    **{
        f"{law} {e}": ({"link": law, "hertz_stiffness": KH, "restitution": e}, {}, V0, {"rebound": e})
        for law in ("hertz-damp", "jankowski") for e in (0.1, 0.5, 0.9)
    },
    **{
        f"{law} 0.5, {published}": (
            {"link": law, "hertz_stiffness": KH, "restitution": 0.5, "damping_formula": published}, {}, V0,
            {"rebound": rebound},
        )
        for law, published, rebound in (
            ("hertz-damp", "ye", hertz_rebound(8 * (1 - 0.5) / (5 * 0.5))),
            ("hertz-damp", "muthukumar", hertz_rebound(3 * (1 - 0.5**2) / 4)),
            ("jankowski", "jankowski", jankowski_rebound(jankowski_damping(0.5, "jankowski"))),
        )
    },
    **{
        f"bilinear {e}": (BILINEAR | {"restitution": e}, {}, *of_bilinear(KH, 0.01, e)) for e in (0.3, 0.5, 1.0)
    },
    **{
        f"infill, {law}": (
            {"link": "infill", "stiffness": 2e7, "law": law}, {"impact": UNDAMPED}, V0,
            of_infill(2e7, S, law == "printed"),
        )
        for law in ("continuous", "printed")
    },
    "formula of kelvin-voigt": (
        OWN, formula("k*v + c*r", "beyond gap", k="2e9 N/m", c=f"{2 * 0.2154538 * math.sqrt(S * REDUCED):.17g} N s/m"),
        V0, of_kelvin_voigt(S, math.exp(-0.2154538 * math.pi / math.sqrt(1 - 0.2154538**2)), False),
    ),
    "formula of hertz": (OWN, formula("k*v**1.5", "beyond gap", k="2e9 N/m^1.5"), V0, of_hertz(KH)),
}  # fmt: skip


@pytest.mark.parametrize(("case", "more", "speed", "known"), BLOWS.values(), ids=BLOWS)
def test_blow(case, more, speed, known) -> None:
    """Fails if a spring, a dashpot, its mass or the end of contact is another."""
    run = blow(case, more, speed)
    assert run.impacts.tolist() == [1]
    left, right = run.end_velocity
    assert right - left == pytest.approx(known["rebound"] * speed, rel=1e-8)
    assert run.impulse[0] == pytest.approx((1 + known["rebound"]) * REDUCED * speed, rel=1e-8)
    assert run.energy["links"] == pytest.approx(REDUCED * speed**2 * (1 - known["rebound"] ** 2) / 2, abs=1e-3)
    for name in known.keys() - {"rebound", "pressed"}:
        assert getattr(run, name)[0] == pytest.approx(known[name], rel=1e-8), name
    if "pressed" in known:
        assert run.max_closing[0] - GAP == pytest.approx(known["pressed"], rel=1e-8)
    assert abs(run.energy["residual"]) < 1e-11


def joined_masses(link: str, speed: float = 0.3, duration: float = 0.2, **keys: Any) -> tuple[Run, float, float]:
    """The run of two masses that a damper joins, and closing and rate at the end."""
    run = blow({"link": link, **keys}, {}, speed, duration)
    return run, float(-np.diff(run.end)[0]), float(-np.diff(run.end_velocity)[0])


def of_linear(system: np.ndarray, start: list[float], duration: float) -> np.ndarray:
    return expm(system * duration) @ np.array(start)


@pytest.mark.parametrize("c", [1e5, 1e6, 2e7])
def test_maxwell(c: float) -> None:
    """m' r' = -f, f' = k (r - f / c). Fails with a spring beside the dashpot."""
    k = 1e8
    system = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1 / REDUCED], [0.0, k, -k / c]])
    expected = of_linear(system, [0.0, 0.3, 0.0], 0.2)
    run, v, rate = joined_masses("maxwell", stiffness=k, damping_coefficient=c)
    assert (v, rate) == pytest.approx(tuple(expected[:2]), rel=1e-7, abs=1e-9)
    held = expected[2] ** 2 / (2 * k)
    assert run.energy["links"] == pytest.approx(REDUCED * (0.3**2 - expected[1] ** 2) / 2 - held, rel=1e-8)


@pytest.mark.parametrize(("s", "xi"), [(5e7, 0.2), (1e8, 0.0)])
def test_connector(s: float, xi: float) -> None:
    """A damped oscillator, from the first instant and both ways. Fails if its spring is not stored."""
    c = 2 * xi * math.sqrt(s * REDUCED)
    expected = of_linear(np.array([[0.0, 1.0], [-s / REDUCED, -c / REDUCED]]), [0.0, 0.3], 0.2)
    run, v, rate = joined_masses("connector", stiffness=s, damping_ratio=xi)
    assert (v, rate) == pytest.approx(tuple(expected), rel=1e-8)
    assert run.energy["links_stored"] == pytest.approx(s * v**2 / 2, rel=1e-8)


@pytest.mark.parametrize("a", [0.1, 0.5, 0.9, "damper"])
def test_dashpots(a: float | str) -> None:
    """m' r' = -c r^a: r^(1 - a) falls in a straight line; r falls exponentially where a is 1. Fails with another
    power."""
    c, lost = 5e4, 5e4 * 0.2 / REDUCED
    if a == "damper":
        run, _, rate = joined_masses("damper", damping_coefficient=c)
        expected, force = 0.3 * math.exp(-lost), c * 0.3
    else:
        run, _, rate = joined_masses("viscous", force_at_1_m_s=c, exponent=a)
        expected, force = (0.3 ** (1 - a) - (1 - a) * lost) ** (1 / (1 - a)), c * 0.3**a
    assert rate == pytest.approx(expected, rel=1e-9)
    assert run.peak_force[0] == pytest.approx(force, rel=1e-9)
    assert run.energy["links"] == pytest.approx(REDUCED * (0.3**2 - expected**2) / 2, rel=1e-9)


def test_friction() -> None:
    """The spring up to the slip force, a constant force until they turn back, then the spring about the slip. Fails if
    the slip is forgotten, or the force goes on."""
    k, force, speed, duration = 1e8, 4e5, 0.3, 0.2
    omega, limit = math.sqrt(k / REDUCED), force / k
    at_slip = math.sqrt(speed**2 - (omega * limit) ** 2)
    slip = REDUCED * at_slip**2 / 2 / force
    turned = math.asin(omega * limit / speed) / omega + REDUCED * at_slip / force
    run, v, rate = joined_masses("friction", stiffness=k, slip_force=force)
    assert run.energy["links"] == pytest.approx(force * slip, rel=1e-8)
    assert run.max_closing[0] == pytest.approx(limit + slip, rel=1e-9)
    assert v == pytest.approx(slip + limit * math.cos(omega * (duration - turned)), rel=1e-7)
    assert rate == pytest.approx(-omega * limit * math.sin(omega * (duration - turned)), rel=1e-7)
    assert run.peak_force[0] == pytest.approx(force, rel=1e-10)


def thrown(speed: float, duration: float = 1.2, accuracy: float = 1e-12, **keys: Any) -> Run:
    """An undamped storey thrown from rest."""
    one = storey(**{"yield_shear": [VY], "hardening": 0.1, "collapse": "never"} | keys)
    start = [[0.0]], [[speed]]
    return solve(Scene((one,), analysis="inelastic", start=start, **still(duration)), accuracy)


def test_bilinear_storey() -> None:
    """Both turns and the energy of the loop. Fails if it unloads along another line, or hardens otherwise."""
    run, known = thrown(0.25, 1.0), bilinear_throw(M, K, VY, 0.1, 0.25)
    assert run.displacement_max[0] == pytest.approx(known.first, rel=1e-10)
    assert run.displacement_min[0] == pytest.approx(known.second, rel=1e-10)
    assert run.shear[0] == pytest.approx(known.shear, rel=1e-10)
    assert run.ductility[0] == pytest.approx(known.first / DY, rel=1e-10)


def test_peak_oriented_storey() -> None:
    """It reloads straight towards the yield on the side where it has not yielded. Fails with another target."""
    a, speed = 0.1, 0.25
    run, plateau = thrown(speed, storey_law="peak-oriented"), (1 - a) * VY
    rest = 0.5 * VY * DY - plateau * DY - 0.5 * a * K * DY**2 - 0.5 * M * speed**2
    first = max(np.roots([0.5 * a * K, plateau, rest]).real)
    shear = plateau + a * K * first
    zero = first - shear / K
    second = zero - shear / math.sqrt(K * VY / (zero + DY))
    assert run.displacement_max[0] == pytest.approx(first, rel=1e-10)
    assert run.shear[0] == pytest.approx(shear, rel=1e-10)
    assert run.displacement_min[0] == pytest.approx(second, rel=1e-9)


CAPPED = {"capping_ductility": 3.0, "post_capping_slope": 0.1, "residual_strength": 0.3}
IMK = {"storey_law": "imk-peak-oriented"} | CAPPED


@pytest.mark.parametrize("speed", [0.3, 0.45, 0.7], ids=["hardening", "capping", "residual"])
def test_imk_backbone(speed: float) -> None:
    """How far a throw goes along its three lines. Fails if capping, slope or residual strength is another."""
    a = 0.1
    cap, top = 3 * DY, VY + a * K * 2 * DY
    level = cap + (top - 0.3 * VY) / (0.1 * K)
    left = 0.5 * M * speed**2 - 0.5 * VY * DY
    to_cap, to_level = 0.5 * (VY + top) * (cap - DY), 0.5 * (top + 0.3 * VY) * (level - cap)
    if left < to_cap:
        expected = DY + (-VY + math.sqrt(VY**2 + 2 * a * K * left)) / (a * K)
    elif left < to_cap + to_level:
        expected = cap + (top - math.sqrt(top**2 - 2 * 0.1 * K * (left - to_cap))) / (0.1 * K)
    else:
        expected = level + (left - to_cap - to_level) / (0.3 * VY)
    run = thrown(speed, **IMK)
    assert run.displacement_max[0] == pytest.approx(expected, rel=1e-10)
    assert run.shear[0] == pytest.approx(VY + a * K * (min(expected, cap) - DY), rel=1e-10)


@pytest.mark.parametrize("mode", ["none", "strength", "reloading", "unloading"])
def test_imk_deterioration(mode: str) -> None:
    """A perfectly plastic storey comes back through zero shear and turns on the line towards the other yield;
    beta = E / (Et - E). Fails if a mode deteriorates by another energy, or the wrong quantity."""
    capacity, speed = 12.0, 0.25
    lost = {} if mode == "none" else {f"{mode}_capacity": capacity}
    run = thrown(speed, hardening=0.0, **IMK | {"capping_ductility": 1e3} | lost)
    first = DY + (0.5 * M * speed**2 - 0.5 * VY * DY) / VY
    energy = VY * (first - DY)
    beta = 0.0 if mode == "none" else energy / (capacity * VY * DY - energy)
    unloading = K * (1 - beta) if mode == "unloading" else K
    zero = first - VY / unloading
    target = DY * (1 + beta) if mode == "reloading" else DY
    if mode == "unloading":  # reloading no stiffer than unloading
        target = max(target, VY / unloading - zero)
    slope = (VY * (1 - beta) if mode == "strength" else VY) / (zero + target)
    assert run.displacement_max[0] == pytest.approx(first, rel=1e-10)
    assert run.displacement_min[0] == pytest.approx(zero - VY / math.sqrt(unloading * slope), rel=1e-9)


def test_imk_pinching() -> None:
    """Two reloading lines, the first 0.3 as stiff as the straight one, up to zero drift. Fails if the second misses the
    yield that it aims at."""
    speed = 0.33
    pinched = IMK | {"storey_law": "imk-pinching", "pinching_force": 0.3, "pinching_drift": 0.6}
    run = thrown(speed, hardening=0.0, **pinched | {"capping_ductility": 1e3})
    first = DY + (0.5 * M * speed**2 - 0.5 * VY * DY) / VY
    zero = first - DY
    at_break = 0.3 * VY / (zero + DY) * zero
    second = (VY - at_break) / DY
    left = 0.5 * VY * DY - 0.5 * at_break * zero
    turned = (-at_break + math.sqrt(at_break**2 + 2 * second * left)) / second
    assert run.displacement_max[0] == pytest.approx(first, rel=1e-10)
    assert run.displacement_min[0] == pytest.approx(-turned, rel=1e-9)


def loading(n: int, x: float) -> tuple[float, float]:
    """z, and the integral of z over x = D / Dy, on loading from z = 0."""
    return (1 - math.exp(-x), x - 1 + math.exp(-x)) if n == 1 else (math.tanh(x), math.log(math.cosh(x)))


@pytest.mark.parametrize(("n", "wen_gamma"), [(1, 0.5), (2, 0.5), (1, -0.5), (1, 0.9)])
@pytest.mark.parametrize("speed", [0.06, 0.15])
def test_bouc_wen(n: int, wen_gamma: float, speed: float) -> None:
    """Out along the curve of n, back by gamma (straight where it is one half), and on along the curve downwards: both
    turns by their energies. Fails if gamma and beta change places, or z grows by another law."""
    a, c = 0.1, 2 * wen_gamma - 1
    run = thrown(speed, storey_law="bouc-wen", wen_exponent=n, wen_gamma=wen_gamma)

    def held(x: float) -> float:
        return 0.5 * a * K * (x * DY) ** 2

    unit = (1 - a) * VY * DY
    first = brentq(lambda x: 0.5 * M * speed**2 - held(x) - unit * loading(n, x)[1], 0.0, 100.0, xtol=1e-15)
    z = loading(n, first)[0]
    zero = first - z if c == 0 else first + math.log(1 - c * z) / c
    back = held(first) + unit * (0.5 * z * z if c == 0 else (first - zero - z) / c)
    second = brentq(lambda x: back - held(x) - unit * loading(n, zero - x)[1], zero - 100.0, zero, xtol=1e-15)
    assert run.displacement_max[0] == pytest.approx(first * DY, rel=1e-10)
    assert run.shear[0] == pytest.approx(a * K * first * DY + (1 - a) * VY * z, rel=1e-10)
    assert run.displacement_min[0] == pytest.approx(min(second, 0.0) * DY, rel=1e-9)


@pytest.mark.parametrize("theta", [0.1, 0.5, 0.99])
def test_p_delta_lengthens_the_period(theta: float) -> None:
    """T' = T / sqrt(1 - theta). Fails if the weight acts on another arm than the storey's height."""
    one = storey(p_delta=[theta * K * H])
    run = solve(Scene((one,), start=([[0.01]], [[0.0]]), **still(1.0)), 1e-12)
    omega = math.sqrt(K / M * (1 - theta))
    assert run.end[0] == pytest.approx(0.01 * math.cos(omega), abs=1e-12)
    assert run.end_velocity[0] == pytest.approx(-0.01 * omega * math.sin(omega), abs=1e-10)
    assert run.energy["input"] == pytest.approx(0.5 * K * (1 - theta) * 1e-4, rel=1e-10)


def test_p_delta_after_yield() -> None:
    """The drift of a throw by its energies, with the slope (a - theta) k; the shear is the law's. Fails if P-Delta is
    part of the storey's shear, or ends at the yield."""
    a, theta, speed = 0.05, 0.2, 0.25
    run, plateau = thrown(speed, 1.0, hardening=a, p_delta=[theta * K * H]), (1 - a) * VY
    rest = 0.5 * VY * DY - plateau * DY - 0.5 * a * K * DY**2 - 0.5 * M * speed**2
    expected = min(np.roots([0.5 * (a - theta) * K, plateau, rest]).real)
    assert run.drift[0] == pytest.approx(expected, rel=1e-10)
    assert run.shear[0] == pytest.approx(plateau + a * K * expected, rel=1e-10)


@pytest.mark.parametrize("limit", [0.02, 0.10, 0.5])
def test_collapse(limit: float) -> None:
    """Its instant on a cosine, then exponentials. Fails if it is found at the end of a step, or at another drift."""
    a, theta, speed = 0.05, 0.25, 0.6
    run = thrown(speed, 4.0, hardening=a, p_delta=[theta * K * H], collapse=limit)
    w, g = math.sqrt(K * (1 - theta) / M), math.sqrt(K * (theta - a) / M)
    t1 = math.asin(DY * w / speed) / w
    v1, c = speed * math.cos(w * t1), (1 - a) * VY / (K * (theta - a))
    p, q, top = 0.5 * (DY - c + v1 / g), 0.5 * (DY - c - v1 / g), limit * H - c
    expected = t1 + math.log((top + math.sqrt(top**2 - 4 * p * q)) / (2 * p)) / g
    assert (run.status, run.place) == ("collapsed", (0, 1))
    assert run.time == pytest.approx(expected, rel=1e-10)
    assert run.drift[0] == pytest.approx(limit * H, rel=1e-12)
    assert abs(run.energy["residual"]) < 1e-11


@pytest.mark.parametrize("case", [
    {"link": "pounding"},
    {"link": "connector", "damping_ratio": 0.0, "stiffness": 1e8},
    {"link": "connector", "damping_ratio": 0.0, "stiffness": 1e8, "rise": 1.5, "distance": 2.0},
    {"link": "friction", "stiffness": 1e8, "slip_force": 1e9},
    {"link": "maxwell", "stiffness": 1e8, "damping_coefficient": 1e30},
], ids=lambda case: f"{case['link']}{', inclined' if 'rise' in case else ''}")  # fmt: skip
@pytest.mark.parametrize("at", [0.3, 0.5, 0.9])
def test_force_on_columns(at: float, case: Mapping[str, Any]) -> None:
    """A slab strikes the columns of a building too heavy to move, or is tied to them: the reactions b^2 (3a + b) / L^3
    and a^2 (3b + a) / L^3 of a clamped beam, whose own give, 12 EI / L^3 = share k, is in series with the level
    stiffness of the link, k cos^2. Fails if the two ends take each other's place, or an inclined link bends columns as
    a level one does."""
    case = {"gap": 0.0, **case}
    height = at * H + case.pop("rise", 0.0)
    cosine = math.cos(math.atan2(height - at * H, case.get("distance", 1.0)))
    if case["link"] != "pounding":
        case["floors"] = [[1, f"0 + {100 * at:g} %"]]
    striker = storey(1e5, 1e-3, height=height, slab=0.1)
    struck = storey(1e14, 1e9, slab=0.1, columns=0.25)
    more = {"impact": {"stiffness": 1e8, "restitution": 1.0}}
    start = [[0.0], [0.0]], [[0.5], [0.0]]
    run = solve(Scene((striker, struck), case=case, more=more, start=start, **still(0.4)), 1e-12)
    below, above = (1 - at) ** 2 * (3 * at + 1 - at), at**2 * (3 * (1 - at) + at)
    if case["link"] == "pounding":
        assert run.impacts.tolist() == [1]
    give = 4 * (at * (1 - at)) ** 3 / (0.25 * 1e9)
    force = 0.5 * math.sqrt(1e5 / (1e-8 / cosine**2 + give))
    assert run.peak_force[0] == pytest.approx(force / cosine, rel=1e-6)
    assert run.shear_below[0] == pytest.approx(force * below, rel=1e-6)
    assert run.shear_above[0] == pytest.approx(force * above, rel=1e-6)


@pytest.mark.parametrize("speed", [1e-4, 0.25, 0.5, 0.8])
@pytest.mark.parametrize("law", ["continuous", "printed"])
def test_infill_on_columns(law: str, speed: float) -> None:
    """A slab presses 1 cm of infill against the columns of a building too heavy to move: the energy of the blow stands
    in the infill and in the columns, f F^2 / 2, at the largest closing x + f F, and all of it comes back. The speeds
    end lightly pressed, inside the thickness, at the jump of the printed law, and beyond it. Fails if columns follow
    another curve than the infill."""
    at, s_mat, s_imp, mass = 0.3, 2e7, 1e9, 1e5
    give = 4 * (at * (1 - at)) ** 3 / (0.25 * 1e9)
    p = (s_imp - s_mat) / (3 * GAP**2)
    before_jump = p * GAP**3 + s_mat * GAP
    behind_jump = s_imp * GAP if law == "printed" else before_jump
    energy = mass * speed**2 / 2

    def force_at(x: float) -> float:
        return p * x**3 + s_mat * x if x <= GAP else behind_jump + s_imp * (x - GAP)

    def excess(x: float) -> float:
        """Energy at the compression x over that of the blow [J]."""
        in_infill = p * min(x, GAP) ** 4 / 4 + s_mat * min(x, GAP) ** 2 / 2
        in_infill += behind_jump * max(x - GAP, 0) + s_imp * max(x - GAP, 0) ** 2 / 2
        return in_infill + give * force_at(x) ** 2 / 2 - energy

    if excess(GAP) >= 0:
        x = brentq(excess, 0.0, GAP, xtol=1e-18)
        force = force_at(x)
    elif excess(GAP * (1 + 1e-15)) >= 0:  # at the jump, where columns alone give way
        x = GAP
        force = math.sqrt(2 * (energy - p * GAP**4 / 4 - s_mat * GAP**2 / 2) / give)
    else:
        x = brentq(excess, GAP * (1 + 1e-15), 1.0, xtol=1e-18)
        force = force_at(x)
    case = {"link": "infill", "gap": GAP, "stiffness": s_mat, "law": law, "damping_ratio": 0.0}
    case["floors"] = [[1, f"0 + {100 * at:g} %"]]
    striker, struck = storey(mass, 1e-3, height=at * H, slab=0.1), storey(1e14, 1e9, slab=0.1, columns=0.25)
    more = {"impact": {"stiffness": s_imp, "restitution": 1.0}}
    scene = Scene((striker, struck), case=case, more=more, start=([[0.0], [0.0]], [[speed], [0.0]]), **still(0.6))
    run = solve(scene, 1e-12)
    assert run.peak_force[0] == pytest.approx(force, rel=1e-8)
    assert run.max_closing[0] == pytest.approx(x + give * force, rel=1e-8)
    assert run.impulse[0] == pytest.approx(2 * mass * speed, rel=1e-8)
    assert abs(run.energy["links"]) < 1e-9 * energy
    stored = scene.built.links[0].law.stored_energy(float(run.max_closing[0]), 0.0)
    assert stored == pytest.approx(energy, rel=1e-8)
    assert run.impacts.tolist() == [1]


def test_infill_beside_columns_that_hardly_bend() -> None:
    """Close to a floor the bending changes nothing, and the infill keeps its series; two springs in series add up.
    Fails if such columns cost the time of the exact curve."""
    infill = pounding_cli.Infill(gap=GAP, stiffness=2e7, impact_stiffness=1e9, damping_ratio=0.2)
    assert infill.soften(1e-19) is infill
    softer = infill.soften(1e-10)
    assert softer.identity != infill.identity
    assert softer.soften(2e-10) == infill.soften(1e-10 + 2e-10)
    with pytest.raises(ValueError, match="flexibility is inf m/N"):
        infill.soften(math.inf)


@pytest.mark.parametrize("distance", [None, 1.6])
@pytest.mark.parametrize("mirrored", [False, True])
def test_damper_on_columns(mirrored: bool, distance: float | None) -> None:
    """Free masses: a floor moves away from columns 1.2 m, 40 %, above the first of two floors, at the height of which
    it would be level. The reduced mass is 1 / (1 / m + (1 - w)^2 / m1 + w^2 / m2), the rate falls as
    exp(-c cos^2 t / m'), and the floors take 1 - w and w of the impulse. Fails if an inclined dashpot moves by the
    whole closing, or pushes with its whole force."""
    c, speed, duration, w = 1e5, 0.3, 0.4, 3 * 0.4**2 - 2 * 0.4**3
    cosine = 1.0 if distance is None else math.cos(math.atan2(1.2, distance))
    one = storey(M1, 1e-3)
    two = {"storeys": 2, "mass": [M2, 1.5e5], "stiffness": [1e-3, 1e-3], "height": H, "yield_shear": "never"}
    two |= {"rayleigh": {"alpha": 0.0, "beta": 0.0}, "columns": 0.5}
    floors, start, buildings = [1, "1 + 40 %"], [[speed], [0.0, 0.0]], (one, two)
    if mirrored:
        floors, start, buildings = floors[::-1], start[::-1], buildings[::-1]
    case = {"link": "damper", "gap": 0.1, "damping_coefficient": c, "floors": [floors]}
    case |= {} if distance is None else {"distance": distance}
    rest = [[0.0] * len(each) for each in start]
    run = solve(Scene(buildings, case=case, start=(rest, start), **still(duration)), 1e-12)
    reduced = 1 / (1 / M1 + (1 - w) ** 2 / M2 + w**2 / 1.5e5)
    rate = speed * math.exp(-c * cosine**2 * duration / reduced)
    impulse = reduced * (speed - rate)
    ends = np.array([speed - impulse / M1, (1 - w) * impulse / M2, w * impulse / 1.5e5])
    assert run.end_velocity == pytest.approx(np.roll(ends, -1) if mirrored else ends, rel=1e-9)
    assert run.peak_force[0] == pytest.approx(c * speed * cosine, rel=1e-9)
    assert run.shear_below[0] == pytest.approx((1 - w) * c * speed * cosine**2, rel=1e-6)
    assert run.shear_above[0] == pytest.approx(w * c * speed * cosine**2, rel=1e-6)
    assert run.energy["links"] == pytest.approx(reduced * (speed**2 - rate**2) / 2, rel=1e-9)
    closing = abs(run.end @ ([1 - w, w, -1.0] if mirrored else [1.0, w - 1, -w]))
    assert closing == pytest.approx(reduced * (speed - rate) / (c * cosine**2), rel=1e-9)
    if not mirrored:
        assert run.max_closing[0] == pytest.approx(closing, rel=1e-9)


@pytest.mark.parametrize("left_height", [6.0, 3.0])
def test_floors_at_different_heights(left_height: float) -> None:
    """Two floors 3 m apart in height, tied over 3 m along the row: a link at 45 degrees is half as stiff, and half as
    much of a dashpot, as a level one; with a dashpot beside it the answer is the exponential of the hand-written
    matrices. Fails if the angle is another's, or is taken once."""
    heights = left_height, 9.0 - left_height
    k, s, ratio, dashpot = (3e7, 5e7), 4e7, 0.1, 8e5
    m = np.array([M1, M2])
    pair = [storey(mass, each, height=height) for mass, each, height in zip(m, k, heights, strict=True)]
    links = [
        {"link": "connector", "stiffness": s, "damping_ratio": ratio, "floors": [[1, 1]], "distance": 3.0},
        {"link": "damper", "damping_coefficient": dashpot, "floors": [[1, 1]], "distance": 4.0},
    ]
    start = ([[0.01], [0.01]], [[0.3], [0.1]])
    run = solve(Scene(pair, case={"gap": 0.3, "links": links}, start=start, **still(0.6)), 1e-12)
    c = ratio * 2 * math.sqrt(0.5 * s * REDUCED) + 0.64 * dashpot
    join = np.array([[1.0, -1.0], [-1.0, 1.0]])
    stiffness = np.diag(k) + 0.5 * s * join
    system = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness / m[:, None], -c * join / m[:, None]]])
    expected = of_linear(system, [0.01, 0.01, 0.3, 0.1], 0.6)
    assert np.concatenate((run.end, run.end_velocity)) == pytest.approx(expected, rel=1e-9, abs=1e-11)
    v = expected[0] - expected[1]
    assert run.energy["links_stored"] == pytest.approx(0.5 * s * v**2 / 2, rel=1e-8)
    assert abs(run.energy["residual"]) < 1e-11


@pytest.mark.parametrize("foundation", ["fixed", SWAY, ROCK, SWAY | ROCK], ids=["fixed", "sway", "rocking", "both"])
@pytest.mark.parametrize("link", [None, "connector", "unaligned"])
def test_linear_buildings(link: str | None, foundation: Any) -> None:
    """Against the exponential of the matrices, to rounding. Fails if damping acts on another motion than the storey's,
    a base has another mass, or an inclined connector joins other floors."""
    buildings = [{"storeys": 4, "period": each, "foundation": foundation, "columns": 0.3} for each in (0.36, 0.60)]
    connector = {"link": "connector", "gap": 0.05, "stiffness": 3e7, "damping_ratio": 0.1}
    case: dict[str, Any] = connector if link else {}
    if link == "unaligned":
        case = connector | {"floors": [[1, 2], [4, 3], ["0 + 50 %", 1], [3, "1 + 1 m"]], "distance": 2.0}
    scene = Scene(buildings, shake(1.5), 0.02, case)
    if not link:
        scene = Scene(buildings[:1], shake(1.5), 0.02)
    run, (_, q, rate) = solve(scene, 1e-12), march(scene.built)
    bases = 0 if foundation == "fixed" else len({"sway_stiffness", "rocking_stiffness"} & foundation.keys())
    floors = [place * (4 + bases) + floor for place in range(len(scene.buildings)) for floor in range(4)]
    assert run.end == pytest.approx(q[-1, floors], rel=1e-8, abs=1e-12)
    assert run.end_velocity == pytest.approx(rate[-1, floors], rel=1e-8, abs=1e-11)
    if foundation != "fixed" and "sway_stiffness" in foundation:
        assert run.sway[0] >= np.abs(q[:, 4]).max() * (1 - 1e-9)
    if foundation != "fixed" and "rocking_stiffness" in foundation:
        assert run.rocking[0] >= np.abs(q[:, 3 + bases]).max() * (1 - 1e-9)


def test_rocking_base_is_a_pendulum() -> None:
    """A stiff column on a rocking spring under its weight: w^2 = (kphi - W h) / (I + m h^2). Fails if the weight acts
    on the storey's own drift alone."""
    inertia, spring, weight = 1e6, 2e7, 9.80665 * M
    one = storey(stiffness=1e12, p_delta=True, foundation={"inertia": inertia, "rocking_stiffness": spring})
    ground = np.zeros(101)
    ground[3:] = 1.0
    scene = Scene((one,), ground, 0.02)
    w, force = math.sqrt((spring - weight * H) / (inertia + M * H**2)), M * H / (spring - weight * H)
    t, ramp = 2.0 - 0.06, 0.02
    expected = -force * (1 - (math.sin(w * (t + ramp)) - math.sin(w * t)) / (w * ramp))
    run = solve(scene, 1e-9)
    assert run.end[0] == pytest.approx(H * expected, rel=1e-4)


@pytest.mark.parametrize("xi", [0.0, 0.05, 0.6])
def test_oscillator_under_a_ramp(xi: float) -> None:
    """Ground whose acceleration is a straight line, half of the damping by mass and half by stiffness. Fails if a
    sample is taken for its neighbour."""
    omega, a0, slope, t = math.sqrt(K / M), 1.7, 5.0, 0.34
    one = storey(rayleigh={"alpha": xi * omega, "beta": xi / omega})
    run = solve(Scene((one,), a0 + slope * 0.02 * np.arange(18), 0.02), 1e-12)
    u, v = oscillator_under_ramp(0.0, 0.0, a0, slope, omega, xi, t)
    assert (run.end[0], run.end_velocity[0]) == pytest.approx((u, v), rel=1e-10)
    held = 0.5 * (M * v**2 + K * u**2)
    assert run.energy["kinetic"] + run.energy["stored"] == pytest.approx(held, rel=1e-10)
    assert run.energy["damping"] == pytest.approx(run.energy["input"] - held, rel=1e-9, abs=1e-9 * held)


@pytest.mark.parametrize("base", [SWAY, ROCK])
def test_a_stiff_base_is_a_fixed_one(base: Mapping[str, float]) -> None:
    """The difference goes as 1 / stiffness. Fails if a rigid base still moves."""
    fixed = solve(Scene(({"storeys": 3, "period": 0.36},), shake(0.6), 0.02), 1e-11)
    differences = []
    for times in (1e1, 1e2):
        stiffer = base | {name: value * times for name, value in base.items() if name.endswith("stiffness")}
        run = solve(Scene(({"storeys": 3, "period": 0.36, "foundation": stiffer},), shake(0.6), 0.02), 1e-11)
        differences.append(np.abs(run.shear / fixed.shear - 1).max())
    assert differences[1] == pytest.approx(0.1 * differences[0], rel=0.35)


def test_the_coefficients_of_dop853_are_those_of_scipy():
    """Fails if one digit of pounding_cli/solver/dop853.json is another."""
    found = json.loads((Path(pounding_cli.__file__).parent / "solver" / "dop853.json").read_text())
    assert set(found) == {"A", "A_EXTRA", "B", "C", "C_EXTRA", "D", "E3", "E5"}
    assert all(np.array_equal(values, getattr(DOP853, name)) for name, values in found.items())


@pytest.mark.parametrize(("floors", "places", "words"), [
    ((0, 1), {"left_at": 0.5}, "ends below a base"),
    ((1, 1), {"left_at": 0.0}, "a part above 0"),
    ((1, 1), {"cosine": 0.0}, "cosine is 0"),
    ((1, 1), {"left_at": 0.5, "right_at": 0.5, "columns": 0.2}, "columns is 0.2"),
])  # fmt: skip
def test_links_that_end_nowhere(floors: tuple[int, int], places: Mapping[str, float], words: str) -> None:
    """Fails if a link that is built by hand may end where nothing is."""
    law = Connector(gap=0.1, stiffness=1e7, damping_ratio=0.0)
    with pytest.raises(ValueError, match=words):
        pounding_cli.Link(0, *floors, law, **places)

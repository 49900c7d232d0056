"""What each law costs beside the plain one: the pair of Fig. 6 under El Centro's stand-in, one law after the other.

Every scene is written as a study would be, so a law that is renamed or refused ends the measurement."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import yaml

from pounding_cli.laws import storey_laws
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.study import expand, load_study

from .clock import in_solver, least

IMPACT = {"restitution": 0.5, "hertz_stiffness": "4.344e11 N/m^1.5", "penetration": "1.053 mm"}
"""Matched as in `configs/contact-laws.yaml`."""

CONTACT = ("kelvin-voigt", "hertz", "hertz-damp", "jankowski", "bilinear")

BETWEEN = {
    "connector": {"stiffness": "1/5 mean storey of stiff"},
    "damper": {"damping_coefficient": "2 MN s/m"},
    "infill": {},
    "maxwell": {"damping_coefficient": "2 MN s/m", "stiffness": "100 kN/mm"},
    "friction": {"slip_force": "200 kN"},
    "viscous": {"force_at_1_m_s": "500 kN", "exponent": 0.5},
}
"""Links and their keys; each stands at floors 3 and 5, the infill at all. The first is the plain one."""

LOSES_STRENGTH = {
    "capping_ductility": 6.0, "post_capping_slope": 0.05, "residual_strength": 0.4, "strength_capacity": 200.0,
    "capping_capacity": 200.0, "unloading_capacity": 200.0, "reloading_capacity": 200.0, "pinching_force": 0.4,
    "pinching_drift": 0.5,
}  # fmt: skip
"""Keys of storey laws, of which each takes its own."""


SWAY = {"mass": "200 t", "sway_stiffness": "2000 kN/mm", "sway_damping": "20 MN s/m"}

ROCKING = {"inertia": "1e7 kg m2", "rocking_stiffness": "1e5 MN m", "rocking_damping": "100 MN m s"}


def scenes() -> Iterator[tuple[str, str, Scene]]:
    """(what is compared, law, scene); the first of each kind is the plain one."""
    touching = {"link": "pounding", "gap": "0 cm"}
    for law in CONTACT:
        yield "contact, elastic, touching", law, _scene({"link": touching, "impact": {"law": law, **IMPACT}})
    for law, keys in BETWEEN.items():
        floors = {} if law == "infill" else {"floors": [3, 5]}
        yield (
            "between the floors, elastic, no pounding",
            law,
            _scene({"link": {"link": law, "gap": "5 cm", **keys, **floors}}),
        )
    for law, made in storey_laws().items():
        own = {key: value for key, value in LOSES_STRENGTH.items() if key in made.parameters()}
        yield "storeys, touching", law, _scene({"link": touching, "storeys": {"storey_law": law, **own}}, "inelastic")
    yield (
        "storeys, touching",
        "bilinear with P-Delta",
        _scene({"link": touching, "storeys": {"p_delta": True}}, "inelastic"),
    )
    for analysis in ("elastic", "inelastic"):
        kind = f"bases, touching, {analysis}"
        yield kind, "fixed", _scene({"link": touching}, analysis)
        yield kind, "sway", _scene({"link": touching, "storeys": {"foundation": SWAY}}, analysis)
        yield (
            kind,
            "sway and rocking",
            _scene({"link": touching, "storeys": {"foundation": {**SWAY, **ROCKING}}}, analysis),
        )


def _scene(wanted: dict, analysis: str = "elastic") -> Scene:
    """The linked scene of a study of two buildings with these keys."""
    study = {
        "records": {"use": ["elcentro"], "duration": "10 s"},
        "buildings": {
            "stiff": {"storeys": 5, "period": "0.36 s", "collapse": "never", **wanted.get("storeys", {})},
            "soft": {"like": "stiff", "period": "0.60 s"},
        },
        "group": ["stiff", "soft"],
        "impact": wanted.get("impact", {}),
        "cases": {"linked": wanted["link"]},
        "analyses": [analysis],
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "law.yaml"
        path.write_text(yaml.safe_dump(study, sort_keys=False), encoding="utf-8")
        return next(scene for scene in expand(load_study(path)).scenes.values() if scene.links)


def measure() -> list[dict]:
    """For every law its time in the solver [s], steps, events, and time over that of the plain law of its kind [-]."""
    made = list(scenes())
    runs = [solve(scene, 1e-6) for _, _, scene in made]
    times = least([in_solver(lambda scene=scene: solve(scene, 1e-6)) for _, _, scene in made], budget=20.0)
    found: list[dict] = []
    plain: dict[str, float] = {}
    for (kind, law, _), run, seconds in zip(made, runs, times, strict=True):
        over = seconds / plain.setdefault(kind, seconds)
        found.append(
            {"kind": kind, "law": law, "seconds": seconds, "over": over, "steps": run.steps, "events": run.events}
        )
    return found

"""Build the buildings of a study: stiffness and yield shears derived, displacements that codes expect."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.laws import storey_laws
from pounding_cli.model.building import Building, Foundation, UnstableError, weight_above
from pounding_cli.model.code_design import BaseShearDesign, Design, UbcDesign
from pounding_cli.model.separation import CODE_RULES, UBC, edge_displacement
from pounding_cli.model.stiffness import frequencies, rayleigh_factors, stiffness_for_period
from pounding_cli.model.wall import UNLIMITED_HEIGHT, Wall
from pounding_cli.study.construct.floor_plans import build_plan, sum_stiffness, sum_yield_shear
from pounding_cli.study.schema.building import BaseShearSpec, BuildingSpec, StiffnessAtSpec
from pounding_cli.study.schema.links import key_parameters


def build_building(name: str, spec: BuildingSpec) -> Building:
    """Return the building that a section describes.

    Raises
    ------
    InputError : it cannot stand
    """
    try:
        with np.errstate(all="ignore"):  # what is not finite in the end is refused
            return _build_wall(name, spec.wall) if spec.wall is not None else _build_frame(name, spec)
    except InputError as refused:
        raise refused.below("buildings", name, "plan") from None
    except (ValueError, ArithmeticError) as error:
        path = ("buildings", name, "p_delta") if isinstance(error, UnstableError) else ("buildings", name)
        parts = "period, stiffness" if spec.plan is None else "period, stiffness, plan"
        hint = f"check its masses, heights, {parts} and P-Delta"
        raise InputError([Issue(path, str(error), hint)]) from None


def _build_frame(name: str, spec: Any) -> Building:
    mass = _fill_storeys(spec.mass, spec.count)
    height = _fill_storeys(spec.height, spec.count)
    stiffness = _find_stiffness(spec, mass)
    period = 2 * np.pi / float(frequencies(mass, stiffness)[0]) if spec.period is None else spec.period
    if spec.rayleigh:
        alpha = spec.rayleigh.alpha
        beta = spec.rayleigh.beta
    else:
        alpha, beta = rayleigh_factors(mass, stiffness, spec.damping)
    yield_shear = _find_yield_shear(spec, mass, height, period)
    plan = None if spec.plan is None else build_plan(spec.plan, mass, stiffness, yield_shear)
    law = storey_laws()[spec.storey_law]
    parameters = {key: getattr(spec, key) for key in key_parameters(law)}
    return Building(
        name,
        mass,
        height,
        stiffness,
        yield_shear,
        _fill_storeys(spec.hardening, spec.count),
        float(alpha),
        float(beta),
        None if spec.foundation == "fixed" else _build_foundation(spec.foundation),
        law,
        tuple((key, value) for key, value in parameters.items() if value is not None),
        _find_gravity_load(spec, mass),
        np.inf if isinstance(spec.collapse, str) else spec.collapse,
        spec.slab,
        0.0 if spec.columns == "none" else spec.columns,
        plan,
    )


def _find_stiffness(spec: Any, mass: np.ndarray) -> np.ndarray:
    """Return the storey stiffnesses [N/m], shape (storeys,)."""
    if spec.gives_stiffness_in_plan:
        return sum_stiffness(spec.plan)
    if spec.stiffness is None:
        return _find_finite_stiffness(mass, spec.period, spec.taper)
    if isinstance(spec.stiffness, StiffnessAtSpec):
        mass = _fill_storeys(spec.stiffness.mass, spec.count)
        return _find_finite_stiffness(mass, spec.stiffness.period, spec.taper)
    return np.array(spec.stiffness)


def _find_finite_stiffness(mass: np.ndarray, period: float, taper: float) -> np.ndarray:
    """Return the storey stiffnesses for a period [N/m].  Raises ValueError: they are too large for a number."""
    with np.errstate(over="ignore"):
        stiffness = stiffness_for_period(mass, period, taper)
    if not np.isfinite(stiffness).all():
        raise ValueError(f"a period of {period:g} s takes storeys of a stiffness above 1e308 N/m")
    return stiffness


def _find_yield_shear(spec: Any, mass: np.ndarray, height: np.ndarray, period: float) -> np.ndarray:
    """Return the storey yield shears [N], shape (storeys,)."""
    if spec.plan is not None and spec.plan.gives_yield_shear:
        return sum_yield_shear(spec.plan, spec.count)
    if spec.yield_shear is None:
        shears: np.ndarray = spec.yield_.overstrength * _build_design(spec.yield_).yield_shears(mass, height, period)
        return shears
    return np.full(spec.count, np.inf) if spec.yield_shear == "never" else np.array(spec.yield_shear)


def _find_gravity_load(spec: Any, mass: np.ndarray) -> np.ndarray | None:
    """Return the weight on every storey [N], shape (storeys,); None without P-Delta."""
    if isinstance(spec.p_delta, bool):
        return weight_above(mass) if spec.p_delta else None
    return np.array(spec.p_delta)


def _build_foundation(base: Any) -> Foundation:
    return Foundation(
        base.mass,
        base.sway_stiffness or 0.0,
        base.sway_damping,
        base.inertia,
        base.rocking_stiffness or 0.0,
        base.rocking_damping,
        base.sways,
        base.rocking_stiffness is not None,
        None if base.isolation is None else base.isolation.law,
    )


def _build_wall(name: str, spec: Any) -> Wall:
    if spec == "fixed":
        return Wall.build(name)
    height = UNLIMITED_HEIGHT if spec.height is None else spec.height
    if spec.stiffness is None:
        return Wall.build(name, height)
    return Wall.build(name, height, spec.mass, spec.stiffness, spec.damping)


def _fill_storeys(value: Any, storeys: int) -> np.ndarray:
    """Return a value for every storey, shape (storeys,)."""
    return np.array(value) if isinstance(value, tuple) else np.full(storeys, float(value))


def _build_design(code: Any) -> Design:
    """Return what sets the yield shears."""
    if isinstance(code, BaseShearSpec):
        return BaseShearDesign(code.base_shear, code.distribution)
    factors = {key: getattr(code, key) for key in ("rw", "k") if getattr(code, key) is not None}
    return UbcDesign(int(code.code[-4:]), code.zone, code.soil, code.importance, **factors)


def find_code_displacements(spec: Any, building: Building, arm: float | None = None) -> dict[str, np.ndarray]:
    """Return the displacement that a code expects, by the name of its rule [m], shape (n,), from the ground up.

    arm : place on floors that twist [m], whose displacement there counts their twist under forces through the centres
        of mass; None of floors that do not twist

    Rules whose factors the study does not give are left out. All follow from the static displacements under the design
    forces: those of the UBC times `UbcDesign.amplification`, those of the others from the forces of `base_shear` and
    `distribution`.
    """
    if spec.wall is not None or spec.yield_shear is not None:
        return {}
    if spec.plan is not None and spec.plan.gives_yield_shear:
        return {}
    code = spec.yield_
    design = _build_design(code)
    period = float(building.periods[0])
    elastic = design.displacements(building.mass, building.height, building.stiffness, period)
    if building.plan is not None and arm is not None:
        shears = design.yield_shears(building.mass, building.height, period)
        elastic = edge_displacement(building.plan, shears, arm)
    if isinstance(design, UbcDesign):
        return {UBC: design.amplification * elastic}
    displacements: dict[str, np.ndarray] = {}
    for rule in CODE_RULES:
        factors = [getattr(code, key.lower()) for key in (*rule.factors, *rule.options)]
        if rule.displacement is not None and None not in factors:
            displacements[rule.name] = rule.displacement(elastic, *factors)
    return displacements


def find_separation(left: Mapping[str, np.ndarray], right: Mapping[str, np.ndarray]) -> float:
    """Return the code separation of two neighbours at the lower roof [m]; NaN where one has none.

    It is the sum of their displacements by the UBC there (clauses of `UbcDesign.amplification`; the paper's "sum of
    the design maximum displacements").

    left, right : displacements that codes expect of both (`find_code_displacements`)
    """
    if UBC not in left or UBC not in right:
        return np.nan
    lower = min(left[UBC].size, right[UBC].size) - 1
    return float(left[UBC][lower] + right[UBC][lower])

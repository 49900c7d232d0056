"""From a building of the study file to `model.Building`: lists filled in, stiffness, yield shears derived."""

from __future__ import annotations

from dataclasses import MISSING
from typing import Any

import numpy as np

from pounding_cli.laws import storey_laws
from pounding_cli.model.building import Building, UnstableError, weight_above
from pounding_cli.model.code_design import BaseShearDesign, UbcDesign, code_separation
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.separation import ASCE7, EN1998, asce7_displacement, en1998_displacement
from pounding_cli.model.stiffness import frequencies, rayleigh_factors, stiffness_for_period
from pounding_cli.numbers import counted
from pounding_cli.study.building_schema import BaseShear, BuildingSpec, CodeDesign, FoundationSpec, StiffnessAt
from pounding_cli.study.law_keys import own_parameters
from pounding_cli.study.problems import Path, Problems, Tree
from pounding_cli.study.source import Node

_PER_STOREY = ("mass", "height", "hardening", "stiffness", "yield_shear", "p_delta")


def build(name: str, spec: BuildingSpec, root: Node | Tree, path: Path, problems: Problems) -> Building | None:
    """The building `spec` describes, or None with the reasons noted in `problems`."""
    told, problems = problems, Problems(problems.file)
    storeys = _storeys(spec, root, path, problems)
    if spec.period is None and spec.stiffness is None:
        problems.at(
            root,
            path,
            f"building '{name}' has neither 'period' nor 'stiffness'",
            "write e.g. `period: 0.36 s`",
        )
    code = spec.yield_ if spec.yield_shear is None else None
    design = _design(code, root, (*path, "yield"), problems) if code else None
    thinnest = min(spec.height) if isinstance(spec.height, tuple) else spec.height
    if spec.slab >= thinnest:
        message = f"a slab of {spec.slab:g} m is not thinner than a storey of {thinnest:g} m"
        problems.at(root, (*path, "slab"), message, "write the thickness of the floor slab, e.g. `slab: 25 cm`")
    foundation = _foundation(spec.foundation, root, (*path, "foundation"), problems)
    parameters = _law_parameters(spec, root, path, problems)
    built = None
    if not problems.found and storeys is not None:
        try:
            built = _derived(name, spec, storeys, design, foundation, parameters)
        except UnstableError as error:
            hint = "make it, or its foundation, stiffer or lighter, or write `p_delta: false`"
            problems.at(root, (*path, "p_delta"), str(error), hint)
        except (ValueError, FloatingPointError) as error:
            problems.at(root, path, str(error), "check the building's masses, heights, period and stiffness")
    told.extend(problems.found)
    return built


def _storeys(spec: BuildingSpec, root: Node | Tree, path: Path, problems: Problems) -> int | None:
    lengths = {key: len(value) for key in _PER_STOREY if isinstance(value := getattr(spec, key), tuple)}
    storeys = spec.storeys if spec.storeys is not None else next(iter(lengths.values()), None)
    if storeys is None:
        problems.at(root, path, "'storeys' is missing", "write the number of storeys, e.g. `storeys: 5`")
    if isinstance(spec.stiffness, StiffnessAt) and isinstance(spec.stiffness.mass, tuple):
        lengths["stiffness.mass"] = len(spec.stiffness.mass)
    for key, length in lengths.items():
        if storeys is not None and length != storeys:
            problems.at(
                root,
                (*path, *key.split(".")),
                f"{key} has {counted(length, 'value')} for {counted(storeys, 'storey')}",
                f"write {counted(storeys, 'value')} from the ground up, or "
                + ("`true` for the weight of the floors above" if key == "p_delta" else "one for all"),
            )
    return storeys


def _law_parameters(
    spec: BuildingSpec, root: Node | Tree, path: Path, problems: Problems
) -> tuple[tuple[str, float], ...]:
    """The parameters that only the building's storey law has, as given; what is missing or belongs to another law is
    noted."""
    law = storey_laws()[spec.storey_law]
    own = own_parameters(law)
    for owner in storey_laws().values():
        for name in own_parameters(owner).keys() - own.keys():
            if getattr(spec, name) is not None:
                message = f"'{name}' does not apply to storey_law: {law.name}"
                problems.at(root, (*path, name), message, f"remove it; it belongs to {owner.name}", key=True)
    given = {name: getattr(spec, name) for name in own}
    for name, value in given.items():
        if value is None and law.parameters()[name].default is MISSING:
            hint = f"storey_law: {law.name} needs it: {own[name].words}"
            problems.at(root, path, f"'{name}' is missing", hint)
    return tuple((name, value) for name, value in given.items() if value is not None)


def _design(
    code: CodeDesign | BaseShear, root: Node | Tree, path: Path, problems: Problems
) -> UbcDesign | BaseShearDesign | None:
    if isinstance(code, BaseShear):
        return BaseShearDesign(code.base_shear, code.distribution)
    old = code.code == "UBC-1985"
    wrong = "Rw" if old else "K"
    if (code.rw if old else code.k) is not None:
        right = "`K: 0.67`" if old else "`Rw: 12`"
        problems.at(root, (*path, wrong), f"{code.code} has no {wrong}", f"write {right} in its place", key=True)
        return None
    if old and code.k is None:
        problems.at(root, path, "'K' is missing: UBC-1985 needs it", "write K, e.g. `K: 0.67` for a ductile frame")
        return None
    if old and "zone" not in code.model_fields_set:
        problems.at(root, path, "'zone' is missing: UBC-1985 needs it", "write Z, e.g. `zone: 1` for zone 4")
        return None
    known = {"rw": code.rw} if code.rw is not None else {}
    known |= {"k": code.k} if code.k is not None else {}
    return UbcDesign(int(code.code[-4:]), code.zone, code.soil, code.importance, **known)


def _foundation(spec: FoundationSpec | str, root: Node | Tree, path: Path, problems: Problems) -> Foundation | None:
    if not isinstance(spec, FoundationSpec):
        return None
    sways, rocks = spec.sway_stiffness is not None, spec.rocking_stiffness is not None
    before = len(problems.found)
    for moves, stiffness, inert, dashpot in (
        (sways, "sway_stiffness", "mass", "sway_damping"),
        (rocks, "rocking_stiffness", "inertia", "rocking_damping"),
    ):
        if moves and getattr(spec, inert) == 0:
            message = f"'{inert}' is missing: '{stiffness}' needs it"
            problems.at(root, path, message, f"write {type(spec).model_fields[inert].description}, above 0")
        for key in (inert, dashpot):
            if not moves and getattr(spec, key) > 0:
                message = f"'{key}' has no effect without '{stiffness}'"
                problems.at(root, (*path, key), message, f"give '{stiffness}' too, or remove it")
    if not sways and not rocks:
        hint = "give 'sway_stiffness' or 'rocking_stiffness', or write `foundation: fixed`"
        problems.at(root, path, "this foundation cannot move", hint)
    if len(problems.found) > before:
        return None
    return Foundation(
        spec.mass, spec.sway_stiffness or 0.0, spec.sway_damping,
        spec.inertia, spec.rocking_stiffness or 0.0, spec.rocking_damping, sways, rocks,
    )  # fmt: skip


def _derived(
    name: str,
    spec: BuildingSpec,
    storeys: int,
    design: UbcDesign | BaseShearDesign | None,
    foundation: Foundation | None,
    parameters: tuple[tuple[str, float], ...],
) -> Building:
    mass, height, hardening = (_filled(getattr(spec, key), storeys) for key in ("mass", "height", "hardening"))
    if spec.stiffness is not None:
        stiffness = _stiffness(spec, storeys)
        period = 2 * np.pi / float(frequencies(mass, stiffness)[0])
    else:
        assert spec.period is not None
        period = spec.period
        stiffness = stiffness_for_period(mass, period, spec.taper)
    if design is not None:
        yield_shear = spec.yield_.overstrength * design.yield_shears(mass, height, period)
    elif spec.yield_shear == "never":
        yield_shear = np.full(storeys, np.inf)
    else:
        yield_shear = np.array(spec.yield_shear)
    if spec.rayleigh is not None:
        alpha, beta = spec.rayleigh.alpha, spec.rayleigh.beta
    else:
        alpha, beta = rayleigh_factors(mass, stiffness, spec.damping)
    law = storey_laws()[spec.storey_law]
    alpha, beta = float(alpha), float(beta)
    load = (weight_above(mass) if spec.p_delta else None) if isinstance(spec.p_delta, bool) else np.array(spec.p_delta)
    collapse = np.inf if isinstance(spec.collapse, str) else spec.collapse
    return Building(
        name, mass, height, stiffness, yield_shear, hardening, alpha, beta, foundation, law, parameters, load, collapse,
        spec.slab, spec.columns,
    )  # fmt: skip


def _stiffness(spec: BuildingSpec, storeys: int) -> np.ndarray:
    """The storey stiffnesses that are given [N/m], shape (n,): as a list, or by a period at certain masses."""
    if isinstance(spec.stiffness, StiffnessAt):
        return stiffness_for_period(_filled(spec.stiffness.mass, storeys), spec.stiffness.period, spec.taper)
    return np.array(spec.stiffness)


def _filled(value: Any, storeys: int) -> np.ndarray:
    return np.array(value) if isinstance(value, tuple) else np.full(storeys, float(value))


def design_displacements(spec: BuildingSpec, building: Building) -> np.ndarray | None:
    """Design displacements by the code that set the yield shears [m], shape (n,); None without one."""
    if spec.yield_shear is not None or isinstance(spec.yield_, BaseShear):
        return None
    design = _design(spec.yield_, Node({}, (0, 0), keys={}), (), Problems(""))
    assert isinstance(design, UbcDesign)
    return design.design_displacements(building.mass, building.height, building.stiffness, float(building.periods[0]))


def code_displacements(spec: BuildingSpec, building: Building) -> dict[str, np.ndarray]:
    """The displacement that a code expects, by the name of its rule [m], shape (n,), from the ground up; without the
    rules whose factors the study does not give.

    delta_M and d_s follow from the static displacements under the forces of `base_shear` and `distribution`.
    """
    yield_ = spec.yield_ if spec.yield_shear is None else None
    if not isinstance(yield_, BaseShear):
        return {}
    design = BaseShearDesign(yield_.base_shear, yield_.distribution)
    mass, height, stiffness = building.mass, building.height, building.stiffness
    elastic = design.elastic_displacements(mass, height, stiffness, float(building.periods[0]))
    found = {}
    if yield_.cd is not None and yield_.ie is not None:
        found[ASCE7] = asce7_displacement(elastic, yield_.cd, yield_.ie)
    if yield_.qd is not None:
        found[EN1998] = en1998_displacement(elastic, yield_.qd)
    return found


def separation(left: np.ndarray | None, right: np.ndarray | None) -> float | None:
    """Code separation of two neighbours at the lower roof [m]; None where no code designed one."""
    return None if left is None or right is None else float(code_separation(left, right)[-1])

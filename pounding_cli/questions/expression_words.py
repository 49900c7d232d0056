"""Expressions in words: with the usual names and units, and whether they depend on the contact stiffness."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.results.arrays import ResultArrays
from pounding_cli.results.columns import column_of
from pounding_cli.results.dataset import find_contacts
from pounding_cli.study.expressions.expression import CONTACT_QUANTITIES, QUANTITIES, TableQuantity
from pounding_cli.study.run_plan import Plan
from pounding_cli.variables import RESPONSE_VARIABLES, VARIABLES

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables


ON_CONTACT = "depends on the contact stiffness"
"""Stands beside such a number."""

_RESPONSES = {variable.name for variable in RESPONSE_VARIABLES}

CONTACT_NOTE = (
    "Where floors strike, accelerations, link forces and contact times depend on the contact stiffness, which is "
    "unknown: the first two grow with its square root."
)


def find_struck_buildings(
    plan: Plan, arrays: ResultArrays, case: int, analysis: int, points: Sequence[int]
) -> frozenset[int]:
    """Return the places of the buildings whose floors strike in a case and analysis, at any of some points.

    points : of the last axis; of the others all
    """
    if not plan.links.places:
        return frozenset()
    kind = arrays["kind"].values[..., case, :]
    impacts = arrays["impacts"].values[..., list(points), case, analysis, :, :]
    is_contact = find_contacts(plan, kind).reshape(-1, kind.shape[-1]).any(axis=0)
    is_struck = np.logical_and((impacts.reshape(-1, impacts.shape[-1]) > 0).any(axis=0), is_contact)
    return frozenset(
        building
        for place, struck in zip(plan.links.places, is_struck.tolist(), strict=True)
        if struck
        for building in (place.left, place.left + 1)
    )


def depends_on_contact(quantities: Sequence[TableQuantity], struck: frozenset[int]) -> bool:
    """Return whether a quantity of an expression depends on the contact stiffness, where some buildings strike.

    struck : places of these buildings, as `find_struck_buildings`
    """
    return any(
        part.name in CONTACT_QUANTITIES and (bool(struck) if part.building is None else part.building in struck)
        for part in quantities
    )


def find_output_unit(results: ResultTables, text: str, si: str) -> Unit:
    """Return the unit in which people read the values of an expression.

    It is that of the quantities of the expression where these agree, otherwise SI.

    text : the expression
    si : its SI unit; "" or "1" of a pure number
    """
    if si in ("", "1"):
        return Unit("", 1.0, "1")
    names = {name for name in re.findall(r"[^\W\d]\w*", text) if QUANTITIES.get(name) == si}
    units = {column_of(name, results.units).unit for name in names}
    return units.pop() if len(units) == 1 else Unit(si.replace("m/s2", "m/s²"), 1.0, si)


def describe_output(text: str) -> str:
    """Return an expression with its quantities as people call them: "largest V/V₀ in stiff"."""

    def rename(match: re.Match[str]) -> str:
        name = match[0]
        is_name_of_building = match.string[: match.start()].rstrip().endswith((" in", " of"))
        if name not in _RESPONSES or is_name_of_building:
            return name
        return VARIABLES[name].label or name.replace("_", " ")

    return re.sub(r"[^\W\d]\w*", rename, text).replace("largest largest", "largest")

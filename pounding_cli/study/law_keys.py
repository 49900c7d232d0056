"""The keys of a link that its law brings along: made from the parameters that the law declares."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any, Literal, get_type_hints

from pounding_cli.laws import link_laws
from pounding_cli.laws.law import LinkLaw, Parameter
from pounding_cli.study.base import optional
from pounding_cli.study.rules import STIFFNESS_FORM, StiffnessRule
from pounding_cli.study.units import Quantity

FROM_CASE = ("gap", "stiffness", "damping_ratio", "restitution", "tension_cut")
"""Parameters that a case gives, or `impact` where it does not, to the laws that have them."""

FROM_IMPACT = {"impact_stiffness": "stiffness", "dashpot": "dashpot"}
"""Parameters that are those of the impact element: its key for each."""


def own_parameters(law: type[LinkLaw]) -> dict[str, Parameter]:
    """The parameters of a law that no other key of a study gives, by name."""
    shared = (*FROM_CASE, *FROM_IMPACT)
    return {name: each.metadata["parameter"] for name, each in law.parameters().items() if name not in shared}


def law_keys() -> dict[str, tuple[Any, Any]]:
    """Type and default of the keys that laws bring along, as `pydantic.create_model` takes them."""
    found: dict[str, tuple[Any, Any]] = {}
    first: dict[str, tuple[type[LinkLaw], Parameter]] = {}
    for law in link_laws().values():
        types = get_type_hints(law)
        for name, declared in own_parameters(law).items():
            kind = _kind(law, name, types[name], declared)
            named = [one.name for one in link_laws().values() if name in own_parameters(one)]
            owners = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
            description = f"{owners}: {declared.words}"
            owner, known = first.setdefault(name, (law, declared))
            if known != declared:
                raise ValueError(f"two link laws mean different things by '{name}': {owner.name} and {law.name}")
            found[name] = (kind | None, optional(None, description))
    return found


def words_of(law: type[LinkLaw], name: str) -> type[StrEnum] | None:
    """The words that a law knows for a parameter; None where that is no choice of words."""
    given = get_type_hints(law)[name]
    return given if isinstance(given, type) and issubclass(given, StrEnum) else None


def _kind(law: type[LinkLaw], name: str, given: Any, declared: Parameter) -> Any:
    if given is bool:
        return bool
    if words_of(law, name) is not None:  # laws with one key may know different words for it
        owners = (one for one in link_laws().values() if name in own_parameters(one))
        return Literal[tuple(dict.fromkeys(str(word) for one in owners for word in words_of(one, name) or ()))]
    if declared.unit == "N/m":
        return Annotated[float | StiffnessRule, STIFFNESS_FORM]
    unit = "" if declared.unit == "-" else declared.unit
    words = name.replace("_", " ")
    low, high, ends = declared.low, declared.high, (declared.open_low, declared.open_high)
    return Annotated[float, Quantity(words, unit, f"1 {unit}".strip(), low, high, *ends)]

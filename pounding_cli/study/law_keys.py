"""The keys of a link or a building that a law brings along: made from the parameters that the law declares."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, Any, Literal, get_type_hints

from pydantic import AfterValidator, Field, GetJsonSchemaHandler

from pounding_cli.laws import contact_laws, link_laws, storey_laws
from pounding_cli.laws.law import Law, Parameter
from pounding_cli.study.base import optional
from pounding_cli.study.rules import STIFFNESS_FORM, StiffnessRule
from pounding_cli.study.units import Quantity, TextForm, refuse, whole_number

FROM_CASE = ("gap", "stiffness", "damping_ratio", "restitution", "tension_cut")
"""Parameters that a case gives, or `impact` where it does not, to the laws that have them."""

FROM_IMPACT = {"impact_stiffness": "stiffness", "dashpot": "dashpot"}
"""Parameters that are those of the impact element: its key for each."""


FROM_BUILDING = ("stiffness", "yield_shear", "hardening")
"""Parameters of storeys that other keys of a building give."""


class LawWord(TextForm):
    """The name of a law: one of `words`, or one that the study gives a law of its own."""

    def __init__(self, words: tuple[str, ...]) -> None:
        def read(value: Any) -> str:
            if isinstance(value, str) and value.strip() and (value != "none" or "none" in words):
                return value.strip()
            shown = "a mapping" if isinstance(value, dict) else "a list" if isinstance(value, list) else None
            shown = shown or ("nothing" if value is None else f"'{str(value)[:60]}'")
            raise refuse(f"{shown} is not known", f"write {', '.join(words)} or a name of `laws`")

        form = "; ".join((*(f"`{word}`" for word in words), "NAME of `laws`"))
        super().__init__(read, form, words)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [{"enum": list(self.examples)}, {"type": "string"}]}


def own_parameters(law: type[Law]) -> Mapping[str, Parameter]:
    """The parameters of a law that no other key of a study gives, by name."""
    return _own_parameters(law)  # type: ignore[arg-type]  # classes are hashable


@functools.cache
def _own_parameters(law: type[Law]) -> Mapping[str, Parameter]:
    shared = FROM_BUILDING if law.acts_on == "storey" else (*FROM_CASE, *FROM_IMPACT)
    return {name: each.metadata["parameter"] for name, each in law.parameters().items() if name not in shared}


def link_keys() -> dict[str, tuple[Any, Any]]:
    """Type and default of the keys that laws of links bring along, as `pydantic.create_model` takes them."""
    return _keys(link_laws())


def contact_keys() -> dict[str, tuple[Any, Any]]:
    """Those that laws of contact bring along, for the impact element."""
    return _keys(contact_laws())


def storey_keys() -> dict[str, tuple[Any, Any]]:
    """Those that laws of storeys bring along."""
    return _keys(storey_laws())


def _keys(laws: Mapping[str, type[Law]]) -> dict[str, tuple[Any, Any]]:
    found: dict[str, tuple[Any, Any]] = {}
    first: dict[str, tuple[type[Law], Parameter]] = {}
    for law in laws.values():
        types = get_type_hints(law)
        for name, declared in own_parameters(law).items():
            kind = _kind(laws, law, name, types[name], declared)
            named = [one.name for one in laws.values() if name in own_parameters(one)]
            owners = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
            description = f"{owners}: {declared.words}"
            owner, known = first.setdefault(name, (law, declared))
            if known != declared:
                raise ValueError(
                    f"two {law.acts_on} laws mean different things by '{name}': {owner.name} and {law.name}"
                )
            found[name] = (kind | None, optional(None, description))
    return found


def words_of(law: type[Law], name: str) -> type[StrEnum] | None:
    """The words that a law knows for a parameter; None where that is no choice of words."""
    given = get_type_hints(law)[name]
    return given if isinstance(given, type) and issubclass(given, StrEnum) else None


def _kind(laws: Mapping[str, type[Law]], law: type[Law], name: str, given: Any, declared: Parameter) -> Any:
    if given is bool:
        return bool
    if given is int:
        least, most = int(declared.low), int(declared.high)
        return Annotated[int, Field(ge=least, le=most), whole_number(least, most)]
    if words_of(law, name) is not None:
        known = dict.fromkeys(words_of(one, name) for one in laws.values() if name in own_parameters(one))
        choice: Any = Literal[tuple(dict.fromkeys(str(word) for some in known for word in some or ()))]
        # Laws of one key that know different words for it: whoever builds the law picks its own.
        # A function: from Python 3.12 on pydantic takes the signature of an Enum for that of another kind of validator.
        return Annotated[choice, AfterValidator(lambda word: given(word))] if len(known) == 1 else choice
    if declared.unit == "N/m":
        return Annotated[float | StiffnessRule, STIFFNESS_FORM]
    unit = "" if declared.unit == "-" else declared.unit
    words = name.replace("_", " ")
    low, high, ends = declared.low, declared.high, (declared.open_low, declared.open_high)
    default = law.parameters()[name].default
    example = default if declared.refusal(1.0) and isinstance(default, float) else 1.0
    return Annotated[float, Quantity(words, unit, f"{example:g} {unit}".strip(), low, high, *ends)]


def quantity_of(law: type[Law], name: str, example: str, absent: bool = False) -> Quantity:
    """How a study writes a parameter that a law declares; `absent`: 0 stands for what is not there."""
    declared: Parameter = law.parameters()[name].metadata["parameter"]
    words = name.replace("_", " ")
    unit = declared.unit.removesuffix("/rad")
    return Quantity(
        words, unit, example, declared.low, declared.high, declared.open_low and not absent, declared.open_high
    )


def words_about(law: type[Law], name: str) -> str:
    """What a parameter that a law declares means, with its unit."""
    return law.parameters()[name].metadata["parameter"].words

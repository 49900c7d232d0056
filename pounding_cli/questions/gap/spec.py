"""The section `gap:` of a study."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from pounding_cli.errors import Issue
from pounding_cli.model.separation import CODE_RULES, GB_SHARE, GB_STEP, CodeRule
from pounding_cli.questions.specs import ANNUAL_RATE, HAZARD_DESCRIPTION, Hazards, percents
from pounding_cli.study.schema.base import Model, one_or_many, spec_field
from pounding_cli.study.schema.quantity import ACCELERATION, ParsedText, Quantity, WholeNumber, refuse, written_unit


class Gb50011Spec(Model):
    """Settings of the joint of GB 50011-2010, clause 6.1.4."""

    intensity: Annotated[int, WholeNumber(min(GB_STEP), max(GB_STEP))] = spec_field(
        ..., "seismic fortification intensity, 6 to 9", 8
    )
    structure: Literal[tuple(GB_SHARE)] = spec_field("frame", "system of the building that needs the wider joint")  # type: ignore[valid-type]


_GROUND_ACCELERATION = ACCELERATION.replace(name="ground acceleration a_g", example="0.25 g", high=30.0)


def _read_ground_acceleration(value: Any) -> float:
    """Return an acceleration that is written with its unit.  Raises PydanticCustomError."""
    acceleration = float(_GROUND_ACCELERATION.read(value))
    if not written_unit(str(value)):
        raise refuse(f"'{value}' lacks its unit", f"write `{value} g`, or `{value} m/s2` if that is meant")
    return acceleration


class NtcSpec(Model):
    """Seismic action of the Italian code at the limit state of life safety (SLV)."""

    ag: Annotated[
        float, ParsedText(_read_ground_acceleration, "ground acceleration", ("0.25 g",), _GROUND_ACCELERATION)
    ] = spec_field(..., "ground acceleration a_g on rock at the limit state of life safety [m/s2]", "0.25 g")
    soil: Annotated[float, Quantity("soil factor S", "", "1.2", 1.0, 3.0)] = spec_field(
        1.0, "factor S of soil and topography [-]"
    )


NAMED_RULES = tuple(rule.name for rule in CODE_RULES if rule.by_name)
"""Rules that `codes` names."""


def _refuse_other_rules(value: Any) -> Any:
    """Return a value of `codes`.  Raises PydanticCustomError: a rule that other keys select."""
    rule = next((rule for rule in CODE_RULES if rule.name == value and not rule.by_name), None)
    if rule is None:
        return value
    if rule.section:
        hint = f"write the key `{rule.section}` in `gap`"
    else:
        hint = f"leave it out here, and write {format_needed_keys(rule)} of both buildings"
    raise refuse(f"'{value}' is not selected by its name", hint)


def format_needed_keys(rule: CodeRule) -> str:
    """Return the keys of a building that a rule needs: "`Cd` and `Ie` in `yield`"; those of the UBC set its design."""
    factors = rule.factors or ("code",)
    return f"{' and '.join(f'`{factor}`' for factor in factors)} in `yield`"


_NamedRule = Annotated[Literal[NAMED_RULES], BeforeValidator(_refuse_other_rules)]  # type: ignore[valid-type]


class GapSpec(Model):
    """Settings of `pound gap`."""

    percentiles: percents("percentile", "84 %") = spec_field(("84 %",), "percentiles over the motions, one or a list")  # type: ignore[valid-type]
    contact: percents("probability of contact", "10 %") = spec_field(  # type: ignore[valid-type]
        ("10 %",), "probabilities of contact, one or a list: the gap for each"
    )
    gb50011: Gb50011Spec | None = spec_field(None, "intensity and system for the joint of GB 50011-2010")
    ntc2018: NtcSpec | None = spec_field(None, "seismic action for the distance of NTC 2018, 7.2.1", {"ag": "0.25 g"})
    ntc2008: NtcSpec | None = spec_field(None, "seismic action for the distance of NTC 2008, 7.2.2", {"ag": "0.25 g"})
    codes: one_or_many(_NamedRule, as_list=True) | None = spec_field(  # type: ignore[valid-type]
        None, "further codes whose gap is told, one or a list", ["TBDY 2018", "E.030"]
    )
    hazard: Hazards | None = spec_field(
        None,
        f"{HAZARD_DESCRIPTION}; for `rate`, and for the rate of contact at the gaps of codes",
        {"0.1 g": 0.02, "0.4 g": "1/475"},
    )
    rate: Annotated[float, ANNUAL_RATE] | None = spec_field(None, "annual rate of contact: the gap for it", "1/2475")

    def issues(self) -> Iterator[Issue]:
        if self.rate is not None and self.hazard is None:
            yield Issue(
                ("rate",), "'rate' needs a hazard curve", "write `hazard: {0.1 g: 0.02, 0.4 g: 1/475}` beside it"
            )

    def select_rules(self) -> list[tuple[CodeRule, dict[str, Any]]]:
        """Return the rules of codes that may say something, each with its settings."""
        selected: list[tuple[CodeRule, dict[str, Any]]] = []
        for rule in CODE_RULES:
            settings = getattr(self, rule.section) if rule.section else None
            if (rule.section and settings is None) or (rule.by_name and rule.name not in (self.codes or ())):
                continue
            selected.append((rule, {} if settings is None else dict(settings)))
        return selected

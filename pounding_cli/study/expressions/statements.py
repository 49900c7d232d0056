"""The statements of a study: what should hold of its results, as comparisons over the tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError, Issue
from pounding_cli.study.expressions.comparison import Comparison, parse_comparison
from pounding_cli.study.expressions.expression import Scope, find_point, parse_expression
from pounding_cli.study.schema.quantity import Quantity, written_unit
from pounding_cli.study.schema.study import StatementSpec


@dataclass(frozen=True)
class Statement:
    """A statement of a study.

    name : short, for tables
    says, source, reading : its words, where they stand, how they are read
    comparisons : all of them hold where it does
    printed : what its number should be, by its source [SI]; None of one that compares
    over_motions : `mean`, `largest`, `smallest` or `each`
    """

    name: str
    says: str
    source: str
    reading: str
    comparisons: tuple[Comparison, ...]
    printed: float | None
    over_motions: str

    @property
    def needs_histories(self) -> bool:
        """Whether it rests on a number of an instant."""
        return any(part.instant is not None for each in self.comparisons for part in each.quantities)


def parse_statements(specs: tuple[StatementSpec, ...], scope: Scope) -> tuple[list[Statement], list[Issue]]:
    """Return the statements of a study, and what is wrong with them, by paths below `statements`."""
    statements: list[Statement] = []
    faults: list[Issue] = []
    for number, spec in enumerate(specs):
        name = spec.name or str(number + 1)
        if name in [each.name for each in statements]:
            faults.append(Issue((number, "name"), f"two statements are called '{name}'", "give one another name"))
        comparisons: list[Comparison] = []
        printed = None
        try:
            here = replace(scope, point=find_point(spec.at, scope.axes))
        except InputError as error:
            faults += error.below(number, "at").issues
            here = scope
        for place, text in enumerate(spec.holds):
            try:
                comparisons.append(parse_comparison(text, here))
            except InputError as error:
                faults += error.below(number, "holds", place).issues
        if spec.number is not None:
            try:
                comparison, printed = parse_number(spec, here)
                comparisons.append(comparison)
            except InputError as error:
                faults += error.below(number).issues
        statements.append(
            Statement(name, spec.says, spec.source, spec.reading, tuple(comparisons), printed, spec.over_motions)
        )
    return statements, faults


def parse_number(spec: StatementSpec, scope: Scope) -> tuple[Comparison, float]:
    """Return that a number is what its source prints, within what a statement allows, and what that is [SI].

    Raises
    ------
    InputError : what is wrong, at its key
    """
    assert spec.number is not None
    assert spec.is_ is not None
    assert spec.within is not None
    try:
        expression = parse_expression(spec.number, scope, written_unit(spec.is_) == "%")
    except InputError as error:
        raise error.below("number") from None
    printed = _read_value("is", spec.is_, expression.unit)
    if written_unit(spec.within) == "%" and printed:
        within = abs(printed) * _read_value("within", spec.within, "")
    else:
        within = _read_value("within", spec.within, expression.unit)
    if within < 0:
        raise InputError(f"'{spec.within}' lies below 0", "write by how much the number may differ").below("within")
    text = f"{expression} = {spec.is_}"
    return Comparison(
        text, (printed - within, expression, printed + within), ("<=", "<="), written_unit(spec.is_)
    ), printed


def _read_value(key: str, written: str, unit: str) -> float:
    """Return a value with its unit in SI.  Raises InputError."""
    example = f"3 {unit}".rstrip()
    hint = f"write e.g. `{key}: {example}`"
    try:
        number = float(Quantity(key, unit, example).read(written))
    except PydanticCustomError as error:
        raise InputError((error.context or {})["message"], hint).below(key) from None
    if unit and not written_unit(written):
        raise InputError(f"'{written}' has no unit", hint).below(key)
    return number


def iter_comparisons(statements: list[Statement]) -> Iterator[tuple[Statement, Comparison]]:
    """Yield every comparison with its statement."""
    for statement in statements:
        for comparison in statement.comparisons:
            yield statement, comparison

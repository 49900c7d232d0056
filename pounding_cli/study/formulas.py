"""`laws`: the laws of links that a study writes itself, each a formula with its parameters."""

from __future__ import annotations

import keyword
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from pounding_cli.laws import link_laws
from pounding_cli.laws.formula import GIVEN, WRITTEN, FormulaError, WrittenLaw
from pounding_cli.laws.law import LinkLaw
from pounding_cli.study.base import Model, Name, optional
from pounding_cli.study.problems import Problems, Tree
from pounding_cli.study.source import Node
from pounding_cli.study.units import Measured, TextForm, measured

_TRIED = 0.01
"""Gap [m] at which a formula is tried when it is read."""

_MEASURED = TextForm(measured, "number with any unit, or a plain number", ("20 kN/mm", "5e12 N/m^3", 0.2))


class LawSpec(Model):
    """A law of links of the study's own."""

    force: str = Field(
        description="its force [N]: a formula of v closing [m], r its rate [m/s], m reduced mass of the floors [kg], "
        "d gap [m] and the parameters; + - * / **, brackets and sqrt()",
        examples=["k*v + c*r"],
    )
    parameters: dict[Name, Annotated[Measured, _MEASURED]] = optional(
        {}, description="constants of the formula by name", examples=[{"k": "20 kN/mm", "c": "2 MN s/m"}]
    )
    acts: Literal["beyond gap", "compression", "always"] = optional(
        "beyond gap",
        description="`beyond gap`: once the gap has closed, with v = closing - gap; `compression`: while the closing v "
        "is above zero, as for material that fills the gap; `always`: as for a damper",
    )
    tension_cut: bool = optional(False, description="no force that pulls the floors together")


@dataclass(frozen=True)
class OwnLaw:
    """A law of the study: its class, and what all links of it share. `law` is None where it is faulty."""

    law: type[WrittenLaw]
    shared: Mapping[str, object]
    sound: bool = True

    def between(self, gap: float) -> WrittenLaw:
        """The law across a gap [m].  Raises FormulaError."""
        return self.law(gap, **self.shared)  # type: ignore[arg-type]  # by name


OwnLaws = Mapping[str, OwnLaw]


def law_class(word: str, own: OwnLaws) -> type[LinkLaw] | None:
    """The class of a law by its name; None for an unknown one."""
    return own[word].law if word in own else link_laws().get(word)


def known_laws(own: OwnLaws) -> tuple[str, ...]:
    """The names of all laws that a link of the study can have."""
    return (*link_laws(), *own)


def own_laws(specs: Mapping[str, LawSpec], root: Node | Tree, problems: Problems) -> dict[str, OwnLaw]:
    """The laws of a study by name; what is wrong with them is noted in `problems`."""
    found = {}
    for name, spec in specs.items():
        path = ("laws", name)
        before = len(problems.found)
        if name in (*link_laws(), "none", "apart"):
            problems.at(root, path, f"'{name}' is a law of this program", "give yours another name", key=True)
        for parameter in spec.parameters:
            if not parameter.isidentifier() or keyword.iskeyword(parameter) or parameter in (*GIVEN, "sqrt"):
                message = f"'{parameter}' cannot be a parameter"
                hint = f"write a name of letters, digits and _ other than {', '.join(GIVEN)} and sqrt"
                problems.at(root, (*path, "parameters", parameter), message, hint, key=True)
        constants = tuple((key, value.value, value.dimension) for key, value in spec.parameters.items())
        shared = {
            "called": name, "formula": spec.force.strip(), "constants": constants, "tension_cut": spec.tension_cut,
        }  # fmt: skip
        own = OwnLaw(WRITTEN[spec.acts], shared)
        if len(problems.found) == before:
            try:
                own.between(_TRIED)
            except FormulaError as error:
                _note(error, root, path, problems)
            except ValueError as error:
                problems.at(root, (*path, "force"), f"{error}", "write a shorter formula")
        found[name] = OwnLaw(own.law, shared, len(problems.found) == before)
    return found


def _note(error: FormulaError, root: Node | Tree, path: tuple[str, ...], problems: Problems) -> None:
    """Place what is wrong with a formula at its character of the file."""
    line, column = root.locate((*path, "force"))
    node = root.get(*path, "force")
    text = node.text if node is not None else ""
    if node is not None and error.line == 0 and "\n" not in text:
        column += error.column + len(text) - len(text.lstrip()) + node.quoted
    problems.add((line, column), f"force: {error.message}", error.hint)

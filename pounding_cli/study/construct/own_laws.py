"""Laws of links that a study writes itself, as a formula under `laws`."""

from __future__ import annotations

import keyword
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.laws import link_laws
from pounding_cli.laws.apart import Apart
from pounding_cli.laws.formula import FORMULA_VARIABLES, WRITTEN_LAWS, WrittenLaw
from pounding_cli.study.schema.links import NO_LINK
from pounding_cli.study.text.file import Map, QuotedText, get, locate

_TRIAL_GAP = 0.01
"""Gap [m] at which a formula is tried when it is read."""


@dataclass(frozen=True)
class OwnLaw:
    """A law of the study's own.

    formula : its force
    constants : name, value in SI and powers of kg, m and s of every parameter
    """

    name: str
    formula: str
    constants: tuple[tuple[str, float, Any], ...]
    acts: str
    tension_cut: bool

    @property
    def is_contact(self) -> bool:
        """True of a law that acts across a gap, as floors that strike each other do."""
        return bool(WRITTEN_LAWS[self.acts].subtracts_gap)

    def build(self, gap: float) -> WrittenLaw:
        """Return the law across a gap [m].  Raises InputError, ValueError: the formula cannot be read."""
        return WRITTEN_LAWS[self.acts](
            gap, called=self.name, formula=self.formula, constants=self.constants, tension_cut=self.tension_cut
        )


def build_own_laws(specs: Mapping[str, Any], tree: Map) -> dict[str, OwnLaw]:
    """Return the laws of a study by name.

    tree : the file, whose places a formula that cannot be read is told by

    Raises
    ------
    InputError : a name is taken, or a formula cannot be read
    """
    issues: list[Issue] = []
    laws: dict[str, OwnLaw] = {}
    for name, spec in specs.items():
        path: KeyPath = ("laws", name)
        if name in (*link_laws(), NO_LINK, Apart.name):
            message = f"'{name}' is a law of this program"
            issues.append(Issue(path, message, "give yours another name", at_key=True))
            continue
        constants = tuple((key, value.value, value.dimension) for key, value in spec.parameters.items())
        law = OwnLaw(name, spec.force.strip(), constants, spec.acts, spec.tension_cut)
        found = _find_bad_parameters(spec, path) or _try_formula(law, path, tree)
        issues += found
        laws[name] = law
    if issues:
        raise InputError(issues)
    return laws


def _find_bad_parameters(spec: Any, path: KeyPath) -> list[Issue]:
    """Return an issue for every parameter that a formula cannot name."""
    issues = []
    for parameter in spec.parameters:
        if not parameter.isidentifier() or keyword.iskeyword(parameter) or parameter in (*FORMULA_VARIABLES, "sqrt"):
            hint = f"write a name of letters, digits and _ other than {', '.join(FORMULA_VARIABLES)} and sqrt"
            key_path = (*path, "parameters", parameter)
            issues.append(Issue(key_path, f"'{parameter}' cannot be a parameter", hint, at_key=True))
    return issues


def _try_formula(law: OwnLaw, path: KeyPath, tree: Map) -> list[Issue]:
    """Return what is wrong with a formula, at its place in the text."""
    key_path = (*path, "force")
    try:
        law.build(_TRIAL_GAP)
    except InputError as error:
        begin = _find_beginning(key_path, tree)
        return [
            replace(
                each,
                path=key_path,
                message=f"force: {each.message}",
                offset=0 if begin is None else begin + each.offset,
            )
            for each in error.issues
        ]
    except ValueError as error:
        return [Issue(key_path, str(error), "write a shorter formula")]
    return []


def _find_beginning(path: KeyPath, tree: Map) -> int | None:
    """Return how many characters of a value stand before its formula; None in Python data and in blocks, and of a
    number, of which the schema makes the formula."""
    text = get(tree, *path)
    _, column = locate(tree, path)
    if not isinstance(text, str) or "\n" in text or not isinstance(column, int):
        return None
    return len(text) - len(text.lstrip()) + isinstance(text, QuotedText)

"""The links of a case with every value that the case and `impact` give them, and what is wrong with their keys."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.laws import KELVIN_VOIGT, link_laws
from pounding_cli.laws.pounding import damping_ratio, restitution_from_damping
from pounding_cli.study.construct.link_names import Names
from pounding_cli.study.schema.links import (
    LINK_PLACE_KEYS,
    LOSSES,
    NO_LINK,
    POUNDING,
    SHARED_KEYS,
    LinkSpec,
    SeveralLinksSpec,
    link_keys,
    list_links,
    list_words,
    needs_key,
    own_parameters,
    refuse_beside_links,
    refuse_key,
)
from pounding_cli.study.text.issues import IssuesFound

DEFAULT_RESTITUTION = 0.5
"""Coefficient of restitution where neither a link nor `impact` gives one or a damping ratio [-]."""


@dataclass(frozen=True, eq=False)
class CompleteLink:
    """A link with everything that it, its case and `impact` say of it.

    spec, path : the link as written, and where it stands
    law : the name of its law; of pounding, the law of contact that `impact` names
    values : what is written of the keys of its law
    paths : where each of these values stands
    """

    spec: LinkSpec
    path: KeyPath
    law: str
    values: Mapping[str, Any]
    paths: Mapping[str, KeyPath]

    @property
    def law_class(self) -> Any:
        """The class of its law; None of a law of the study's own, and of no link."""
        return link_laws().get(self.law)

    @property
    def title(self) -> str:
        """The name of its law in messages."""
        return self.law if self.law == self.spec.link else f"{POUNDING} of {self.law}"


def complete_links(name: str, case: Any, impact: Any) -> tuple[CompleteLink, ...]:
    """Return the links of a case with what the case and `impact` say of them.

    A link takes from its case what its law has, except for a stiffness, which does not say whose it is; a law of
    contact takes the rest from `impact`, others only losses and the tension cut. The stiffness of `impact` is not among
    the values: `build_laws` takes it where a link has none.
    """
    shared = case if isinstance(case, SeveralLinksSpec) else None
    return tuple(_complete_link(link, path, shared, name, impact) for link, path in list_links(name, case))


def _complete_link(link: LinkSpec, path: KeyPath, case: Any, name: str, impact: Any) -> CompleteLink:
    law_name = impact.law if link.link == POUNDING and impact.law != KELVIN_VOIGT else link.link
    keys = _keys_of_law(law_name)
    law = link_laws().get(law_name)
    keys_of_impact = keys - {"stiffness"} if law is not None and law.subtracts_gap else keys & {*LOSSES, "tension_cut"}
    sources: list[tuple[Any, KeyPath, Collection[str]]] = [(link, path, keys)]
    if case is not None:
        sources.append((case, ("cases", name), keys - {"stiffness"}))
    sources.append((impact, ("impact",), keys_of_impact))
    values: dict[str, Any] = {}
    paths: dict[str, KeyPath] = {}
    for source, place, taken in sources:
        has_loss = any(loss in values for loss in LOSSES)
        for key in source.model_fields_set:
            value = getattr(source, key)
            if key in taken and key not in values and value is not None and not (has_loss and key in LOSSES):
                values[key] = value
                paths[key] = (*place, key)
    return CompleteLink(link, path, law_name, values, paths)


def _keys_of_law(law_name: str) -> frozenset[str]:
    """Return the keys that a link of a law takes; of a law of the study's own the gap alone."""
    law = link_laws().get(law_name)
    if law is not None:
        return link_keys(law)
    return frozenset() if law_name == NO_LINK else frozenset({"gap"})


def check_links(
    name: str, case: Any, links: tuple[CompleteLink, ...], names: Names, left_out: Collection[str] = ()
) -> tuple[CompleteLink, ...]:
    """Return the links of a case unchanged; those of unknown laws are not looked at.

    left_out : keys that `impact` has, but faulty

    Raises
    ------
    IssuesFound : a key is missing, does not apply to the law of its link, or to no link of the case
    """
    known = [link for link in links if link.law in (*link_laws(), *names.laws, NO_LINK)]
    issues = [issue for link in known for issue in find_key_issues(link, left_out)]
    if isinstance(case, SeveralLinksSpec) and len(known) == len(links):
        issues += find_idle_shared_keys(name, case, links)
    if issues:
        raise IssuesFound(issues)
    return links


def find_key_issues(link: CompleteLink, left_out: Collection[str] = ()) -> list[Issue]:
    """Return what is wrong with the keys of a link: missing, not of its law, or a word that its law does not know.

    left_out : keys that are written, but faulty
    """
    if link.law == NO_LINK:
        return []
    return [*_find_missing_keys(link, left_out), *_find_idle_keys(link), *_find_unknown_words(link)]


def find_idle_shared_keys(name: str, case: SeveralLinksSpec, links: Sequence[CompleteLink]) -> list[Issue]:
    """Return an issue for every key beside `links:` that none of them takes."""
    taken = frozenset().union(*(_keys_of_law(link.law) - {"stiffness"} for link in links))
    idle = [key for key in case.model_fields_set if key != "links" and key not in taken]
    return [Issue(("cases", name, key), *refuse_beside_links(key), at_key=True) for key in idle]


def _find_missing_keys(link: CompleteLink, left_out: Collection[str]) -> list[Issue]:
    """Return an issue for every key that a law needs and nothing gives."""
    issues = []
    given = {*link.values, *left_out}
    if "gap" not in given:
        field = SHARED_KEYS["gap"][1]
        hint = f"write {field.description}, e.g. `gap: {field.examples[0]}`"
        issues.append(Issue(link.path, "'gap' is missing", hint))
    law = link.law_class
    for key, declared in own_parameters(law).items() if law is not None else ():
        if needs_key(law, key) and key not in given:
            contact = " here or under `impact`" if law.subtracts_gap else ""
            message = f"a {law.name} needs it{contact}: {declared.description}"
            issues.append(Issue(link.path, f"'{key}' is missing", message))
    return issues


def _find_idle_keys(link: CompleteLink) -> list[Issue]:
    """Return an issue for every key of a link as written that its law does not have."""
    law = link.law_class
    keys = _keys_of_law(link.law)
    issues = []
    ordered = [key for key in type(link.spec).model_fields if key in keys]
    for key in link.spec.model_fields_set - {*LINK_PLACE_KEYS} - keys:
        issues.append(Issue((*link.path, key), *refuse_key(key, link.title, ordered), at_key=True))
    ratio = link.values.get("damping_ratio")
    if law is not None and ratio is not None and {*LOSSES} & law.parameters().keys() == {"restitution"}:
        message = f"'damping_ratio' is that of a Kelvin-Voigt contact; a {law.name} takes 'restitution'"
        hint = f"write `restitution: {restitution_from_damping(ratio):.3g}`, the e of that ratio there"
        issues.append(Issue(link.paths["damping_ratio"], message, hint, at_key=True))
    return issues


def _find_unknown_words(link: CompleteLink) -> list[Issue]:
    """Return an issue for every word that the law of a link does not know, though another law does."""
    issues = []
    for key, value in link.values.items() if link.law_class is not None else ():
        words = list_words(link.law_class, key)
        if words and value not in words:
            known = ", ".join(f"'{word}'" for word in words[:-1])
            choice = f"{known} or '{words[-1]}'" if known else f"'{words[-1]}'"
            is_here = link.paths[key][:-1] == link.path
            message = f"{key}: '{value}' is not known to link: {link.title}"
            hint = f"write {choice}" if is_here else f"write `{key}:` in this link: {choice}"
            issues.append(Issue(link.paths[key] if is_here else link.path, message, hint))
    return issues


def find_losses(values: Mapping[str, Any], law: Any) -> dict[str, float]:
    """Return damping ratio and coefficient of restitution of a link [-]: one is given, the other follows from it.

    Empty for a law that takes neither. What gives neither has that of a restitution of DEFAULT_RESTITUTION.
    """
    ratio = values.get("damping_ratio")
    restitution = values.get("restitution")
    if ratio is not None:
        return {"damping_ratio": ratio, "restitution": restitution_from_damping(ratio)}
    if restitution is None:
        if not link_keys(law) & {*LOSSES}:
            return {}
        restitution = DEFAULT_RESTITUTION
    return {"damping_ratio": damping_ratio(restitution) + 0.0, "restitution": restitution}  # no negative zero at e = 1

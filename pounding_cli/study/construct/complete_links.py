"""From what a study says of the links of a case to their laws.

The steps, as `resolve` and `links_between` take them:

1. `check_link_names` (`link_names.py`): laws, buildings and pairs that links name are there.
2. `complete_links`: a link gets the values that it, its case and `impact` give the keys of its law.
3. `check_links`: no key is missing, and none is of another law.
4. `list_multiples` and `evaluate_multiples`: stiffnesses such as `20 x stiffest storey` in N/m.
5. `build_laws`: the values, by their names, are the parameters of the class of the law.

A parameter that is added to a law in `laws/` passes all of them by its name, as `schema/links.py` makes a key of it.
Two things do not pass by their name: of the keys of losses one follows from the other (`find_losses`), and some
parameters come from `impact` (`_build_law`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.laws import KELVIN_VOIGT, link_laws
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import DashpotLaw, damping_ratio, restitution_from_damping
from pounding_cli.study.construct.group import Group
from pounding_cli.study.construct.link_names import Names
from pounding_cli.study.construct.link_places import Floors
from pounding_cli.study.construct.own_laws import OwnLaw
from pounding_cli.study.schema.links import (
    LINK_PLACE_KEYS,
    LOSSES,
    NO_LINK,
    POUNDING,
    SHARED_KEYS,
    LinkSpec,
    SeveralLinksSpec,
    key_parameters,
    link_keys,
    list_links,
    list_words,
    needs_key,
    refuse_beside_links,
    refuse_key,
    to_enum,
)
from pounding_cli.study.schema.quantity import LINK_STIFFNESS, StoreyMultiple
from pounding_cli.study.text.issues import Issues

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


# Values


def complete_links(name: str, case: Any, impact: Any) -> tuple[CompleteLink, ...]:
    """Return the links of a case with what the case and `impact` say of them.

    A link takes from its case what its law has, except for a stiffness, which does not say whose it is; a law of
    contact takes the rest from `impact`, others only losses and the tension cut. The stiffness of `impact` is not among
    the values: `build_laws` takes it where a link has none.
    """
    shared = case if isinstance(case, SeveralLinksSpec) else None
    return tuple(_complete_link(link, path, shared, name, impact) for link, path in list_links(name, case))


def _complete_link(link: LinkSpec, path: KeyPath, case: Any, name: str, impact: Any) -> CompleteLink:
    """Return a link with its own values, then those of its case, then those of `impact`: the first one of a key counts.

    case : with several links; None of a link that is the case itself
    """
    law_name = impact.law if link.link == POUNDING and impact.law != KELVIN_VOIGT else link.link
    keys = _keys_of_law(law_name)
    law = link_laws().get(law_name)
    is_contact = law is not None and law.subtracts_gap
    keys_of_impact = keys - {"stiffness"} if is_contact else keys & {*LOSSES, "tension_cut"}
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


# Keys


def check_links(name: str, case: Any, links: tuple[CompleteLink, ...], names: Names) -> tuple[CompleteLink, ...]:
    """Return the links of a case unchanged; those of unknown laws are not looked at.

    Raises
    ------
    InputError : a key is missing, does not apply to the law of its link, or to no link of the case
    """
    known = [link for link in links if link.law in (*link_laws(), *names.laws, NO_LINK)]
    issues: list[Issue] = []
    for link in known:
        if link.law != NO_LINK:
            issues += [*_find_missing_keys(link), *_find_idle_keys(link), *_find_unknown_words(link)]
    if isinstance(case, SeveralLinksSpec) and len(known) == len(links):
        issues += _find_idle_shared_keys(name, case, links)
    if issues:
        raise InputError(issues)
    return links


def _find_idle_shared_keys(name: str, case: SeveralLinksSpec, links: Sequence[CompleteLink]) -> list[Issue]:
    """Return an issue for every key beside `links:` that none of them takes."""
    taken = frozenset().union(*(_keys_of_law(link.law) - {"stiffness"} for link in links))
    idle = [key for key in case.model_fields_set if key != "links" and key not in taken]
    return [Issue(("cases", name, key), *refuse_beside_links(key), at_key=True) for key in idle]


def _find_missing_keys(link: CompleteLink) -> list[Issue]:
    """Return an issue for every key that a law needs and nothing gives."""
    issues = []
    if "gap" not in link.values:
        field = SHARED_KEYS["gap"][1]
        hint = f"write {field.description}, e.g. `gap: {field.examples[0]}`"
        issues.append(Issue(link.path, "'gap' is missing", hint))
    law = link.law_class
    for key, declared in key_parameters(law).items() if law is not None else ():
        if needs_key(law, key) and key not in link.values:
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


# Laws


def list_multiples(links: Sequence[CompleteLink], impact: Any) -> tuple[StoreyMultiple, ...]:
    """Return the stiffnesses of links that are multiples of a storey's, each once."""
    multiples: dict[StoreyMultiple, None] = {}
    for link in links:
        law = link.law_class
        if law is None:
            continue
        stiffnesses = [value for key, value in link.values.items() if key != "stiffness"]
        stiffnesses.append(link.values.get("stiffness") or _default_stiffness(law, impact))
        if "impact_stiffness" in law.parameters():
            stiffnesses.append(impact.stiffness)
        multiples |= {each: None for each in stiffnesses if isinstance(each, StoreyMultiple)}
    return tuple(multiples)


def evaluate_multiples(multiples: Sequence[StoreyMultiple], group: Group) -> tuple[tuple[StoreyMultiple, float], ...]:
    """Return multiples of a storey's stiffness, each with what it comes to [N/m]."""
    return tuple((multiple, group.stiffness(multiple)) for multiple in multiples)


def _default_stiffness(law: Any, impact: Any) -> Any:
    """Return the stiffness of a link that gives none: that of its law, else that of `impact`."""
    return LINK_STIFFNESS.read(law.stiffness_default) if law.stiffness_default else impact.stiffness


def build_laws(
    links: Sequence[CompleteLink],
    impact: Any,
    laws: Mapping[str, OwnLaw],
    multiples: Sequence[tuple[StoreyMultiple, float]],
    floors: Floors,
) -> tuple[LinkLaw | None, ...]:
    """Return the law of every link of a case; None of no link.

    Raises
    ------
    InputError : the parameters of a law do not go together, of a link that joins something
    """
    issues = Issues()
    built = []
    for number, link in enumerate(links):
        law = None
        may_be_at_columns = link.spec.at is not None or (link.law_class is not None and not link.law_class.joins)
        joins = may_be_at_columns or any(of_pair[number] for of_pair in floors)
        found: Sequence[Issue] = ()
        try:
            law = _build_law(link, impact, laws, dict(multiples))
        except InputError as refused:
            found = refused.issues
        except ValueError as error:
            found = [Issue(link.path, str(error).removeprefix("link: "), "correct it")]
        if joins:
            issues.add_written(found)
        built.append(law)
    issues.check()
    return tuple(built)


def _build_law(
    link: CompleteLink, impact: Any, laws: Mapping[str, OwnLaw], multiples: Mapping[Any, float]
) -> LinkLaw | None:
    """Return the law of a link; None of no link.

    Raises
    ------
    InputError, ValueError : its parameters do not go together, or one is outside its range
    """
    if link.law == NO_LINK:
        return None
    law = link.law_class
    if law is None:
        return laws[link.law].build(link.values["gap"])
    values = {
        "stiffness": _default_stiffness(law, impact),
        "impact_stiffness": impact.stiffness,
        "dashpot": DashpotLaw(impact.dashpot),
        "tension_cut": impact.tension_cut,
        **link.values,
        **find_losses(link.values, law),
    }
    parameters = {name: to_enum(law, name, values[name]) for name in law.parameters() if name in values}
    parameters = {
        name: multiples[value] if isinstance(value, StoreyMultiple) else value for name, value in parameters.items()
    }
    numbers = {name: value for name, value in parameters.items() if isinstance(value, float)}
    if conflict := law.find_conflict(**numbers):
        key, message, hint = conflict
        raise InputError([Issue(link.paths.get(key, (*link.path, key)), message, hint)])
    built: LinkLaw = law(**parameters)
    return built


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

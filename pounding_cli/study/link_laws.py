"""The law of one link from the mappings of a study that speak about it, the nearest first."""

from __future__ import annotations

import difflib
import functools
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field
from typing import Any

from pounding_cli.laws import KELVIN_VOIGT, contact_laws, link_laws
from pounding_cli.laws.dashpot import DashpotLaw, damping_ratio, restitution_of
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.meetings import Strike
from pounding_cli.study.case_schema import Impact, LinkSpec, ListedLink
from pounding_cli.study.formulas import OwnLaws, known_laws, law_class
from pounding_cli.study.law_keys import FROM_CASE, own_parameters, words_of
from pounding_cli.study.problems import Path, Problems, Tree, nearest
from pounding_cli.study.rules import StiffnessRule, read_stiffness
from pounding_cli.study.source import Node


@dataclass(frozen=True)
class Group:
    """The buildings of a group and what else the links of a case depend on besides the case.

    buildings, types : buildings by place and by name
    common, strikes : of each pair of neighbours the floors that meet, and the slabs that strike columns whose share of
        the storey is known
    impact : the impact element; laws : those of the study's own, by name
    Where the group is not sound an empty one stands in for it, so that its cases can be checked all the same:
    `buildings` and `common` are empty then, and `defined` still holds every name that the file defines.
    """

    buildings: Sequence[Building]
    types: Mapping[str, Building]
    common: Sequence[Sequence[tuple[int, int]]]
    impact: Impact
    defined: Sequence[str]
    laws: OwnLaws = field(default_factory=dict)
    strikes: Sequence[Sequence[Strike]] = ()

    @property
    def is_empty(self) -> bool:
        return not self.buildings

    @functools.cached_property
    def floors(self) -> tuple[tuple[tuple[int, int], ...], ...]:
        """`common`, to be looked up by."""
        return tuple(map(tuple, self.common))

    @functools.cached_property
    def _stiffnesses(self) -> dict[StiffnessRule, float | None]:
        return {}

    def stiffness(self, rule: StiffnessRule) -> float | None:
        """What a rule gives [N/m]; None where its building, or the group, is not sound."""
        if rule not in self._stiffnesses:
            buildings = list(self.buildings)
            if rule.building is not None:
                buildings = [self.types[rule.building]] if rule.building in self.types else []
            of = max if rule.which == "stiffest" else _mean
            most = max((float(of(b.stiffness.tolist())) for b in buildings), default=None)
            self._stiffnesses[rule] = None if most is None else rule.factor * most
        return self._stiffnesses[rule]


@dataclass(frozen=True)
class Layer:
    """One mapping that speaks about a link: the nearest comes first."""

    spec: LinkSpec | ListedLink
    path: Path


def says(layers: Sequence[Layer], key: str) -> Any:
    """What the nearest layer that gives `key` says; the default of the outermost otherwise."""
    for layer in layers:
        if key in layer.spec.model_fields_set:
            return getattr(layer.spec, key)
    return getattr(layers[-1].spec, key, None)


def where(layers: Sequence[Layer], key: str) -> Path:
    for layer in layers:
        if key in layer.spec.model_fields_set:
            return (*layer.path, key)
    return layers[0].path


class LawReader:
    """Builds laws of links and notes what is wrong with them."""

    def __init__(self, group: Group, root: Node | Tree, problems: Problems) -> None:
        self.group, self.root, self.problems = group, root, problems
        self.rules: dict[StiffnessRule, float | None] = {}  # that were asked for, and what they gave

    def refuse(self, path: Path, message: str, hint: str, key: bool = False) -> None:
        self.problems.at(self.root, path, message, hint, key)

    def law(self, layers: list[Layer]) -> LinkLaw | None:
        """The law of a link; None where there is none, or where something is wrong."""
        named = says(layers, "link")
        if named is None:
            known = ", ".join((*list(link_laws())[1:], "or none")).replace(", or", " or")
            self.refuse(layers[0].path, "'link' is missing", f"write `link: pounding`, {known}")
            return None
        if named == "none":
            return None
        word = self.contact() if named == Pounding.name else named
        law = None if word is None else self.known(word, where(layers, "link"))
        if word is None or law is None:
            return None
        gap = says(layers, "gap")
        if gap is None:
            self.refuse(
                layers[0].path,
                "'gap' is missing",
                "write the distance between the buildings, e.g. `gap: 5 cm`, or `gap: 0 cm`",
            )
            return None
        if self._conflicts(law, layers, gap=gap):
            return None
        self._refuse_keys_of_others(named, law, layers)
        impact = self.value(self.group.impact.stiffness, ("impact", "stiffness"))
        stiffness = self._stiffness(named, law, layers)
        if impact is None or stiffness is None:
            return None
        if self._conflicts(law, layers, gap=gap, stiffness=stiffness, impact_stiffness=impact):
            return None
        cut = says(layers, "tension_cut")
        losses = self._losses(law, layers)
        if losses is None:
            return None
        ratio, restitution = losses
        given = {
            "gap": gap,
            "stiffness": stiffness,
            "impact_stiffness": impact,
            "damping_ratio": ratio,
            "restitution": restitution,
            "tension_cut": self.group.impact.tension_cut if cut is None else cut,
            "dashpot": DashpotLaw(self.group.impact.dashpot),
        }
        values = {name: given[name] for name in law.parameters() if name in given}
        for name in own_parameters(law):
            own = self._own(name, law, layers)
            if own is None:
                return None
            values[name] = own
        own_law = self.group.laws.get(word)
        if own_law is not None and not own_law.sound:
            return None
        try:
            return law(**values) if own_law is None else own_law.between(gap)
        except ValueError as error:
            self.refuse(layers[0].path, str(error).removeprefix("link: "), "correct it")
            return None

    def contact(self) -> str | None:
        """What `link: pounding` stands for: the law of contact that `impact` names; notes one that is none."""
        law = self.group.impact.law
        if law == KELVIN_VOIGT:
            return Pounding.name
        found = law_class(law, self.group.laws)
        if found is not None and found.subtracts_gap and found is not Pounding:
            return law
        written = (name for name, own in self.group.laws.items() if own.law.subtracts_gap)
        hint = f"write {', '.join((*contact_laws(), *written))}"
        self.refuse(("impact", "law"), f"'{law[:60]}' is not a law of contact", hint)
        return None

    def known(self, word: str, path: Path) -> type[LinkLaw] | None:
        """The class of a law by its name; notes an unknown one."""
        law = law_class(word, self.group.laws)
        if law is None:
            names = known_laws(self.group.laws)
            close = difflib.get_close_matches(word, names, 1, 0.5)
            hint = (f"did you mean '{close[0]}'? " if close else "") + f"write {', '.join(names)} or none"
            self.refuse(path, f"link: '{word[:60]}' is not known", f"{hint}; a law of your own stands under `laws`")
        return law

    def _conflicts(self, law: type[LinkLaw], layers: list[Layer], **values: float) -> bool:
        """Note what a law says is wrong with values that are each in their range; whether there was something."""
        conflict = law.conflict(**values)
        if conflict is not None:
            name, message, hint = conflict
            self.refuse(where(layers, name), message, hint)
        return conflict is not None

    def _refuse_keys_of_others(self, named: str, law: type[LinkLaw], layers: list[Layer]) -> None:
        """Note keys that belong to another law, where they are said of this one: beside its name, or nearer."""
        place = next(number for number, layer in enumerate(layers) if "link" in layer.spec.model_fields_set)
        nearer = [] if isinstance(layers[place].spec, ListedLink) else layers[:place]
        said = [*nearer, layers[place], *(layer for layer in layers[place + 1 :] if layer.spec.link == named)]
        word = f"{named} of the law {law.name}" if named == Pounding.name and law is not Pounding else named
        own, others = own_parameters(law), _keys_of_others(law, tuple(link_laws().values()))  # type: ignore[arg-type]
        unused = [name for name in ("stiffness", "tension_cut") if name not in law.parameters()]
        if not {"damping_ratio", "restitution"} & law.parameters().keys():
            unused += ["damping_ratio", "restitution"]
        for layer in said:
            for name in unused:
                if getattr(layer.spec, name, None) is not None:
                    message = f"'{name}' does not apply to link: {word}"
                    needed = ", ".join((*own, *(n for n in FROM_CASE if n in law.parameters())))
                    self.refuse((*layer.path, name), message, f"remove it; {word} takes {needed}", key=True)
            for name in others.keys() & layer.spec.model_fields_set:
                if getattr(layer.spec, name) is not None:
                    owners = (f"{'an' if one[0] in 'aeio' else 'a'} {one}" for one in others[name])
                    message = f"'{name}' does not apply to link: {word}"
                    hint = f"remove it; it belongs to {' and '.join(owners)}"
                    self.refuse((*layer.path, name), message, hint, key=True)

    def _own(self, name: str, law: type[LinkLaw], layers: list[Layer]) -> Any:
        """A parameter that only this law has: as given, or its default; None where something is wrong."""
        given, path = says(layers, name), where(layers, name)
        if given is None and law.subtracts_gap:
            given, path = getattr(self.group.impact, name, None), ("impact", name)
        if given is None:
            default = law.parameters()[name].default
            if default is not MISSING:
                return default
            self.refuse(
                layers[0].path,
                f"'{name}' is missing",
                f"a {law.name} needs it{' here or under `impact`' if law.subtracts_gap else ''}: "
                f"{own_parameters(law)[name].words}",
            )
            return None
        words = words_of(law, name)
        if words is not None:
            if given in list(words):
                return words(given)
            self.refuse(path, f"{name}: '{given}' is none of a {law.name}", f"write {' or '.join(words)}")
            return None
        return self.value(given, path) if isinstance(given, StiffnessRule) else given

    def _stiffness(self, named: str, law: type[LinkLaw], layers: list[Layer]) -> float | None:
        # A stiffness given around a link holds for it only where the kind is the same.
        for place, layer in enumerate(layers):
            if layer.spec.stiffness is not None and says(layers[place:], "link") == named:
                return self.value(layer.spec.stiffness, (*layer.path, "stiffness"))
        rule = law.stiffness_default
        default = read_stiffness(rule) if rule else self.group.impact.stiffness
        return self.value(default, ("impact", "stiffness"))

    def _losses(self, law: type[LinkLaw], layers: list[Layer]) -> tuple[float, float] | None:
        """(damping ratio, coefficient of restitution) of a link: the nearest layer gives one, the other follows. None,
        and noted, where a law that has no damping ratio would take its e from one: the ratio is that of Kelvin and
        Voigt."""
        speakers: list[tuple[LinkSpec | ListedLink | Impact, Path]] = [
            *((layer.spec, layer.path) for layer in layers), (self.group.impact, ("impact",))
        ]  # fmt: skip
        restitution = self.group.impact.restitution
        asked = {"damping_ratio", "restitution"} & law.parameters().keys()
        for spec, path in speakers:
            given = spec.model_fields_set
            if "damping_ratio" in given and spec.damping_ratio is not None:
                if asked == {"restitution"}:
                    message = f"'damping_ratio' is that of a Kelvin-Voigt contact; a {law.name} takes 'restitution'"
                    hint = f"write `restitution: {restitution_of(spec.damping_ratio):.3g}`, the e of that ratio there"
                    self.refuse((*path, "damping_ratio"), message, hint, key=True)
                    return None
                return spec.damping_ratio, restitution_of(spec.damping_ratio)
            if "restitution" in given and spec.restitution is not None:
                restitution = spec.restitution
                break
        return damping_ratio(restitution) + 0.0, restitution  # no negative zero at e = 1

    def value(self, given: float | StiffnessRule, path: Path) -> float | None:
        """A stiffness in N/m."""
        if not isinstance(given, StiffnessRule):
            return given
        if given.building is not None and given.building not in self.group.defined:
            message = f"no building '{given.building}' is defined"
            self.refuse(path, message, nearest(given.building, self.group.defined))
            return None
        self.rules[given] = self.group.stiffness(given)
        return self.rules[given]


@functools.cache
def _keys_of_others(law: type[LinkLaw], laws: tuple[type[LinkLaw], ...]) -> dict[str, list[str]]:
    """Keys that this law does not take, each with the names of the laws that it belongs to."""
    others: dict[str, list[str]] = {}
    for owner in laws:
        for name in own_parameters(owner).keys() - own_parameters(law).keys():
            others.setdefault(name, []).append(owner.name)
    return others


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)

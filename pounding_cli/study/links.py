"""From a case of the study file to the links of a scene, floor by floor and pair by pair."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass
from typing import Any

from pounding_cli.laws import link_laws
from pounding_cli.laws.dashpot import DashpotLaw, damping_ratio, restitution_of
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.study.law_keys import FROM_CASE, own_parameters
from pounding_cli.study.problems import Faults, Path, Tree, nearest
from pounding_cli.study.rules import StiffnessRule, read_stiffness
from pounding_cli.study.schema import CaseSpec, Impact, LinkSpec, PairSpec
from pounding_cli.study.source import Node
from pounding_cli.words import counted


@dataclass(frozen=True)
class Street:
    """What the links of a case depend on besides the case.

    group, types : buildings by place and by name; common : common floors of each pair of neighbours
    impact : the impact element
    A sketch stands in for a street that is not sound, so that its cases can be looked at all the same:
    `group` and `common` are empty then, and `defined` still holds every name the file defines.
    """

    group: Sequence[Building]
    types: Mapping[str, Building]
    common: Sequence[Sequence[tuple[int, int]]]
    impact: Impact
    defined: Sequence[str]

    @property
    def is_sketch(self) -> bool:
        return not self.group


@dataclass(frozen=True)
class _Layer:
    """One mapping that speaks about a link: the nearest comes first."""

    spec: LinkSpec
    path: Path


def links_of(case: CaseSpec, street: Street, root: Node | Tree, path: Path, faults: Faults) -> tuple[Link, ...]:
    """All links of a case, by pair and then from the ground up; what is wrong is noted in `faults`."""
    reader = _Reader(street, root, faults)
    pairs = len(case.pairs or "1") if street.is_sketch else len(street.group) - 1
    if case.pairs is not None and len(case.pairs) != pairs:
        faults.at(
            root,
            (*path, "pairs"),
            f"pairs has {counted(len(case.pairs), 'entry', 'entries')} for {counted(pairs, 'pair')} of neighbours",
            f"write {pairs}, left to right",
        )
        return ()
    outer = _Layer(case, path)
    links: list[Link] = []
    for place in range(pairs):
        layers = [outer]
        if case.pairs is not None:
            entry = case.pairs[place]
            layers.insert(0, _layer(entry, (*path, "pairs", place), PairSpec))
        links += reader.pair(place, layers)
    return tuple(links)


def _layer(entry: Any, path: Path, model: type[LinkSpec] = LinkSpec) -> _Layer:
    return _Layer(model.model_validate({"link": entry}) if isinstance(entry, str) else entry, path)


def _says(layers: Sequence[_Layer], key: str) -> Any:
    """What the nearest layer that gives `key` says; the default of the outermost otherwise."""
    for layer in layers:
        if key in layer.spec.model_fields_set:
            return getattr(layer.spec, key)
    return getattr(layers[-1].spec, key, None)


def _where(layers: Sequence[_Layer], key: str) -> Path:
    for layer in layers:
        if key in layer.spec.model_fields_set:
            return (*layer.path, key)
    return layers[0].path


class _Reader:
    """Builds links and notes what is wrong with them."""

    def __init__(self, street: Street, root: Node | Tree, faults: Faults) -> None:
        self.street, self.root, self.faults = street, root, faults

    def refuse(self, path: Path, message: str, hint: str, key: bool = False) -> None:
        self.faults.at(self.root, path, message, hint, key)

    def pair(self, place: int, layers: list[_Layer]) -> list[Link]:
        floors, by_floor, elsewhere = (_says(layers, key) for key in ("floors", "by_floor", "elsewhere"))
        if self.street.is_sketch:
            listed = {*by_floor, *(() if floors == "all" else floors)} or {1}
            common = {floor: floor for floor in (*listed, max(listed) + 1)}
        else:
            common = dict(self.street.common[place])
        named = set(common) if floors == "all" else set(floors)
        if floors != "all":
            for number, floor in enumerate(floors):
                self._exists(place, floor, (*_where(layers, "floors"), number), "write floors among")
        elif any("elsewhere" in layer.spec.model_fields_set for layer in layers):
            self.refuse(
                _where(layers, "elsewhere"),
                "'elsewhere' needs 'floors'",
                "list the floors that differ: `floors: [3, 5]`",
            )
        for floor in by_floor:
            self._exists(place, floor, (*_where(layers, "by_floor"), str(floor)), "write floors among")
        links = []
        found: dict[int | str, LinkLaw | None] = {}  # floors that are spoken of together have one law
        for left, right in common.items():
            name = left if left in by_floor else "named" if left in named else "elsewhere"
            if name not in found:
                inner = layers
                if name == left:
                    inner = [_layer(by_floor[left], (*_where(layers, "by_floor"), str(left))), *layers]
                elif name == "elsewhere":
                    inner = [_layer(elsewhere, _where(layers, "elsewhere")), *layers]
                found[name] = self.law(inner)
            law = found[name]
            if law is not None:
                links.append(Link(place, left, right, law))
        return links

    def _exists(self, place: int, floor: int, path: Path, hint: str) -> None:
        if self.street.is_sketch:
            return
        floors = [left for left, _ in self.street.common[place]]
        if floor not in floors:
            one, other = self.street.group[place].name, self.street.group[place + 1].name
            self.refuse(
                path,
                f"{one} and {other} have no common floor {floor}",
                f"{hint} {', '.join(map(str, floors))}",
            )

    def law(self, layers: list[_Layer]) -> LinkLaw | None:
        """The law of a link; None where there is none, or where something is wrong."""
        word = _says(layers, "link")
        if word is None:
            known = ", ".join((*list(link_laws())[1:], "or none")).replace(", or", " or")
            self.refuse(layers[0].path, "'link' is missing", f"write `link: pounding`, {known}")
            return None
        if word == "none":
            return None
        law = link_laws()[word]
        gap = _says(layers, "gap")
        if gap is None:
            self.refuse(
                layers[0].path,
                "'gap' is missing",
                "write the distance between the buildings, e.g. `gap: 5 cm`, or `gap: 0 cm`",
            )
            return None
        if self._conflicts(law, layers, gap=gap):
            return None
        self._refuse_keys_of_others(word, law, layers)
        impact = self.value(self.street.impact.stiffness, ("impact", "stiffness"))
        stiffness = self._stiffness(word, law, layers)
        if impact is None or stiffness is None:
            return None
        if self._conflicts(law, layers, gap=gap, stiffness=stiffness, impact_stiffness=impact):
            return None
        cut = _says(layers, "tension_cut")
        ratio, restitution = self._losses(layers)
        given = {
            "gap": gap,
            "stiffness": stiffness,
            "impact_stiffness": impact,
            "damping_ratio": ratio,
            "restitution": restitution,
            "tension_cut": self.street.impact.tension_cut if cut is None else cut,
            "dashpot": DashpotLaw(self.street.impact.dashpot),
        }
        values = {name: given[name] for name in law.parameters() if name in given}
        for name in own_parameters(law):
            own = self._own(name, law, layers)
            if own is None:
                return None
            values[name] = own
        try:
            return law(**values)
        except ValueError as error:
            self.refuse(layers[0].path, str(error).removeprefix("link: "), "correct it")
            return None

    def _conflicts(self, law: type[LinkLaw], layers: list[_Layer], **values: float) -> bool:
        """Note what a law says is wrong with values that are each in their range; whether there was something."""
        conflict = law.conflict(**values)
        if conflict is not None:
            name, message, hint = conflict
            self.refuse(_where(layers, name), message, hint)
        return conflict is not None

    def _refuse_keys_of_others(self, word: str, law: type[LinkLaw], layers: list[_Layer]) -> None:
        """Note keys that belong to another law than the layer's own."""
        own = own_parameters(law)
        others: dict[str, list[str]] = {}
        for owner in link_laws().values():
            for name in own_parameters(owner).keys() - own.keys():
                others.setdefault(name, []).append(owner.name)
        unused = [name for name in ("stiffness", "tension_cut") if name not in law.parameters()]
        if not {"damping_ratio", "restitution"} & law.parameters().keys():
            unused += ["damping_ratio", "restitution"]
        for layer in layers:
            for name in unused:
                if layer.spec.link == word and getattr(layer.spec, name, None) is not None:
                    message = f"'{name}' means nothing for link: {word}"
                    needed = ", ".join((*own, *(n for n in FROM_CASE if n in law.parameters())))
                    self.refuse((*layer.path, name), message, f"remove it; {word} takes {needed}", key=True)
            for name in others.keys() & layer.spec.model_fields_set:
                if layer.spec.link == word and getattr(layer.spec, name) is not None:
                    owners = (f"{'an' if one[0] in 'aeio' else 'a'} {one}" for one in others[name])
                    message = f"'{name}' means nothing for link: {word}"
                    hint = f"remove it; it belongs to {' and '.join(owners)}"
                    self.refuse((*layer.path, name), message, hint, key=True)

    def _own(self, name: str, law: type[LinkLaw], layers: list[_Layer]) -> Any:
        """A parameter that only this law has: as given, or its default; None where something is wrong."""
        given = _says(layers, name)
        if given is None:
            default = law.parameters()[name].default
            if default is not MISSING:
                return default
            self.refuse(
                layers[0].path,
                f"'{name}' is missing",
                f"a {law.name} needs it: {own_parameters(law)[name].words}",
            )
            return None
        return self.value(given, _where(layers, name)) if isinstance(given, StiffnessRule) else given

    def _stiffness(self, word: str, law: type[LinkLaw], layers: list[_Layer]) -> float | None:
        # A stiffness given around a link holds for it only where the kind is the same.
        for place, layer in enumerate(layers):
            if layer.spec.stiffness is not None and _says(layers[place:], "link") == word:
                return self.value(layer.spec.stiffness, (*layer.path, "stiffness"))
        rule = law.stiffness_default
        default = read_stiffness(rule) if rule else self.street.impact.stiffness
        return self.value(default, ("impact", "stiffness"))

    def _losses(self, layers: list[_Layer]) -> tuple[float, float]:
        """(damping ratio, coefficient of restitution) of a link: the nearest layer gives one, the other follows."""
        speakers: list[LinkSpec | Impact] = [*(layer.spec for layer in layers), self.street.impact]
        restitution = self.street.impact.restitution
        for spec in speakers:
            given = spec.model_fields_set
            if "damping_ratio" in given and spec.damping_ratio is not None:
                return spec.damping_ratio, restitution_of(spec.damping_ratio)
            if "restitution" in given and spec.restitution is not None:
                restitution = spec.restitution
                break
        return damping_ratio(restitution) + 0.0, restitution  # no negative zero at e = 1

    def value(self, given: float | StiffnessRule, path: Path) -> float | None:
        """A stiffness in N/m."""
        if not isinstance(given, StiffnessRule):
            return given
        buildings = list(self.street.group)
        if given.building is not None:
            if given.building not in self.street.defined:
                self.refuse(
                    path,
                    f"no building '{given.building}' is defined",
                    nearest(given.building, self.street.defined),
                )
                return None
            buildings = [self.street.types[given.building]] if given.building in self.street.types else []
        if not buildings:
            return None
        of = max if given.which == "stiffest" else _mean
        return given.factor * max(float(of(b.stiffness.tolist())) for b in buildings)


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)

"""From a case of the study file to the links of a scene, floor by floor and pair by pair."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from pounding_cli.laws import link_laws
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.links import Link, SceneLinks
from pounding_cli.model.meetings import column_flexibility
from pounding_cli.numbers import counted
from pounding_cli.study.case_schema import CaseSpec, LinkSpec, ListedLink, PairSpec
from pounding_cli.study.formulas import law_class
from pounding_cli.study.law_keys import own_parameters
from pounding_cli.study.link_laws import Group, LawReader, Layer, says, where
from pounding_cli.study.problems import Path, Problems, Tree
from pounding_cli.study.rules import StiffnessRule
from pounding_cli.study.source import Node

MOST_KNOWN = 500
"""Cases whose links are known again, about 4 kB each."""


@dataclass(frozen=True)
class _Element:
    """One link of floors that are spoken of together: its law, and the floors where it alone stands (None: all)."""

    law: LinkLaw
    floors: tuple[int, ...] | None
    path: Path


class Links:
    """The links of cases. Those of groups that differ in nothing that links depend on are the same, and found once: a
    period that is swept leaves links alone whose stiffness is that of another building.

    several : whether there are several groups; otherwise nothing is found again
    """

    def __init__(self, several: bool = False) -> None:
        self._several = several
        self._known: OrderedDict[tuple[Any, ...], _Known] = OrderedDict()

    def of(self, case: CaseSpec, group: Group, root: Node | Tree, path: Path, problems: Problems) -> tuple[Link, ...]:
        """All links of a case, by pair and then from the ground up; what is wrong is noted in `problems`."""
        if not self._several or group.is_empty or any(group.strikes):  # links on columns depend on the building
            return _links_of(case, group, root, path, _Reader(group, root, problems))
        key = id(case), id(group.impact), id(group.laws), group.floors
        known = self._known.get(key)
        if known is not None and all(group.stiffness(rule) == found for rule, found in known.rules):
            return known.links
        before = len(problems.found)
        reader = _Reader(group, root, problems)
        links = _links_of(case, group, root, path, reader)
        if len(problems.found) == before:
            self._known[key] = _Known(links, tuple(reader.rules.items()), (case, group.impact, group.laws))
            if len(self._known) > MOST_KNOWN:
                self._known.popitem(last=False)
        return links


@dataclass(frozen=True)
class _Known:
    """The links of a case, the rules for stiffness that they follow from with what they gave, and what they were looked
    up by, which is held so that nothing else gets its place in memory."""

    links: tuple[Link, ...]
    rules: tuple[tuple[StiffnessRule, float | None], ...]
    held: tuple[Any, ...]


def _links_of(case: CaseSpec, group: Group, root: Node | Tree, path: Path, reader: _Reader) -> tuple[Link, ...]:
    problems = reader.problems
    pairs = len(case.pairs or "1") if group.is_empty else len(group.buildings) - 1
    if case.pairs is not None and len(case.pairs) != pairs:
        problems.at(
            root,
            (*path, "pairs"),
            f"pairs has {counted(len(case.pairs), 'entry', 'entries')} for {counted(pairs, 'pair')} of neighbours",
            f"write {pairs}, left to right",
        )
        return ()
    outer = Layer(case, path)
    if isinstance(case.link, str) and case.link != "none" and reader.known(case.link, (*path, "link")) is None:
        return ()
    links: list[Link] = []
    for place in range(pairs):
        layers = [outer]
        if case.pairs is not None:
            entry = case.pairs[place]
            layers.insert(0, _layer(entry, (*path, "pairs", place), PairSpec))
        links += reader.pair(place, layers)
        links += reader.at_columns(place, layers)
    return SceneLinks(links)


def _layer(entry: Any, path: Path, model: type[LinkSpec] | type[ListedLink] = LinkSpec) -> Layer:
    return Layer(model.model_validate({"link": entry}) if isinstance(entry, str) else entry, path)


class _Reader(LawReader):
    """Builds links and notes what is wrong with them."""

    def pair(self, place: int, layers: list[Layer]) -> list[Link]:
        floors, by_floor, elsewhere = (says(layers, key) for key in ("floors", "by_floor", "elsewhere"))
        if self.group.is_empty:
            listed = {*by_floor, *(() if floors == "all" else floors)} or {1}
            common = {floor: floor for floor in (*listed, max(listed) + 1)}
        else:
            common = dict(self.group.common[place])
        named = set(common) if floors == "all" else set(floors)
        if floors != "all":
            for number, floor in enumerate(floors):
                self._exists(place, floor, (*where(layers, "floors"), number), "write floors among")
        elif any("elsewhere" in layer.spec.model_fields_set for layer in layers):
            self.refuse(
                where(layers, "elsewhere"),
                "'elsewhere' needs 'floors'",
                "list the floors that differ: `floors: [3, 5]`",
            )
        for floor in by_floor:
            self._exists(place, floor, (*where(layers, "by_floor"), str(floor)), "write floors among")
        links: list[Link] = []
        found: dict[int | str, list[_Element]] = {}  # floors that are spoken of together have the same laws
        stood: dict[Path, set[int]] = {}
        for left, right in common.items():
            name = left if left in by_floor else "named" if left in named else "elsewhere"
            if name not in found:
                inner = layers
                if name == left:
                    inner = [_layer(by_floor[left], (*where(layers, "by_floor"), str(left))), *layers]
                elif name == "elsewhere":
                    inner = [_layer(elsewhere, where(layers, "elsewhere")), *layers]
                found[name] = self.elements(inner)
            here: dict[LinkLaw, Path] = {}
            for element in found[name]:
                stood.setdefault(element.path, set()).add(left)
                if element.floors is not None and left not in element.floors:
                    continue
                if element.law in here:
                    message = f"two {element.law.name} links alike between the same floors"
                    self.refuse(element.path, message, "give one, or let them differ")
                    continue
                here[element.law] = element.path
                links.append(Link(place, left, right, element.law))
        self._refuse_floors_of_no_list([each for some in found.values() for each in some], stood)
        return links

    def at_columns(self, place: int, layers: list[Layer]) -> list[Link]:
        """The links of slabs that strike columns."""
        strikes = () if self.group.is_empty else self.group.strikes[place]
        given = says(layers, "at_columns")
        if given is not None:
            layers = [_layer(given, where(layers, "at_columns")), *layers]
        elif says(layers, "floors") != "all":
            layers = [_layer(says(layers, "elsewhere"), where(layers, "elsewhere")), *layers]
        word = says(layers, "link")
        if word is None or word == "none" or (not strikes and given is None):
            return []
        contact = self.contact() if word == Pounding.name else word
        if strikes and word == Pounding.name and contact not in (Pounding.name, None):
            message = f"slabs strike columns here, and the law {contact} between a slab and columns is not modelled"
            hint = "write `at_columns: none` in the case to leave these blows out, or `law: kelvin-voigt`"
            self.refuse(("impact", "law"), message, hint)
            return []
        if isinstance(word, tuple) or law_class(word, self.group.laws) not in (Pounding, None):
            kind = "several links" if isinstance(word, tuple) else word
            self.refuse(
                where(layers, "link"),
                f"slabs strike columns here, and {kind} between a slab and columns is not modelled",
                "write `at_columns: pounding`, or `at_columns: none` to leave these blows out",
            )
            return []
        law = self.law(layers)
        if not isinstance(law, Pounding):
            return []
        links = []
        for strike in strikes:
            building = self.group.buildings[place + strike.side]
            assert building.columns is not None  # of these the share is known
            flexibility = 1.0 / law.stiffness + column_flexibility(building, strike.storey, strike.at)
            floors = strike.left_floor, strike.right_floor
            in_series = replace(law, stiffness=1.0 / flexibility)
            links.append(Link(place, *floors, in_series, strike.left_at, strike.right_at, building.columns))
        return links

    def _refuse_floors_of_no_list(self, elements: list[_Element], stood: Mapping[Path, set[int]]) -> None:
        """Note floors of one link in a list that the list does not stand on."""
        for element in elements:
            for number, floor in enumerate(element.floors or ()):
                if floor not in stood[element.path] and not self.group.is_empty:
                    listed = ", ".join(map(str, sorted(stood[element.path])))
                    message = f"the list that this link is in does not stand on floor {floor}"
                    self.refuse((*element.path, "floors", number), message, f"write floors among {listed}")

    def elements(self, layers: list[Layer]) -> list[_Element]:
        """The links of floors that are spoken of together: one, several where `link` is a list, or none."""
        given = says(layers, "link")
        if not isinstance(given, tuple):
            law = self.law(layers)
            return [] if law is None else [_Element(law, None, layers[0].path)]
        place = next(number for number, layer in enumerate(layers) if "link" in layer.spec.model_fields_set)
        listed = [_layer(one, (*layers[place].path, "link", n), ListedLink) for n, one in enumerate(given)]
        self._refuse_keys_of_no_link(layers[: place + 1], [says([layer], "link") for layer in listed])
        found = []
        for layer in listed:
            law = self.law([*layers[:place], layer, *layers[place:]])
            if law is not None:
                floors = says([layer], "floors")
                found.append(_Element(law, None if floors == "all" else floors, layer.path))
        return found

    def _refuse_keys_of_no_link(self, layers: list[Layer], words: list[str]) -> None:
        """Note keys beside a list of links that cannot speak for them: a stiffness, and what none of them takes."""
        known = [self.contact() if word == Pounding.name else word for word in words]
        laws = [law for word in known if word is not None and (law := law_class(word, self.group.laws)) is not None]
        taken = {name for law in laws for name in _keys_of(law)} - {"stiffness"}
        for layer in layers:
            for name in ("stiffness", "tension_cut", "damping_ratio", "restitution", *_all_own()):
                if name in taken or getattr(layer.spec, name, None) is None or name not in layer.spec.model_fields_set:
                    continue
                message = f"'{name}' beside several links does not say which it is of"
                hint = f"write it in the list: `link: [..., {{link: {words[-1]}, {name}: ...}}]`"
                if not any(name in _keys_of(law) for law in laws):
                    message, hint = f"'{name}' does not apply to links {', '.join(words)}", "remove it"
                self.refuse((*layer.path, name), message, hint, key=True)

    def _exists(self, place: int, floor: int, path: Path, hint: str) -> None:
        if self.group.is_empty:
            return
        floors = [left for left, _ in self.group.common[place]]
        if floor not in floors:
            one, other = self.group.buildings[place].name, self.group.buildings[place + 1].name
            self.refuse(
                path,
                f"{one} and {other} have no common floor {floor}",
                f"{hint} {', '.join(map(str, floors))}",
            )


def _keys_of(law: type[LinkLaw]) -> set[str]:
    """The keys of a link that a law takes."""
    losses = {"damping_ratio", "restitution"}
    return law.parameters().keys() | (losses if losses & law.parameters().keys() else set())


def _all_own() -> list[str]:
    """Every key that some law brings along."""
    return list(dict.fromkeys(name for law in link_laws().values() for name in own_parameters(law)))

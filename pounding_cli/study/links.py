"""From a case of the study file to the links of a scene, floor by floor and pair by pair."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pounding_cli.model.building import Building
from pounding_cli.model.links import DashpotLaw, InfillLaw, Kind, Link, damping_ratio
from pounding_cli.study.problems import Faults, Path, Tree, nearest
from pounding_cli.study.rules import StiffnessRule
from pounding_cli.study.schema import CaseSpec, Impact, LinkSpec, PairSpec
from pounding_cli.study.source import Node
from pounding_cli.words import counted

DEFAULT_MATERIAL = StiffnessRule(0.2, "mean")
"""s_mat and s_con unless given: 1/5 of the mean storey stiffness of the stiffer building (paper)."""

THINNEST = 1e-6
"""Least thickness of an infill [m]; its cubic law has (s_imp - s_mat) / (3 d^2), which grows without bound."""


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


_Law = tuple[Kind, float, float, float, float, bool, InfillLaw, DashpotLaw]
"""The fields of a `Link` after its ends."""


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
        found: dict[int | str, _Law | None] = {}  # floors that are spoken of together have one law
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
                links.append(Link(place, left, right, *law))
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

    def law(self, layers: list[_Layer]) -> _Law | None:
        """What a link is besides its ends; None where there is none, or where something is wrong."""
        word = _says(layers, "link")
        if word is None:
            self.refuse(layers[0].path, "'link' is missing", "write `link: pounding`, infill, connector or none")
            return None
        if word == "none":
            return None
        kind = Kind(word)
        gap = _says(layers, "gap")
        if gap is None:
            self.refuse(
                layers[0].path,
                "'gap' is missing",
                "write the distance between the buildings, e.g. `gap: 5 cm`, or `gap: 0 cm`",
            )
            return None
        if kind is Kind.INFILL and gap < THINNEST:
            self.refuse(
                _where(layers, "gap"),
                "an infill in a gap of zero has no thickness"
                if gap == 0
                else f"an infill {gap:g} m thick is thinner than {THINNEST:g} m: there is no such material",
                f"write `link: pounding` for buildings in touch, or a gap of {THINNEST:g} m or more",
            )
            return None
        for layer in layers:
            if kind is not Kind.INFILL and layer.spec.law is not None and layer.spec.link == word:
                self.refuse(
                    (*layer.path, "law"),
                    f"'law' means nothing for link: {word}",
                    "remove it; it belongs to an infill",
                    key=True,
                )
        impact = self.value(self.street.impact.stiffness, ("impact", "stiffness"))
        stiffness = self._stiffness(kind, layers)
        if impact is None or stiffness is None:
            return None
        if kind is Kind.INFILL and stiffness > impact:
            self.refuse(
                _where(layers, "stiffness"),
                f"the infill's stiffness {stiffness:.3g} N/m is above the impact stiffness {impact:.3g} N/m",
                "an infill stiffens to impact.stiffness (paper, Fig. 3): lower the one or raise the other",
            )
            return None
        cut = _says(layers, "tension_cut")
        return (
            kind, gap, stiffness, impact, self._damping(layers),
            self.street.impact.tension_cut if cut is None else cut,
            InfillLaw(_says(layers, "law") or "continuous"), DashpotLaw(self.street.impact.dashpot),
        )  # fmt: skip

    def _stiffness(self, kind: Kind, layers: list[_Layer]) -> float | None:
        # A stiffness given around a link holds for it only where the kind is the same.
        for place, layer in enumerate(layers):
            if layer.spec.stiffness is not None and _says(layers[place:], "link") == kind.value:
                return self.value(layer.spec.stiffness, (*layer.path, "stiffness"))
        default = self.street.impact.stiffness if kind is Kind.POUNDING else DEFAULT_MATERIAL
        return self.value(default, ("impact", "stiffness"))

    def _damping(self, layers: list[_Layer]) -> float:
        speakers: list[LinkSpec | Impact] = [*(layer.spec for layer in layers), self.street.impact]
        for spec in speakers:
            given = spec.model_fields_set
            if "damping_ratio" in given and spec.damping_ratio is not None:
                return spec.damping_ratio
            if "restitution" in given and spec.restitution is not None:
                return damping_ratio(spec.restitution) + 0.0  # no negative zero at e = 1
        return damping_ratio(self.street.impact.restitution) + 0.0

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

"""Links of cases and the impact element as a study writes them: pydantic models made from what the laws declare.

What a law declares by `parameter` (`laws/law.py`) becomes a key of a study in these steps:

1. `key_parameters` leaves out what several laws share (SHARED_KEYS) or `impact` gives.
2. `_find_value_type` takes the type of the key from the annotation, unit and range of the parameter.
3. The key goes into three models: of the links of the law (`_build_link_model`), of a case with `links:`, whose links
   take the keys beside them (`SeveralLinks`), and of `impact`, where the law is one of contact (`ImpactSpec`).

`construct/complete_links.py` puts together what these three say of a link, and hands it to the law.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_type_hints

from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    create_model,
)

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.laws import KELVIN_VOIGT, contact_laws, link_laws
from pounding_cli.laws.pounding import Pounding
from pounding_cli.numbers import pluralize
from pounding_cli.study.schema.base import Model, Name, one_or_many, spec_field, tagged_union
from pounding_cli.study.schema.floor_places import FloorPair, FloorPairParser
from pounding_cli.study.schema.floor_plan import REST, fill_rest, find_fault_in_shares
from pounding_cli.study.schema.quantity import (
    GAP,
    LENGTH,
    LINK_STIFFNESS,
    MeasuredValue,
    ParsedText,
    Quantity,
    WholeNumber,
    parse_measured,
    quote,
    refuse,
)
from pounding_cli.study.schema.street_places import PlaceOfLink, PlaceParser

POUNDING = Pounding.name
NO_LINK = "none"
OWN_LAW = "(formula)"
"""Stands among the names of laws for the laws that a study writes itself."""

LOSSES = ("damping_ratio", "restitution")
"""Keys of which one is given; the other follows from it."""

SHARED = ("gap", "stiffness", *LOSSES, "tension_cut")
"""Keys that several laws take."""

MAX_PAIR = 19
"""Largest number of a pair of neighbours."""

LINK_PLACE_KEYS = ("link", "floors", "pair", "at", "distance", "places", "shares")
"""Keys that say which link it is and where it stands."""

_DERIVED = {"link": (*SHARED, "impact_stiffness", "dashpot"), "storey": ("stiffness", "yield_shear", "hardening")}
"""Parameters of laws that are no keys by themselves, by what the law acts on."""

RATIO = Quantity("damping ratio", "", "5 %", 0.0, 1.0, open_high=True)
Ratio = Annotated[float, RATIO]
RESTITUTION = Quantity("coefficient of restitution", "", "0.5", 0.0, 1.0, open_low=True)
SHARED_KEYS: dict[str, tuple[Any, Any]] = {
    "gap": (
        Annotated[float, GAP] | None,
        spec_field(None, "the distance d at rest [m], `0 cm` of floors in touch", "5 cm"),
    ),
    "stiffness": (
        Annotated[Any, LINK_STIFFNESS] | None,
        spec_field(
            None,
            "s_imp, s_mat, s_con or k [N/m]; default: 1/5 mean storey of infill and connector, 1 x mean storey of "
            "maxwell and friction, else that of `impact`",
        ),
    ),
    "restitution": (Annotated[float, RESTITUTION] | None, spec_field(None, "coefficient of restitution e [-]")),
    "damping_ratio": (
        Annotated[float, RATIO] | None,
        spec_field(
            None,
            "damping ratio of the dashpot [-], instead of restitution; also of an infill and a connector, which take "
            "that of the restitution of `impact` unless it is given: 0.215 of 0.5",
        ),
    ),
    "tension_cut": (bool | None, spec_field(None, "no force that pulls the floors together")),
}


# Keys that laws bring along


def _find_key_parameters(law: Any) -> dict[str, Any]:
    derived = _DERIVED[law.acts_on]
    return {name: each.metadata["parameter"] for name, each in law.parameters().items() if name not in derived}


def _find_link_keys(law: Any) -> frozenset[str]:
    names = set(law.parameters())
    losses = LOSSES if names & {*LOSSES} else ()
    return frozenset({*key_parameters(law), *(names & {*SHARED}), *losses})


key_parameters: Callable[[Any], dict[str, Any]] = functools.cache(_find_key_parameters)
"""key_parameters(law) -> the parameters of a law that are keys by themselves, with what the law declares of each."""

link_keys: Callable[[Any], frozenset[str]] = functools.cache(_find_link_keys)
"""link_keys(law) -> the keys that a link of this law takes, beside those of its place."""


_parameter_types: Callable[[Any], dict[str, Any]] = functools.cache(get_type_hints)
"""_parameter_types(law) -> the type of every parameter of a law."""


def _find_enumeration(law: Any, name: str) -> type[StrEnum] | None:
    """Return the enumeration of the words that a parameter of a law may be; None of a number, or without it."""
    kind = _parameter_types(law).get(name)
    return kind if isinstance(kind, type) and issubclass(kind, StrEnum) else None


def list_words(law: Any, name: str) -> list[str]:
    """Return the words that a parameter of a law may be; none of a number."""
    return [str(word) for word in _find_enumeration(law, name) or ()]


def to_enum(law: Any, name: str, value: Any) -> Any:
    """Return a value as the law takes it: a word as a member of its enumeration, others as they are."""
    enumeration = _find_enumeration(law, name)
    return value if enumeration is None or value is None else enumeration(value)


def needs_key(law: Any, name: str) -> bool:
    """Return whether a parameter of a law has no default."""
    return not isinstance(law.parameters()[name].default, str | float | int)


def _find_value_type(law: Any, name: str, declared: Any, words: tuple[str, ...]) -> Any:
    """Return the type of a key, from the parameter that a law declares; words : that the key may take."""
    hint = _parameter_types(law)[name]
    if hint is bool:
        return bool
    if hint is int:
        return Annotated[int, WholeNumber(int(declared.low), int(declared.high))]
    if isinstance(hint, type) and issubclass(hint, StrEnum):
        return Literal[words]
    if declared.unit == "N/m":
        return Annotated[Any, LINK_STIFFNESS]
    unit = "" if declared.unit == "-" else declared.unit
    default = law.parameters()[name].default
    example = default if declared.describe_issue(1.0) and isinstance(default, float) else 1.0
    ends = declared.low, declared.high, declared.open_low, declared.open_high
    return Annotated[float, Quantity(name.replace("_", " "), unit, f"{example:g} {unit}".strip(), *ends)]


def law_fields(laws: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return type and field of all keys that laws bring along, for `create_model`; none of them has to be given.

    The description of each names the laws that take it.
    """
    fields: dict[str, tuple[Any, Any]] = {}
    for law in laws.values():
        for name, declared in key_parameters(law).items():
            owners = [owner for owner in laws.values() if name in key_parameters(owner)]
            words = tuple(dict.fromkeys(word for owner in owners for word in list_words(owner, name)))
            others = ", ".join(owner.name for owner in owners[:-1])
            names = f"{others} and {owners[-1].name}" if others else owners[-1].name
            value_type = _find_value_type(law, name, declared, words)
            fields[name] = value_type | None, spec_field(None, f"{names}: {declared.description}")
    return fields


def _build_fields(law: Any) -> dict[str, Any]:
    """Return type and field of all keys that one law brings along, with its defaults."""
    fields: dict[str, Any] = {}
    for name, declared in key_parameters(law).items():
        default = law.parameters()[name].default
        words = tuple(list_words(law, name))
        value_type = _find_value_type(law, name, declared, words)
        fields[name] = value_type | None, spec_field(None if needs_key(law, name) else default, declared.description)
    return fields


# Links


_Floor = Annotated[int, WholeNumber(1, 100, zero="base")]


class ExceptSpec(Model):
    """All floors but some."""

    floors: tuple[_Floor, ...] = spec_field(..., "floors that are left out", [1], alias="except")


def _floors_kind(value: Any) -> str:
    if isinstance(value, dict | ExceptSpec):
        return "mapping"
    return "word" if isinstance(value, str) and value != "base" else "floors"


_FLOORS_USAGE = "write floors, from 1 up, e.g. `[3, 5]`, or both ends of every link, e.g. `[[4, 5], [4, 2 + 1.2 m]]`"


def _check_word(value: Any) -> Any:
    """Return a word for several floors.  Raises PydanticCustomError."""
    if value not in ("all", "rest"):
        raise refuse(f"{quote(value)} is no place of a link", f"{_FLOORS_USAGE}; `all`, `rest` or `base`")
    return value


def _read_floor(value: Any, read: ValidatorFunctionWrapHandler) -> Any:
    """Return a floor that a link lists.  Raises PydanticCustomError."""
    try:
        return read(value)
    except ValidationError as error:
        context = error.errors()[0].get("ctx", {})
        message = context.get("message", f"{quote(value)} is not a floor")
        raise refuse(str(message), _FLOORS_USAGE) from None


def _floor_kind(value: Any) -> str:
    return "ends" if isinstance(value, list | tuple | FloorPair) else "floor"


_FloorOrEnds = tagged_union(
    _floor_kind, floor=Annotated[_Floor, WrapValidator(_read_floor)], ends=Annotated[Any, FloorPairParser()]
)
FloorChoice: Any = tagged_union(
    _floors_kind,
    word=Annotated[Literal["all", "rest"], BeforeValidator(_check_word)],
    mapping=ExceptSpec,
    floors=one_or_many(_FloorOrEnds, as_list=True),
)
DISTANCE = LENGTH.replace(name="distance", example="2 m", high=100.0)


SHARE_OF_LINK = Quantity("share", "", "50 %", 0.0, 1.0, open_low=True, words=(REST,))


class LinkSpec(Model):
    """A link between floors of neighbours."""

    link: str = spec_field(
        ..., f"its law: {', '.join(link_laws())}, or a name of `laws`; `none` keeps floors free", "pounding"
    )
    floors: FloorChoice = spec_field(
        "all",
        "floors with this link, numbered in the left building: 5, [3, 5], {except: [1]}; `rest`: those that no other "
        "link of the pair lists; `base`: the moving base of a building beside a wall; [[4, 5], [6, 7 + 1.2 m]]: from "
        "floor 4 of the left building to floor 5 of the right one, and from floor 6 to 1.2 m above floor 7",
    )
    pair: Annotated[int, WholeNumber(1, MAX_PAIR)] | None = spec_field(
        None, "number of the pair of neighbours, from the left; default: every pair"
    )
    at: Literal["columns"] | None = spec_field(
        None,
        "`columns`: this link stands where slabs strike columns, and no other there; without it links that list no "
        "floors stand there too",
    )
    distance: Annotated[float, DISTANCE] | None = spec_field(
        None,
        "of a connector or a damper: how far its ends are apart along the row [m], which with their heights gives its "
        "angle; without it the link is level",
        "2 m",
    )

    places: one_or_many(Annotated[PlaceOfLink, PlaceParser()], most=20, as_list=True) | None = spec_field(  # type: ignore[valid-type]
        None,
        "where it stands along the street, beside a building with a `plan:`: a place, or both ends from the middles of "
        "their plans; default: both ends of the edge that the neighbours share, half of the link at each",
        ["-5 m", "5 m"],
    )
    shares: tuple[Annotated[float | str, SHARE_OF_LINK], ...] | None = spec_field(
        None,
        "part of the link at each of `places` [-], one of them may be `rest`; default: equal parts",
        ["30 %", "70 %"],
    )

    @property
    def part_shares(self) -> tuple[float, ...]:
        """Part of the link at each of its places [-]."""
        places = self.places or ()
        return (1.0 / len(places),) * len(places) if self.shares is None else fill_rest(self.shares)

    def issues(self) -> Iterator[Issue]:
        places = self.places or ()
        if self.shares is not None and self.places is None:
            message = "'shares' has no effect without 'places'"
            yield Issue(("shares",), message, "write `places:` too, or remove it", at_key=True)
        elif self.shares is not None and len(self.shares) != len(places):
            counts = f"{pluralize(len(self.shares), 'value')} for {pluralize(len(places), 'place')}"
            message = f"'shares' has {counts}"
            yield Issue(("shares",), message, "write one share for each of `places`", at_key=True)
        elif self.shares is not None:
            message, hint = find_fault_in_shares(self.shares)
            if message:
                yield Issue(("shares",), f"the shares {message}", hint, at_key=True)
        if self.at is not None and self.floors != "all":
            yield Issue(
                ("floors",),
                "'floors' has no effect beside 'at: columns'",
                "remove it: slabs strike where they are",
                at_key=True,
            )
        if self.at is not None and self.distance is not None:
            hint = "remove it: a slab is as high as the columns that it faces, so the link is level"
            yield Issue(("distance",), "'distance' has no effect beside 'at: columns'", hint, at_key=True)
        yield from _refuse_both_losses(self)


def _refuse_both_losses(owner: Any) -> Iterator[Issue]:
    if getattr(owner, "restitution", None) is not None and getattr(owner, "damping_ratio", None) is not None:
        hint = "remove one: 'damping_ratio' stands in place of 'restitution'"
        yield Issue(("damping_ratio",), "'damping_ratio' and 'restitution' cannot both be given", hint, at_key=True)


def _keys_as_written(law: Any) -> frozenset[str]:
    """Return the keys that a link of a law may be written with; those of pounding are of the law `impact` names."""
    if law is not Pounding:
        return link_keys(law)
    return frozenset().union(*map(link_keys, contact_laws().values()))


def _build_link_model(name: str, law: Any) -> type[LinkSpec]:
    """Return the model of the links of a law; what they lack their case or `impact` may give."""
    fields: dict[str, Any] = {shared: SHARED_KEYS[shared] for shared in SHARED if shared in _keys_as_written(law)}
    fields |= law_fields(contact_laws()) if law is Pounding else _build_fields(law)
    about = (law.__doc__ or name).strip().split("\n\n")[0]
    title = f"Link_{name}".replace("-", "_")
    model: type[LinkSpec] = create_model(title, __base__=LinkSpec, __doc__=about, **fields)
    return model


class NoLinkSpec(LinkSpec):
    """Nothing between the floors; the keys of other links have no meaning beside it."""

    link: Literal["none"] = spec_field(NO_LINK, "no link")

    def issues(self) -> Iterator[Issue]:
        yield from super().issues()
        for name in ("places", "shares"):
            if getattr(self, name) is not None:
                message = f"'{name}' does not apply to link: none"
                yield Issue((name,), message, "remove it: it keeps the whole edge free", at_key=True)


class OwnLinkSpec(LinkSpec):
    """A link whose law the study writes itself (`laws`)."""


@functools.cache
def link_models() -> dict[str, type[LinkSpec]]:
    """Return the model of the links of every law by its name; OWN_LAW stands for laws of the study's own."""
    models = {name: _build_link_model(name, law) for name, law in link_laws().items()}
    shared: dict[str, Any] = {**SHARED_KEYS}
    no_link = create_model("Link_none", __base__=NoLinkSpec, __doc__=NoLinkSpec.__doc__, **shared)
    own_fields: dict[str, Any] = {"gap": SHARED_KEYS["gap"]}
    own_link = create_model("Link_formula", __base__=OwnLinkSpec, __doc__=OwnLinkSpec.__doc__, **own_fields)
    return {**models, NO_LINK: no_link, OWN_LAW: own_link}


def find_law_name(link: Any) -> str:
    """Return the name in `link_models` of the law of a link, validated or as the file has it."""
    word = link.get("link") if isinstance(link, dict) else getattr(link, "link", None)
    return str(word) if str(word) in link_models() else OWN_LAW


def union_tag(name: str) -> str:
    """Return what the union of all links calls the model of a law; it is no key of the file."""
    return name if name == OWN_LAW else f"({name})"


_LINKS = [Annotated[model, Tag(union_tag(name))] for name, model in link_models().items()]
AnyLink: Any = Annotated[
    functools.reduce(operator.or_, _LINKS), Discriminator(lambda link: union_tag(find_law_name(link)))
]


def _to_mapping(entry: Any) -> Any:
    """Return an entry of a list of links as a mapping: a word stands for the law of a link without further keys."""
    return {"link": entry} if isinstance(entry, str) else entry


ListedLink = Annotated[AnyLink, BeforeValidator(_to_mapping)]


# Cases


class SeveralLinksSpec(Model):
    """A case of several links; each takes the keys beside them that its law has."""

    links: Annotated[tuple[ListedLink, ...], Field(min_length=1, max_length=500)] = spec_field(
        ..., "links between the floors; one may stand in the case itself"
    )

    def issues(self) -> Iterator[Issue]:
        yield from _refuse_both_losses(self)


_CASE_KEYS: dict[str, Any] = {name: field for name, field in SHARED_KEYS.items() if name != "stiffness"}
_CASE_KEYS |= law_fields(link_laws())
SeveralLinks: Any = create_model(
    "Case_links", __base__=SeveralLinksSpec, __doc__=SeveralLinksSpec.__doc__, **_CASE_KEYS
)
CaseSpec: Any = tagged_union(
    lambda case: (
        "links" if isinstance(case, SeveralLinksSpec) or (isinstance(case, dict) and "links" in case) else "link"
    ),
    link=AnyLink,
    links=SeveralLinks,
)
"""What stands between the buildings of the group: one link, or a list of links under `links`."""


def list_links(name: str, case: Any) -> list[tuple[LinkSpec, KeyPath]]:
    """Return the links of a case as written, each with its path."""
    if isinstance(case, SeveralLinksSpec):
        return [(link, ("cases", name, "links", number)) for number, link in enumerate(case.links)]
    return [(case, ("cases", name))]


class OwnLawSpec(Model):
    """A law of links of the study's own."""

    force: str = spec_field(
        ...,
        "its force [N]: a formula of v closing [m], r its rate [m/s], m reduced mass of the floors [kg], d gap [m] "
        "and the parameters; + - * / **, brackets and sqrt()",
        "k*v + c*r",
    )
    parameters: dict[
        Name,
        Annotated[
            MeasuredValue,
            ParsedText(parse_measured, "number with any unit, or a plain number", ("20 kN/mm", 0.2), name="parameter"),
        ],
    ] = spec_field({}, "constants of the formula by name", {"k": "20 kN/mm"})
    acts: Literal["beyond gap", "compression", "always"] = spec_field(
        "beyond gap",
        "`beyond gap`: once the gap has closed, with v = closing - gap; `compression`: while the closing v is above "
        "zero, as for material that fills the gap; `always`: as for a damper",
    )
    tension_cut: bool = spec_field(False, "no force that pulls the floors together")


# The impact element


def _read_contact(value: Any) -> str:
    if isinstance(value, str) and value.strip():
        return value.strip()
    raise refuse(f"{quote(value)} is not known", f"write {', '.join(contact_laws())} or a name of `laws`")


class _ImpactSpec(Model):
    """The impact element of pounding, and what an infill stiffens to."""

    law: Annotated[
        str,
        ParsedText(
            _read_contact,
            "; ".join([*(f"`{name}`" for name in contact_laws()), "NAME of `laws`"]),
            tuple(contact_laws()),
            name="law of contact",
        ),
    ] = spec_field(KELVIN_VOIGT, "law of contact of every `link: pounding`; sweep it to compare laws")
    stiffness: Annotated[Any, LINK_STIFFNESS] = spec_field("20 x stiffest storey", "impact spring s_imp [N/m]")
    restitution: Annotated[float, RESTITUTION] | None = spec_field(
        None, "coefficient of restitution e [-]; default: 0.5"
    )
    damping_ratio: Annotated[float, RATIO] | None = spec_field(
        None, "damping ratio of the dashpot [-], instead of restitution"
    )
    tension_cut: bool = spec_field(False, "no force that pulls the floors together at the end of a contact")
    dashpot: Literal["reduced-mass", "printed"] = spec_field(
        "reduced-mass", "mass in eq. (7); `printed` is its form in the paper, whose unit is wrong"
    )

    def issues(self) -> Iterator[Issue]:
        yield from _refuse_both_losses(self)


if TYPE_CHECKING:
    ImpactSpec = _ImpactSpec
else:
    ImpactSpec = create_model("Impact", __base__=_ImpactSpec, __doc__=_ImpactSpec.__doc__, **law_fields(contact_laws()))


def refuse_beside_links(key: str) -> tuple[str, str]:
    """Return what is wrong with a key beside `links:` that none of them takes, and what to write."""
    hint = f"write it in the entry that it is of: `links: [{{link: ..., {key}: ...}}]`"
    return f"'{key}' beside `links:` does not apply to them, or does not say which it is of", hint


def refuse_key(key: str, title: str, keys: Iterable[str]) -> tuple[str, str]:
    """Return what is wrong with a key that the law of a link does not have, and what to write.

    title : of the law; keys : that it takes
    """
    owners = [law.name for law in link_laws().values() if key in link_keys(law)]
    takes = ", ".join(each for each in keys if each not in LINK_PLACE_KEYS)
    hint = f"remove it: {title} takes {takes or 'none'}; it belongs to {', '.join(owners)}"
    return f"'{key}' does not apply to link: {title}", hint

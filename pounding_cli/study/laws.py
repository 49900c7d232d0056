"""One pydantic model per law, made from the parameters that the law declares: of links, and the keys of storey laws."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Iterator
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_type_hints

from pydantic import Discriminator, Tag, create_model

from pounding_cli.laws import KELVIN_VOIGT, contact_laws, link_laws
from pounding_cli.laws.pounding import restitution_of
from pounding_cli.study.base import Model, SpecIssue, one_or_many, spec_field, tagged_union
from pounding_cli.study.quantity import GAP, LINK_STIFFNESS, ParsedText, Quantity, WholeNumber, quote, refuse

POUNDING, FORMULA = "pounding", "(formula)"
SHARED = ("gap", "stiffness", "damping_ratio", "restitution", "tension_cut")
LOSSES = ("damping_ratio", "restitution")
_ELSEWHERE = {"link": (*SHARED, "impact_stiffness", "dashpot"), "storey": ("stiffness", "yield_shear", "hardening")}
RATIO = Quantity("damping ratio", "", "5 %", 0.0, 1.0, open_high=True)
RESTITUTION = Quantity("coefficient of restitution", "", "0.5", 0.0, 1.0, open_low=True)
SHARED_KEYS: dict[str, tuple[Any, Any]] = {
    "gap": (Annotated[float, GAP], spec_field(..., "the distance d at rest [m], `0 cm` of floors in touch", "5 cm")),
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
}  # fmt: skip


_Floor = Annotated[int, WholeNumber(1, 100, zero="base")]


class Except(Model):
    """All floors but some."""

    floors: tuple[_Floor, ...] = spec_field(..., "floors that are left out", [1], alias="except")


def _floors_kind(value: Any) -> str:
    if isinstance(value, dict | Except):
        return "mapping"
    return "word" if isinstance(value, str) and value != "base" else "floors"


Floors: Any = tagged_union(
    _floors_kind, word=Literal["all", "rest"], mapping=Except, floors=one_or_many(_Floor, as_list=True)
)


def _both_losses(owner: Any) -> Iterator[SpecIssue]:
    if getattr(owner, "restitution", None) is not None and getattr(owner, "damping_ratio", None) is not None:
        hint = "remove one: 'damping_ratio' stands in place of 'restitution'"
        yield ("damping_ratio",), "'damping_ratio' and 'restitution' cannot both be given", hint, True


class Link(Model):
    """A link between floors of neighbours."""

    link: str = spec_field(
        ..., f"its law: {', '.join(link_laws())}, or a name of `laws`; `none` keeps floors free", "pounding"
    )
    floors: Floors = spec_field(
        "all",
        "floors with this link, numbered in the left building: 5, [3, 5], {except: [1]}; `rest`: those that no other "
        "link of the pair lists; `base`: the moving base of a building beside a wall",
    )
    pair: Annotated[int, WholeNumber(1, 19)] | None = spec_field(
        None, "number of the pair of neighbours, from the left; default: every pair"
    )
    at: Literal["columns"] | None = spec_field(
        None,
        "`columns`: this link stands where slabs strike columns, and no other there; without it links that list no "
        "floors stand there too",
    )

    def issues(self) -> Iterator[SpecIssue]:
        if self.at is not None and self.floors != "all":
            yield (
                ("floors",),
                "'floors' beside 'at: columns' says nothing",
                "remove it: slabs strike where they are",
                True,
            )
        yield from _both_losses(self)
        law, ratio = link_laws().get(self.kind), getattr(self, "damping_ratio", None)
        if law is None:
            return
        if ratio is not None and {*LOSSES} & law.parameters().keys() == {"restitution"}:
            what = f"'damping_ratio' is that of a Kelvin-Voigt contact; a {law.name} takes 'restitution'"
            hint = f"write `restitution: {restitution_of(ratio):.3g}`, the e of that ratio there"
            yield ("damping_ratio",), what, hint, True

    @property
    def kind(self) -> str:
        """Of `pounding of hertz` the law that `impact` names."""
        return kind_of(self.link)


def kind_of(word: str) -> str:
    """The law that acts: of `pounding of hertz`, as pounding by another law of contact is called, `hertz`."""
    return word.removeprefix(f"{POUNDING} of ")


def _own(law: Any) -> dict[str, Any]:
    aside = _ELSEWHERE[law.acts_on]
    return {name: each.metadata["parameter"] for name, each in law.parameters().items() if name not in aside}


def _keys_of(law: Any) -> set[str]:
    names = set(law.parameters())
    return {*own(law), *(names & {*SHARED}), *(LOSSES if names & {*LOSSES} else ())}


own: Callable[[Any], dict[str, Any]] = functools.cache(_own)
"""own(law) -> the parameters of a law that are keys of its own."""

keys_of: Callable[[Any], set[str]] = functools.cache(_keys_of)
"""keys_of(law) -> the keys that a link of this law takes."""


def _kind(law: Any, name: str, declared: Any, words: tuple[str, ...]) -> Any:
    given = get_type_hints(law)[name]
    if given is bool:
        return bool
    if given is int:
        return Annotated[int, WholeNumber(int(declared.low), int(declared.high))]
    if isinstance(given, type) and issubclass(given, StrEnum):
        return Literal[words or tuple(map(str, given))]
    if declared.unit == "N/m":
        return Annotated[Any, LINK_STIFFNESS]
    unit, default = "" if declared.unit == "-" else declared.unit, law.parameters()[name].default
    example = default if declared.refusal(1.0) and isinstance(default, float) else 1.0
    ends = declared.low, declared.high, declared.open_low, declared.open_high
    return Annotated[float, Quantity(name.replace("_", " "), unit, f"{example:g} {unit}".strip(), *ends)]


@functools.cache
def _words(law: Any) -> dict[str, type[StrEnum]]:
    return {
        name: kind for name, kind in get_type_hints(law).items() if isinstance(kind, type) and issubclass(kind, StrEnum)
    }


def typed(law: Any, name: str, value: Any) -> Any:
    """A value as the law takes it: words as its own enumeration."""
    return _words(law)[name](value) if name in _words(law) and value is not None else value


def law_keys(laws: dict[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Type and default of all keys that laws bring along, as `create_model` takes them; their owners are described."""
    found: dict[str, tuple[Any, Any]] = {}
    for law in laws.values():
        for name, declared in own(law).items():
            owners = [one for one in laws.values() if name in own(one)]
            hints = [get_type_hints(one)[name] for one in owners]
            words = tuple(
                dict.fromkeys(str(w) for h in hints if isinstance(h, type) and issubclass(h, StrEnum) for w in h)
            )
            told = " and ".join(filter(None, (", ".join(one.name for one in owners[:-1]), owners[-1].name)))
            found[name] = _kind(law, name, declared, words) | None, spec_field(None, f"{told}: {declared.words}")
    return found


def _link_model(name: str, law: Any) -> Any:
    fields: dict[str, Any] = {n: SHARED_KEYS[n] for n in SHARED if n in keys_of(law)}
    for n, declared in own(law).items():
        default = law.parameters()[n].default
        kind = _kind(law, n, declared, ())
        fields[n] = kind, spec_field(... if not isinstance(default, str | float | int) else default, declared.words)
    about = (law.__doc__ or name).strip().split("\n\n")[0]
    return create_model(f"Link_{name}".replace("-", "_"), __base__=Link, __doc__=about, **fields)


class NoLink(Link):
    """Nothing between the floors."""

    link: Literal["none"] = spec_field("none", "no link")


@functools.cache
def link_models() -> dict[str, Any]:
    """The model of every law by name; FORMULA stands for a law of the study's own."""
    found = {name: _link_model(name, law) for name, law in link_laws().items()}
    fields: Any = {"gap": SHARED_KEYS["gap"]}
    formula = create_model("Link_formula", __base__=Link, __doc__="A law of the study's own (`laws`).", **fields)
    return {**found, "none": NoLink, FORMULA: formula}


def tag_of(value: Any) -> str:
    """Which law a link has."""
    word = (value.get("link") if isinstance(value, dict) else getattr(value, "link", None)) or ""
    word = kind_of(str(word))
    return tag(word) if word in link_models() else FORMULA


def tag(name: str) -> str:
    """How the union of all links calls one: no key of the file."""
    return name if name == FORMULA else f"({name})"


_LINKS = [Annotated[model, Tag(tag(name))] for name, model in link_models().items()]
AnyLink: Any = Annotated[functools.reduce(operator.or_, _LINKS), Discriminator(tag_of)]


def _contact(value: Any) -> str:
    if isinstance(value, str) and value.strip():
        return value.strip()
    raise refuse(f"{quote(value)} is not known", f"write {', '.join(contact_laws())} or a name of `laws`")


class _Impact(Model):
    """The impact element of pounding, and what an infill stiffens to."""

    law: Annotated[
        str,
        ParsedText(
            _contact, "; ".join([*(f"`{name}`" for name in contact_laws()), "NAME of `laws`"]), tuple(contact_laws())
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

    def issues(self) -> Iterator[SpecIssue]:
        yield from _both_losses(self)


if TYPE_CHECKING:
    Impact = _Impact
else:
    Impact = create_model("Impact", __base__=_Impact, __doc__=_Impact.__doc__, **law_keys(contact_laws()))

"""What stands between the buildings of a study file: the impact element, links, cases."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, create_model

from pounding_cli.laws import KELVIN_VOIGT, contact_laws, link_laws
from pounding_cli.study import units
from pounding_cli.study.base import EACH_STOREY, DampingShare, Model, list_or_one, optional, word_or_mapping
from pounding_cli.study.law_keys import LawWord, contact_keys, link_keys
from pounding_cli.study.rules import STIFFNESS_FORM, StiffnessRule
from pounding_cli.study.units import Quantity, whole_number

if TYPE_CHECKING:
    LinkKind = str
    LawName = str
    ContactKind = str
else:
    LinkKind = Annotated[str, LawWord((*link_laws(), "none"))]
    LawName = Annotated[str, LawWord(tuple(link_laws()))]
    ContactKind = Annotated[str, LawWord(tuple(contact_laws()))]
Gap = Annotated[float, units.GAP]
LinkStiffness = Annotated[float | StiffnessRule, STIFFNESS_FORM]
Restitution = Annotated[float, Quantity("coefficient of restitution", "", "0.5", 0.0, 1.0, open_low=True)]


class _Impact(Model):
    """The impact element of pounding, and what an infill stiffens to."""

    law: ContactKind = optional(
        KELVIN_VOIGT, description="law of contact of every `link: pounding`; sweep it to compare laws"
    )
    stiffness: LinkStiffness = optional("20 x stiffest storey", description="impact spring s_imp [N/m]")
    restitution: Restitution = optional(0.5, description="coefficient of restitution e [-]")
    damping_ratio: DampingShare | None = optional(
        None, description="damping ratio of the dashpot [-], instead of restitution"
    )
    tension_cut: bool = optional(False, description="no force that pulls the floors together at the end of a contact")
    dashpot: Literal["reduced-mass", "printed"] = optional(
        "reduced-mass", description="mass in eq. (7); `printed` is its form in the paper, whose unit is wrong"
    )


if TYPE_CHECKING:
    Impact = _Impact
else:
    Impact = create_model("Impact", __base__=_Impact, __doc__=_Impact.__doc__, **contact_keys())


class _LinkSpec(Model):
    """One link; what is not given is taken from the case around it and then from `impact`."""

    link: LinkKind | None = optional(None, description="link between the floors")
    gap: Gap | None = optional(None, description="initial distance d [m]", examples=["5 cm", "0 cm"])
    stiffness: LinkStiffness | None = optional(
        None,
        description="s_imp, s_mat, s_con or k [N/m]; unless given 1/5 mean storey of infill and connector, "
        "1 x mean storey of maxwell and friction",
    )
    restitution: Restitution | None = optional(None, description="coefficient of restitution e [-]")
    damping_ratio: DampingShare | None = optional(None, description="damping ratio [-], instead of restitution")
    tension_cut: bool | None = optional(None, description="no force that pulls the floors together")


Floor = Annotated[int, Field(ge=1, le=100), whole_number(1, 100)]


def _floors_kind(value: Any) -> str:
    if isinstance(value, int) and not isinstance(value, bool):
        return "single"
    return list_or_one(value)


Floors = Annotated[
    Annotated[tuple[Floor, ...], EACH_STOREY, Tag("list")]
    | Annotated[Floor, AfterValidator(lambda floor: (floor,)), Tag("single")]
    | Annotated[Literal["all"], Tag("one")],
    Discriminator(_floors_kind),
]


class _ListedLink(_LinkSpec):
    """One of several links between the same floors."""

    link: LawName = Field(description="link between the floors, one of the list")
    floors: Floors = optional("all", description="floors with this link, of those that the list stands on")


if TYPE_CHECKING:
    ListedLink = _ListedLink
else:
    ListedLink = create_model("ListedLink", __base__=_ListedLink, __doc__=_ListedLink.__doc__, **link_keys())

ListedOrWord = Annotated[
    Annotated[LawName, Tag("word")] | Annotated[ListedLink, Tag("mapping")], Discriminator(word_or_mapping)
]
WordOrList = Annotated[
    Annotated[LinkKind, Tag("word")]
    | Annotated[tuple[ListedOrWord, ...], Field(min_length=1, max_length=10), Tag("list")],
    Discriminator(lambda value: "list" if isinstance(value, list | tuple) else "word"),
]


class _AnyLinks(_LinkSpec):
    __doc__ = _LinkSpec.__doc__

    link: WordOrList | None = optional(  # type: ignore[assignment]
        None, description="link between the floors; a list if several join the same floors"
    )


if TYPE_CHECKING:
    LinkSpec = _AnyLinks
else:
    LinkSpec = create_model("LinkSpec", __base__=_AnyLinks, __doc__=_LinkSpec.__doc__, **link_keys())

LinkOrWord = Annotated[
    Annotated[LinkKind, Tag("word")] | Annotated[LinkSpec, Tag("mapping")], Discriminator(word_or_mapping)
]


class PairSpec(LinkSpec):
    """The links of one pair of neighbours."""

    floors: Floors = optional("all", description="floors with this link, numbered in the left building of the pair")
    elsewhere: LinkOrWord = optional("none", description="the link on the floors not listed")
    by_floor: dict[Floor, LinkOrWord] = optional(
        {}, description="links of single floors; they take precedence over `floors`"
    )
    at_columns: LinkOrWord | None = optional(
        None,
        description="where a slab strikes columns: `pounding` or `none`; default: as floors that are not listed",
    )


PairOrWord = Annotated[
    Annotated[LinkKind, Tag("word")] | Annotated[PairSpec, Tag("mapping")], Discriminator(word_or_mapping)
]


class CaseSpec(PairSpec):
    """A case: what stands between the buildings of the group."""

    pairs: Annotated[tuple[PairOrWord, ...], Field(min_length=1, max_length=100)] | None = optional(
        None, description="one entry for each pair of neighbours, left to right, if they differ"
    )

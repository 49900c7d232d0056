"""The laws of links, storeys and foundation springs, a new law is a file and a line in `BUILT_IN`."""

from __future__ import annotations

import functools

from pounding_cli.laws.bilinear import Bilinear
from pounding_cli.laws.bilinear_contact import BilinearContact
from pounding_cli.laws.bouc_wen import BoucWen
from pounding_cli.laws.formula import WrittenLaw
from pounding_cli.laws.foundation import Rocking, Sway
from pounding_cli.laws.hertz import Hertz, HertzDamp, Jankowski
from pounding_cli.laws.imk import PeakOrientedImk, PeakOrientedLaw, PinchingImk
from pounding_cli.laws.infill import Infill, InfillOnColumns
from pounding_cli.laws.joints import Connector, Damper, Friction, Maxwell, Viscous
from pounding_cli.laws.law import JOINED, Behaviour, Law, LinkLaw
from pounding_cli.laws.pounding import Pounding
from pounding_cli.laws.slider import Slider
from pounding_cli.laws.storey import StoreyLaw

BUILT_IN: tuple[type[Law], ...] = (
    Pounding,
    Infill,
    Connector,
    Damper,
    Viscous,
    Maxwell,
    Friction,
    Hertz,
    HertzDamp,
    Jankowski,
    BilinearContact,
    Bilinear,
    PeakOrientedLaw,
    PeakOrientedImk,
    PinchingImk,
    BoucWen,
    Sway,
    Rocking,
)
"""In the order in which reference pages list them."""


_ACTING = (*(law for law in BUILT_IN if issubclass(law, LinkLaw | StoreyLaw)), Slider, WrittenLaw, InfillOnColumns)
BEHAVIOURS: tuple[Behaviour, ...] = tuple(dict.fromkeys((JOINED, *(law.behaviour for law in _ACTING))))
"""What the elements of all laws do, each once: the `kind` of an element is its place here."""


@functools.cache
def link_laws() -> dict[str, type[LinkLaw]]:
    """The laws a link can have, by the name that a study file calls them."""
    return {law.name: law for law in BUILT_IN if issubclass(law, LinkLaw)}


KELVIN_VOIGT = "kelvin-voigt"
"""What a study calls the law of `Pounding` among the laws of contact."""


@functools.cache
def contact_laws() -> dict[str, type[LinkLaw]]:
    """The laws of floors that strike each other across a gap, by the name that `impact` of a study calls them."""
    laws = {name: law for name, law in link_laws().items() if law.subtracts_gap and law is not Pounding}
    return {KELVIN_VOIGT: Pounding, **laws}


@functools.cache
def storey_laws() -> dict[str, type[StoreyLaw]]:
    """The laws that storeys can have, likewise."""
    return {law.name: law for law in BUILT_IN if issubclass(law, StoreyLaw)}


def is_damper(name: str) -> bool:
    """Return whether a law of links is that of a damper (`LinkLaw.takes_energy`); not of one that is not installed."""
    return link_laws().get(name, LinkLaw).takes_energy


def link_symbol(name: str) -> str:
    """Return the symbol of a law in pictures (`LinkLaw.symbol`), also of one that is not installed here."""
    return link_laws().get(name, LinkLaw).symbol

"""Buildings of which no more is known than what one sees from the street: the model building types of HAZUS.

Where the numbers are from, by table of the manual (FEMA (2012). Hazus-MH 2.1, Multi-hazard Loss Estimation
Methodology, Earthquake Model, Technical Manual. Federal Emergency Management Agency, chapter 5). The manual itself was
not at hand: the tables were compared, number by number, with public programs that have them (github.com).

hazus_types.csv    the 36 types, their range of storeys, typical storeys and height in feet (Table 5.1); period, share
                   of the weight in the pushover mode alpha1, overstrength ratios gamma and lambda (Table 5.5); all as
                   in youtian95/MDOFModel. Elastic damping: as in the generator of shear buildings that follows Lu et
                   al. (2014), NHERI-SimCenter/rWHALE; programs differ here, see below
hazus_designs.csv  by type and design level: design strength Cs (Table 5.4) and interstorey drift at the thresholds of
                   the four damage states (Table 5.9), as in MDOFModel, the drifts also in
                   NHERI-SimCenter/DamageAndLossModelLibrary (Hazus 5.1); yield acceleration Ay and hardening, the slope
                   between yield and ultimate point over the slope before it, as in rWHALE and, within the rounding of
                   two digits, as from the points of Table 5.7 in steva44/Rts. Ultimate points of pre-codes lie further
                   than the ductilities of Table 5.6

How uncertain a guess from the street is, as standard deviations of logarithms:

strength        0.25 of designs to a code, 0.30 of those before codes: HAZUS of 1999, as quoted by Robinson, D., Gray,
                D., Ghasemi, H. and Horspool, N. (2014). EQRM: Geoscience Australia's Earthquake Risk Model, Technical
                Manual, version 4.0, draft, section 6.2.1. HAZUS gives no reason for them, as that manual says
drift capacity  0.40: variability of the thresholds of structural damage, in DamageAndLossModelLibrary of SimCenter
                (Hazus 5.1) and in section 6.4 of the manual of EQRM
period          0.18 of concrete frames, 0.24 of all others: assumed here. Mehanny, S. S. F. (2012). Are theoretically
                calculated periods of vibration for skeletal structures error-free? Earthquakes and Structures 3(1),
                17-35, has errors of the same order, 19 % of new and 25 % of existing concrete frames
damping         0.39, a coefficient of variation of 0.40: assumed here. Programs read the elastic damping of HAZUS
                differently: steel 5, 6 or 10 %, wood 10, 12.5 or 15 %, reinforced masonry 7, 8.5 or 10 %, unreinforced
                5 or 10 %, precast concrete 5 or 7 %, other concrete 7 % in all
"""

from __future__ import annotations

import csv
import math
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.code_design import BaseShearDesign
from pounding_cli.model.stiffness import frequencies, rayleigh_factors, stiffness_for_period

FOOT = 0.3048
"""[m]"""

DESIGNS = ("high-code", "moderate-code", "low-code", "pre-code")
"""Design levels, the strictest first."""

DAMAGE_STATES = ("slight", "moderate", "extensive", "complete")
"""Damage states, the lightest first."""

UNCERTAIN = ("period", "strength", "damping", "drift")
"""What is uncertain of a building that is only seen; `drift` are the drifts at the thresholds of damage."""

MANUAL = "Hazus-MH 2.1 Technical Manual"
"""Short name of the source."""

FORCE_DISTRIBUTION = "triangular"
"""Forces over the height by which the yield shears of the storeys follow from that of the base."""

TAPER = 1.0
"""Stiffness of the top over that of the bottom storey [-]."""

CONCRETE_PERIOD_SPREAD = 0.18
PERIOD_SPREAD = 0.24
DAMPING_SPREAD = math.sqrt(math.log(1.0 + 0.40**2))
DRIFT_SPREAD = 0.40
"""Standard deviations of logarithms [-]; where they are from stands above."""

SOURCES = {
    "storeys": "Table 5.1",
    "period": "Table 5.5, in proportion to the storeys",
    "height": "Table 5.1",
    "strength": "Tables 5.4, 5.5 and 5.7",
    "hardening": "Table 5.7",
    "damping": "as the generator of Lu et al. 2014; programs read HAZUS differently",
    "drift": "Table 5.9",
}
"""Table of the manual in which a number stands, or where else it is from."""

SPREAD_SOURCES = {
    "period": "assumed here",
    "strength": "HAZUS of 1999, quoted by EQRM",
    "damping": "assumed here",
    "drift": "Hazus 5.1, quoted by SimCenter",
}
"""Where the dispersions are from."""

_SEED = 20260101


@dataclass(frozen=True)
class Archetype:
    """A model building type of HAZUS at one design level.

    type, description : short name and words of the type
    design : one of DESIGNS
    storeys_from, storeys_to : range of the type; None where it has no upper end
    typical_storeys : number of storeys of the building that the numbers are of
    typical_period : its period [s]
    storey_height : [m], in full centimetres: that of another building can be written to agree with it
    design_strength : design base shear over weight Cs [-]
    alpha1 : share of the weight in the pushover mode [-]
    gamma : yield over design strength [-]
    lambda_ : ultimate over yield strength [-]
    yield_acceleration : spectral acceleration at yield [g]
    hardening : slope between yield and ultimate point over the slope before it [-]
    damping : elastic damping ratio [-]
    drift_limits : drift over storey height at which each damage state begins [-]
    """

    type: str
    description: str
    design: str
    storeys_from: int
    storeys_to: int | None
    typical_storeys: int
    typical_period: float
    storey_height: float
    design_strength: float
    alpha1: float
    gamma: float
    lambda_: float
    yield_acceleration: float
    hardening: float
    damping: float
    drift_limits: Mapping[str, float]

    @property
    def period_per_storey(self) -> float:
        """Period over number of storeys [s]."""
        return self.typical_period / self.typical_storeys

    @property
    def ultimate_ductility(self) -> float:
        """Displacement at the ultimate point over that at yield [-]; beyond it the type has no further strength."""
        return 1.0 + (self.lambda_ - 1.0) / self.hardening

    @property
    def spreads(self) -> dict[str, float]:
        """Standard deviation of the logarithm of everything in UNCERTAIN [-]."""
        is_concrete_frame = self.type.startswith("C1")
        return {
            "period": CONCRETE_PERIOD_SPREAD if is_concrete_frame else PERIOD_SPREAD,
            "strength": 0.30 if self.design == "pre-code" else 0.25,
            "damping": DAMPING_SPREAD,
            "drift": DRIFT_SPREAD,
        }

    def has_storeys(self, storeys: int) -> bool:
        """Return whether a number of storeys lies in the range of the type."""
        return self.storeys_from <= storeys and (self.storeys_to is None or storeys <= self.storeys_to)

    def describe_range(self) -> str:
        """Return the range of storeys in words: "4 to 7 storeys"."""
        if self.storeys_to is None:
            return f"{self.storeys_from} storeys or more" if self.storeys_from > 1 else "any number of storeys"
        return f"{self.storeys_from} to {self.storeys_to} storeys"

    def period(self, storeys: int) -> float:
        """Return the period of a building of so many storeys [s]."""
        return self.period_per_storey * storeys

    def base_shear(self, storeys: int) -> float:
        """Return the base shear at yield over the weight, V/W [-]: the spectral acceleration at yield times the share
        of the weight in the first mode of equal storeys."""
        return self.yield_acceleration * first_mode_share(storeys)

    def build(self, name: str, storeys: int, mass: float, factors: Mapping[str, float] | None = None) -> Building:
        """Return the building of a type, with equal storeys.

        mass : of a floor [kg]
        factors : on its period, strength and damping [-] (`draw_factors`); 1 unless given
        """
        factor = {name: 1.0 for name in UNCERTAIN} | dict(factors or {})
        masses = np.full(storeys, float(mass))
        heights = np.full(storeys, self.storey_height)
        period = factor["period"] * self.period(storeys)
        stiffness = stiffness_for_period(masses, period, TAPER)
        design = BaseShearDesign(factor["strength"] * self.base_shear(storeys), FORCE_DISTRIBUTION)
        shears = design.yield_shears(masses, heights, period)
        alpha, beta = rayleigh_factors(masses, stiffness, factor["damping"] * self.damping)
        hardening = np.full(storeys, self.hardening)
        return Building(name, masses, heights, stiffness, shears, hardening, alpha, beta)


def first_mode_share(storeys: int) -> float:
    """Return the share of the weight in the first mode of a building with equal storeys [-]."""
    number = np.arange(1, storeys + 1)
    mode = np.sin(np.pi * number / (2 * storeys + 1))
    return float(mode.sum() ** 2 / (storeys * (mode**2).sum()))


def stiffness_factor(storeys: int) -> float:
    """Return k / (m (2 pi / T)^2) of a building with equal storeys [-]."""
    return 1.0 / float(frequencies(np.ones(storeys), np.ones(storeys))[0]) ** 2


def find_archetype(type: str, design: str) -> Archetype:
    """Return a model building type at a design level.

    Raises
    ------
    KeyError : there is no such type (`list_types`), or it does not have this design level (`list_designs`)
    """
    return _read_archetypes()[type, design]


def list_types() -> tuple[str, ...]:
    """Return the short names of all types."""
    return tuple(dict.fromkeys(name for name, _ in _read_archetypes()))


def list_designs(type: str) -> tuple[str, ...]:
    """Return the design levels of a type, the strictest first."""
    return tuple(design for name, design in _read_archetypes() if name == type)


@cache
def _read_archetypes() -> dict[tuple[str, str], Archetype]:
    """Return all types at all of their design levels."""
    types = {row["type"]: row for row in _read_rows("hazus_types.csv")}
    found = {}
    for row in _read_rows("hazus_designs.csv"):
        of_type = types[row["type"]]
        typical_storeys = int(of_type["typical_storeys"])
        found[row["type"], row["design"]] = Archetype(
            row["type"],
            of_type["description"],
            row["design"],
            int(of_type["storeys_from"]),
            int(of_type["storeys_to"]) if of_type["storeys_to"] else None,
            typical_storeys,
            float(of_type["period"]),
            round(FOOT * float(of_type["typical_height"]) / typical_storeys, 2),
            float(row["strength"]),
            float(of_type["alpha1"]),
            float(of_type["gamma"]),
            float(of_type["lambda"]),
            float(row["yield_acceleration"]),
            float(row["hardening"]),
            float(of_type["damping"]),
            {state: float(row[state]) for state in DAMAGE_STATES},
        )
    return found


def _read_rows(name: str) -> list[dict[str, str]]:
    with Path(__file__).with_name(name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def draw_factors(spreads: Mapping[str, float], name: str, number: int, count: int) -> dict[str, float]:
    """Return the factors on the medians of one of the buildings that a neighbour may be [-], 1 of the median one.

    The buildings are a Latin hypercube: of every quantity each takes the middle of another of `count` equally likely
    parts of its lognormal distribution (McKay, M. D., Beckman, R. J. and Conover, W. J. (1979). A comparison of three
    methods for selecting values of input variables. Technometrics 21(2), 239-245).

    spreads : standard deviations of logarithms [-] (`Archetype.spreads`)
    name : of the building, so that two neighbours are drawn apart
    number : of the building that is drawn, from 1; 0: the median one
    count : number of buildings that are drawn
    """
    if number == 0:
        return dict.fromkeys(spreads, 1.0)
    scores = _draw_scores(name, count)[number - 1]
    return {each: math.exp(spreads[each] * score) for each, score in zip(UNCERTAIN, scores.tolist(), strict=True)}


@cache
def _draw_scores(name: str, count: int) -> np.ndarray:
    """Return a Latin hypercube of standard normal scores, with a deviation of 1, shape (count, quantities)."""
    from scipy.special import ndtri  # here: few studies have buildings that are only seen

    generator = np.random.Generator(np.random.PCG64([_SEED, zlib.crc32(name.encode())]))
    parts = np.stack([generator.permutation(count) for _ in UNCERTAIN], axis=-1)
    scores: np.ndarray = ndtri((parts + 0.5) / count)
    return scores / scores.std(axis=0)  # middles scatter a little less than the distribution

"""Elastic response spectra of codes, 5 % damped or by the code's own factor of damping.

Every branch of these spectra is a straight line in T and Sa, or a power of T, which is one in ln T and ln Sa. A
spectrum is therefore exact between the periods of its corners, at which the next branch begins.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from pounding_cli.records.motion import SPECTRUM_DAMPING
from pounding_cli.units import GRAVITY

EN1998 = "EN 1998-1"
ASCE7 = "ASCE 7-16"
NTC2018 = "NTC 2018"
GB50011 = "GB 50011-2010"

MAX_PERIOD = 60.0
"""Period to which a spectrum goes whose code sets no end [s]."""


@dataclass(frozen=True)
class CodeSpectrum:
    """The elastic response spectrum of a code.

    name : code and parameters in words
    periods, values : its corners [s], [m/s2], the first at T = 0
    straight_in_period : of every branch, whether it is a straight line in T and Sa; else it is one in ln T and ln Sa
    """

    name: str
    periods: tuple[float, ...]
    values: tuple[float, ...]
    straight_in_period: tuple[bool, ...]


@dataclass(frozen=True)
class SuiteRules:
    """Rules of a code for motions that are scaled to its spectrum.

    min_motions, count_clause : least number of motions, and where that stands
    range_end_factor, range_clause : the range of periods runs from RANGE_START_FACTOR times the shortest first period
        of the buildings to this multiple of the longest one, and where that stands
    range_note : what else the clause says of the range
    part, part_clause : part of the target that the mean spectrum may not fall below in that range [-], and where that
        stands
    peak_clause : where it asks that the mean of the peaks is at least the ordinate at T = 0; "" where it does not
    """

    min_motions: int
    count_clause: str
    range_end_factor: float
    range_clause: str
    range_note: str
    part: float
    part_clause: str
    peak_clause: str = ""


RANGE_START_FACTOR = 0.2
"""Multiple of the shortest first period at which the range begins, in both codes whose rules are known [-]."""


@dataclass(frozen=True)
class CodeRules:
    """The spectrum of a code, and its rules for motions that are scaled to it.

    build : of the spectrum, from the parameters of the code by name and `damping` [-]
    clause : where the spectrum stands
    reference : key of the code in the references
    max_period : longest period of the spectrum [s]
    damping : the only damping ratio that it has [-]; None: any
    suite : what it asks of the motions; None where that is not known here
    """

    build: Callable[..., CodeSpectrum]
    clause: str
    reference: str
    max_period: float = MAX_PERIOD
    damping: float | None = None
    suite: SuiteRules | None = None


# Europe

MIN_DAMPING_FACTOR = 0.55


def damping_factor(damping: float) -> float:
    """Return the factor eta on the ordinates of a damping ratio: sqrt(10 / (5 + xi)) with xi in %, at least 0.55.

    Source: EN 1998-1:2004, 3.2.2.2(3), eq. 3.6; NTC 2018, 3.2.3.2.1.
    """
    return max(math.sqrt(10.0 / (5.0 + 100.0 * damping)), MIN_DAMPING_FACTOR)


EN1998_GROUND: Mapping[tuple[int, str], tuple[float, float, float, float]] = MappingProxyType({
    (1, "A"): (1.00, 0.15, 0.40, 2.0),
    (1, "B"): (1.20, 0.15, 0.50, 2.0),
    (1, "C"): (1.15, 0.20, 0.60, 2.0),
    (1, "D"): (1.35, 0.20, 0.80, 2.0),
    (1, "E"): (1.40, 0.15, 0.50, 2.0),
    (2, "A"): (1.00, 0.05, 0.25, 1.2),
    (2, "B"): (1.35, 0.05, 0.25, 1.2),
    (2, "C"): (1.50, 0.10, 0.25, 1.2),
    (2, "D"): (1.80, 0.10, 0.30, 1.2),
    (2, "E"): (1.60, 0.05, 0.25, 1.2),
})  # fmt: skip
"""S [-], TB, TC, TD [s] by type of spectrum and ground type: EN 1998-1:2004, tables 3.2 and 3.3."""

EN1998_MAX_PERIOD = 4.0
"""Longest period of the spectrum of EN 1998-1:2004, eq. 3.5 [s]; the same in NTC 2018, 3.2.3.2.1."""


def build_en1998(
    type: int, soil: str, ag: float, importance: float = 1.0, damping: float = SPECTRUM_DAMPING
) -> CodeSpectrum:
    """Return the horizontal elastic response spectrum of EN 1998-1.

    With ag = importance x agR and eta of `damping_factor`:

        Se = ag S (1 + T / TB (2.5 eta - 1))  up to TB   (eq. 3.2)
        Se = 2.5 ag S eta                     up to TC   (eq. 3.3)
        Se = 2.5 ag S eta TC / T              up to TD   (eq. 3.4)
        Se = 2.5 ag S eta TC TD / T^2         up to 4 s  (eq. 3.5)

    type : 1, or 2 where earthquakes of a magnitude up to 5.5 contribute most
    soil : ground type, A to E
    ag : reference peak ground acceleration agR on ground type A [m/s2]
    importance : factor gamma_I [-]
    damping : ratio [-]

    Source: EN 1998-1:2004, 3.2.2.2, eqs 3.2 to 3.6, tables 3.2 and 3.3 (recommended values); 3.2.1(3): gamma_I.
    """
    factor, t_b, t_c, t_d = EN1998_GROUND[type, soil]
    at_zero = importance * ag * factor
    plateau = 2.5 * damping_factor(damping) * at_zero
    name = f"{EN1998}, type {type}, soil {soil}, {ag / GRAVITY:.4g} g"
    if importance != 1.0:
        name += f" x {importance:.4g}"
    return _build_european(name, at_zero, plateau, (t_b, t_c, t_d))


def _build_european(name: str, at_zero: float, plateau: float, corners: tuple[float, float, float]) -> CodeSpectrum:
    """Return a spectrum that rises in T, stays, falls as 1 / T and then as 1 / T^2."""
    t_b, t_c, t_d = corners
    values = (at_zero, plateau, plateau, plateau * t_c / t_d, plateau * t_c * t_d / EN1998_MAX_PERIOD**2)
    return CodeSpectrum(name, (0.0, t_b, t_c, t_d, EN1998_MAX_PERIOD), values, (True, False, False, False))


NTC_TOPOGRAPHY: Mapping[str, float] = MappingProxyType({"T1": 1.0, "T2": 1.2, "T3": 1.2, "T4": 1.4})
"""Factor ST of a topographic category, its largest value [-]: NTC 2018, table 3.2.V."""

NTC_STRATIGRAPHY: Mapping[str, tuple[float, float, float, float]] = MappingProxyType({
    "B": (1.0, 1.4, 0.4, 1.2),
    "C": (1.0, 1.7, 0.6, 1.5),
    "D": (0.9, 2.4, 1.5, 1.8),
    "E": (1.0, 2.0, 1.1, 1.6),
})  # fmt: skip
"""Factor SS by soil category, as least value, a, b and largest value of a - b F0 ag/g [-]: NTC 2018, table 3.2.IV.
That of category A is 1."""

NTC_PERIOD: Mapping[str, tuple[float, float]] = MappingProxyType({
    "A": (1.0, 0.0), "B": (1.10, -0.20), "C": (1.05, -0.33), "D": (1.25, -0.50), "E": (1.15, -0.40)
})  # fmt: skip
"""Factor CC by soil category, as a and b of a (TC*)^b: NTC 2018, table 3.2.IV."""


def build_ntc2018(
    ag: float, f0: float, tc_star: float, soil: str, topography: str = "T1", damping: float = SPECTRUM_DAMPING
) -> CodeSpectrum:
    """Return the horizontal elastic response spectrum of NTC 2018.

    With S = SS ST, TC = CC TC*, TB = TC / 3, TD = 4 ag/g + 1.6 s and eta of `damping_factor`:

        Se = ag S eta F0 (T / TB + 1 / (eta F0) (1 - T / TB))  up to TB
        Se = ag S eta F0                                       up to TC
        Se = ag S eta F0 TC / T                                up to TD
        Se = ag S eta F0 TC TD / T^2                           up to 4 s

    ag : peak ground acceleration at the site on rigid ground [m/s2]
    f0 : largest amplification of the spectrum F0 [-]
    tc_star : period TC* at which its branch of constant velocity begins [s]
    soil : category A to E
    topography : category T1 to T4
    damping : ratio [-]

    Source: NTC 2018 (D.M. 17/01/2018), 3.2.3.2.1, tables 3.2.IV and 3.2.V.
    """
    stratigraphy = 1.0
    if soil in NTC_STRATIGRAPHY:
        least, constant, slope, largest = NTC_STRATIGRAPHY[soil]
        stratigraphy = min(max(constant - slope * f0 * ag / GRAVITY, least), largest)
    at_zero = ag * stratigraphy * NTC_TOPOGRAPHY[topography]
    constant, power = NTC_PERIOD[soil]
    t_c = constant * tc_star**power * tc_star
    corners = (t_c / 3.0, t_c, 4.0 * ag / GRAVITY + 1.6)
    site = f"{ag / GRAVITY:.4g} g, F0 {f0:.4g}, TC* {tc_star:.4g} s"
    name = f"{NTC2018}, soil {soil}, {topography}, {site}"
    return _build_european(name, at_zero, damping_factor(damping) * f0 * at_zero, corners)


# United States

MCER_FACTOR = 1.5


def build_asce7(
    sds: float, sd1: float, tl: float, level: str = "design", damping: float = SPECTRUM_DAMPING
) -> CodeSpectrum:
    """Return the design response spectrum of ASCE 7-16, or that of the risk-targeted maximum considered earthquake.

    With T0 = 0.2 SD1 / SDS and TS = SD1 / SDS:

        Sa = SDS (0.4 + 0.6 T / T0)  up to T0  (eq. 11.4-5)
        Sa = SDS                     up to TS
        Sa = SD1 / T                 up to TL  (eq. 11.4-6)
        Sa = SD1 TL / T^2            beyond    (eq. 11.4-7)

    sds : design spectral acceleration at short periods [m/s2]
    sd1 : the same at 1 s [m/s2]
    tl : long-period transition period TL, at least TS [s]
    level : `design`, or `mcer`: 1.5 times as much
    damping : 5 %, the only ratio that it has [-]

    Source: ASCE/SEI 7-16, 11.4.6 and 11.4.7.
    """
    if not math.isclose(damping, SPECTRUM_DAMPING):
        message = f"{ASCE7} has a spectrum of 5 % damping only"
        raise ValueError(message)
    factor = MCER_FACTOR if level == "mcer" else 1.0
    t_s = sd1 / sds  # sd1 is the ordinate at 1 s: the product with it is in m/s
    periods = (0.0, 0.2 * t_s, t_s, tl, MAX_PERIOD)
    ordinates = (0.4 * sds, sds, sds, sd1 / tl, sd1 * tl / MAX_PERIOD**2)
    name = f"{ASCE7}, SDS {sds / GRAVITY:.4g} g, SD1 {sd1 / GRAVITY:.4g} g, TL {tl:.4g} s"
    if level == "mcer":
        name += ", MCE_R"
    return CodeSpectrum(name, periods, tuple(factor * each for each in ordinates), (True, False, False, False))


# China

GB50011_MAX_PERIOD = 6.0
"""Longest period of the spectrum of GB 50011-2010, 5.1.5 [s]."""


def build_gb50011(alpha_max: float, tg: float, damping: float = SPECTRUM_DAMPING) -> CodeSpectrum:
    """Return the spectrum of GB 50011-2010: its seismic influence coefficient alpha times g.

    alpha = alpha_max times

        0.45 + (eta2 - 0.45) T / 0.1 s             up to 0.1 s
        eta2                                       up to Tg
        eta2 (Tg / T)^gamma                        up to 5 Tg
        eta2 0.2^gamma - eta1 (T - 5 Tg) / 1 s     up to 6 s

    gamma = 0.9 + (0.05 - zeta) / (0.3 + 6 zeta); eta1 = 0.02 + (0.05 - zeta) / (4 + 32 zeta), at least 0;
    eta2 = 1 + (0.05 - zeta) / (0.08 + 1.6 zeta), at least 0.55; zeta is the damping ratio.

    alpha_max : largest seismic influence coefficient at 5 % damping [-]
    tg : characteristic period of the site Tg [s]
    damping : ratio [-]

    Source: GB 50011-2010 (2016), 5.1.5, eqs 5.1.5-1 to 5.1.5-3.
    """
    gamma = 0.9 + (0.05 - damping) / (0.3 + 6.0 * damping)
    slope = max(0.02 + (0.05 - damping) / (4.0 + 32.0 * damping), 0.0)
    plateau = max(1.0 + (0.05 - damping) / (0.08 + 1.6 * damping), 0.55)
    at_fall = plateau * 0.2**gamma
    shares = (0.45, plateau, plateau, at_fall, at_fall - slope * (GB50011_MAX_PERIOD - 5.0 * tg))
    name = f"{GB50011}, alpha_max {alpha_max:.4g}, Tg {tg:.4g} s"
    periods = (0.0, 0.1, tg, 5.0 * tg, GB50011_MAX_PERIOD)
    values = tuple(alpha_max * GRAVITY * share for share in shares)
    return CodeSpectrum(name, periods, values, (True, False, False, True))


EN1998_SUITE = SuiteRules(
    min_motions=3,
    count_clause="EN 1998-1:2004, 3.2.3.1.2(4)a",
    range_end_factor=2.0,
    range_clause="EN 1998-1:2004, 3.2.3.1.2(4)c",
    range_note="",
    part=0.9,
    part_clause="EN 1998-1:2004, 3.2.3.1.2(4)c",
    peak_clause="EN 1998-1:2004, 3.2.3.1.2(4)b",
)
ASCE7_SUITE = SuiteRules(
    min_motions=11,
    count_clause="ASCE/SEI 7-16, 16.2.2",
    range_end_factor=2.0,
    range_clause="ASCE/SEI 7-16, 16.2.3.1",
    range_note=", or to a multiple from 1.5 on that is justified",
    part=0.9,
    part_clause="ASCE/SEI 7-16, 16.2.3.2",
)

CODES: Mapping[str, CodeRules] = MappingProxyType({
    EN1998: CodeRules(build_en1998, "3.2.2.2", "en1998", EN1998_MAX_PERIOD, suite=EN1998_SUITE),
    ASCE7: CodeRules(build_asce7, "11.4.6 and 11.4.7", "asce2017", damping=SPECTRUM_DAMPING, suite=ASCE7_SUITE),
    NTC2018: CodeRules(build_ntc2018, "3.2.3.2.1", "ntc2018", EN1998_MAX_PERIOD),
    GB50011: CodeRules(build_gb50011, "5.1.5", "gb50011-2010", GB50011_MAX_PERIOD),
})  # fmt: skip
"""The codes whose spectra are known, by the name that a study gives."""

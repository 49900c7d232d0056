"""Two damped oscillators joined by a spring and a dashpot, in closed form (Figs 4 and 5): study, numbers, figure."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.laws.pounding import damping_ratio
from pounding_cli.numbers import Unit
from pounding_cli.paper.points import PointAnswer, PointCommand, SweepPoint, build_variable, describe_extremes
from pounding_cli.report.style import finish, panels, with_style
from pounding_cli.study.construct.complete_links import DEFAULT_RESTITUTION
from pounding_cli.study.schema.base import Model, spec_field
from pounding_cli.study.schema.quantity import MASS, STIFFNESS, TIME, ParsedText, Quantity, WholeNumber
from pounding_cli.tables import Column

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pounding_cli.report.document import Picture

MAX_PANELS = 4
"""Points of the sweep that the figure shows."""

MIN_GRID_POINTS = 4001
"""Grid on which peaks and bands are searched at least."""

_RATIO = Unit("", 1.0, "1")

CONNECTOR_COLUMNS = (
    Column("peak1", "largest ratio of system 1", _RATIO, "peak 1"),
    Column("at1", "Omega / omega10 at the peak of system 1", _RATIO, "at Ω/ω₁₀"),
    Column("peak2", "largest ratio of system 2", _RATIO, "peak 2"),
    Column("at2", "Omega / omega10 at the peak of system 2", _RATIO, "at Ω/ω₁₀"),
    Column("frequency_low", "lower coupled frequency over omega10", _RATIO, "ω low"),
    Column("frequency_high", "higher coupled frequency over omega10", _RATIO, "ω high"),
    Column("p", "omega20 / omega10", _RATIO),
)
"""The numbers of a point."""

SAME_RATIO = 1e-9
"""A ratio of displacements that is one to this is one [-]."""

DAMPING_RATIO = damping_ratio(DEFAULT_RESTITUTION)
"""Damping ratio of a connector whose dashpot the study does not give [-]."""

_JOINT = STIFFNESS.replace(example="0.2 k1", open_low=False)


def _read_joint(given: Any) -> float | str:
    if not isinstance(given, str) or not given.strip().endswith("k1"):
        return _JOINT.read(given)
    return f"{_JOINT.replace(si='').read(given.strip().removesuffix('k1')):.15g} k1"


Mass = Annotated[float, MASS]
OscillatorPeriod = Annotated[float, TIME.replace(name="period", example="0.5 s", high=60.0)]
ConnectorStiffness = Annotated[
    float | str, ParsedText(_read_joint, "stiffness of the connector", ("0.2 k1", "20 kN/mm"), _JOINT)
]
Dashpot = Annotated[float, Quantity("dashpot", "N s/m", "100 kN s/m", 0.0)]
Damping = Annotated[float, Quantity("damping ratio", "", "5 %", 0.0, 1.0)]
FrequencyRatio = Annotated[float, Quantity("frequency ratio", "", "0.6", 0.0, 100.0, open_low=True)]


class SystemSpec(Model):
    """One of the two systems."""

    mass: Mass = spec_field(200e3, "mass", "200 t")
    period: OscillatorPeriod | None = spec_field(
        None, "period alone; 0.5 s of the first unless stiffness is given", "0.5 s"
    )
    stiffness: Annotated[float, STIFFNESS] | None = spec_field(None, "stiffness, in place of the period")
    frequency_ratio: FrequencyRatio | None = spec_field(
        None, "p = omega20 / omega10 of the second, in place of the period", 0.6
    )
    damping: Damping | None = spec_field(None, "damping ratio; the study's unless given", "5 %")


class ConnectorSpec(Model):
    """The connector between the two systems."""

    stiffness: ConnectorStiffness = spec_field("0.2 k1", "K, as a multiple of k1 or in N/m", "0.2 k1")
    damping_ratio: Damping | None = spec_field(
        None,
        f"xi of its dashpot (eq. 7); default: {DAMPING_RATIO:.3g}, which follows from the restitution "
        f"{DEFAULT_RESTITUTION:g} that connectors of `pound run` have unless a study gives another",
        0.1,
    )
    dashpot: Dashpot | None = spec_field(None, "its dashpot, in place of damping_ratio", "100 kN s/m")


class FrequenciesSpec(Model):
    """Frequencies at which the ratios are computed, in Omega / omega10."""

    low: FrequencyRatio = spec_field(0.2, "lowest Omega / omega10", 0.2)
    high: FrequencyRatio = spec_field(1.6, "highest Omega / omega10", 1.6)
    points: Annotated[int, WholeNumber(11, 1_000_000)] = spec_field(1401, "number of frequencies", 1401)


class ConnectorStudySpec(Model):
    """A study of two connected oscillators (paper, Figs 4 and 5)."""

    title: str = spec_field(..., "one line that says what is studied", "Two connected oscillators")
    first: SystemSpec = SystemSpec(period=0.5)
    second: SystemSpec = SystemSpec(frequency_ratio=0.6)
    connector: ConnectorSpec = ConnectorSpec()
    damping: Damping = spec_field(0.05, "damping ratio of both systems", "5 %")
    frequencies: FrequenciesSpec = FrequenciesSpec()
    sweep: Any = spec_field(None, "keys and the values they take", {"damping": ["5 %", "10 %"]})

    def issues(self) -> Iterator[Issue]:
        """Yield keys that give one quantity twice or not at all, and a range of frequencies without extent."""
        kinds = ("period", "stiffness", "frequency_ratio")
        for name, keys in {"first": kinds, "second": kinds, "connector": ("damping_ratio", "dashpot")}.items():
            given_keys = [key for key in keys if getattr(getattr(self, name), key) is not None]
            if len(given_keys) > 1:
                first, second = given_keys[:2]
                message = f"'{first}' and '{second}' cannot both be given"
                yield Issue((name, second), message, "remove one", at_key=True)
            if name == "second" and not given_keys:
                yield Issue((name,), "the second system has no frequency", "add `frequency_ratio: 0.6`, or a period")
        if self.first.frequency_ratio is not None:
            yield Issue(
                ("first", "frequency_ratio"), "the ratio is that of the second system", "write a period", at_key=True
            )
        if self.frequencies.low >= self.frequencies.high:
            yield Issue(("frequencies",), "'low' is not below 'high'", "write e.g. {low: 0.2, high: 1.6}")


class OscillatorPair(NamedTuple):
    """Two oscillators and what connects them.

    m, k, zeta : masses [kg], stiffnesses [N/m] and damping ratios [-] of the two, shapes (2,)
    joint, dashpot : stiffness K [N/m] and dashpot c [N s/m] of the connector
    """

    m: np.ndarray
    k: np.ndarray
    zeta: np.ndarray
    joint: float
    dashpot: float


def build_pair(study: ConnectorStudySpec) -> OscillatorPair:
    """Return the numbers of a study; c is as given, or 2 xi sqrt(K m1 m2 / (m1 + m2)) (eq. 7, units corrected)."""
    first = study.first
    second = study.second
    joint = study.connector.stiffness
    k1 = first.stiffness or first.mass * (2 * math.pi / (first.period or 0.5)) ** 2
    k2 = second.stiffness or second.mass * (2 * math.pi / (second.period or math.nan)) ** 2
    if second.frequency_ratio is not None:
        k2 = second.mass * second.frequency_ratio**2 * k1 / first.mass
    k = float(joint.removesuffix("k1")) * k1 if isinstance(joint, str) else joint
    xi = study.connector.damping_ratio
    if xi is None:
        xi = DAMPING_RATIO
    dashpot = 2 * xi * math.sqrt(k * first.mass * second.mass / (first.mass + second.mass))
    dashpot = dashpot if study.connector.dashpot is None else study.connector.dashpot
    zeta = [study.damping if one.damping is None else one.damping for one in (first, second)]
    return OscillatorPair(np.array([first.mass, second.mass]), np.array([k1, k2]), np.array(zeta), k, dashpot)


def find_coupled_frequencies(pair: OscillatorPair) -> tuple[float, float]:
    """Return the two undamped circular frequencies of the connected systems [rad/s], lower first.

    They are the roots of (a - w^2) (b - w^2) = K^2 / (m1 m2) with a = (k1 + K) / m1, b = (k2 + K) / m2. The lower one
    comes from their product, a sum of positive terms: nothing cancels for a stiff connector.
    """
    m1, m2 = pair.m
    k1, k2 = pair.k
    k = pair.joint
    a = (k1 + k) / m1
    b = (k2 + k) / m2
    high = 0.5 * (a + b) + math.hypot(0.5 * (a - b), k / math.sqrt(m1 * m2))
    return math.sqrt(((k1 / m1) * (k2 / m2) + k * (k1 + k2) / (m1 * m2)) / high), math.sqrt(high)


def compute_response_ratios(pair: OscillatorPair, omega: np.ndarray) -> np.ndarray:
    """Return the steady displacement, connected over alone, of both systems under a_g = exp(i Omega t).

    It is complex, of shape (2, n).

    With D_j = k_j - m_j Omega^2 + i Omega c_j and Z = K + i Omega c, Cramer's rule gives

        R1 = D1 (D2 + Z (m1 + m2) / m1) / (D1 D2 + Z (D1 + D2)),

    and R2 by exchanging the indices, so that m1 R1 + m2 R2 = m1 + m2 whatever K, c, p and Omega are. Their absolute
    values are the paper's Fig. 5. omega : circular frequencies of the ground motion [rad/s], shape (n,), > 0
    """
    m = pair.m[:, None]
    k = pair.k[:, None]
    zeta = pair.zeta[:, None]
    z = pair.joint + 1j * omega * pair.dashpot
    d = k - m * omega**2 + 2j * zeta * np.sqrt(k * m) * omega
    return d * (d[::-1] + z * m.sum() / m) / (d[0] * d[1] + z * d.sum(axis=0))


def solve_connector(study: ConnectorStudySpec) -> PointAnswer:
    """Return both ratios over frequency, their peaks, and the bands in which both exceed one, found to rounding.

    Peaks and bands are searched on a grid, then refined: two features closer than one interval are seen as one.

    Raises
    ------
    InputError : numbers are too large or too small to compute with
    """
    from scipy.optimize import brentq, minimize_scalar  # here: `pound check` does not need it

    both = build_pair(study)
    low = study.frequencies.low
    high = study.frequencies.high
    alone, other = np.sqrt(both.k / both.m)
    ratio = np.linspace(low, high, study.frequencies.points)
    grid = np.linspace(low, high, max(ratio.size, MIN_GRID_POINTS))

    def compute_sizes(x: Any) -> np.ndarray:
        return np.abs(compute_response_ratios(both, np.atleast_1d(x) * alone))

    numbers: dict[str, float] = {}
    arrays = {"frequency": build_variable("1", "Omega / omega10", ratio, "frequency")}
    for which, each in enumerate(compute_response_ratios(both, ratio * alone)):
        best = int(np.argmax(compute_sizes(grid)[which]))
        number = which + 1
        ends = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
        top = minimize_scalar(lambda x, which=which: -compute_sizes(x)[which, 0], bounds=ends, options={"xatol": 1e-10})
        peak, place = max((float(compute_sizes(x)[which, 0]), float(x)) for x in (top.x, grid[best]))
        numbers[f"peak{number}"] = peak
        numbers[f"at{number}"] = place
        text = f"displacement of system {number}, connected over alone"
        arrays[f"R{number}"] = build_variable("1", text, np.abs(each), "frequency")
        arrays[f"R{number}_real"] = build_variable("1", f"{text}, real part", each.real, "frequency")
        arrays[f"R{number}_imag"] = build_variable("1", f"{text}, imaginary part", each.imag, "frequency")
    smaller = compute_sizes(grid).min(axis=0) - 1.0
    # A ratio that is one throughout (no connector, equal systems) is not above one: rounding is left out.
    above = smaller > 1e-12
    edges = [low] if above[0] else []
    for i in np.flatnonzero(above[1:] != above[:-1]):
        crosses = smaller[i] * smaller[i + 1] < 0
        x = brentq(lambda x: compute_sizes(x).min() - 1.0, grid[i], grid[i + 1], xtol=1e-14) if crosses else grid[i]
        edges.append(float(x))
    bands = np.array([*edges, high] if above[-1] else edges).reshape(-1, 2)
    lower, upper = find_coupled_frequencies(both)
    numbers["frequency_low"] = float(lower / alone)
    numbers["frequency_high"] = float(upper / alone)
    numbers["p"] = float(other / alone)
    text = "bands of Omega / omega10 in which both ratios exceed one"
    arrays["both_above"] = build_variable("1", text, bands, "band", "edge")
    if not all(np.isfinite(number) for number in numbers.values()):
        hint = "give masses, stiffnesses and dashpots that differ by fewer powers of ten"
        raise InputError("the response is not finite", hint)
    return PointAnswer(numbers, arrays, [describe_bands(bands)])


def describe_bands(bands: np.ndarray) -> str:
    """Return in words at which frequencies both systems move farther than alone.

    bands : ends of the bands of Omega / omega10, shape (n, 2)
    """
    if not len(bands):
        return "at no frequency do both systems move farther than alone"
    texts = [f"{low:.3f} to {high:.3f}" for low, high in bands]
    return f"both systems move farther than alone at Ω/ω₁₀ = {' and '.join(texts)}"


def list_connector_sentences(points: Sequence[SweepPoint]) -> list[str]:
    """Return which systems the connector makes move farther than alone, and how much."""
    is_increased = [any(point.numbers[name] > 1 + SAME_RATIO for point in points) for name in ("peak1", "peak2")]
    if all(is_increased):
        verdict = "the largest displacements of both systems"
    elif any(is_increased):
        number = 1 + is_increased.index(True)
        verdict = f"the largest displacement of system {number}, and at no frequency that of system {3 - number}"
    else:
        verdict = "the displacement of neither system at any frequency"
    low = min(point.study.frequencies.low for point in points)
    high = max(point.study.frequencies.high for point in points)
    peaks = [describe_extremes(points, column) for column in CONNECTOR_COLUMNS if column.name in ("peak1", "peak2")]
    return [
        f"The connector increases {verdict}: where it moves most, system 1 moves {peaks[0]} times as far as alone, "
        f"and system 2 moves {peaks[1]} times as far (at Ω/ω₁₀ from {low:g} to {high:g})."
    ]


def cite_connector(study: ConnectorStudySpec) -> Iterator[tuple[str, str]]:
    """Yield the references of a study, each with what for."""
    yield "spiliopoulos1996", "two connected oscillators, Figs 4 and 5"
    yield "westermo1989", "connecting buildings"
    if study.connector.dashpot is None and study.connector.damping_ratio != 0:
        yield "anagnostopoulos1988", "the dashpot, eq. (7)"


def list_connector_figures(title: str, points: Sequence[SweepPoint]) -> list[Picture]:
    """Return the figure of both ratios against the frequency of the ground."""
    from pounding_cli.report.document import Picture

    heading = "Largest displacements over those alone, |R1| and |R2|, against the frequency of the ground"
    return [Picture("ratios", heading, heading, partial(draw_ratios, title, points))]


@with_style
def draw_ratios(title: str, points: Sequence[SweepPoint]) -> Figure:
    """Draw one panel a point of the sweep, of the first four, |R1| solid and |R2| dashed."""
    drawn = points[:MAX_PANELS]
    figure, axes = panels(1, len(drawn), sharex=True, sharey=True)
    for ax, point in zip(axes[0], drawn, strict=True):
        frequency = point.values("frequency")
        ax.plot(frequency, point.values("R1"), color="#000000", lw=1.6, label="system 1")
        ax.plot(frequency, point.values("R2"), color="#0072B2", linestyle=(0, (5, 2)), lw=1.6, label="system 2")
        for low, high in point.values("both_above"):
            ax.axvspan(low, high, color="0.88", zorder=0)
        for name in ("frequency_low", "frequency_high"):
            ax.axvline(point.numbers[name], color="#AA2211", lw=0.9, linestyle=(0, (1, 1.5)))
        ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        ax.set_title(point.label or "response ratios", loc="left")
        ax.set(xlabel="Ω / ω₁₀", ylabel="largest displacement over that alone")
        ax.set(xlim=(frequency[0], frequency[-1]), ylim=(0, None))
    axes[0, 0].legend(loc="upper right")
    left_out = f" The first {len(drawn)} of {len(points)} points of the sweep." if len(points) > len(drawn) else ""
    finish(figure, title, f"Grey: both ratios exceed one. Dotted: frequencies of the connected pair.{left_out}")
    return figure


COMMAND = PointCommand(
    name="connector",
    spec=ConnectorStudySpec,
    solve=solve_connector,
    columns=CONNECTOR_COLUMNS,
    shown_columns=[column.name for column in CONNECTOR_COLUMNS],
    sentences=list_connector_sentences,
    figures=list_connector_figures,
    cite=cite_connector,
)
"""`pound connector`."""

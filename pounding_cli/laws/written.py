"""Laws of links that a study writes as a formula (`laws.formula`)."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.formula import GIVEN, Dimension, FormulaError, Term, is_straight, powers_of_closing, read
from pounding_cli.laws.law import Branch, Guard, LinkLaw, falls_below, opening
from pounding_cli.laws.program import Expression, operations

LARGEST_ROOT = 8
"""Powers of v are whole powers of v^(1/b) with b up to this."""

_PRESSED = (0.0, 1e-6, 1e-3, 0.01, 0.1)
_BOTH_WAYS = (*(-v for v in _PRESSED[1:]), *_PRESSED)


@dataclass(frozen=True)
class WrittenLaw(LinkLaw):
    """F = the formula, once the gap has closed; v is the closing less the gap.

    called : its name
    formula : its force [N] of v, r, m, d and its constants
    constants : (name, SI value, dimension), ...
    tension_cut : no force that pulls the floors together

    Raises
    ------
    FormulaError : what the formula says cannot be solved
    """

    closings: ClassVar[tuple[float, ...]] = _PRESSED
    subtracts_gap: ClassVar[bool] = True

    called: str = ""
    formula: str = ""
    constants: tuple[tuple[str, float, Dimension], ...] = ()
    tension_cut: bool = False

    @property
    def name(self) -> str:  # type: ignore[override]  # of the study, not of the class
        """As the study calls it."""
        return self.called

    def __post_init__(self) -> None:
        super().__post_init__()
        operations(self._force(1.0), self._root)

    def _force(self, mass: float) -> Expression:
        return _read(self.formula, self.constants, mass, self.gap, self.closings)

    @property
    def _root(self) -> int:
        """b of which all powers of v are whole powers of v^(1/b)."""
        powers = powers_of_closing(self._force(1.0))
        for root in range(1, LARGEST_ROOT + 1):
            if all(abs(power * root - round(power * root)) < 1e-9 for power in powers):
                return root
        told = ", ".join(f"{power:g}" for power in sorted(powers))
        raise FormulaError(
            f"the powers of v, {told}, are not whole multiples of one of 1, 1/2, ..., 1/{LARGEST_ROOT}",
            "write e.g. v**1.5 or v**1.25",
        )

    def _branch(self, name: str, left_mass: float, right_mass: float, guards: tuple[Guard, ...] = ()) -> Branch:
        force = self._force(left_mass * right_mass / (left_mass + right_mass))
        if not is_straight(force):
            return Branch(name, force=force, regular=self._root, guards=guards)
        still = float(force.at(0.0, 0.0))
        linear, dashpot = float(force.at(1.0, 0.0)) - still, float(force.at(0.0, 1.0)) - still
        return Branch(name, linear, offset=still, dashpot=dashpot, guards=guards)

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """Open and in contact."""
        contact = self._branch("contact", left_mass, right_mass, (falls_below(0.0, "open"),))
        return opening(contact, tension_cut=self.tension_cut)


@dataclass(frozen=True)
class WrittenFilling(WrittenLaw):
    """F = the formula while the material that fills the gap is pressed; v is the closing."""

    drawn: ClassVar[str] = "filling"
    subtracts_gap: ClassVar[bool] = False
    beyond_gap: ClassVar[str] = "material of a law of the study compressed beyond its thickness"


@dataclass(frozen=True)
class WrittenJoint(WrittenLaw):
    """F = the formula at all times; v is the closing, of either sign."""

    closings: ClassVar[tuple[float, ...]] = _BOTH_WAYS
    drawn: ClassVar[str] = "bar"
    subtracts_gap: ClassVar[bool] = False
    beyond_gap: ClassVar[str] = "joint of a law of the study closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.tension_cut:
            raise FormulaError("a law that acts always may pull", "leave `tension_cut` out")
        still = float(self._force(1.0).at(0.0, 0.0))
        if still != 0.0:
            raise FormulaError(f"the force at rest, v = r = 0, is {still:g} N", "let it be zero there")

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """One without end."""
        return (self._branch("joined", left_mass, right_mass),)


WRITTEN: Mapping[str, type[WrittenLaw]] = {
    "beyond gap": WrittenLaw,
    "compression": WrittenFilling,
    "always": WrittenJoint,
}
"""By when they act."""


@functools.lru_cache(maxsize=4096)
def _read(
    formula: str,
    constants: tuple[tuple[str, float, Dimension], ...],
    mass: float,
    gap: float,
    closings: tuple[float, ...],
) -> Expression:
    known = {name: Term(value, dimension) for name, value, dimension in constants}
    return read(formula, {**known, "m": Term(mass, GIVEN["m"][0]), "d": Term(gap, GIVEN["d"][0])}, closings)

"""The building that tables of a frame program give, and the choices that they leave open."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.imports.headings import PERIOD_TABLES
from pounding_cli.model.stiffness import frequencies

MAX_PERIOD_DIFFERENCE = 0.05
"""Relative difference of the periods of stick and model beyond which storeys do not deform in shear alone."""


@dataclass(frozen=True)
class Choices:
    """Choices that the tables leave open, as options of the command give them.

    direction : of the row, "X" or "Y"
    case, step, tower : of the tables; "" where they leave no choice
    order : "up" or "down": the order of the rows, where nothing else shows it; "" for none
    mode : number of the mode whose period the stick is compared with; None: the first one along the row
    period : of the model [s], where the tables have none; None for none
    """

    direction: str = "X"
    case: str = ""
    step: str = ""
    tower: str = ""
    order: str = ""
    mode: int | None = None
    period: float | None = None


@dataclass
class ImportedBuilding:
    """A building from tables; arrays run from the ground up, shape (n,).

    names : of the storeys
    height [m], mass [kg], stiffness [N/m], yield_shear [N], hardening [-]
    eccentricity : of the centres of stiffness from the centres of mass, across the row [m]; None where no table has it
    model_period : of the model [s]; None where no table has it
    mode_words : which mode that is
    notes : which table and column was taken for what
    warnings : what a reader must know
    """

    names: tuple[str, ...]
    height: np.ndarray
    mass: np.ndarray
    stiffness: np.ndarray | None = None
    yield_shear: np.ndarray | None = None
    hardening: np.ndarray | None = None
    eccentricity: np.ndarray | None = None
    model_period: float | None = None
    mode_words: str = ""
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def stick_period(self) -> float:
        """First period of the shear building on a fixed base [s]."""
        assert self.stiffness is not None
        return float(2 * math.pi / frequencies(self.mass, self.stiffness)[0])

    def match_period(self) -> None:
        """Scale the stiffnesses so that the first period is that of the model.

        Raises
        ------
        InputError : the period of the model is not known
        """
        if self.model_period is None or self.stiffness is None:
            message = "--match-period needs the period of the model, and no table has it"
            raise InputError(message, f"export the table '{PERIOD_TABLES[0]}', or give --period 1.2 s")
        factor = (self.stick_period / self.model_period) ** 2
        self.stiffness = self.stiffness * factor
        self.notes.append(f"stiffnesses: scaled by {factor:.6g}, so that the first period is that of the model")

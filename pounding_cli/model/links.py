"""What stands between two neighbouring floors, and its law (paper, eqs 5-10)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import Pounding

APART = "apart"
"""What tables call the kind of a link that is nothing but a place where the closing of two floors is found."""


@dataclass(frozen=True)
class Link:
    """One link between floor `left_floor` of building `left` and `right_floor` of the building to its right.

    Parameters
    ----------
    left : place of the left building in the group, from 0; the right building is left + 1
    left_floor, right_floor : floors, from 1
    law : its law with its parameters: `Pounding`, `Infill`, `Connector`, ...

    Raises
    ------
    ValueError : a value is outside its range
    """

    left: int
    left_floor: int
    right_floor: int
    law: LinkLaw

    def __post_init__(self) -> None:
        if self.left < 0:
            raise ValueError(f"link: left is {self.left}; places in the group count from 0")
        if self.left_floor < 1 or self.right_floor < 1:
            raise ValueError(f"link: floors {self.left_floor} and {self.right_floor}; floors count from 1")

    @classmethod
    def apart(cls, left: int, left_floor: int, right_floor: int) -> Link:
        """Nothing between two floors: no force whatever they do; a run finds their largest closing all the same."""
        return cls(left, left_floor, right_floor, Pounding(math.inf, 1.0, 0.0))

    @property
    def kind(self) -> str:
        """The name of its law; APART where nothing stands between the floors."""
        return APART if self.law.gap == math.inf else self.law.name

    @property
    def gap(self) -> float:
        """Initial distance of the floors [m]."""
        return self.law.gap

    @property
    def words(self) -> str:
        """Everything about the link, in a line: two links with one line act alike."""
        return f"{self.left} {self.left_floor} {self.right_floor} {self.law.words}"

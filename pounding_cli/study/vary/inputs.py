"""Inputs that vary with a number between 0 and 1: drawn from a distribution, chosen, or searched over a range."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.study.schema.quantity import Quantity, StoreyMultiple
from pounding_cli.study.text.file import Mark
from pounding_cli.study.vary.ranges import canonical_value, in_unit

MOTION = "motion"
"""The key that stands for the choice of motions."""

DRAWN_SETS = 64
"""Number of the sets of motions of a bootstrap."""


_LEAST = 1e-12
"""Probability beyond the last values of a distribution without an end: seven standard deviations from the mean."""

_TAIL = 0.01
"""Probability beyond which the values of a distribution without an end count as its end."""


@dataclass(frozen=True)
class Distribution:
    """A distribution with its fields in SI.

    name : key in REQUIRED_FIELDS
    is_log : uniform in the logarithm
    storey : its values are multiples of the stiffness of this storey
    """

    name: str
    fields: Mapping[str, float] = field(default_factory=dict)
    is_log: bool = False
    storey: StoreyMultiple | None = None

    @property
    def spacing(self) -> str:
        """Spacing of a range as a study writes it."""
        return "log" if self.is_log else "linear"

    @property
    def ends(self) -> tuple[float, float]:
        """`from` and `to`, infinite where they are not given."""
        return self.fields.get("from", -np.inf), self.fields.get("to", np.inf)

    @cached_property
    def _scipy(self) -> Any:
        """The distribution of scipy, of the logarithm where that is normal."""
        from scipy import stats  # half a second to import, and few studies have distributions

        low, high = self.ends
        if self.name == "uniform":
            return stats.loguniform(low, high) if self.is_log else stats.uniform(low, high - low)
        if self.name == "triangular":
            return stats.triang((self.fields["mode"] - low) / (high - low), low, high - low)
        if self.name == "normal":
            centre = self.fields["mean"]
            width = self.fields["sd"]
        else:
            centre = np.log(self.fields["median"])
            width = self.fields["spread"]
            with np.errstate(divide="ignore"):
                low = np.log(max(low, 0.0))
                high = np.log(high)
        return stats.truncnorm((low - centre) / width, (high - centre) / width, centre, width)

    def __call__(self, u: np.ndarray | float) -> np.ndarray:
        """Return the values at u in [0, 1], which covers what lies between `from` and `to`; same shape."""
        u = np.asarray(u, dtype=float)
        is_endless = self.name in ("normal", "lognormal") and not {"from", "to"} <= self.fields.keys()
        values = self._scipy.ppf(np.clip(u, _LEAST, 1 - _LEAST) if is_endless else u)
        return np.clip(np.exp(values) if self.name == "lognormal" else values, *self.ends)

    def quantile_of(self, value: float) -> float | None:
        """Return the u of a uniform distribution at a value; None beyond its ends."""
        low, high = self.ends
        return float(self._scipy.cdf(value)) if low <= value <= high else None


@dataclass(frozen=True, kw_only=True)
class UncertainInput(ABC):
    """An input of a study that varies with a number u between 0 and 1.

    key : dotted key as in the file; MOTION for the choice of motions
    mark : where the key stands
    unit : unit in which people read its values
    """

    key: str
    mark: Mark
    unit: Unit

    @property
    @abstractmethod
    def members(self) -> tuple[KeyInput, ...]:
        """The keys of the study that move with u."""

    @property
    @abstractmethod
    def option_count(self) -> int:
        """Number of the options that it chooses from; 0 where it is continuous."""

    @abstractmethod
    def end_quantiles(self) -> list[float]:
        """Return the u of both ends of a range, or of every option."""

    @abstractmethod
    def split_at_ends(self, u: np.ndarray, output: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the values of an output at the low and at the high end of the input; None where it has no ends.

        u, output : of every sample, shape (samples,)
        share : part of the range that counts as an end [-]
        """


@dataclass(frozen=True, kw_only=True)
class KeyInput(UncertainInput):
    """A key of the study that varies.

    quantity : what the key takes; None for a word
    moves_with : further keys that move by the same u
    """

    quantity: Quantity | None = None
    moves_with: tuple[KeyInput, ...] = ()

    @property
    def members(self) -> tuple[KeyInput, ...]:
        return (self, *self.moves_with)

    @property
    @abstractmethod
    def middle(self) -> float:
        """The u of the middle of the range or of the options."""

    @property
    @abstractmethod
    def column_unit(self) -> str:
        """SI unit of its column in a table, "1" for a pure number; "" where the column holds texts."""

    @abstractmethod
    def values(self, u: Sequence[float] | np.ndarray) -> list[Any]:
        """Return the values at every u as a study writes them."""

    @abstractmethod
    def to_column(self, u: np.ndarray) -> list[str] | np.ndarray:
        """Return the values at every u as a table has them: SI numbers, or the texts of the options."""

    @abstractmethod
    def quantile_of(self, written: Any) -> float | None:
        """Return the u of a value as the file writes it; None for a value that the key does not take here."""


@dataclass(frozen=True, kw_only=True)
class ChoiceInput(KeyInput):
    """A key that takes one of some values.

    options : the values as the file writes them, two or more
    """

    options: tuple[Any, ...]

    @property
    def option_count(self) -> int:
        return len(self.options)

    @property
    def middle(self) -> float:
        return option_quantile(self.option_count // 2, self.option_count)

    @property
    def column_unit(self) -> str:
        return ""

    def end_quantiles(self) -> list[float]:
        return option_quantiles(self.option_count)

    def split_at_ends(self, u: np.ndarray, output: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
        return _split_by_option(choose_option(u, self.option_count), output)

    def values(self, u: Sequence[float] | np.ndarray) -> list[Any]:
        numbers = choose_option(np.asarray(u), self.option_count)
        return [self.options[number] for number in numbers.tolist()]

    def to_column(self, u: np.ndarray) -> list[str]:
        return [str(option) for option in self.values(u)]

    def quantile_of(self, written: Any) -> float | None:
        value = canonical_value(written, self.quantity)
        numbers = {canonical_value(option, self.quantity): number for number, option in enumerate(self.options)}
        return option_quantile(numbers[value], self.option_count) if value in numbers else None


@dataclass(frozen=True, kw_only=True)
class DistributedInput(KeyInput):
    """A key that is drawn from a distribution, or searched over a range.

    distribution : of its values; of a range the uniform one
    """

    distribution: Distribution

    @property
    def option_count(self) -> int:
        return 0

    @property
    def middle(self) -> float:
        return 0.5

    @property
    def column_unit(self) -> str:
        return self.unit.si or "1"

    def end_quantiles(self) -> list[float]:
        low, high = self.distribution.ends
        return [0.0 if np.isfinite(low) else _TAIL, 1.0 if np.isfinite(high) else 1.0 - _TAIL]

    def split_at_ends(self, u: np.ndarray, output: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
        return output[u < share], output[u >= 1 - share]

    def values(self, u: Sequence[float] | np.ndarray) -> list[Any]:
        numbers = self.to_column(np.asarray(u)).tolist()
        storey = self.distribution.storey
        if storey is None:
            return [in_unit(number, self.unit) for number in numbers]
        return [str(replace(storey, factor=number)) for number in numbers]

    def to_column(self, u: np.ndarray) -> np.ndarray:
        return self.distribution(u)

    def quantile_of(self, written: Any) -> float | None:
        value = canonical_value(written, self.quantity)
        if find_storey(value) != self.distribution.storey:
            return None
        number = value.factor if isinstance(value, StoreyMultiple) else value
        return self.distribution.quantile_of(number) if isinstance(number, int | float) else None


@dataclass(frozen=True, kw_only=True)
class MotionInput(UncertainInput):
    """The choice of motions: one of them, or as many as there are, drawn anew with replacement.

    is_bootstrap : drawn with replacement
    motion_count : number of the motions of the study
    """

    is_bootstrap: bool
    motion_count: int

    @property
    def members(self) -> tuple[KeyInput, ...]:
        return ()

    @property
    def option_count(self) -> int:
        return DRAWN_SETS if self.is_bootstrap else self.motion_count

    def end_quantiles(self) -> list[float]:
        return option_quantiles(self.option_count)

    def split_at_ends(self, u: np.ndarray, output: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray] | None:
        if self.is_bootstrap:
            return None
        return _split_by_option(choose_option(u, self.option_count), output)

    def draw_sets(self, seed: int) -> np.ndarray:
        """Return the numbers of the motions of every option, shape (options, motions of an option)."""
        if not self.is_bootstrap:
            return np.arange(self.motion_count)[:, None]
        size = self.option_count, self.motion_count
        return np.sort(np.random.default_rng(seed).integers(self.motion_count, size=size), axis=1)


def choose_option(u: np.ndarray, count: int) -> np.ndarray:
    """Return the number of the option, from 0, at every u in [0, 1]."""
    return np.minimum((np.asarray(u) * count).astype(int), count - 1)


def option_quantile(number: int, count: int) -> float:
    """Return the u of an option, in the middle of its share."""
    return (number + 0.5) / count


def option_quantiles(count: int) -> list[float]:
    """Return the u of every option."""
    return [option_quantile(number, count) for number in range(count)]


def _split_by_option(numbers: np.ndarray, output: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the values of an output at the options where its mean is least and most.

    numbers : of the option of every sample, shape (samples,)
    """
    groups = sorted((output[numbers == number] for number in np.unique(numbers)), key=np.mean)
    return groups[0], groups[-1]


def find_storey(value: Any) -> StoreyMultiple | None:
    """Return the storey whose stiffness a value is a multiple of, once its stiffness; None for other values."""
    return replace(value, factor=1.0) if isinstance(value, StoreyMultiple) else None

"""The methods of solution: what each is called, which setting it takes, who published it.

They are stated here alone; the study's schema, `solve`, `pound accuracy` and citations read this list."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from pounding_cli.errors import InputError


@dataclass(frozen=True)
class Setting:
    """The setting of a method: an accuracy or a time step.

    Parameters
    ----------
    key : its name in study files, in `solve` and in the columns of results
    title, unit : its name in sentences; the unit of its values, "" where they are relative [-]
    example : as people write it
    trial_values : values that `pound accuracy` tries, coarse to fine
    """

    key: str
    title: str
    unit: str
    example: str
    trial_values: tuple[float, ...]

    def text(self, value: float) -> str:
        """A value with its unit: "0.001 s"."""
        return f"{value:g} {self.unit}".rstrip()


ACCURACY = Setting("accuracy", "accuracy", "", "1e-6", (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10))
"""Relative error wanted of the peaks [-]; the method chooses its steps."""

_STEPS = (2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6)
TIME_STEP = Setting("time_step", "time step", "s", "1e-4 s", _STEPS)
"""Length of every step [s]; cut to a whole number of steps in a sample of the motion."""


@dataclass(frozen=True)
class Method:
    """One way to integrate the equations of motion.

    Parameters
    ----------
    name : its key in METHODS and in a study file
    title : what tables and figures call it
    order : of convergence in the time step where the motion is smooth [-]; 0 where it follows the accuracy asked
    setting : what it is told
    citation : (key of `report/references.bib`, where in it or with what values), ...
    remembers : whether it runs laws whose force depends on events before
    """

    name: str
    title: str
    order: int
    setting: Setting
    citation: tuple[tuple[str, str], ...]
    remembers: bool = False

    @property
    def takes_step(self) -> bool:
        """True where its setting is a time step."""
        return self.setting is TIME_STEP

    def check_setting(self, accuracy: float, time_step: float | None = None) -> float:
        """Its setting, which of both it is.  Raises InputError: a setting that it does not take, or not above zero."""
        setting = self.setting
        value = time_step if self.takes_step else accuracy
        if self.takes_step != (time_step is not None):
            message = f"method {self.name} takes {'a time step' if self.takes_step else 'an accuracy and no time step'}"
            raise InputError(message, f"give it e.g. `{setting.key}: {setting.example}` and no other setting")
        if value is None or not (isfinite(value) and value > 0):
            hint = f"write e.g. `{setting.key}: {setting.example}`"
            raise InputError(f"{setting.title} is {value:g}; it must be above zero", hint)
        return value


_LIST = (
    Method("taylor", "Taylor with events", 0, ACCURACY, (("jorba2005", ""),), remembers=True),
    Method("dop853", "Dormand-Prince 8(5,3) with events", 8, ACCURACY, (("hairer1993", "section II.10"),), True),
    Method("central-difference", "central difference", 2, TIME_STEP,
           (("newmark1959", "with beta = 0"), ("bathe1996", "section 9.2.1"))),
    Method("newmark", "Newmark", 2, TIME_STEP, (("newmark1959", ""),)),
)  # fmt: skip

METHODS: dict[str, Method] = {method.name: method for method in _LIST}
"""The methods by name, as tables list them. Whoever has one of his own adds it here (docs/extending.md)."""


def get_method(name: str) -> Method:
    """The method of that name.  Raises `InputError` where there is none."""
    if name not in METHODS:
        raise InputError(f"there is no method {name}", f"write one of {', '.join(METHODS)}")
    return METHODS[name]

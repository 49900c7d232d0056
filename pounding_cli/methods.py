"""The methods of solution: what each is called, which setting it takes, where it is stable, who published it.

They are stated here alone; the study's schema, `solve`, `pound accuracy`, citations and docs read this list. The code
of a method stands in a file of its own and is imported when a scene is solved: reading a study needs none of it."""

from __future__ import annotations

from dataclasses import dataclass

AUTO = "auto"
"""Name that stands for the cheapest method that keeps the accuracy, scene by scene."""


@dataclass(frozen=True)
class Setting:
    """What a method is told besides the scene.

    Parameters
    ----------
    key : its name in study files, in `solve` and in the columns of results
    title : its name in sentences
    unit : of its values; "" where they are relative [-]
    low, high : range of its values; above `low` where `open_low`
    default : value where none is given; None where one has to be
    example : as people write it
    tried : values that `pound accuracy` tries, coarse to fine
    phrase : how a sentence says a value
    """

    key: str
    title: str
    unit: str
    low: float
    high: float
    default: float | None
    example: str
    tried: tuple[float, ...]
    phrase: str

    def text(self, value: float) -> str:
        """A value with its unit: "0.001 s"."""
        return f"{value:g} {self.unit}".rstrip()

    def said(self, value: float) -> str:
        """A value within a sentence: "a time step of 0.001 s"."""
        return f"{self.phrase} {self.text(value)}"


ACCURACY = Setting(
    "accuracy", "accuracy", "", 1e-14, 0.1, 1e-6, "1e-6", (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10), "accuracy"
)
"""Relative error wanted of the peaks [-]; the method chooses its steps."""

TIME_STEP = Setting(
    "time_step", "time step", "s", 0.0, 3600.0, None, "1e-4 s", (2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5),
    "a time step of",
)  # fmt: skip
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
    stability : largest time step, in words
    contacts : what it does at a contact or a yield, in words
    source : full citation
    code : its `solve.method.Integrator`, or where that stands as "module:name"
    solves : which scenes it runs, in words
    remembers : whether it runs laws whose force depends on events before
    keeps_ledger : whether it fills the energy ledger
    located : whether the ends of a contact or a yield are steps of their own, so that the order holds there too
    """

    name: str
    title: str
    order: int
    setting: Setting
    stability: str
    contacts: str
    source: str
    code: object
    solves: str = "every scene"
    remembers: bool = False
    keeps_ledger: bool = False
    located: bool = False

    @property
    def takes_step(self) -> bool:
        """Whether its setting is a time step."""
        return self.setting is TIME_STEP


_NEWMARK_STABLE = "any where the scene is linear; a contact may leave a step without a root"
_EXPLICIT = "about 2.8 / ω"
_STEPPED_OVER = "steps over it: order 1"
_KUTTA = (
    "Kutta, W. (1901). Beitrag zur naeherungsweisen Integration totaler Differentialgleichungen. Z. Math. Phys. 46."
)

_LIST = (
    Method(
        "taylor", "Taylor with events", 0, ACCURACY, "chooses its steps itself", "locates it to rounding",
        "Jorba, A. & Zou, M. (2005). A software package for the numerical integration of ODEs by means of high-order "
        "Taylor methods. Exp. Math. 14(1).",
        "pounding_cli.solve.taylor:TAYLOR", remembers=True, keeps_ledger=True, located=True,
    ),
    Method(
        "rk4-events", "Runge-Kutta 4 with events", 4, TIME_STEP, _EXPLICIT,
        "locates it on the step's quintic, keeps order 4",
        f"{_KUTTA} Events: Shampine, L. F. & Thompson, S. (2000). Event location for ordinary differential equations. "
        "Comput. Math. Appl. 39(5-6).",
        "pounding_cli.solve.runge_kutta:RUNGE_KUTTA_EVENTS", located=True,
    ),
    Method(
        "rk4", "Runge-Kutta 4", 4, TIME_STEP, _EXPLICIT, _STEPPED_OVER, _KUTTA,
        "pounding_cli.solve.runge_kutta:RUNGE_KUTTA",
    ),
    Method(
        "central-difference", "central difference", 2, TIME_STEP, "2 (√(1 + 4 ξ²) - 2 ξ) / ω", _STEPPED_OVER,
        "Newmark, N. M. (1959), with beta = 0; Bathe, K. J. (1996). Finite Element Procedures, section 9.2.1.",
        "pounding_cli.solve.central_difference:CENTRAL_DIFFERENCE",
    ),
    Method(
        "newmark", "Newmark", 2, TIME_STEP, _NEWMARK_STABLE, _STEPPED_OVER,
        "Newmark, N. M. (1959). A method of computation for structural dynamics. J. Eng. Mech. Div. ASCE 85(3).",
        "pounding_cli.solve.generalized_alpha:NEWMARK",
    ),
    Method(
        "hht-alpha", "HHT-alpha", 2, TIME_STEP, _NEWMARK_STABLE, _STEPPED_OVER,
        "Hilber, H. M., Hughes, T. J. R. & Taylor, R. L. (1977). Improved numerical dissipation for time integration "
        "algorithms in structural dynamics. Earthquake Eng. Struct. Dyn. 5(3).",
        "pounding_cli.solve.generalized_alpha:HHT_ALPHA",
    ),
    Method(
        "generalized-alpha", "generalized-alpha", 2, TIME_STEP, _NEWMARK_STABLE, _STEPPED_OVER,
        "Chung, J. & Hulbert, G. M. (1993). A time integration algorithm for structural dynamics with improved "
        "numerical dissipation: the generalized-alpha method. J. Appl. Mech. 60(2).",
        "pounding_cli.solve.generalized_alpha:GENERALIZED_ALPHA",
    ),
    Method(
        "exponential", "exponential", 0, ACCURACY, "any", "does not meet any",
        "Moler, C. & Van Loan, C. (2003). Nineteen dubious ways to compute the exponential of a matrix, twenty-five "
        "years later. SIAM Review 45(1), methods 1 and 3.",
        "pounding_cli.solve.exponential:EXPONENTIAL", solves="linear scenes: no links or connectors only, no yielding",
        keeps_ledger=True,
    ),
)  # fmt: skip

METHODS: dict[str, Method] = {method.name: method for method in _LIST}
"""The methods by name, as tables list them. Whoever has one of his own adds it here (docs/extending.md)."""


def setting_of(name: str) -> Setting:
    """The setting of a method by its name, of AUTO the accuracy."""
    return ACCURACY if name == AUTO else METHODS[name].setting


def table() -> list[str]:
    """The methods as lines of Markdown: docs/accuracy.md shows them."""
    rows = ["| `method:` | order | setting | time step below | at a contact or a yield | runs |", "|" + "---|" * 6]
    for method in METHODS.values():
        order = str(method.order) if method.order else "follows the accuracy"
        facts = (f"`{method.name}`", order, f"`{method.setting.key}`", method.stability, method.contacts, method.solves)
        rows.append(f"| {' | '.join(facts)} |")
    return rows


def citations() -> list[str]:
    """The sources as lines of Markdown."""
    return [f"- `{method.name}`: {method.source}" for method in METHODS.values()]


if __name__ == "__main__":
    print("\n".join((*table(), "", *citations())))

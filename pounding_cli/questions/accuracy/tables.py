"""The columns of the tables of `pound accuracy`."""

from __future__ import annotations

from pounding_cli.methods import METHODS
from pounding_cli.numbers import Unit
from pounding_cli.questions.frames import PURE_NUMBER
from pounding_cli.tables import Column, Row

ERRORS = {
    "error_V": "storey shear",
    "error_mu": "ductility",
    "error_acceleration": "floor acceleration",
    "error_force": "link force",
}
"""Columns of errors, and what they are errors of."""

_TIME = Unit("ms", 1e-3, "s")


def format_setting(row: Row) -> str:
    """Return the setting of a row's method with its unit: "0.001 s"."""
    return METHODS[row["method"]].setting.text(row["setting"])


def format_counts(row: Row) -> str:
    """Return how many time histories a setting solved, and how many failed."""
    return f"{row['solved']}, {row['failed']} failed" if row["failed"] else f"{row['solved']}"


def _list_error_columns(about: str, is_optional: bool) -> list[Column]:
    return [
        Column(name, f"{about} of the {label}", PURE_NUMBER, label, digits=2, optional=is_optional)
        for name, label in ERRORS.items()
    ]


RUN_COLUMNS = (
    Column("case", "case of the study"),
    Column("analysis", "elastic or inelastic"),
    Column("record", "motion"),
    Column("method", "method of solution"),
    Column("setting", "its accuracy [-] or its time step [s]", write=format_setting),
    Column("status", "done, or how the run ended"),
    Column("seconds", "time in the solver, the least of its repeats", _TIME, "time"),
    Column("seconds_noise", "how well that time repeats", _TIME, "noise of the time"),
    Column("steps", "time steps", PURE_NUMBER, digits=0),
    Column("events", "events located", PURE_NUMBER, digits=0),
    *_list_error_columns("largest relative error", is_optional=False),
    Column("impacts", "impacts of all links", PURE_NUMBER, digits=0),
    Column("impacts_reference", "those of the reference", PURE_NUMBER, "impacts of the reference", digits=0),
    Column(
        "energy_residual", "open part of the energy balance over the input", PURE_NUMBER, "energy left open", digits=2
    ),
    Column("advice", "what to do about a run that did not end"),
)
"""The table `accuracy`: a row a run of a method at a setting on a time history."""

SETTING_COLUMNS = (
    Column("method", "method of solution"),
    Column("setting", "its accuracy or its time step", write=format_setting),
    Column("seconds", "mean time in the solver of the time histories solved", _TIME, "time"),
    Column("error", "largest relative error of all quantities", PURE_NUMBER, digits=2),
    Column("solved", "time histories solved, and those that failed", PURE_NUMBER, write=format_counts),
    Column("miscounted", "time histories whose impact count differs from the reference", PURE_NUMBER, digits=0),
    *_list_error_columns("largest relative error", is_optional=True),
    Column("energy", "largest open part of the energy balance over the input", PURE_NUMBER, "energy left open",
           digits=2, optional=True),
)  # fmt: skip
"""A row a method and setting, over all time histories."""

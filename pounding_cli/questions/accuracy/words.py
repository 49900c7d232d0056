"""The words and tables of `pound accuracy`: the cheapest method for a wanted error, and how far the numbers go."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Iterator
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, cast

import pandas as pd

from pounding_cli.methods import METHODS
from pounding_cli.numbers import count_histories, format_number
from pounding_cli.questions.accuracy.tables import ERRORS, RUN_COLUMNS, SETTING_COLUMNS, format_setting
from pounding_cli.report.references import list_method_sources
from pounding_cli.solver.response import DONE
from pounding_cli.solver.work_precision import REFERENCE, SECOND, WorkPrecision
from pounding_cli.tables import Table, build_table

if TYPE_CHECKING:
    from pounding_cli.questions.accuracy import Measurement

WANTED_ERRORS = (1e-2, 1e-3, 1e-4)
"""Errors for which the cheapest method is named [-]."""

MIN_NOISE = 0.1
"""Part of two times by which they differ at least where one is shorter, however well their repeats agree [-]."""


def list_tables(measurement: Measurement) -> tuple[Table, Table]:
    """Return the table of methods and settings, which a terminal prints, and that of all runs."""
    caption = "Time, and largest relative error, of every method and setting"
    settings = Table("", summarize_settings(measurement.runs), SETTING_COLUMNS, caption)
    return settings, build_table("accuracy", measurement.runs, RUN_COLUMNS, caption="Every run")


def summarize_settings(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row for every method and setting.

    Columns are method and setting; solved, failed and miscounted (numbers of time histories), seconds and seconds_noise
    (means over those solved), the largest of every error, of all errors (`error`), and of the energy residual.

    runs : with the columns of `tables.RUN_COLUMNS`
    """
    is_solved = runs["status"] == DONE
    counted = runs.assign(
        seconds=runs["seconds"].where(is_solved),
        seconds_noise=runs["seconds_noise"].where(is_solved),
        error=runs[list(ERRORS)].max(axis=1),
        solved=is_solved,
        failed=~is_solved,
        miscounted=is_solved & (runs["impacts"] != runs["impacts_reference"]),
        energy=runs["energy_residual"].abs(),
    )
    means = dict.fromkeys(("seconds", "seconds_noise"), "mean")
    largest = dict.fromkeys(("error", *ERRORS, "energy"), "max")
    counts = dict.fromkeys(("solved", "failed", "miscounted"), "sum")
    return counted.groupby(["method", "setting"], sort=False).agg({**means, **largest, **counts}).reset_index()


def find_cheapest(settings: pd.DataFrame, wanted: float, count: int) -> pd.DataFrame:
    """Return of every method the setting that reaches the wanted error at the least cost, the cheapest method first.

    Of settings whose times cannot be told from that of the fastest the most accurate is taken, and of methods likewise;
    methods that do not reach the error on every time history are left out.

    Parameters
    ----------
    settings : as `summarize_settings` has them
    wanted : largest error allowed, in every quantity [-]
    count : number of time histories that a setting must have solved
    """
    good = settings[(settings["solved"] == count) & (settings["error"] <= wanted)]
    best = [_sort_by_cost(of_method).head(1) for _, of_method in good.groupby("method", sort=False)]
    return _sort_by_cost(pd.concat(best) if best else good)


def _sort_by_cost(settings: pd.DataFrame) -> pd.DataFrame:
    """Return settings by time, with those first, by their error, that are as fast as the fastest within the noise."""
    if settings.empty:
        return settings
    by_time = settings.sort_values("seconds")
    fastest = by_time.iloc[0]
    noise = by_time["seconds_noise"].clip(lower=max(fastest["seconds_noise"], MIN_NOISE * fastest["seconds"]))
    are_fastest = by_time["seconds"] - fastest["seconds"] <= noise
    return pd.concat([by_time[are_fastest].sort_values("error", kind="stable"), by_time[~are_fastest]])


def list_sentences(measurement: Measurement) -> list[str]:
    """Return for every wanted error which method is the cheapest, and what the others cost."""
    count = len(measurement.found.references)
    if not count:
        return ["No method can be judged: the reference failed on every time history."]
    settings = summarize_settings(measurement.runs)
    return [describe_cheapest(settings, wanted, count) for wanted in WANTED_ERRORS]


def describe_cheapest(settings: pd.DataFrame, wanted: float, count: int) -> str:
    """Return in a sentence which method reaches a wanted error at the least cost, and what the others cost.

    The parameters are those of `find_cheapest`.
    """
    target = f"For an error of at most {100 * wanted:g} %"
    methods = find_cheapest(settings, wanted, count).to_dict("records")
    if not methods:
        return f"{target}: no setting that was tried reaches it on every time history."
    first, *others = methods
    setting = f"{METHODS[first['method']].setting.title} {format_setting(first)}"
    sentence = f"{target} use {first['method']} with {setting}: {_format_time(first)} per time history."
    if others:
        costs = ", ".join(f"{each['method']} {_format_time(each)} ({format_setting(each)})" for each in others)
        sentence += f" The others: {costs}."
    reached = {each["method"] for each in methods}
    missing = [
        f"{name} down to {_describe_finest(of_method, count)}"
        for name, of_method in settings.groupby("method", sort=False)
        if name not in reached
    ]
    return sentence + (f" Not reached by {', '.join(missing)}." if missing else "")


def _describe_finest(settings: pd.DataFrame, count: int) -> str:
    """Return the finest setting of a method that solved all time histories, of any where none did, with its name.

    The parameters are those of `find_cheapest`, of one method.
    """
    complete = settings[settings["solved"] == count]
    finest = (complete if len(complete) else settings).iloc[-1].to_dict()
    return f"{METHODS[finest['method']].setting.title} {format_setting(finest)}"


def _format_time(setting: Any) -> str:
    return f"{format_number(1e3 * setting['seconds'], 3)} ms"


def list_notes(measurement: Measurement) -> list[str]:
    """Return what the numbers mean, how well the reference is known, and what was left out."""
    found = measurement.found
    return [
        "Errors: relative, largest over storeys, floors or links and over the time histories. Time: mean over the time "
        "histories, each the least of its repeats, without compiling. Miscounted: time histories whose impact count "
        "differs from the reference.",
        "Settings whose times differ by less than their noise (as repeats show it, at least "
        f"{100 * MIN_NOISE:g} %) count as equally fast; of these the most accurate is named.",
        describe_reference(found),
        *(f"Failed: {text}." for text in _iter_failures(measurement.runs)),
        *(f"Left out: {text}." for text in found.left_out),
        f"The runs took {found.spent:.2g} s, compiling before them {found.compiling:.2g} s.",
    ]


def describe_reference(found: WorkPrecision) -> str:
    """Return how well the two reference methods agree."""
    if not found.references:
        return "No time history has a reference."
    both = pd.DataFrame(found.references)
    differences = ", ".join(
        f"{label} {format_number(both[name.removeprefix('error_')].max(), 2)}" for name, label in ERRORS.items()
    )
    differing_count = int((both["impacts"] > 0).sum())
    impacts = "the impact counts agree"
    if differing_count:
        impacts = f"the impact counts differ in {count_histories(differing_count)}"
    return (
        f"Reference: {REFERENCE[0]} at accuracy {REFERENCE[1]:g}. On {count_histories(len(both))} {SECOND[0]} at "
        f"{SECOND[1]:g} differs from it by at most: {differences}; {impacts}."
    )


def _iter_failures(runs: pd.DataFrame) -> Iterator[str]:
    """Yield the runs that did not end, by method, setting and outcome."""
    failed = runs[runs["status"] != DONE].groupby(["method", "setting", "status"], sort=False)["advice"]
    for (method, setting, status), advice in cast("Any", failed):
        text = METHODS[method].setting.text(setting)
        yield f"{method} at {text}: {status} on {count_histories(len(advice))} ({advice.iloc[0]})"


def list_sources(measurement: Measurement) -> list[str]:
    """Return the machine, the command that repeats the measurement, and the publications of the methods."""
    software = ", ".join(f"{name} {version(name)}" for name in ("pounding-cli", "numpy", "scipy", "numba"))
    machine = f"{platform.platform()}, {platform.machine()}, {os.cpu_count()} cores, of which one was used"
    methods = measurement.runs["method"].unique()
    return [
        f"Machine: {machine}. Python {sys.version.split()[0]}, {software}.",
        f"Command: `{measurement.command}`",
        *(line.removeprefix("- ") for line in list_method_sources(methods)),
    ]

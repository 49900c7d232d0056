"""Sensitivity indices in rows that people read: the keys of an output, those that decide most first."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from pounding_cli.numbers import counted
from pounding_cli.report.evidence import Tables
from pounding_cli.store.answers import Answer
from pounding_cli.store.indices import FOUND
from pounding_cli.store.sensitivity import INDICES, PERCENTILES

_HEADS = {
    "sobol": ("key", "first order", "total", "output at its low end", "at its high end"),
    "morris": ("key", "mean effect", "mean, signed", "deviation"),
}


@dataclass(frozen=True)
class Part:
    """One output at one point of the other swept keys, case and analysis.

    rows : of the table of indices, those that decide most first
    words : where it is, "" where there is one place
    """

    output: str
    words: str
    rows: pd.DataFrame

    @property
    def title(self) -> str:
        """The output, and where it is."""
        return f"{self.output}{f', {self.words}' if self.words else ''}"

    @property
    def outcome(self) -> str:
        return str(self.rows["outcome"].iloc[0])

    @property
    def unit(self) -> str:
        return str(self.rows["unit"].iloc[0])


def method_of(answer: Answer) -> str:
    """sobol or morris."""
    return "sobol" if "total" in answer.frame else "morris"


def split_claims(frame: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """A table of indices: the rows about claims of the paper, which rest on all cases, and the others."""
    of_claims = frame["case"] == ""
    return frame[of_claims], frame[~of_claims]


def parts(results: Tables, frame: pd.DataFrame, among: Sequence[str] = ()) -> Iterator[Part]:
    """The outputs of a table of indices, one after the other.

    among : swept keys that tell them apart
    """
    names = [*among, "case", "analysis"]
    told = [name for name in names if name == "case" or len(set(frame[name])) > 1]
    by = "total" if "total" in frame else "mu_star"
    for _, rows in frame.groupby([*names, "output"], sort=False, dropna=False):
        first = rows.iloc[0]
        words = ", ".join(
            f"{name} = {results.units[name].text(first[name])}"
            if name in among
            else f"{'case ' if name == 'case' else ''}{first[name]}"
            for name in told
        )
        yield Part(str(first["output"]), words, rows.sort_values(by, ascending=False, kind="stable"))


def heads(answer: Answer) -> list[str]:
    """Headings of `cells`."""
    return list(_HEADS[method_of(answer)])


def cells(answer: Answer, part: Part) -> list[list[str]]:
    """The keys of an output, with the intervals in brackets."""
    found = []
    for row in part.rows.to_dict("records"):
        if method_of(answer) == "sobol":
            numbers = [
                interval(row, "first", ".2f"),
                interval(row, "total", ".2f"),
                _error(row, "at_low"),
                _error(row, "at_high"),
            ]
        else:
            numbers = [interval(row, "mu_star"), _number(row["mu"]), _number(row["sigma"])]
        found.append([str(row["key"]), *numbers])
    return found


def interval(row: dict[Any, Any], name: str, form: str = ".3g") -> str:
    """A number with its interval."""
    if row[name] != row[name]:
        return "-"
    found, low, high = (_number(row[f"{name}{end}"], form) for end in ("", "_low", "_high"))
    return f"{found} ({low} to {high})"


def _error(row: dict[Any, Any], name: str) -> str:
    if row[name] != row[name]:
        return "-"
    return with_error(row[name], row[f"{name}_error"])


def with_error(value: float, error: float) -> str:
    """A number with as many decimals as its standard error has at two digits: 26.8 ± 1.1."""
    if not (math.isfinite(error) and error > 0):
        return _number(value)
    decimals = 1 - math.floor(math.log10(error))
    if not 0 <= decimals <= 6:
        return f"{_number(value)} ± {_number(error, '.2g')}"
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def _number(value: float, form: str = ".3g") -> str:
    text = f"{value:{form}}"
    return text.removeprefix("-") if float(text) == 0 else text


def sentence(part: Part) -> str:
    """What decides an output."""
    if part.outcome != FOUND:
        return f"{part.title}: {part.outcome}."
    first = part.rows.iloc[0]
    if "total" in part.rows:
        share = f"{100 * first['total']:.0f} % ({100 * first['total_low']:.0f} to {100 * first['total_high']:.0f} %)"
        return (
            f"{part.title}: decided most by {first['key']}; with its interactions it explains {share} of the variance."
        )
    change = f"{interval(dict(first), 'mu_star')} {part.unit}".rstrip()
    return f"{part.title}: changed most by {first['key']}, on the average by {change}."


def spread_sentence(row: dict[Any, Any]) -> str:
    """The distribution of an output."""
    low, _, high = PERCENTILES
    what = f"{row['output']}, case {row['case']}, {row['analysis']}"
    unit = f" {row['unit']}" if row["unit"] else ""
    if row["mean"] != row["mean"]:
        return f"{what}: no distribution, {counted(int(row['failed']), 'sample')} gave no number."
    between = f"{_number(row[f'percentile_{low}'])} to {_number(row[f'percentile_{high}'])}"
    return f"{what}: mean {interval(row, 'mean')}{unit}; {high - low} % of the samples from {between}{unit}."


def notes(results: Tables) -> list[str]:
    """What a reader should know of the indices; of claims more is told by `claim_odds.notes`."""
    answer = results.answer(INDICES)
    said = [] if split_claims(answer.frame)[1].empty else _legend(results, answer)
    refused = answer.frame[answer.frame["failed"] > 0]
    if len(refused):
        most = counted(int(refused["failed"].max()), "sample")
        said.append(
            f"Where samples gave no number (up to {most}) there is no index: leaving them out would bias it. Their "
            "scenes failed again in a second solution with a hundred times finer accuracy, or have no such number."
        )
    return said


def _legend(results: Tables, answer: Answer) -> list[str]:
    """What the columns of `cells` mean."""
    spec = results.resolved.get("sensitivity") or {}
    first = answer.frame.iloc[0]
    said = [
        f"In brackets: {100 * float(spec.get('confidence', 0.95)):.4g} % interval of {spec.get('draws', 1000)} "
        f"bootstrap draws of the {int(first['samples'])} samples."
    ]
    if method_of(answer) == "sobol":
        said.append(
            "First order: part of the variance that the key explains by itself; total: with all its interactions. At "
            "its ends: mean of the output over the lowest and the highest fifth of the key, of a choice at the "
            "options where it is least and most, with the standard error."
        )
    else:
        said.append(
            "Mean effect: mean size of the change of the output over the whole range of the key; a standard deviation "
            "as large as the mean indicates interactions or a nonlinear effect."
        )
    return said

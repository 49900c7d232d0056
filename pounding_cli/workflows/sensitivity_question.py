"""`pound sensitivity`: what a study asks, checked, and its samples."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from pounding_cli.study.expression import Expression, Statement
from pounding_cli.study.file import Problems
from pounding_cli.study.questions import SensitivitySpec
from pounding_cli.study.study import Study
from pounding_cli.study.vary import MOTION, Factor, choice_of, read_uncertain
from pounding_cli.workflows.expressions import expressions, statements
from pounding_cli.workflows.sampled import distinct

SAMPLES = {"sobol": 256, "morris": 32}
"""Base samples unless the study says how many."""

MOST_POINTS = 200_000

_LEAST_LEVELS = 4


@dataclass(frozen=True, eq=False)
class Question:
    """What `pound sensitivity` is asked of a study.

    spec : its section
    factors : the keys that vary, the choice of motion among them
    outputs : the numbers looked at
    statements : what may hold of such numbers, and how likely
    motions : names of the motions
    """

    spec: SensitivitySpec
    factors: tuple[Factor, ...]
    outputs: tuple[Expression, ...]
    statements: tuple[Statement, ...]
    motions: tuple[str, ...]

    @property
    def samples(self) -> int:
        """Base samples."""
        return self.spec.samples or SAMPLES[self.spec.method]

    @property
    def keys(self) -> tuple[Factor, ...]:
        """The factors that are keys of the study."""
        return tuple(factor for factor in self.factors if factor.key != MOTION)

    @property
    def motion(self) -> int | None:
        """The number of the factor that chooses the motions; None where every sample rests on all of them."""
        return next((n for n, factor in enumerate(self.factors) if factor.key == MOTION), None)

    @property
    def takes_one(self) -> bool:
        """Whether every sample rests on one motion."""
        return self.motion is not None and not self.factors[self.motion].options

    @property
    def options(self) -> tuple[int, ...]:
        """How many values each factor chooses from; 0 of a continuous one."""
        return tuple(factor.options or len(self.motions) * (factor.key == MOTION) for factor in self.factors)

    @property
    def levels(self) -> int:
        """Levels of the method of Morris: even, and as many as the longest choice has options."""
        most = max(_LEAST_LEVELS, *self.options)
        return most + most % 2

    @property
    def problem(self) -> dict[str, Any]:
        """The unit cube, as SALib has it."""
        names = [factor.key for factor in self.factors]
        return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}

    @cached_property
    def grid(self) -> np.ndarray:
        """The samples as SALib draws them, shape (samples, factors)."""
        from SALib.sample import morris, sobol  # a second to import

        seed = self.spec.seed
        if self.spec.method == "morris":
            return morris.sample(self.problem, self.samples, num_levels=self.levels, seed=seed)
        return sobol.sample(self.problem, self.samples, calc_second_order=False, seed=seed)

    @cached_property
    def cube(self) -> np.ndarray:
        """The samples in the unit cube, shape (samples, factors).

        Levels of Morris run from 0 to 1, where many distributions have no value: each stands for the middle of an equal
        share of the probability.
        """
        if self.spec.method != "morris":
            return self.grid
        return (np.rint(self.grid * (self.levels - 1)) + 0.5) / self.levels

    @property
    def independent(self) -> np.ndarray:
        """Numbers of the samples of Sobol that are independent of each other, his matrices A and B, shape (2 x base
        samples,); of Morris the first of every trajectory."""
        block = len(self.cube) // self.samples
        begins = np.arange(self.samples) * block
        return np.concatenate([begins, begins + block - 1]) if self.spec.method == "sobol" else begins

    @cached_property
    def distinct(self) -> tuple[np.ndarray, np.ndarray]:
        """The different points that the samples need, shape (points, keys), and of every sample its point."""
        return distinct(self.keys, np.delete(self.cube, [] if self.motion is None else self.motion, axis=1))

    @cached_property
    def drawn(self) -> np.ndarray | None:
        """The motions that every sample rests on, by number, shape (samples, motions of a sample); None: all."""
        if self.motion is None:
            return None
        options = self.options[self.motion]
        sets = np.arange(options)[:, None]
        if not self.takes_one:
            random = np.random.default_rng(self.spec.seed)
            sets = np.sort(random.integers(len(self.motions), size=(options, len(self.motions))), axis=1)
        return sets[choice_of(self.cube[:, self.motion], options)]

    @property
    def motion_labels(self) -> list[str]:
        """Of every sample its motions in words, with a factor where one was drawn more than once."""
        assert self.drawn is not None
        counts = [Counter(self.motions[number] for number in numbers) for numbers in self.drawn]
        return [" + ".join(name if n == 1 else f"{n} {name}" for name, n in each.items()) for each in counts]


def question_of(study: Study) -> Question:
    """What a study asks.

    Raises
    ------
    InputError : no key that varies, no output, or one that is not understood
    """
    spec: SensitivitySpec = study.model.sensitivity
    problems, root = Problems(study.file), study.root
    factors = read_uncertain(root, problems) if root.get("uncertain") is not None else []
    motions = tuple(study.motions(study.base))
    if len(factors) < 2 and not problems.found:
        what = (
            "nothing is uncertain" if not factors else f"'{factors[0].key}' alone is uncertain: it decides everything"
        )
        hint = "write two keys or more, e.g. `uncertain: {impact.restitution: {uniform: {from: 0.4, to: 0.65}}}`"
        problems.at(root, ("uncertain",), what, hint, key=True)
    for factor in factors:
        if factor.key == MOTION and len(motions) < 2:
            problems.add(
                factor.mark, "the study has one motion: there is nothing to choose", "name more under `records:`"
            )
    if study.model.keep is not None:
        what = "histories cannot be kept of samples"
        problems.at(root, ("keep",), what, "remove `keep:`; `pound run` keeps those of chosen points", key=True)
    if spec.claims and study.model.claims is None:
        hint = "write `claims: fig6` or `claims: fig7` at the top of the study: the figure that it reproduces"
        at = ("sensitivity", "claims")
        problems.at(root, at, "the study names no figure whose claims could be judged", hint, key=True)
    named = statements(study, "sensitivity", "probabilities", spec.probabilities, problems)
    is_needed = not spec.claims and not spec.probabilities
    outputs = expressions(study, "sensitivity", "outputs", spec.outputs, problems) if spec.outputs or is_needed else ()
    question = Question(spec, tuple(factors), outputs, named, motions)
    if factors:
        _check_samples(question, root, problems)
    problems.check()
    return question


def _check_samples(question: Question, root: Any, problems: Problems) -> None:
    at, number = ("sensitivity", "samples"), question.samples
    if question.spec.method == "sobol" and number & (number - 1):
        low = 1 << (number.bit_length() - 1)
        what = f"{number} samples: Sobol's sequence is even only at powers of 2"
        problems.at(root, at, what, f"write {low} or {2 * low}")
    points = number * (len(question.factors) + (2 if question.spec.method == "sobol" else 1))
    if points > MOST_POINTS:
        problems.at(root, at, f"{number} samples make {points} points", f"keep it to {MOST_POINTS}: write fewer")

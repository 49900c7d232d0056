"""The commands that answer a question of a study: `pound gap`, `pound fragility`, `pound sensitivity`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli.solving import Solving, output_option, solve_study, solving_options, time_text
from pounding_cli.workflows import TITLES

if TYPE_CHECKING:
    from pounding_cli.api.running import Outcome

_HELP = {
    "gap": """Compute how wide the gap of STUDY must be, so that its buildings do not touch.

    Each building moves alone under every motion. The largest closing of two floors that face each other is the gap
    that this motion requires. The command prints statistics over the motions, the gap for a given probability of
    contact, and the gaps by the rules ABS, SRSS, DDC and those of codes. The section `gap:` of the study selects them;
    the default is mean, largest, 84th percentile and 10 % probability of contact.

    It then says for each case whether its gap is enough, by each rule and for how many motions, and how far each
    building moves to either side, which is its distance to a property line. The buildings move alone: links do not
    change what is required.

    After Ctrl-C, a crash or a full disk, run the same command again to resume.

    \b
    Example:
      pound gap study.yaml
      pound show results/study-gap.h5 gap_cases
      pound show results/study-gap.h5 property_line
      pound report results/study-gap.h5
    """,
    "fragility": """Compute how likely the limits of STUDY are passed over an intensity, for each building alone and
    with pounding.

    The section `fragility:` of the study has the limits (`mu > 4`, `drift > 2 %`, `acceleration > 1 g`,
    `shear_demand > 1`, `contact`, `collapse`), the section `sweep:` the intensities (`records.scale.pga`, `.sa`, `.pgv`
    or `records.scale`). By default each motion is scaled until it passes, and only the intensities needed for this are
    solved. The curves are lognormal, fitted by maximum likelihood, with bootstrap intervals over the motions.

    After Ctrl-C, a crash or a full disk, run the same command again to resume.
    Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

    \b
    Example:
      pound fragility study.yaml
      pound show results/study-fragility.h5 fragility
      pound report results/study-fragility.h5
    """,
    "sensitivity": """Compute how much each uncertain key of STUDY contributes to the variance of its results.

    The section `uncertain:` has the keys with their distributions; `motion: any` varies the motion too. The section
    `sensitivity:` has the outputs, e.g. `outputs: [largest mu in soft]`, or `claims: all` for the probability of the
    paper's statements. Quasi-random samples are solved like a sweep. Sobol indices give the part of the variance that
    each key explains; Morris indices screen many keys at low cost.

    A failed scene is solved again with a hundred times finer accuracy. If it fails again, its outputs get no index.
    After Ctrl-C, a crash or a full disk, run the same command again to resume.
    Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

    \b
    Example:
      pound sensitivity study.yaml
      pound show results/study-sensitivity.h5 sensitivity
      pound report results/study-sensitivity.h5
    """,
}


def _command(name: str) -> click.Command:
    @click.command(name, short_help=TITLES[name], help=_HELP[name])
    @click.argument("study", type=click.Path(path_type=Path))
    @output_option(f"results/<study>-{name}.h5")
    @solving_options
    @click.pass_context
    def command(ctx: click.Context, study: Path, output: Path | None, **options: Any) -> None:
        solve_study(ctx, name, study, output, Solving(**options), print_answer)

    return command


def print_answer(path: Path, outcome: Outcome) -> None:
    """Print what a results file says, and what it took."""
    from pounding_cli.api.studies import open_results
    from pounding_cli.report import report

    report(open_results(path)).print()
    side = f", {outcome.workers} side by side" if outcome.workers > 1 else ""
    click.echo(
        f"Scenes: {outcome.done} solved, {outcome.reused} reused, {outcome.failed} failed{side}; "
        f"solver {time_text(outcome.solver_seconds)}, in all {time_text(outcome.wall_seconds)}\nResults: {outcome.path}"
    )


gap, fragility, sensitivity = map(_command, ("gap", "fragility", "sensitivity"))

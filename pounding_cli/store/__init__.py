"""The results file: one HDF5 file a study, written whole or not at all, read back as tidy tables."""

from __future__ import annotations

from pounding_cli.store.flagged import FlagGroup, flag_groups_of, flagged_scenes
from pounding_cli.store.former import check_results, former_run
from pounding_cli.store.keys import FORMAT, FORMAT_VERSION, solution_key
from pounding_cli.store.locks import locked
from pounding_cli.store.overview import Overview, overview
from pounding_cli.store.parts import PartStore
from pounding_cli.store.results import Results, open_results
from pounding_cli.store.solutions import stored_chunks
from pounding_cli.store.write import Run, is_current, is_finished, write_results

__all__ = [
    "FORMAT",
    "FORMAT_VERSION",
    "FlagGroup",
    "Overview",
    "PartStore",
    "Results",
    "Run",
    "check_results",
    "flag_groups_of",
    "flagged_scenes",
    "former_run",
    "is_current",
    "is_finished",
    "locked",
    "open_results",
    "overview",
    "solution_key",
    "stored_chunks",
    "write_results",
]

"""Figures of a sweep: maps over its two longest axes, or curves where it has one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from matplotlib.figure import Figure

from pounding_cli.errors import InputError, Problem
from pounding_cli.report.axes import SweptAxis, swept_axes
from pounding_cli.report.curves import draw_curves
from pounding_cli.report.evidence import Evidence, Tables, motion_sentence
from pounding_cli.report.figures import RESPONSES, headline, plotted_cases
from pounding_cli.report.maps import draw_maps
from pounding_cli.report.quantity import Choice, OverSweep, Panels, over_sweep, table_of
from pounding_cli.words import counted

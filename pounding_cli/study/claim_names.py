"""Names of the paper's statements about Figs 6 and 7, as studies and tables write them."""

from __future__ import annotations

from collections.abc import Mapping

_BOTH = ("fig6", "fig7")

CLAIMS: Mapping[str, tuple[str, ...]] = {
    "infill-response": _BOTH,
    "infill-accelerations": _BOTH,
    "softer-infill": _BOTH,
    "code-gap": ("fig7",),
    "narrow-gap": ("fig6",),
    "separation": _BOTH,
    "connection-stiffer": _BOTH,
    "connection-other": _BOTH,
    "connection-always": _BOTH,
    "connection-closing": _BOTH,
    "scales": _BOTH,
}
"""Every claim in the order of the report, and the figures that it is about."""


def claims_about(figure: str | None) -> tuple[str, ...]:
    """The claims about a figure, `fig6` or `fig7`; none about None."""
    return tuple(name for name, figures in CLAIMS.items() if figure in figures)

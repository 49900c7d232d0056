"""Figures, tables, claims and the page, from the results file alone."""

"""Quantities of results in words: expressions, comparisons, limits and statements."""

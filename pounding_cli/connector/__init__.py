"""Two connected oscillators in closed form (Figs 4 and 5)."""

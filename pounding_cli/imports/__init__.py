"""Studies from what other programs export: tables of frame models, and pushover curves."""

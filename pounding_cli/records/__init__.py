"""Ground motions: reading, measuring, scaling, synthesizing, the catalogue."""

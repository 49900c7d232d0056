"""What varies: axes of the sweep, ranges, dotted keys, uncertain and searched values."""

"""Running many scenes: engines, one writer, progress."""

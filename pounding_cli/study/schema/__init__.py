"""What may be written: quantities, one model a section, and buildings made whole by `like:` and `archetype:`."""

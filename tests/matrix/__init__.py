"""Every question, from every engine, killed and run again: the same tables."""

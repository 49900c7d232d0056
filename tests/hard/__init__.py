"""Hard scenes: study files that say what they must show, random studies in bulk, and those that once failed."""

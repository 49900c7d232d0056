"""The file: YAML with lines and columns, edits, templates, and what is wrong and where."""

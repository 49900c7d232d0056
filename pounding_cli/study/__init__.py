"""The study file: schema, units, loading with file:line:column errors, expansion into scenes."""

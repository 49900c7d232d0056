"""Functions and classes for scripts, prompts and notebooks; `import pounding_cli` offers it."""

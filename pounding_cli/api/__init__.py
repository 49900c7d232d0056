"""What a person at a prompt or in a notebook uses; `import pounding_cli` offers it."""

# make        sets up and runs the main job: Figs 5 to 8 into results/
# make test   sets up and passes the tests
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.stamp

.PHONY: all setup run test lint lock clean

all: run

setup: $(STAMP)

$(STAMP): requirements/dev.txt pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/dev.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	touch $(STAMP)

run: setup
	$(BIN)/pound run configs/fig6.yaml -o results/fig6.h5
	$(BIN)/pound run configs/fig7.yaml -o results/fig7.h5
	$(BIN)/pound report results/fig6.h5 -o results/fig6
	$(BIN)/pound report results/fig7.h5 -o results/fig7

test: setup lint
	$(BIN)/python -m pytest -n auto

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# Rewrites the locked versions from pyproject.toml (needs uv: pip install uv).
lock:
	uv pip compile --universal --generate-hashes --python-version 3.11 --extra test --extra dev -o requirements/dev.txt pyproject.toml

clean:
	rm -rf results .venv

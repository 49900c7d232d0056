# make        sets up and runs the main job: Figs 5 to 8 into results/
# make test   sets up and passes the tests
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.stamp
PEERS := .venv/.peers
MOTIONS := .venv/.motions
POUND := $(BIN)/pound
# uv installs what is locked, and compiles modules on all cores, in a third of the time of pip, which installs uv. It does
# not read the settings of pip.
UV := $(BIN)/uv pip install --quiet --python $(BIN)/python
export UV_SYSTEM_CERTS := 1
ifdef PIP_INDEX_URL
export UV_DEFAULT_INDEX := $(PIP_INDEX_URL)
endif
PAGES := $(foreach study,fig5 fig6 fig7 fig8,results/$(study)/report.html)

.PHONY: all setup figures studies pages test lint lock docs peers reference processors bench pictures fuzz dist clean

all: figures

setup: $(STAMP)

$(BIN)/uv: requirements/uv.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/uv.txt
	touch $@

$(STAMP): $(BIN)/uv requirements/all.txt pyproject.toml
	$(UV) --compile-bytecode --require-hashes -r requirements/all.txt
	$(UV) --no-deps --no-build-isolation -e .
	$(POUND) schema -o configs/pound.schema.json
	touch $(STAMP)

# `pound` finds out by itself what is missing and leaves a finished file alone, so pages are drawn only when needed; with
# `-q` it does not read a finished file to print its summary again.
figures: studies
	@$(MAKE) --no-print-directory pages
	@echo "Figures and statements: $(PAGES)"

studies: setup
	@mkdir -p results
	@for study in fig6 fig7; do \
	  $(POUND) run configs/$$study.yaml -o results/$$study.h5 $$(test -f results/$$study.h5 && echo -q) || exit $$?; \
	done

pages: $(PAGES)

results/fig5/report.html: configs/fig5.yaml
	$(POUND) connector $< -o results/fig5.h5

results/fig8/report.html: configs/fig8.yaml
	$(POUND) wall $< -o results/fig8.h5

results/%/report.html: results/%.h5
	$(POUND) report $< -o results/$*

# The kernels are compiled while the source is checked.
test: setup
	$(BIN)/python -m tests.warm & warm=$$!; $(MAKE) --no-print-directory lint && wait $$warm
	$(BIN)/python -m pytest -n auto --dist loadgroup

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# Rewrites the locked versions from pyproject.toml.
LOCKED := $(BIN)/uv pip compile --quiet --upgrade --no-deps --generate-hashes --no-annotate --no-header
lock: $(BIN)/uv
	$(BIN)/uv lock --quiet --upgrade
	$(BIN)/uv export --quiet --locked --no-emit-project --no-annotate --no-header --extra test --extra dev --extra docs -o requirements/all.txt
	$(BIN)/uv pip compile --quiet --upgrade --universal --python-version 3.11 --generate-hashes --no-annotate --no-header \
	  --extra motions --constraint requirements/all.txt -o requirements/motions.txt pyproject.toml
	printf 'uv\n' | $(LOCKED) --universal -o requirements/uv.txt -
	printf 'heyoka\nopenseespy==3.7.*\nopenseespylinux==3.7.*\n' | $(LOCKED) --python-version 3.11 \
	  --python-platform x86_64-manylinux_2_28 -o requirements/peers.txt -
	rm uv.lock

# The site, into site/: every warning is an error.
docs: setup
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo "The site: site/index.html"

$(PEERS): $(STAMP) requirements/peers.txt
	$(UV) --require-hashes --no-deps -r requirements/peers.txt
	touch $(PEERS)

# Three pairs by this program and by OpenSees side by side into docs/published.md, then the tests against other
# programs (OpenSeesPy needs Debian's libblas3), and with one that reads its exports.
peers: $(PEERS)
	$(BIN)/python -m tests.peers.side_by_side
	$(PYTHON) -m venv .venv/pelicun
	$(BIN)/uv pip install --quiet --python .venv/pelicun/bin/python pelicun==3.10.0
	PELICUN_PYTHON=$(CURDIR)/.venv/pelicun/bin/python $(BIN)/python -m pytest tests/peers tests/cli/test_pelicun.py

# What it costs, by law, as scenes grow, by method and in OpenSees, into the pages that say so and the README (about
# fifteen minutes on a quiet machine).
bench: $(PEERS)
	$(BIN)/python -m tests.bench

# The pictures of the documentation that show reports (half a minute; needs Chromium).
pictures: setup
	$(BIN)/python -m tests.bench pictures

# The package with the recorded motions of FEMA P695 (70 MB, which `make test` does without).
$(MOTIONS): $(STAMP) requirements/motions.txt
	$(UV) --require-hashes -r requirements/motions.txt
	touch $(MOTIONS)

# The independent integrator's runs once more, into tests/physics/references.npz (five minutes); with CHECK=--check they
# are compared with those kept there instead. Then the documentation, the matrix and the kernel cache with the tests that
# `make test` skips, and the recorded motions of FEMA P695.
reference: $(MOTIONS)
	nice -n 5 $(BIN)/python -m tests.physics.references $(CHECK)
	POUND_NIGHTLY=1 $(BIN)/python -m pytest -n auto --dist loadgroup tests/docs tests/matrix tests/hard/test_kernel_cache.py \
	  tests/cli/test_motion_sets.py tests/cli/test_commands.py tests/cli/test_report.py tests/physics/test_laws.py \
	  tests/physics/test_isolation.py tests/cli/test_report_paper.py tests/cli/test_optimise.py tests/cli/test_check.py \
	  tests/cli/test_fragility_undecided.py tests/cli/test_systems.py tests/browser tests/results/test_views.py

# The physics, hard and golden tests by the arithmetic of other processors: without vectors, with and without fused
# multiply-add, by another kernel of OpenBLAS (half an hour).
processors: setup
	nice -n 5 $(BIN)/python -m tests.hard.processors --tests tests/physics tests/hard tests/golden

# Random studies over the whole schema (about ten minutes; SCENES=2000 for a short run), and a thousand mutations each of
# studies and motions.
SCENES ?= 100000
fuzz: setup
	nice -n 5 $(BIN)/python -m tests.hard.fuzz --scenes $(SCENES)
	nice -n 5 $(BIN)/python -m tests.hard.mutate_input --tries 1000

# Wheel and sdist into dist/, each installed and used away from the source on Python 3.11, 3.12 and 3.13.
dist:
	$(PYTHON) -m tests.release

clean:
	rm -rf results site .venv

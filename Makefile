# Everything runs in .venv, which is made on first use; nothing else is touched.

PYTHON ?= python3
VENV ?= .venv
# A file stays in one process: what takes long is set up once for all its tests.
PYTEST_ARGS ?= -n auto --dist loadfile
LOWEST ?= .venv-lowest
LOWEST_TESTS ?= tests/test_public_names.py tests/cli/test_app.py tests/cli/test_data_commands.py \
	tests/cli/test_rulebase_commands.py tests/io tests/plotting/test_plotting.py \
	tests/plotting/test_surfaces.py tests/fuzzy/test_loading.py tests/fuzzy/test_system.py \
	tests/fuzzy/test_membership.py tests/kernels tests/trackers/test_speed_paths.py \
	tests/studio/test_access.py tests/studio/test_studio_server.py \
	--deselect tests/kernels/test_shared_code.py::test_results_are_those_of_plain_python_to_the_bit
FUZZ_COUNT ?= 1000000
FUZZ_FILES ?= 100000
BENCH_ARGS ?=
ARM_ARGS ?=
PIP_ARGS ?=

BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip -qq --disable-pip-version-check --no-input

export MPLBACKEND ?= Agg

.DEFAULT_GOAL := help
.NOTPARALLEL:
.DELETE_ON_ERROR:
.PHONY: help environment lowest-environment install demo walk test lowest constraints referee lint format docs fuzz bench arm clean distclean

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

# ---------------------------------------------------------------- environment

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(None if sys.version_info >= (3, 11) else "fuzzytrack needs Python 3.11 or newer: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv $(VENV)

# One stamp for the package and one for each extra; all are redone when pyproject.toml changes.
$(VENV)/.installed: pyproject.toml | $(BIN)/python
	$(PIP) install --editable .
	@touch $@

$(VENV)/.installed-%: pyproject.toml | $(BIN)/python
	$(PIP) install --editable '.[$*]'
	@touch $@

.PRECIOUS: $(VENV)/.installed-%

# All extras at once: pip then looks each package up once.
environment: pyproject.toml | $(BIN)/python ## Install what test, lint and docs need
	$(PIP) install $(PIP_ARGS) --editable '.[test,docs,browser]'
	@touch $(VENV)/.installed-test $(VENV)/.installed-docs

lowest-environment: $(LOWEST)/.installed

# ---------------------------------------------------------------- use

install: $(VENV)/.installed ## Set up .venv with fuzzytrack in it

demo: $(VENV)/.installed ## Track a turning target and write pictures and tables to demo/
	$(BIN)/fuzzytrack demo -o demo --force

# ---------------------------------------------------------------- checks

test: $(VENV)/.installed-test ## Run every test, with branch coverage (PYTEST_ARGS= for one process)
	$(BIN)/python -m pytest $(PYTEST_ARGS) --cov --cov-branch --cov-report=term-missing:skip-covered

# Without a file of constraints pip may mix the lowest versions with any others.
$(LOWEST)/.installed: pyproject.toml .ci/lowest.py
	$(PYTHON) -m venv $(LOWEST)
	$(PYTHON) .ci/lowest.py > $(LOWEST)/constraints.txt
	$(LOWEST)/bin/python -m pip -qq --disable-pip-version-check --no-input install $(PIP_ARGS) \
		--constraint $(LOWEST)/constraints.txt --editable '.[parquet,zst,geo,asterix,ais,studio]' pytest hypothesis jsonschema
	@touch $@

# The oldest packages use what newer ones will no longer have; that is not for us to mend. All other
# warnings are errors here too.
lowest: $(LOWEST)/.installed ## Run a short suite with the lowest versions that pyproject.toml allows
	HYPOTHESIS_PROFILE=few $(LOWEST)/bin/python -m pytest -q -p no:cacheprovider -W default::DeprecationWarning $(LOWEST_TESTS)

constraints: $(VENV)/.installed-test $(VENV)/.installed-docs ## Record the versions that are installed, after a green run
	$(BIN)/python -m pip --disable-pip-version-check freeze --exclude-editable > .ci/constraints.txt

# Without what they need for images and tables of their own.
referee: $(VENV)/.installed-test ## Compare engine, filters and metrics with independent programs (pyfuzzylite is GPL, installed for this only)
	$(PIP) install --no-deps pyfuzzylite motmetrics trackeval xmltodict
	$(PIP) install filterpy stonesoup
	$(BIN)/python -m pytest $(PYTEST_ARGS) tests/referee

lint: $(VENV)/.installed-test ## Check style, format and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(VENV)/.installed-test ## Put the code into the one format
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .

docs: $(VENV)/.installed-docs ## Build the documentation into docs/_build/html; a warning is an error
	@rm -rf docs/_build/html
	$(BIN)/python -m sphinx -E -W --keep-going -q -b html docs docs/_build/html
	$(BIN)/python .ci/pages.py docs/_build/html
	@echo "Documentation: docs/_build/html/index.html"

walk: ## Run every command of README and quickstart in a fresh clone, with nothing but PATH
	$(PYTHON) .ci/walk.py

fuzz: $(VENV)/.installed-test ## Try new random examples, FUZZ_COUNT broken rule bases and rows of CSV, FUZZ_FILES files of each other format, scans and messages
	$(BIN)/python tests/fuzz_rulebases.py --count $(FUZZ_COUNT)
	$(BIN)/python tests/fuzz_rulebases.py --count $(FUZZ_FILES) --format fis
	$(BIN)/python tests/fuzz_rulebases.py --count $(FUZZ_FILES) --format fll
	$(BIN)/python tests/round_trips.py
	$(BIN)/python tests/fuzz_readers.py --count $(FUZZ_FILES)
	$(BIN)/python tests/fuzz_files.py --rows $(FUZZ_COUNT)
	$(BIN)/python tests/fuzz_scans.py --scans $(FUZZ_FILES)
	$(BIN)/python tests/fuzz_studio.py --count $(FUZZ_FILES)
	$(BIN)/python tests/fuzz_c99.py --count $(FUZZ_COUNT)
	HYPOTHESIS_PROFILE=free $(BIN)/python -m pytest $(PYTEST_ARGS) -m hypothesis

bench: $(VENV)/.installed-bench ## Measure speed on this machine against peers (BENCH_ARGS=--quick)
	$(BIN)/python -m benchmarks $(BENCH_ARGS)

arm: $(VENV)/.installed ## Run exported C on an emulated ARM Cortex-M4, and print its sizes (ARM_ARGS="-o FILE")
	$(BIN)/python tests/arm/selftests.py $(ARM_ARGS)

# ---------------------------------------------------------------- tidying

clean: ## Remove what was built, but keep .venv
	rm -rf build dist demo docs/_build docs/gallery docs/cli-reference.md docs/scene-settings.md docs/pictures docs/pictures.md docs/api/generated docs/sg_execution_times.rst
	rm -rf .coverage .coverage.* .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find . -path './$(VENV)' -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean ## Remove .venv as well
	rm -rf $(VENV) $(LOWEST)

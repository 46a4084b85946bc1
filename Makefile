# make demo   the drum-brake paper of 2011 from nothing: environment, install, study, and where its page is
# make test   lint, import floors, types and tests
# make fuzz   random systems against a slow integrator, for an hour; FUZZ=100 for fewer
# make docs   the documentation, into docs/_build/html
# make bench  the benchmarks
# make format, make picture, make clean: tidy the code, draw the README's pictures, remove what was made
#
# Python 3.11 or newer and make are all that is assumed; uv is used when it is there, because it installs faster.
# Another interpreter: make demo PYTHON=python3.12

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
OUT    ?= out/drum-brake-2011
WORKERS ?= 2
FUZZ   ?= 10000
UV     ?= $(shell uv --version >/dev/null 2>&1 && echo uv)

ifneq ($(UV),)
CREATE  = $(UV) venv --quiet --allow-existing --python $(PYTHON) $(VENV)
INSTALL = VIRTUAL_ENV=$(VENV) $(UV) pip install --quiet
else
CREATE  = $(PYTHON) -m venv $(VENV)
INSTALL = $(BIN)/python -m pip install --quiet --disable-pip-version-check
endif

# Tests start some hundred processes: each would translate the sources anew where no compiled modules may be kept.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help demo test lint floors types tests browser fuzz format docs picture bench fortran clean
.DEFAULT_GOAL := help

help:
	@sed -n '1,9s/^# \{0,1\}//p' Makefile

demo: $(VENV)/.installed
	$(BIN)/squealbox paper drum-brake-2011 --out $(OUT)

# Types are looked at beside the tests, which wait for files and browsers now and then.
test: lint floors
	$(MAKE) --no-print-directory --jobs=2 types tests

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check

floors: $(VENV)/.installed-dev
	$(BIN)/lint-imports

types: $(VENV)/.installed-dev
	$(BIN)/mypy

tests: $(VENV)/.installed-dev browser
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal

browser:
	@.ci/browser

fuzz: $(VENV)/.installed-dev
	SQUEALBOX_FUZZ=$(FUZZ) $(BIN)/python -m pytest -q -n $(WORKERS) tests/properties/test_physics_fuzz.py

format: $(VENV)/.installed-dev
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

docs: $(VENV)/.installed-docs
	$(BIN)/python -m sphinx --fail-on-warning -b html docs docs/_build/html
	@echo "The documentation is at $(abspath docs/_build/html)/index.html"

picture: $(VENV)/.installed-dev
	$(BIN)/python docs/images/draw.py
	$(BIN)/python docs/images/workbench.py

bench: fortran $(VENV)/.installed-bench
	@for each in benchmarks/*.py; do echo "== $$each"; $(BIN)/python $$each || exit 1; done

fortran:
	@command -v gfortran >/dev/null || { echo "one of the rivals, numbalsoda, is built here with a Fortran compiler: apt install gfortran"; exit 1; }

# One stamp for each set of extras; pip and uv run again only after pyproject.toml changed.
$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("squealbox needs Python 3.11 or newer, and $(PYTHON) is " + sys.version.split()[0] + ": try make PYTHON=python3.12")'
	$(CREATE)

$(VENV)/.installed: pyproject.toml | $(BIN)/python
	$(INSTALL) --editable '.[workbench]'
	@touch $@

$(VENV)/.installed-%: pyproject.toml | $(BIN)/python
	$(INSTALL) --editable '.[$*]'
	@touch $@ $(VENV)/.installed

clean:
	rm -rf docs/_build out .pytest_cache .mypy_cache .ruff_cache .import_linter_cache

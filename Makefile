# make            set up, reproduce every figure, write results/report.html
# make test       set up, run all tests (a small copy of the whole workflow among them)
# make check-all  the linters, the tests, 2500 new random scenes for each property of the engines, and what takes long
# make smoke      all figures, small
# make docs       public names, and a page for each family of figures: results/docs/index.html
# make benchmark  how fast the engines are on this machine, with nothing else running: results/tables/performance.csv
# make coverage   which lines of src/gaspart the tests run (at least 95 %); compiles all kernels anew
# make lint | report | clean | distclean
#
# Needs Python 3.11 or later with venv and pip, and make. Everything else is installed into .venv.

SHELL := /bin/bash
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all
.PHONY: all setup test check-all smoke benchmark coverage lint report docs clean distclean

PYTHON ?= $(shell command -v python3.11 || command -v python3)
CORES ?= all
PIP = .venv/bin/python -m pip --quiet --disable-pip-version-check
SNAKEMAKE = .venv/bin/python -m snakemake --cores $(CORES)

all: setup
	$(SNAKEMAKE) --quiet rules
	@echo "done: results/report.html"

setup: .venv/gaspart.stamp

.venv/environment.stamp: environment.txt
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "gaspart needs Python 3.11 or later: make PYTHON=/path/to/python3.11" >&2; exit 2; }
	"$(PYTHON)" -m venv --clear .venv
	$(PIP) install --require-hashes --requirement environment.txt
	@touch $@

# Nothing unlocked gets in: no dependencies, no build tools from the network.
.venv/gaspart.stamp: .venv/environment.stamp pyproject.toml
	$(PIP) install --no-deps --no-build-isolation --editable .
	@touch $@

test: setup
	.venv/bin/python -m pytest --numprocesses=auto

check-all: lint test
	.venv/bin/python -m pytest --numprocesses=auto -m hypothesis --hypothesis-profile=search
	.venv/bin/python -m pytest -m thorough

smoke: setup
	$(SNAKEMAKE) --quiet rules --configfile config/smoke.yaml

benchmark: setup
	mkdir -p results/benchmarks
	.venv/bin/python -m pytest benchmarks --numprocesses=0 --benchmark-json=results/benchmarks/performance.json
	.venv/bin/python benchmarks/table.py results/benchmarks/performance.json \
		results/tables/performance.csv results/figures/performance.png

# The workflow's tests run copies of the project, and what they run has tests of its own.
coverage: export GASPART_CACHE = $(CURDIR)/results/coverage/kernels
coverage: export COVERAGE_FILE = $(CURDIR)/results/coverage/data
coverage: setup
	rm -rf results/coverage
	.venv/bin/python -m pytest --numprocesses=auto --ignore=tests/workflow --cov --cov-report=term \
		--cov-report=html:results/coverage/html --cov-fail-under=95

lint: setup
	.venv/bin/python -m ruff check .
	.venv/bin/python -m ruff format --check .
	.venv/bin/python -m mypy
	.venv/bin/python -m snakefmt --check Snakefile workflow
	.venv/bin/python -m snakemake --lint

report: setup
	$(SNAKEMAKE) report --quiet rules

docs: setup
	.venv/bin/python docs/build.py results/docs

clean:
	rm -rf results .snakemake

distclean: clean
	rm -rf .venv .pytest_cache .ruff_cache .mypy_cache .hypothesis src/*.egg-info

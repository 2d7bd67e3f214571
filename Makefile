# make            set up, reproduce every figure, write results/report.html, print the verdicts; EFFORT=1 continues all
#                 runs to four times their length; FROM=archive.zip measures the points of a deposit instead
# make decide     continue exactly the runs behind claims that are open; says first which and how long
# make first      set up, three figures of the sources: results/first.html, in some two minutes
# make test       set up, run the tests that catch most per second; OPTIONS=... are options of pytest
# make test-all   all tests: the whole workflow, small, with its digests, all kernels, 2500 new random scenes each, Slurm
# make digests    the simulations of the whole workflow, small, compared bit for bit with tests/workflow/digests.json
# make precise    all figures from longer runs: results/precise/report.html
# make smoke      all figures, small: results/smoke/report.html
# make docs       the documentation site, with executed notebooks: results/docs/html/index.html; after a complete
#                 reproduction also docs/gallery.png, the picture of the README
# make wheel      dist/gaspart-...whl, for this version of Python, with compiled kernels for the scenes of `gaspart new`
# make archive    all figures, and archive.zip, the file to deposit
# make benchmark  the speed of the engines on this machine, which should run nothing else: results/tables/performance.csv
# make referees   gaspart's runs judged by programs of others, which have an environment of their own, .venv-referees:
#                 docs/referees.csv, a page of the site; 15 minutes on two cores
# make coverage   which lines of src/gaspart the tests run (at least 95 %); compiles all kernels anew
# make lint | report | develop (install what tests, linters and documentation need) | clean | distclean
#
# Needs Python 3.11 or later with venv and pip, and make. Everything else is installed into .venv and
# .venv-referees, which make replaces or removes only if it has made them.

SHELL := /bin/bash
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all
.PHONY: all decide first setup develop test test-all digests precise smoke wheel archive benchmark referees coverage lint report docs clean distclean

PYTHON ?= $(shell command -v python3.11 || command -v python3)
CORES ?= all
QUIETLY = -m pip --quiet --disable-pip-version-check
PIP = .venv/bin/python $(QUIETLY)
SNAKEMAKE = .venv/bin/python -m snakemake --logger gaspart --cores $(CORES) $(if $(EFFORT),--config effort=$(EFFORT))
# Printed after Snakemake has ended, also if there was nothing to do.
VERDICTS = @.venv/bin/python -c 'import sys; from gaspart.reproduction.claims import summary; print(summary(sys.argv[1]))'

# An environment that somebody else has made may hold what exists nowhere else.
own = @test ! -e $(1) -o -e $(1)/made_by_make -o -e $(1)/environment.stamp || { echo \
	"make: $(1) exists and was not made by make, which would replace it; move it away" >&2; exit 2; }

START = .venv/bin/python -c 'import sys; from gaspart.reproduction.start import start; sys.exit(start(*sys.argv[1:]))'

all: setup
	$(if $(FROM),@$(START) $(FROM) config/config.yaml)
	$(SNAKEMAKE) --quiet rules
	$(VERDICTS) results/tables/claims.csv
	@echo "report: results/report.html"

# Doubles the effort of what open claims depend on until each is decided, or has an effort of 4. What an interrupted
# run was to make comes first: `--next` doubles efforts that are written, made or not.
decide: setup
	$(SNAKEMAKE) --quiet rules
	@while .venv/bin/python -m gaspart budget config/config.yaml --next; \
		do $(SNAKEMAKE) --quiet rules || exit; done
	$(VERDICTS) results/tables/claims.csv

first: setup
	@echo "three figures of the sources, some two minutes on two cores; make and make test take longer"
	$(SNAKEMAKE) --quiet rules -- first
	$(VERDICTS) results/tables/first.csv
	@echo "report: results/first.html"

setup: .venv/gaspart.stamp

develop: setup .venv/environment-dev.stamp

# Packages are installed without bytecode (see below). Where this is set, each of some hundred processes would compile
# anew what it imports, which takes two seconds.
unexport PYTHONDONTWRITEBYTECODE

# All packages are listed with their dependencies. If pip looked for these again, it would refuse a release newer than
# the one listed.
# Nothing is compiled to bytecode, which takes a minute: Python does so with what it imports, a small part of all.
.venv/environment.stamp: environment.txt
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "gaspart needs Python 3.11 or later: make PYTHON=/path/to/python3.11" >&2; exit 2; }
	$(call own,.venv)
	"$(PYTHON)" -m venv --clear .venv
	@touch .venv/made_by_make
	$(PIP) install --no-deps --no-compile --require-hashes --requirement environment.txt
	@touch $@

# What tests, linters, documentation and releases need besides.
.venv/environment-dev.stamp: environment-dev.txt .venv/environment.stamp
	$(PIP) install --no-deps --no-compile --require-hashes --requirement environment-dev.txt
	@touch $@

# Only locked packages are installed: neither dependencies nor build tools come from the network here.
.venv/gaspart.stamp: .venv/environment.stamp pyproject.toml
	$(PIP) install --no-deps --no-build-isolation --editable .
	@touch $@

# A test that waits for ever fails by its name, and the others go on. Slow tests and searches have no such limit.
# Tests of few particles run their kernels as plain Python first: to compile each would take longer.
TEST = .venv/bin/python -m pytest --numprocesses=auto --timeout=1500 --timeout-method=signal
INTERPRETED = $(shell grep -rl mark.interpreted tests --include='test_*.py')
test: develop
	NUMBA_DISABLE_JIT=1 $(TEST) -m interpreted --hypothesis-profile=few $(INTERPRETED) $(OPTIONS)
	PYTHONPATH=tests .venv/bin/python -W ignore -m battery.compile_kernels
	$(TEST) --canonical -m "not thorough and not interpreted" $(OPTIONS)

test-all: develop
	.venv/bin/python -m pytest --numprocesses=auto -m "" --hypothesis-profile=search $(OPTIONS)

digests: setup
	$(SNAKEMAKE) --quiet rules --configfile config/smoke.yaml --until simulate
	.venv/bin/python tests/workflow/digests.py results/smoke/points

precise: setup
	$(SNAKEMAKE) --quiet rules --configfile config/precise.yaml
	$(VERDICTS) results/precise/tables/claims.csv
	@echo "report: results/precise/report.html"

smoke: setup
	$(SNAKEMAKE) --quiet rules --configfile config/smoke.yaml
	$(VERDICTS) results/smoke/tables/claims.csv
	@echo "report: results/smoke/report.html"

wheel: develop
	.venv/bin/python release/ship_kernels.py dist

archive: all
	.venv/bin/python -m gaspart archive results -o archive.zip --force

benchmark: develop
	mkdir -p results/benchmarks
	.venv/bin/python -m pytest benchmarks --numprocesses=0 --benchmark-json=results/benchmarks/performance.json
	.venv/bin/python benchmarks/table.py results/benchmarks/performance.json \
		results/tables/performance.csv results/figures/performance.png

# The referees have packages of their own, and what they judge are files: gaspart is not installed there.
.venv-referees/environment.stamp: tests/referees/environment.txt
	$(call own,.venv-referees)
	"$(PYTHON)" -m venv --clear .venv-referees
	@touch .venv-referees/made_by_make
	.venv-referees/bin/python $(QUIETLY) install --no-deps --no-compile --require-hashes --requirement $<
	@touch $@

referees: develop .venv-referees/environment.stamp
	.venv/bin/python tests/referees/runs.py results/referees
	.venv-referees/bin/python -m pytest -c tests/referees/pytest.ini tests/referees $(OPTIONS)

# Without the tests of the workflow: they run copies of the project, and the functions they call have their own tests.
coverage: export GASPART_CACHE = $(CURDIR)/results/coverage/kernels
coverage: export COVERAGE_FILE = $(CURDIR)/results/coverage/data
coverage: develop
	rm -rf results/coverage
	.venv/bin/python -m pytest --numprocesses=auto -m "" --ignore=tests/workflow --cov --cov-report=term \
		--cov-report=html:results/coverage/html --cov-fail-under=95

lint: develop
	.venv/bin/python -m ruff check .
	.venv/bin/python -m ruff format --check .
	.venv/bin/python -m mypy
	.venv/bin/lint-imports --no-cache
	.venv/bin/python -m snakefmt --check Snakefile workflow
	.venv/bin/python -m snakemake --lint

report: setup
	$(SNAKEMAKE) report --quiet rules

# Tables of the tests for pages of the site: a few minutes each, made anew when the library or these tests have changed.
MEASURED = $(shell find src/gaspart/analysis src/gaspart/engines src/gaspart/kernels src/gaspart/scene -name '*.py')
results/docs/symmetries.csv: $(MEASURED) $(wildcard tests/battery/*.py) | develop
	PYTHONPATH=tests .venv/bin/python -m battery.table

results/docs/exact_values.csv: $(MEASURED) $(wildcard tests/exact/*) | develop
	PYTHONPATH=tests .venv/bin/python -m exact.table

# Pages on which gases run, of the templates that share five kinds of kernels, in some two minutes.
RUNNING = $(addprefix results/docs/extra/play/,$(addsuffix .html,gas heat cooling rough melting atmosphere shock piston))
$(RUNNING): results/docs/extra/play/%.html: $(wildcard src/gaspart/rendering/*) $(MEASURED) | develop
	mkdir -p $(@D)
	.venv/bin/gaspart play --template $* -o $@ --force

docs: develop results/docs/symmetries.csv results/docs/exact_values.csv $(RUNNING)
	.venv/bin/python docs/gallery.py results docs/gallery.png
	.venv/bin/python -m sphinx --quiet --fail-on-warning --jobs auto docs results/docs/html
	@echo "documentation: results/docs/html/index.html"

clean:
	rm -rf .snakemake $(filter-out results/README.md,$(wildcard results/*))

distclean: clean
	$(call own,.venv)
	$(call own,.venv-referees)
	rm -rf .venv .venv-referees .pytest_cache .ruff_cache .mypy_cache .hypothesis src/*.egg-info

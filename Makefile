# `make` sets everything up and reproduces Table 2; `make test` runs the tests. README.md tells more.
.DEFAULT_GOAL := reproduce

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
SWEEPS := orientations resolutions paths trimming motions bonding
EXTRAS := notebooks,exact,cluster,site,bench,test
WANTED := --constraint constraints.txt --editable ".[$(EXTRAS)]"

# Without a display the window must come from EGL, or VTK crashes at the first picture.
ifeq ($(shell uname -s)$(DISPLAY),Linux)
export VTK_DEFAULT_OPENGL_WINDOW ?= vtkEGLRenderWindow
endif

# Where nothing compiled may be kept, each start of Python takes several times as long.
unexport PYTHONDONTWRITEBYTECODE

reproduce: $(STAMP)  ## Table 2 of the paper: results/table2.csv, .md, .tex
	$(BIN)/lineup table2

test: $(STAMP)  ## The default tests (then the others: .venv/bin/pytest -m slow, or -m notebook)
	$(BIN)/python -m pytest -n 2 --dist worksteal -q

lint: $(STAMP)  ## Style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy --strict lineup

lab: $(STAMP)  ## JupyterLab on the first notebook
	$(BIN)/jupyter lab notebooks/00_overview.ipynb

notebooks: $(STAMP)  ## Execute every notebook again from its .py half
	$(BIN)/jupytext --quiet --to ipynb --update --set-formats ipynb,py:percent --set-kernel python3 notebooks/*.py
	env -u LINEUP_MODELS $(BIN)/jupyter nbconvert --log-level WARN --to notebook --inplace --execute \
	  --ExecutePreprocessor.record_timing=False --ExecutePreprocessor.store_widget_state=False \
	  notebooks/*.ipynb
	sed -i.bak '/"application\/vnd.jupyter.widget-view+json": {/,/},/d' notebooks/*.ipynb
	rm notebooks/*.ipynb.bak

bench: $(STAMP)  ## Each stage beside other tools, and how its time grows: results/benchmarks.md, stages.md
	$(BIN)/python benchmarks/ratios.py
	$(BIN)/python benchmarks/stages.py

mutants: $(STAMP)  ## Faults planted all over the core, and whether the tests find them: results/mutants.md
	$(BIN)/python tests/mutants.py

site: $(STAMP)  ## The documentation: site/html/docs/index.html
	$(BIN)/sphinx-build --quiet --fail-on-warning --keep-going -c docs . site/html

# Without meshes from outside, so that everyone has the same solids.
experiments: $(STAMP)  ## Every sweep again, and its committed tables: experiments/results/sweeps/
	set -e; for name in $(SWEEPS); do env -u LINEUP_MODELS LINEUP_CACHE=results/none \
	  $(BIN)/lineup sweep experiments/$$name.yaml --out experiments/results/sweeps; done

setup: $(STAMP)  ## The virtual environment alone

clean:  ## Remove results and caches; the virtual environment stays
	rm -rf results out site experiments/results/sweeps/*/ .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find lineup tests -name __pycache__ -prune -exec rm -rf {} +

help:  ## This list
	@sed -nE 's/^([a-z]+):.*## (.*)/make \1	\2/p' $(MAKEFILE_LIST)

# uv installs several times faster than pip; without it pip does the same.
$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 14))' || { \
	  echo "LineUp needs Python 3.11 to 3.13, and '$(PYTHON)' is not: name one with 'make PYTHON=python3.12'" >&2; exit 1; }
	@echo "setting up $(VENV), once and for some minutes"
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --constraint constraints.txt uv || echo "no uv, going on with pip"
	@{ test -x $(BIN)/uv && $(BIN)/uv pip install --quiet --python $(BIN)/python $(WANTED); } \
	  || $(BIN)/python -m pip install --quiet $(WANTED)
	@echo "compiling the kernels, once"
	@$(BIN)/python -c 'import lineup as lu; lu.lineup(["duck"], blocks=40)'
	@touch $@

.PHONY: reproduce test lint lab notebooks bench mutants experiments site setup clean help

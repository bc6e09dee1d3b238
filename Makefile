# make demo     the main job on a fresh clone: needs python3 (3.11 or later) and make only
# make test     everything installed, the quick tests
# make lint     ruff, import-linter, mypy
# make evidence every number that README and docs show, computed again
# make reports-cheap  the reports of a few seconds, computed again: does each row hold as it did when the report was made?
# make mutants  deliberate faults of one line, and whether the tests catch them: half an hour

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
SCENE  ?= examples/b7206.toml

# Together half a minute of one core with kernels compiled.
CHEAP := depth expected_values orders tangent verify

# What a bare Debian lacks for gmsh (linked), pyvista (opened at run time, without a display), the tests of pages (a browser)
# and of the .inp files (CalculiX).
APT_PACKAGES := calculix-ccx chromium chromium-driver fonts-dejavu-core libegl1 libfontconfig1 libgl1 libglu1-mesa libgomp1 libxcursor1 libxext6 libxfixes3 libxft2 libxinerama1 libxrender1
APT_LINE     := apt-get install -y --no-install-recommends $(APT_PACKAGES)

.PHONY: demo test lint evidence reports-cheap mutants system-libraries apt-line clean

demo: $(VENV)/.base
	$(BIN)/raceway run $(SCENE)

test: $(VENV)/.all system-libraries
	$(BIN)/python -m pytest -n 2 -q

lint: $(VENV)/.all
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(BIN)/mypy

evidence: $(VENV)/.all
	$(BIN)/python -m benchmarks.evidence

reports-cheap: $(VENV)/.all
	$(BIN)/python -m benchmarks.evidence --check $(CHEAP)

mutants: $(VENV)/.all
	$(BIN)/python -m benchmarks.mutants

# The package is installed in place, so only a change of pyproject.toml installs anything again.
$(VENV)/.python:
	$(PYTHON) -c 'import sys; sys.exit("Raceway needs Python 3.11 or later, this is " + sys.version.split()[0] + ": make PYTHON=python3.12 ..." if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/.base: $(VENV)/.python pyproject.toml
	$(BIN)/python -m pip install -q -e .
	touch $@

$(VENV)/.all: $(VENV)/.python pyproject.toml
	$(BIN)/python -m pip install -q -e '.[all]'
	touch $@ $(VENV)/.base

# Prints the one line that a bare Debian needs; loads both libraries, draws without a display, opens a page in the browser.
system-libraries: $(VENV)/.all
	@echo "what a bare Debian needs for gmsh, pyvista and the tests of pages and .inp files, as root: $(APT_LINE)"
	@$(BIN)/python -c 'import gmsh, pyvista; pyvista.Plotter(off_screen=True).show(auto_close=True)' >/dev/null 2>$(VENV)/.libraries.log \
	  && echo "gmsh and pyvista: system libraries present" \
	  || { cat $(VENV)/.libraries.log; echo "gmsh or pyvista lacks system libraries: run the line above"; exit 1; }
	@$(BIN)/python -c 'from validation.browser.chromium import Browser; Browser().close()' 2>$(VENV)/.browser.log \
	  && echo "chromium and chromedriver: present" \
	  || { tail -n 1 $(VENV)/.browser.log; echo "no browser for the tests of pages: run the line above"; exit 1; }
	@command -v ccx >/dev/null && echo "ccx (CalculiX): present" \
	  || { echo "no ccx (CalculiX) for the tests of .inp files: run the line above"; exit 1; }

apt-line:
	@echo $(APT_LINE)

clean:
	rm -rf $(VENV) raceway-out build dist

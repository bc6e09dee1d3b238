PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
SCENE  ?= examples/b7206.toml
PACKAGES := $(wildcard ./packages/*)
# Byte code is written by the first import: most of what is installed is never imported.
unexport PYTHONDONTWRITEBYTECODE
INSTALL = $(BIN)/python -m pip install -q --no-compile -c constraints.txt

# What a bare Debian lacks for gmsh (linked), pyvista (opened at run time, without a display), the tests of pages (a browser)
# and of the .inp files (CalculiX).  Without them these tests are skipped; with CI=true or RACEWAY_TEST_ALL=1 they fail.
APT_PACKAGES := calculix-ccx chromium chromium-driver fonts-dejavu-core libegl1 libfontconfig1 libgl1 libglu1-mesa libgomp1 libxcursor1 libxext6 libxfixes3 libxft2 libxinerama1 libxrender1
APT_LINE     := apt-get install -y --no-install-recommends $(APT_PACKAGES)

.PHONY: help demo test test-all lint docs ross gpu wheel evidence mutants constraints apt-line clean

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/make \1 :\2/p' Makefile | while IFS=: read -r name words; do printf '%-20s%s\n' "$$name" "$$words"; done

demo: $(VENV)/.base ## the main job on a fresh clone: needs python3 (3.11 or later), venv and make only
	$(BIN)/raceway run $(SCENE)

test: $(VENV)/.all ## everything installed, the quick tests: some minutes
	$(BIN)/python -m pytest -n 2 --dist worksteal -q -m "not slow and not docs and not night and not release and not ross"

test-all: $(VENV)/.all ## the long proofs too
	$(BIN)/python -m pytest -n 2 --dist worksteal -q -m "not release and not ross"

lint: $(VENV)/.all ## ruff, import-linter, mypy, measures of structure
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(BIN)/mypy
	$(BIN)/python -m checks.structure --gate

docs: $(VENV)-docs/.installed ## the site in docs/_build/html, its tutorials and gallery run; in an environment of its own, which has ROSS
	rm -rf docs/api/generated docs/gallery docs/_build
	$(VENV)-docs/bin/sphinx-build -W --keep-going -E -q -b html docs docs/_build/html
	$(VENV)-docs/bin/python -m pytest -q docs/test_site.py
	$(VENV)-docs/bin/python -m pytest -q -m "docs and not slow" tests/test_documents.py
	@echo "open docs/_build/html/index.html"

ross: $(VENV)-docs/.installed ## the tests under the rotor program ROSS
	$(VENV)-docs/bin/python -m pytest -q -m ross packages/raceway-rotor/tests/test_ross_inside.py packages/raceway-rotor/tests/test_against_ross.py

gpu: $(VENV)/.all ## explicit steps on a CUDA device, checked and timed; without one their kernels run as Python, some minutes
	$(BIN)/python -m checks.device --turn

wheel: $(VENV)/.all ## a wheel in dist with compiled kernels, installed into an empty environment without extras, which runs a scene
	rm -rf dist build && mkdir -p build/source
	tar -c --exclude=__pycache__ raceway README.md LICENSE pyproject.toml | tar -x -C build/source
	$(BIN)/python -m checks.kernels build/source/raceway/data/kernels
	$(BIN)/python -m build --wheel --no-isolation --outdir dist build/source
	$(PYTHON) -m venv build/wheel
	build/wheel/bin/python -m pip install -q -c constraints.txt dist/*.whl
	cd build/wheel && bin/raceway run $(CURDIR)/examples/minimal.toml -v --out out

evidence: $(VENV)/.all ## the numbers that README and docs show, computed again at the commit that is checked out: hours
	$(BIN)/python -m checks.night

mutants: $(VENV)/.all ## deliberate faults of one line, and whether the tests catch them: half an hour
	$(BIN)/python -m checks.mutants

# The package is installed in place, so only a change of pyproject.toml installs anything again.
$(VENV)/.python:
	$(PYTHON) -c 'import sys; sys.exit("Raceway needs Python 3.11 or later, this is " + sys.version.split()[0] + ": make PYTHON=python3.12 ..." if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/.base: $(VENV)/.python pyproject.toml constraints.txt
	@echo "installing into $(VENV): half a minute or more, 0.1 GB to download, 0.5 GB on disk"
	$(INSTALL) -e .
	touch $@

$(VENV)/.all: $(VENV)/.python pyproject.toml constraints.txt $(wildcard packages/*/pyproject.toml)
	@echo "installing with all packages into $(VENV): two minutes or more, 1.6 GB"
	$(INSTALL) hatchling editables
	$(INSTALL) --no-build-isolation -e '.[pictures,sweep,elastic,dev]' $(addprefix -e ,$(PACKAGES))
	touch $@ $(VENV)/.base

$(VENV)-docs/.installed: $(VENV)/.python pyproject.toml constraints.txt $(wildcard packages/*/pyproject.toml)
	@echo "installing Sphinx and ROSS into $(VENV)-docs: some minutes, 2.1 GB, most of it what ROSS needs"
	$(PYTHON) -m venv $(VENV)-docs
	$(VENV)-docs/bin/python -m pip install -q --no-compile -c constraints.txt -e '.[pictures,sweep,docs]' $(addprefix -e ,$(PACKAGES)) -e './packages/raceway-rotor[ross]' pytest
	touch $@

constraints: $(VENV)/.python ## constraints.txt, kept where pyproject.toml allows; UPGRADE=--upgrade takes the newest versions
	$(BIN)/python -m pip install -q uv
	printf '%s\n' '.[pictures,sweep,elastic,gpu,dev,docs]' $(PACKAGES) | $(BIN)/uv pip compile -q $(UPGRADE) --universal --python-version 3.11 --no-annotate --custom-compile-command 'make constraints' - | grep -v '^\./\|^\.\[' > constraints.new
	mv constraints.new constraints.txt

apt-line: ## what installs the system libraries that some tests need, as root on Debian
	@echo $(APT_LINE)

clean: ## without environment and outputs
	rm -rf $(VENV) $(VENV)-docs raceway-out build dist docs/_build docs/api/generated docs/gallery

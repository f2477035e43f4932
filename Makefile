# Every target makes its own environment; nothing but Python 3.11 or newer, its venv module and make is needed.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RIVAL := .venv-surfalize
CF := .venv-cf
LOWEST := .venv-lowest
INSTALL := $(BIN)/uv pip install --quiet --compile-bytecode --python $(BIN)/python
RUN := OPENBLAS_NUM_THREADS=1 MPLBACKEND=Agg
# tests start the program some 200 times and import 400 files in each process, which is faster from byte code, also where
# none is to be kept; a process that has run its half takes from the end of the other, so that neighbours share results
TEST := $(RUN) PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n 2 --dist worksteal
OUT := out
SCRIPTS := 'src/sonolube/browser/static/{link,scripts/**/*}.js'
NPX = npx --yes --prefer-offline --package $(filter $(1)@%,$(shell cat requirements/node.txt)) --
# surfalize (GPL) is run as a program of its own, by the tests and benchmarks that compare with it, where `make surfalize` has put it
export SURFALIZE_PYTHON ?= $(abspath $(wildcard $(RIVAL)/bin/python))
# the checker of the CF conventions, too, for its 20 packages are needed by nothing else
export CF_CHECKER ?= $(abspath $(wildcard $(CF)/bin/compliance-checker))

.DEFAULT_GOAL := help
.PHONY: help demo app browser quick test test-rest test-all times arithmetic lowest surfalize cf lint docs bench reliability lock clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /  make \1\t/' | expand -t 16

# first what a user does with a rig, last what becomes of the dissertation's claims
demo: $(VENV)/demo ## predict the reference rig and judge the dissertation's claims; report and figures go to out/
	$(RUN) $(BIN)/sonolube predict examples/rigs/tribometer.toml --out $(OUT)
	$(RUN) $(BIN)/sonolube reproduce --out $(OUT)

app: $(VENV)/app ## open the workbench in the browser
	$(BIN)/sonolube app examples/rigs/tribometer.toml

browser: ## install Debian's Chromium, in which the pages are tested
	apt-get install --no-install-recommends -y chromium

test: $(VENV)/test ## check style and run the daily tests, in ten minutes
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(TEST) --tier daily

test-rest: $(VENV)/test ## run the tests that are not daily, and those of properties with many examples
	$(TEST) --tier rest

test-all: test-rest test ## run every test

times: $(VENV)/test ## run every test and keep its time, from which its tier follows
	$(TEST) --renew-times

quick: $(VENV)/test ## check style and what a change most likely breaks, in less than a minute
	$(BIN)/ruff check .
	$(BIN)/ruff format --check --quiet .
	$(TEST) -q @tests/quick.txt

# warnings are of packages newer than the lowest, which the lowest ones call; the schema is written by the newest pydantic
lowest: $(LOWEST)/installed ## run a part of the tests with the lowest versions that pyproject.toml allows
	$(RUN) $(LOWEST)/bin/python -m pytest -q -n 2 --dist worksteal -W ignore::DeprecationWarning -k "not schema_in_the_docs" \
	    tests/measurement/recordings tests/measurement/impedance tests/measurement/surface_files tests/text \
	    tests/rig/file tests/models/wear tests/facts/protocol tests/cli/predict

arithmetic: $(VENV)/test ## run a part of the tests with the loops of other processors, and with one thread and four
	PYTHONDONTWRITEBYTECODE= $(BIN)/python -m tests.arithmetic

surfalize: $(RIVAL)/installed ## install surfalize beside sonolube, for the tests that compare with it

cf: $(CF)/installed ## install the checker of the CF conventions beside sonolube, for the tests that ask it

lint: $(VENV)/test ## mend what ruff and prettier can mend, then check style, types and architecture
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/mypy
	$(BIN)/lint-imports
	if command -v npx >/dev/null; then $(call NPX,prettier) prettier --write --log-level warn $(SCRIPTS) && $(call NPX,typescript) tsc --project .; fi

docs: $(VENV)/docs ## build the documentation into out/docs
	$(RUN) $(BIN)/sphinx-build -W --keep-going -b html docs $(OUT)/docs
	@echo "$(OUT)/docs/index.html"

bench: $(VENV)/bench ## measure speed, each benchmark beside its rival
	$(RUN) $(BIN)/python -m pytest benchmarks --benchmark-only --benchmark-columns=min,median,iqr,rounds

reliability: $(VENV)/test ## run every study of reliability in full, resuming, and write docs/reliability.md
	$(RUN) $(BIN)/python -m reliability

lock: $(VENV)/uv ## pin and hash every dependency for Python 3.11 to 3.13
	$(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
	    pyproject.toml -o requirements/runtime.txt
	$(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
	    pyproject.toml --extra fem -c requirements/runtime.txt -o requirements/demo.txt
	$(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
	    pyproject.toml --extra app -c requirements/runtime.txt -o requirements/app.txt
	$(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
	    pyproject.toml --group test -c requirements/demo.txt -c requirements/app.txt -o requirements/test.txt
	$(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
	    pyproject.toml --group test --group docs -c requirements/test.txt -o requirements/docs.txt
	$(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
	    pyproject.toml --group test --group bench -c requirements/test.txt -o requirements/bench.txt
	echo "surfalize>=0.19.2" | $(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
	    - -o requirements/surfalize.txt
	echo "compliance-checker>=6.1" | $(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
	    --only-binary :all: - -o requirements/cf.txt

clean: ## remove the environment and everything generated
	rm -rf $(VENV) $(RIVAL) $(CF) $(LOWEST) $(OUT) .mypy_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache .benchmarks
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# -- environments: one, which grows as targets ask for more

$(VENV)/uv: requirements/uv.txt
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "sonolube needs Python 3.11 or newer; name one with: make PYTHON=python3.12 ...")'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/uv.txt
	@touch $@

$(VENV)/runtime: $(VENV)/uv requirements/runtime.txt pyproject.toml
	$(INSTALL) --require-hashes -r requirements/runtime.txt
	$(INSTALL) --no-deps --editable .
	@touch $@

$(VENV)/demo: $(VENV)/runtime requirements/demo.txt
	$(INSTALL) --require-hashes -r requirements/demo.txt
	@touch $@

$(VENV)/app: $(VENV)/runtime requirements/app.txt
	$(INSTALL) --require-hashes -r requirements/app.txt
	@touch $@

$(VENV)/test: $(VENV)/runtime requirements/test.txt
	$(INSTALL) --require-hashes -r requirements/test.txt
	@touch $@

$(RIVAL)/installed: $(VENV)/uv requirements/surfalize.txt
	test -x $(RIVAL)/bin/python || $(PYTHON) -m venv $(RIVAL)
	$(BIN)/uv pip install --quiet --python $(RIVAL)/bin/python --require-hashes -r requirements/surfalize.txt
	@touch $@

$(CF)/installed: $(VENV)/uv requirements/cf.txt
	test -x $(CF)/bin/python || $(PYTHON) -m venv $(CF)
	$(BIN)/uv pip install --quiet --python $(CF)/bin/python --only-binary :all: --require-hashes -r requirements/cf.txt
	@touch $@

$(LOWEST)/installed: $(VENV)/uv pyproject.toml
	$(PYTHON) -m venv --clear $(LOWEST)
	$(BIN)/uv pip install --quiet --compile-bytecode --python $(LOWEST)/bin/python --resolution lowest-direct --editable ".[app]"
	$(BIN)/uv pip install --quiet --compile-bytecode --python $(LOWEST)/bin/python pytest pytest-xdist hypothesis
	@touch $@

$(VENV)/docs: $(VENV)/test requirements/docs.txt
	$(INSTALL) --require-hashes -r requirements/docs.txt
	@touch $@

$(VENV)/bench: $(VENV)/test requirements/bench.txt
	$(INSTALL) --require-hashes -r requirements/bench.txt
	@touch $@

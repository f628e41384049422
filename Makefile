# gproof's commands. A fresh Debian needs git, make, python3 (3.11 or newer) and python3-venv;
# the first target that needs Python packages puts them into .venv from requirements.lock.

PYTHON ?= python3
BIN := .venv/bin
LOCKED := .venv/locked
READY := .venv/ready
PEERS := .venv/peers/ready

# Processes that tests start would read every module anew where the environment forbids to keep bytecode.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.PHONY: help demo test lint types proved checked collected goldens soak bench replay lock clean

help: ## List these targets
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## (.*)/  make \1	\2/' | expand -t 17

demo: $(READY) ## Check, compile, verify and run one job of the corpus on the virtual board
	bash scripts/demo.sh

test: $(READY) ## Everything CI runs: lint, types, import contracts, all tests (under 8 minutes)
	@$(MAKE) --no-print-directory -j2 --output-sync=target proved lint types checked collected
	$(BIN)/pytest -n 2 --dist worksteal

lint: $(READY) ## ruff (rules and format) and the import contracts between the folders
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-logo

types: $(READY) ## mypy --strict over all packages
	MYPYPATH=.typing $(BIN)/mypy --namespace-packages --explicit-package-bases -p gproof

# Kernels compiled once and not by each process of the tests that waits for one: two halves, the first as long as mypy and the second.
proved checked: $(READY)
	$(BIN)/python scripts/kernels.py $@

collected: $(READY) # Tests compiled once
	$(BIN)/pytest --collect-only -q -q >/dev/null

goldens: $(READY) ## Rewrite the expected texts of golden tests; never the `; expect:` markers
	$(BIN)/pytest tests --refresh-goldens

soak: $(READY) ## The long random tests; ONLY=name: one campaign (CONTRIBUTING.md has the names)
	GPROOF_SOAK=1 $(BIN)/pytest -n 2 -m soak $(if $(ONLY),-k "$(ONLY)") tests

bench: $(READY) $(PEERS) ## Side-by-side benchmarks
	$(BIN)/python bench/run.py

# The peer of bench/collisions.py, apart from what gproof and its tests use; without an index the bench says that it is missing.
$(PEERS): pyproject.toml | $(READY)
	@$(BIN)/python -m venv .venv/peers
	@.venv/peers/bin/python -m pip install --quiet --disable-pip-version-check gcode-collision-check==0.1.0 && touch $@ \
		|| echo "gcode-collision-check could not be installed: its column stays empty" >&2

replay: $(READY) ## Compare all programs of the project with another revision: make replay BASE=rev
	@test -n "$(BASE)" || { echo "make replay BASE=rev: which revision to compare with?" >&2; exit 2; }
	$(BIN)/python scripts/replay "$(BASE)"

lock: $(READY) ## Write requirements.lock anew: the newest versions that pyproject.toml allows
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/uv pip compile --quiet --upgrade --universal --python-version 3.11 --generate-hashes --extra dev \
		--no-emit-package gproof --custom-compile-command "make lock" pyproject.toml -o requirements.lock

clean: ## Remove everything that make, tests and tools made, .venv too
	rm -rf .venv build dist *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(READY): $(LOCKED) pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

$(LOCKED): requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit("gproof needs Python 3.11 or newer: make PYTHON=python3.x" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv --clear .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --require-hashes -r requirements.lock
	@touch $@

# The two commands: `make demo` and `make test`. Both set up .venv first.
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.ready
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1

.PHONY: setup demo test check docs bench clean help

help:  ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/'

setup: $(STAMP)  ## create .venv with pinned dependencies (idempotent)

$(STAMP): pyproject.toml constraints.txt
	@command -v $(PYTHON) >/dev/null || { echo "make: $(PYTHON) is needed (set PYTHON=... to name another 3.11+)"; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade --constraint constraints.txt pip hatchling editables
	$(BIN)/python -m pip install --quiet --no-build-isolation --constraint constraints.txt --editable . --group dev
	@touch $@

demo: setup  ## survey the S-shaped reef and make its report
	$(BIN)/coral reef run s1 --video

test: setup  ## the whole test suite
	$(BIN)/python -m pytest -n 2

check: setup  ## lint, format and types
	$(BIN)/ruff check .
	$(BIN)/mypy

docs: setup  ## run every command that the documentation shows
	$(BIN)/python -m pytest -n 2 tests/e2e/test_docs.py

bench: setup  ## speed against peers, ratios in one run
	for script in benchmarks/*.py; do $(BIN)/python $$script || exit 1; done

clean:  ## remove the virtual environment and caches
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis

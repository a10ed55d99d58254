# The two that a stranger needs: `make demo` and `make test`. Both do all set-up themselves.

# The first Python that runs and is new enough; set-up says what to do where there is none.
ifndef PYTHON
PYTHON := $(shell for p in python3 python3.13 python3.12 python3.11; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && exit; done; echo python3)
endif
BIN := .venv/bin
OUT ?= out/demo
PYTEST_ARGS ?=

.PHONY: help setup setup-dev viewer demo test check bench screenshots

help:
	@echo "make demo    bake our own scene and write everything, with report, to $(OUT)"
	@echo "make test    run every test"
	@echo "make check   lint, types and layers, Python and TypeScript"
	@echo "make bench   run the benchmarks, peers included"
	@echo "make screenshots  take the README's pictures of the viewer, from the demo in $(OUT)"
	@echo "make viewer  build the viewer that \`irradia view\` shows"
	@echo "make setup   only what running needs; the others call it"

setup:
	@$(PYTHON) scripts/setup.py

setup-dev:
	@$(PYTHON) scripts/setup.py --dev

viewer:
	@$(PYTHON) scripts/setup.py --viewer

demo: setup
	@$(BIN)/irradia demo --out $(OUT)

test: setup-dev
	@$(BIN)/pytest $(PYTEST_ARGS)

check: setup-dev
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/pyright
	@$(BIN)/lint-imports
	@npm run --silent --prefix web check

bench: setup-dev
	@set -e; for file in bench/*.py; do echo "== $$file"; $(BIN)/python $$file; done

screenshots: setup-dev
	@$(BIN)/python scripts/screenshots.py $(OUT)

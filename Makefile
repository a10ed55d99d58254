# The two that a stranger needs: `make demo` and `make test`. Both do all set-up themselves.

PYTHON ?= $(shell command -v python3.13 || command -v python3.12 || command -v python3.11 || command -v python3)
BIN := .venv/bin
OUT ?= out/demo
PYTEST_ARGS ?=

.PHONY: help setup setup-dev demo test check bench

help:
	@echo "make demo    bake our own scene and write everything, with report, to $(OUT)"
	@echo "make test    run every test"
	@echo "make check   lint, types and layers"
	@echo "make bench   run the benchmarks, peers included"
	@echo "make setup   only what running needs; the others call it"

setup:
	@$(PYTHON) scripts/setup.py

setup-dev:
	@$(PYTHON) scripts/setup.py --dev

demo: setup
	@$(BIN)/irradia demo --out $(OUT)

test: setup-dev
	@$(BIN)/pytest $(PYTEST_ARGS)

check: setup-dev
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/pyright
	@$(BIN)/lint-imports

bench: setup-dev
	@set -e; for file in bench/*.py; do echo "== $$file"; $(BIN)/python $$file; done

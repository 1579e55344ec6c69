# Everything a person or CI does with this repository; `make` alone lists it.
# Needs Python >= 3.11, a Rust toolchain and a C compiler. All else is installed into .venv, pinned by version.

PYTHON ?= python3
VENV := .venv
TRAIN_VENV := .venv-train
BIN := $(VENV)/bin
RUST_SOURCES := $(shell find crates -name '*.rs' -o -name Cargo.toml)
export PIP_CONSTRAINT := $(CURDIR)/constraints.txt
export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_QUIET := 1

.DEFAULT_GOAL := help
.PHONY: help build demo test check wheel train-toy bench docs pins clean
.DELETE_ON_ERROR:

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-9s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

build: $(VENV)/installed ## Set up .venv: pinned dependencies and a release build of the core

demo: build ## Plan the example farm; plan, picture and missions go to out/demo
	$(BIN)/pondhop plan examples/delta_farm.geojson --drones 5 -o out/demo

test: build ## Run every test: Rust, Python, the examples and the code blocks of the docs
	cargo test --workspace --locked
	$(BIN)/pytest

check: build ## Formatters, linters, types and the rules about layers; warnings are errors
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/mypy
	$(BIN)/lint-imports

wheel: $(VENV)/installed ## Build a wheel into out/wheels; pip installs it on machines without Rust
	$(BIN)/maturin build --release --locked --quiet --out out/wheels

train-toy: $(TRAIN_VENV)/installed ## Train toy attention models for a few steps; needs PyTorch, 5 GB in .venv-train
	$(TRAIN_VENV)/bin/pytest tests/training

bench: build ## Time the hot parts of the core, and compare the planners on a few farms; tables go to out/bench
	cargo bench --package pondhop-core --locked --bench '*' -- --warm-up-time 0.3 --measurement-time 1 --sample-size 10
	$(BIN)/pondhop bench run --generate 50,100,200,300,500,700 --farms 20 --routes 5 --planners search,hpp --time-limits 0.1 -o out/bench
	$(BIN)/pondhop bench table out/bench/results.csv

docs: build ## Renew the generated pages and pictures of docs/
	$(BIN)/python -m typer pondhop.cli utils docs --name pondhop --title "pondhop: the command line" --output docs/reference/cli.md
	$(BIN)/python scripts/docs_pictures.py

pins: ## Take the newest dependencies and pin them in Cargo.pins and constraints.txt
	cargo update
	$(PYTHON) scripts/pin_crates.py refresh
	rm -rf $(VENV)
	: > constraints.txt
	rm -rf $(TRAIN_VENV)
	$(MAKE) build $(TRAIN_VENV)/installed
	mkdir -p out
	for bin in $(BIN) $(TRAIN_VENV)/bin; do $$bin/pip freeze --exclude pip --exclude setuptools --exclude pondhop; done \
		| sort --ignore-case --unique > out/constraints.txt
	mv out/constraints.txt constraints.txt

clean: ## Remove everything that make has made
	rm -rf $(VENV) $(TRAIN_VENV) target out Cargo.lock python/pondhop/_core*.so .mypy_cache .ruff_cache .pytest_cache .import_linter_cache

Cargo.lock: Cargo.pins Cargo.toml crates/core/Cargo.toml crates/py/Cargo.toml
	$(PYTHON) scripts/pin_crates.py write
	@touch $@

$(VENV)/installed: Cargo.lock $(RUST_SOURCES) pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "pondhop needs Python 3.11 or newer; set PYTHON=")'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/pip install maturin
	$(BIN)/maturin develop --release --locked --quiet --extras plot,report,dev,baselines
	@touch $@

$(TRAIN_VENV)/installed: Cargo.lock $(RUST_SOURCES) pyproject.toml constraints.txt
	test -x $(TRAIN_VENV)/bin/python || $(PYTHON) -m venv $(TRAIN_VENV)
	$(TRAIN_VENV)/bin/pip install maturin pytest
	. $(TRAIN_VENV)/bin/activate && maturin develop --release --locked --quiet --extras train
	@touch $@

# Two commands do everything: `make train` and `make test`. Each makes the environment first.
.DEFAULT_GOAL := help
SHELL := /bin/bash
MAKEFLAGS += --no-print-directory --no-builtin-rules
.DELETE_ON_ERROR:
# Without bytecode every process compiles the packages it imports anew, for seconds; tests start dozens of processes.
unexport PYTHONDONTWRITEBYTECODE

VENV := .venv
BIN := $(VENV)/bin
# Options for the command behind a target: make train ARGS="--preset paper"
ARGS ?=
# Test processes: one for each core, at most 4 (each holds 2 to 3 GB). TEST_WORKERS=0 runs them in one, as --pdb needs.
TEST_WORKERS ?= logical
PYTEST := -m pytest -q -n $(TEST_WORKERS) --maxprocesses 4 --dist worksteal
# What `make test-newer` runs
NEWER ?= tests/simulation tests/robots tests/scene
# What `make train` trains: CocoNav, Go2Nav, Go2Joystick
ENV ?= CocoNav

.PHONY: help setup setup-dev setup-torch setup-newer train test test-extended test-slow test-torch test-newer test-gpu mutants check format bench streets scenes assets base thumbnails gallery scene-gallery doctor docs docs-media setup-docs lock licences advisories wheel clean distclean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-13s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

setup: $(VENV)/.stamp-main ## create .venv and install the locked packages (CUDA ones too where nvidia-smi works)
	@:

setup-dev: $(VENV)/.stamp-dev ## the same, and what tests and checks need
	@:

$(VENV)/.stamp-main: pyproject.toml requirements.lock requirements-cuda.lock .ci/setup
	@.ci/setup main >&2

$(VENV)/.stamp-dev: requirements-dev.lock $(VENV)/.stamp-main
	@.ci/setup dev >&2

setup-torch: $(VENV)/.stamp-torch
	@:

$(VENV)/.stamp-torch: requirements-torch.lock $(VENV)/.stamp-dev
	@.ci/setup torch >&2

setup-newer: $(VENV)/.stamp-newer ## the same with MuJoCo 4 and without mujoco-mjx, in .venv/newer
	@:

$(VENV)/.stamp-newer: requirements-newer.lock $(VENV)/.stamp-dev
	@.ci/setup newer >&2

setup-docs: $(VENV)/.stamp-docs
	@:

$(VENV)/.stamp-docs: requirements-docs.lock .ci/setup
	@.ci/setup docs >&2

train: setup ## train the small policy, evaluate it on unseen streets; the last line printed is the result as JSON
	@$(BIN)/urbanverse train --env-name $(ENV) $(ARGS)

test: setup-dev ## run the quick tests, which are most
	@$(BIN)/python $(PYTEST) $(ARGS)

test-extended: setup-dev ## run those that take seconds each
	@$(BIN)/python $(PYTEST) -m "extended and not slow and not gpu" $(ARGS)

test-slow: setup-dev ## run the tests that take minutes
	@$(BIN)/python $(PYTEST) -m "slow and not gpu" $(ARGS)

test-torch: setup-torch ## run the tests that need PyTorch, which the others skip (installs 5 GB of its packages into .venv/torch)
	@JAX_PLATFORMS=cpu CUDA_VISIBLE_DEVICES= OMP_NUM_THREADS=1 PYTHONPATH=$(VENV)/torch $(BIN)/python $(PYTEST) -m "torch and not slow and not gpu" $(ARGS)

test-newer: setup-newer ## run the tests of engines, robots and scenes with MuJoCo 4, without mujoco-mjx (installs it into .venv/newer)
	@$(VENV)/newer/bin/python $(PYTEST) -m "not slow and not gpu" $(NEWER) $(ARGS)

test-gpu: setup-dev ## run the tests that need a CUDA device
	@$(BIN)/python -m pytest -q -m gpu $(ARGS)

mutants: setup-dev ## make 120 small faults and list those that no test detects: hours; continues an interrupted run (ARGS="--seed 1")
	@$(BIN)/python -m tests.support.mutants $(ARGS)

check: setup-dev ## formatting, lint, types and import layers
	@$(BIN)/ruff format --check .
	@$(BIN)/ruff check .
	@$(BIN)/pyright
	@$(BIN)/lint-imports

format: setup-dev ## format the code and fix what ruff can fix
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

results: setup-dev ## draw the tables and figures of docs/results.md anew from their rows
	@$(BIN)/python -m benchmarks.results
	@$(BIN)/python -m benchmarks.scaling
	@$(BIN)/python -m benchmarks.transfer_page
	@$(BIN)/python -m benchmarks.missions --page
	@$(BIN)/python -m benchmarks.street_tuning --page
	@$(BIN)/python -m benchmarks.several_gpus --page

streets: setup ## compile the six shipped streets into a scene bank in the cache, where they changed
	@$(BIN)/urbanverse scene bank

scenes: streets ## build the scene library into the cache: 476 scenes, hours; continues an interrupted build (ARGS="autobench")
	@$(BIN)/urbanverse scene library $(ARGS)

bench: setup ## measure throughput; prints one JSON line
	@$(BIN)/python -m benchmarks.throughput --impl jax --num-envs 64 --pixels 36x64 --json $(ARGS)

assets: setup ## write the catalogue of 102,444 asset records into the cache
	@$(BIN)/urbanverse assets build $(ARGS)

base: setup-dev ## make the base shapes, their measures and missing hulls anew from the recipes (CoACD: minutes to hours)
	@$(BIN)/urbanverse assets index
	@$(BIN)/urbanverse assets hulls $(ARGS)

thumbnails: setup ## draw the thumbnails of all base shapes into the cache; continues an interrupted run
	@MUJOCO_GL=$${MUJOCO_GL:-egl} $(BIN)/urbanverse assets thumbnails $(ARGS)

gallery: setup ## draw a contact sheet per middle category into the cache (ARGS="--out FOLDER")
	@MUJOCO_GL=$${MUJOCO_GL:-egl} $(BIN)/urbanverse assets gallery $(ARGS)

scene-gallery: setup ## draw a page of compiled scenes with their numbers into the cache (ARGS="FOLDER ... --out FOLDER")
	@MUJOCO_GL=$${MUJOCO_GL:-egl} $(BIN)/urbanverse scene gallery $(ARGS)

doctor: setup ## say what this machine has and how to fix what is missing
	@$(BIN)/urbanverse doctor $(ARGS)

docs: setup-docs ## build the documentation site into build/docs, without network; a dead link or a page left out fails
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --clean $(ARGS) # --quiet would drop the warnings that --strict counts

docs-media: setup ## film every shipped policy, the tasks and every scene of the benchmarks into build/media (ARGS="--only coco_best")
	@$(BIN)/python -m benchmarks.films $(ARGS)

lock: ## resolve the locks anew, keeping versions that still fit (needs uv; ARGS=--upgrade takes the newest)
	@.ci/lock $(ARGS)

licences: setup-dev ## write docs/licences.md anew: what the default installation brings, and under which licences
	@$(BIN)/python .ci/dependencies.py licences

advisories: setup-dev ## compare the locks with stored advisories in OSV's format, without network (ARGS=FILE)
	@$(BIN)/python .ci/dependencies.py advisories $(ARGS)

wheel: setup-dev ## build a wheel and its bill of materials, install it in an empty environment and ask its doctor
	@.ci/wheel

clean: ## remove build outputs and caches of this folder (not .venv, not runs/)
	@rm -rf -- build dist .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	@find . -path ./$(VENV) -prune -o -name __pycache__ -type d -exec rm -rf -- {} +

distclean: clean ## clean, and remove .venv
	@rm -rf -- $(VENV)

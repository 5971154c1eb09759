PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
PEERS  := .venv-peers
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: help install run sweep verdicts thresholds reproduction test test-slow bench roofline
.PHONY: figures discrete check format clean
.DEFAULT_GOAL := help

help:  ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F':.*## ' '{printf "  make %-12s %s\n", $$1, $$2}'

install: $(STAMP)  ## set up .venv with the locked dependencies

# the lock pins every package; building the project itself needs only what the lock brings
$(STAMP): requirements.lock pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	$(BIN)/python -m cardiosurf.stepping.compiled
	$(BIN)/python -m cardiosurf.analysis.compiled
	touch $@

run: $(STAMP)  ## run the T-domain and print its verdict
	$(BIN)/cardiosurf run configs/t_domain.yaml --overwrite

sweep: $(STAMP)  ## map what a scenario varies: SCENARIO=scenarios/x.yaml [JOBS=2]
	@test -n "$(SCENARIO)" || { echo "which one? make sweep SCENARIO=scenarios/plane_sweep.yaml"; exit 2; }
	$(BIN)/cardiosurf sweep $(SCENARIO) $(if $(JOBS),--workers $(JOBS))

verdicts: $(STAMP)  ## all scenarios against what is expected of them: [FAST=1] [JOBS=2]
	$(BIN)/cardiosurf check scenarios $(if $(FAST),--fast) $(if $(JOBS),--workers $(JOBS))

thresholds: $(STAMP)  ## critical values of all scenarios that are not in docs/results yet: [JOBS=2]
	$(BIN)/cardiosurf reproduce scenarios --only thresholds $(if $(JOBS),--workers $(JOBS))

reproduction: $(STAMP)  ## docs/reproduction.md from docs/results; what is missing is run: [JOBS=2]
	$(BIN)/cardiosurf reproduce scenarios $(if $(JOBS),--workers $(JOBS))

test: $(STAMP)  ## the everyday tests, under 3 minutes
	$(BIN)/python -m pytest -m "not slow" -n 2

test-slow: $(STAMP)  ## convergence and regression suites
	$(BIN)/python -m pytest -m slow -n 2

bench: $(STAMP) $(PEERS)/.installed  ## time everything, other codes too; write benchmarks/README.md
	@/usr/bin/python3 -c "import dolfinx" 2>/dev/null || \
		echo "FEniCSx is left out: on Debian, apt-get install python3-dolfinx brings it"
	$(BIN)/python benchmarks/everyday.py
	$(BIN)/python benchmarks/accuracy.py
	$(BIN)/python benchmarks/roofline.py
	$(BIN)/python benchmarks/compare.py --core 0
	$(BIN)/python benchmarks/page.py

roofline: $(STAMP)  ## how near the march comes to the machine's bounds
	$(BIN)/python benchmarks/roofline.py
	$(BIN)/python benchmarks/page.py

# the peers' pins contradict ours (numpy), so they have an environment of their own
$(PEERS)/.installed: benchmarks/peers/requirements.txt
	test -x $(PEERS)/bin/python || $(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check --requirement $<
	touch $@

figures: $(STAMP)  ## draw the figures of the theory again (docs/images)
	$(BIN)/python -m cardiosurf.report.theory_figures docs/images
	$(BIN)/python -m cardiosurf.report.roc_figure docs/results/prediction.csv docs/images
	$(BIN)/cardiosurf run configs/plane_block.yaml --set tissue.patches.block.anisotropy.x=4 \
		-o runs/figures/plane-4 --overwrite
	$(BIN)/cardiosurf analyze runs/figures/plane-4 --acceleration -o docs/images
	rm -f docs/images/relative_acceleration.vtu

discrete: $(STAMP)  ## Appendix B's units against the simulation: what is missing is asked
	$(BIN)/python -m cardiosurf.report.discrete_study .

check: $(STAMP)  ## ruff, mypy --strict, import-linter
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(STAMP)  ## let ruff mend what it can
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean:  ## remove the environment, caches and runs
	rm -rf $(VENV) $(PEERS) runs .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

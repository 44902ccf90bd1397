# make render | test | lint | types | bench | faults | fuzz | docs | wheel | clean
PYTHON ?= python3
VENV ?= .venv
WORKERS ?= 2
PY := $(VENV)/bin/python
BASE := $(VENV)/.base
TEST := $(VENV)/.test
DOCS := $(VENV)/.docs

.PHONY: render test lint types bench faults fuzz docs wheel clean
.DELETE_ON_ERROR:

render: $(BASE)
	$(VENV)/bin/symrender demo --out out --force

test: lint types
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || test "$$(id -u)" != 0 \
	  || { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
	       chromium fonts-dejavu-core >/dev/null; } || echo "no chromium: the tests in a browser will be skipped" >&2
	$(PY) tests/compile_first.py $(WORKERS)
	$(PY) -m pytest -n $(WORKERS) --dist loadfile --no-loadscope-reorder

lint: $(TEST)
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .

types: $(TEST)
	$(PY) -m mypy

bench: $(BASE)
	$(PY) benchmarks/run.py --quick

faults: $(TEST)
	$(PY) tests/faults/run.py

fuzz: $(TEST)
	$(PY) benchmarks/fuzz_scene_files.py

docs: $(DOCS)
	$(PY) docs/build.py

wheel: $(BASE)
	$(PY) wheels/make_wheels.py --out dist --workers $(WORKERS)

clean:
	rm -rf out dist docs/_build docs/_extra docs/laboratory .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find src tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +

$(PY):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "symrender needs Python 3.11 or later; name one: make PYTHON=python3.12 $(MAKECMDGOALS)" >&2; exit 1; }
	@$(PYTHON) -m venv $(VENV) || { $(PYTHON) -m venv --without-pip $(VENV) \
	  && $(PYTHON) -m pip --python $(PY) install --quiet --quiet --disable-pip-version-check pip; }

$(BASE): pyproject.toml | $(PY)
	$(PY) -m pip install --quiet --quiet --disable-pip-version-check --editable .
	@touch $@

$(TEST): pyproject.toml | $(PY)
	$(PY) -m pip install --quiet --quiet --disable-pip-version-check --editable '.[test]'
	@touch $@ $(BASE)

$(DOCS): pyproject.toml | $(PY)
	$(PY) -m pip install --quiet --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@

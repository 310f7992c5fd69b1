# Two commands after a clone: `make demo` and `make test`. Each sets itself up.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
ZIG    := 0.17.1 # compiles the kernels where there is no C compiler
# Those that hatch_build.py looks for; without one of them the kernels are compiled by zig.
HAS_COMPILER := for each in "$${CC%% *}" cc gcc clang; do command -v "$$each" >/dev/null && exit 0; done; false
PIP    := $(BIN)/python -m pip --disable-pip-version-check install --quiet

DESIGNER := editors/designer
NPM      := npm --prefix $(DESIGNER) --no-audit --no-fund --no-update-notifier --loglevel=error

# Where Python may not keep what it compiles, every test process would compile all modules anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test native wheels lint lint-page page-tools unit quick docs lessons bench fuzz editors designer types lock clean help

help:
	@echo "make demo   set up and run the whole story on rulebases/pd7.frb"
	@echo "make test   set up and run linters, types and the whole test suite"
	@echo "make quick  the tests without browser, compilers, other processes and pages"
	@echo "make native build the machine code of the kernels anew"
	@echo "make wheels make wheels for this platform and, by ziglang, for others, and check them"
	@echo "make docs   set up and build the pages as a site, in build/docs"
	@echo "make bench  set up and measure against C and the peers that are installed;"
	@echo "            with BEFORE=TREE/.venv/bin/python beside another tree, in turns"
	@echo "make fuzz   all random cases of the tests; then texts, tables, rule bases and proofs, 20,000 each, 5,000 loops"
	@echo "            and 12,000 commands: seven hours"
	@echo "make editors  compile, test and package the extension for VS Code (needs node)"
	@echo "make designer  build what the designer's page needs of other packages (needs node)"
	@echo "make types  print the messages of the designer as types for its page"
	@echo "make lessons  the lessons as notebooks and marimo files, in build/lessons"
	@echo "make lock   renew the lock files (needs uv)"

demo: $(VENV)/.run
	@$(BIN)/fuzzyarm demo
	@echo
	@echo "── To type now:"
	@echo
	@echo "  $(BIN)/fuzzyarm designer rulebases    the rule bases in a browser; Ctrl-C ends it"
	@echo "  $(BIN)/fuzzyarm playground -o site    the same as files for any web server"
	@echo "  source $(BIN)/activate                from then on the command is fuzzyarm"

test: lint unit

lint: $(VENV)/.dev lint-page
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# What the page is checked with, and axe-core for the tests; without node or a registry it says so.
page-tools:
	@cmp -s $(DESIGNER)/package-lock.json $(DESIGNER)/node_modules/.of-lock || { \
	  command -v npm >/dev/null && $(NPM) ci --ignore-scripts && \
	  cp $(DESIGNER)/package-lock.json $(DESIGNER)/node_modules/.of-lock; \
	} || echo "skipped: the tools of the designer's page are not installed (npm, a registry)"

lint-page: page-tools
	@if [ -f $(DESIGNER)/node_modules/.of-lock ]; then $(NPM) run --silent lint; \
	else echo "skipped: eslint, prettier, tsc and node --test of the designer's page"; fi

unit: $(VENV)/.dev page-tools
	$(BIN)/python -m pytest -n 2 --dist worksteal $(FLAGS)

quick: $(VENV)/.dev
	$(BIN)/python -m pytest -n 2 --dist worksteal --quick

docs: $(VENV)/.dev
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs build/docs
	@echo "build/docs/index.html"

lessons: $(VENV)/.run
	$(BIN)/python tools/make_lessons.py build/lessons

bench: $(VENV)/.dev
	$(BIN)/python benchmarks/$(if $(BEFORE),beside.py --before $(BEFORE),run_all.py)

fuzz: $(VENV)/.dev
	$(BIN)/python -m pytest -n 2 --dist worksteal --thorough
	$(BIN)/python tests/fuzz/damaged_texts.py --count 20000
	$(BIN)/python tests/fuzz/damaged_tables.py --count 20000
	$(BIN)/python tests/fuzz/random_rule_bases.py --count 20000
	$(BIN)/python tests/fuzz/random_proofs.py --count 20000
	$(BIN)/python tests/fuzz/random_loops.py --count 5000
	$(BIN)/python tests/fuzz/random_commands.py --count 12000
	$(BIN)/python tests/fuzz/patience.py --count 100

native: $(VENV)/.run
	$(BIN)/python -m fuzzyarm.apps.native.build

wheels: $(VENV)/.dev
	$(PIP) ziglang==$(ZIG)
	$(BIN)/python tools/wheels.py

$(VENV)/bin/python:
	$(PYTHON) -c 'import sys; sys.exit("fuzzyarm needs Python 3.11 or later") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.run: requirements/run.lock pyproject.toml | $(VENV)/bin/python
	$(PIP) --require-hashes -r requirements/run.lock
	$(PIP) --require-hashes -r requirements/build.lock
	@( $(HAS_COMPILER) ) || $(PIP) ziglang==$(ZIG)
	$(PIP) --no-deps --no-build-isolation -e .
	@$(BIN)/python -m compileall -q src
	@touch $@

$(VENV)/.dev: requirements/dev.lock pyproject.toml | $(VENV)/bin/python
	$(PIP) --require-hashes -r requirements/dev.lock
	@( $(HAS_COMPILER) ) || $(PIP) ziglang==$(ZIG)
	$(PIP) --no-deps --no-build-isolation -e .
	@$(BIN)/python -m compileall -q src
	@touch $@ $(VENV)/.run

editors:
	cd editors/vscode && npm ci && npm test && npm run package

designer: page-tools
	$(NPM) run build

types: $(VENV)/.dev
	$(BIN)/python tools/message_types.py

lock:
	uv pip compile --universal --generate-hashes --no-header --no-annotate -p 3.11 pyproject.toml -o requirements/run.lock
	uv pip compile --universal --generate-hashes --no-header --no-annotate -p 3.11 --group build -o requirements/build.lock
	uv pip compile --universal --generate-hashes --no-header --no-annotate -p 3.11 pyproject.toml --all-extras --group dev --group docs -c requirements/run.lock -o requirements/dev.lock

clean:
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .hypothesis

# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0

PYTHON ?= python3
SOURCES := CMakeLists.txt pyproject.toml $(shell find core bindings python -type f -not -name '*.so' -not -path '*/__pycache__/*' -not -path '*/viewer/page/*')
PAGE := python/eclat/viewer/page/index.html
CORE_TESTS := $(shell find tests/core -type f)

.PHONY: demo test docs install page core-test clean
.DEFAULT_GOAL := demo

demo: .venv/installed ## render the built-in scenes by irradiance caching and by path tracing, side by side
	.venv/bin/python examples/demo.py

test: web/node_modules/installed .venv/tested core-test ## all tests but the dearest (tools/check --full has those)
	.venv/bin/python -m pytest tests -m "not full" -n auto --maxprocesses 4 --dist loadfile

docs: .venv/documented ## the documentation site, in build/docs/html
	.venv/bin/python tools/docs.py

install: .venv/installed

page: $(PAGE) ## the page of `eclat view`, which the wheel contains; without npm there is none, and `eclat view` says so

# It is not under version control, because it is half a megabyte that would change with every change of its sources.
$(PAGE): web/package.json web/package-lock.json $(shell find web/view -type f)
	if command -v npm >/dev/null; then cd web && { [ -x node_modules/.bin/vite ] || npm ci --loglevel=error; } && \
	    npm run --silent build -- --logLevel warn && touch ../$@; \
	else echo "eclat: npm: not found; eclat view needs its page, which npm builds"; fi

.venv/python:
	tools/bootstrap
	$(PYTHON) -m venv .venv
	.venv/bin/pip install --quiet --upgrade pip
	touch $@

.venv/installed: .venv/python $(SOURCES) $(PAGE)
	.venv/bin/pip install --quiet .
	touch $@

.venv/tested: web/node_modules/installed .venv/installed
	.venv/bin/pip install --quiet '.[test,docs]'
	touch $@

.venv/documented: .venv/installed
	.venv/bin/pip install --quiet '.[docs]'
	touch $@

web/node_modules/installed: web/package.json web/package-lock.json
	tools/bootstrap browser
	if command -v npm >/dev/null; then cd web && npm ci --loglevel=error && touch node_modules/installed; fi

core-test: build/core-test/tested

# Line numbers are all of the debug information that sanitizers print; the rest takes a third of the compiler's time.
build/core-test/tested: .venv/python CMakeLists.txt $(SOURCES) $(CORE_TESTS)
	cmake -S . -B build/core-test -G Ninja -DECLAT_PYTHON=OFF -DECLAT_TESTS=ON -DECLAT_SANITIZE=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O2 -g1 -DNDEBUG" >/dev/null
	cmake --build build/core-test
	build/core-test/tests/core/core_tests
	touch $@

clean:
	rm -rf build .venv web/node_modules python/eclat/viewer/page

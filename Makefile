# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0

PYTHON ?= python3
SOURCES := CMakeLists.txt pyproject.toml $(shell find core bindings python -type f -not -name '*.so' -not -path '*/__pycache__/*')
CORE_TESTS := $(shell find tests/core -type f)

.PHONY: demo test install core-test clean
.DEFAULT_GOAL := demo

demo: .venv/installed ## render the built-in scenes by irradiance caching and by path tracing, side by side
	.venv/bin/python examples/demo.py

test: .venv/tested web/node_modules/installed core-test ## all tests but the dearest (tools/check --full has those)
	.venv/bin/python -m pytest tests -m "not full"

install: .venv/installed

.venv/python:
	tools/bootstrap
	$(PYTHON) -m venv .venv
	.venv/bin/pip install --quiet --upgrade pip
	touch $@

.venv/installed: .venv/python $(SOURCES)
	.venv/bin/pip install --quiet .
	touch $@

.venv/tested: .venv/installed
	.venv/bin/pip install --quiet '.[test]'
	touch $@

web/node_modules/installed: web/package.json web/package-lock.json
	tools/bootstrap browser
	if command -v npm >/dev/null; then cd web && npm ci --loglevel=error && touch node_modules/installed; fi

core-test: build/core-test/tested

build/core-test/tested: .venv/python CMakeLists.txt $(SOURCES) $(CORE_TESTS)
	cmake -S . -B build/core-test -G Ninja -DECLAT_PYTHON=OFF -DECLAT_TESTS=ON -DECLAT_SANITIZE=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo >/dev/null
	cmake --build build/core-test
	build/core-test/tests/core/core_tests
	touch $@

clean:
	rm -rf build .venv web/node_modules

# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A fuzzer of everything that Éclat reads: `PYTHONPATH=python:tests python -m fuzz --help`.

`corpus` makes small valid files, `mutations` damages them as their formats are built, `targets` says what is done with
each, and `workers` does it in processes with limits of time and memory. Input number n of a seed is always the same.
"""

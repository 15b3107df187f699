# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Grids of probes: the light that arrives at points in space, for objects that move; their files, and what engines read."""

# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Substitutes for a missing light or camera, and replacement of materials by name."""

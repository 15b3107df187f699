# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Éclat: global illumination by irradiance caching, beside an unbiased path tracer."""

from __future__ import annotations

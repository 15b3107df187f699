# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verbs, the functions that users call: solve, render, irradiance, bake, compare and denoise. Except for denoise,
each works with all methods."""

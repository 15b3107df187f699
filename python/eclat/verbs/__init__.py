# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What Éclat does: solve, render, irradiance, bake, compare; each works with all methods."""

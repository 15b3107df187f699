# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The records of irradiance caching and radiance caching: their options, their computation, and the solutions that hold
them."""

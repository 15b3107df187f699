# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Light maps: charts of all surfaces in one image (`atlas`), the points that its texels stand for (`texels`), what lies
between charts (`gutters`), and the result as a value and as files (`lightmap`)."""

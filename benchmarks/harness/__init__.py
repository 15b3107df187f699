# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What the benchmarks share: scenes, turns, references, curves, results and the document."""

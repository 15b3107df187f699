# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
def supported_level() -> int:
    """The highest level of x86-64 that this machine runs, 1 to 4."""

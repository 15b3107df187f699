# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The compiled core of wheels, which hold one for each instruction set.

Python runs this file only where no extension module `_core` lies beside it, as in builds from the sources. The module
that it loads takes its place.
"""

from eclat.instruction_set import load_core

load_core()

# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0

"""`python -m eclat`: the command line, also where the script `eclat` is not on the path."""

import sys

from eclat.cli import main

sys.exit(main())

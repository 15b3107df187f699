# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0

"""The command line as `python -m eclat`, which works even if the script `eclat` is not on the path."""

import sys

from eclat.cli import main

sys.exit(main())

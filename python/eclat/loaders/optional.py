# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Import the packages that only some files need. They belong to extras of Éclat, so they may be missing."""

from __future__ import annotations

import importlib
from typing import Any

from eclat.errors import EclatError


def optional_module(module: str, extra: str, what: str) -> Any:
    """Import `module`, which the extra `extra` of Éclat installs.

    `what` says for the message what needs it, such as "geometry compressed by Draco". Raises EclatError, which says
    what to install, if the module cannot be imported.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise EclatError(
            f"{what} can be read only with an optional package: install it with: pip install 'eclat[{extra}]' "
            f"(got: {error})"
        ) from None

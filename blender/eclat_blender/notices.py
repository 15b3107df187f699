# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What could not be carried over from Blender, each thing once."""

from __future__ import annotations


class Notices:
    """A list of sentences for the user, in the order in which the translation met their causes."""

    def __init__(self) -> None:
        self._texts: dict[str, None] = {}

    def add(self, where: str, what: str) -> None:
        """Add a sentence about `where`, such as "material 'Wall'"; the same sentence is kept once."""
        self._texts.setdefault(f"{where}: {what}")

    @property
    def texts(self) -> list[str]:
        """The sentences."""
        return list(self._texts)

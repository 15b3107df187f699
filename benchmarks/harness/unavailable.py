# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What cannot be measured here."""


class UnavailableError(Exception):
    """A peer, a tool or a model is missing; the message says which and how to get it."""

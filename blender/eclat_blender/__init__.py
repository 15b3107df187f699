# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Éclat as a render engine of Blender.

Only `engine`, `panels`, `settings`, `bake`, `sky` and `viewport_draw` use `bpy`; all other modules translate what they are
given, so that they can be tested without Blender.
"""


def register() -> None:
    """Make the engine known to Blender."""
    from . import registration

    registration.register()


def unregister() -> None:
    """Remove the engine from Blender."""
    from . import registration

    registration.unregister()

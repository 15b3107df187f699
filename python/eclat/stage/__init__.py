# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Changes to a scene before it is rendered: a camera or light for a scene without one, overrides of the user, and
replacement of materials by name."""

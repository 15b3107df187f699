# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How scenes, arguments and long calls cross into the compiled core."""

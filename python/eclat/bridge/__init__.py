# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The bridge to the compiled core: it checks arguments, converts scenes, and runs long calls."""

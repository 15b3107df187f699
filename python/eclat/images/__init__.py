# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Images: their pixels, their file formats and their conversion for display."""

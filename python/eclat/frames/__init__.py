# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The frames of an animation: their files, what is finished, what moves between them, and the video of them."""

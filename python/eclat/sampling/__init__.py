# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decides how many samples each pixel takes, when sampling stops, and how far denoised pictures are from the truth."""

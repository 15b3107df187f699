# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Measures of light and of error: spectra, photometric units and the relative error."""

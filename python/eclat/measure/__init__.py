# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Measures of light and of errors: spectra, photometric units, and relative errors of pictures and caches."""

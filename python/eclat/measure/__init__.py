# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What numbers mean: spectra, photometric units, the error measure."""

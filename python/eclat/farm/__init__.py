# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Many processes and machines, by Dask: which of them may take part, what travels to them, and what comes back."""

# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A solved scene in the browser. `messages` defines the format of what is sent, `surfaces`, `materials`, `lamps` and
`record_rows` fill it, `server` serves it on this machine, and `showing` holds the verb `view`."""

# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures that grow in tev, a viewer of images, while they are rendered [tev]."""

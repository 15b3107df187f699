# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
Where the records lie
=====================

Irradiance caching computes indirect light at few points, the records, and interpolates between them. Here each record
is an orange dot: they are dense in corners, where indirect light changes quickly, and sparse on open walls.
"""

import numpy as np

import eclat

scene = eclat.load("cornell-box")
solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.03), size=(320, 320))
print(solution)

image = eclat.render(scene, solution, samples=16, size=(320, 320), denoise=False)
pixels = image.show_records(exposure=1).pixels
twice_as_large = np.repeat(np.repeat(pixels, 2, axis=0), 2, axis=1)  # so that single pixels can be seen
eclat.Image(twice_as_large).save("records.png", exposure=1)

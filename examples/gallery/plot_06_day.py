# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
A courtyard from morning to evening
===================================

The built-in courtyard takes the place of the sun as parameters. The exposure is the same in all pictures, so that
they can be compared.
"""

import eclat

for hour, azimuth, elevation in (("morning", 95, 18), ("noon", 180, 60), ("evening", 275, 12)):
    scene = eclat.load("atrium", sun_azimuth=azimuth, sun_elevation=elevation)
    image = eclat.render(scene, eclat.IrradianceCache(max_error=0.2), samples=16, size=(256, 144), denoise=True)
    image.save(f"{hour}.png", exposure=1, tone_mapping="filmic")

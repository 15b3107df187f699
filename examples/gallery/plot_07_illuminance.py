# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
How much light falls on the floor
=================================

``irradiance`` computes light at points. A grid of points on the floor of the courtyard gives a plan of its
illuminance under the sun and the clear sky of noon, in false colours from black (dark) to pale yellow (in the sun).
"""

from dataclasses import replace

import numpy as np
from PIL import Image

import eclat
from eclat.daylight.sky import sun_direction, sun_sky
from eclat.images.colormaps import AMOUNT, colored
from eclat.measure.photometry import illuminance

scene = eclat.load("atrium")
sun, sky = sun_sky(sun_direction(azimuth_deg=180, elevation_deg=60))
scene = replace(scene, lights=(sun,), environment=sky)

corners = np.concatenate([np.asarray(mesh.positions) for mesh in scene.meshes])
(x0, _, z0), (x1, _, z1) = np.percentile(corners, 5, axis=0), np.percentile(corners, 95, axis=0)
x, z = np.meshgrid(np.linspace(x0, x1, 64), np.linspace(z0, z1, 64))
points = np.stack([x, np.full_like(x, 0.8), z], axis=-1).reshape(-1, 3)
E = eclat.irradiance(scene, points, np.broadcast_to([0.0, 1.0, 0.0], points.shape), max_error=0.05, samples=64)
lux = illuminance(E, scene.photometric).reshape(x.shape)
print(f"median {np.median(lux):,.0f} lux, between {lux.min():,.0f} and {lux.max():,.0f}")

plan = colored(np.log10(np.maximum(lux, 1)) / 5, AMOUNT)
Image.fromarray(plan).resize((320, 320), Image.Resampling.NEAREST).save("plan.png")

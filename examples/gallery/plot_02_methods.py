# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
The same room by every method
=============================

All methods are used in the same way, so that they can be compared. ``path`` has no error but noise, and so two of its
pictures, with other seeds and more samples, serve as the reference. The error is that of all figures of this project.
"""

import eclat
from eclat.measure.metrics import relative_rmse

SIZE = (160, 160)
scene = eclat.load("cornell-box")
references = [eclat.render(scene, eclat.Path(), samples=128, size=SIZE, seed=seed).pixels for seed in (98, 99)]

for name, method in {
    "path": eclat.Path(),
    "irradiance-cache": eclat.IrradianceCache(),
    "photon-map": eclat.PhotonMap(photons=50_000),
    "radiosity": eclat.Radiosity(patches=2000),
}.items():
    image = eclat.render(scene, method, samples=16, size=SIZE, denoise=False)
    image.save(f"{name}.png", exposure=1)
    seconds = image.metadata["statistics"]["seconds"]
    print(f"{name:17} error {relative_rmse(image.pixels, *references):5.1%} after {seconds:.1f} s")

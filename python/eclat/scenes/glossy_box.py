# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The Cornell box with a floor and a tall box of rough metal."""

from __future__ import annotations

from eclat.errors import EclatError
from eclat.scene import Material, Scene, grey
from eclat.scenes import cornell_box


def build(alpha: float = 0.2) -> Scene:
    """Build the scene. The metal has a GGX distribution of roughness `alpha`, 0..1 (0 is a mirror), and reflects 80 %
    of the light; the camera has 512 × 512 pixels."""
    if not 0 <= alpha <= 1:
        raise EclatError(f"built-in scene glossy-box: expected alpha from 0 to 1, got {alpha}")
    parameters = {"eta": grey(0), "k": grey(1), "specular_reflectance": grey(0.8), "alpha_u": grey(alpha)}
    gloss = Material("conductor", parameters, name="gloss", two_sided=False)
    return cornell_box.room(floor=gloss, large_box=gloss, name="glossy-box")

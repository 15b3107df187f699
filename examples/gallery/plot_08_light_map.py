# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
A light map for the browser
===========================

``bake`` computes the light of all surfaces at once and keeps it in an image. In the file ``box_lit.glb`` the scene
carries that image, so that a viewer shows the light without computing it.
"""

import eclat

lightmap = eclat.bake("cornell-box", texel_size=0.04, max_error=0.03)
print(lightmap)
lightmap.save("box_lit.glb")

# %%
# This is the image itself: every surface has a place of its own in it.

eclat.Image(lightmap.irradiance / lightmap.intensity()).save("light-map.png")

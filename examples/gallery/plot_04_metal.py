# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
Rough metal, by radiance caching
================================

Records of irradiance hold one number for all directions, which is right for diffuse surfaces only. Radiance caching
keeps the light of all directions, so that rough metal can be read from records, too.
Here materials of the Cornell box are replaced by metals of Mitsuba's list.
"""

import eclat


def rough(metal, alpha):
    return {"type": "roughconductor", "material": metal, "distribution": "ggx", "alpha": alpha}


metals = {"floor": rough("Cr", 0.35), "large-box": rough("Cu", 0.4), "small-box": rough("Au", 0.5)}
scene = eclat.override_materials(eclat.load("cornell-box"), metals)
image = eclat.render(scene, eclat.RadianceCache(max_error=0.03), samples=32, size=(256, 256))
image.save("metals.png", exposure=1)

# %%
# Two layers tell how much of the light of glossy lobes came from records, and how much was traced because a lobe was
# too sharp for them.

cached, traced = (float(image.layers[name].sum()) for name in ("gloss_cached", "gloss_traced"))
print(f"{cached / (cached + traced):.0%} of the gloss was read from records")

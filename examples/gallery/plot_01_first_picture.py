# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
A first picture
===============

The Cornell box is built in, so that this needs no file. Irradiance caching is the default method; the picture is done
when its estimated error is below 3 %.
"""

import eclat

image = eclat.render("cornell-box", size=(256, 256))
image.save("cornell-box.png", exposure=1)

# %%
# The metadata of the picture state the error that was measured, and what it took.

statistics = image.metadata["statistics"]
low, high = statistics["estimated_error_low"], statistics["estimated_error_high"]
print(f"estimated error {statistics['estimated_error']:.1%}, with 95 % between {low:.1%} and {high:.1%}")
print(
    f"{statistics['records']:.0f} records, {statistics['samples']:.0f} samples a pixel, {statistics['rays']:,.0f} rays"
)

# %%
# Besides the radiance, a picture has layers: here the light that comes straight from the lamp, and the light of all
# further bounces, which is what a cache computes. In an .exr file all of them are kept.

eclat.Image(image.layers["direct"]).save("direct.png", exposure=1)
eclat.Image(image.layers["indirect"]).save("indirect.png", exposure=1)

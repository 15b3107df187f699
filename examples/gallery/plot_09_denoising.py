# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
Noise removed, and the error that is left
=========================================

Sixteen paths for each pixel are noisy. With ``denoise`` the samples are taken in two independent halves, each of which judges
the other after the denoiser, so that the error that is left is measured without a reference.
"""

import eclat

noisy = eclat.render("glossy-box", eclat.Path(), samples=16, size=(192, 192), denoise=False)
noisy.save("noisy.png", exposure=1)

# %%
# The same number of samples, denoised.

clean = eclat.render("glossy-box", eclat.Path(), samples=16, size=(192, 192), denoise=True)
clean.save("denoised.png", exposure=1)
statistics = clean.metadata["statistics"]
print(f"error that is left: {statistics['estimated_error']:.1%}")

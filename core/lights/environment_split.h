// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The division of an environment into a part that gathers collect and a part that counts as direct light.
// A gather sends one ray into each cell of its grid. The gradients of the sky, a horizon and clouds are wider than a
// cell and are sampled well, but a sun or a lamp in the image is hit by one ray in thousands. The image is therefore
// split once, L = smooth + sharp, both ≥ 0: smooth is L where its luminance is below a limit, and L scaled down to the
// limit elsewhere.
//
// Symbol    name here       meaning
//   c       limit           the luminance that smooth is cut at
//   ω_b     cell_solid_angle  a cell's: 2π over the rays of a gather
//   V_b     –               variance of the cut luminance within block b of the sky, which is about as large as a cell
//   E       –               irradiance of a surface under the image; on average over its normals ¼ ∫ L dω
//
// One ray a cell, of weight ω_b cos θ, brings a variance of Σ ω_b² cos² θ V_b, that is on average over normals
// ω_b / 6 Σ V_b ω_b over the blocks of the whole sphere, since the mean of cos² over a hemisphere is 1/3 and a surface sees
// half of the sphere. c is the largest limit at which its root is at most `tolerated_noise` of E.
// Departures   Textures of forests and clouds have a share of that noise too, so that their brightest spots become sharp.
// Held to      tests/core/lights/test_environment_split.cpp, tests/methods/test_environment_images.py

#pragma once

#include <cstdint>
#include <span>

namespace eclat {

/// Returns the luminance at which the smooth part of an equirectangular image (height × width × 3, row 0 at the pole)
/// is clamped. It is infinite if nothing in the image is sharp, and 0 if everything is.
float smooth_limit(std::span<const float> rgb, uint32_t width, uint32_t height);

}  // namespace eclat

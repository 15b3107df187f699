// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A stratified gather: radiance and distance in each cell of a polar grid. Within a cell, directions are uniform in sin²,
// so that its mean radiance times its projected solid angle is its irradiance.

#pragma once

#include <array>
#include <vector>

#include "base/frame.h"
#include "hemisphere/gradients.h"

namespace eclat {

/// The positions of the walls between rows.
enum class Rows : uint8_t {
    cosine,    // uniform in sin² [Ward88]: all cells have the same share of the irradiance
    balanced,  // half of the cells by sin² and half by solid angle, for lobes at grazing angles too
};

/// Sine and cosine of the elevation from the zenith.
struct RowWall {
    float sin, cos;
};
/// The wall above row j; below the last row, for j = rows.
RowWall row_wall(Rows kind, int j, int rows);

struct HemisphereSamples {
    int rows = 0, columns = 0;  // M, N
    Rows kind = Rows::cosine;
    Frame frame;                   // its u is the direction of the grid's φ = 0
    std::vector<Color> radiance;   // L_jk, row by row from the zenith
    std::vector<float> distance;   // r_jk, infinite if the ray hit nothing
    std::vector<Vec3> direction;   // unit, in `frame`
    std::vector<Vec3> hit_normal;  // normals of the hits, in `frame`, on the visible side
    std::vector<uint8_t> apart;    // 1 if the hit is separate from the surface of the point

    const Color& L(int j, int k) const { return radiance[size_t(j) * columns + k]; }
    float r(int j, int k) const { return distance[size_t(j) * columns + k]; }
};

/// Returns the number of columns N = π M for M rows, with which cells are about as wide as high.
int columns_for(int rows);

/// Returns the direction in cell (j, k) for random numbers u in the unit square, in the grid's frame.
Vec3 cell_direction(int rows, int columns, int j, int k, Vec2 u, Rows kind = Rows::cosine);

/// The luminance above which light of a cell is excess, for the two halves of the grid that lie like the colours of a chessboard.
struct ExcessLimits {
    std::array<float, 2> of_half;
    /// Returns the limit for a cell, from its index.
    float at(const HemisphereSamples& samples, size_t cell) const;
};
/// Returns the luminance at which a cell contributes a twentieth of the irradiance after all brighter cells have been reduced
/// to it. The limit for the cells of one half follows from those of the other, so that it does not depend on what it limits.
ExcessLimits excess_limits(const HemisphereSamples& samples);
/// Returns the index of the cell that contains a unit direction of the upper hemisphere in the grid's frame. Rows must be uniform
/// in sin².
size_t cell_at(const HemisphereSamples& samples, Vec3 direction);
/// Returns the part of a radiance that is above a luminance.
Color beyond(Color radiance, float limit);
/// Reduces the radiance of cells that contribute more than their limit to it, and returns the irradiance that was removed. So
/// few rays cannot determine the size of a bright object; only many records together can.
Color take_excess(HemisphereSamples& samples);

/// Computes E, the sum of L_jk times the projected solid angle of the cell, which is π / MN in cosine rows [Ward88].
Color irradiance(const HemisphereSamples& samples);
/// Estimates the relative standard error of the irradiance's luminance from the differences of neighbouring cells. It
/// is too large if radiance varies smoothly, because this variation counts as noise too.
float relative_noise(const HemisphereSamples& samples);
RotationGradient rotation_gradient(const HemisphereSamples& samples);
TranslationGradient translation_gradient(const HemisphereSamples& samples);

/// Increases all distances below `least` to `least`.
void keep_off(HemisphereSamples& samples, float least);
/// Returns the harmonic mean of the distances; a miss counts as infinite.
float harmonic_mean_distance(const HemisphereSamples& samples);
/// Returns the distance that a point sees: the harmonic mean over the farther half of the hits, or infinity if there is
/// none. In a corner half of the rays are short, and through a window some are very long; neither changes this distance
/// much.
float reach(const HemisphereSamples& samples);
/// Returns the largest distance of a hit, or 0 if there is none.
float farthest_distance(const HemisphereSamples& samples);
/// Returns whether a hit with the normal `there` is separate from the surface with the normal `here`, and not its
/// curved continuation: at the two ends of a chord of a circle, normals differ by twice its elevation.
bool stands_apart(Vec3 here, Vec3 direction, Vec3 there);
/// Returns the least distance to separate objects.
float minimum_distance(const HemisphereSamples& samples);

/// Returns, for each sector of azimuth in Frame::around(normal), the least horizontal distance to separate objects up
/// to 45° above the horizon, or infinity.
std::array<float, 12> sector_clearance(const HemisphereSamples& samples);
/// Returns the sector of that frame in which the tangential vector `d` lies.
int clearance_sector(const Frame& frame, Vec3 d);

}  // namespace eclat

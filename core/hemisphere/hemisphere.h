// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A stratified gather: radiance and distance in each cell of a polar grid. Within a cell, directions are uniform in sin²,
// so that its mean radiance times its projected solid angle is its irradiance.

#pragma once

#include <vector>

#include "base/frame.h"
#include "hemisphere/gradients.h"

namespace eclat {

/// Where the walls between rows lie.
enum class Rows : uint8_t {
    cosine,    // uniform in sin² [Ward88]: all cells bring as much irradiance
    balanced,  // half of the cells by that, half by solid angle: for light that lobes along the surface see as well
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
    std::vector<float> distance;   // r_jk, infinite where nothing was met
    std::vector<Vec3> direction;   // unit, in `frame`
    std::vector<Vec3> hit_normal;  // of what was met, in `frame`, on the side that is seen
    std::vector<uint8_t> apart;    // 1 where what was met stands apart from the surface itself

    const Color& L(int j, int k) const { return radiance[size_t(j) * columns + k]; }
    float r(int j, int k) const { return distance[size_t(j) * columns + k]; }
};

/// N for M rows such that cells are about as wide as high: N = π M.
int columns_for(int rows);

/// The direction in cell (j, k) for random numbers u in the unit square, in the grid's frame.
Vec3 cell_direction(int rows, int columns, int j, int k, Vec2 u, Rows kind = Rows::cosine);

/// The luminance of a cell that alone brings a twentieth of the irradiance, if all brighter ones are lowered to it.
float excess_limit(const HemisphereSamples& samples);
/// What radiance has beyond that luminance.
Color beyond(Color radiance, float limit);
/// Lowers the radiance of cells that alone bring more than a twentieth of the irradiance to that share, and returns the
/// irradiance that was taken away. So few rays cannot tell how large a bright thing is: one record knows nothing of
/// it, many together do.
Color take_excess(HemisphereSamples& samples);

/// E = Σ L_jk times the projected solid angle of its cell, which is π / MN for all in cosine rows [Ward88].
Color irradiance(const HemisphereSamples& samples);
/// Standard error of the irradiance's luminance in units of it, from how much neighbouring cells differ: too large where
/// radiance changes smoothly, for that difference counts as noise too.
float relative_noise(const HemisphereSamples& samples);
RotationGradient rotation_gradient(const HemisphereSamples& samples);
TranslationGradient translation_gradient(const HemisphereSamples& samples);

/// No distance stays less than `least`.
void keep_off(HemisphereSamples& samples, float least);
/// Harmonic mean of the distances; a miss is infinitely far.
float harmonic_mean_distance(const HemisphereSamples& samples);
/// How far one sees: the harmonic mean over the farther half of what is met; infinite where nothing is. In a corner half of
/// the rays end close by, and through a window some go very far: neither moves it much.
float reach(const HemisphereSamples& samples);
/// The largest distance to anything that is met; 0 where nothing is.
float farthest_distance(const HemisphereSamples& samples);
/// Whether a hit with normal `there` belongs to something else than the surface of normal `here`, gone on in a curve:
/// at both ends of a chord of a circle, normals differ by twice its elevation.
bool stands_apart(Vec3 here, Vec3 direction, Vec3 there);
/// Least distance to what stands apart.
float minimum_distance(const HemisphereSamples& samples);

/// Least horizontal distance to what stands apart beside the point (up to 45° above the horizon) per sector of azimuth
/// in Frame::around(normal); infinite where nothing does.
std::array<float, 12> sector_clearance(const HemisphereSamples& samples);
/// The sector of that frame in which the tangential vector `d` points.
int clearance_sector(const Frame& frame, Vec3 d);

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light from all directions: an equirectangular image, looked up bilinearly and sampled by exactly that interpolant.
//
// The image is cut at its texel centres, not at texel borders: in such a cell the lookup is one bilinear patch between
// four texels, so a cell is chosen by its mean luminance (times the row's mean sin θ) and the place in it by the patch.
// The density is then luminance(lookup) · row factor / sin θ: zero only where the radiance is, with no bright rim
// outside of the sampled cells. Rows are half as high at both poles.

#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lights/emission_discs.h"
#include "sampling/discrete.h"

namespace eclat {

class EnvironmentImage {
  public:
    /// `rgb` is (height, width, 3), row 0 towards +y of the environment's frame, the centre column towards its −z, u
    /// growing towards +x. `to_world` is a rotation, row by row.
    /// Throws std::invalid_argument where a texel is negative or not finite, or the matrix is not orthonormal.
    EnvironmentImage(std::span<const float> rgb, uint32_t width, uint32_t height, const std::array<float, 9>& to_world);

    /// Radiance from the direction `w`.
    Color radiance(Vec3 w) const;
    float pdf_solid_angle(Vec3 w) const;
    /// Returns both at once, in the time of one.
    struct Lookup {
        Color radiance;
        float pdf_solid_angle;
    };
    Lookup lookup(Vec3 w) const;

    /// Returns the smooth part of the radiance, which gathers collect (environment_split.h). If there is no sharp part,
    /// this is all of it.
    Color smooth_radiance(Vec3 w) const;
    /// Returns an image of the sharp part, which is sampled as direct light, or nothing if there is none.
    std::optional<EnvironmentImage> sharp_part() const;

    LightSample sample(Vec2 u) const;

    /// `sample` in four steps. Each step prefetches what the next one reads, so that a caller who takes each step for
    /// many samples in turn hardly waits for memory: tables and texels of large images lie outside of the caches.
    struct Search {
        Vec2 u;
        PiecewiseConstant2D::Search among;
        PiecewiseConstant2D::Cell cell;
    };
    Search find_row(Vec2 u) const;
    void narrow(Search& search) const;
    void find_cell(Search& search) const;
    LightSample finish(const Search& search) const;
    /// A photon from a disc outside of the scene's sphere, in a direction chosen as `sample` does.
    PhotonSample emit(const EmissionDiscs& discs, Vec2 u_position, Vec2 u_direction) const;

    /// ∫ L dω, W m^-2: times the area of the scene's bounding disc it is the power.
    Color integral() const { return integral_; }

  private:
    struct Cell;
    Cell locate(Vec2 uv) const;
    Lookup between(const Cell& cell, float sine) const;
    Color texel(uint32_t x, uint32_t y) const;
    Color smooth_texel(uint32_t x, uint32_t y) const;
    template <class TexelOf>
    static Color blend(const Cell& cell, const TexelOf& texel_of);
    Vec2 to_uv(Vec3 w) const;
    void build_distribution();

    uint32_t width_, height_;
    std::vector<float> texels_;
    Vec3 x_, y_, z_;  // the environment's axes in the world
    bool constant_ = false;
    float smooth_limit_ = infinity;  // luminance beyond which radiance is sharp
    Color integral_;
    PiecewiseConstant2D cells_;      // width × (height + 1)
    std::vector<float> row_factor_;  // of a row of cells: density on the image over luminance
};

}  // namespace eclat

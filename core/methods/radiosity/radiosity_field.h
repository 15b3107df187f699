// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A radiosity solution that can be read at points; it is built once.

#pragma once

#include <optional>
#include <span>

#include "base/kd_tree.h"
#include "methods/radiosity/solve_radiosity.h"
#include "scene/surface_point.h"

namespace eclat {

class RadiosityField {
  public:
    /// Irradiance, W m⁻².
    struct Light {
        Color direct, total;

        Light scaled(float share) const { return {direct * share, total * share}; }
        Color indirect() const { return max(total - direct, Color(0.0f)); }
    };

    /// Throws std::invalid_argument where the patches are not those of the scene.
    RadiosityField(const Geometry& geometry, std::span<const SolvedPatch> patches, int threads);

    // A shading normal that bends away from the surface takes its share of the light, as of a uniform hemisphere.

    /// The light of the patch that holds the point, constant over it; nothing where there is no patch or no known light.
    struct OnPatch {
        Light light;
        float radius;  // of the patch
    };
    std::optional<OnPatch> on_patch(const SurfacePoint& point) const;

    /// Reconstructed from the patches around the point: a plane through their values, by least squares, those near by
    /// weighing most [Cleveland79]. Beside walls only those count that the point sees.
    std::optional<Light> smooth(const SurfacePoint& point) const;

  private:
    uint32_t find(const SurfacePoint& point) const;
    void find_beside(int threads);
    void drop_hidden(const SurfacePoint& point, const Disc& disc, std::vector<Neighbor>& found) const;
    Light fit(const Disc& disc, std::span<const Neighbor> found, float radius) const;

    const Geometry& geometry_;
    PatchTree tree_;
    std::vector<Light> light_;       // by node
    std::vector<uint8_t> unknown_;   // by node
    std::vector<uint8_t> beside_;    // by node: patches of unknown light are near, so that something may stand there
    KdTree centers_;                 // of patches whose light is known
    std::vector<uint32_t> node_of_;  // each place of the tree of centres
};

}  // namespace eclat

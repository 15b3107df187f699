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

    /// Throws std::invalid_argument if the patches are not those of the scene.
    RadiosityField(const Geometry& geometry, std::span<const SolvedPatch> patches, int threads);

    // A shading normal that bends away from the surface takes its share of the light, as of a uniform hemisphere.

    /// Returns the light of the patch that contains the point, or nothing if there is no patch or its light is unknown.
    struct OnPatch {
        Light light;
        float radius;  // radius of the patch
    };
    std::optional<OnPatch> on_patch(const SurfacePoint& point) const;

    /// Returns the light reconstructed from the patches around the point by a weighted least-squares plane, in which
    /// near patches have the largest weights [Cleveland79]. Beside walls only patches that the point sees are used.
    std::optional<Light> smooth(const SurfacePoint& point) const;

  private:
    uint32_t find(const SurfacePoint& point) const;
    void find_beside(int threads);
    void drop_hidden(const SurfacePoint& point, const Disc& disc, std::vector<Neighbor>& found) const;
    Light fit(const Disc& disc, std::span<const Neighbor> found, float radius) const;

    const Geometry& geometry_;
    PatchTree tree_;
    std::vector<Light> light_;       // light of each node
    std::vector<uint8_t> unknown_;   // whether the light of each node is unknown
    std::vector<uint8_t> beside_;    // whether patches of unknown light, so perhaps obstacles, are near each node
    KdTree centers_;                 // centres of the patches whose light is known
    std::vector<uint32_t> node_of_;  // node of each entry of the tree of centres
};

}  // namespace eclat

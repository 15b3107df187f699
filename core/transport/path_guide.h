// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A guide of paths: what it has learnt at places on surfaces of where light comes from, so that paths are sent there more often
// [Jensen95, Vorba14].

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/kd_tree.h"
#include "sampling/cosine_guide.h"
#include "transport/paths.h"
#include "transport/point_irradiance.h"

namespace eclat {

class PathGuide {
  public:
    /// Learns from a path with `options` in each cell of the hemisphere of each place. Light from lights counts as far as a sample
    /// of all lights leaves it to such paths. Counts places and rays in `progress`.
    PathGuide(const World& world, std::span<const PointNormal> places, const PathOptions& options, int threads,
              Progress& progress);

    /// Aims the diffuse lobes of each point by one of the nearest places on similar surfaces, if there is any. What happens to a point
    /// depends on no other.
    void aim(std::span<SurfacePoint* const> points) const;

    size_t size() const { return places_.size(); }

  private:
    struct Place {
        Vec3 position;
        Frame frame;
        CosineGuide guide;
    };
    /// What a path found.
    struct Seen {
        Vec3 direction;
        float distance;   // to its first vertex, m
        float luminance;  // W m⁻² sr⁻¹
    };

    std::vector<Seen> look_around(const World& world, uint32_t place, const PathOptions& options,
                                  Progress& progress) const;
    CosineGuide learnt_at(uint32_t place, std::span<const std::vector<Seen>> seen) const;
    /// Finds the places nearest to the middle of a disc on surfaces that are turned like it. Returns the radius that they fill.
    float nearest(const Disc& disc, size_t count, std::vector<Neighbor>& found) const;

    /// The points that have the same places around them: those in a cell of a grid whose normals are about the same.
    struct Region {
        std::array<int32_t, 3> cell{}, normal{};  // in units of `width_` and of an eighth

        bool operator==(const Region&) const = default;
    };
    static constexpr size_t choices = 3;
    /// The places among which paths from a region choose.
    struct Around {
        std::array<uint32_t, choices> places{};
        uint32_t count = 0;
        float radius = 0;  // distance at which a place is no longer chosen
    };
    float usual_width(int threads, const Progress& progress) const;
    Region region_of(Vec3 position, Vec3 normal) const;
    Around around(const Region& region) const;
    void aim(SurfacePoint& point, const Around& around) const;

    std::vector<Place> places_;  // in the order of the tree
    KdTree tree_;
    float width_ = 1;  // of the cells of regions, m
};

}  // namespace eclat

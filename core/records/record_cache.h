// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A cache of records, with the tree by which they are found. It is filled in passes and only read after that.

#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/frame.h"
#include "records/record_tree.h"
#include "records/weight.h"

namespace eclat {

struct CacheOptions {
    Weight weight = Weight::tabellion;
    float relaxation = 2;  // factor on a record's radius when it is read
    bool rotation_gradient = true;
    bool translation_gradient = true;
    bool neighbor_clamping = true;
};

/// The test whether records that reach each other disagree.
struct Disagreement {
    /// Distances in units of a record's radius.
    struct Reach {
        float placed;  // distance up to which no other record is placed
        float read;    // distance up to which the record is read
    };

    /// Returns the error of record `from` at the position of record `at`, in units of the tolerated error.
    std::function<float(uint32_t from, uint32_t at)> error;
    /// Returns the reach for values that are read at the position of record `at`.
    std::function<Reach(uint32_t at)> reach;
};

class RecordCache {
  public:
    RecordCache() = default;
    explicit RecordCache(const CacheOptions& options) : options_(options) {}

    /// Adds records in the given order, clamps the radii of neighbours and rebuilds the tree.
    void insert(std::span<const IrradianceRecord> records, float spacing, int threads);

    /// If two records that reach each other differ by more than `tolerance` of the irradiance, beyond what their noise
    /// explains, the radius of the worse one shrinks until they no longer do [Krivanek06]. The radii of neighbours are
    /// then clamped again. The next pass adds records where the radius has become too small. Returns how many records
    /// shrank.
    size_t shrink_where_records_disagree(float tolerance, float spacing, int threads);
    /// Does the same with another measure of the error.
    size_t shrink_where_records_disagree(const Disagreement& disagreement, float spacing, int threads);
    /// Returns the excess irradiance of record i, averaged over the records around it.
    Color shared_excess(uint32_t i) const { return members_[slot_of_[i]].excess; }

    // Normals are geometric in these functions, because bump maps tilt only the shading normal, not the surface on
    // which the records lie.

    /// Returns whether a record is valid at the point by the strict test, which decides where records are placed.
    bool serves(Vec3 p, Vec3 normal) const;
    /// Returns the indirect irradiance at `p`, extrapolated to the normal of `shading` by the rotation gradient, or
    /// nothing if no record serves the point. `mean_radius` is set to the mean radius of the records that do.
    std::optional<Color> interpolate(Vec3 p, Vec3 normal, Vec3 shading, float* mean_radius = nullptr) const;
    /// Calls `f(record, weight, excess)` for each record that serves the point if its radius is multiplied by `reach`,
    /// which is at most the relaxation. The order does not depend on the number of threads. `excess` is the mean over
    /// the surrounding records.
    template <class F>
    void for_each_serving(Vec3 p, Vec3 normal, float reach, F&& f) const {
        for_each_weight(p, normal, reach, 0,
                        [&](uint32_t slot, float w) { f(tree_.order()[slot], w, members_[slot].excess); });
    }
    /// Returns the mean noise of the records whose relaxed radii reach the point, or nothing if there is none.
    std::optional<float> noise_around(Vec3 p, Vec3 normal) const;
    /// Returns the sum of the weights at the point, which measures the density of records.
    float density(Vec3 p, Vec3 normal) const;

    /// Returns the mean luminance of the records' irradiance, or 0 if there are no records.
    float mean_luminance() const { return mean_luminance_; }

    const std::vector<IrradianceRecord>& records() const { return records_; }
    const CacheOptions& options() const { return options_; }

  private:
    /// Calls `f(slot, weight)` for each record whose sphere is closer than `around`, which reaches the point with that
    /// `relaxation`, and between which and the point there is no geometry.
    template <class F>
    void for_each_footing(Vec3 p, Vec3 n, float relaxation, float around, F&& f) const {
        static_assert(Footings::count == SphereTree::width);
        tree_.for_each_leaf_near(p, around, [&](uint32_t leaf) {
            float weights[Footings::count];
            footings_[leaf].weights(p, n, options_.weight, relaxation, weights);
            for_each_lane(lanes_where([&](uint32_t i) { return weights[i] > 0; }), [&](uint32_t i) {
                const uint32_t slot = leaf * SphereTree::width + i;
                if (!out_of_sight(footings_[leaf], i, slot, p)) f(slot, weights[i]);
            });
        });
    }
    /// Does the same without records inside solids, which are never read.
    template <class F>
    void for_each_weight(Vec3 p, Vec3 n, float relaxation, float around, F&& f) const {
        for_each_footing(p, n, relaxation, around, [&](uint32_t slot, float w) {
            if (!footings_[slot / SphereTree::width].enclosed[slot % SphereTree::width]) f(slot, w);
        });
    }
    /// Returns the weight with which the record is read at the point.
    float weight_of(uint32_t slot, Vec3 p, Vec3 n, float relaxation) const {
        const Footings& footings = footings_[slot / SphereTree::width];
        const uint32_t i = slot % SphereTree::width;
        const float w = weight(footings[i], p, n, options_.weight, relaxation);
        return w > 0 && !footings.enclosed[i] && !out_of_sight(footings, i, slot, p) ? w : 0;
    }
    /// Returns whether geometry lies between the record and the point. Most points are closer to the record than any
    /// geometry.
    bool out_of_sight(const Footings& footings, uint32_t i, uint32_t slot, Vec3 p) const {
        if (options_.weight == Weight::split_sphere) return false;
        const float x = p.x - footings.position[0][i], y = p.y - footings.position[1][i],
                    z = p.z - footings.position[2][i];
        return x * x + y * y + z * z > sqr(footings.clearance[i]) && obstructed(slot, p);
    }
    bool obstructed(uint32_t slot, Vec3 p) const;
    void rebuild(float spacing, int threads);
    void clamp_to_neighbors(float spacing, int threads);
    void share_excess(int threads);
    /// What the turn from the geometric to the shading normal does to irradiance, and the geometric normal.
    struct Bend {
        Vec3 normal;
        float even;   // the share that is kept of what a uniform hemisphere brings
        Vec3 turn{};  // what the rotation gradient is multiplied with, rad

        Bend(Vec3 normal, Vec3 shading);
    };
    /// What interpolation reads of a record: two lines of a processor's cache.
    struct alignas(64) Member {
        Vec3 position, normal;
        Color irradiance, excess;  // the excess is the mean around the record, W·m⁻²
        RotationGradient rotation;
        TranslationGradient translation;
        float radius = 0;
    };
    static_assert(sizeof(Member) == 128);
    /// The clearance of a record's sectors, and the axes from which they are counted.
    struct Sectors {
        Frame frame;
        std::array<float, 12> clearance{};
    };
    Color extrapolate(const Member& member, Vec3 p, const Bend& bend) const;
    const Member& member_of(uint32_t record) const { return members_[slot_of_[record]]; }

    CacheOptions options_;
    std::vector<IrradianceRecord> records_;
    float mean_luminance_ = 0;
    SphereTree tree_;
    std::vector<Footings> footings_;  // positions and reaches of the records in each leaf of the tree
    // These are in the order of the tree's slots, so that neighbours in space are neighbours in memory.
    std::vector<Member> members_;
    std::vector<Sectors> sectors_;
    std::vector<float> excess_noise_;  // standard error of the luminance of each member's excess
    std::vector<uint32_t> slot_of_;    // slot of each record in the tree
};

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Records with the tree that finds them. A cache is filled in passes and then only read.

#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "records/record_tree.h"
#include "records/weight.h"

namespace eclat {

struct CacheOptions {
    Weight weight = Weight::tabellion;
    float relaxation = 2;  // of a record's radius when it is read
    bool rotation_gradient = true;
    bool translation_gradient = true;
    bool neighbor_clamping = true;
};

/// How records that reach each other are found to disagree.
struct Disagreement {
    /// In units of a record's radius.
    struct Reach {
        float placed;  // how far it keeps others from being placed
        float read;    // how far it is read
    };

    /// How many times more than is tolerated record `from` errs at the place of record `at`.
    std::function<float(uint32_t from, uint32_t at)> error;
    /// For what is read at the place of record `at`.
    std::function<Reach(uint32_t at)> reach;
};

class RecordCache {
  public:
    RecordCache() = default;
    explicit RecordCache(const CacheOptions& options) : options_(options) {}

    /// Adds records in the order given, clamps neighbours and rebuilds the tree.
    void insert(std::span<const IrradianceRecord> records, float spacing, int threads);

    /// Where two records that reach each other disagree by more than `tolerance` of what is there, beyond what their noise
    /// explains, the worse one's radius shrinks to where it would not [Krivanek06]; then neighbours are clamped again. What
    /// it no longer serves is up to the next pass. Returns how many shrank.
    size_t shrink_where_records_disagree(float tolerance, float spacing, int threads);
    /// The same by any measure of error.
    size_t shrink_where_records_disagree(const Disagreement& disagreement, float spacing, int threads);
    /// What record i shares with its surroundings of the irradiance in excess.
    Color shared_excess(uint32_t i) const { return shared_excess_[slot_of_[i]]; }

    // Normals here are geometric: a bump tilts what a point looks at, not where its records lie.

    /// Whether a record is valid at the point, by the strict test that decides where records are placed.
    bool serves(Vec3 p, Vec3 normal) const;
    /// Indirect irradiance at `p`, turned by the rotation gradient to the normal of `shading`; nothing where no record
    /// serves it. `mean_radius`: of those that do.
    std::optional<Color> interpolate(Vec3 p, Vec3 normal, Vec3 shading, float* mean_radius = nullptr) const;
    /// `f(record, weight, excess)` for each record whose radius times `reach`, at most the relaxation, serves the point, in an
    /// order that does not depend on threads; `excess` is what it shares with its surroundings.
    template <class F>
    void for_each_serving(Vec3 p, Vec3 normal, float reach, F&& f) const {
        for_each_weight(p, normal, reach, 0,
                        [&](uint32_t slot, float w) { f(tree_.order()[slot], w, shared_excess_[slot]); });
    }
    /// Mean noise of the gathers whose records, relaxed, reach the point; nothing where none does.
    std::optional<float> noise_around(Vec3 p, Vec3 normal) const;
    /// Sum of the weights there: the density of records.
    float density(Vec3 p, Vec3 normal) const;

    /// Mean luminance of the records' irradiance; 0 without records.
    float mean_luminance() const { return mean_luminance_; }

    const std::vector<IrradianceRecord>& records() const { return records_; }
    const CacheOptions& options() const { return options_; }

  private:
    /// `f(slot, weight)` for each record that reaches the point with that `relaxation` and from which nothing stands in the way,
    /// among those whose spheres are closer than `around`.
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
    /// The same without those in solids: what is read there.
    template <class F>
    void for_each_weight(Vec3 p, Vec3 n, float relaxation, float around, F&& f) const {
        for_each_footing(p, n, relaxation, around, [&](uint32_t slot, float w) {
            if (!footings_[slot / SphereTree::width].enclosed[slot % SphereTree::width]) f(slot, w);
        });
    }
    /// With what weight the record is read there.
    float weight_of(uint32_t slot, Vec3 p, Vec3 n, float relaxation) const {
        const Footings& footings = footings_[slot / SphereTree::width];
        const uint32_t i = slot % SphereTree::width;
        const float w = weight(footings[i], p, n, options_.weight, relaxation);
        return w > 0 && !footings.enclosed[i] && !out_of_sight(footings, i, slot, p) ? w : 0;
    }
    /// Whether geometry stands between the record and the point; most are closer than any geometry.
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
    Color extrapolate(const IrradianceRecord& record, Vec3 p, Vec3 shading) const;

    CacheOptions options_;
    std::vector<IrradianceRecord> records_;
    float mean_luminance_ = 0;
    SphereTree tree_;
    std::vector<Footings> footings_;    // of the records, for each of the tree's leaves
    std::vector<Color> shared_excess_;  // of each record's surroundings, in the tree's slots
    std::vector<uint32_t> slot_of_;     // each record's
};

}  // namespace eclat

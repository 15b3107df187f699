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
        tree_.for_each_around(p, [&](uint32_t slot, float d2) {
            const float w = weight_of(slot, p, normal, d2, reach);
            if (w > 0) f(tree_.order()[slot], w, shared_excess_[slot]);
        });
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
    /// How far the record reaches there; 0 also where geometry stands between them.
    float footing_at(uint32_t slot, Vec3 p, Vec3 n, float distance2, float relaxation) const;
    /// With what weight it is read there.
    float weight_of(uint32_t slot, Vec3 p, Vec3 n, float distance2, float relaxation) const;
    void rebuild(float spacing, int threads);
    void clamp_to_neighbors(float spacing, int threads);
    void share_excess(int threads);
    Color extrapolate(const IrradianceRecord& record, Vec3 p, Vec3 shading) const;

    CacheOptions options_;
    std::vector<IrradianceRecord> records_;
    float mean_luminance_ = 0;
    SphereTree tree_;
    std::vector<Footing> footings_;     // of the records, in the tree's slots
    std::vector<Color> shared_excess_;  // of each record's surroundings, in the tree's slots
    std::vector<uint32_t> slot_of_;     // each record's
};

}  // namespace eclat

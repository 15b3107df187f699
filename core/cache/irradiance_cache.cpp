// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "cache/irradiance_cache.h"

#include <algorithm>

#include "base/parallel.h"
#include "cache/hemisphere.h"

namespace eclat {

void RecordCache::insert(std::span<const IrradianceRecord> records, float spacing, int threads) {
    records_.insert(records_.end(), records.begin(), records.end());
    if (options_.neighbor_clamping) clamp_to_neighbors(spacing, threads);
    std::vector<SphereTree::Sphere> spheres;
    spheres.reserve(records_.size());
    for (const auto& r : records_) spheres.push_back({r.position, r.radius * r.elongation * options_.relaxation});
    tree_ = SphereTree(spheres);
    footings_.clear();
    for (uint32_t i : tree_.order()) {
        if (i == SphereTree::vacant) {
            footings_.push_back({});
            continue;
        }
        const IrradianceRecord& r = records_[i];
        const float nearest = *std::min_element(r.clearance.begin(), r.clearance.end());
        const Frame frame = Frame::around(r.normal);
        const Vec3 axis = frame.u * std::cos(r.axis) + frame.v * std::sin(r.axis);
        footings_.push_back({r.position, r.radius, r.normal, nearest, axis * safe_sqrt(1 - 1 / sqr(r.elongation))});
    }
    share_excess(threads);
    double sum = 0;
    for (const auto& r : records_) sum += luminance(r.irradiance);
    mean_luminance_ = static_cast<float>(sum / static_cast<double>(std::max<size_t>(1, records_.size())));
}

// Each record reads the weighted mean of what its wider surroundings found in excess: the sum of all stays about the same,
// its noise falls with their number.
void RecordCache::share_excess(int threads) {
    constexpr float surroundings = 4;  // in units of a record's radius
    const auto& order = tree_.order();
    shared_excess_ = parallel_map<Color>(order.size(), threads, [&](size_t slot) {
        Color sum;
        float weights = 0;
        if (order[slot] == SphereTree::vacant) return sum;
        const Footing& here = footings_[slot];
        tree_.for_each_near(here.position, surroundings * here.radius, [&](uint32_t other, float d2) {
            const float w = weight_of(other, here.position, here.normal, d2, surroundings);
            sum += records_[order[other]].excess * w;
            weights += w;
        });
        return sum * (1 / weights);
    });
}

std::optional<float> RecordCache::noise_around(Vec3 p, Vec3 normal) const {
    float sum = 0, weights = 0;
    tree_.for_each_around(p, [&](uint32_t slot, float d2) {
        const float w = weight_of(slot, p, normal, d2, options_.relaxation);
        if (w <= 0) return;
        sum += records_[tree_.order()[slot]].noise * w;
        weights += w;
    });
    if (weights == 0) return std::nullopt;
    return sum / weights;
}

float RecordCache::weight_of(uint32_t slot, Vec3 p, Vec3 n, float distance2, float relaxation) const {
    const Footing& footing = footings_[slot];
    const float w = weight(footing, p, n, options_.weight, relaxation);
    if (w <= 0 || distance2 <= sqr(footing.clearance)) return w;
    // The lower bound of the radius may reach through a thin wall: what stands in that direction ends the validity.
    const int sector = clearance_sector(Frame::around(footing.normal), p - footing.position);
    return distance2 <= sqr(records_[tree_.order()[slot]].clearance[sector]) ? w : 0;
}

// Distances to geometry cannot change faster than position, so R_i ≤ R_j + |P_i − P_j| for all pairs [Krivanek06].
// What one record sees in a gap reaches its neighbours. One round over the unclamped distances is exact: by the triangle
// inequality a chain of clamps is never shorter than the direct one.
void RecordCache::clamp_to_neighbors(float spacing, int threads) {
    std::vector<SphereTree::Sphere> points;
    for (const auto& r : records_) points.push_back({r.position, 0});
    const SphereTree tree(points);
    const auto& order = tree.order();
    const auto clamped = parallel_map<float>(records_.size(), threads, [&](size_t i) {
        const IrradianceRecord& record = records_[i];
        float distance = record.distance;
        // A neighbour at distance d can only matter if d < R_i − R_j < R_i, and no farther than the upper bound lets
        // the radius reach.
        const float reach = std::min(distance, record.largest_radius / spacing);
        tree.for_each_near(record.position, reach, [&](uint32_t slot, float d2) {
            distance = std::min(distance, records_[order[slot]].distance + std::sqrt(d2));
        });
        return distance;
    });
    for (size_t i = 0; i < records_.size(); ++i) {
        IrradianceRecord& r = records_[i];
        r.radius = clamp(spacing * clamped[i], r.least_radius, r.largest_radius);
    }
}

bool RecordCache::serves(Vec3 p, Vec3 normal) const {
    bool served = false;
    tree_.for_each_around(p,
                          [&](uint32_t slot, float d2) { served = served || weight_of(slot, p, normal, d2, 1) > 0; });
    return served;
}

float RecordCache::density(Vec3 p, Vec3 normal) const {
    float sum = 0;
    tree_.for_each_around(p, [&](uint32_t slot, float d2) { sum += weight_of(slot, p, normal, d2, 1); });
    return sum;
}

Color RecordCache::extrapolate(const IrradianceRecord& record, Vec3 p, Vec3 shading) const {
    Color E = record.irradiance;
    const Vec3 turn = cross(record.normal, shading), shift = p - record.position;
    for (int c = 0; c < 3; ++c) {
        const float value = E[c];  // both gradients, first order [WardHeckbert92]
        float change = 0;
        if (options_.rotation_gradient) change += dot(turn, record.rotation.channel[c]);
        if (options_.translation_gradient) change += dot(shift, record.translation.channel[c]);
        E[c] = clamp(value + change, 0.05f * value, 20 * value);  // no farther than it is plausible
    }
    return E;
}

std::optional<Color> RecordCache::interpolate(Vec3 p, Vec3 normal, Vec3 shading, float* mean_radius) const {
    Color sum;
    float weights = 0, radii = 0;
    tree_.for_each_around(p, [&](uint32_t slot, float d2) {
        const float w = weight_of(slot, p, normal, d2, options_.relaxation);
        if (w <= 0) return;
        sum += (extrapolate(records_[tree_.order()[slot]], p, shading) + shared_excess_[slot]) * w;
        weights += w;
        radii += w * footings_[slot].radius;
    });
    if (weights == 0) return std::nullopt;  // a miss, not darkness
    if (mean_radius) *mean_radius = radii / weights;
    return sum / weights;
}

}  // namespace eclat

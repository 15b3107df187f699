// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance between records is a weighted mean of what each record extrapolates to the point [WardHeckbert92],
//   E(P) = Σ w_i (E_i + (n_i × n) · ∇_r E_i + (P − P_i) · ∇_t E_i + X_i) / Σ w_i ,
// where X_i is what a plane through the excess of the gathers around the record has there, less half of the covariance of
// gradients and ways,
//   ½ [ Σ w_i (P − P_i) · ∇_t E_i / Σ w_i − (Σ w_i (P − P_i) / Σ w_i) · (Σ w_i ∇_t E_i / Σ w_i) ] ,
// which is what tangents to a bent field leave out (records/bending.h). A bump or a smooth normal that bends n to s, by an
// angle α, turns each term into
//   (1 + cos α) / 2 · E + (1 − α / π) (n × s) · ∇_r E .
// Inserting records may shrink others: a neighbour that is closer to an obstacle, or that disagrees, shows that a record
// reaches too far [Krivanek06].
//
// Symbol       name here              meaning                                                          unit
//   P, n       p, normal              the point and its geometric normal
//   s          shading                its shading normal
//   P_i, n_i   position, normal       those of record i
//   E_i        irradiance             irradiance there, without excess                                 W m⁻²
//   X_i        member.excess          excess, shared with surroundings                                 W m⁻²
//   ∇_r, ∇_t   rotation, translation  gradients by turning (W m⁻² rad⁻¹) and by moving (W m⁻³)
//   w_i        weight_of              weight, records/weight.h                                         1
//   R_i        distance               the length that the radius follows, records/spacing.cpp          m
//   κ          relaxation             how much farther a record is read than it keeps others away      1
//
// References   [WardHeckbert92], [KraaijpoelLeeuwen10] half of the first order, [Tabellion04] strict and relaxed tests,
//              [Krivanek06] neighbour clamping, disagreement
// Departures   Neighbours are clamped in one exact round over all records instead of whenever one is inserted, so that the
//              order of records does not matter. Extrapolation is bounded. Bends are integrated, see `Bend`.
// Held to      tests/core/records/test_record_cache.cpp

#include "records/record_cache.h"

#include <algorithm>

#include "base/parallel.h"
#include "hemisphere/hemisphere.h"
#include "records/bending.h"
#include "records/local_plane.h"
#include "scene/surface_point.h"

namespace eclat {

namespace {

// These factors are the ones that Radiance uses. A larger change is due to a record that is read too far away and not to a
// real change of the light. Tighter bounds would cut off real penumbrae; without bounds, a gradient could make the
// irradiance negative or cause a bright spot.
constexpr float least_change = 0.05f, most_change = 20;

}  // namespace

// Rays above the surface that lie below s bring no light. For radiance that is linear in direction, L = a + b · ω, the integral
// over the others has the form above: of what a brings the share (1 − cos α) / 2 is lost, of what b brings α / π.
RecordCache::Bend::Bend(Vec3 normal, Vec3 shading) : normal(normal), even(even_share(normal, shading)) {
    if (shading == normal) return;
    turn = cross(normal, shading) * (1 - std::acos(clamp(dot(normal, shading), -1, 1)) * inv_pi);
}

void RecordCache::insert(std::span<const IrradianceRecord> records, float spacing, int threads) {
    records_.insert(records_.end(), records.begin(), records.end());
    rebuild(spacing, threads);
}

void RecordCache::rebuild(float spacing, int threads) {
    if (options_.neighbor_clamping) clamp_to_neighbors(spacing, threads);
    std::vector<SphereTree::Sphere> spheres;
    spheres.reserve(records_.size());
    for (const auto& r : records_) {
        const float reach = r.radius * r.elongation * options_.relaxation;
        spheres.push_back({r.position, reach, r.normal, height_read(r.radius, reach, options_.weight)});
    }
    tree_ = SphereTree(spheres);
    const auto& order = tree_.order();
    footings_.assign(order.size() / SphereTree::width, {});
    members_.assign(order.size(), {});
    sectors_.assign(order.size(), {});
    slot_of_.resize(records_.size());
    for (uint32_t slot = 0; slot < order.size(); ++slot) {
        if (order[slot] == SphereTree::vacant) continue;
        slot_of_[order[slot]] = slot;
        const IrradianceRecord& r = records_[order[slot]];
        const float nearest = *std::min_element(r.clearance.begin(), r.clearance.end());
        const Frame frame = Frame::around(r.normal);
        const Vec3 axis = frame.u * std::cos(r.axis) + frame.v * std::sin(r.axis);
        const Vec3 stretch = axis * safe_sqrt(1 - 1 / sqr(r.elongation));
        footings_[slot / SphereTree::width].set(
            slot % SphereTree::width, {r.position, r.radius, r.normal, nearest, stretch, spacing, r.enclosed > 0});
        members_[slot] = {r.position, r.normal, r.irradiance, {}, r.rotation, r.translation, r.radius};
        sectors_[slot] = {frame, r.clearance};
    }
    share_excess(threads);
    double sum = 0, read = 0;
    for (const auto& r : records_) {
        if (r.enclosed > 0) continue;
        sum += luminance(r.irradiance);
        ++read;
    }
    mean_luminance_ = static_cast<float>(sum / std::max(1.0, read));
}

// Each record gets the excess that the records around it give, so that its noise decreases with their number. It is read from a
// plane through them: their mean belongs to the middle of the neighbourhood, and wide records on one side, or the border of a face,
// put that beside the record. Upper walls beside a window took the light of wide records below them so, and were 12 % too bright
// in the light that far records give. The width of the neighbourhood depends on the noise of all of them and not on that of the
// record alone, because a record whose rays missed the bright object estimates no noise.
void RecordCache::share_excess(int threads) {
    // These are chosen by judgement: wider neighbourhoods blur bright spots, and narrower ones leave splotches.
    constexpr float widest = 4, narrowest = 0.5f;  // widths of the neighbourhood in units of a record's radius
    constexpr float noisiest = 0.1f;  // noise relative to the irradiance at which the neighbourhood is widest
    const auto& order = tree_.order();
    excess_noise_.assign(order.size(), 0);
    parallel_for(order.size(), threads, [&](size_t slot) {
        if (order[slot] == SphereTree::vacant || records_[order[slot]].enclosed > 0) return;
        const IrradianceRecord& here = records_[order[slot]];
        const auto for_each_in = [&](float surroundings, auto&& f) {
            for_each_weight(here.position, here.normal, surroundings, surroundings * here.radius,
                            [&](uint32_t other, float w) { f(records_[order[other]], w); });
        };
        float noise = 0, light = 0;
        for_each_in(widest, [&](const IrradianceRecord& r, float w) {
            noise += r.excess_noise * w;
            light += luminance(r.irradiance + r.excess) * w;
        });
        if (!(noise > 0)) {
            members_[slot].excess = here.excess;
            return;
        }
        struct Sharer {
            const IrradianceRecord* record;
            float weight;
        };
        std::vector<Sharer> sharers;
        LocalPlane plane(Frame::around(here.normal));
        for_each_in(clamp(widest * noise / (noisiest * light), narrowest, widest),
                    [&](const IrradianceRecord& r, float w) {
                        plane.add(r.position - here.position, w);
                        sharers.push_back({&r, w});
                    });
        plane.fit();
        Color sum;
        float squares = 0;
        for (const auto& [record, weight] : sharers) {
            const float share = plane.share(record->position - here.position, weight);
            sum += record->excess * share;
            squares += sqr(record->excess_noise * share);
        }
        members_[slot].excess = sum;
        excess_noise_[slot] = std::sqrt(squares);
    });
}

std::optional<float> RecordCache::noise_around(Vec3 p, Vec3 normal) const {
    float sum = 0, weights = 0;
    for_each_weight(p, normal, options_.relaxation, 0, [&](uint32_t slot, float w) {
        sum += records_[tree_.order()[slot]].noise * w;
        weights += w;
    });
    if (weights == 0) return std::nullopt;
    return sum / weights;
}

bool RecordCache::obstructed(uint32_t slot, Vec3 p) const {
    // The lower bound of the radius may extend through a thin wall, so geometry in the direction of the point ends the
    // validity of the record.
    const Sectors& sectors = sectors_[slot];
    const Vec3 d = p - members_[slot].position;
    return length_squared(d) > sqr(sectors.clearance[clearance_sector(sectors.frame, d)]);
}

// Distances to geometry cannot change faster than position, so R_i ≤ R_j + |P_i − P_j| for all pairs [Krivanek06].
// An obstacle that only one record sees thereby limits its neighbours too, but not those on the other side of the same
// sheet or wall, which see the other half of the world. One round over the unclamped distances is exact, because by the
// triangle inequality a chain of clamps never gives a smaller radius than the direct clamp.
void RecordCache::clamp_to_neighbors(float spacing, int threads) {
    // Chosen by judgement: faces that share an edge mostly see the same room.
    constexpr float other_side = -0.5f;  // cosine of 120°
    std::vector<SphereTree::Sphere> points;
    for (const auto& r : records_) points.push_back({r.position, 0});
    const SphereTree tree(points);
    const auto& order = tree.order();
    const auto clamped = parallel_map<float>(records_.size(), threads, [&](size_t i) {
        const IrradianceRecord& record = records_[i];
        float distance = record.distance;
        // A neighbour at distance d has an effect only if d < R_i − R_j < R_i, and if d is below the upper bound of the
        // radius.
        const float reach = std::min(distance, record.largest_radius / spacing);
        tree.for_each_near(record.position, reach, [&](uint32_t slot, float d2) {
            const IrradianceRecord& other = records_[order[slot]];
            if (other.enclosed == 0 && dot(record.normal, other.normal) > other_side)
                distance = std::min(distance, other.distance + std::sqrt(d2));
        });
        return distance;
    });
    for (size_t i = 0; i < records_.size(); ++i) {
        IrradianceRecord& r = records_[i];
        r.radius = clamp(spacing * clamped[i], r.least_radius, r.largest_radius);
    }
}

size_t RecordCache::shrink_where_records_disagree(float tolerance, float spacing, int threads) {
    constexpr float deviations = 2;  // noise explains smaller differences with a probability of 95 %
    // Returns the standard error of the luminance that is read at a record, W·m⁻². A record whose rays missed the bright
    // object estimates no noise, but the records around it may.
    const auto noise = [&](uint32_t record) {
        return std::max(records_[record].own_noise * luminance(records_[record].irradiance + shared_excess(record)),
                        excess_noise_[slot_of_[record]]);
    };
    const auto error = [&](uint32_t from, uint32_t at) {
        const Member &a = member_of(from), &b = member_of(at);
        const float there = luminance(b.irradiance + b.excess);
        const float read = luminance(extrapolate(a, b.position, Bend(b.normal, b.normal)) + a.excess);
        // The lower bound is that of the error measure.
        const float unit = std::sqrt(sqr(there) + sqr(0.1f * mean_luminance_));
        const float explained = deviations * std::sqrt(sqr(noise(from)) + sqr(noise(at)));
        return std::fabs(read - there) / (explained + tolerance * unit);
    };
    const auto reach = [&](uint32_t) { return Disagreement::Reach{1, options_.relaxation}; };
    return shrink_where_records_disagree({error, reach}, spacing, threads);
}

// The value of a record at its own position is not extrapolated, so the extrapolations of its neighbours are compared
// with it there. The error of a first-order extrapolation increases with the square of the distance. It is therefore
// equal to the tolerated error at a distance that is shorter by the square root of the ratio of the errors.
size_t RecordCache::shrink_where_records_disagree(const Disagreement& disagreement, float spacing, int threads) {
    const auto& order = tree_.order();
    // The result is 0 if record `from` does not reach the other one.
    const auto error = [&](uint32_t from, uint32_t at) {
        const IrradianceRecord& b = records_[at];
        if (b.enclosed > 0 || weight_of(slot_of_[from], b.position, b.normal, disagreement.reach(at).read) <= 0)
            return 0.0f;
        return disagreement.error(from, at);
    };
    const auto distances = parallel_map<float>(records_.size(), threads, [&](size_t i) {
        const auto here = static_cast<uint32_t>(i);
        float distance = records_[i].distance;
        const float reach = records_[i].radius * records_[i].elongation * options_.relaxation;
        tree_.for_each_near(records_[i].position, reach, [&](uint32_t slot, float d2) {
            const uint32_t other = order[slot];
            if (other == here) return;
            const float mine = error(here, other);
            if (mine <= 1 || mine < error(other, here)) return;
            distance = std::min(distance, std::sqrt(d2 / mine) / (spacing * disagreement.reach(other).placed));
        });
        return distance;
    });
    size_t shrunk = 0;
    for (size_t i = 0; i < records_.size(); ++i) {
        // A radius at its lower bound cannot shrink further.
        shrunk += distances[i] < records_[i].distance && records_[i].radius > records_[i].least_radius;
        IrradianceRecord& r = records_[i];
        r.distance = distances[i];
        r.radius = std::min(r.radius, clamp(spacing * r.distance, r.least_radius, r.largest_radius));
    }
    if (shrunk > 0) rebuild(spacing, threads);
    return shrunk;
}

bool RecordCache::serves(Vec3 p, Vec3 normal) const {
    bool served = false;
    for_each_footing(p, normal, 1, 0, [&](uint32_t, float) { served = true; });
    return served;
}

float RecordCache::density(Vec3 p, Vec3 normal) const {
    float sum = 0;
    for_each_weight(p, normal, 1, 0, [&](uint32_t, float w) { sum += w; });
    return sum;
}

Color RecordCache::extrapolate(const Member& member, Vec3 p, const Bend& bend) const {
    Color E = member.irradiance;
    const Vec3 turn = cross(member.normal, bend.normal) * bend.even + bend.turn, shift = p - member.position;
    for (int c = 0; c < 3; ++c) {
        const float value = E[c];  // first-order extrapolation with both gradients [WardHeckbert92]
        float bent = value;
        if (options_.translation_gradient) bent += dot(shift, member.translation.channel[c]);
        bent *= bend.even;
        if (options_.rotation_gradient) bent += dot(turn, member.rotation.channel[c]);
        E[c] = clamp(bent, least_change * value, most_change * value);
    }
    return E;
}

std::optional<Color> RecordCache::interpolate(Vec3 p, Vec3 normal, Vec3 shading, float* mean_radius) const {
    Color sum;
    float weights = 0, radii = 0;
    Bending bending;
    const Bend bend(normal, shading);
    for_each_weight(p, normal, options_.relaxation, 0, [&](uint32_t slot, float w) {
        const Member& member = members_[slot];
        sum += (extrapolate(member, p, bend) + member.excess * bend.even) * w;
        weights += w;
        radii += w * member.radius;
        bending.add(member.translation, p - member.position, w);
    });
    if (weights == 0) return std::nullopt;  // no record serves the point, which does not mean that it is dark
    if (mean_radius) *mean_radius = radii / weights;
    // The plane through the excess around a record may be below 0 there.
    const Color first_order = max(sum / weights, Color());
    if (!options_.translation_gradient) return first_order;
    Color out;
    for (int c = 0; c < 3; ++c)
        out[c] = clamp(first_order[c] - 0.5f * bend.even * bending.covariance(c), least_change * first_order[c],
                       most_change * first_order[c]);
    return out;
}

}  // namespace eclat

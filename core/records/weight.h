// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// How much a record counts at a point: 1 at the record, falling to 0 at the border of its validity, so that no border
// shows. `relaxation` ≥ 1 widens the radius, and the turn a little: records are placed by a strict test and read by a relaxed
// one.

#pragma once

#include "base/lanes.h"
#include "records/record.h"

namespace eclat {

enum class Weight : uint8_t {
    tabellion,  // the larger of the errors of distance and turn, squared to end smoothly [Tabellion04]
    ward,       // the inverse of their sum, shifted to end at 0
    split_sphere,  // the same as published [Ward88]: the tolerance of turns grows with that of distances, and only what lies
                   // behind a record is refused. For comparisons: it leaks.
};

namespace detail {
// √(1 − cos 10°): a normal that differs by 10° keeps others from being placed [Tabellion04].
constexpr float sqrt_one_minus_cos_10 = 0.12326f;
// Reading stretches that to at most 0.2 rad [Schwarzhaupt12]: what rises over the horizon is not known, and a bevel's record
// must not be read on the faces beside it.
constexpr float largest_turn = 1.146f;
inline float tolerated_turn(float relaxation) { return sqrt_one_minus_cos_10 * std::min(relaxation, largest_turn); }
// How far behind or before a record's plane a point may lie beyond what the turn of the normal explains, as a part of the
// record's radius, and no farther when it is read. Behind a panel that hangs close below it the ceiling takes the light of
// the panel's front: up to records as wide as 25 gaps at 0.04, as 66 at this.
constexpr float plane_tolerance = 0.015f;
}  // namespace detail

/// How far from its plane a record may be read, at most, of points within `reach` of it: the tolerance, and what normals that
/// differ by the most that is tolerated explain. See `weight`.
inline float height_read(float radius, float reach, Weight kind) {
    if (kind == Weight::split_sphere) return infinity;
    constexpr float sine = 0.2f;  // of the largest turn
    return detail::plane_tolerance * radius + sine * reach;
}

/// Where a record lies and how far it reaches: all that its weight depends on.
struct Footing {
    Vec3 position;
    float radius;
    Vec3 normal;
    float clearance;        // the least of the record's sectors
    Vec3 stretch{};         // along the long axis, of length √(1 − (R1/R2)²): lengths are measured shorter there
    float tolerance = 0;    // the split sphere's a: its radius is a R
    bool enclosed = false;  // in a solid: it keeps other records away, and is not read
};

/// Ward's weight without our guards [Ward88].
inline float split_sphere_weight(const Footing& record, Vec3 p, Vec3 n, float relaxation) {
    const Vec3 d = p - record.position;
    const float distance = length(d), turn = safe_sqrt(1 - dot(n, record.normal));
    const float e = (distance / record.radius + turn / record.tolerance) / relaxation;
    // Behind the record by the mean of both normals, beyond rounding.
    if (e >= 1 || dot(d, n + record.normal) < -1e-3f * record.radius) return 0;
    return 1 / std::max(e, 1e-3f) - 1;
}

/// 0 where the record does not serve the point. Free of branches, so that compilers look at many records at once.
inline float weight(const Footing& record, Vec3 p, Vec3 n, Weight kind, float relaxation) {
    if (kind == Weight::split_sphere) return split_sphere_weight(record, p, n, relaxation);
    // Normals that differ by more than the tolerance end the validity under both weights.
    const float cosine = dot(n, record.normal);
    const float tolerated = detail::tolerated_turn(relaxation);
    const Vec3 d = p - record.position;
    const float reach = record.radius * relaxation;
    // An ellipse in the record's plane with the small radius off it [Schwarzhaupt12].
    const float distance2 = length_squared(d) - sqr(dot(d, record.stretch));
    const bool near = (1 - cosine < sqr(tolerated)) & (distance2 < reach * reach);
    const float e_position = std::sqrt(std::max(0.0f, distance2)) / reach;
    const float turn = safe_sqrt(1 - cosine);
    // The point must lie in the record's plane, by the mean of both normals: what is behind one sees what the other
    // cannot [Ward88]. On a sphere that mean is at right angles to the chord; across an edge between two facets the
    // offset is at most half the distance times the sine of their angle. Relative to the radius, so that no unit of
    // length matters.
    const float facets = std::sqrt(length_squared(d) * std::max(0.0f, 1 - cosine * cosine));
    const float offset = 0.5f * (std::fabs(dot(d, n + record.normal)) - facets);
    const float off_plane = std::max(0.0f, offset) / (detail::plane_tolerance * record.radius);
    if (kind == Weight::tabellion) {
        // The larger of both errors [Tabellion04]; the square makes the border smooth.
        const float e = std::max(std::max(e_position, off_plane), turn / tolerated);
        return near & (e < 1) ? sqr(1 - e) : 0;
    }
    // The inverse of the summed errors [Ward88], the radius standing for a R, minus its value at the border.
    const float e = e_position + turn / tolerated;
    return near & (e < 1) & (off_plane < 1) ? (1 / std::max(e, 1e-3f) - 1) * (1 - off_plane) : 0;
}

/// Eight records beside each other, whose weights are found together.
struct alignas(32) Footings {
    static constexpr uint32_t count = lane_count;

    float position[3][count]{}, radius[count]{}, normal[3][count]{}, clearance[count]{}, stretch[3][count]{},
        tolerance[count]{};
    bool enclosed[count]{};

    Footing operator[](uint32_t i) const {
        return {{position[0][i], position[1][i], position[2][i]},
                radius[i],
                {normal[0][i], normal[1][i], normal[2][i]},
                clearance[i],
                {stretch[0][i], stretch[1][i], stretch[2][i]},
                tolerance[i],
                enclosed[i]};
    }
    void set(uint32_t i, const Footing& footing) {
        for (int axis = 0; axis < 3; ++axis) {
            position[axis][i] = footing.position[axis];
            normal[axis][i] = footing.normal[axis];
            stretch[axis][i] = footing.stretch[axis];
        }
        radius[i] = footing.radius;
        clearance[i] = footing.clearance;
        tolerance[i] = footing.tolerance;
        enclosed[i] = footing.enclosed;
    }

    /// The weight of each at a point, 0 where there is no record. Each kind has a loop of its own, which has no branch.
    void weights(Vec3 p, Vec3 n, Weight kind, float relaxation, float* out) const {
        if (kind == Weight::tabellion)
            for (uint32_t i = 0; i < count; ++i) out[i] = weight((*this)[i], p, n, Weight::tabellion, relaxation);
        else if (kind == Weight::ward)
            for (uint32_t i = 0; i < count; ++i) out[i] = weight((*this)[i], p, n, Weight::ward, relaxation);
        else
            for (uint32_t i = 0; i < count; ++i) out[i] = weight((*this)[i], p, n, Weight::split_sphere, relaxation);
    }
};

}  // namespace eclat

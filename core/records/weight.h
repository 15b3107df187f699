// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The weight of a record at a point. It is 1 at the record and decreases to 0 at the border of its validity, so that no
// border is visible. A `relaxation` above 1 increases the radius and, slightly, the tolerated angle between the
// normals, because records are placed by a strict test and read by a relaxed one.

#pragma once

#include "base/lanes.h"
#include "records/record.h"

namespace eclat {

enum class Weight : uint8_t {
    tabellion,  // from the larger of the errors of distance and angle, squared so that it ends smoothly [Tabellion04]
    ward,       // the inverse of the sum of both errors, shifted so that it ends at 0
    /// The weight as published in [Ward88], for comparisons: the tolerance of angles grows with that of distances, and only
    /// points behind a record are rejected, so that light leaks.
    split_sphere,
};

namespace detail {
// √(1 − cos 10°): no record is placed where the normals differ by less than 10° [Tabellion04].
constexpr float sqrt_one_minus_cos_10 = 0.12326f;
// When records are read, this increases to at most 0.2 rad [Schwarzhaupt12]. The light from below a record's horizon is
// unknown, and the records on a bevel must not be read on the adjacent faces.
constexpr float largest_turn = 1.146f;
inline float tolerated_turn(float relaxation) { return sqrt_one_minus_cos_10 * std::min(relaxation, largest_turn); }
// This is the distance of a point from a record's plane, as a share of the record's radius, that is tolerated in
// addition to what the difference of the normals explains. It is not relaxed when records are read. With a larger
// tolerance, a ceiling would read the light on the front of a panel that hangs close below it: at 0.04 this happens for
// records wider than 25 gaps, at this value only for records wider than 66.
constexpr float plane_tolerance = 0.015f;
}  // namespace detail

/// Returns the largest distance from its plane at which a record is read, among points within `reach` of it. It
/// consists of the tolerance and of the distance that the largest tolerated difference of normals explains. See
/// `weight`.
inline float height_read(float radius, float reach, Weight kind) {
    if (kind == Weight::split_sphere) return infinity;
    constexpr float sine = 0.2f;  // sine of the largest angle between the normals
    return detail::plane_tolerance * radius + sine * reach;
}

/// The position and extent of a record, on which its weight depends.
struct Footing {
    Vec3 position;
    float radius;
    Vec3 normal;
    float clearance;      // least clearance of the record's sectors
    Vec3 stretch{};       // vector along the long axis, of length √(1 − (R1/R2)²), by which distances are reduced there
    float tolerance = 0;  // the constant a of the split-sphere model, whose radius is a R
    bool enclosed = false;  // inside a solid: no other record is placed near it, and it is not read
};

/// Computes Ward's weight as published, without additional tests [Ward88].
inline float split_sphere_weight(const Footing& record, Vec3 p, Vec3 n, float relaxation) {
    const Vec3 d = p - record.position;
    const float distance = length(d), turn = safe_sqrt(1 - dot(n, record.normal));
    const float e = (distance / record.radius + turn / record.tolerance) / relaxation;
    // The point is behind the record, as measured along the mean of both normals, by more than rounding errors.
    if (e >= 1 || dot(d, n + record.normal) < -1e-3f * record.radius) return 0;
    return 1 / std::max(e, 1e-3f) - 1;
}

/// Returns 0 if the record does not serve the point. There are no branches, so that compilers can vectorise loops over
/// records.
inline float weight(const Footing& record, Vec3 p, Vec3 n, Weight kind, float relaxation) {
    if (kind == Weight::split_sphere) return split_sphere_weight(record, p, n, relaxation);
    // With both weights, a record is not valid if the normals differ by more than the tolerance.
    const float cosine = dot(n, record.normal);
    const float tolerated = detail::tolerated_turn(relaxation);
    const Vec3 d = p - record.position;
    const float reach = record.radius * relaxation;
    // The region is an ellipse in the record's plane, with the small radius perpendicular to the plane
    // [Schwarzhaupt12].
    const float distance2 = length_squared(d) - sqr(dot(d, record.stretch));
    const bool near = (1 - cosine < sqr(tolerated)) & (distance2 < reach * reach);
    const float e_position = std::sqrt(std::max(0.0f, distance2)) / reach;
    const float turn = safe_sqrt(1 - cosine);
    // The point must lie in the record's plane, as measured along the mean of both normals, because a point behind the
    // record sees surfaces that the record cannot see [Ward88]. On a sphere the mean normal is perpendicular to the
    // chord. Across an edge between two facets, the offset is at most half the distance times the sine of their angle.
    // The tolerance is relative to the radius, so that it does not depend on the unit of length.
    const float facets = std::sqrt(length_squared(d) * std::max(0.0f, 1 - cosine * cosine));
    const float offset = 0.5f * (std::fabs(dot(d, n + record.normal)) - facets);
    const float off_plane = std::max(0.0f, offset) / (detail::plane_tolerance * record.radius);
    if (kind == Weight::tabellion) {
        // The weight depends on the larger of both errors [Tabellion04]; the square makes it smooth at the border.
        const float e = std::max(std::max(e_position, off_plane), turn / tolerated);
        return near & (e < 1) ? sqr(1 - e) : 0;
    }
    // The weight is the inverse of the sum of the errors [Ward88], in which the radius takes the place of a R, minus
    // its value at the border.
    const float e = e_position + turn / tolerated;
    return near & (e < 1) & (off_plane < 1) ? (1 / std::max(e, 1e-3f) - 1) * (1 - off_plane) : 0;
}

/// Eight records whose weights are computed together.
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

    /// Computes the weight of each record at a point, which is 0 in empty lanes. Each kind of weight has its own loop
    /// without branches.
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

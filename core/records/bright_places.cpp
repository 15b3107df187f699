// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Hits of gather rays whose radiance exceeds the limit for one ray are recorded in the cells of a grid. Later gathers
// aim at the cells with the most light. Seen from a point, each cell is a cone around the bounding sphere of the cell;
// a cone is chosen with a probability that is about proportional to the irradiance from it, and a direction in the cone
// uniformly.
//
// Symbol     name here          meaning                                                         unit
//   L        place.luminance    mean luminance above the limit, of the rays that hit the place  W m⁻² sr⁻¹
//   sin² γ   sine2              of the angle γ that the sphere's radius spans                   1
//   θ        –                  angle of the cone's uppermost part from the point's normal      rad
//   c        chance             chance of the cone, L cos θ sin² γ over the sum of all cones'   1
//   q(ω)     pdf_solid_angle    Σ c / (2π (1 − cos γ)) over the cones that hold ω               sr⁻¹
//
// Held to      tests/core/records/test_bright_places.cpp

#include "records/bright_places.h"

#include <algorithm>
#include <cmath>

#include "base/frame.h"
#include "sampling/warp.h"

namespace eclat {

namespace {

constexpr size_t most_places = 64;
constexpr float cell_share =
    0.022f;  // of the distance; tuned in scenes in which it was a fiftieth of half the room's diagonal
constexpr float least_cell = 1e-12f;         // m; the coordinates of smaller cells would exceed 64 bits
constexpr float half_diagonal = 0.8660254f;  // half the diagonal of a cell, in units of its side

}  // namespace

void BrightPlaces::add(std::span<const Sighting> sightings) {
    for (const Sighting& s : sightings) {
        const float share = cell_share * s.distance;
        if (!(share >= least_cell)) continue;  // an object that touches the point fills its hemisphere
        Key key;
        key[0] = std::ilogb(share);
        for (int axis = 0; axis < 3; ++axis)
            key[axis + 1] = std::llround(std::floor(std::ldexp(s.position[axis], static_cast<int>(-key[0]))));
        Cell& found = cells_[key];
        found.sum = found.sum + s.position;
        found.luminance += s.luminance;
        found.count += 1;
    }
    struct Ranked {
        float luminance;
        float width;
        const Cell* cell;
    };
    std::vector<Ranked> ranked;
    for (const auto& [key, c] : cells_) ranked.push_back({c.luminance, std::ldexp(1.0f, static_cast<int>(key[0])), &c});
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const Ranked& a, const Ranked& b) { return a.luminance > b.luminance; });
    ranked.resize(std::min(ranked.size(), most_places));
    places_.clear();
    for (const auto& [luminance, width, cell] : ranked)
        places_.push_back({cell->sum / cell->count, cell->luminance / cell->count, width});
}

AimedCones BrightPlaces::seen_from(Vec3 p, Vec3 n) const {
    AimedCones out;
    float sum = 0;
    for (const Place& place : places_) {
        const Vec3 d = place.position - p;
        const float d2 = length_squared(d), sine2 = sqr(half_diagonal * place.cell) / d2;
        // A place that is this close fills so much of the hemisphere that gathers hit it without aiming.
        if (!(sine2 < 0.25f)) continue;
        const Vec3 axis = d / std::sqrt(d2);
        // This is approximately the fraction of the sphere above the horizon.
        const float cosine = std::min(1.0f, dot(axis, n) + std::sqrt(sine2));
        if (cosine <= 0) continue;
        const float chance = place.luminance * cosine * sine2;
        if (!(chance > 0)) continue;
        sum += chance;
        out.cones_.push_back({axis, sine2 / (1 + safe_sqrt(1 - sine2)), chance, sum});
    }
    for (auto& cone : out.cones_) {
        cone.chance /= sum;
        cone.before /= sum;
    }
    return out;
}

Vec3 AimedCones::sample(float u_cone, Vec2 u) const {
    const auto found = std::upper_bound(cones_.begin(), cones_.end() - 1, u_cone,
                                        [](float x, const Cone& cone) { return x < cone.before; });
    return Frame::around(found->axis).to_world(square_to_uniform_cone(u, found->one_minus_cos));
}

float AimedCones::pdf_solid_angle(Vec3 w) const {
    float sum = 0;
    for (const Cone& cone : cones_)
        // 1 − cos is computed from the chord, because the direct formula cancels for narrow cones.
        if (0.5f * length_squared(w - cone.axis) < cone.one_minus_cos)
            sum += cone.chance * uniform_cone_pdf_solid_angle(cone.one_minus_cos);
    return sum;
}

}  // namespace eclat

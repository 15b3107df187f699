// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Small bright objects, which earlier gathers hit by chance and at which later gathers aim.

#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "base/vec.h"

namespace eclat {

/// Where a gather's ray met radiance beyond what one ray may bring.
struct Sighting {
    Vec3 position;
    float luminance;  // of that part
    float distance;   // from which it was met, m
};

/// The bright places as seen from one point: cones, each with its chance. Empty where none is above the horizon.
class AimedCones {
  public:
    struct Cone {
        Vec3 axis;
        float one_minus_cos;
        float chance;
        float before;  // summed chances of all cones up to and with this one
    };

    bool empty() const { return cones_.empty(); }
    /// A direction for random numbers in [0, 1).
    Vec3 sample(float u_cone, Vec2 u) const;
    /// Density of `sample`; cones may overlap.
    float pdf_solid_angle(Vec3 w) const;

  private:
    friend class BrightPlaces;
    std::vector<Cone> cones_;
};

class BrightPlaces {
  public:
    /// Sightings in one cell of a grid become one place. Cells are as wide as a fiftieth of the distance from which they were
    /// met, down to the next power of two, so that each part of a scene has its own, however far away another lies.
    void add(std::span<const Sighting> sightings);
    bool empty() const { return places_.empty(); }
    size_t size() const { return places_.size(); }
    /// Chances in proportion to the irradiance at a point with normal `n` from a sphere around each place.
    AimedCones seen_from(Vec3 p, Vec3 n) const;

  private:
    struct Cell {
        Vec3 sum;  // of positions
        float luminance = 0;
        float count = 0;
    };
    struct Place {
        Vec3 position;
        float luminance;
        float cell;  // its width, m
    };
    /// The exponent of a cell's width, and where it lies in the grid of such cells.
    using Key = std::array<int64_t, 4>;
    std::map<Key, Cell> cells_;  // ordered, so that sums and ties are
    std::vector<Place> places_;  // the brightest of them
};

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Bright places are small bright objects that earlier gathers hit by chance. Later gathers aim rays at them.

#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "base/vec.h"

namespace eclat {

/// A hit of a gather ray whose radiance exceeds the limit for a single ray.
struct Sighting {
    Vec3 position;
    float luminance;  // luminance of the part above the limit
    float distance;   // length of the ray, m
};

/// The bright places as cones seen from one point, each with its probability. There are none if no bright place is
/// above the horizon of the point.
class AimedCones {
  public:
    struct Cone {
        Vec3 axis;
        float one_minus_cos;
        float chance;
        float before;  // sum of the probabilities up to and including this cone
    };

    bool empty() const { return cones_.empty(); }
    /// Returns a direction for random numbers in [0, 1).
    Vec3 sample(float u_cone, Vec2 u) const;
    /// Returns the density with which `sample` takes the direction, summed over all cones that contain it.
    float pdf_solid_angle(Vec3 w) const;

  private:
    friend class BrightPlaces;
    std::vector<Cone> cones_;
};

class BrightPlaces {
  public:
    /// Adds sightings; all that lie in the same cell of a grid become one place. The width of a cell is a fiftieth of
    /// the distance from which it was seen, rounded down to a power of two, so it does not depend on distant parts of
    /// the scene.
    void add(std::span<const Sighting> sightings);
    bool empty() const { return places_.empty(); }
    size_t size() const { return places_.size(); }
    /// Returns cones around all places. The probability of a cone is proportional to the irradiance that a sphere
    /// around its place causes at the point `p` with the normal `n`.
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
        float cell;  // width of the cell, m
    };
    /// The exponent of a cell's width, and the cell's integer coordinates in the grid of that width.
    using Key = std::array<int64_t, 4>;
    std::map<Key, Cell> cells_;  // ordered, so that sums and ties do not depend on chance
    std::vector<Place> places_;  // places of the brightest cells
};

}  // namespace eclat

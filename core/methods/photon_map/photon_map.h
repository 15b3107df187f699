// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Photons, with the tree that finds those near a point. A photon map is built once and then only read.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/color.h"
#include "base/kd_tree.h"

namespace eclat {

/// A packet of light that arrived at a surface [Jensen01].
struct Photon {
    Vec3 position;
    Color power;      // W, as if it were the only one emitted; divided by the number of paths when it is read
    Vec3 direction;   // unit vector in the direction from which it came
    Vec3 normal;      // geometric unit normal on the side where it arrived
    float edges = 1;  // number of edges of its path; 1 means straight from a light
};
static_assert(sizeof(Photon) == 13 * sizeof(float));

class PhotonMap {
  public:
    PhotonMap() = default;
    /// `emitted` is the number of paths, including those that stored no photon.
    PhotonMap(std::span<const Photon> photons, double emitted, int threads);

    /// Finds the `count` photons nearest to the disc's centre, on its side and within its radius, of paths with at most
    /// `max_edges` edges (−1 means any number). They are written to `found` in no particular order. Returns the radius
    /// of the disc that they fill, with which their number divided by the area is an unbiased density.
    float nearest(const Disc& disc, size_t count, int max_edges, std::vector<Neighbor>& found) const {
        return tree_.nearest(disc, count, found, [&](uint32_t i) {
            const Photon& photon = photons_[i];
            return disc.same_side(photon.normal) && (max_edges < 0 || photon.edges <= static_cast<float>(max_edges));
        });
    }

    /// The photons in the order of the tree.
    const std::vector<Photon>& photons() const { return photons_; }
    const Photon& photon(const Neighbor& n) const { return photons_[n.index]; }
    bool empty() const { return photons_.empty(); }
    /// Returns the power of a photon divided by the number of paths, W.
    Color power(const Photon& photon) const { return photon.power * per_emitted_; }

  private:
    float per_emitted_ = 0;
    KdTree tree_;
    std::vector<Photon> photons_;
};

}  // namespace eclat

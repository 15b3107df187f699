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

/// Light that arrived somewhere [Jensen01].
struct Photon {
    Vec3 position;
    Color power;      // W, as if it were the only one that was emitted: divided by their number when it is read
    Vec3 direction;   // unit, towards where it came from
    Vec3 normal;      // unit, geometric, on the side where it arrived
    float edges = 1;  // of its path; 1 = straight from a light
};
static_assert(sizeof(Photon) == 13 * sizeof(float));

class PhotonMap {
  public:
    PhotonMap() = default;
    /// `emitted`: paths that the photons are of, those that ended without one included.
    PhotonMap(std::span<const Photon> photons, double emitted, int threads);

    /// The `count` photons nearest to the disc's centre, on its side, within its radius, of paths with at most `max_edges`
    /// (−1: any); into `found`, in no order. Returns the radius of the disc that they fill: with it their number over the
    /// area is an unbiased density.
    float nearest(const Disc& disc, size_t count, int max_edges, std::vector<Neighbor>& found) const {
        return tree_.nearest(disc, count, found, [&](uint32_t i) {
            const Photon& photon = photons_[i];
            return disc.same_side(photon.normal) && (max_edges < 0 || photon.edges <= static_cast<float>(max_edges));
        });
    }

    /// In the tree's order.
    const std::vector<Photon>& photons() const { return photons_; }
    const Photon& photon(const Neighbor& n) const { return photons_[n.index]; }
    bool empty() const { return photons_.empty(); }
    /// Power of a photon in the sum of all, W.
    Color power(const Photon& photon) const { return photon.power * per_emitted_; }

  private:
    float per_emitted_ = 0;
    KdTree tree_;
    std::vector<Photon> photons_;
};

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/photon_map/photon_map.h"

namespace eclat {

PhotonMap::PhotonMap(std::span<const Photon> photons, double emitted, int threads)
    : per_emitted_(emitted > 0 ? static_cast<float>(1 / emitted) : 0) {
    std::vector<Vec3> positions;
    positions.reserve(photons.size());
    for (const Photon& p : photons) positions.push_back(p.position);
    tree_ = KdTree(positions, threads);
    photons_.reserve(photons.size());
    for (const uint32_t i : tree_.order()) photons_.push_back(photons[i]);
}

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The kd-tree finds what looking at every photon finds, and is the same on any number of threads.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "methods/photon_map/photon_map.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

/// Photons in a cube, on six sides; some share coordinates.
std::vector<Photon> scattered(size_t count) {
    constexpr std::array<Vec3, 6> normals{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
    Rng rng(3, 9);
    std::vector<Photon> out;
    for (size_t i = 0; i < count; ++i) {
        const Vec3 p{rng.next(), std::floor(rng.next() * 16) / 16, rng.next()};
        const Vec3 n = normals[static_cast<size_t>(rng.next() * 6)];
        out.push_back({p, Color(1 + rng.next()), n, n, 1 + std::floor(rng.next() * 4)});
    }
    return out;
}

/// Distances of what `nearest` should find, and of the next one.
std::vector<float> by_looking_at_all(const PhotonMap& map, const Disc& disc, size_t count, int max_edges) {
    std::vector<float> found;
    for (const Photon& p : map.photons()) {
        if (dot(p.normal, disc.normal) < Disc::least_cosine || (max_edges >= 0 && p.edges > float(max_edges))) continue;
        const Vec3 d = p.position - disc.position;
        const float along = dot(d, disc.normal);
        const float d2 = length_squared(d) + (Disc::flatness * Disc::flatness - 1) * along * along;
        if (d2 < disc.radius * disc.radius) found.push_back(d2);
    }
    std::sort(found.begin(), found.end());
    if (found.size() > count + 1) found.resize(count + 1);
    return found;
}

}  // namespace

TEST_CASE("the tree finds the same photons as a loop over all") {
    for (const size_t photons : {size_t(0), size_t(1), size_t(5), size_t(9), size_t(40000)}) {
        const PhotonMap map(scattered(photons), 100, 2);
        REQUIRE(map.photons().size() == photons);
        Rng rng(4, 4);
        std::vector<Neighbor> found;
        for (int i = 0; i < 60; ++i) {
            Disc disc{{rng.next(), rng.next(), rng.next()}, {0, 1, 0}};
            if (i % 3 == 1) disc.radius = 0.2f;
            const int max_edges = i % 4 == 1 ? 2 : -1;
            const size_t count = i % 2 == 0 ? 30 : 3;
            const float radius = map.nearest(disc, count, max_edges, found);
            const auto expected = by_looking_at_all(map, disc, count, max_edges);
            REQUIRE(found.size() == std::min(count, expected.size()));
            std::sort(found.begin(), found.end());
            for (size_t k = 0; k < found.size(); ++k) {
                CHECK(found[k].distance2 == doctest::Approx(expected[k]).epsilon(1e-5));
                CHECK(disc.distance2(map.photon(found[k]).position) == found[k].distance2);
            }
            if (expected.size() > count) {
                CHECK(radius == doctest::Approx(std::sqrt(expected[count])).epsilon(1e-5));
            } else {
                CHECK(radius == disc.radius);
            }
        }
    }
}

TEST_CASE("the tree is the same on one thread and on two") {
    const PhotonMap one(scattered(60000), 7, 1), two(scattered(60000), 7, 2);
    CHECK(std::memcmp(one.photons().data(), two.photons().data(), 60000 * sizeof(Photon)) == 0);
    CHECK(one.power(one.photons()[5]).r == doctest::Approx(one.photons()[5].power.r / 7));
}

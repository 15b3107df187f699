// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include <vector>

#include "base/frame.h"
#include "sampling/rng.h"
#include "sampling/warp.h"

using namespace eclat;

namespace {

void check_right_handed(const Frame& f) {
    CHECK(length(f.u) == doctest::Approx(1).epsilon(2e-6));
    CHECK(length(f.v) == doctest::Approx(1).epsilon(2e-6));
    CHECK(std::abs(dot(f.u, f.v)) < 2e-6f);
    CHECK(std::abs(dot(f.u, f.n)) < 2e-6f);
    CHECK(std::abs(dot(f.v, f.n)) < 2e-6f);
    CHECK(length(cross(f.u, f.v) - f.n) < 4e-6f);
}

std::vector<Vec3> normals() {
    // Both poles, their neighbourhood and the equator, where frames that branch go wrong.
    std::vector<Vec3> out{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1, 0, -0.0f}};
    for (float tilt : {1e-20f, 1e-7f, 1e-4f, 1e-2f})
        for (float z : {-1.0f, 1.0f}) out.push_back(normalize({tilt, -tilt, z}));
    Rng rng(3, 4);
    for (int i = 0; i < 1000; ++i) {
        const float u = rng.next(), v = rng.next();
        out.push_back(square_to_uniform_sphere({u, v}));
    }
    return out;
}

}  // namespace

TEST_CASE("a frame around any normal is orthonormal and right-handed") {
    for (Vec3 n : normals()) {
        const Frame f = Frame::around(n);
        CHECK(f.n == n);
        check_right_handed(f);
    }
}

TEST_CASE("local and back is the identity, and local z is the normal") {
    for (Vec3 n : normals()) {
        const Frame f = Frame::around(n);
        const Vec3 w = normalize({0.3f, -0.8f, 0.5f});
        CHECK(length(f.to_world(f.to_local(w)) - w) < 4e-6f);
        CHECK(length(f.to_local(n) - Vec3{0, 0, 1}) < 4e-6f);
    }
}

TEST_CASE("a frame along a tangent keeps its direction as far as the normal allows") {
    const Vec3 n = normalize({1, 2, 3});
    const Vec3 tangent{5, -1, 0.2f};
    const Frame f = Frame::along(n, tangent);
    check_right_handed(f);
    CHECK(dot(f.u, tangent) > 0);
    CHECK(std::abs(dot(f.v, tangent)) < 1e-5f);  // all of what lies in the plane is along u
}

TEST_CASE("a tangent that is parallel to the normal, or nothing, still gives a frame") {
    check_right_handed(Frame::along({0, 0, 1}, {0, 0, -2}));
    check_right_handed(Frame::along({0, 1, 0}, {0, 0, 0}));
}

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/radiosity_field.h"

#include <doctest/doctest.h>

#include "room.h"

using namespace eclat;

namespace {

const Wall plate{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 0};

/// Patches of a plate with irradiance from `light(center)`.
template <class F>
std::vector<SolvedPatch> painted(const PatchTree& tree, F&& light) {
    std::vector<SolvedPatch> out;
    for (const uint32_t i : tree.leaves()) {
        SolvedPatch p;
        p.name = tree.name(i);
        p.total = Color(light(tree[i].center)) * (tree[i].back ? 10.0f : 1.0f);
        p.direct = p.total * 0.25f;
        out.push_back(p);
    }
    return out;
}

SurfacePoint at(const Room& room, float x, float z, bool from_above = true) {
    std::vector<Ray> ray{{{x, from_above ? 1.0f : -1.0f, z}, 0, {0, from_above ? -1.0f : 1.0f, 0}, infinity}};
    std::vector<Hit> hit(1);
    room.geometry->rays().intersect(ray, hit);
    return room.geometry->surface_point(hit[0], -ray[0].direction);
}

}  // namespace

TEST_CASE("linear light is reconstructed exactly up to the edge, and each side has its own light") {
    const Room room = build_room({plate});
    const PatchTree tree(*room.geometry, 0.2f);
    const auto linear = [](Vec3 p) { return 2 + 0.7f * p.x - 0.4f * p.z; };
    const RadiosityField field(*room.geometry, painted(tree, linear), 1);
    for (const float x : {-0.8f, -0.31f, 0.02f, 0.55f})
        for (const float z : {-0.7f, 0.013f, 0.77f}) {
            const auto light = field.smooth(at(room, x, z));
            REQUIRE(light);
            CHECK(light->total.g == doctest::Approx(linear({x, 0, z})).epsilon(1e-3));
            CHECK(light->direct.g == doctest::Approx(0.25 * linear({x, 0, z})).epsilon(1e-3));
            CHECK(field.smooth(at(room, x, z, false))->total.g ==
                  doctest::Approx(10 * linear({x, 0, z})).epsilon(1e-3));
            const auto patch = field.on_patch(at(room, x, z));
            CHECK(std::fabs(patch->light.total.g - linear({x, 0, z})) < 0.7f * patch->radius * 1.5f);
        }
    // Beyond the outermost centres the plane is cut off at the brightest patch.
    CHECK(field.smooth(at(room, 0.999f, -0.999f))->total.g == doctest::Approx(linear({1, 0, -1})).epsilon(0.05));
}

TEST_CASE("a step is reconstructed without overshooting") {
    const Room room = build_room({plate});
    const PatchTree tree(*room.geometry, 0.1f);
    const RadiosityField field(*room.geometry, painted(tree, [](Vec3 p) { return p.x < 0 ? 1.0f : 3.0f; }), 1);
    for (float x = -0.3f; x < 0.3f; x += 0.01f) {
        const float value = field.smooth(at(room, x, 0.1f))->total.g;
        CHECK(value >= 0.999f);
        CHECK(value <= 3.001f);
    }
    CHECK(field.smooth(at(room, -0.2f, 0))->total.g == doctest::Approx(1));
    CHECK(field.smooth(at(room, 0.2f, 0))->total.g == doctest::Approx(3));
}

TEST_CASE("a rug shows none of the darkness of the floor a centimetre below it, and curved sheets stay whole") {
    const Wall rug{{-1, 0.01f, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 0};
    const Room room = build_room({plate, rug});
    const PatchTree tree(*room.geometry, 0.4f);
    const RadiosityField field(*room.geometry, painted(tree, [](Vec3 p) { return p.y > 0 ? 3.0f : 0.0f; }), 1);
    for (const float x : {-0.9f, -0.3f, 0.4f}) CHECK(field.smooth(at(room, x, 0.2f))->total.g == doctest::Approx(3));

    const Disc disc{{0, 0, 0}, {0, 1, 0}, 1};
    const float angle = 0.3f;  // of a curved sheet that turns by as much over a metre
    CHECK(disc.same_sheet({1, -std::tan(angle / 2), 0}, {std::sin(angle), std::cos(angle), 0}));
    CHECK_FALSE(disc.same_sheet({1, -0.01f, 0}, {0, 1, 0}));
}

TEST_CASE("patches of unknown light are not read, and patches of another scene are refused") {
    const Room room = build_room({plate});
    const PatchTree tree(*room.geometry, 0.2f);
    auto patches = painted(tree, [](Vec3 p) { return p.x < 0 ? 0.0f : 3.0f; });
    for (SolvedPatch& p : patches) p.unknown = p.total.g == 0;
    const RadiosityField field(*room.geometry, patches, 1);
    CHECK(field.smooth(at(room, -0.02f, 0.3f))->total.g == doctest::Approx(3));
    CHECK_FALSE(field.on_patch(at(room, -0.5f, 0.3f)));
    patches.pop_back();
    CHECK_THROWS_AS(RadiosityField(*room.geometry, patches, 1), std::invalid_argument);
}

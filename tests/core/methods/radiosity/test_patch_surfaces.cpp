// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/patch_surfaces.h"

#include <doctest/doctest.h>

#include "bsdf/fresnel.h"
#include "room.h"

using namespace eclat;

namespace {

std::vector<PatchSurface> measured(const Room& room, const PatchTree& tree, int threads = 1) {
    std::vector<PatchSurface> out(tree.nodes().size());
    Progress progress;
    measure_surfaces(room.world(), tree, tree.leaves(), {.threads = threads}, out, progress);
    CHECK(progress.rays > 0);
    return out;
}

void set_lights(Room& room, LightInputs inputs) {
    inputs.triangles = room.emitters;
    inputs.scene_radius = room.geometry->radius();
    room.lights = Lights(std::move(inputs));
}

const Wall floor_plate{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0.6f, 0};

}  // namespace

TEST_CASE("albedo, emission, and closure of a closed room") {
    const Room room = closed_room({0.5f, 0.7f, 0.2f, 0.6f, 0.5f, 0.5f}, {0, 3, 0, 0, 0, 0});
    const PatchTree tree(*room.geometry, 1);
    const auto surfaces = measured(room, tree);
    constexpr float albedo[] = {0.5f, 0.7f, 0.2f, 0.6f, 0.5f, 0.5f};
    for (const uint32_t i : tree.leaves()) {
        const PatchSurface& s = surfaces[i];
        CHECK(s.albedo.g == doctest::Approx(albedo[tree[i].triangle / 2]).epsilon(1e-4));
        const bool emits = tree[i].triangle / 2 == 1 && !tree[i].back;
        CHECK(s.emitted.g == doctest::Approx(emits ? 3 * M_PI : 0).epsilon(1e-4));
        CHECK(is_black(s.lights));
        CHECK(s.closure == (tree[i].back ? 0 : 1));
        CHECK(s.closure_error == 0);
        CHECK(s.exposed == 1);
    }
}

TEST_CASE("what a pane lets straight through is not its own, and rays of others go on behind it") {
    // A clear pane over a floor, under the sky.
    std::vector<Wall> walls{floor_plate, {{-9, 0.5f, -9}, {0, 0, 18}, {18, 0, 0}, 0, 0}};
    std::vector<Material> materials = own_materials(walls);
    materials[1].kind = MaterialKind::thin_dielectric;
    Value white, ior;
    white.constant = Color(1), ior.constant = Color(1.5f);
    materials[1].parameters = {white, white, ior};
    for (Material& m : materials) m.prepare({});
    const Room room = build_room(walls, materials);
    const PatchTree tree(*room.geometry, 0.5f);
    const auto surfaces = measured(room, tree);
    double stops = 0;
    for (int i = 0; i < 1000; ++i) {
        const double c = std::sqrt((i + 0.5) / 1000), r = fresnel_dielectric(float(c), 1.5f).reflectance;
        stops += 2 * r / (1 + r) / 1000;
    }
    double found = 0, closure = 0, area = 0;
    for (const uint32_t i : tree.leaves()) {
        const PatchSurface& s = surfaces[i];
        if (tree[i].triangle > 1) {
            CHECK(s.stops == doctest::Approx(stops).scale(0).epsilon(0.05));
            found += tree[i].area * s.stops / (2 * 18 * 18);
            CHECK(s.opacity == s.stops);
            CHECK(s.albedo.g == doctest::Approx(0.999).epsilon(1e-4));
        } else if (!tree[i].back) {
            CHECK(s.stops == 1);
            closure += tree[i].area * s.closure, area += tree[i].area;
        }
    }
    CHECK(found == doctest::Approx(stops).scale(0).epsilon(0.003));
    CHECK(closure / area == doctest::Approx(stops).scale(0).epsilon(0.15));
}

TEST_CASE("irradiance of a sun, a point and a sky in closed form") {
    Room room = build_room({floor_plate});
    const PatchTree tree(*room.geometry, 0.5f);
    const float cosine = 0.8f;
    LightInputs sun;
    sun.directionals.emplace_back(Vec3{0.6f, -cosine, 0}, Color(2), 0.0f);
    set_lights(room, std::move(sun));
    auto surfaces = measured(room, tree);
    for (const uint32_t i : tree.leaves())
        CHECK(surfaces[i].lights.g == doctest::Approx(tree[i].back ? 0 : 2 * cosine).epsilon(1e-4));

    LightInputs point;
    point.points.push_back({{0.2f, 1.5f, -0.1f}, Color(4)});
    set_lights(room, std::move(point));
    surfaces = measured(room, tree);
    double arrived = 0;
    for (const uint32_t i : tree.leaves())
        if (!tree[i].back) arrived += tree[i].area * surfaces[i].lights.g;
    // Flux = intensity × solid angle of the plate: Σ over its four rectangles about the foot of atan(ab / (h √(a²+b²+h²))).
    double solid_angle = 0;
    for (const double a : {0.8, 1.2})
        for (const double b : {0.9, 1.1})
            solid_angle += std::atan(a * b / (1.5 * std::sqrt(a * a + b * b + 1.5 * 1.5)));
    CHECK(arrived == doctest::Approx(4 * solid_angle).epsilon(0.002));

    LightInputs sky;
    const float texels[3] = {0.7f, 0.7f, 0.7f};
    sky.environment.emplace(std::span<const float>(texels, 3), 1, 1, std::array<float, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
    set_lights(room, std::move(sky));
    surfaces = measured(room, tree);
    double mean_irradiance = 0;
    for (const uint32_t i : tree.leaves()) mean_irradiance += surfaces[i].lights.g / double(tree.leaves().size());
    CHECK(mean_irradiance == doctest::Approx(0.7 * M_PI).epsilon(0.01));
    CHECK(surfaces[tree.leaves().front()].closure == 0);
}

TEST_CASE("parts of a patch inside a solid of one-sided walls do not belong to it") {
    // A solid without a bottom stands on the left half of the floor: its walls look outwards and have no backs.
    std::vector<Wall> walls{floor_plate,
                            {{-1, 1, -1}, {0, 0, 2}, {1, 0, 0}, 0.5f, 0},  // top
                            {{0, 0, -1}, {0, 1, 0}, {0, 0, 2}, 0.5f, 0},   // towards +x
                            {{-1, 0, -1}, {0, 0, 2}, {0, 1, 0}, 0.5f, 0},  // towards −x
                            {{-1, 0, -1}, {0, 1, 0}, {1, 0, 0}, 0.5f, 0},  // towards −z
                            {{-1, 0, 1}, {1, 0, 0}, {0, 1, 0}, 0.5f, 0}};  // towards +z
    Room room = build_room(walls, false);
    LightInputs sun;
    sun.directionals.emplace_back(Vec3{0, -1, 0}, Color(1), 0.0f);
    set_lights(room, std::move(sun));
    const PatchTree tree(*room.geometry, 0.45f);
    const auto surfaces = measured(room, tree);
    for (const uint32_t i : tree.leaves()) {
        if (tree[i].triangle / 2 != 0) continue;
        float left = infinity, right = -infinity;
        for (const Vec3& v : tree[i].corner) left = std::min(left, v.x), right = std::max(right, v.x);
        if (right < 0) CHECK(surfaces[i].unknown());
        if (left > 0) CHECK(surfaces[i].exposed == 1);
        if (!surfaces[i].unknown()) CHECK(surfaces[i].lights.g == doctest::Approx(1).epsilon(0.35));
        if (left > 0) CHECK(surfaces[i].lights.g == doctest::Approx(1).epsilon(1e-4));
    }
}

TEST_CASE("a wall that stands on a patch cuts it; a patch beside it is whole") {
    // 3 mm thick would do as well: what hides is the wall's face.
    const Room room = build_room({floor_plate, {{0.1f, 0, -1}, {0, 1, 0}, {0, 0, 2}, 0.5f, 0}});
    const PatchTree tree(*room.geometry, 0.45f);
    const auto surfaces = measured(room, tree);
    int cut = 0;
    for (const uint32_t i : tree.leaves()) {
        if (tree[i].triangle > 1 || tree[i].back) continue;
        float left = infinity, right = -infinity;
        for (const Vec3& v : tree[i].corner) left = std::min(left, v.x), right = std::max(right, v.x);
        const bool beside = left > 0.1f || right < 0.1f;
        CHECK_FALSE((beside && surfaces[i].cut));
        cut += surfaces[i].cut;
    }
    CHECK(cut >= 10);
}

TEST_CASE("if a wall divides a patch, the light of its larger part is known") {
    // One side of the wall is under a lamp, the other in the dark.
    const float at = 0.5f;
    Room room = build_room({floor_plate, {{at, 0, -1}, {0, 4, 0}, {0, 0, 2}, 0.5f, 0}});
    LightInputs sun;
    sun.directionals.emplace_back(Vec3{0.6f, -0.8f, 0}, Color(1),
                                  0.0f);  // shadow beyond the wall, as far as the floor goes
    set_lights(room, std::move(sun));
    const PatchTree tree(*room.geometry, 2.9f);  // two patches
    const auto surfaces = measured(room, tree);
    int looked_at = 0;
    for (const uint32_t i : tree.leaves()) {
        if (tree[i].triangle > 1 || tree[i].back) continue;
        const PatchSurface& s = surfaces[i];
        REQUIRE(s.cut);
        // Of the triangle with most of it on the left (0.5 / 2)² are cut off; of the other (1.5 / 2)² remain.
        CHECK(s.exposed == doctest::Approx(tree[i].center.x < 0 ? 0.9375 : 0.5625).epsilon(0.15));
        for (int k = 0; k < s.point_count; ++k) {
            const float u = (static_cast<float>(k) + 0.5f) / s.point_count;
            CHECK(tree[i].point(s.exposed_point({}, u)).x < at);
        }
        CHECK(s.lights.g == doctest::Approx(0.8).epsilon(1e-4));
        ++looked_at;
    }
    CHECK(looked_at == 2);
}

TEST_CASE("patch surfaces are the same on one thread and on two") {
    const Room room = closed_room({0.5f, 0.7f, 0.2f, 0.6f, 0.5f, 0.5f}, {0, 3, 0, 0, 0, 0});
    const PatchTree tree(*room.geometry, 0.3f);
    const auto one = measured(room, tree, 1), two = measured(room, tree, 2);
    for (const uint32_t i : tree.leaves()) {
        CHECK(one[i].albedo.g == two[i].albedo.g);
        CHECK(one[i].closure == two[i].closure);
    }
}

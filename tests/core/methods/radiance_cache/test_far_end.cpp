// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Where gather rays end instead of going on: in radiance records on what is glossy, in near records where nothing else serves.

#include <doctest/doctest.h>

#include "methods/radiance_cache/radiance_cache.h"
#include "room.h"

using namespace eclat;

namespace {

constexpr int order = 8;

/// The closed room, its ceiling shining, with a floor of rough metal that reflects nine tenths.
struct MetalFloor {
    MetalFloor() {
        const auto walls = closed_walls({0, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {0, 2, 0, 0, 0, 0});
        materials = own_materials(walls);
        Material& metal = materials[0];
        metal = {};
        metal.kind = MaterialKind::conductor;
        metal.parameters = {constant(0), constant(1), constant(0.9f), constant(0.5f), constant(0.5f)};
        metal.prepare(materials);
        room = build_room(walls, materials);
        BrdfTableOptions options;
        options.basis = Basis::spherical;
        options.order = order;
        options.max_error = 0.4;
        Progress progress;
        for (const TableLobe& lobe : RadianceTables::wanted(materials).lobes)
            tables.emplace_back(std::vector<TableLobe>{lobe}, options, progress);
        lobes = RadianceTables(materials, {&tables.at(0)}, order);
    }

    std::vector<Material> materials;
    Room room;
    std::vector<BrdfTable> tables;
    RadianceTables lobes{{}, {}, order};
};

}  // namespace

TEST_CASE("gather rays that meet gloss end in its records, which does not change their mean") {
    const MetalFloor place;
    const World world = place.room.world();
    RadianceCacheOptions options;
    options.irradiance.rows = 10;
    options.irradiance.far_records = 300;
    options.irradiance.least_pixels = 20;
    options.order = order;
    Progress progress;
    SolvedCaches caches;
    solve_radiance_everywhere(world, place.lobes, options, caches, progress);
    REQUIRE(caches.radiance.records().size() > 10);

    std::vector<Candidate> wanted;
    for (uint32_t i = 0; i < 48; ++i) {
        Candidate c;
        c.position = {-1, -0.9f + 0.3f * static_cast<float>(i % 6), -0.875f + 0.25f * static_cast<float>(i / 6)};
        c.normal = c.shading_normal = {1, 0, 0};
        c.offset = 1e-5f;
        c.footprint = 0.01f;
        c.key = i;
        wanted.push_back(c);
    }
    const auto gathered = [&](const FarEnd& far, Stream stream) {
        Progress counted;
        double sum = 0;
        for (const IrradianceRecord& r : gather_records(world, wanted, far, options.irradiance, stream, 24, counted))
            sum += (r.irradiance + r.excess).g;
        return std::pair{sum, static_cast<double>(counted.rays)};
    };
    const FarEnd diffuse = far_end(world, caches, options.irradiance, progress);
    CHECK(!diffuse.reflection);
    const FarEnd both = far_end(world, caches, options.irradiance, progress, &place.lobes);
    REQUIRE(both.reflection);
    const auto [traced, rays_traced] = gathered(diffuse, Stream{20});
    const auto [read, rays_read] = gathered(both, Stream{21});
    CHECK(read == doctest::Approx(traced).epsilon(0.015));
    CHECK(rays_read < 0.95 * rays_traced);

    IrradianceCacheOptions short_paths = options.irradiance;
    short_paths.max_depth = 4;  // records hold light of all lengths
    const FarEnd none = far_end(world, caches, short_paths, progress, &place.lobes);
    CHECK(!none.irradiance);
    CHECK(!none.reflection);
}

TEST_CASE("gather rays end in near records of earlier passes, which does not change their mean") {
    const Room room = closed_room({0.2f, 0.7f, 0.5f, 0.5f, 0.6f, 0.4f}, {0, 0, 0, 5, 0, 0});
    const auto on_floor = [](uint32_t i, uint32_t columns, float z) {
        Candidate c;
        c.position = {-0.95f + 1.9f * static_cast<float>(i % columns) / static_cast<float>(columns - 1), -1, z};
        c.normal = c.shading_normal = {0, 1, 0};
        c.offset = 1e-5f;
        c.footprint = 0.005f;
        c.key = i;
        return c;
    };
    std::vector<Candidate> floor, wall;
    for (uint32_t i = 0; i < 400; ++i) floor.push_back(on_floor(i, 20, -0.95f + 0.1f * static_cast<float>(i / 20)));
    for (uint32_t i = 0; i < 40; ++i) {
        Candidate c = on_floor(i, 40, -1);
        c.position.y = -0.8f;
        c.normal = c.shading_normal = {0, 0, 1};
        wall.push_back(c);
    }
    IrradianceCacheOptions options;
    options.far_records = 0;
    options.disagreement = infinity;
    SolvedCaches caches = empty_caches(options);
    Progress progress;
    RecordSolve solve{caches};
    add_near(room.world(), floor, options, solve, progress);
    const auto gathered = [&](const FarEnd& far, Stream stream) {
        Progress counted;
        double sum = 0;
        for (const IrradianceRecord& r : gather_records(room.world(), wall, far, options, stream, 24, counted))
            sum += (r.irradiance + r.excess).g;
        return std::pair{sum, static_cast<double>(counted.rays)};
    };
    const FarCells no_cells;
    const auto [traced, rays_traced] = gathered({}, Stream{20});
    const auto [read, rays_read] =
        gathered(far_end(room.world(), caches, options, progress, nullptr, &no_cells), Stream{21});
    CHECK(read == doctest::Approx(traced).epsilon(0.015));
    CHECK(rays_read < 0.9 * rays_traced);
}

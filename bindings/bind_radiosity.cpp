// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "base/error.h"
#include "methods/radiosity/radiosity_gathering.h"
#include "render/render.h"
#include "methods/radiosity/solve_radiosity.h"
#include "render_range.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

// A patch by name: triangle; 1 for the back, 2 for one of unknown light; lower and upper half of its path.
using PatchNames = Array<uint32_t, -1, 4>;
// Direct and total irradiance, albedo, emitted radiosity.
using PatchValues = Array<float, -1, 12>;

constexpr uint32_t back_bit = 1, unknown_bit = 2;

auto names_of(const std::vector<SolvedPatch>& patches) {
    auto* data = new uint32_t[4 * patches.size()];
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<uint32_t*>(p); });
    for (size_t i = 0; i < patches.size(); ++i) {
        const SolvedPatch& p = patches[i];
        data[4 * i] = p.name.triangle;
        data[4 * i + 1] = (p.name.back ? back_bit : 0) | (p.unknown ? unknown_bit : 0);
        data[4 * i + 2] = static_cast<uint32_t>(p.name.path);
        data[4 * i + 3] = static_cast<uint32_t>(p.name.path >> 32);
    }
    return nb::ndarray<nb::numpy, uint32_t>(data, {patches.size(), 4}, owner);
}

auto values_of(const std::vector<SolvedPatch>& patches) {
    return float_array({patches.size(), 12}, [&](float* data) {
        for (const SolvedPatch& p : patches)
            for (const Color& c : {p.direct, p.total, p.albedo, p.emitted})
                for (int k = 0; k < 3; ++k) *data++ = c[k];
    });
}

std::vector<SolvedPatch> patches_of(const PatchNames& names, const PatchValues& values) {
    require(names.shape(0) == values.shape(0), "patches: expected as many names as values");
    std::vector<SolvedPatch> patches(names.shape(0));
    for (size_t i = 0; i < patches.size(); ++i) {
        SolvedPatch& p = patches[i];
        const auto color = [&](size_t at) { return Color(values(i, at), values(i, at + 1), values(i, at + 2)); };
        p.name = {names(i, 0), (names(i, 1) & back_bit) != 0, names(i, 2) | uint64_t(names(i, 3)) << 32};
        p.unknown = (names(i, 1) & unknown_bit) != 0;
        p.direct = color(0), p.total = color(3), p.albedo = color(6), p.emitted = color(9);
    }
    return patches;
}

/// Patches, their values and corners; the numbers of links and sweeps, the residual, and the error of sums of form factors
/// before they were balanced.
auto solve(const CoreScene& scene, Progress& progress, float patch_size, size_t patches, int refinements,
           float tolerance, int solver, int bounces, uint32_t seed, int threads) {
    const RadiosityOptions options{patch_size, patches, refinements, tolerance, static_cast<RadiositySolver>(solver),
                                   bounces,    seed,    threads};
    SolvedRadiosity solved;
    std::vector<Vec3> corners;
    {
        const nb::gil_scoped_release unlocked;
        solved = solve_radiosity(scene.world(), options, progress);
        std::vector<PatchName> names;
        for (const SolvedPatch& p : solved.patches) names.push_back(p.name);
        const PatchTree tree(*scene.geometry, names);
        for (const PatchName& name : names)
            for (const Vec3& corner : tree[tree.find(name)].corner) corners.push_back(corner);
    }
    auto placed = float_array({solved.patches.size(), 3, 3}, [&](float* data) {
        for (const Vec3& c : corners)
            for (int k = 0; k < 3; ++k) *data++ = c[k];
    });
    const std::array<double, 5> numbers{double(solved.links), double(solved.sweeps), double(solved.residual),
                                        double(solved.closure_error), double(solved.tolerance)};
    return std::make_tuple(names_of(solved.patches), values_of(solved.patches), std::move(placed), numbers);
}

void render_field(const CoreScene& scene, const Camera& camera, Film& film, Progress& progress,
                  const RadiosityField& field, int gather_rays, int max_depth, SampleCounts first, SampleCounts end,
                  std::array<int, 4> crop, uint32_t seed, int threads, int filter, std::vector<uint32_t> tile_order) {
    const World world = scene.world();
    const Estimator estimate = [&](std::span<const PathRay> rays, std::span<PathResult> results, Progress& counted) {
        trace_to_patches(world, field, gather_rays, max_depth, rays, results, counted);
    };
    render(camera, estimate, render_range(first, end, crop, seed, threads, filter, std::move(tile_order)), film,
           progress);
}

auto irradiance_at_points(const CoreScene& scene, Points positions, Points normals, const RadiosityField& field,
                          Progress& progress, int component, int samples, int max_depth, uint32_t seed, int threads) {
    const auto points = points_with_normals(positions, normals);
    const PointIrradianceOptions options{static_cast<Component>(component), samples, max_depth, seed, threads};
    std::vector<Color> values;
    {
        const nb::gil_scoped_release unlocked;
        values = radiosity_irradiance(scene.world(), points, field, options, progress);
    }
    return color_array(values);
}

}  // namespace

void bind_radiosity(nb::module_& m) {
    nb::class_<RadiosityField>(m, "RadiosityField")
        .def(
            "__init__",
            [](RadiosityField* field, const CoreScene& scene, PatchNames names, PatchValues values, int threads) {
                const auto patches = patches_of(names, values);
                const nb::gil_scoped_release unlocked;
                new (field) RadiosityField(*scene.geometry, patches, threads);
            },
            nb::keep_alive<1, 2>());
    m.def("solve_radiosity", &solve, "scene"_a, "progress"_a, "patch_size"_a, "patches"_a, "refinements"_a,
          "tolerance"_a, "solver"_a, "bounces"_a, "seed"_a, "threads"_a);
    m.def("render_radiosity", &render_field, "scene"_a, "camera"_a, "film"_a, "progress"_a, "field"_a, "gather_rays"_a,
          "max_depth"_a, "first"_a, "end"_a, "crop"_a, "seed"_a, "threads"_a, "filter"_a, "tile_order"_a,
          nb::call_guard<nb::gil_scoped_release>());
    m.def("irradiance_by_radiosity", &irradiance_at_points, "scene"_a, "positions"_a, "normals"_a, "field"_a,
          "progress"_a, "component"_a, "samples"_a, "max_depth"_a, "seed"_a, "threads"_a);
}

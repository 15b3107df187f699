// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "methods/irradiance_cache/irradiance_cache.h"
#include "methods/irradiance_cache/cached_irradiance.h"
#include "methods/radiance_cache/radiance_cache.h"
#include "render/render.h"
#include "render_range.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

PathOptions path_options(int max_depth, int roulette_depth, const SolvedCaches* caches) {
    PathOptions options;
    options.max_depth = max_depth;
    options.roulette_depth = roulette_depth;
    if (caches) {
        options.light_set = LightSet::without_environment_image;
        options.cache = read_near(*caches);
        if (max_depth < 0 && !caches->far.records().empty()) options.far_cache = read_far(caches->far);
        options.light_samples = cached_light_samples;
        options.miss_paths = cached_miss_paths;
        options.gloss_paths = cached_gloss_paths;
    }
    return options;
}

void render_samples(const CoreScene& scene, const Camera& camera, Film& film, Progress& progress, int max_depth,
                    int roulette_depth, const SolvedCaches* caches, const RadianceTables* tables, SampleCounts first,
                    SampleCounts end, std::array<int, 4> crop, uint32_t seed, int threads, int filter,
                    std::vector<uint32_t> tile_order) {
    PathOptions options = path_options(max_depth, roulette_depth, caches);
    options.coherence = Coherence::camera;
    if (caches && tables) options.reflection = read_radiance(caches->radiance, *tables);
    render(scene.world(), camera, options, render_range(first, end, crop, seed, threads, filter, std::move(tile_order)),
           film, progress);
}

PointIrradianceOptions point_options(int component, int samples, int max_depth, uint32_t seed, int threads) {
    return {static_cast<Component>(component), samples, max_depth, seed, threads};
}

auto irradiance_by_paths(const CoreScene& scene, Points positions, Points normals, Progress& progress, int component,
                         int samples, int max_depth, uint32_t seed, int threads) {
    const auto points = points_with_normals(positions, normals);
    std::vector<Color> out;
    {
        const nb::gil_scoped_release unlocked;
        out = path_irradiance(scene.world(), points, point_options(component, samples, max_depth, seed, threads),
                              progress);
    }
    return color_array(out);
}

auto irradiance_from_caches(const CoreScene& scene, Points positions, Points normals, const SolvedCaches& caches,
                            const IrradianceCacheOptions& cache_options, Progress& progress, int component, int samples,
                            uint32_t seed, int threads) {
    const auto points = points_with_normals(positions, normals);
    CachedPoints out;
    {
        const nb::gil_scoped_release unlocked;
        out = cached_irradiance(scene.world(), points, caches, cache_options,
                                point_options(component, samples, -1, seed, threads), progress);
    }
    return std::make_tuple(color_array(out.irradiance), out.served, out.gathered);
}

template <class Get>
auto layer(const Film& film, Get&& get) {
    const auto& pixels = film.pixels();
    return float_array({size_t(film.height()), size_t(film.width()), 3}, [&](float* data) {
        for (size_t i = 0; i < pixels.size(); ++i) {
            const auto c = get(pixels[i]);
            for (int k = 0; k < 3; ++k) data[3 * i + k] = c[k];
        }
    });
}

/// (height, width): of each pixel's samples, how many were counted.
auto share(const Film& film, uint32_t Film::Pixel::* counted) {
    const auto& pixels = film.pixels();
    return float_array({size_t(film.height()), size_t(film.width())}, [&](float* data) {
        for (size_t i = 0; i < pixels.size(); ++i)
            data[i] = float(pixels[i].*counted) / std::max(1.0f, float(pixels[i].samples));
    });
}

}  // namespace

void bind_render(nb::module_& m) {
    nb::class_<Progress>(m, "Progress")
        .def(nb::init<>())
        .def("cancel", [](Progress& p) { p.cancelled = true; })
        .def_prop_ro("done", [](const Progress& p) { return p.done.load(); })
        .def_prop_ro("total", [](const Progress& p) { return p.total.load(); })
        .def_prop_ro("rays", [](const Progress& p) { return p.rays.load(); });
    nb::exception<Cancelled>(m, "Cancelled");
    nb::class_<Camera>(m, "Camera")
        .def("__init__", [](Camera* c, std::array<float, 3> right, std::array<float, 3> up,
                            std::array<float, 3> backward, std::array<float, 3> position, std::array<int, 2> size,
                            std::array<float, 2> half, std::array<float, 2> shift, float aperture_radius,
                            float focus_distance, bool orthographic) {
            new (c) Camera{vec3(right), vec3(up), vec3(backward),       vec3(position),  size[0],        size[1],
                           half[0],     half[1],  {shift[0], shift[1]}, aperture_radius, focus_distance, orthographic};
        });
    nb::class_<Film>(m, "Film")
        .def(nb::init<int, int>())
        .def("copy", [](const Film& f) { return Film(f); })
        .def_prop_ro(
            "radiance",
            [](const Film& f) {
                return layer(f,
                             [](const Film::Pixel& p) { return p.radiance * (1 / std::max(1.0f, float(p.samples))); });
            },
            nb::rv_policy::move)
        .def_prop_ro(
            "direct",
            [](const Film& f) {
                return layer(f, [](const Film::Pixel& p) { return p.direct * (1 / std::max(1.0f, float(p.samples))); });
            },
            nb::rv_policy::move)
        .def_prop_ro(
            "albedo",
            [](const Film& f) {
                return layer(f, [](const Film::Pixel& p) { return p.albedo * (1 / std::max(1.0f, float(p.samples))); });
            },
            nb::rv_policy::move)
        .def_prop_ro(
            "normal",
            [](const Film& f) {
                return layer(f, [](const Film::Pixel& p) { return p.normal * (1 / std::max(1.0f, float(p.samples))); });
            },
            nb::rv_policy::move)
        .def_prop_ro(
            "depth",
            [](const Film& f) {
                return float_array({size_t(f.height()), size_t(f.width())}, [&](float* data) {
                    for (size_t i = 0; i < f.pixels().size(); ++i)
                        data[i] = f.pixels()[i].hits ? f.pixels()[i].distance / float(f.pixels()[i].hits) : infinity;
                });
            },
            nb::rv_policy::move)
        .def_prop_ro(
            "gloss_cached", [](const Film& f) { return share(f, &Film::Pixel::gloss_cached); }, nb::rv_policy::move)
        .def_prop_ro(
            "gloss_traced", [](const Film& f) { return share(f, &Film::Pixel::gloss_traced); }, nb::rv_policy::move)
        .def_prop_ro("cache_misses",
                     [](const Film& f) {
                         uint64_t sum = 0;
                         for (const auto& p : f.pixels()) sum += p.cache_misses;
                         return sum;
                     })
        .def_prop_ro("bad_count", &Film::bad_count)
        .def_prop_ro("bad_samples", [](const Film& f) {
            std::vector<std::tuple<int, int, uint32_t>> out;
            for (const BadSample& b : f.bad_samples()) out.emplace_back(b.x, b.y, b.sample);
            return out;
        });
    m.def("render_samples", &render_samples, "scene"_a, "camera"_a, "film"_a, "progress"_a, "max_depth"_a,
          "roulette_depth"_a, "caches"_a.none(), "tables"_a.none(), "first"_a, "end"_a, "crop"_a, "seed"_a, "threads"_a,
          "filter"_a, "tile_order"_a, nb::call_guard<nb::gil_scoped_release>());
    m.def("irradiance_by_paths", &irradiance_by_paths, "scene"_a, "positions"_a, "normals"_a, "progress"_a,
          "component"_a, "samples"_a, "max_depth"_a, "seed"_a, "threads"_a);
    m.def("irradiance_from_caches", &irradiance_from_caches, "scene"_a, "positions"_a, "normals"_a, "caches"_a,
          "cache_options"_a, "progress"_a, "component"_a, "samples"_a, "seed"_a, "threads"_a);
}

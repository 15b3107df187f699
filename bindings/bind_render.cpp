// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "estimators.h"
#include "methods/irradiance_cache/cached_paths.h"
#include "render/render.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

/// The numbers of samples: one for each pixel of the picture, or one for all.
using SampleCounts = Array<uint32_t, -1>;

void render_samples(const Camera& camera, Film& film, const EstimatorHolder& estimator, const RenderRange& asked,
                    const SampleCounts& first, const SampleCounts& end, Progress& progress) {
    RenderRange range = asked;
    const std::span<const uint32_t> firsts(first.data(), first.size()), ends(end.data(), end.size());
    require(!ends.empty() && firsts.size() == ends.size(), "first, end: expected as many of each");
    range.first_sample = std::ranges::min(firsts), range.end_sample = std::ranges::max(ends);
    if (ends.size() > 1) range.first_samples = firsts, range.end_samples = ends;
    render(camera, estimator.call, range, film, progress);
}

auto irradiance(Points positions, Points normals, const PointEstimatorHolder& estimator,
                const PointIrradianceOptions& options, Progress& progress) {
    const auto points = points_with_normals(positions, normals);
    std::vector<float> errors(points.size(), 0.0f);
    PointIrradianceOptions asked = options;
    asked.direct_errors = errors;
    PointIrradiance found;
    {
        const nb::gil_scoped_release unlocked;
        found = estimator.call(points, asked, progress);
    }
    std::optional<std::pair<size_t, size_t>> served;
    if (found.served) served = {found.served->served, found.served->gathered};
    auto direct_errors = float_array({errors.size()}, [&](float* data) { std::ranges::copy(errors, data); });
    return std::make_tuple(color_array(found.values), served, std::move(direct_errors));
}

using FoundRadiance = Array<float, -1, 2, 3>;

/// An estimator that calls a function in Python. The function takes origins and directions (rays, 3) and a random key
/// for each ray, and returns the radiance and its part from paths with at most two edges, (rays, 2, 3). The albedo,
/// normal and depth of visible surfaces are computed here, so that they are the same for all methods.
Estimator called_estimator(const World& world, nb::object function) {
    PathOptions first_edge;
    first_edge.max_depth = 1;
    const Estimator first_hits = path_estimator(world, first_edge);
    return [first_hits, function](std::span<const PathRay> rays, std::span<PathResult> results, Progress& progress) {
        first_hits(rays, results, progress);
        const nb::gil_scoped_acquire locked;
        std::vector<Color> origins, directions;
        for (const PathRay& r : rays) {
            origins.push_back({r.ray.origin.x, r.ray.origin.y, r.ray.origin.z});
            directions.push_back({r.ray.direction.x, r.ray.direction.y, r.ray.direction.z});
        }
        auto numbers = float_array({rays.size()}, [&](float* data) {
            for (const PathRay& r : rays) *data++ = Sampler(r.sampler).next_1d();
        });
        const nb::object found = function(color_array(origins), color_array(directions), std::move(numbers));
        const auto radiance = nb::cast<FoundRadiance>(found);
        require(radiance.shape(0) == rays.size(), "estimator: expected radiance for " + std::to_string(rays.size()) +
                                                      " rays, got " + std::to_string(radiance.shape(0)));
        for (size_t i = 0; i < rays.size(); ++i) {
            results[i].radiance = {radiance(i, 0, 0), radiance(i, 0, 1), radiance(i, 0, 2)};
            results[i].direct = {radiance(i, 1, 0), radiance(i, 1, 1), radiance(i, 1, 2)};
        }
    };
}

/// A function in Python: positions and normals, (points, 3) each, and the name of the component → irradiance (points, 3).
PointEstimator called_point_estimator(nb::object function) {
    return [function](std::span<const PointNormal> points, const PointIrradianceOptions& options, Progress& progress) {
        progress.begin(1);
        const nb::gil_scoped_acquire locked;
        std::vector<Color> positions, normals;
        for (const PointNormal& p : points) {
            positions.push_back({p.position.x, p.position.y, p.position.z});
            normals.push_back({p.normal.x, p.normal.y, p.normal.z});
        }
        const nb::object found = function(color_array(positions), color_array(normals), options.component);
        const auto values = nb::cast<Points>(found);
        require(values.shape(0) == points.size(), "estimator: expected irradiance at " + std::to_string(points.size()) +
                                                      " points, got " + std::to_string(values.shape(0)));
        PointIrradiance out;
        for (size_t i = 0; i < points.size(); ++i) out.values.push_back({values(i, 0), values(i, 1), values(i, 2)});
        return out;
    };
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

/// Returns the number of samples that were counted in each pixel, (height, width).
auto share(const Film& film, uint32_t Film::Pixel::* counted) {
    const auto& pixels = film.pixels();
    return float_array({size_t(film.height()), size_t(film.width())}, [&](float* data) {
        for (size_t i = 0; i < pixels.size(); ++i)
            data[i] = float(pixels[i].*counted) / std::max(1.0f, float(pixels[i].samples));
    });
}

/// Makes a layer of `values` of pixels, each divided by the number of the pixel's samples.
template <class Value>
auto mean_layer(Value Film::Pixel::* value) {
    return [value](const Film& f) {
        return layer(f, [&](const Film::Pixel& p) { return p.*value * (1 / std::max(1.0f, float(p.samples))); });
    };
}

auto depth_layer(const Film& f) {
    return float_array({size_t(f.height()), size_t(f.width())}, [&](float* data) {
        for (const Film::Pixel& p : f.pixels()) *data++ = p.hits ? p.distance / float(p.hits) : infinity;
    });
}

void bind_progress(nb::module_& m) {
    nb::class_<Progress>(m, "Progress")
        .def(nb::init<>())
        .def("cancel", [](Progress& p) { p.cancelled = true; })
        .def_prop_ro("done", [](const Progress& p) { return p.done.load(); })
        .def_prop_ro("total", [](const Progress& p) { return p.total.load(); })
        .def_prop_ro("rays", [](const Progress& p) { return p.rays.load(); });
    nb::exception<Cancelled>(m, "Cancelled");
}

void bind_camera(nb::module_& m) {
    using Three = std::array<float, 3>;
    using Pair = std::array<float, 2>;
    nb::class_<Camera>(m, "Camera")
        .def(
            "__init__",
            [](Camera* c, const std::array<Three, 3>& axes, const Three& position, std::array<int, 2> size,
               Pair half_extent, Pair shift, Pair lens, bool orthographic) {
                new (c) Camera{.right = vec3(axes[0]),
                               .up = vec3(axes[1]),
                               .backward = vec3(axes[2]),
                               .position = vec3(position),
                               .width = size[0],
                               .height = size[1],
                               .half_width = half_extent[0],
                               .half_height = half_extent[1],
                               .shift = {shift[0], shift[1]},
                               .aperture_radius = lens[0],
                               .focus_distance = lens[1],
                               .orthographic = orthographic};
            },
            nb::kw_only(), "axes"_a, "position"_a, "size"_a, "half_extent"_a, "shift"_a, "lens"_a, "orthographic"_a,
            "axes: what points right, up and backward; lens: radius of the aperture and distance of the focus.");
}

constexpr Color Film::Pixel::* summed_colors[] = {&Film::Pixel::radiance, &Film::Pixel::direct, &Film::Pixel::albedo,
                                                  &Film::Pixel::rough_albedo};
constexpr Vec3 Film::Pixel::* summed_normals[] = {&Film::Pixel::normal, &Film::Pixel::rough_normal};
constexpr uint32_t Film::Pixel::* counted[] = {&Film::Pixel::samples, &Film::Pixel::hits, &Film::Pixel::cache_misses,
                                               &Film::Pixel::gloss_cached, &Film::Pixel::gloss_traced};
constexpr size_t numbers_of_pixel = 3 * (std::size(summed_colors) + std::size(summed_normals)) + 1 + std::size(counted);

using FilmSums = Array<float, -1, -1, static_cast<int>(numbers_of_pixel)>;

/// Calls `visit` for the pixels of a rectangle of the film, row by row.
template <class AnyFilm, class Visit>
void for_pixels(AnyFilm& film, int x0, int y0, size_t width, size_t height, Visit&& visit) {
    require(x0 >= 0 && y0 >= 0 && size_t(x0) + width <= size_t(film.width()) &&
                size_t(y0) + height <= size_t(film.height()),
            "film: expected a rectangle inside " + std::to_string(film.width()) + "x" + std::to_string(film.height()) +
                " pixels, got one of " + std::to_string(width) + "x" + std::to_string(height) + " at (" +
                std::to_string(x0) + ", " + std::to_string(y0) + ")");
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x)
            visit(film.pixels()[(size_t(y0) + y) * size_t(film.width()) + size_t(x0) + x]);
}

auto sums_within(const Film& film, std::array<int, 4> rectangle) {
    const auto [x0, y0, x1, y1] = rectangle;
    require(x0 <= x1 && y0 <= y1, "film: expected a rectangle with x0 <= x1 and y0 <= y1");
    const auto width = static_cast<size_t>(x1 - x0), height = static_cast<size_t>(y1 - y0);
    return float_array({height, width, numbers_of_pixel}, [&](float* data) {
        for_pixels(film, x0, y0, width, height, [&](const Film::Pixel& p) {
            for (const auto color : summed_colors)
                for (int k = 0; k < 3; ++k) *data++ = (p.*color)[k];
            for (const auto normal : summed_normals)
                for (int k = 0; k < 3; ++k) *data++ = (p.*normal)[k];
            *data++ = p.distance;
            for (const auto count : counted) *data++ = static_cast<float>(p.*count);
        });
    });
}

auto film_sums(const Film& film) { return sums_within(film, {0, 0, film.width(), film.height()}); }

void restore_within(Film& film, const FilmSums& sums, int x0, int y0) {
    const float* data = sums.data();
    for_pixels(film, x0, y0, sums.shape(1), sums.shape(0), [&](Film::Pixel& p) {
        for (const auto color : summed_colors) p.*color = {data[0], data[1], data[2]}, data += 3;
        for (const auto normal : summed_normals) p.*normal = {data[0], data[1], data[2]}, data += 3;
        p.distance = *data++;
        for (const auto count : counted) p.*count = static_cast<uint32_t>(*data++);
    });
}

void restore_film(Film& film, const FilmSums& sums) {
    require(sums.shape(0) == size_t(film.height()) && sums.shape(1) == size_t(film.width()),
            "sums: expected " + std::to_string(film.width()) + "x" + std::to_string(film.height()) + " pixels, got " +
                std::to_string(sums.shape(1)) + "x" + std::to_string(sums.shape(0)));
    restore_within(film, sums, 0, 0);
}

void bind_film(nb::module_& m) {
    nb::class_<Film>(m, "Film")
        .def(nb::init<int, int, int, int>(), "width"_a, "height"_a, "x0"_a = 0, "y0"_a = 0)
        .def("copy", [](const Film& f) { return Film(f); })
        .def_prop_ro("radiance", mean_layer(&Film::Pixel::radiance), nb::rv_policy::move)
        .def_prop_ro("direct", mean_layer(&Film::Pixel::direct), nb::rv_policy::move)
        .def_prop_ro("albedo", mean_layer(&Film::Pixel::albedo), nb::rv_policy::move)
        .def_prop_ro("normal", mean_layer(&Film::Pixel::normal), nb::rv_policy::move)
        .def_prop_ro("rough_albedo", mean_layer(&Film::Pixel::rough_albedo), nb::rv_policy::move)
        .def_prop_ro("rough_normal", mean_layer(&Film::Pixel::rough_normal), nb::rv_policy::move)
        .def("interleave", &Film::interleave, "other"_a,
             "Adds the samples of another film; ours are the even ones from then on.")
        .def("sums", &film_sums, nb::rv_policy::move, "What has been added up, (height, width, numbers).")
        .def("restore", &restore_film, "sums"_a, "Goes on from what `sums` gave.")
        .def("sums_within", &sums_within, "rectangle"_a, nb::rv_policy::move, "The sums of (x0, y0, x1, y1).")
        .def("restore_within", &restore_within, "sums"_a, "x0"_a, "y0"_a, "Replaces those of a rectangle.")
        .def(
            "add_bad",
            [](Film& f, uint64_t count, const std::vector<std::tuple<int, int, uint32_t>>& first) {
                std::vector<BadSample> bad;
                for (const auto& [x, y, sample] : first) bad.push_back({x, y, sample});
                f.add_bad(count, bad);
            },
            "count"_a, "first"_a, "Counts samples of a part of the picture that were not finite.")
        .def_prop_ro("depth", &depth_layer, nb::rv_policy::move)
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
}

void bind_pixels(nb::module_& m) {
    nb::class_<FinishedTiles>(m, "FinishedTiles")
        .def(nb::init<>())
        .def(
            "take",
            [](FinishedTiles& tiles) {
                std::vector<std::tuple<int, int, Film>> taken;
                for (const FinishedTile& tile : tiles.take()) taken.emplace_back(tile.x, tile.y, tile.film);
                return taken;
            },
            "The column and row of the upper left pixel, and a copy of the film, of each tile since the last call.");
    nb::enum_<Filter>(m, "Filter").value("box", Filter::box).value("tent", Filter::tent);
    nb::class_<RenderRange>(m, "RenderRange")
        .def(
            "__init__",
            [](RenderRange* r, std::array<int, 4> crop, uint32_t seed, int threads, Filter filter,
               std::vector<uint32_t> tile_order, FinishedTiles* finished) {
                auto& range = *new (r) RenderRange{};
                range.x0 = crop[0], range.y0 = crop[1], range.x1 = crop[2], range.y1 = crop[3];
                range.seed = seed, range.threads = threads, range.filter = filter;
                range.tile_order = std::move(tile_order), range.finished = finished;
            },
            nb::kw_only(), "crop"_a, "seed"_a, "threads"_a, "filter"_a, "tile_order"_a, "finished"_a = nb::none(),
            nb::keep_alive<1, 7>());
    m.def("render", &render_samples, "camera"_a, "film"_a, "estimator"_a, "range"_a, "first"_a, "end"_a, "progress"_a,
          nb::call_guard<nb::gil_scoped_release>(), "Adds samples [first, end) of each pixel, or of all, to `film`.");
}

void bind_points(nb::module_& m) {
    nb::enum_<Component>(m, "Component")
        .value("total", Component::total)
        .value("direct", Component::direct)
        .value("indirect", Component::indirect);
    nb::class_<PointIrradianceOptions>(m, "PointIrradianceOptions")
        .def(
            "__init__",
            [](PointIrradianceOptions* o, Component component, int samples, int max_depth, uint32_t seed, int threads,
               uint32_t first) { new (o) PointIrradianceOptions{component, samples, max_depth, seed, threads, first}; },
            nb::kw_only(), "component"_a, "samples"_a, "max_depth"_a, "seed"_a, "threads"_a, "first"_a = 0,
            "first: the index of the first point, if the points are a range of more.");
    m.def("irradiance", &irradiance, "positions"_a, "normals"_a, "estimator"_a, "options"_a, "progress"_a,
          "Irradiance (points, 3), and how many points a cache served and did not, or None where there is none.");
}

void bind_estimators(nb::module_& m) {
    nb::class_<EstimatorHolder>(m, "Estimator");
    nb::class_<PointEstimatorHolder>(m, "PointEstimator");
    m.def(
        "path_estimator",
        [](const CoreScene& scene, int max_depth, int roulette_depth) {
            PathOptions options;
            options.max_depth = max_depth, options.roulette_depth = roulette_depth;
            return EstimatorHolder{path_estimator(scene.world(), options)};
        },
        nb::keep_alive<0, 1>(), "scene"_a, nb::kw_only(), "max_depth"_a, "roulette_depth"_a);
    m.def(
        "path_point_estimator",
        [](const CoreScene& scene, int max_depth) {
            return PointEstimatorHolder{path_point_estimator(scene.world(), max_depth)};
        },
        nb::keep_alive<0, 1>(), "scene"_a, nb::kw_only(), "max_depth"_a);
    m.def(
        "cached_path_estimator",
        [](const CoreScene& scene, const SolvedCaches& caches, const RadianceTables* tables, int max_depth,
           const PathGuide* guide) {
            return EstimatorHolder{cached_path_estimator(scene.world(), caches, tables, max_depth, guide)};
        },
        nb::keep_alive<0, 1>(), nb::keep_alive<0, 2>(), nb::keep_alive<0, 3>(), nb::keep_alive<0, 5>(), "scene"_a,
        "caches"_a, "tables"_a.none(), nb::kw_only(), "max_depth"_a, "guide"_a = nb::none());
    nb::class_<PathGuide>(m, "PathGuide").def("__len__", &PathGuide::size);
    m.def(
        "learn_path_guide",
        [](const CoreScene& scene, const SolvedCaches& caches, int max_depth, int threads, Progress& progress) {
            return learn_path_guide(scene.world(), caches, max_depth, threads, progress);
        },
        "scene"_a, "caches"_a, "max_depth"_a, "threads"_a, "progress"_a, nb::call_guard<nb::gil_scoped_release>());
    m.def(
        "cached_point_estimator",
        [](const CoreScene& scene, const SolvedCaches& caches, const IrradianceCacheOptions& options) {
            return PointEstimatorHolder{cached_point_estimator(scene.world(), caches, options)};
        },
        nb::keep_alive<0, 1>(), nb::keep_alive<0, 2>(), "scene"_a, "caches"_a, "options"_a);
    m.def(
        "called_estimator",
        [](const CoreScene& scene, nb::object function) {
            return EstimatorHolder{called_estimator(scene.world(), std::move(function))};
        },
        nb::keep_alive<0, 1>(), "scene"_a, "function"_a);
    m.def(
        "called_point_estimator",
        [](nb::object function) { return PointEstimatorHolder{called_point_estimator(std::move(function))}; },
        "function"_a);
}

}  // namespace

void bind_render(nb::module_& m) {
    bind_progress(m);
    bind_camera(m);
    bind_film(m);
    bind_pixels(m);
    bind_points(m);
    bind_estimators(m);
}

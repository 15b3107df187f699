// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>

#include "micro/lazy_fill.h"
#include "micro/replay.h"
#include "world_holder.h"

namespace nb = nanobind;
using namespace eclat;
using namespace nb::literals;

namespace {

struct GatherPoints {
    std::vector<Candidate> candidates;
};

/// What the camera sees through the centres of every `stride`-th pixel.
GatherPoints gather_points(const CoreScene& scene, const Camera& camera, const IrradianceCacheOptions& options,
                           int stride, Progress& progress) {
    std::vector<Vec2> pixels;
    for (int y = stride / 2; y < camera.height; y += stride)
        for (int x = stride / 2; x < camera.width; x += stride)
            pixels.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
    return {camera_candidates(scene.world(), camera, pixels, options, progress)};
}

size_t gather(const CoreScene& scene, const GatherPoints& points, const SolvedCaches& caches,
              const IrradianceCacheOptions& options, Progress& progress) {
    constexpr uint32_t stream = 18;  // of random numbers
    return gather_records(scene.world(), points.candidates, caches.far, options, stream, options.rows, progress).size();
}

}  // namespace

void bind_probe(nb::module_& m) {
    m.def("start_timing", &start_timing);
    m.def(
        "stop_timing",
        [] {
            const TimeInside t = stop_timing();
            return std::pair(t.seconds, t.rays);
        },
        "Seconds inside Embree, summed over threads, and rays, since start_timing.");
    m.def("start_recording", &start_recording);
    m.def("stop_recording", &stop_recording);
    nb::class_<RayRecording>(m, "RayRecording")
        .def_prop_ro("nearest", [](const RayRecording& r) { return r.nearest.size(); })
        .def_prop_ro("shadow", [](const RayRecording& r) { return r.shadow.size(); })
        .def(
            "replay",
            [](const RayRecording& r, int width, bool coherent, int threads) {
                return replay(r, {width, coherent, threads});
            },
            "width"_a, "coherent"_a, "threads"_a, nb::call_guard<nb::gil_scoped_release>(), "Seconds of bare Embree.");
    nb::class_<GatherPoints>(m, "GatherPoints").def("__len__", [](const GatherPoints& p) {
        return p.candidates.size();
    });
    m.def("gather_points", &gather_points, "scene"_a, "camera"_a, "options"_a, "stride"_a, "progress"_a,
          nb::call_guard<nb::gil_scoped_release>());
    m.def("gather", &gather, "scene"_a, "points"_a, "caches"_a, "options"_a, "progress"_a,
          nb::call_guard<nb::gil_scoped_release>(), "Number of records.");
    m.def(
        "fill_lazily",
        [](const CoreScene& scene, const Camera& camera, const IrradianceCacheOptions& options, Progress& progress) {
            return fill_lazily(scene.world(), camera, options, progress);
        },
        "scene"_a, "camera"_a, "options"_a, "progress"_a, nb::call_guard<nb::gil_scoped_release>());
}

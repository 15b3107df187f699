// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "arrays.h"
#include "methods/irradiance_cache/records_in_use.h"
#include "methods/radiance_cache/radiance_cache.h"
#include "record_arrays.h"
#include "records/renewal.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

auto floats(const std::vector<float>& values) {
    return float_array({values.size()}, [&](float* data) { std::ranges::copy(values, data); });
}

std::vector<Renewal> renewals_of(const Array<float, -1, -1>& records, const Points& shading_normals,
                                 const Array<uint32_t, -1>& keys) {
    const auto old = records_of(records);
    const auto shading = vec3s(shading_normals);
    if (old.size() != shading.size() || old.size() != keys.shape(0))
        throw std::invalid_argument("expected as many shading normals and keys as records");
    std::vector<Renewal> renewals;
    for (size_t i = 0; i < old.size(); ++i) renewals.push_back({old[i], shading[i], keys(i)});
    return renewals;
}

std::vector<IrradianceRecord> records_in(const std::vector<Renewed>& renewed) {
    std::vector<IrradianceRecord> out;
    for (const Renewed& r : renewed) out.push_back(r.record);
    return out;
}

/// Returns the renewed records (records, floats), the number of cells of each grid (records,), and the luminance of each
/// cell, one record after the other.
auto renew_records(const CoreScene& scene, const SolvedCaches& caches, const RenewalSettings& settings,
                   const IrradianceCacheOptions& options, const Array<float, -1, -1>& records,
                   const Points& shading_normals, const Array<uint32_t, -1>& keys, Progress& progress) {
    const auto renewals = renewals_of(records, shading_normals, keys);
    std::vector<Renewed> renewed;
    {
        const nb::gil_scoped_release unlocked;
        const FarEnd far = far_end(scene.world(), caches, options, progress);
        renewed = renew({scene.world(), far, settings, options, nullptr}, renewals, progress);
    }
    std::vector<float> counts, seen;
    for (const Renewed& r : renewed) {
        counts.push_back(static_cast<float>(r.seen.size()));
        seen.insert(seen.end(), r.seen.begin(), r.seen.end());
    }
    return std::make_tuple(to_array(records_in(renewed)), floats(counts), floats(seen));
}

/// Returns the renewed records (records, floats) and their coefficients (records, 9 order²): the values of each channel, then
/// the gradients of each along u, then along v, in the frame that all records around the same normal have.
auto renew_radiance(const CoreScene& scene, const SolvedCaches& caches, float mean, const RadianceCacheOptions& options,
                    const Array<float, -1, -1>& records, const Points& shading_normals, const Array<uint32_t, -1>& keys,
                    Progress& progress) {
    const auto renewals = renewals_of(records, shading_normals, keys);
    std::vector<Renewed> renewed;
    {
        const nb::gil_scoped_release unlocked;
        const IrradianceCacheOptions gathering = radiance_gathering(options);
        const FarEnd far = far_end(scene.world(), caches, gathering, progress);
        const RadianceProjection projection(options.order, Rows::balanced, options.rows);
        const RenewalSettings settings{{}, RecordKind::radiance, mean};
        renewed = renew({scene.world(), far, settings, gathering, &projection}, renewals, progress);
    }
    const size_t width = 9 * size_t(coefficient_count(options.order));
    auto coefficients = float_array({renewed.size(), width}, [&](float* data) {
        for (const Renewed& r : renewed) {
            data = std::ranges::copy(r.coefficients.values, data).out;
            data = std::ranges::copy(r.coefficients.gradients, data).out;
        }
    });
    return std::make_tuple(to_array(records_in(renewed)), std::move(coefficients));
}

}  // namespace

void bind_renewal(nb::module_& m) {
    nb::enum_<RecordKind>(m, "RecordKind")
        .value("near", RecordKind::near)
        .value("far", RecordKind::far)
        .value("radiance", RecordKind::radiance);
    nb::class_<BrightPlaces>(m, "BrightPlaces").def(nb::init<>());
    nb::class_<RenewalSettings>(m, "RenewalSettings")
        .def(
            "__init__",
            [](RenewalSettings* self, const BrightPlaces& bright, RecordKind kind, float mean) {
                new (self) RenewalSettings{bright, kind, mean};
            },
            "bright"_a, "kind"_a, "mean"_a);
    m.def("renew_records", &renew_records, "scene"_a, "caches"_a, "settings"_a, "options"_a, "records"_a,
          "shading_normals"_a, "keys"_a, "progress"_a,
          "Gathers records anew: their rows, the number of cells of each grid, and the luminance that each cell saw.");
    m.def("renew_radiance", &renew_radiance, "scene"_a, "caches"_a, "mean"_a, "options"_a, "records"_a,
          "shading_normals"_a, "keys"_a, "progress"_a,
          "Gathers records of radiance anew: their rows, and their values and gradients (records, 9 order²).");
    m.def(
        "records_in_use",
        [](const CoreScene& scene, const Camera& camera, const Array<float, -1, -1>& records,
           const IrradianceCacheOptions& options, Progress& progress) {
            RecordCache cache(options.cache);
            cache.insert(records_of(records), options.spacing, options.threads);
            std::vector<uint8_t> used;
            {
                const nb::gil_scoped_release unlocked;
                used = records_in_use(scene.world(), camera, cache, options, progress);
            }
            return float_array({used.size()}, [&](float* data) { std::ranges::copy(used, data); });
        },
        "scene"_a, "camera"_a, "records"_a, "options"_a, "progress"_a,
        "1 for each record (N,) that is read where the camera sees something, 0 for the others.");
    m.def(
        "tangents_around",
        [](const Points& normals) {
            return float_array({normals.shape(0), 3}, [&](float* data) {
                for (const Vec3& n : vec3s(normals)) {
                    const Vec3 u = Frame::around(n).u;
                    for (int k = 0; k < 3; ++k) *data++ = u[k];
                }
            });
        },
        "normals"_a, "The first axis (N, 3) of the frame of records around each normal.");
}

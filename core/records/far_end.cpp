// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A gather ray that hits a surface can end there if a coarse cache of irradiance, or photons, gives the light of that surface.
// Only averages over whole hemispheres use these values, so they may be inaccurate. But a short ray, as in a corner, hits a
// surface that fills a large part of the hemisphere, where inaccuracy would be visible. In a solve for a picture, it reads a
// cell of those of records/far_cells.cpp, or the near records that earlier passes made there, whose radii are small in corners.
// Where none serves, it is continued. One path finds a window only by chance, while each near record has averaged hundreds:
// without them, the records between the cushions of `living-room` deviate by 10 % (with them, 9), and the picture by 3.1 % (2.9).
//
// Symbol     name here     meaning                                                                   unit
//   κ        relaxation    how much farther than its radius a record is read                         1
//   t        distance      length of the gather ray                                                  m
//   R        radius        mean radius of the records that serve the point; read only where t ≥ R    m
//
// References   [Christensen99] gather rays that end in precomputed irradiance, [Ward88] records of earlier passes
// Bias         Gather rays see light that varies over distances below R only blurred.
// Held to      tests/core/methods/radiance_cache/test_far_end.cpp

#include "records/far_end.h"

namespace eclat {

CacheOptions far_reading(const CacheOptions& near) {
    CacheOptions far = near;
    far.relaxation =
        1.4f;  // chosen by judgement: a wider reach blurs light behind gaps, a narrower one continues more rays
    far.rotation_gradient = false;
    return far;
}

CachedIrradiance read_beyond_radius(const RecordCache& records) {
    return [&records](const SurfacePoint& point, float distance) -> std::optional<Color> {
        float radius = 0;
        auto E = records.interpolate(point.position, point.normal_towards_shading(), point.frame.n, &radius);
        if (!E || distance < radius) return std::nullopt;
        return E;
    };
}

CachedIrradiance read_far(const World& world, const PhotonMaps& photons, Progress& progress) {
    return [&](const SurfacePoint& point, float distance) {
        return far_irradiance(world, photons, {point, point.frame.n}, distance, -1, progress);
    };
}

namespace {

CachedIrradiance read_cells(const FarCells& cells) {
    return [&cells](const SurfacePoint& point, float distance) {
        return cells.irradiance(point.position, point.frame.n, distance);
    };
}

/// Reads `second` where `first` knows nothing or is empty.
CachedIrradiance either(CachedIrradiance first, CachedIrradiance second) {
    if (!first) return second;
    return [first = std::move(first), second = std::move(second)](const SurfacePoint& point, float distance) {
        const auto E = first(point, distance);
        return E ? E : second(point, distance);
    };
}

}  // namespace

CachedReflection read_radiance(const RadianceCache& cache, const RadianceTables& tables, Reading reading) {
    return [&cache, &tables, reading](SurfacePoint& point, Vec3 wo) -> Color {
        ReflectedFactors factors;
        tables.reflect(point.bsdf, wo, factors);
        if (factors.order == 0) return {};
        const auto reflected =
            cache.reflect(point.position, point.normal_towards_shading(), point.frame, factors, reading);
        if (!reflected) return {};
        set_cached(point.bsdf, factors);
        return *reflected;
    };
}

FarEnd far_end(const World& world, const SolvedCaches& caches, const IrradianceCacheOptions& options,
               Progress& progress, const RadianceTables* tables, const FarCells* cells) {
    FarEnd out;
    if (options.max_depth >= 0) return out;
    if (options.far_photons) {
        out.irradiance = read_far(world, *options.far_photons, progress);
    } else {
        if (!caches.far.records().empty()) out.irradiance = read_beyond_radius(caches.far);
        if (cells) {
            out.irradiance = either(std::move(out.irradiance), read_cells(*cells));
            if (!caches.near.records().empty())
                out.irradiance = either(std::move(out.irradiance), read_beyond_radius(caches.near));
            out.wants_samples = true;
        }
    }
    if (tables && !caches.radiance.records().empty())
        out.reflection = read_radiance(caches.radiance, *tables, Reading::nearest);
    return out;
}

SolvedCaches empty_caches(const IrradianceCacheOptions& options) {
    return {RecordCache(options.cache), RecordCache(far_reading(options.cache)), {}, 0};
}

}  // namespace eclat

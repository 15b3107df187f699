// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "integrators/render.h"

#include "base/parallel.h"

namespace eclat {

namespace {

constexpr int tile_size = 32;

/// Offset within a filter around the pixel's centre: importance-sampled, so that every sample counts alike and only
/// for its own pixel.
float filter_offset(Filter filter, float u) {
    if (filter == Filter::box) return u;
    // Tent of radius 1 around the centre.
    return 0.5f + (u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u));
}

void render_tile(const World& world, const Camera& camera, const PathOptions& options, const RenderRange& range, int tx,
                 int ty, Film& film, Progress& progress) {
    const int x_end = std::min(camera.width, (tx + 1) * tile_size),
              y_end = std::min(camera.height, (ty + 1) * tile_size);
    std::vector<PathRay> rays;
    std::vector<PathResult> results;
    for (uint32_t sample = range.first_sample; sample < range.end_sample; ++sample) {
        progress.check();
        rays.clear();
        for (int y = ty * tile_size; y < y_end; ++y)
            for (int x = tx * tile_size; x < x_end; ++x) {
                Sampler sampler(range.seed, static_cast<uint32_t>(y) * 65536u + static_cast<uint32_t>(x), sample);
                const Vec2 u = sampler.next_2d(), lens = sampler.next_2d();
                const float px = static_cast<float>(x) + filter_offset(range.filter, u.x);
                const float py = static_cast<float>(y) + filter_offset(range.filter, u.y);
                rays.push_back({camera.ray(px, py, lens), sampler});
            }
        results.resize(rays.size());
        trace_paths(world, rays, options, results, progress);
        size_t i = 0;
        for (int y = ty * tile_size; y < y_end; ++y)
            for (int x = tx * tile_size; x < x_end; ++x, ++i) {
                if (x < range.x0 || x >= range.x1 || y < range.y0 || y >= range.y1) continue;
                const PathResult& r = results[i];
                film.add(
                    x, y, sample,
                    {r.radiance, r.direct, r.albedo, r.normal, r.distance < infinity ? r.distance : 0, r.cache_missed});
            }
        progress.advance();
    }
}

}  // namespace

void render(const World& world, const Camera& camera, const PathOptions& options, const RenderRange& range, Film& film,
            Progress& progress) {
    std::vector<std::pair<int, int>> tiles;
    for (int ty = range.y0 / tile_size; ty * tile_size < range.y1; ++ty)
        for (int tx = range.x0 / tile_size; tx * tile_size < range.x1; ++tx) tiles.emplace_back(tx, ty);
    if (!range.tile_order.empty()) {
        require(range.tile_order.size() == tiles.size(),
                "tile_order: expected " + std::to_string(tiles.size()) + " tiles");
        const auto in_order = tiles;
        for (size_t i = 0; i < tiles.size(); ++i) tiles[i] = in_order[range.tile_order[i] % in_order.size()];
    }
    progress.begin(tiles.size() * (range.end_sample - range.first_sample));
    parallel_for(tiles.size(), range.threads, [&](size_t i) {
        render_tile(world, camera, options, range, tiles[i].first, tiles[i].second, film, progress);
    });
}

}  // namespace eclat

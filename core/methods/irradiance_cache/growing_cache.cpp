// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/irradiance_cache/growing_cache.h"

#include <utility>

namespace eclat {

namespace {

// The distance in pixels between the candidates of the passes that come before the far records, chosen by judgement: of a
// picture of 640 × 480, the first has 20 candidates and the second 60, whose whole paths take a fraction of a second.
constexpr float first_steps[] = {128, 64};

}  // namespace

GrowingCache::GrowingCache(const World& world, IrradianceCacheOptions options, const SolvedCaches& caches)
    : world_(world),
      options_(std::move(options)),
      caches_(caches.near.records().empty() && caches.far.records().empty() ? empty_caches(options_) : caches),
      solve_{caches_} {}

void GrowingCache::look(const Camera& camera) {
    passes_.clear();
    solve_.usual_footprint = 0;  // that of the view before
    const size_t view = views_++;
    const auto near = [this, camera, view](std::vector<Vec2> pixels, float step, bool after_far) {
        passes_.push_back([this, camera, view, pixels = std::move(pixels), step, after_far](Progress& progress) {
            solve_.read_cells = after_far;
            add_near_of_lattice(world_, camera, {pixels, step, view}, options_, solve_, progress);
        });
    };
    for (const float step : first_steps) near(lattice(camera, step, 0), step, false);
    passes_.push_back([this, camera](Progress& progress) {
        solve_far_for_cameras(world_, {&camera, 1}, options_, solve_, progress);
    });
    for_each_lattice({&camera, 1}, options_, [&](size_t, std::span<const Vec2> pixels, float step) {
        near({pixels.begin(), pixels.end()}, step, true);
    });
}

void GrowingCache::step(Progress& progress) {
    if (passes_.empty()) return;
    passes_.front()(progress);
    passes_.pop_front();
}

}  // namespace eclat

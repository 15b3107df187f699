// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiance_cache/growing_cache.h"

#include <algorithm>
#include <utility>

#include "methods/irradiance_cache/solve_points.h"

namespace eclat {

namespace {

// The distance in pixels between the candidates of the passes that come before the far records, chosen by judgement: of a
// picture of 640 × 480, the first has 20 candidates and the second 60, whose whole paths take a fraction of a second.
constexpr float first_steps[] = {128, 64};

// The number of points of all surfaces that are tried at once, chosen by judgement: their gathers take some seconds where
// all of them are unserved, and less than one in a cache that is nearly full.
constexpr size_t places_at_once = 4096;

SolvedCaches begun(const SolvedCaches& caches, const IrradianceCacheOptions& options) {
    return caches.near.records().empty() && caches.far.records().empty() ? empty_caches(options) : caches;
}

/// Records from a file have no lobes, by which they could be compared with new ones.
RadianceCacheOptions comparing(RadianceCacheOptions options, const SolvedCaches& caches) {
    if (!caches.radiance.records().empty()) options.irradiance.disagreement = infinity;
    return options;
}

}  // namespace

GrowingCache::GrowingCache(const World& world, IrradianceCacheOptions options, const SolvedCaches& caches)
    : world_(world), options_(std::move(options)), caches_(begun(caches, options_)), solve_{caches_} {}

GrowingCache::GrowingCache(const World& world, const RadianceCacheOptions& options, const RadianceTables& tables,
                           const SolvedCaches& caches)
    : GrowingCache(world, options.irradiance, caches) {
    radiance_.emplace(
        Radiance{tables, comparing(options, caches), RadianceProjection(options.order, Rows::balanced, options.rows)});
    if (caches_.radiance.records().empty()) caches_.radiance = RadianceCache(options_.cache, options.order);
    solve_.tables = &tables;
}

void GrowingCache::add_passes(const Camera& camera, size_t view, std::span<const Vec2> pixels, float step,
                              bool after_far) {
    const std::vector<Vec2> kept(pixels.begin(), pixels.end());
    if (radiance_)
        passes_.push_back([this, camera, view, kept, step](Progress& progress) {
            add_radiance_of_lattice(world_, camera, {kept, step, view}, radiance_->work(), solve_, progress);
        });
    passes_.push_back([this, camera, view, kept, step, after_far](Progress& progress) {
        solve_.read_cells = after_far;
        const MarkCached mark = radiance_ ? mark_lobes(radiance_->tables) : MarkCached();
        add_near_of_lattice(world_, camera, {kept, step, view}, options_, solve_, progress, mark);
    });
}

void GrowingCache::look(const Camera& camera) {
    passes_.clear();
    solve_.usual_footprint = 0;  // that of the view before
    const size_t view = views_++;
    for (const float step : first_steps) add_passes(camera, view, lattice(camera, step, 0), step, false);
    passes_.push_back([this, camera](Progress& progress) {
        solve_far_for_cameras(world_, {&camera, 1}, options_, solve_, progress);
    });
    for_each_lattice({&camera, 1}, options_, [&](size_t, std::span<const Vec2> pixels, float step) {
        add_passes(camera, view, pixels, step, true);
    });
}

void GrowingCache::look_everywhere() {
    if (!surface_) surface_.emplace(world_);
    sweeps_.clear();
    if (surface_->empty()) return;
    if (far_rounds(options_) > 0) sweeps_.push_back({Sweep::Kind::far});
    if (radiance_) sweeps_.push_back({Sweep::Kind::radiance});
    sweeps_.push_back({Sweep::Kind::irradiance});
}

void GrowingCache::step_everywhere(Progress& progress) {
    Sweep& sweep = sweeps_.front();
    solve_.read_cells = false;
    if (sweep.kind == Sweep::Kind::far) {
        add_far_everywhere(world_, *surface_, sweep.pass, options_, solve_, progress);
        if (++sweep.pass == far_rounds(options_)) sweeps_.pop_front();
        return;
    }
    const size_t count = places_of_pass(sweep.pass), end = std::min(count, sweep.first + places_at_once);
    const PlacesPart part{sweep.pass, count, sweep.first, end};
    const PassCounts found = sweep.kind == Sweep::Kind::radiance
                                 ? add_radiance_at_places(world_, *surface_, part, radiance_->work(), solve_, progress)
                                 : add_near_at_places(world_, *surface_, part, options_, solve_, progress);
    sweep.counts = {sweep.counts.tried + found.tried, sweep.counts.unserved + found.unserved};
    sweep.first = end;
    if (end < count) return;
    if (places_suffice(sweep.pass, sweep.counts) || sweep.pass + 1 == most_place_passes) {
        sweeps_.pop_front();
        return;
    }
    sweep = {sweep.kind, sweep.pass + 1};
}

void GrowingCache::step(Progress& progress) {
    if (!passes_.empty()) {
        passes_.front()(progress);
        passes_.pop_front();
    } else if (!sweeps_.empty()) {
        step_everywhere(progress);
    }
}

}  // namespace eclat

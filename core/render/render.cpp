// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "render/render.h"

#include "base/parallel.h"

namespace eclat {

namespace {

constexpr int tile_size = 32;
// Batches take up to this many samples of the pixels of a block before they go on to the next block, so that their paths
// meet the same surfaces, textures and records while these are in a processor's cache.
constexpr int block_size = 8;
constexpr uint32_t samples_of_block = 16;
constexpr size_t batch_size = size_t(block_size) * block_size * samples_of_block;
// Rays that are traced together (scene/intersect.cpp). Samples with different numbers never share such a packet, so that
// bits do not depend on the range of samples.
constexpr size_t packet_size = 8;

/// Returns an offset from the pixel's centre, distributed like the filter, so that all samples have the same weight and
/// affect only their own pixel.
float filter_offset(Filter filter, float u) {
    if (filter == Filter::box) return u;
    // The tent filter has the radius 1.
    return 0.5f + (u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u));
}

/// A tile, which is rendered in batches of paths; each path is a sample of one of its pixels.
class Tile {
  public:
    Tile(const Camera& camera, const Estimator& estimate, const RenderRange& range, int tx, int ty, Film& film)
        : camera_(camera),
          estimate_(estimate),
          range_(range),
          x0_(tx * tile_size),
          y0_(ty * tile_size),
          x1_(std::min(camera.width, x0_ + tile_size)),
          y1_(std::min(camera.height, y0_ + tile_size)),
          uneven_(!range.end_samples.empty()),
          film_(film) {
        if (!uneven_) return;
        first_sample_ = range.end_sample, end_sample_ = range.first_sample;
        for (int y = y0_; y < y1_; ++y)
            for (int x = x0_; x < x1_; ++x) {
                first_sample_ = std::min(first_sample_, range.first_samples[pixel(x, y)]);
                end_sample_ = std::max(end_sample_, range.end_samples[pixel(x, y)]);
            }
    }

    uint64_t work() const { return end_sample_ > first_sample_ ? end_sample_ - first_sample_ : 0; }

    void render(Progress& progress) {
        for (uint32_t sample = first_sample_; sample < end_sample_; sample += samples_of_block) {
            const uint32_t end = std::min(end_sample_, sample + samples_of_block);
            for (int y = y0_; y < y1_; y += block_size)
                for (int x = x0_; x < x1_; x += block_size) push_block(x, y, sample, end, progress);
            progress.advance(end - sample);
        }
        trace(progress);
        if (range_.finished) range_.finished->add(film_, x0_, y0_, x1_, y1_);
    }

  private:
    struct Place {
        int x, y;
        uint32_t sample;
    };

    size_t pixel(int x, int y) const {
        return static_cast<size_t>(y) * static_cast<size_t>(camera_.width) + static_cast<size_t>(x);
    }

    bool takes(int x, int y, uint32_t sample) const {
        return sample >= range_.first_samples[pixel(x, y)] && sample < range_.end_samples[pixel(x, y)];
    }

    /// Adds samples [first, end) of the pixels of the block whose first pixel is (x, y).
    void push_block(int x, int y, uint32_t first, uint32_t end, Progress& progress) {
        const int x1 = std::min(x1_, x + block_size), y1 = std::min(y1_, y + block_size);
        for (uint32_t sample = first; sample < end; ++sample) {
            for (int py = y; py < y1; ++py)
                for (int px = x; px < x1; ++px)
                    if (!uneven_ || takes(px, py, sample)) push(px, py, sample);
            const bool shares_packet = !uneven_ && rays_.size() % packet_size != 0;
            if (shares_packet || rays_.size() >= batch_size) trace(progress);
        }
    }

    void push(int x, int y, uint32_t sample) {
        Sampler sampler(range_.seed, static_cast<uint32_t>(y) * 65536u + static_cast<uint32_t>(x), sample);
        const Vec2 u = sampler.next_2d(), lens = sampler.next_2d();
        const float px = static_cast<float>(x) + filter_offset(range_.filter, u.x);
        const float py = static_cast<float>(y) + filter_offset(range_.filter, u.y);
        rays_.push_back({camera_.ray(px, py, lens), sampler});
        places_.push_back({x, y, sample});
    }

    void trace(Progress& progress) {
        progress.check();
        results_.resize(rays_.size());
        estimate_(rays_, results_, progress);
        for (size_t i = 0; i < places_.size(); ++i) {
            const auto [x, y, sample] = places_[i];
            if (x < range_.x0 || x >= range_.x1 || y < range_.y0 || y >= range_.y1) continue;
            const PathResult& r = results_[i];
            film_.add(x, y, sample,
                      {.radiance = r.radiance,
                       .direct = r.direct,
                       .albedo = r.albedo,
                       .normal = r.normal,
                       .distance = r.distance < infinity ? r.distance : 0,
                       .cache_missed = r.cache_missed,
                       .gloss_cached = r.gloss_cached,
                       .gloss_traced = r.gloss_traced,
                       .rough_albedo = r.rough_albedo,
                       .rough_normal = r.rough_normal});
        }
        rays_.clear();
        places_.clear();
    }

    const Camera& camera_;
    const Estimator& estimate_;
    const RenderRange& range_;
    int x0_, y0_, x1_, y1_;  // bounds in pixels of the whole picture
    uint32_t first_sample_ = range_.first_sample, end_sample_ = range_.end_sample;
    bool uneven_;
    Film& film_;
    std::vector<PathRay> rays_;
    std::vector<Place> places_;  // pixel and sample of each ray
    std::vector<PathResult> results_;
};

}  // namespace

void render(const Camera& camera, const Estimator& estimate, const RenderRange& range, Film& film, Progress& progress) {
    std::vector<std::pair<int, int>> tiles;
    for (int ty = range.y0 / tile_size; ty * tile_size < range.y1; ++ty)
        for (int tx = range.x0 / tile_size; tx * tile_size < range.x1; ++tx) tiles.emplace_back(tx, ty);
    const size_t pixels = size_t(camera.width) * static_cast<size_t>(camera.height);
    require(range.end_samples.empty() || (range.first_samples.size() == pixels && range.end_samples.size() == pixels),
            "first_samples, end_samples: expected " + std::to_string(pixels) + " pixels, got " +
                std::to_string(range.first_samples.size()) + " and " + std::to_string(range.end_samples.size()));
    if (!range.tile_order.empty()) {
        require(range.tile_order.size() == tiles.size(), "tile_order: expected " + std::to_string(tiles.size()) +
                                                             " tiles, got " + std::to_string(range.tile_order.size()));
        const auto in_order = tiles;
        for (size_t i = 0; i < tiles.size(); ++i) tiles[i] = in_order[range.tile_order[i] % in_order.size()];
    }
    const auto tile = [&](size_t i) { return Tile(camera, estimate, range, tiles[i].first, tiles[i].second, film); };
    uint64_t work = 0;
    for (size_t i = 0; i < tiles.size(); ++i) work += tile(i).work();
    progress.begin(work);
    parallel_for(tiles.size(), range.threads, [&](size_t i) { tile(i).render(progress); });
}

}  // namespace eclat

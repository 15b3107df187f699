// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "micro/lazy_fill.h"

namespace eclat {

namespace {

constexpr uint32_t lazy_stream = 17;  // of random numbers

/// Records to which one is added at a time. The core's cache is rebuilt whole whenever records enter, so new ones wait
/// in a second, small one until they are a 32nd of all; until then they are clamped to each other only.
class GrowingCache {
  public:
    explicit GrowingCache(const IrradianceCacheOptions& options)
        : options_(options), settled_(options.cache), waiting_(options.cache) {}

    bool serves(const Candidate& c) const {
        return settled_.serves(c.position, c.shading_normal) || waiting_.serves(c.position, c.shading_normal);
    }

    void add(std::span<const IrradianceRecord> records) {
        waiting_.insert(records, options_.spacing, 1);
        if (waiting_.records().size() >= std::max<size_t>(16, settled_.records().size() / 32)) settle();
    }

    RecordCache take() {
        settle();
        return std::move(settled_);
    }

  private:
    void settle() {
        settled_.insert(waiting_.records(), options_.spacing, 1);
        waiting_ = RecordCache(options_.cache);
    }

    const IrradianceCacheOptions& options_;
    RecordCache settled_, waiting_;
};

}  // namespace

SolvedCaches fill_lazily(const World& world, const Camera& camera, const IrradianceCacheOptions& options,
                         Progress& progress) {
    IrradianceCacheOptions alone = options;
    alone.threads = 1;
    const RecordCache no_far;
    GrowingCache cache(alone);
    progress.begin(static_cast<uint64_t>(camera.height));
    for (int y = 0; y < camera.height; ++y) {
        std::vector<Vec2> row;
        for (int x = 0; x < camera.width; ++x)
            row.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        for (const Candidate& wanted : camera_candidates(world, camera, row, alone, progress))
            if (!cache.serves(wanted))
                cache.add(
                    gather_records(world, std::span(&wanted, 1), no_far, alone, lazy_stream, alone.rows, progress));
        progress.advance();
    }
    return {cache.take(), RecordCache(options.cache)};
}

}  // namespace eclat

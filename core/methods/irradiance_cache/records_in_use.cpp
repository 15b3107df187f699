// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/irradiance_cache/records_in_use.h"

#include <algorithm>

namespace eclat {

std::vector<uint8_t> records_in_use(const World& world, const Camera& camera, const RecordCache& cache,
                                    const IrradianceCacheOptions& options, Progress& progress) {
    std::vector<uint8_t> used(cache.records().size(), 0);
    if (used.empty()) return used;
    const auto pixels = lattice(camera, std::max(1.0f, options.least_pixels), 0);
    for (const Candidate& c : camera_candidates(world, camera, pixels, options, progress))
        cache.for_each_serving(c.position, c.normal, cache.options().relaxation,
                               [&](uint32_t record, float, const Color&) { used[record] = 1; });
    return used;
}

}  // namespace eclat

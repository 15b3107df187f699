// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Which samples of which pixels, as Python asks for them.

#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "arrays.h"
#include "base/error.h"
#include "render/render.h"

namespace eclat {

/// Of each pixel of the picture, or one for all.
using SampleCounts = Array<uint32_t, -1>;

/// Borrows `first` and `end`.
inline RenderRange render_range(const SampleCounts& first, const SampleCounts& end, std::array<int, 4> crop,
                                uint32_t seed, int threads, int filter, std::vector<uint32_t> tile_order) {
    RenderRange range;
    range.x0 = crop[0], range.y0 = crop[1], range.x1 = crop[2], range.y1 = crop[3];
    range.seed = seed;
    range.threads = threads;
    range.filter = static_cast<Filter>(filter);
    range.tile_order = std::move(tile_order);
    const std::span<const uint32_t> firsts(first.data(), first.size()), ends(end.data(), end.size());
    require(!ends.empty() && firsts.size() == ends.size(), "first, end: expected as many of each");
    range.first_sample = std::ranges::min(firsts), range.end_sample = std::ranges::max(ends);
    if (ends.size() > 1) range.first_samples = firsts, range.end_samples = ends;
    return range;
}

}  // namespace eclat

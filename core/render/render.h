// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The loop over all pixels.

#pragma once

#include <span>
#include <vector>

#include "film/film.h"
#include "render/finished_tiles.h"
#include "scene/camera.h"
#include "transport/estimator.h"

namespace eclat {

enum class Filter : uint8_t { box, tent };

struct RenderRange {
    uint32_t first_sample = 0, end_sample = 1;
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels of the crop; x1, y1 are exclusive
    uint32_t seed = 0;
    int threads = 0;
    Filter filter = Filter::box;
    std::vector<uint32_t> tile_order;  // a permutation of the tiles, or empty for the usual order
    // If pixels take different numbers of samples, these are the ranges [first, end) of all pixels of the whole
    // picture, row by row, within [first_sample, end_sample). If they are empty, all pixels take all samples.
    std::span<const uint32_t> first_samples, end_samples;
    FinishedTiles* finished = nullptr;  // takes a copy of each tile when it has all its samples; null if nobody watches
};

/// Adds samples [first, end) of each pixel of the crop to `film`.
/// The picture is divided into tiles of 32 × 32 pixels, and these into blocks of 8 × 8. A batch has up to 16 samples of each
/// pixel of a block, and of further blocks if there are fewer samples. If all pixels take the same samples, rays that are
/// traced together have the same sample number, so that bits do not depend on the crop, on the range of samples or on the
/// number of threads.
void render(const Camera& camera, const Estimator& estimate, const RenderRange& range, Film& film, Progress& progress);

}  // namespace eclat

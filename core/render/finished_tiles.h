// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Copies of the tiles of a picture that are finished while others are still rendered, for those who watch it grow.

#pragma once

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "film/film.h"

namespace eclat {

/// A copy of a rectangle of a film. (x, y) is its upper left pixel.
struct FinishedTile {
    int x, y;
    Film film;
};

class FinishedTiles {
  public:
    /// Copies the pixels of `film` in [x0, x1) × [y0, y1), and replaces an older copy that nobody has taken.
    /// The thread that rendered the tile calls this, so that nobody writes these pixels at the same time.
    void add(const Film& film, int x0, int y0, int x1, int y1) {
        Film copy(x1 - x0, y1 - y0);
        auto to = copy.pixels().begin();
        for (int y = y0; y < y1; ++y) {
            const auto row = film.pixels().begin() + ptrdiff_t(y) * film.width();
            to = std::copy(row + x0, row + x1, to);
        }
        const std::lock_guard lock(mutex_);
        tiles_.erase({y0, x0});
        tiles_.emplace(std::pair(y0, x0), copy);
    }

    /// Returns the tiles that were added since the last call, row by row.
    std::vector<FinishedTile> take() {
        std::vector<FinishedTile> taken;
        const std::lock_guard lock(mutex_);
        for (const auto& [corner, film] : tiles_) taken.push_back({corner.second, corner.first, film});
        tiles_.clear();
        return taken;
    }

  private:
    std::mutex mutex_;
    std::map<std::pair<int, int>, Film> tiles_;  // by row and column of the upper left pixel
};

}  // namespace eclat

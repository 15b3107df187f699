// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Gathers of a pass that several processes share, as bytes. Most of what gathers find are estimates of the irradiance at far
// places, of which later passes read only means, so the digest of a pass has the means that changed instead: a tenth of the bytes.

#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/work_exchange.h"
#include "records/gather.h"

namespace eclat {

/// The gathers of a pass, which this process and others computed.
class SharedGathers {
  public:
    /// Lets `exchange` compute `count` gathers of about `rays` rays each.
    SharedGathers(const WorkExchange& exchange, size_t count, uint64_t rays, int threads, Progress& progress,
                  const std::function<Gathered(size_t)>& gather);

    /// The gathers in order. In a process that follows they have no samples.
    const std::vector<Gathered>& gathered() const { return gathered_; }
    /// Whether this process follows another, from which it has the gathers.
    bool follows() const { return step_.digest().has_value(); }
    /// In a process that follows: the cells that later passes read, as they are after this pass.
    const std::vector<CellMean>& means() const { return means_; }
    /// Tells the processes that follow the gathers, and the means of the cells that changed by their samples.
    void tell(std::span<const CellMean> changed) const;

  private:
    SharedStep step_;
    std::vector<Gathered> gathered_;
    std::vector<CellMean> means_;
};

}  // namespace eclat

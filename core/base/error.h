// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The core throws; it never prints and never exits. std::invalid_argument for the user's mistakes (Python sees a
// ValueError), Cancelled when the caller asked to stop.

#pragma once

#include <stdexcept>
#include <string>

namespace eclat {

struct Cancelled : std::runtime_error {
    Cancelled() : std::runtime_error("cancelled") {}
};

/// Throw std::invalid_argument with `message` unless `condition` holds.
inline void require(bool condition, const std::string& message) {
    if (!condition) throw std::invalid_argument(message);
}

}  // namespace eclat

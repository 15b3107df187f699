// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The errors that the core throws; it never prints and never exits. Mistakes of the user are std::invalid_argument (ValueError
// in Python), and Cancelled means that the caller asked to stop.

#pragma once

#include <stdexcept>
#include <string>

namespace eclat {

struct Cancelled : std::runtime_error {
    Cancelled() : std::runtime_error("cancelled") {}
};

/// Throws std::invalid_argument with `message` unless `condition` holds.
inline void require(bool condition, const std::string& message) {
    if (!condition) throw std::invalid_argument(message);
}

}  // namespace eclat

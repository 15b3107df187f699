// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The choice of emissions that lead to stored photons. If a glass stands in a hall, or a hall under a sky with a large bounding
// sphere, these come from few positions in few directions of the lights.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/warp.h"

namespace eclat {

/// Random numbers of an emission: the light's choice, the place on it (2), the direction (2).
using EmissionNumbers = std::array<float, 5>;

/// A density on the unit cube of emission numbers, constant on boxes.
class EmissionGuide {
  public:
    /// One box: uniform.
    EmissionGuide();

    struct Guided {
        EmissionNumbers u;
        float pdf;  // with respect to uniform numbers
        uint32_t box;
    };
    /// A box by `u_box`, and a place in it by `u`: all uniform numbers. They stay stratified.
    Guided sample(float u_box, const EmissionNumbers& u) const;

    /// What one emission brought: `value` is the flux that was stored of it, as if it had been emitted uniformly.
    struct Result {
        EmissionNumbers u;
        uint32_t box;
        float value;
    };
    /// Splits boxes in halves where the value of one half is much more than the other's, and takes more emissions from boxes
    /// whose value is large. `results` are all those of numbers that this guide sampled, those without a value included.
    void refine(std::span<const Result> results);

    size_t boxes() const { return boxes_.size(); }
    bool uniform() const { return boxes_.size() == 1; }

  private:
    struct Box {
        EmissionNumbers low{}, high{};
        bool hit = true;  // something of it has been stored, or it has not been asked often enough to tell

        double volume() const;
    };
    struct Part;
    static void split(Part part, double total, std::vector<Part>& out);

    std::vector<Box> boxes_;
    std::vector<float> cumulative_;  // probability of the boxes before each, and 1
};

}  // namespace eclat

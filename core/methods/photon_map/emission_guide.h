// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The choice of emissions that lead to stored photons. If a glass stands in a hall, or a hall under a sky with a large bounding
// sphere, these come from few positions in few directions of the lights.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/work_exchange.h"
#include "sampling/warp.h"

namespace eclat {

/// The random numbers of an emission: one for the choice of the light, two for the position on it, and two for the
/// direction.
using EmissionNumbers = std::array<float, 5>;

/// A density on the unit cube of emission numbers, which is constant on boxes.
class EmissionGuide {
  public:
    /// Makes a uniform density, which has one box.
    EmissionGuide();

    struct Guided {
        EmissionNumbers u;
        float pdf;  // density with respect to uniform numbers
        uint32_t box;
    };
    /// Chooses a box by `u_box` and a position in it by `u`. The results are stratified if these uniform numbers are.
    Guided sample(float u_box, const EmissionNumbers& u) const;

    /// The result of one emission: `value` is the flux that was stored, converted to uniform emission.
    struct Result {
        EmissionNumbers u;
        uint32_t box;
        float value;
    };
    /// Splits boxes in halves if the value of one half is much larger than that of the other, and increases the density
    /// of boxes with large values. `results` must contain all results of numbers that this guide sampled, including
    /// those without a value.
    void refine(std::span<const Result> results);

    /// These turn the guide into bytes and back.
    void write(std::string& out) const;
    void read(ByteReader& reader);

    size_t boxes() const { return boxes_.size(); }
    bool uniform() const { return boxes_.size() == 1; }

  private:
    struct Box {
        EmissionNumbers low{}, high{};
        bool hit = true;  // whether a photon from it was stored, or it had too few emissions to tell

        double volume() const;
    };
    struct Part;
    static void split(Part part, double total, std::vector<Part>& out);

    std::vector<Box> boxes_;
    std::vector<float> cumulative_;  // sum of the probabilities before each box, and finally 1
};

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The choice of a light, in proportion to power, with a minimum share for each kind of light so that none is neglected.

#pragma once

#include <array>
#include <span>

#include "sampling/discrete.h"

namespace eclat {

/// The set of lights that are sampled.
enum class LightSet {
    all,
    /// This excludes the smooth part of the environment image, which a gather over the hemisphere collects; its sharp
    /// part and suns remain.
    without_smooth_environment,
};

/// Kinds of light, in the order in which they are numbered.
enum class LightKind { triangle, point, spot, profile, directional, environment, sharp_environment };
constexpr size_t light_kinds = 7;

class LightSampler {
  public:
    LightSampler() = default;
    /// Weights (powers) of each kind's lights; the environment is one light or none, and so is its sharp part, which takes its
    /// place where the set leaves the smooth one out.
    explicit LightSampler(const std::array<std::vector<double>, light_kinds>& powers);

    struct Choice {
        LightKind kind = LightKind::triangle;
        uint32_t index = 0;      // within its kind
        float pdf_discrete = 0;  // 0: there is no light
    };

    Choice choose(LightSet set, float u) const { return choice(tables_[static_cast<size_t>(set)].sample(u)); }
    float pdf_discrete(LightSet set, LightKind kind, uint32_t index) const {
        return tables_[static_cast<size_t>(set)].pdf_discrete(first_[static_cast<size_t>(kind)] + index);
    }

    bool empty() const { return tables_[static_cast<size_t>(LightSet::all)].empty(); }

  private:
    Choice choice(const DiscreteSample& s) const {
        size_t kind = 0;
        while (kind + 1 < light_kinds && s.index >= first_[kind + 1]) ++kind;
        return {static_cast<LightKind>(kind), s.index - first_[kind], s.pdf_discrete};
    }

    std::array<uint32_t, light_kinds> first_{};
    std::array<AliasTable, 2> tables_;  // by LightSet
};

}  // namespace eclat

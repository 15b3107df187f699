// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/light_sampler.h"

#include <algorithm>
#include <numeric>

namespace eclat {

namespace {

// These are groups of lights that are sampled independently of their power: lamps, suns, the sky.
constexpr std::array<size_t, light_kinds> group_of = {0, 1, 1, 1, 2, 3, 3};
constexpr size_t groups = 4;

/// Returns the probabilities: half is distributed by power, and half equally over the groups that emit. By power alone,
/// a desk lamp would get one sample in a million beside the sun, even at points that the sun does not reach.
std::vector<double> odds(std::array<std::vector<double>, light_kinds> powers, LightKind without) {
    std::ranges::fill(powers[static_cast<size_t>(without)], 0.0);
    std::array<double, groups> sum{};
    for (size_t kind = 0; kind < light_kinds; ++kind)
        for (const double p : powers[kind]) sum[group_of[kind]] += p;
    const double total = std::accumulate(sum.begin(), sum.end(), 0.0);
    double shining = 0;
    for (const double s : sum) shining += s > 0;
    std::vector<double> out;
    for (size_t kind = 0; kind < light_kinds; ++kind) {
        const double s = sum[group_of[kind]];
        const double share = s > 0 ? 0.5 / total + 0.5 / (shining * s) : 0;
        for (const double p : powers[kind]) out.push_back(p * share);
    }
    return out;
}

}  // namespace

LightSampler::LightSampler(const std::array<std::vector<double>, light_kinds>& powers) {
    size_t count = 0;
    for (size_t kind = 0; kind < light_kinds; ++kind) {
        first_[kind] = static_cast<uint32_t>(count);
        count += powers[kind].size();
    }
    tables_[static_cast<size_t>(LightSet::all)] = AliasTable(odds(powers, LightKind::sharp_environment));
    tables_[static_cast<size_t>(LightSet::without_smooth_environment)] =
        AliasTable(odds(powers, LightKind::environment));
}

}  // namespace eclat

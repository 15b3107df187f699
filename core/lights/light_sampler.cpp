// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/light_sampler.h"

#include <numeric>

namespace eclat {

namespace {

// Lights that are sampled side by side: a lamp, a sun, a sky.
constexpr std::array<size_t, light_kinds> group_of = {0, 1, 1, 2, 3};
constexpr size_t groups = 4;
constexpr size_t environment_group = 3;

/// Odds: half by power, half shared equally by the groups that shine. By power alone a desk lamp would get one sample
/// in a million beside the sun, also where the sun does not reach.
std::vector<double> odds(const std::array<std::vector<double>, light_kinds>& powers, bool with_environment) {
    std::array<double, groups> sum{};
    for (size_t kind = 0; kind < light_kinds; ++kind) {
        if (group_of[kind] == environment_group && !with_environment) continue;
        for (const double p : powers[kind]) sum[group_of[kind]] += p;
    }
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
    std::vector<double> all;
    for (size_t kind = 0; kind < light_kinds; ++kind) {
        first_[kind] = static_cast<uint32_t>(all.size());
        all.insert(all.end(), powers[kind].begin(), powers[kind].end());
    }
    tables_[static_cast<size_t>(LightSet::all)] = AliasTable(odds(powers, true));
    tables_[static_cast<size_t>(LightSet::without_environment_image)] = AliasTable(odds(powers, false));
    emission_ = AliasTable(all);
}

}  // namespace eclat

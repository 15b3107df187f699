// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Progressive refinement over linked patches [Cohen88]: in each step, the part of the scene with the most unsent power
// sends it. Light that arrives at a node is stored there until the patches below send, so that the time of a step
// depends on the number of its links and not on the number of patches below them. The unsent power is nevertheless
// known: it is the stored irradiance times the sum of albedo times area over the patches below.
// Southwell's method takes the patch with the most power; here it is searched from the root down, always in the half
// with more power.

#include <algorithm>
#include <vector>

#include "methods/radiosity/radiosity_system.h"

namespace eclat {

namespace {

constexpr uint32_t most_patches = 64;  // greatest number of patches that send together

class Shooter {
  public:
    explicit Shooter(const RadiositySystem& system)
        : system_(system),
          tree_(system.tree()),
          waiting_(tree_.nodes().size()),
          reflects_(waiting_.size()),
          power_(waiting_.size()),
          unsent_(waiting_.size()),
          sent_(waiting_.size()),
          patches_(waiting_.size(), 1) {
        light.total.resize(waiting_.size());
        for (const uint32_t i : tree_.leaves()) light.total[i] = system_.surface(i).lights;
        for (uint32_t i = static_cast<uint32_t>(waiting_.size()); i-- > 0;) {
            if (tree_[i].is_leaf()) {
                const PatchSurface& s = system_.surface(i);
                Color scattered = s.albedo;
                for (const auto& o : system_.other_sides().of(i))
                    scattered += system_.surface(o.patch).transmittance * o.share;
                reflects_[i] = scattered * (tree_[i].area * system_.receives(i));
                unsent_[i] = system_.leaving(i, light.total);
                power_[i] = unsent_[i] * tree_[i].area;
            } else {
                const uint32_t c = tree_[i].child;
                reflects_[i] = reflects_[c] + reflects_[c + 1];
                power_[i] = power_[c] + power_[c + 1];
                patches_[i] = patches_[c] + patches_[c + 1];
            }
        }
    }

    float unsent_power() const { return power_.empty() ? 0 : mean(power_[0]); }

    void step() {
        const uint32_t top = choose();
        subtree_.clear();
        collect(top);
        send_up(top);
        hand_through();
        for (const uint32_t node : subtree_) send(node, sent_[node]);
        const Color power = sent_[top] * tree_[top].area;
        for (uint32_t up = tree_[top].parent; up != no_node; up = tree_[up].parent) send(up, power / tree_[up].area);
    }

    /// Passes all stored irradiance down to the patches.
    void finish() {
        for (uint32_t i = 0; i < waiting_.size(); ++i)
            tree_[i].is_leaf() ? void(light.total[i] += waiting_[i] * system_.receives(i)) : push(i);
    }

    PatchLight light;

  private:
    uint32_t choose() {
        uint32_t node = 0;
        while (!tree_[node].is_leaf() && patches_[node] > most_patches) {
            push(node);
            const uint32_t c = tree_[node].child;
            node = mean(power_[c]) >= mean(power_[c + 1]) ? c : c + 1;
        }
        return node;
    }

    /// Passes the irradiance that is stored at a node to its halves.
    void push(uint32_t node) {
        if (is_black(waiting_[node])) return;
        for (const uint32_t half : {tree_[node].child, tree_[node].child + 1}) {
            waiting_[half] += waiting_[node];
            power_[half] += waiting_[node] * reflects_[half];
        }
        waiting_[node] = Color();
    }

    /// Collects the unsent light of each node below `node` and marks it as sent.
    void collect(uint32_t node) {
        subtree_.push_back(node);
        power_[node] = Color();
        if (tree_[node].is_leaf()) {
            const PatchSurface& s = system_.surface(node);
            const Color arrived = waiting_[node] * system_.receives(node);
            light.total[node] += arrived;
            sent_[node] = (unsent_[node] + s.albedo * arrived) * system_.sends(node);
            unsent_[node] = waiting_[node] = Color();
            for (const auto& o : system_.other_sides().of(node)) {
                const float spread = o.share * tree_[node].area / tree_[o.patch].area;
                passed_.push_back({o.patch, system_.surface(o.patch).transmittance * arrived * spread});
            }
            return;
        }
        push(node);
        const uint32_t c = tree_[node].child;
        collect(c);
        collect(c + 1);
        power_[node] = power_[c] = power_[c + 1] = Color();
        const float first = tree_[c].area / (tree_[c].area + tree_[c + 1].area);
        sent_[node] = sent_[c] * first + sent_[c + 1] * (1 - first);
    }

    /// Updates the unsent power of the ancestors of `node`.
    void send_up(uint32_t node) {
        for (uint32_t up = tree_[node].parent; up != no_node; up = tree_[up].parent) {
            const uint32_t c = tree_[up].child;
            power_[up] = power_[c] + power_[c + 1] + waiting_[up] * reflects_[up];
        }
    }

    /// Adds transmitted light to the unsent light of the patches behind those that received it.
    void hand_through() {
        for (const Passed& p : passed_) {
            unsent_[p.patch] += p.radiosity;
            const Color power = p.radiosity * tree_[p.patch].area;
            for (uint32_t up = p.patch; up != no_node; up = tree_[up].parent) power_[up] += power;
        }
        passed_.clear();
    }

    void send(uint32_t node, Color radiosity) {
        if (is_black(radiosity)) return;
        for (const auto& to : system_.exchanges().of(node)) {
            const Color arrived = radiosity * to.tint * (to.form_factor * tree_[node].area / tree_[to.node].area);
            waiting_[to.node] += arrived;
            const Color power = arrived * reflects_[to.node];
            for (uint32_t up = to.node; up != no_node; up = tree_[up].parent) power_[up] += power;
        }
    }

    const RadiositySystem& system_;
    const PatchTree& tree_;
    std::vector<Color> waiting_;   // irradiance that has not been passed to the patches below
    std::vector<Color> reflects_;  // Σ (ρ + τ) A of the patches below, with τ of the patches behind them
    std::vector<Color> power_;     // unsent power of the patches below, W
    std::vector<Color> unsent_;    // unsent radiosity of patches from lights
    std::vector<Color> sent_;      // radiosity of this step
    std::vector<uint32_t> patches_, subtree_;
    struct Passed {
        uint32_t patch;
        Color radiosity;
    };
    std::vector<Passed> passed_;  // through sheets in this step
};

}  // namespace

PatchLight solve_by_shooting(const RadiositySystem& system, const SolveLimits& limits, Progress& progress) {
    PatchLight direct = solve_by_gathering(system, {limits.residual, 1}, progress);
    Shooter shooter(system);
    const float all = shooter.unsent_power();
    constexpr uint64_t whole = 1000;
    progress.begin(whole);
    // The greatest number of steps allows each patch to send as often as it could gather.
    const uint64_t most = uint64_t(limits.sweeps) * system.tree().leaves().size();
    while (uint64_t(shooter.light.sweeps) < most && shooter.unsent_power() > limits.residual * all) {
        progress.check();
        shooter.step();
        ++shooter.light.sweeps;
        const float done = std::log(shooter.unsent_power() / all) / std::log(limits.residual);
        progress.done = static_cast<uint64_t>(clamp(done, 0, 1) * static_cast<float>(whole));
    }
    const float residual = all > 0 ? shooter.unsent_power() / all : 0;
    shooter.finish();
    PatchLight out = std::move(shooter.light);
    out.direct = std::move(direct.direct);
    out.residual = residual;
    return out;
}

}  // namespace eclat

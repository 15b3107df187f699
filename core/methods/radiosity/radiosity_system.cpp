// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// References   [Goral84], [Hanrahan91], [Lischinski93]; [Knight14] scaling a symmetric
//              matrix to given row sums
// Held to      tests/core/methods/radiosity/test_radiosity_system.cpp, tests/methods/test_radiosity.py

#include "methods/radiosity/radiosity_system.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "methods/radiosity/form_factor.h"

namespace eclat {

namespace {

constexpr size_t block = 4096;  // number of nodes of one task

// This bounds the distance of a patch's factor from 1. Larger deviations are not errors of form factors, but for
// example patches that are half inside a solid.
constexpr float least_factor = 1.0f / 64, largest_factor = 4;

// That may be where no ray found any.
constexpr float least_closure = 0.05f;

/// Returns the factor by which a sum of form factors must be multiplied to equal the closure of the patch, within the
/// error of the closure.
float balancing_factor(const PatchSurface& surface, float sum) {
    if (!(sum > 0)) return 1;
    const float most = std::max(surface.closure + surface.closure_error, least_closure);
    const float wanted = clamp(sum, surface.closure - surface.closure_error, most);
    return clamp(wanted / sum, least_factor, largest_factor);
}

/// A few parts of each cluster, which represent all of its parts.
class ClusterParts {
  public:
    explicit ClusterParts(const PatchTree& tree) : tree_(tree), parts_(tree.nodes().size()) {
        for (uint32_t i = 0; i < parts_.size(); ++i) {
            if (!tree[i].is_cluster()) continue;
            for (int k = 0; k < count; ++k) {
                float u = (static_cast<float>(k) + 0.5f) / count;
                uint32_t node = i;
                while (tree[node].is_cluster()) {
                    const uint32_t child = tree[node].child;
                    const float first = tree[child].area / (tree[child].area + tree[child + 1].area);
                    const bool second = u >= first;
                    u = second ? (u - first) / (1 - first) : u / first;
                    node = child + second;
                }
                parts_[i][k] = node;
            }
        }
    }

    /// Computes form factors from the centre of a patch, with parts approximated by discs.
    float form_factor(const PatchNode& patch, uint32_t cluster) const {
        const float area = tree_[cluster].area / count;
        float sum = 0;
        for (const uint32_t part : parts_[cluster]) {
            const Vec3 to = tree_[part].center - patch.center;
            const float here = dot(patch.normal, to), there = -dot(tree_[part].normal, to), d2 = length_squared(to);
            if (here > 0 && there > 0) sum += here * there * area / (d2 * (pi * d2 + area));
        }
        return sum;
    }

  private:
    static constexpr int count = 4;
    const PatchTree& tree_;
    std::vector<std::array<uint32_t, count>> parts_;  // triangles or parts, by node
};

double power(const RadiositySystem& system, std::span<const Color> radiosity) {
    double sum = 0;
    for (const uint32_t i : system.tree().leaves()) sum += double(system.tree()[i].area) * mean(radiosity[i]);
    return sum;
}

}  // namespace

RadiositySystem::RadiositySystem(const PatchTree& tree, std::span<const PatchSurface> surfaces,
                                 const Exchanges& exchanges, int threads)
    : tree_(tree),
      surfaces_(surfaces),
      exchanges_(exchanges),
      other_sides_(tree, surfaces),
      threads_(threads),
      factor_(tree.nodes().size(), 1) {}

Color RadiositySystem::let_through(uint32_t patch, std::span<const Color> irradiance) const {
    Color behind;
    for (const auto& overlap : other_sides_.of(patch)) behind += irradiance[overlap.patch] * overlap.share;
    return surfaces_[patch].transmittance * behind;
}

std::vector<Color> RadiositySystem::pull(std::span<const Color> radiosity) const {
    std::vector<Color> sent(tree_.nodes().size());
    for (uint32_t i = static_cast<uint32_t>(sent.size()); i-- > 0;) {
        const PatchNode& n = tree_[i];
        if (n.is_leaf()) {
            sent[i] = radiosity[i] * sends(i);
        } else {
            const float first = tree_[n.child].area / (tree_[n.child].area + tree_[n.child + 1].area);
            sent[i] = sent[n.child] * first + sent[n.child + 1] * (1 - first);
        }
    }
    return sent;
}

std::vector<Color> RadiositySystem::irradiance(std::span<const Color> radiosity) const {
    const std::vector<Color> sent = pull(radiosity);
    std::vector<Color> out(sent.size());
    parallel_blocks(out.size(), block, threads_, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            for (const auto& sender : exchanges_.of(static_cast<uint32_t>(i)))
                out[i] += sent[sender.node] * sender.tint * sender.form_factor;
    });
    // The irradiance is pushed down; parents precede their children.
    for (size_t i = 0; i < out.size(); ++i)
        if (const uint32_t parent = tree_.nodes()[i].parent; parent != no_node) out[i] += out[parent];
    for (const uint32_t i : tree_.leaves()) out[i] *= receives(i);
    return out;
}

std::vector<Color> RadiositySystem::known() const {
    std::vector<Color> out(tree_.nodes().size());
    for (const uint32_t i : tree_.leaves()) out[i] = Color(surfaces_[i].unknown() ? 0.0f : 1.0f);
    return out;
}

std::vector<float> RadiositySystem::row_sums() const {
    const std::vector<Color> sums = irradiance(known());
    std::vector<float> out(sums.size());
    for (const uint32_t i : tree_.leaves()) out[i] = mean(sums[i]);
    return out;
}

void RadiositySystem::balance(float tolerance, int most, Progress& progress) {
    for (int step = 0; step < most; ++step) {
        progress.check();
        const std::vector<float> sums = row_sums();
        float worst = 0;
        for (const uint32_t i : tree_.leaves()) {
            // The square root of the ratio is used, because the factors of the other patches are scaled too.
            const float step = std::sqrt(balancing_factor(surfaces_[i], sums[i]));
            const float next = clamp(factor_[i] * step, least_factor, largest_factor);
            worst = std::max(worst, std::fabs(next / factor_[i] - 1));
            factor_[i] = next;
        }
        if (worst < tolerance) return;
    }
}

PatchLight solve_by_gathering(const RadiositySystem& system, const SolveLimits& limits, Progress& progress) {
    const PatchTree& tree = system.tree();
    PatchLight out;
    std::vector<Color> radiosity(tree.nodes().size());
    for (const uint32_t i : tree.leaves()) radiosity[i] = system.surface(i).emitted;
    constexpr uint64_t whole = 1000;
    progress.begin(whole);
    for (int sweep = 0; sweep < limits.sweeps; ++sweep) {
        progress.check();
        out.total = system.irradiance(radiosity);
        for (const uint32_t i : tree.leaves()) out.total[i] += system.surface(i).lights;
        if (sweep == 0) out.direct = out.total;
        ++out.sweeps;
        std::vector<Color> change(radiosity.size());
        for (const uint32_t i : tree.leaves()) {
            const Color next = system.leaving(i, out.total);
            for (int k = 0; k < 3; ++k) change[i][k] = std::fabs(next[k] - radiosity[i][k]);
            radiosity[i] = next;
        }
        const double all = power(system, radiosity);
        out.residual = all > 0 ? static_cast<float>(power(system, change) / all) : 0;
        if (!(out.residual > limits.residual)) break;
        const float done = std::log(out.residual) / std::log(limits.residual);
        progress.done = static_cast<uint64_t>(clamp(done, 0, 1) * static_cast<float>(whole));
    }
    if (out.total.empty()) out.direct = out.total = std::vector<Color>(tree.nodes().size());
    return out;
}

void refine_locally(const RadiositySystem& system, PatchLight& light, Progress& progress) {
    const PatchTree& tree = system.tree();
    std::vector<Color> emitted(tree.nodes().size()), radiosity(tree.nodes().size());
    for (const uint32_t i : tree.leaves()) {
        emitted[i] = system.surface(i).emitted;
        radiosity[i] = system.leaving(i, light.total);
    }
    const std::vector<Color> sent_emitted = system.pull(emitted), sent = system.pull(radiosity);
    const std::vector<Color> opaque = system.pull(system.known());
    const ClusterParts clusters(tree);
    const auto& leaves = tree.leaves();
    progress.begin((leaves.size() + block - 1) / block);
    parallel_blocks(leaves.size(), block, system.threads(), [&](size_t begin, size_t end) {
        progress.check();
        for (size_t l = begin; l < end; ++l) {
            const uint32_t leaf = leaves[l];
            const PatchNode& patch = tree[leaf];
            Color direct, total;
            float sum = 0;
            for (uint32_t node = leaf; node != no_node; node = tree[node].parent) {
                for (const auto& sender : system.exchanges().of(node)) {
                    float form_factor = sender.form_factor;
                    if (node != leaf)
                        form_factor =
                            sender.visibility * (tree[sender.node].is_cluster()
                                                     ? clusters.form_factor(patch, sender.node)
                                                     : point_to_patch(patch.center, patch.normal, tree[sender.node]));
                    direct += sent_emitted[sender.node] * sender.tint * form_factor;
                    total += sent[sender.node] * sender.tint * form_factor;
                    sum += opaque[sender.node].r * form_factor;
                }
            }
            const PatchSurface& s = system.surface(leaf);
            const float factor = s.unknown() ? 0 : balancing_factor(s, sum);
            light.direct[leaf] = s.lights + direct * factor;
            light.total[leaf] = s.lights + total * factor;
        }
        progress.advance();
    });
}

}  // namespace eclat

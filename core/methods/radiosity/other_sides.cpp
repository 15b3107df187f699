// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/other_sides.h"

#include <algorithm>

namespace eclat {

namespace {

/// Appends the patches that `node` consists of, each with its share of `area`.
void add_patches(const PatchTree& tree, uint32_t node, float area, std::vector<OtherSides::Overlap>& out) {
    if (tree[node].is_leaf()) {
        out.push_back({node, std::min(1.0f, tree[node].area / area)});
        return;
    }
    add_patches(tree, tree[node].child, area, out);
    add_patches(tree, tree[node].child + 1, area, out);
}

}  // namespace

OtherSides::OtherSides(const PatchTree& tree, std::span<const PatchSurface> surfaces) {
    const auto lets_through = [&](uint32_t patch) { return !is_black(surfaces[patch].transmittance); };
    if (std::ranges::none_of(tree.leaves(), lets_through)) return;
    first_.assign(tree.nodes().size() + 1, 0);
    for (uint32_t i = 0; i < tree.nodes().size(); ++i) {
        const size_t first = overlaps_.size();
        if (tree[i].is_leaf()) {
            if (const uint32_t behind = tree.behind(i); behind != no_node)
                add_patches(tree, behind, tree[i].area, overlaps_);
            const auto added = std::span(overlaps_).subspan(first);
            if (!lets_through(i) &&
                std::ranges::none_of(added, [&](const Overlap& o) { return lets_through(o.patch); }))
                overlaps_.resize(first);
        }
        first_[i + 1] = overlaps_.size();
    }
}

}  // namespace eclat

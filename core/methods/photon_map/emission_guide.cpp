// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Importance sampling of emission in the space of its random numbers, which serves every kind of light: for a point light the
// numbers of the direction matter, for the sun those of the position, for a lamp both, for many lights the choice of the light.
// It replaces the projection maps of [Jensen01]; it learns from emissions what projection maps compute from objects.
// The number of emissions from a box of the cube is proportional to its volume times the root of its mean squared
// value, which minimises the variance of a sum with a given number of terms. However, a photon from a box of low
// density has a large power and would be visible as a spot. Boxes from which any photon was stored therefore get at
// least an eighth of the highest density. The other boxes share a tenth of all emissions, so that paths that were
// missed while learning are still found. They get as many emissions later as they had while learning, so a map contains
// about one such photon, if any.
//
// Held to      tests/core/methods/photon_map/test_emission_guide.cpp

#include "methods/photon_map/emission_guide.h"

#include <algorithm>
#include <cmath>

namespace eclat {

namespace {

constexpr double uniform_part = 0.1;
constexpr double largest_spread = 8;      // largest ratio of densities among boxes that are hit
constexpr size_t least_hits = 64;         // number of results with a value that is needed to split a box
constexpr size_t least_results = 64;      // number of results without a value for which a box counts as empty
constexpr double least_share = 1e-3;      // share of the total value below which a box is not split
constexpr double least_volume = 0x1p-14;  // a tenth of it is still many steps of a random number
constexpr size_t bins = 8;
constexpr double least_chi_square = 40;  // exceeded by chance, with 7 degrees of freedom, once in a million

/// Returns the χ² statistic of the distribution of hits over the bins.
double chi_square(const std::array<size_t, bins>& counts, size_t hits) {
    const double expected = static_cast<double>(hits) / bins;
    double sum = 0;
    for (const size_t n : counts) sum += (static_cast<double>(n) - expected) * (static_cast<double>(n) - expected);
    return sum / expected;
}

}  // namespace

EmissionGuide::EmissionGuide() : boxes_(1), cumulative_{0, 1} { boxes_[0].high.fill(1); }

double EmissionGuide::Box::volume() const {
    double v = 1;
    for (size_t k = 0; k < low.size(); ++k) v *= static_cast<double>(high[k]) - low[k];
    return v;
}

EmissionGuide::Guided EmissionGuide::sample(float u_box, const EmissionNumbers& u) const {
    const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u_box);
    const auto i = static_cast<size_t>(above - cumulative_.begin()) - 1;
    const float mass = cumulative_[i + 1] - cumulative_[i];
    const Box& box = boxes_[i];
    Guided out;
    for (size_t k = 0; k < u.size(); ++k)
        out.u[k] = std::min(box.low[k] + (box.high[k] - box.low[k]) * u[k], below_one);
    out.pdf = static_cast<float>(static_cast<double>(mass) / box.volume());
    out.box = static_cast<uint32_t>(i);
    return out;
}

/// A box and the results in it, each of which represents the volume divided by their number.
struct EmissionGuide::Part {
    Box box;
    std::vector<Result> results;
    double value = 0;   // integral of the value over the box
    double square = 0;  // mean of the squared values
    size_t hits = 0;

    void sum_up() {
        for (const Result& r : results) {
            value += r.value;
            square += static_cast<double>(r.value) * r.value;
            hits += r.value > 0;
        }
        if (results.empty()) return;
        value *= box.volume() / static_cast<double>(results.size());
        square /= static_cast<double>(results.size());
    }
};

void EmissionGuide::split(Part part, double total, std::vector<Part>& out) {
    size_t axis = 0;
    double best = least_chi_square;
    if (part.hits >= least_hits && part.value > least_share * total && part.box.volume() > least_volume) {
        for (size_t k = 0; k < part.box.low.size(); ++k) {
            std::array<size_t, bins> counts{};
            const float low = part.box.low[k], scale = bins / (part.box.high[k] - low);
            for (const Result& r : part.results)
                if (r.value > 0) ++counts[std::min(bins - 1, static_cast<size_t>((r.u[k] - low) * scale))];
            const double chi2 = chi_square(counts, part.hits);
            if (chi2 > best) best = chi2, axis = k;
        }
    }
    if (best == least_chi_square) {
        part.box.hit = part.hits > 0 || (part.box.hit && part.results.size() < least_results);
        out.push_back(std::move(part));
        return;
    }
    const float middle = (part.box.low[axis] + part.box.high[axis]) / 2;
    Part below{part.box, {}}, above{part.box, {}};
    below.box.high[axis] = above.box.low[axis] = middle;
    for (const Result& r : part.results) (r.u[axis] < middle ? below : above).results.push_back(r);
    part.results = {};
    below.sum_up();
    above.sum_up();
    split(std::move(below), total, out);
    split(std::move(above), total, out);
}

void EmissionGuide::write(std::string& out) const {
    write_bytes(out, static_cast<uint64_t>(boxes_.size()));
    write_bytes(out, std::span<const Box>(boxes_));
    write_bytes(out, std::span<const float>(cumulative_));
}

void EmissionGuide::read(ByteReader& reader) {
    const auto count = reader.read<uint64_t>();
    boxes_ = reader.read<Box>(count);
    cumulative_ = reader.read<float>(count + 1);
}

void EmissionGuide::refine(std::span<const Result> results) {
    std::vector<Part> before(boxes_.size());
    for (size_t i = 0; i < boxes_.size(); ++i) before[i].box = boxes_[i];
    for (const Result& r : results) before[r.box].results.push_back(r);
    double total = 0;
    for (Part& part : before) {
        part.sum_up();
        total += part.value;
    }
    if (!(total > 0)) return;
    std::vector<Part> parts;
    for (Part& part : before) split(std::move(part), total, parts);

    double largest = 0;
    for (const Part& part : parts) largest = std::max(largest, std::sqrt(part.square));
    std::vector<double> importance;
    double sum = 0;
    for (const Part& part : parts) {
        const double density = part.box.hit ? std::max(std::sqrt(part.square), largest / largest_spread) : 0;
        importance.push_back(part.box.volume() * density);
        sum += importance.back();
    }
    boxes_.clear();
    cumulative_.assign(1, 0);
    double running = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
        running += uniform_part * parts[i].box.volume() + (1 - uniform_part) * importance[i] / sum;
        boxes_.push_back(parts[i].box);
        cumulative_.push_back(static_cast<float>(std::min(running, 1.0)));
    }
    cumulative_.back() = 1;
}

}  // namespace eclat

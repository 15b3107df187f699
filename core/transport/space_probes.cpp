// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/space_probes.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "base/parallel.h"
#include "harmonics/harmonics.h"
#include "transport/arriving_light.h"

namespace eclat {

namespace {

using Coefficients = std::vector<std::array<double, 3>>;

/// Σ_k L_k Y_i(ω_k), for directions ω_k and numbers L_k that are already divided by the density of the directions.
class HarmonicSum {
  public:
    explicit HarmonicSum(int order)
        : order_(order), sums_(size_t(coefficient_count(order))), harmonics_(sums_.size()) {}

    void add(Vec3 w, Color radiance) {
        if (is_black(radiance)) return;
        if (!is_finite(radiance)) {
            ++dropped_;
            return;
        }
        spherical_harmonics(order_, {w.x, w.y, w.z}, harmonics_.data());
        for (size_t i = 0; i < sums_.size(); ++i)
            for (int k = 0; k < 3; ++k) sums_[i][size_t(k)] += double(radiance[k]) * harmonics_[i];
    }

    const Coefficients& sums() const { return sums_; }
    size_t dropped() const { return dropped_; }

  private:
    int order_;
    Coefficients sums_;
    std::vector<double> harmonics_;
    size_t dropped_ = 0;
};

/// The samples of one probe. `Receiver` says from where it receives light.
template <class Receiver>
class Probe {
  public:
    Probe(const World& world, const Receiver& receiver, uint32_t index, const Estimator& scattered,
          const ProbeOptions& options)
        : receiver_(receiver),
          index_(index),
          scattered_(scattered),
          options_(options),
          light_(world, receiver_, LightSet::all, 1) {}

    /// Sums over the samples [first, end).
    Coefficients sum(int first, int end, Progress& progress) {
        constexpr int samples_at_once = 1024;  // bounds the memory and the time until a cancellation is noticed
        HarmonicSum sum(options_.order);
        for (; first < end; first += samples_at_once) {
            progress.check();
            block(first, std::min(end, first + samples_at_once), progress, sum);
        }
        dropped_ += sum.dropped();
        return sum.sums();
    }

    size_t dropped() const { return dropped_; }

  private:
    void block(int first, int end, Progress& progress, HarmonicSum& sum) {
        const auto add = [&](Vec3 w, Color radiance) { sum.add(w, radiance); };
        rays_.clear();
        directions_.clear();
        samplers_.clear();
        const uint32_t seed = stream_seed(options_.seed, Stream::space_probes);
        const uint32_t seed_of_lights = stream_seed(options_.seed, Stream::space_lights);
        for (int s = first; s < end; ++s) {
            Sampler sampler(seed, index_, static_cast<uint32_t>(s));
            directions_.push_back(receiver_.direction(sampler.next_2d()));
            rays_.push_back({receiver_.ray(directions_.back()), sampler});
            samplers_.emplace_back(seed_of_lights, index_, static_cast<uint32_t>(s));
        }
        if (options_.component != Component::indirect) {
            light_.sample_lights(samplers_, progress, add);
            light_.meet_lights(directions_, progress, add);
        }
        if (options_.component == Component::direct) return;
        results_.assign(rays_.size(), {});
        scattered_(rays_, results_, progress);
        for (size_t k = 0; k < rays_.size(); ++k)
            if (const float pdf = receiver_.pdf_solid_angle(directions_[k]); pdf > 0)
                add(directions_[k], (results_[k].radiance - results_[k].emitted) / pdf);
    }

    Receiver receiver_;
    uint32_t index_;
    const Estimator& scattered_;
    const ProbeOptions& options_;
    ArrivingLight<Receiver> light_;
    std::vector<PathRay> rays_;
    std::vector<PathResult> results_;
    std::vector<Vec3> directions_;
    std::vector<Sampler> samplers_;
    size_t dropped_ = 0;
};

/// Projects the light at `number` places, of which `receiver(i)` is one.
template <class Receive>
ProbeCoefficients project_each(const World& world, size_t number, const Receive& receiver, const Estimator& scattered,
                               const ProbeOptions& options, Progress& progress) {
    require_order(options.order);
    const auto count = size_t(coefficient_count(options.order));
    ProbeCoefficients out;
    out.values.resize(number * count);
    out.errors.resize(number * count);
    std::vector<size_t> dropped(number);
    progress.begin(number);
    parallel_for(number, options.threads, [&](size_t p) {
        Probe probe(world, receiver(p), static_cast<uint32_t>(p), scattered, options);
        const int n = options.samples, half = (n + 1) / 2;
        const Coefficients first = probe.sum(0, half, progress), second = probe.sum(half, n, progress);
        for (size_t i = 0; i < count; ++i) {
            for (int k = 0; k < 3; ++k) {
                const double a = first[i][size_t(k)], b = second[i][size_t(k)];
                out.values[p * count + i][k] = static_cast<float>((a + b) / n);
                if (n > half) out.errors[p * count + i][k] = static_cast<float>(0.5 * (a / half - b / (n - half)));
            }
        }
        dropped[p] = probe.dropped();
        progress.advance();
    });
    out.dropped = std::accumulate(dropped.begin(), dropped.end(), size_t(0));
    return out;
}

}  // namespace

ProbeCoefficients project_probes(const World& world, std::span<const Vec3> positions, const Estimator& scattered,
                                 const ProbeOptions& options, Progress& progress) {
    return project_each(
        world, positions.size(), [&](size_t i) { return SphereReceiver{positions[i]}; }, scattered, options, progress);
}

ProbeCoefficients project_probes(const World& world, std::span<const PointNormal> points, const Estimator& scattered,
                                 const ProbeOptions& options, Progress& progress) {
    return project_each(
        world, points.size(), [&](size_t i) { return HalfSpaceReceiver{bare_point(world, points[i])}; }, scattered,
        options, progress);
}

}  // namespace eclat

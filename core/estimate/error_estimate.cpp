// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The relative error √mean((x − A)(x − B) / (R² + c)), estimated from a few points: A and B are independent gathers by paths
// that are traced to their ends, x is the light from the cache, and R the light that is shown.
//
// Symbol       name here      meaning                                                          unit
//   q_i        guess          relative squared error at a place by one gather, its noise included   1
//   p_i        probability    of the place being drawn                                            1
//   z_i        squared / (P p_i)   whose mean is the estimate [HansenHurwitz43]                     1
// There are two phases. In the first, a gather of few rays is made at many evenly distributed places. The places that
// contribute most to the mean are those at which this gather is noisy or differs much from x. In the second phase, a
// few of the places are drawn, with probabilities that are partly proportional to that contribution and partly uniform,
// and A and B are gathered there. The first gather only determines the probabilities, so the estimate is unbiased even
// if that gather is inaccurate.

#include "estimate/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "estimate/error_probes.h"

namespace eclat {

namespace {

constexpr uint32_t guess_paths = 16;                        // number of paths of a gather in the first phase
constexpr uint32_t samples_first = 4, samples_second = 32;  // numbers of samples for R in each phase
constexpr uint32_t round_places = 32;  // number of places of a round of the second phase, which has at least two
constexpr uint32_t looks = 4;        // number of camera rays of A, because a pixel is a mean over its area and the lens
constexpr double even_chance = 0.4;  // share of uniform draws; no weight exceeds its inverse
constexpr double relative_c = 0.01;  // c in units of mean(R²), as in the measure of pictures

// A third of the rays is for the first phase, and at most half as many are for a round, according to the approximate
// number of rays per path. More paths at fewer places are more informative as long as places do not differ too much,
// because the deviation is proportional to √places / paths.
uint32_t first_places(uint64_t rays) {
    constexpr uint64_t rays_of_place = 3 * guess_paths + 3 * samples_first;
    return static_cast<uint32_t>(std::clamp<uint64_t>(rays / 3 / rays_of_place, 256, 16384));
}
constexpr uint64_t rays_of_path = 6;
uint32_t paths_of_look(uint64_t rays) {
    constexpr uint64_t paths = 2 * round_places * looks;
    return static_cast<uint32_t>(std::clamp<uint64_t>(rays / 6 / (paths * rays_of_path), 16, 256));
}

double channel_mean(Color c) { return (double(c.r) + c.g + c.b) / 3; }

struct Place {
    Vec2 u;
    Color scale;  // 1 / (R² + c), roughly
    double probability = 0;
    bool served = false;
};

template <class Probes>
class Estimator {
  public:
    Estimator(const Probes& probes, const ErrorCheck& check, Progress& progress)
        : probes_(probes),
          check_(check),
          progress_(progress),
          count_(first_places(check.rays)),
          paths_(paths_of_look(check.rays)) {}

    ErrorEstimate run() {
        const uint64_t before = progress_.rays;
        spread();
        choose();
        ErrorEstimate out;
        size_t served = 0;
        for (const Place& p : places_) served += p.served;
        out.missed = 1 - static_cast<double>(served) / static_cast<double>(places_.size());
        for (uint32_t round = 0; round < 2 || (progress_.rays - before < check_.rays && !decided(out)); ++round) {
            add_round(round, out);
            summarize(out);
        }
        return out;
    }

  private:
    /// Returns `f(i)` in index order, which several processes may compute.
    template <class T, class F>
    std::vector<T> shared(size_t count, uint64_t rays_of_item, const F& f) {
        return shared_map<T>(check_.exchange.get(), count, rays_of_item, check_.threads, progress_, [&](size_t i) {
            progress_.check();
            return f(i);
        });
    }

    /// Chooses evenly distributed places, one in each cell of a grid, and computes the light that is shown there.
    void spread() {
        const uint32_t columns = probes_.columns(count_), rows = count_ / columns;
        const size_t count = size_t(rows) * columns;
        places_.resize(count);
        for (size_t i = 0; i < count; ++i) {
            const auto index = static_cast<uint32_t>(i);
            Sampler sampler(stream_seed(check_.seed, Stream::estimate_layout), index, 0);
            const Vec2 jitter = sampler.next_2d();
            places_[i].u = {(static_cast<float>(i % columns) + jitter.x) / static_cast<float>(columns),
                            (static_cast<float>(i / columns) + jitter.y) / static_cast<float>(rows)};
        }
        const auto shown = shared<Color>(count, samples_first * rays_of_path, [&](size_t i) {
            return probes_.shown(places_[i].u, 0, static_cast<uint32_t>(i), samples_first, progress_);
        });
        double square = 0;
        for (const Color& c : shown) square += channel_mean(c * c);
        c_ = static_cast<float>(relative_c * square / static_cast<double>(count));
        for (size_t i = 0; i < count; ++i) places_[i].scale = scale_of(shown[i]);
    }

    /// Computes 1 / (R² + c).
    Color scale_of(Color R) const {
        Color scale;
        for (int k = 0; k < 3; ++k) {
            const float below = R[k] * R[k] + c_;
            scale[k] = below > 0 ? 1 / below : 0;  // if everything is black, there is no error
        }
        return scale;
    }

    /// Computes the probability of each place in the second phase.
    void choose() {
        struct Guess {
            double squared;
            uint64_t served;
        };
        const auto guesses = shared<Guess>(places_.size(), guess_paths * rays_of_path, [&](size_t i) {
            const Probe probe = probes_.guess(places_[i].u, static_cast<uint32_t>(i), guess_paths, progress_);
            return Guess{channel_mean(probe.value * probe.value * places_[i].scale), probe.served};
        });
        double sum = 0;
        for (size_t i = 0; i < places_.size(); ++i) {
            sum += guesses[i].squared;
            places_[i].served = guesses[i].served != 0;
        }
        const double even = 1 / static_cast<double>(places_.size());
        for (size_t i = 0; i < places_.size(); ++i)
            places_[i].probability = sum > 0 ? even_chance * even + (1 - even_chance) * guesses[i].squared / sum : even;
    }

    /// Draws places by systematic sampling of the cumulative sum of their probabilities, and makes two gathers at each.
    void add_round(uint32_t round, ErrorEstimate& out) {
        std::vector<uint32_t> drawn;
        const double shift = to_unit_float(hash(stream_seed(check_.seed, Stream::estimate_draws), round));
        double sum = 0;
        for (uint32_t i = 0; i < places_.size(); ++i) {
            sum += places_[i].probability;
            while (drawn.size() < round_places && (static_cast<double>(drawn.size()) + shift) / round_places < sum)
                drawn.push_back(i);
        }
        while (drawn.size() < round_places) drawn.push_back(static_cast<uint32_t>(places_.size() - 1));  // rounding
        struct Found {
            ErrorPlace place;
            double z;
        };
        const auto found = shared<Found>(drawn.size(), 2 * looks * paths_ * rays_of_path, [&](size_t k) {
            const Place& place = places_[drawn[k]];
            const uint32_t key = round * round_places + static_cast<uint32_t>(k);
            const Probe a = probes_.error(place.u, 2, key, looks, paths_, progress_);
            const Probe b = probes_.error(place.u, 3, key, looks, paths_, progress_);
            const Color scale = scale_of(probes_.shown(place.u, 4, key, samples_second, progress_));
            const double squared = channel_mean(a.value * b.value * scale);
            return Found{{a.served ? a.position : b.position, static_cast<float>(squared)},
                         squared / (static_cast<double>(places_.size()) * place.probability)};
        });
        for (const Found& f : found) {
            out.places.push_back(f.place);
            z_.push_back(f.z);
            out.paths += 2 * looks * paths_;
        }
    }

    // The variance of z includes the noise of the gathers and the choice of places from those of the first phase; the
    // variance from the choice of the places of the first phase is added.
    void summarize(ErrorEstimate& out) const {
        const auto n = static_cast<double>(z_.size());
        double mean = 0, squares = 0, first = 0;
        for (double z : z_) mean += z / n;
        for (size_t i = 0; i < z_.size(); ++i) {
            squares += (z_[i] - mean) * (z_[i] - mean);
            first += z_[i] * out.places[i].squared / n;
        }
        const double between = std::max(0.0, first - mean * mean) / static_cast<double>(places_.size());
        out.squared = mean;
        out.deviation = std::sqrt(squares / (n * (n - 1)) + between);
    }

    /// Returns whether the confidence interval excludes the wanted error.
    bool decided(const ErrorEstimate& out) const {
        constexpr double sigmas = 4;  // wider than the stated interval, because stopping early causes bias
        const double wanted = check_.wanted * check_.wanted;
        return check_.wanted > 0 && std::fabs(out.squared - wanted) > sigmas * out.deviation;
    }

    const Probes& probes_;
    const ErrorCheck& check_;
    Progress& progress_;
    uint32_t count_, paths_;
    float c_ = 0;
    std::vector<Place> places_;
    std::vector<double> z_;
};

}  // namespace

ErrorEstimate estimate_error(const World& world, const Camera& camera, const SolvedCaches& caches,
                             const RadianceTables* tables, const ErrorCheck& check, Progress& progress) {
    const PixelProbes probes(world, camera, caches, tables, check.max_depth, check.seed);
    return Estimator(probes, check, progress).run();
}

ErrorEstimate estimate_error(const World& world, std::span<const PointNormal> points, const SolvedCaches& caches,
                             const ErrorCheck& check, Progress& progress) {
    if (points.empty()) return {};
    const PointProbes probes(world, points, caches, check.max_depth, check.seed);
    return Estimator(probes, check, progress).run();
}

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Sums of samples per pixel and layer. The samples of a pixel are added in the order of their index, so that any division of the
// work gives the same bits. Samples that are not finite are counted and recorded instead of added.

#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <tuple>
#include <vector>

#include "base/color.h"

namespace eclat {

struct FilmSample {
    Color radiance{}, direct{}, albedo{};
    Vec3 normal{};
    float distance = 0;  // 0 if the ray hit nothing
    bool cache_missed = false;
    bool gloss_cached = false, gloss_traced = false;  // at the first vertex
    Color rough_albedo{};  // albedo of the first surface that is neither a mirror nor clear glass
    Vec3 rough_normal{};
};

struct BadSample {
    int x, y;
    uint32_t sample;

    auto key() const { return std::tuple(sample, y, x); }
};

class Film {
  public:
    /// The film of a part of a picture has the picture's pixel (x0, y0) in its upper left corner.
    Film(int width, int height, int x0 = 0, int y0 = 0)
        : width_(width), height_(height), x0_(x0), y0_(y0), pixels_(size_t(width) * height) {}
    /// This may be called only between passes, while no samples are added.
    Film(const Film& other)
        : width_(other.width_),
          height_(other.height_),
          x0_(other.x0_),
          y0_(other.y0_),
          pixels_(other.pixels_),
          bad_count_(other.bad_count_),
          bad_(other.bad_) {}

    /// (x, y) is a pixel of the picture.
    void add(int x, int y, uint32_t sample, const FilmSample& s) {
        Pixel& p = pixels_[size_t(y - y0_) * width_ + (x - x0_)];
        if (!is_finite(s.radiance)) {
            report(x, y, sample);
            return;
        }
        ++p.samples;
        p.radiance += s.radiance;
        p.direct += s.direct;
        p.albedo += s.albedo;
        p.normal += s.normal;
        p.rough_albedo += s.rough_albedo;
        p.rough_normal += s.rough_normal;
        p.cache_misses += s.cache_missed;
        p.gloss_cached += s.gloss_cached;
        p.gloss_traced += s.gloss_traced;
        if (s.distance > 0) {
            ++p.hits;
            p.distance += s.distance;
        }
    }

    struct Pixel {
        Color radiance, direct, albedo;
        Vec3 normal;
        Color rough_albedo;
        Vec3 rough_normal;
        float distance = 0;
        uint32_t samples = 0, hits = 0, cache_misses = 0, gloss_cached = 0, gloss_traced = 0;

        void add(const Pixel& p) {
            radiance += p.radiance, direct += p.direct, albedo += p.albedo, normal += p.normal;
            rough_albedo += p.rough_albedo, rough_normal += p.rough_normal, distance += p.distance;
            samples += p.samples, hits += p.hits, cache_misses += p.cache_misses;
            gloss_cached += p.gloss_cached, gloss_traced += p.gloss_traced;
        }
    };

    /// Adds the samples of a film of the same size. From then on sample n of this one has the number 2 n, and of the other
    /// 2 n + 1.
    void interleave(const Film& other) {
        for (size_t i = 0; i < pixels_.size(); ++i) pixels_[i].add(other.pixels_[i]);
        bad_count_ += other.bad_count_;
        for (BadSample& bad : bad_) bad.sample *= 2;
        for (const BadSample& bad : other.bad_) remember({bad.x, bad.y, 2 * bad.sample + 1});
    }

    /// Counts samples that were not finite in the film of a part of this picture; `first` are the first of them.
    void add_bad(uint64_t count, const std::vector<BadSample>& first) {
        bad_count_ += count;
        for (const BadSample& bad : first) remember(bad);
    }

    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<Pixel>& pixels() const { return pixels_; }
    std::vector<Pixel>& pixels() { return pixels_; }
    uint64_t bad_count() const { return bad_count_; }
    const std::vector<BadSample>& bad_samples() const { return bad_; }

  private:
    static constexpr size_t bad_samples_kept = 8;

    void report(int x, int y, uint32_t sample) {
        const std::lock_guard lock(mutex_);
        ++bad_count_;
        remember({x, y, sample});
    }

    /// The first ones by position and not by time, so that a warning is the same with any number of threads.
    void remember(const BadSample& bad) {
        const auto before = [](const BadSample& a, const BadSample& b) { return a.key() < b.key(); };
        bad_.insert(std::upper_bound(bad_.begin(), bad_.end(), bad, before), bad);
        if (bad_.size() > bad_samples_kept) bad_.pop_back();
    }

    int width_, height_;
    int x0_ = 0, y0_ = 0;
    std::vector<Pixel> pixels_;
    std::mutex mutex_;
    uint64_t bad_count_ = 0;
    std::vector<BadSample> bad_;
};

}  // namespace eclat

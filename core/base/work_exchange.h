// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Work that several processes share. Each runs the same computation, in which steps of many independent items follow each
// other. One process asks: it has ranges of the items of a step computed by the others, or computes them itself, uses what they
// found, and tells what the next step needs of it, the digest of the step. The others follow: they take the digest, and so come to
// the next step with the same state, but without having computed what is theirs not to compute. So all have the same bits.
//
// Held to   tests/python/methods/test_shared_work.py

#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"

namespace eclat {

/// Computes the items [first, end) of the present step, and returns what they found as bytes, which only the same build on the
/// same kind of machine can read.
using WorkRange = std::function<std::string(size_t first, size_t end)>;

class WorkExchange {
  public:
    struct Answer {
        std::vector<std::string> ranges;    // what ranges that are all items found, in order: for the process that asks
        std::optional<std::string> digest;  // what the process that asks told after this step: for those that follow
    };
    /// Gets the number of items of a step, about how many rays each takes, and the function that computes a range of them.
    using Share = std::function<Answer(size_t count, uint64_t rays_of_item, const WorkRange& compute)>;
    using Tell = std::function<void(const std::string& digest)>;

    WorkExchange(Share share, Tell tell) : share_(std::move(share)), tell_(std::move(tell)) {}

    Answer share(size_t count, uint64_t rays_of_item, const WorkRange& compute) const {
        return share_(count, rays_of_item, compute);
    }
    /// Is called once after each step whose answer had no digest.
    void tell(const std::string& digest) const { tell_(digest); }

  private:
    Share share_;
    Tell tell_;
};

/// Appends values to bytes, as they lie in memory.
template <class T>
void write_bytes(std::string& out, std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    out.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}
template <class T>
void write_bytes(std::string& out, const T& value) {
    write_bytes(out, std::span<const T>(&value, 1));
}

/// Reads what `write_bytes` wrote. Throws if there are too few bytes.
class ByteReader {
  public:
    explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}

    bool at_end() const { return at_ == bytes_.size(); }

    template <class T>
    std::vector<T> read(uint64_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        require(count <= (bytes_.size() - at_) / sizeof(T), "shared work: expected more bytes than there are");
        std::vector<T> out(count);
        if (count) std::memcpy(static_cast<void*>(out.data()), bytes_.data() + at_, count * sizeof(T));
        at_ += count * sizeof(T);
        return out;
    }
    template <class T>
    T read() {
        return read<T>(1).front();
    }
    template <class T>
    std::vector<T> rest() {
        require((bytes_.size() - at_) % sizeof(T) == 0, "shared work: expected whole values");
        return read<T>((bytes_.size() - at_) / sizeof(T));
    }

  private:
    const std::string& bytes_;
    size_t at_ = 0;
};

/// One step of shared work. The rays that all ranges took count as if this process had traced them, and those of ranges that it
/// computed count once.
class SharedStep {
  public:
    /// `compute` returns the bytes of a range, without its rays.
    SharedStep(const WorkExchange& exchange, size_t count, uint64_t rays_of_item, Progress& progress,
               const WorkRange& compute)
        : exchange_(exchange) {
        const uint64_t begin = progress.rays;
        const WorkRange counted = [&](size_t first, size_t end) {
            progress.check();
            require(first <= end && end <= count, "shared work: expected a range within the step");
            const uint64_t before = progress.rays;
            const std::string found = compute(first, end);
            std::string out;
            write_bytes(out, static_cast<uint64_t>(progress.rays - before));
            return out + found;
        };
        WorkExchange::Answer answer = exchange.share(count, rays_of_item, counted);
        if (answer.digest) {
            rays_ = without_rays(*answer.digest);
            digest_ = std::move(answer.digest);
        }
        for (std::string& range : answer.ranges) {
            rays_ += without_rays(range);
            ranges_.push_back(std::move(range));
        }
        progress.rays = begin + rays_;
    }

    /// What the process that asks told of this step; nothing in that process itself, which has the ranges.
    const std::optional<std::string>& digest() const { return digest_; }
    const std::vector<std::string>& ranges() const { return ranges_; }
    /// Tells the digest of this step, for which there was none.
    void tell(const std::string& digest) const {
        std::string out;
        write_bytes(out, rays_);
        exchange_.tell(out + digest);
    }

  private:
    static uint64_t without_rays(std::string& bytes) {
        const auto rays = ByteReader(bytes).read<uint64_t>();
        bytes.erase(0, sizeof rays);
        return rays;
    }

    const WorkExchange& exchange_;
    uint64_t rays_ = 0;
    std::optional<std::string> digest_;
    std::vector<std::string> ranges_;
};

/// Returns the results of `f(i)` in index order, each of which all processes need. Without an exchange, this one computes all.
template <class T, class F>
std::vector<T> shared_map(const WorkExchange* exchange, size_t count, uint64_t rays_of_item, int threads,
                          Progress& progress, F&& f) {
    if (!exchange) return parallel_map<T>(count, threads, f);
    const SharedStep step(*exchange, count, rays_of_item, progress, [&](size_t first, size_t end) {
        std::string out;
        write_bytes(out,
                    std::span<const T>(parallel_map<T>(end - first, threads, [&](size_t i) { return f(first + i); })));
        return out;
    });
    std::string all;
    if (step.digest()) all = *step.digest();
    for (const std::string& range : step.ranges()) all += range;
    std::vector<T> out = ByteReader(all).rest<T>();
    require(out.size() == count, "shared work: expected the results of all items");
    if (!step.digest()) step.tell(all);
    return out;
}

}  // namespace eclat

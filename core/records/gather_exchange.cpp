// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "records/gather_exchange.h"

#include <cstring>
#include <type_traits>

#include "base/parallel.h"

namespace eclat {

namespace {

/// What has a fixed size of a gather, and the lengths of the rest.
struct Head {
    IrradianceRecord record;
    float obstacle, reach, footprint;
    uint64_t sightings, samples;
};

template <class T>
void write(std::string& out, std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    out.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

class Reader {
  public:
    explicit Reader(const std::string& bytes) : bytes_(bytes) {}

    bool at_end() const { return at_ == bytes_.size(); }

    template <class T>
    std::vector<T> read(uint64_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        require(count <= (bytes_.size() - at_) / sizeof(T), "gathers: expected more bytes than there are");
        std::vector<T> out(count);
        if (count) std::memcpy(static_cast<void*>(out.data()), bytes_.data() + at_, count * sizeof(T));
        at_ += count * sizeof(T);
        return out;
    }

  private:
    const std::string& bytes_;
    size_t at_ = 0;
};

}  // namespace

std::string packed(std::span<const Gathered> gathered, uint64_t rays) {
    std::string out;
    write(out, std::span<const uint64_t>(&rays, 1));
    for (const Gathered& g : gathered) {
        Head head;
        std::memset(static_cast<void*>(&head), 0, sizeof head);  // so that equal gathers have equal bytes
        head.record = g.record;
        head.obstacle = g.obstacle, head.reach = g.reach, head.footprint = g.footprint;
        head.sightings = g.sightings.size(), head.samples = g.samples.size();
        write(out, std::span<const Head>(&head, 1));
        write(out, std::span<const Sighting>(g.sightings));
        write(out, std::span<const CellSample>(g.samples));
    }
    return out;
}

uint64_t unpack(const std::string& bytes, std::vector<Gathered>& out) {
    Reader reader(bytes);
    const uint64_t rays = reader.read<uint64_t>(1).front();
    while (!reader.at_end()) {
        const Head head = reader.read<Head>(1).front();
        Gathered& g = out.emplace_back();
        g.record = head.record;
        g.obstacle = head.obstacle, g.reach = head.reach, g.footprint = head.footprint;
        g.sightings = reader.read<Sighting>(head.sightings);
        g.samples = reader.read<CellSample>(head.samples);
    }
    return rays;
}

std::vector<Gathered> exchanged(const GatherExchange& exchange, size_t count, int threads, Progress& progress,
                                const std::function<Gathered(size_t)>& gather) {
    uint64_t own = 0;
    const GatherRange compute = [&](size_t first, size_t end) {
        progress.check();
        require(first <= end && end <= count, "gathers: expected a range within the pass");
        const uint64_t before = progress.rays;
        const auto found = parallel_map<Gathered>(end - first, threads, [&](size_t i) { return gather(first + i); });
        own += progress.rays - before;
        return packed(found, progress.rays - before);
    };
    uint64_t rays = 0;
    std::vector<Gathered> out;
    for (const std::string& bytes : exchange(count, compute)) rays += unpack(bytes, out);
    require(out.size() == count, "gathers: expected all of the pass");
    progress.count_rays(rays - std::min(rays, own));
    return out;
}

}  // namespace eclat

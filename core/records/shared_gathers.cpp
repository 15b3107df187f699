// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "records/shared_gathers.h"

namespace eclat {

namespace {

enum class Samples { with, without };

/// What has a fixed size of a gather, and the lengths of the rest.
struct Head {
    IrradianceRecord record;
    float obstacle, reach, footprint;
    uint32_t sightings, samples, values, gradients;
};

void write(std::string& out, const Gathered& g, Samples samples) {
    Head head;
    std::memset(static_cast<void*>(&head), 0, sizeof head);  // so that equal gathers have equal bytes
    head.record = g.record;
    head.obstacle = g.obstacle, head.reach = g.reach, head.footprint = g.footprint;
    const std::span<const CellSample> sent = samples == Samples::with ? g.samples : std::span<const CellSample>();
    head.sightings = static_cast<uint32_t>(g.sightings.size()), head.samples = static_cast<uint32_t>(sent.size());
    head.values = static_cast<uint32_t>(g.radiance.values.size());
    head.gradients = static_cast<uint32_t>(g.radiance.gradients.size());
    write_bytes(out, head);
    write_bytes(out, std::span<const Sighting>(g.sightings));
    write_bytes(out, sent);
    write_bytes(out, std::span<const float>(g.radiance.values));
    write_bytes(out, std::span<const float>(g.radiance.gradients));
}

Gathered read(ByteReader& reader) {
    const Head head = reader.read<Head>();
    Gathered g;
    g.record = head.record;
    g.obstacle = head.obstacle, g.reach = head.reach, g.footprint = head.footprint;
    g.sightings = reader.read<Sighting>(head.sightings);
    g.samples = reader.read<CellSample>(head.samples);
    g.radiance.values = reader.read<float>(head.values);
    g.radiance.gradients = reader.read<float>(head.gradients);
    return g;
}

}  // namespace

SharedGathers::SharedGathers(const WorkExchange& exchange, size_t count, uint64_t rays, int threads, Progress& progress,
                             const std::function<Gathered(size_t)>& gather)
    : step_(exchange, count, rays, progress, [&](size_t first, size_t end) {
          std::string out;
          for (const Gathered& g :
               parallel_map<Gathered>(end - first, threads, [&](size_t i) { return gather(first + i); }))
              write(out, g, Samples::with);
          return out;
      }) {
    for (const std::string& range : step_.ranges()) {
        ByteReader reader(range);
        while (!reader.at_end()) gathered_.push_back(read(reader));
    }
    if (step_.digest()) {
        ByteReader reader(*step_.digest());
        for (size_t i = 0; i < count; ++i) gathered_.push_back(read(reader));
        means_ = reader.rest<CellMean>();
    }
    require(gathered_.size() == count, "gathers: expected all of the pass");
}

void SharedGathers::tell(std::span<const CellMean> changed) const {
    std::string out;
    for (const Gathered& g : gathered_) write(out, g, Samples::without);
    write_bytes(out, changed);
    step_.tell(out);
}

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A record on a surface that moves, or in light that changes, is gathered anew at other times, at the same place of the surface
// and with the same random numbers. Two gathers then differ by what has changed and not by noise.
//
// References   [Gautron07] records are renewed in place
// Held to      tests/core/records/test_renewal.cpp

#include "records/renewal.h"

#include "base/parallel.h"
#include "records/spacing.h"

namespace eclat {

namespace {

Renewed renew_one(const RenewalTask& task, const Renewal& renewal, Progress& progress) {
    const bool far = task.settings.kind == RecordKind::far;
    const IrradianceRecord& old = renewal.record;
    const IrradianceCacheOptions options = far ? far_gathering(task.options) : task.options;
    Candidate candidate;
    candidate.position = old.position;
    candidate.normal = old.normal;
    candidate.shading_normal = renewal.shading_normal;
    candidate.offset = task.world.geometry.ray_offset(old.position, old.normal);
    candidate.footprint = far ? 0 : old.least_radius / options.least_pixels;
    candidate.key = renewal.key;
    candidate.seen = !far;
    const FarEnd none;
    const GatherTask gathering{task.world,
                               far ? none : task.far,
                               task.settings.bright,
                               options,
                               far ? Stream::far_records : Stream::near_records,
                               progress};
    Renewed out;
    const int rows = far ? options.far_rows : rows_of(old, options.rows);
    const Gathered gathered = gather(gathering, candidate, rows, Rows::cosine, [&](const HemisphereSamples& samples) {
        for (const Color& L : samples.radiance) out.seen.push_back(luminance(L));
    });
    out.record = gathered.record;
    space(out.record, gathered.obstacle, gathered.footprint, task.settings.mean, spacing_rule(options));
    if (far && gathered.reach < infinity) {
        bound_far(out.record, gathered.reach, options);
    } else {
        out.record.least_radius = old.least_radius;
        out.record.largest_radius = old.largest_radius;
    }
    return out;
}

}  // namespace

std::vector<Renewed> renew(const RenewalTask& task, std::span<const Renewal> renewals, Progress& progress) {
    progress.begin(renewals.size());
    return parallel_map<Renewed>(renewals.size(), task.options.threads, [&](size_t i) {
        progress.check();
        Renewed out = renew_one(task, renewals[i], progress);
        progress.advance();
        return out;
    });
}

}  // namespace eclat

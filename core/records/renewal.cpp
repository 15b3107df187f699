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

/// How the records of one kind are gathered.
struct Shape {
    IrradianceCacheOptions options;
    Stream stream;
    Rows kind;
    int rows;
};

Shape shape_of(const RenewalTask& task, const IrradianceRecord& old) {
    switch (task.settings.kind) {
        case RecordKind::far:
            return {far_gathering(task.options), Stream::far_records, Rows::cosine, task.options.far_rows};
        case RecordKind::radiance:
            return {task.options, Stream::radiance_records, task.projection->kind(), task.projection->rows()};
        case RecordKind::near: break;
    }
    return {task.options, Stream::near_records, Rows::cosine, rows_of(old, task.options.rows)};
}

Candidate candidate_at(const RenewalTask& task, const Renewal& renewal) {
    const IrradianceRecord& old = renewal.record;
    const bool far = task.settings.kind == RecordKind::far;
    Candidate candidate;
    candidate.position = old.position;
    candidate.normal = old.normal;
    candidate.shading_normal = renewal.shading_normal;
    candidate.offset = task.world.geometry.ray_offset(old.position, old.normal);
    candidate.footprint = far ? 0 : old.least_radius / task.options.least_pixels;
    candidate.key = renewal.key;
    candidate.seen = !far;
    return candidate;
}

Renewed renew_one(const RenewalTask& task, const Renewal& renewal, Progress& progress) {
    const RecordKind kind = task.settings.kind;
    const Shape shape = shape_of(task, renewal.record);
    const FarEnd none;
    const GatherTask gathering{task.world,           kind == RecordKind::far ? none : task.far,
                               task.settings.bright, shape.options,
                               shape.stream,         progress};
    Renewed out;
    const Gathered gathered =
        gather(gathering, candidate_at(task, renewal), shape.rows, shape.kind, [&](const HemisphereSamples& samples) {
            for (const Color& L : samples.radiance) out.seen.push_back(luminance(L));
            if (kind == RecordKind::radiance) out.coefficients = (*task.projection)(samples);
        });
    out.record = gathered.record;
    space(out.record, gathered.obstacle, gathered.footprint, task.settings.mean, spacing_rule(shape.options));
    if (kind == RecordKind::far && gathered.reach < infinity) {
        bound_far(out.record, gathered.reach, shape.options);
    } else {
        out.record.least_radius = renewal.record.least_radius;
        out.record.largest_radius = renewal.record.largest_radius;
    }
    if (kind == RecordKind::radiance) reduce_gradients(out.record, shape.options.spacing, out.coefficients);
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

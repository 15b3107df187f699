// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Records that are gathered anew where their surfaces are at another time.

#pragma once

#include <span>
#include <vector>

#include "records/gather.h"

namespace eclat {

/// A record to gather anew. Its position and normal are those of its surface now; its bounds and the number of its rays are
/// kept.
struct Renewal {
    IrradianceRecord record;
    Vec3 shading_normal;
    uint32_t key =
        0;  // of its random numbers, the same at all times, so that what has not changed stays the same in every bit
};

/// A renewed record, and what it saw: the luminance in each cell of its grid, without the excess, W·m⁻²·sr⁻¹.
struct Renewed {
    IrradianceRecord record;
    std::vector<float> seen;
    RadianceCoefficients coefficients{};  // of a radiance record
};

enum class RecordKind { near, far, radiance };

/// What renewals of one kind have in common at all times.
struct RenewalSettings {
    BrightPlaces bright{};  // places at which some rays are aimed, from any time
    RecordKind kind = RecordKind::near;
    float mean = 0;  // mean luminance of the irradiance in the scene, W·m⁻²
};

/// The data that all renewals of one time share.
struct RenewalTask {
    const World& world;
    const FarEnd& far;  // the light that rays read where they end; those of far records trace whole paths
    const RenewalSettings& settings;
    const IrradianceCacheOptions& options;
    const RadianceProjection* projection;  // of radiance records, whose gathers have its grid
};

/// Gathers records anew, in parallel. `progress` counts the records.
std::vector<Renewed> renew(const RenewalTask& task, std::span<const Renewal> renewals, Progress& progress);

}  // namespace eclat

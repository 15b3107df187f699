// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Records of incident radiance: where an irradiance record keeps one colour, these keep what arrives from each direction, so
// that any lobe wide enough finds what it reflects by a dot product. Positions, radii, weights and what ends a record's
// validity are those of irradiance records, which each of them has beside it.
//
// References   [Krivanek05]; [Krivanek06] adaptive refinement by reflected radiance and Weber's law
//
// Symbol       name here    meaning
//   L_o        –            Σ_k w_k Σ_i (λ_ik + (P − P_k)·∂λ_ik) f_i / Σ_k w_k
//
// Departures   The factors f are turned into each record's frame instead of the light into the query's: three times fewer
//              numbers. A record's radius is multiplied by the lobe's width at the query.
// Held to      tests/core/records/test_radiance_record_cache.cpp, tests/methods/test_radiance_cache.py

#pragma once

#include <optional>
#include <vector>

#include "records/record_cache.h"
#include "hemisphere/radiance_rotation.h"
#include "tables/radiance_tables.h"

namespace eclat {

/// The lobe for which a record was made, as far as neighbours are compared by it.
struct PlacedLobe {
    float width = 1;
    Color albedo;                // under uniform light
    std::vector<float> factors;  // three channels, each padded as the records' values are, in Frame::around(normal)
};

/// Beyond this angle between the shading normal and that of a record, too much has risen over its horizon.
constexpr float largest_radiance_tilt = 0.3f;

/// How far from records radiance is read.
enum class Reading : uint8_t {
    smooth,   // beyond their radii, so that none ends abruptly: for what is seen
    nearest,  // within them, which takes a quarter of the records: for averages of many places
};

class RadianceCache {
  public:
    RadianceCache() = default;
    RadianceCache(const CacheOptions& options, int order);

    int order() const { return order_; }
    const std::vector<IrradianceRecord>& records() const { return cache_.records(); }
    float mean_luminance() const { return cache_.mean_luminance(); }
    /// Numbers of a channel: n², and zeros up to whole vectors of eight.
    size_t stride() const { return stride_; }
    /// The coefficients of all records one after another, with channels as in RadianceCoefficients.
    const std::vector<float>& values() const { return values_; }
    /// The upper halves of floats: three digits do for a correction.
    const std::vector<uint16_t>& gradients() const { return gradients_; }

    /// Adds records with their coefficients, in the order given; `lobes` of all of them, or of none.
    void insert(std::span<const IrradianceRecord> records, std::span<const RadianceCoefficients> coefficients,
                std::span<const PlacedLobe> lobes, float spacing, int threads);
    /// From the arrays of another cache.
    void insert(std::span<const IrradianceRecord> records, std::span<const float> values,
                std::span<const uint16_t> gradients, float spacing, int threads);

    /// A lobe with these `factors` in the frame `shading`, for a record there.
    PlacedLobe placed_lobe(const ReflectedFactors& factors, const Frame& shading, Vec3 normal) const;

    /// Where two records that reach each other reflect, by the lobe that stands at one of them, unlike radiance there, by more
    /// than `tolerance` of it beyond what their noise explains, the worse one's radius shrinks. What it no longer serves is up
    /// to the next pass. Returns how many shrank; needs the lobes of all records.
    size_t shrink_where_records_disagree(float tolerance, float spacing, int threads);

    /// How far a lobe of relative width σ may reach, in units of a record's radius.
    static float reach(float width);

    /// Whether a record serves a lobe of that width at the point, by the strict test that decides where records are placed.
    bool serves(Vec3 p, Vec3 normal, float width) const;

    /// Indirect radiance reflected by lobes with these `factors` in the frame `shading`; nothing where no record serves them.
    std::optional<Color> reflect(Vec3 p, Vec3 normal, const Frame& shading, const ReflectedFactors& factors,
                                 Reading reading = Reading::smooth) const;

  private:
    /// How far that lobe reads records beyond that.
    float relaxed_reach(float width) const;
    /// What record i reflects at `p` by `factors` in its own frame, a pointer for each channel.
    Color reflected(uint32_t i, Vec3 p, const std::array<const float*, 3>& factors, size_t padded) const;

    int order_ = 0;
    size_t stride_ = 0;
    RecordCache cache_;
    RadianceRotation rotation_;
    std::vector<float> values_;
    std::vector<uint16_t> gradients_;
    std::vector<PlacedLobe> lobes_;  // of the records, while they are made
};

}  // namespace eclat

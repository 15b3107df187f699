// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Records of incident radiance. An irradiance record stores one colour; a radiance record stores the radiance as a
// function of direction, so that the light that a wide lobe reflects is a dot product. Each radiance record belongs to
// an irradiance record, which has the same position, radius, weight and limits of validity.
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

/// The lobe for which a record was made, which serves to compare the record with its neighbours.
struct PlacedLobe {
    float width = 1;
    Color albedo;                // reflectance under uniform light
    std::vector<float> factors;  // three channels, each padded as the records' values are, in Frame::around(normal)
};

/// Reduces the gradients of a record whose radius a lower bound increased, like those of irradiance: they would reach farther
/// than they are known.
void reduce_gradients(const IrradianceRecord& record, float spacing, RadianceCoefficients& coefficients);

/// The largest angle between the shading normal and that of a record. Beyond it, the query sees too much that is below
/// the record's horizon.
constexpr float largest_radiance_tilt = 0.3f;

/// The distance from records up to which radiance is read.
enum class Reading : uint8_t {
    smooth,   // beyond their radii, so that no record ends abruptly: for visible surfaces
    nearest,  // within their radii, which reads a quarter of the records: for averages over many points
};

class RadianceCache {
  public:
    RadianceCache() = default;
    RadianceCache(const CacheOptions& options, int order);

    int order() const { return order_; }
    const std::vector<IrradianceRecord>& records() const { return cache_.records(); }
    float mean_luminance() const { return cache_.mean_luminance(); }
    /// Returns the excess irradiance of record i, averaged over the records around it.
    Color shared_excess(uint32_t i) const { return cache_.shared_excess(i); }
    /// Returns the number of floats of a channel: n² coefficients, padded with zeros to a multiple of eight.
    size_t stride() const { return stride_; }
    /// The coefficients of all records, consecutively, with channels as in RadianceCoefficients.
    const std::vector<float>& values() const { return values_; }
    /// These are the upper halves of floats, because three digits suffice for a correction.
    const std::vector<uint16_t>& gradients() const { return gradients_; }

    /// Adds records with their coefficients, in the given order. `lobes` is empty or has an entry for each record.
    void insert(std::span<const IrradianceRecord> records, std::span<const RadianceCoefficients> coefficients,
                std::span<const PlacedLobe> lobes, float spacing, int threads);
    /// Makes a cache from the arrays of another cache.
    void insert(std::span<const IrradianceRecord> records, std::span<const float> values,
                std::span<const uint16_t> gradients, float spacing, int threads);

    /// Makes the lobe of a record from `factors` that are in the frame `shading`.
    PlacedLobe placed_lobe(const ReflectedFactors& factors, const Frame& shading, Vec3 normal) const;

    /// Compares records that reach each other by the radiance that the lobe of one of them reflects. If the two values
    /// differ by more than `tolerance` times that radiance, beyond what noise explains, the radius of the worse record
    /// shrinks. The next pass adds records where it is no longer valid. Returns how many records shrank. All records
    /// must have lobes.
    size_t shrink_where_records_disagree(float tolerance, float spacing, int threads);

    /// Returns the distance up to which a lobe of relative width σ may read a record, in units of the record's radius.
    static float reach(float width);

    /// Returns whether a record serves a lobe of that width at the point by the strict test, which decides where
    /// records are placed.
    bool serves(Vec3 p, Vec3 normal, float width) const;

    /// Returns the indirect radiance that lobes with these `factors` in the frame `shading` reflect, or nothing if no
    /// record serves them.
    std::optional<Color> reflect(Vec3 p, Vec3 normal, const Frame& shading, const ReflectedFactors& factors,
                                 Reading reading = Reading::smooth) const;

  private:
    /// Returns how much farther that lobe reads records than the strict test allows.
    float relaxed_reach(float width) const;
    /// Returns the radiance that record i gives at `p` for `factors` in the record's own frame, with one pointer for
    /// each channel, and in `gradient`, unless it is null, how that radiance changes along the surface.
    Color reflected(uint32_t i, Vec3 p, const std::array<const float*, 3>& factors, size_t padded,
                    TranslationGradient* gradient = nullptr) const;

    int order_ = 0;
    size_t stride_ = 0;
    RecordCache cache_;
    RadianceRotation rotation_;
    std::vector<float> values_;
    std::vector<uint16_t> gradients_;
    std::vector<PlacedLobe> lobes_;  // lobes of the records, only while the cache is filled
};

}  // namespace eclat

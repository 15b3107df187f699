// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Records that are gathered anew: the same bits where nothing has changed, the closed form where the light has.

#include "records/renewal.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "hemisphere/hemisphere.h"
#include "room.h"

using namespace eclat;

namespace {

Room furnace(float emission) {
    std::array<float, 6> albedos, emissions;
    albedos.fill(0.5f);
    emissions.fill(emission);
    return closed_room(albedos, emissions);
}

IrradianceCacheOptions coarse() {
    IrradianceCacheOptions options;
    options.rows = 8;
    options.far_rows = 5;
    options.threads = 2;
    return options;
}

std::vector<Renewal> on_the_floor(int count) {
    std::vector<Renewal> out;
    for (int i = 0; i < count; ++i) {
        Renewal renewal;
        renewal.record.position = {-0.8f + 0.2f * static_cast<float>(i), -1, 0.3f};
        renewal.record.normal = renewal.shading_normal = {0, 1, 0};
        renewal.record.least_radius = 0.01f;
        renewal.record.largest_radius = 0.4f;
        renewal.key = static_cast<uint32_t>(i);
        out.push_back(renewal);
    }
    return out;
}

std::vector<Renewed> renewed(const Room& room, std::span<const Renewal> renewals, RecordKind kind) {
    const FarEnd far;
    const RenewalSettings settings{{}, kind, 0};
    const IrradianceCacheOptions options = coarse();
    const RadianceProjection projection(4, Rows::balanced, 8);
    Progress progress;
    auto out = renew({room.world(), far, settings, options, &projection}, renewals, progress);
    CHECK(progress.rays > renewals.size());
    CHECK(progress.done == renewals.size());
    return out;
}

bool same_bits(const Renewed& a, const Renewed& b) {
    return std::memcmp(&a.record, &b.record, sizeof a.record) == 0 && a.seen == b.seen &&
           a.coefficients.values == b.coefficients.values && a.coefficients.gradients == b.coefficients.gradients;
}

}  // namespace

TEST_CASE("renewed records have the closed form of a furnace, and all its cells the same radiance") {
    for (const RecordKind kind : {RecordKind::near, RecordKind::far, RecordKind::radiance}) {
        const auto before = renewed(furnace(2), on_the_floor(9), kind);
        const auto after = renewed(furnace(4), on_the_floor(9), kind);
        double sum = 0;
        for (size_t i = 0; i < before.size(); ++i) {
            sum += (before[i].record.irradiance + before[i].record.excess).g / 9;
            // The random numbers are the same, so the light doubles exactly.
            CHECK(after[i].record.irradiance.g == doctest::Approx(2 * before[i].record.irradiance.g).epsilon(1e-5));
            REQUIRE(after[i].seen.size() == before[i].seen.size());
            for (size_t k = 0; k < after[i].seen.size(); ++k)
                CHECK(after[i].seen[k] == doctest::Approx(2 * before[i].seen[k]).epsilon(1e-5));
        }
        CHECK(sum == doctest::Approx(pi * 2 * 0.5 / (1 - 0.5)).epsilon(0.05));
    }
}

TEST_CASE("what has not changed stays the same in every bit, whichever records are renewed with it") {
    for (const RecordKind kind : {RecordKind::near, RecordKind::far, RecordKind::radiance}) {
        const auto all = renewed(furnace(2), on_the_floor(9), kind);
        const auto renewals = on_the_floor(9);
        const auto one = renewed(furnace(2), std::span(renewals).subspan(4, 1), kind);
        CHECK(same_bits(all[4], one[0]));
    }
}

TEST_CASE("a renewed near record keeps its bounds and takes as many rows as the gather that made it") {
    auto renewals = on_the_floor(1);
    const Room room = furnace(2);
    const size_t usual = renewed(room, renewals, RecordKind::near)[0].seen.size();
    CHECK(usual == size_t(coarse().rows) * columns_for(coarse().rows));
    // A gather of 12 rows has more noise than one of the usual 14 rows.
    renewals[0].record.noise = 0.04f;
    renewals[0].record.own_noise = 0.04f / std::pow(12 / 14.0f, 1.5f);
    const Renewed more = renewed(room, renewals, RecordKind::near)[0];
    CHECK(more.seen.size() == size_t(12) * columns_for(12));
    CHECK(more.record.least_radius == renewals[0].record.least_radius);
    CHECK(more.record.largest_radius == renewals[0].record.largest_radius);
    CHECK(more.record.radius >= more.record.least_radius);
    CHECK(more.record.radius <= more.record.largest_radius);
}

TEST_CASE("renewed records of radiance have the same light from all directions of a furnace") {
    constexpr int order = 4;
    const size_t count = size_t(coefficient_count(order));
    double sum = 0;
    for (const Renewed& r : renewed(furnace(2), on_the_floor(9), RecordKind::radiance)) {
        REQUIRE(r.coefficients.values.size() == 3 * count);
        REQUIRE(r.coefficients.gradients.size() == 6 * count);
        double squares = 0;
        for (size_t i = 0; i < count; ++i) squares += sqr(double(r.coefficients.values[count + i]));
        // The basis is orthonormal on the hemisphere: the radiance L has coefficients of the norm √(2π) L.
        sum += (std::sqrt(squares / (2 * double(pi))) + double(r.record.excess.g) / double(pi)) / 9;
    }
    CHECK(sum == doctest::Approx(2 * 0.5 / (1 - 0.5)).epsilon(0.06));
}

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// BSDFs against Mitsuba 3: numbers in tests/golden/bsdf_mitsuba.csv, made by make_bsdf_golden.py beside it.

#include <doctest/doctest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "bsdf/bsdf.h"

using namespace eclat;

namespace {

struct GoldenRow {
    std::string kind, model;
    Vec3 wo, wi;
    Color f;  // times the cosine
    float pdf = 0;
};

std::vector<GoldenRow> read_golden() {
    std::ifstream file(ECLAT_TEST_DATA "/bsdf_mitsuba.csv");
    std::vector<GoldenRow> rows;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("#") || line.starts_with("kind")) continue;
        std::istringstream cells(line);
        GoldenRow row;
        std::getline(cells, row.kind, ',');
        std::getline(cells, row.model, ',');
        float x[10] = {};
        char comma;
        for (float& value : x) cells >> value >> comma;
        row.wo = {x[0], x[1], x[2]};
        row.wi = {x[3], x[4], x[5]};
        row.f = {x[6], x[7], x[8]};
        row.pdf = x[9];
        rows.push_back(row);
    }
    return rows;
}

/// The parameters of make_bsdf_golden.py.
struct GoldenModels {
    PlasticTable smooth = make_plastic_table(1.49f, 0, Distribution::ggx);
    PlasticTable ggx = make_plastic_table(1.49f, 0.3f, Distribution::ggx);
    PlasticTable beckmann = make_plastic_table(1.6f, 0.15f, Distribution::beckmann);

    std::map<std::string, Bsdf> all() const {
        constexpr auto ggx_d = Distribution::ggx, beckmann_d = Distribution::beckmann;
        const Color red(0.8f, 0.4f, 0.2f), green(0.3f, 0.9f, 0.5f), white(1);
        const Color eta(0.143f, 0.375f, 1.442f), k(3.983f, 2.386f, 1.603f);
        return {
            {"diffuse", make_diffuse(red)},
            {"conductor", make_conductor(eta, k, white, 0, 0, ggx_d)},
            {"conductor_ggx", make_conductor(eta, k, white, 0.3f, 0.3f, ggx_d)},
            {"conductor_ggx_anisotropic", make_conductor(eta, k, red, 0.1f, 0.5f, ggx_d)},
            {"conductor_beckmann", make_conductor(eta, k, white, 0.3f, 0.3f, beckmann_d)},
            {"conductor_beckmann_anisotropic", make_conductor(eta, k, white, 0.6f, 0.2f, beckmann_d)},
            {"dielectric", make_dielectric(1.5f, 0, 0, red, green, ggx_d)},
            {"dielectric_ggx", make_dielectric(1.5f, 0.3f, 0.3f, white, white, ggx_d)},
            {"dielectric_ggx_anisotropic", make_dielectric(1.33f, 0.2f, 0.5f, red, green, ggx_d)},
            {"dielectric_beckmann", make_dielectric(1.8f, 0.4f, 0.4f, white, white, beckmann_d)},
            {"thin_dielectric", make_thin_dielectric(1.5f, red, green)},
            {"plastic", make_plastic(smooth, red, white, ggx_d, false)},
            {"plastic_nonlinear", make_plastic(smooth, red, white, ggx_d, true)},
            {"roughplastic_ggx", make_plastic(ggx, red, green, ggx_d, false)},
            {"roughplastic_beckmann_nonlinear", make_plastic(beckmann, red, white, beckmann_d, true)},
        };
    }
};

void check_value(const GoldenRow& row, const Bsdf& bsdf) {
    const EvalPdf e = bsdf.eval(row.wo, row.wi, LobeSet::all);
    // Mitsuba's plastics take the inside's diffuse reflectance from a fit (0.1 %) or from coarser quadrature.
    const double tolerance = row.model.find("plastic") == std::string::npos ? 5e-4 : 5e-3;
    for (int i = 0; i < 3; ++i) {
        const double expected = double(row.f[i]), value = double(e.f[i] * abs_cos(row.wi));
        CHECK(std::abs(value - expected) <= tolerance * expected + 1e-7);
    }
    // Mixtures choose among their parts in another way, so do tinted interfaces; Mitsuba takes the density of
    // Beckmann's visible normals from the fit of their masking (0.4 %).
    if (row.model.find("plastic") != std::string::npos || row.model == "dielectric_ggx_anisotropic") return;
    const double pdf_tolerance = row.model.find("beckmann") == std::string::npos ? 5e-4 : 5e-3;
    CHECK(std::abs(double(e.pdf_solid_angle - row.pdf)) <= pdf_tolerance * double(row.pdf) + 1e-7);
}

void check_delta(const GoldenRow& row, const Bsdf& bsdf) {
    const bool transmission = row.wo.z * row.wi.z < 0;
    for (const float u_lobe : {0.0f, 0.9999f}) {
        const auto s = bsdf.sample(row.wo, u_lobe, {0.5f, 0.5f}, LobeSet::glossy);
        if (!s || s->transmission != transmission) continue;
        CHECK(s->delta);
        CHECK(length(s->wi - row.wi) < 1e-5f);
        const Color f = s->weight * s->pdf_solid_angle;
        // Of plastic, Mitsuba counts the choice between coat and base into the weight; so do we, over the coat alone.
        for (int i = 0; i < 3; ++i) CHECK(double(f[i]) == doctest::Approx(double(row.f[i])).epsilon(1e-4));
        return;
    }
    FAIL("no such delta part");
}

}  // namespace

TEST_CASE("values, densities and delta parts are Mitsuba's") {
    const std::vector<GoldenRow> rows = read_golden();
    REQUIRE(rows.size() > 200);
    const GoldenModels golden;
    const auto models = golden.all();
    for (const GoldenRow& row : rows) {
        CAPTURE(row.model);
        CAPTURE(row.wo.z);
        CAPTURE(row.wi.z);
        const Bsdf& bsdf = models.at(row.model);
        row.kind == "value" ? check_value(row, bsdf) : check_delta(row, bsdf);
    }
}

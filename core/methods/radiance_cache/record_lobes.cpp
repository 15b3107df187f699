// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiance_cache/record_lobes.h"

#include <algorithm>
#include <map>

namespace eclat {

namespace {

RecordLobe lobe_of(const Bsdf& bsdf, const RadianceTables& tables, std::span<const Vec3> directions) {
    const size_t channel = size_t(coefficient_count(tables.order()));
    RecordLobe lobe{std::vector<float>(directions.size() * 3 * channel), {}, {}};
    ReflectedFactors found;
    for (size_t i = 0; i < directions.size(); ++i) {
        tables.reflect(bsdf, directions[i], found);
        lobe.widths.push_back(found.order > 0 ? found.width : 0);
        lobe.albedos.push_back(found.order > 0 ? found.albedo : Color());
        if (found.order == 0) continue;
        for (size_t c = 0; c < 3; ++c)
            std::copy_n(found.factors[found.grey ? 0 : c].begin(), coefficient_count(found.order),
                        lobe.factors.begin() + ptrdiff_t((i * 3 + c) * channel));
    }
    return lobe;
}

}  // namespace

RecordLobes record_lobes(const World& world, const RadianceCache& cache, const RadianceTables& tables,
                         std::span<const Vec3> directions) {
    RecordLobes out;
    std::map<std::pair<const Material*, bool>, int> known;  // by material and side
    for (const IrradianceRecord& record : cache.records()) {
        const Hit hit = world.geometry.triangle_at(record.position, record.normal);
        if (hit.missed()) {
            out.lobe_of.push_back(-1);
            continue;
        }
        const bool front = dot(world.geometry.geometric_normal(hit.triangle), record.normal) > 0;
        const auto [entry, is_new] = known.try_emplace({&world.geometry.material_of(hit.triangle), front}, -1);
        if (is_new) {
            RecordLobe lobe = lobe_of(world.geometry.surface_point(hit, record.normal).bsdf, tables, directions);
            if (std::ranges::any_of(lobe.widths, [](float width) { return width > 0; })) {
                entry->second = static_cast<int>(out.lobes.size());
                out.lobes.push_back(std::move(lobe));
            }
        }
        out.lobe_of.push_back(entry->second);
    }
    return out;
}

}  // namespace eclat

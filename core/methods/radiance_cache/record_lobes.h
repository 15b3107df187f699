// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The lobes of the surfaces on which radiance records lie, for programs that draw the records: a record's dot products with
// the factors for many directions are a small image of what the surface reflects there.
// Held to      tests/methods/test_view_in_browser.py

#pragma once

#include <span>
#include <vector>

#include "records/solved_caches.h"
#include "tables/radiance_tables.h"
#include "transport/world.h"

namespace eclat {

/// The lobes of one material towards each of the given directions, in the frame around the normal.
struct RecordLobe {
    std::vector<float> factors;  // direction after direction, three channels each, order² numbers
    std::vector<float> widths;   // of each direction; 0 where nothing may be cached
    std::vector<Color> albedos;  // of each direction
};

struct RecordLobes {
    std::vector<int> lobe_of;  // index of each record's lobe, or −1 if its surface reflects nothing that may be cached
    std::vector<RecordLobe> lobes;
};

/// Finds the lobes at the records of radiance. All records on a material take the lobe that the first of them finds, so that
/// textures of gloss are not followed, and anisotropic lobes take the record's frame instead of the tangent's.
RecordLobes record_lobes(const World& world, const RadianceCache& cache, const RadianceTables& tables,
                         std::span<const Vec3> directions);

}  // namespace eclat

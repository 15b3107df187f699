// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Which sides need patches by their area, and which exchange too little light for that.

#include "methods/radiosity/patch_importance.h"

#include <doctest/doctest.h>

#include "room.h"

using namespace eclat;

namespace {

/// A room of 4 × 3 × 5 m; with `ground`, half a metre above a ground of a square kilometre.
Room room(bool ground) {
    const Vec3 x{4, 0, 0}, y{0, 3, 0}, z{0, 0, 5};
    std::vector<Wall> quads{{{}, x, y, 0.7f, 0}, {z, x, y, 0.7f, 0},  {{}, x, z, 0.7f, 0},
                            {y, x, z, 0.7f, 0},  {{}, y, z, 0.7f, 0}, {x, y, z, 0.7f, 0}};
    if (ground) quads.push_back({{-500, -500, -0.5f}, {1000, 0, 0}, {0, 1000, 0}, 0.2f, 0});
    return build_room(quads);
}

}  // namespace

TEST_CASE("patches of a room are of one size, though nobody sees its walls from outside") {
    CHECK(patch_scales(*room(false).geometry, 1).empty());
}

TEST_CASE("a ground that hardly exchanges light with a room has much longer patches") {
    const Room wide = room(true);
    const auto scales = patch_scales(*wide.geometry, 1);
    REQUIRE(scales.size() == 28);
    for (size_t triangle = 0; triangle < 12; ++triangle) {
        // One of its sides is within the room.
        CHECK(std::min(scales[2 * triangle], scales[2 * triangle + 1]) == 1);
    }
    for (size_t side = 24; side < 28; ++side) CHECK(scales[side] > 50);
}

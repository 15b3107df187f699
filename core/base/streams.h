// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The streams of random numbers: each use has its own identifier, which is part of the key, so that no two uses share numbers.

#pragma once

#include <cstdint>

namespace eclat {

/// A change of a number changes the bits of all that draws from it.
enum class Stream : uint32_t {
    far_records = 2,       // candidates and gathers of the far cache
    near_records = 3,      // gathers of irradiance records
    camera_chains = 4,     // mirrors between the camera and diffuse candidates
    glossy_chains = 5,     // … and glossy ones
    radiance_records = 6,  // gathers of radiance records
    point_gathers = 21,    // at points that a user named and no record serves
    surface_points = 33,   // places all over a scene
    probe_cameras = 41,    // camera rays of error probes
    probe_chains = 42,     // the paths that these rays begin
    probe_gathers = 43,    // what is true at a vertex of such a path
    probe_shown = 44,      // what is shown at a probe
    probe_guesses = 45,    // cheap probes, which choose where to look closer
    estimate_layout = 46,  // where probes lie in their cells
    estimate_draws = 47,   // which of them are looked at closely
    photons = 51,          // paths of photons
    emission_guides = 52,  // paths from which a guide of emission learns
    patch_surfaces = 61,   // what a radiosity patch reflects and emits: points on it
    patch_lights = 62,     // its direct light
    patch_closure = 63,    // what it sees
    patch_insides = 64,    // … and whether it lies inside of a solid
    link_decisions = 65,   // whether a link is hidden in part
    point_arrivals = 71,   // light that is met from points that a user named
    photon_places = 72,    // from where places are seen at which photons' irradiance is taken
    focused_light = 73,    // photons that tell how much light comes by mirrors
};

/// Does not compile where two streams share a number.
constexpr bool is_stream(Stream stream) {
    switch (stream) {
        case Stream::far_records:
        case Stream::near_records:
        case Stream::camera_chains:
        case Stream::glossy_chains:
        case Stream::radiance_records:
        case Stream::point_gathers:
        case Stream::surface_points:
        case Stream::probe_cameras:
        case Stream::probe_chains:
        case Stream::probe_gathers:
        case Stream::probe_shown:
        case Stream::probe_guesses:
        case Stream::estimate_layout:
        case Stream::estimate_draws:
        case Stream::photons:
        case Stream::emission_guides:
        case Stream::patch_surfaces:
        case Stream::patch_lights:
        case Stream::patch_closure:
        case Stream::patch_insides:
        case Stream::link_decisions:
        case Stream::point_arrivals:
        case Stream::photon_places:
        case Stream::focused_light: return true;
    }
    return false;
}

}  // namespace eclat

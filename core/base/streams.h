// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The streams of random numbers: each use has its own identifier, which is part of the key, so that no two uses share numbers.

#pragma once

#include <cstdint>

namespace eclat {

/// If the number of a stream changes, all results that use its random numbers have other bits.
enum class Stream : uint32_t {
    far_records = 2,        // candidates and gathers of the far cache
    near_records = 3,       // gathers of irradiance records
    camera_chains = 4,      // mirrors between the camera and diffuse candidates
    glossy_chains = 5,      // mirrors between the camera and glossy candidates
    radiance_records = 6,   // gathers of radiance records
    point_gathers = 21,     // gathers at points given by the user that no record serves
    surface_points = 33,    // points on all surfaces
    probe_cameras = 41,     // camera rays of error probes
    probe_chains = 42,      // paths that continue these rays
    probe_gathers = 43,     // reference gathers at vertices of such paths
    probe_shown = 44,       // light that is shown at a probe
    probe_guesses = 45,     // cheap probes, which choose the places of accurate ones
    estimate_layout = 46,   // positions of probes in their cells
    estimate_draws = 47,    // choice of the accurate probes
    photons = 51,           // paths of photons
    emission_guides = 52,   // paths from which an emission guide learns
    patch_surfaces = 61,    // points at which the material of a radiosity patch is evaluated
    patch_lights = 62,      // direct light of a patch
    patch_closure = 63,     // rays that find the surfaces that a patch sees
    patch_insides = 64,     // rays that find whether a patch lies inside a solid
    link_decisions = 65,    // rays that find whether a link is partly occluded
    patch_importance = 66,  // walkers that find which sides exchange light
    patch_panes = 67,       // whether rays from patches pass through panes
    point_arrivals = 71,    // light that rays from points given by the user find
    photon_places = 72,     // view directions at the points of precomputed irradiance
    focused_light = 73,     // photons that measure the light from mirrors
    path_guides = 74,       // paths from which guides of final gathers learn
    space_probes = 81,      // rays from probes in space
    space_lights = 82,      // light samples of these probes
};

/// This does not compile if two streams have the same number.
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
        case Stream::patch_importance:
        case Stream::patch_panes:
        case Stream::point_arrivals:
        case Stream::photon_places:
        case Stream::focused_light:
        case Stream::path_guides:
        case Stream::space_probes:
        case Stream::space_lights: return true;
    }
    return false;
}

}  // namespace eclat

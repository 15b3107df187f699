// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Small scenes of rectangles, diffuse unless a material is given, built from arrays.

#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "transport/lit_scene.h"

namespace eclat {

using Room = LitScene;

struct Wall {
    Vec3 corner, edge1, edge2;  // edge1 × edge2 points inwards
    float albedo, emission;
};

inline Value constant(float x) {
    Value v;
    v.constant = Color(x);
    return v;
}

inline Material diffuse(float albedo, float emission) {
    Material m;
    m.parameters = {constant(albedo)};
    m.emits = emission > 0;
    m.emission.constant = Color(emission);
    return m;
}

/// Plastic with an index of 1.5.
inline Material varnish(float albedo, float alpha) {
    Material m;
    m.kind = MaterialKind::plastic;
    m.parameters = {constant(albedo), constant(1), constant(1.5f), constant(alpha)};
    m.prepare({});
    return m;
}

/// A material for each wall, in place of its own.
inline Room build_room(const std::vector<Wall>& walls, std::vector<Material> materials) {
    std::vector<MeshArrays> meshes;
    for (const Wall& wall : walls) {
        MeshArrays mesh;
        mesh.positions = {wall.corner, wall.corner + wall.edge1, wall.corner + wall.edge1 + wall.edge2,
                          wall.corner + wall.edge2};
        mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
        mesh.material = static_cast<int>(meshes.size());
        meshes.push_back(mesh);
    }
    return light_scene(
        std::make_unique<Geometry>(std::move(meshes), std::move(materials), std::vector<std::unique_ptr<Texture>>{}));
}

inline std::vector<Material> own_materials(const std::vector<Wall>& walls, bool two_sided = true) {
    std::vector<Material> out;
    for (const Wall& wall : walls) {
        out.push_back(diffuse(wall.albedo, wall.emission));
        out.back().two_sided = two_sided;
    }
    return out;
}

inline Room build_room(const std::vector<Wall>& walls, bool two_sided = true) {
    return build_room(walls, own_materials(walls, two_sided));
}

/// 2 × 2 × 2 around the origin, seen from inside.
inline std::vector<Wall> closed_walls(const std::array<float, 6>& albedo, const std::array<float, 6>& emission) {
    return {{{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, albedo[0], emission[0]},  // floor
            {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, albedo[1], emission[1]},   // ceiling
            {{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, albedo[2], emission[2]},  // left
            {{1, -1, -1}, {0, 0, 2}, {0, 2, 0}, albedo[3], emission[3]},   // right
            {{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, albedo[4], emission[4]},  // back
            {{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, albedo[5], emission[5]}};  // front
}

inline Room closed_room(const std::array<float, 6>& albedo, const std::array<float, 6>& emission) {
    return build_room(closed_walls(albedo, emission));
}

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/lit_scene.h"

#include <utility>

#include "transport/busy_places.h"

namespace eclat {

namespace {

EmitterTriangle emitter(const Geometry& g, uint32_t triangle) {
    const Material& m = g.material_of(triangle);
    const int set = m.emission.uv_set;
    EmitterTriangle e;
    e.p0 = g.vertex(triangle, 0);
    e.p1 = g.vertex(triangle, 1);
    e.p2 = g.vertex(triangle, 2);
    e.uv0 = g.uv(triangle, 0, set);
    e.uv1 = g.uv(triangle, 1, set);
    e.uv2 = g.uv(triangle, 2, set);
    e.emission = m.emission;
    e.two_sided = m.emission_two_sided;
    e.triangle_id = triangle;
    return e;
}

}  // namespace

LitScene light_scene(std::unique_ptr<Geometry> geometry, LightInputs lights) {
    LitScene scene;
    scene.geometry = std::move(geometry);
    const Geometry& g = *scene.geometry;
    for (uint32_t t = 0; t < g.triangle_count(); ++t) {
        if (!g.material_of(t).emits) continue;
        if (scene.emitter_of_triangle.empty()) scene.emitter_of_triangle.assign(g.triangle_count(), not_emitting);
        scene.emitter_of_triangle[t] = static_cast<uint32_t>(scene.emitters.size());
        scene.emitters.push_back(emitter(g, t));
    }
    lights.triangles = scene.emitters;
    lights.scene_center = (g.low() + g.high()) * 0.5f;
    lights.scene_radius = g.radius();
    if (lights.environment || !lights.directionals.empty()) lights.places = busy_places(g);
    scene.lights = Lights(std::move(lights));
    return scene;
}

}  // namespace eclat

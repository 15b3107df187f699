// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "scene/scene.h"

#include <algorithm>

#include "base/error.h"
#include "base/precision.h"

namespace eclat {

namespace {

float magnitude(Vec3 v) { return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z))); }

template <class T>
T interpolate(const std::vector<T>& values, const uint32_t* v, float b, float c) {
    return (1 - b - c) * values[v[0]] + b * values[v[1]] + c * values[v[2]];
}

/// Returns the unit normal of a triangle, or any unit vector if the triangle has no area.
Vec3 normal_of(Vec3 p0, Vec3 p1, Vec3 p2) {
    const Vec3 n = cross(p1 - p0, p2 - p0);
    const float l2 = length_squared(n);
    return l2 > 0 ? n / std::sqrt(l2) : Vec3{0, 0, 1};
}

/// Returns the normal for `texel` of a normal map, where `up` is the direction of the green channel.
Vec3 from_tangent_space(Color texel, float scale, const Frame& frame, Vec3 up) {
    const float x = (2 * texel.r - 1) * scale, y = (2 * texel.g - 1) * scale;
    const Vec3 n = frame.u * x + up * y + frame.n * (2 * texel.b - 1);
    const float l2 = length_squared(n);
    return l2 > 0 ? n / std::sqrt(l2) : frame.n;
}

void check(const MeshArrays& m, size_t index, size_t materials) {
    const std::string where = "mesh " + std::to_string(index) + ": ";
    const size_t n = m.positions.size();
    for (size_t size : {m.normals.size(), m.uvs.size(), m.uvs2.size(), m.colors.size() / 4, m.tangents.size() / 4})
        require(size == 0 || size == n, where + "per-vertex arrays must be as long as positions (" + std::to_string(n) +
                                            "), got " + std::to_string(size));
    for (size_t i = 0; i < n; ++i)
        require(is_finite(m.positions[i]), where + "position " + std::to_string(i) + " is not finite");
    for (size_t i = 0; i < m.triangles.size(); ++i)
        for (uint32_t v : m.triangles[i].v)
            require(v < n, where + "triangle " + std::to_string(i) + " uses vertex " + std::to_string(v) + " of " +
                               std::to_string(n));
    require(m.material >= 0 && static_cast<size_t>(m.material) < materials,
            where + "expected the index of one of " + std::to_string(materials) + " materials, got " +
                std::to_string(m.material));
}

}  // namespace

Geometry::Geometry(std::vector<MeshArrays> meshes, std::vector<Material> materials,
                   std::vector<std::unique_ptr<Texture>> textures)
    : arrays_(std::move(meshes)), materials_(std::move(materials)), textures_(std::move(textures)) {
    for (Material& m : materials_) m.prepare(materials_);
    low_ = Vec3{infinity, infinity, infinity};
    high_ = -low_;
    std::vector<Intersector::Triangle> triangles;
    std::vector<Sieve> sieves;
    for (size_t i = 0; i < arrays_.size(); ++i) {
        MeshArrays& m = arrays_[i];
        check(m, i, materials_.size());
        const auto first = static_cast<uint32_t>(vertices_.size());
        mesh_.push_back({m.material, first, &m});
        vertices_.insert(vertices_.end(), m.positions.begin(), m.positions.end());
        const Material& material = materials_[m.material];
        const Sieve sieve{!material.opacity.is_constant() || material.opacity.constant.r < 1 ||
                              (material.vertex_colors && !m.colors.empty()),
                          material.culls_back(), material.pane, material.hidden_from_camera};
        for (const auto& t : m.triangles) {
            triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
            faces_.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}, static_cast<uint32_t>(i)});
            sieves.push_back(sieve);
            for (int k = 0; k < 3; ++k) {
                low_ = min(low_, m.positions[t.v[k]]);
                high_ = max(high_, m.positions[t.v[k]]);
                largest_coordinate_ = std::max(largest_coordinate_, magnitude(m.positions[t.v[k]]));
            }
        }
        m.positions = {};
    }
    if (faces_.empty()) low_ = high_ = {};
    vertices_.reserve(vertices_.size() + 1);  // wide loads read past the last
    intersector_ = std::make_unique<Intersector>(
        vertices_, triangles, sieves,
        [this](uint32_t t, float u, float v) { return opacity_at(material_of(t), coordinates(t, u, v)); },
        [this](uint32_t t, float u, float v, Vec3 direction) { return straight({t, 0, u, v}, direction); });
}

Color Geometry::straight(const Hit& hit, Vec3 direction) const {
    const SurfacePoint point = surface_point(hit, -direction);
    return point.bsdf.straight(point.frame.to_local(-direction));
}

void Geometry::meet_with_backs(std::span<const Ray> rays, std::span<Hit> hits, Coherence coherence) const {
    intersector_->intersect(rays, hits, coherence);
    if (!intersector_->culls_backs()) return;
    std::vector<Hit> with_backs(rays.size());
    intersector_->intersect(rays, with_backs, coherence, Backs::met);
    for (size_t i = 0; i < rays.size(); ++i)
        if (with_backs[i].t < hits[i].t * shadow_shortening) hits[i] = with_backs[i];
}

Vec2 Geometry::uv(uint32_t triangle, int corner, int set) const {
    const Mesh& mesh = mesh_[faces_[triangle].mesh];
    const auto& uvs = set == 0 ? mesh.arrays->uvs : mesh.arrays->uvs2;
    return uvs.empty() ? Vec2{} : uvs[faces_[triangle].v[corner] - mesh.first_vertex];
}

Vec3 Geometry::geometric_normal(uint32_t triangle) const {
    return normal_of(vertex(triangle, 0), vertex(triangle, 1), vertex(triangle, 2));
}

SurfaceCoordinates Geometry::coordinates(uint32_t triangle, float u, float v) const {
    const Mesh& mesh = mesh_[faces_[triangle].mesh];
    const MeshArrays& a = *mesh.arrays;
    const auto& t = faces_[triangle].v;
    const uint32_t local[3] = {t[0] - mesh.first_vertex, t[1] - mesh.first_vertex, t[2] - mesh.first_vertex};
    SurfaceCoordinates at;
    if (!a.uvs.empty()) at.uv = interpolate(a.uvs, local, u, v);
    if (!a.uvs2.empty()) at.uv2 = interpolate(a.uvs2, local, u, v);
    if (!a.colors.empty()) {
        float c[4];
        for (int i = 0; i < 4; ++i)
            c[i] = (1 - u - v) * a.colors[4 * local[0] + i] + u * a.colors[4 * local[1] + i] +
                   v * a.colors[4 * local[2] + i];
        at.vertex_color = {c[0], c[1], c[2]};
        at.vertex_alpha = c[3];
    }
    return at;
}

Vec3 Geometry::shading_normal(uint32_t triangle, float u, float v, Vec3 geometric) const {
    const Mesh& mesh = mesh_[faces_[triangle].mesh];
    const auto& normals = mesh.arrays->normals;
    if (normals.empty()) return geometric;
    const auto& t = faces_[triangle].v;
    const uint32_t local[3] = {t[0] - mesh.first_vertex, t[1] - mesh.first_vertex, t[2] - mesh.first_vertex};
    const Vec3 n = interpolate(normals, local, u, v);
    const float l2 = length_squared(n);
    return l2 > 0 ? n / std::sqrt(l2) : geometric;
}

Vec3 Geometry::mapped_normal(const Material& material, const Hit& hit, const SurfaceCoordinates& at, Vec3 normal,
                             bool turned) const {
    const Value& map = material.normal_map;
    const uint32_t triangle = hit.triangle;
    const Mesh& mesh = mesh_[faces_[triangle].mesh];
    if (!material.bump && !mesh.arrays->tangents.empty()) {
        float t[4] = {};
        const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 4; ++i)
                t[i] += weights[k] * mesh.arrays->tangents[4 * (faces_[triangle].v[k] - mesh.first_vertex) + i];
        const Frame frame = Frame::along(normal, {t[0], t[1], t[2]});
        const bool right_handed = (t[3] > 0) != turned;
        return from_tangent_space(map.color(at.uv, at.uv2), material.normal_scale, frame,
                                  right_handed ? frame.v : -frame.v);
    }
    // Position as a function of the map's texture coordinates: e = a · du + b · dv for both edges.
    const Vec2 t0 = map.transform(uv(triangle, 0, map.uv_set)), t1 = map.transform(uv(triangle, 1, map.uv_set)) - t0,
               t2 = map.transform(uv(triangle, 2, map.uv_set)) - t0;
    const Vec3 e1 = vertex(triangle, 1) - vertex(triangle, 0), e2 = vertex(triangle, 2) - vertex(triangle, 0);
    const float determinant = t1.x * t2.y - t1.y * t2.x;
    if (determinant == 0) return normal;
    const Vec3 dpdu = (e1 * t2.y - e2 * t1.y) / determinant, dpdv = (e2 * t1.x - e1 * t2.x) / determinant;
    if (!material.bump) {
        const Frame frame = Frame::along(normal, dpdu);
        // Green grows upwards in the image, which is against our v.
        const Vec3 up = dot(frame.v, dpdv) > 0 ? -frame.v : frame.v;
        return from_tangent_space(map.color(at.uv, at.uv2), material.normal_scale, frame, up);
    }
    // Gradient of the height by central differences of one texel [Blinn78].
    const float du = 1 / static_cast<float>(map.texture->width()), dv = 1 / static_cast<float>(map.texture->height());
    const Vec2 p = map.transform(map.uv_set == 0 ? at.uv : at.uv2);
    const auto height = [&](float x, float y) { return map.scalar_at({x, y}) * material.normal_scale; };
    const float hu = (height(p.x + du, p.y) - height(p.x - du, p.y)) / (2 * du);
    const float hv = (height(p.x, p.y + dv) - height(p.x, p.y - dv)) / (2 * dv);
    const Vec3 ng = cross(dpdu, dpdv);
    const float area = length_squared(ng);
    if (!(area > 0)) return normal;
    // Surface gradient: dual vectors of the tangents, weighted by the height's derivatives.
    const Vec3 gradient = (cross(dpdv, ng) * hu + cross(ng, dpdu) * hv) / area;
    return normalize(normal - gradient + normal * dot(gradient, normal));
}

float Geometry::ray_offset(uint32_t triangle) const {
    float largest = 0;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, magnitude(vertex(triangle, k)));
    return coordinate_resolution * largest;
}

float Geometry::ray_offset(Vec3 position, Vec3 normal) const {
    const Hit hit = triangle_at(position, normal);
    return std::max(coordinate_resolution * magnitude(position), hit.missed() ? 0 : ray_offset(hit.triangle));
}

Hit Geometry::triangle_at(Vec3 position, Vec3 normal) const {
    // Rounding displaces a point by its triangle's coordinates, which are larger than its own only in large triangles,
    // so the search widens from its own coordinates to the scene's.
    constexpr float wider = 4, least = 0x1p-20f;
    const float most = coordinate_resolution * largest_coordinate_;
    Hit hit;
    for (float reach = std::max(coordinate_resolution * magnitude(position), least * most);; reach *= wider) {
        const Ray across{position + normal * reach, 0, -normal, 2 * reach};
        rays().intersect({&across, 1}, {&hit, 1});
        if (!hit.missed() || !(reach < most)) return hit;
    }
}

SurfacePoint Geometry::surface_point(const Hit& hit, Vec3 wo) const {
    const uint32_t triangle = hit.triangle;
    const Vec3 p0 = vertex(triangle, 0), p1 = vertex(triangle, 1), p2 = vertex(triangle, 2);
    const Mesh& mesh = mesh_[faces_[triangle].mesh];
    const Material& material = materials_[mesh.material];
    const SurfaceCoordinates at = coordinates(triangle, hit.u, hit.v);
    Vec3 normal = normal_of(p0, p1, p2);
    Vec3 n = shading_normal(triangle, hit.u, hit.v, normal);
    const bool turned = dot(n, normal) < 0;
    if (turned) n = -n;
    if (material.has_normal_map) n = mapped_normal(material, hit, at, n, turned);
    const bool from_behind = dot(wo, normal) < 0;
    if (from_behind && !material.refracts) {
        normal = -normal;
        n = -n;
    }
    // A shading normal that faces away from a viewer in front of the surface is bent towards the viewer.
    const float facing = dot(n, wo), side = dot(normal, wo);
    if (facing * side <= 0) n = normalize(n + wo * ((side > 0 ? 1.0f : -1.0f) * 1e-3f - facing));
    Frame frame = Frame::around(n);
    if (material.anisotropic() && !mesh.arrays->uvs.empty()) {
        const Vec2 a = uv(triangle, 0, 0), b = uv(triangle, 1, 0) - a, c = uv(triangle, 2, 0) - a;
        const float determinant = b.x * c.y - b.y * c.x;
        if (determinant != 0) frame = Frame::along(n, ((p1 - p0) * c.y - (p2 - p0) * b.y) / determinant);
    }
    // Lobes are large, so they are constructed in place.
    return {.position = p0 * (1 - hit.u - hit.v) + p1 * hit.u + p2 * hit.v,
            .normal = normal,
            .frame = frame,
            .uv = material.emission.uv_set == 0 ? at.uv : at.uv2,
            .offset = ray_offset(triangle),
            .triangle = triangle,
            .bsdf = make_bsdf(materials_, mesh.material, at, from_behind)};
}

}  // namespace eclat

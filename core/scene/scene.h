// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A scene made from arrays, which is validated once, so that all other code can rely on it.

#pragma once

#include <memory>
#include <vector>

#include "scene/intersect.h"
#include "scene/material.h"
#include "scene/surface_point.h"
#include "scene/texture.h"

namespace eclat {

/// Per-vertex arrays are empty or as long as `positions`.
struct MeshArrays {
    std::vector<Vec3> positions, normals;
    std::vector<Vec2> uvs, uvs2;
    std::vector<float> colors;    // RGBA
    std::vector<float> tangents;  // xyz, w = ±1; normal maps lie along them, with the bitangent w · normal × tangent
    std::vector<Intersector::Triangle> triangles;
    int material = 0;
};

class Geometry {
  public:
    /// Throws std::invalid_argument for non-finite positions, indices out of range or sizes that disagree.
    Geometry(std::vector<MeshArrays> meshes, std::vector<Material> materials,
             std::vector<std::unique_ptr<Texture>> textures);

    const Intersector& rays() const { return *intersector_; }
    const std::vector<Material>& materials() const { return materials_; }
    size_t triangle_count() const { return faces_.size(); }
    Vec3 low() const { return low_; }
    Vec3 high() const { return high_; }
    /// Returns half the diagonal of the bounds, for computations that must cover the whole scene, such as emitting
    /// photons from a sun. A stray part makes it very large, so methods must not derive lengths from it.
    float radius() const { return 0.5f * length(high_ - low_); }
    /// Returns the distance from a triangle at which rays that leave it start, which exceeds the rounding error of hits.
    /// It depends on the coordinates of this triangle alone, so that wide or distant parts cannot change it elsewhere.
    float ray_offset(uint32_t triangle) const;
    /// Returns the distance from a point at which rays that leave it start: that of the triangle on which it lies, if
    /// there is one across `normal`.
    float ray_offset(Vec3 position, Vec3 normal) const;
    /// Finds the triangle on which a point lies, as far as rounding allows to say so.
    Hit triangle_at(Vec3 position, Vec3 normal) const;

    const Material& material_of(uint32_t triangle) const { return materials_[mesh_[faces_[triangle].mesh].material]; }
    /// Returns whether a triangle is black or invisible from behind.
    bool has_no_back(uint32_t triangle) const {
        const Material& m = material_of(triangle);
        return m.has_no_back();
    }
    /// Closest hits of rays, culled backs included; a front that lies on such a back comes first.
    void meet_with_backs(std::span<const Ray> rays, std::span<Hit> hits, Coherence coherence = Coherence::none) const;
    Vec3 vertex(uint32_t triangle, int corner) const { return vertices_[faces_[triangle].v[corner]]; }
    Vec2 uv(uint32_t triangle, int corner, int set) const;
    /// Unit normal by counter-clockwise order.
    Vec3 geometric_normal(uint32_t triangle) const;

    /// These prefetch the data that `surface_point` will read: first the face, and a few hits later its vertices.
    void prefetch_face(uint32_t triangle) const { __builtin_prefetch(&faces_[triangle]); }
    void prefetch_vertices(uint32_t triangle) const {
        for (const uint32_t v : faces_[triangle].v) __builtin_prefetch(&vertices_[v]);
    }

    /// The point of `hit`, seen from direction `wo` (away from the surface).
    SurfacePoint surface_point(const Hit& hit, Vec3 wo) const;
    SurfaceCoordinates coordinates(uint32_t triangle, float u, float v) const;
    /// Returns the share of light along `direction` that passes straight through a pane at `hit`.
    Color straight(const Hit& hit, Vec3 direction) const;

  private:
    struct Mesh {
        int material;
        uint32_t first_vertex;
        const MeshArrays* arrays;
    };
    struct Face {
        uint32_t v[3], mesh;
    };
    Vec3 shading_normal(uint32_t triangle, float u, float v, Vec3 geometric) const;
    /// `turned`: `normal` is against the mesh's own.
    Vec3 mapped_normal(const Material& material, const Hit& hit, const SurfaceCoordinates& at, Vec3 normal,
                       bool turned) const;

    std::vector<MeshArrays> arrays_;
    std::vector<Mesh> mesh_;
    std::vector<Vec3> vertices_;
    std::vector<Face> faces_;
    std::vector<Material> materials_;
    std::vector<std::unique_ptr<Texture>> textures_;
    std::unique_ptr<Intersector> intersector_;
    Vec3 low_, high_;
    float largest_coordinate_ = 0;
};

}  // namespace eclat

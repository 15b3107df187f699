// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <string>

#include "arrays.h"
#include "base/error.h"
#include "base/parallel.h"
#include "lights/environment_split.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

/// Collects the parts of a scene that Python passes, and then makes the scene.
struct SceneBuilder {
    SceneBuilder() = default;
    SceneBuilder(const SceneBuilder&) = delete;

    std::vector<MeshArrays> meshes;
    std::vector<Material> materials;
    std::vector<std::unique_ptr<Texture>> textures;
    LightInputs lights;

    int add_texture_bytes(Bytes3 image, bool srgb, Wrap wrap_u, Wrap wrap_v, bool nearest) {
        return add_texture({static_cast<uint32_t>(image.shape(1)), static_cast<uint32_t>(image.shape(0)),
                            static_cast<uint32_t>(image.shape(2)), image.data(), nullptr},
                           srgb, wrap_u, wrap_v, nearest);
    }
    int add_texture_floats(Floats3 image, bool srgb, Wrap wrap_u, Wrap wrap_v, bool nearest) {
        return add_texture({static_cast<uint32_t>(image.shape(1)), static_cast<uint32_t>(image.shape(0)),
                            static_cast<uint32_t>(image.shape(2)), nullptr, image.data()},
                           srgb, wrap_u, wrap_v, nearest);
    }
    int add_texture(const ImageView& view, bool srgb, Wrap wrap_u, Wrap wrap_v, bool nearest) {
        textures.push_back(std::make_unique<Texture>(view, TextureOptions{srgb, wrap_u, wrap_v, nearest}));
        return static_cast<int>(textures.size()) - 1;
    }
    Value value(std::array<float, 3> constant, int texture, int channel, int uv_set, std::array<float, 6> uv_transform,
                bool invert, bool square) const {
        Value v;
        v.constant = {constant[0], constant[1], constant[2]};
        v.texture = texture < 0 ? nullptr : textures.at(texture).get();
        v.channel = channel;
        v.uv_set = static_cast<uint8_t>(uv_set);
        v.uv_transform = uv_transform;
        v.invert = invert;
        v.square = square;
        return v;
    }
    int add_material(const Material& material) {
        materials.push_back(material);
        return static_cast<int>(materials.size()) - 1;
    }
    void add_mesh(Points positions, Triangles triangles, int material, Points normals, Uvs uvs, Uvs uvs2, Colors colors,
                  Tangents tangents) {
        MeshArrays mesh;
        mesh.positions = vec3s(positions);
        mesh.normals = vec3s(normals);
        mesh.uvs = vec2s(uvs);
        mesh.uvs2 = vec2s(uvs2);
        mesh.colors.assign(colors.data(), colors.data() + colors.size());
        mesh.tangents.assign(tangents.data(), tangents.data() + tangents.size());
        for (size_t i = 0; i < triangles.shape(0); ++i)
            mesh.triangles.push_back({{triangles(i, 0), triangles(i, 1), triangles(i, 2)}});
        mesh.material = material;
        meshes.push_back(std::move(mesh));
    }
    void add_point(std::array<float, 3> p, std::array<float, 3> i) { lights.points.push_back({vec3(p), color(i)}); }
    void add_spot(std::array<float, 3> p, std::array<float, 3> d, std::array<float, 3> i, float inner, float outer,
                  bool smooth) {
        lights.spots.emplace_back(vec3(p), vec3(d), color(i), inner, outer,
                                  smooth ? SpotLight::Falloff::smooth : SpotLight::Falloff::linear);
    }
    /// `axes` are rows; `values` has a row for each polar angle.
    void add_profile(std::array<float, 3> p, std::array<std::array<float, 3>, 3> axes, std::array<float, 3> i,
                     std::vector<float> polar, std::vector<float> azimuth, Floats2 values) {
        lights.profiles.emplace_back(
            vec3(p), std::array<Vec3, 3>{vec3(axes[0]), vec3(axes[1]), vec3(axes[2])}, color(i),
            IntensityTable{std::move(polar), std::move(azimuth), {values.data(), values.data() + values.size()}});
    }
    void add_directional(std::array<float, 3> d, std::array<float, 3> e, float angular_radius) {
        lights.directionals.emplace_back(vec3(d), color(e), angular_radius);
    }
    void set_environment(Floats3 image, std::array<float, 9> to_world) {
        lights.environment.emplace(std::span<const float>(image.data(), image.size()),
                                   static_cast<uint32_t>(image.shape(1)), static_cast<uint32_t>(image.shape(0)),
                                   to_world);
    }

    std::unique_ptr<CoreScene> build() {
        auto geometry = std::make_unique<Geometry>(std::move(meshes), std::move(materials), std::move(textures));
        return std::make_unique<CoreScene>(light_scene(std::move(geometry), std::move(lights)));
    }
};

/// Sets a parameter. The kind must be known; an unknown name raises an exception.
void set_parameter(Material& material, const std::string& name, const Value& value) {
    const auto names = parameter_names(material.kind);
    const auto found = std::find(names.begin(), names.end(), name);
    require(found != names.end(), "material: expected the name of a parameter of its kind, got " + name);
    material.parameters.resize(names.size());
    material.parameters[static_cast<size_t>(found - names.begin())] = value;
}

std::vector<std::string> names_of(MaterialKind kind) {
    const auto names = parameter_names(kind);
    return {names.begin(), names.end()};
}

size_t escapes(const CoreScene& scene, Points origins, Points directions) {
    std::vector<Ray> rays;
    const auto o = vec3s(origins), d = vec3s(directions);
    for (size_t i = 0; i < o.size(); ++i) rays.push_back({o[i], 0, d[i], infinity});
    std::vector<uint8_t> hit(rays.size());
    scene.geometry->rays().occluded(rays, hit);
    return static_cast<size_t>(std::count(hit.begin(), hit.end(), uint8_t(0)));
}

auto first_hits(const CoreScene& scene, Points origins, Points directions, int threads, bool from_camera) {
    const auto o = vec3s(origins), d = vec3s(directions);
    if (o.size() != d.size()) throw std::invalid_argument("expected as many directions as origins");
    auto* triangles = new int32_t[o.size()];
    nb::capsule owner(triangles, [](void* p) noexcept { delete[] static_cast<int32_t*>(p); });
    {
        nb::gil_scoped_release unlocked;
        parallel_blocks(o.size(), 1024, threads, [&](size_t begin, size_t end) {
            std::vector<Ray> rays;
            for (size_t i = begin; i < end; ++i) rays.push_back({o[i], 0, d[i], infinity});
            std::vector<Hit> hits(rays.size());
            scene.geometry->meet_with_backs(rays, hits, from_camera ? Coherence::camera : Coherence::none);
            for (size_t i = begin; i < end; ++i)
                triangles[i] = static_cast<int32_t>(hits[i - begin].triangle);  // -1 for no_triangle
        });
    }
    return nb::ndarray<nb::numpy, int32_t>(triangles, {o.size()}, owner);
}

void bind_kinds(nb::module_& m) {
    nb::enum_<Wrap>(m, "Wrap").value("repeat", Wrap::repeat).value("mirror", Wrap::mirror).value("clamp", Wrap::clamp);
    nb::enum_<MaterialKind>(m, "MaterialKind")
        .value("diffuse", MaterialKind::diffuse)
        .value("phong", MaterialKind::phong)
        .value("ward", MaterialKind::ward)
        .value("conductor", MaterialKind::conductor)
        .value("dielectric", MaterialKind::dielectric)
        .value("thin_dielectric", MaterialKind::thin_dielectric)
        .value("plastic", MaterialKind::plastic)
        .value("metallic_roughness", MaterialKind::metallic_roughness)
        .value("translucent", MaterialKind::translucent)
        .value("measured", MaterialKind::measured)
        .value("blend", MaterialKind::blend);
    m.def("parameter_names", &names_of, "kind"_a);
}

void bind_material(nb::module_& m) {
    nb::class_<Value>(m, "Value");
    nb::class_<Material>(m, "Material")
        .def(nb::init<>())
        .def_rw("kind", &Material::kind)
        .def("set", &set_parameter, "name"_a, "value"_a)
        .def_rw("two_sided", &Material::two_sided)
        .def_rw("back_culled", &Material::back_culled)
        .def_rw("hidden_from_camera", &Material::hidden_from_camera)
        .def_rw("back", &Material::back)
        .def_prop_rw(
            "children", [](const Material& s) { return std::array<int, 2>{s.children[0], s.children[1]}; },
            [](Material& s, std::array<int, 2> c) { s.children[0] = c[0], s.children[1] = c[1]; })
        .def_prop_rw(
            "table", [](const Material& m) { return std::const_pointer_cast<MeasuredBrdf>(m.table); },
            [](Material& m, std::shared_ptr<MeasuredBrdf> table) { m.table = std::move(table); })
        .def_rw("beckmann", &Material::beckmann)
        .def_rw("correlated", &Material::correlated)
        .def_rw("nonlinear", &Material::nonlinear)
        .def_rw("thin_walled", &Material::thin_walled)
        .def_rw("opacity", &Material::opacity)
        .def_rw("alpha_cutoff", &Material::alpha_cutoff)
        .def_rw("vertex_colors", &Material::vertex_colors)
        .def_rw("has_normal_map", &Material::has_normal_map)
        .def_rw("bump", &Material::bump)
        .def_rw("normal_map", &Material::normal_map)
        .def_rw("normal_scale", &Material::normal_scale)
        .def_rw("emits", &Material::emits)
        .def_rw("emission", &Material::emission)
        .def_rw("emission_two_sided", &Material::emission_two_sided);
}

}  // namespace

void bind_scene(nb::module_& m) {
    bind_kinds(m);
    bind_material(m);
    nb::class_<SceneBuilder>(m, "SceneBuilder")
        .def(nb::init<>())
        .def("add_texture", &SceneBuilder::add_texture_bytes, "image"_a, nb::kw_only(), "srgb"_a, "wrap_u"_a,
             "wrap_v"_a, "nearest"_a)
        .def("add_texture", &SceneBuilder::add_texture_floats, "image"_a, nb::kw_only(), "srgb"_a, "wrap_u"_a,
             "wrap_v"_a, "nearest"_a)
        .def("value", &SceneBuilder::value, "constant"_a, nb::kw_only(), "texture"_a, "channel"_a, "uv_set"_a,
             "uv_transform"_a, "invert"_a, "square"_a)
        .def("add_material", &SceneBuilder::add_material)
        .def("add_mesh", &SceneBuilder::add_mesh, nb::kw_only(), "positions"_a, "triangles"_a, "material"_a,
             "normals"_a, "uvs"_a, "uvs2"_a, "colors"_a, "tangents"_a)
        .def("add_point", &SceneBuilder::add_point)
        .def("add_spot", &SceneBuilder::add_spot, nb::kw_only(), "position"_a, "direction"_a, "intensity"_a,
             "inner_angle"_a, "outer_angle"_a, "smooth"_a)
        .def("add_profile", &SceneBuilder::add_profile, nb::kw_only(), "position"_a, "axes"_a, "intensity"_a, "polar"_a,
             "azimuth"_a, "values"_a)
        .def("add_directional", &SceneBuilder::add_directional)
        .def("set_environment", &SceneBuilder::set_environment)
        .def("build", &SceneBuilder::build);
    nb::class_<CoreScene>(m, "Scene")
        .def_prop_ro("triangle_count", [](const CoreScene& s) { return s.geometry->triangle_count(); })
        .def_prop_ro("radius", [](const CoreScene& s) { return s.geometry->radius(); })
        .def("escapes", &escapes, "origins"_a, "directions"_a, "Number of rays that meet nothing.")
        .def(
            "first_hits", &first_hits, "origins"_a, "directions"_a, "threads"_a, "from_camera"_a = false,
            "The triangle that each ray meets first, culled backs included, counted over all meshes, and -1 for none.");
    m.def(
        "smooth_limit",
        [](const Floats3& image) {
            require(image.shape(2) == 3, "image: expected three channels");
            return smooth_limit({image.data(), image.size()}, uint32_t(image.shape(1)), uint32_t(image.shape(0)));
        },
        "image"_a, "The luminance at which the smooth part of an environment is cut; infinite if nothing is sharp.");
}

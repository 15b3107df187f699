// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The only file that uses Embree. The versions 3.13 (Debian 12) and 4.x differ in how the options of a query are passed.

#include "scene/intersect.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "base/error.h"
#include "sampling/rng.h"
#include "scene/ray_tracer.h"

namespace eclat {

struct Intersector::Impl {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    OpacityFunction opacity;
    PaneFunction pane;
    // There is one geometry for each combination of the tests that its triangles need (none, opacity, side, or both),
    // each with and without panes, and each seen by cameras or hidden from them.
    static constexpr unsigned kinds = 16;
    std::vector<uint32_t> to_triangle[kinds];
    std::vector<Triangle> indices[kinds];

    static unsigned kind_of(Sieve sieve) {
        return (sieve.translucent ? 1u : 0u) + (sieve.back_culled ? 2u : 0u) + (sieve.pane ? 4u : 0u) +
               (sieve.hidden_from_camera ? 8u : 0u);
    }

    ~Impl() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

namespace {

/// The bits of the flags that rays of a packet carry to the filters.
constexpr unsigned meets_backs = 1, comes_from_camera = 2;

void reject_backs(const RTCFilterFunctionNArguments* args) {
    const unsigned n = args->N;
    for (unsigned i = 0; i < n; ++i) {
        if (args->valid[i] != -1 || (RTCRayN_flags(args->ray, n, i) & meets_backs)) continue;
        const float along = RTCHitN_Ng_x(args->hit, n, i) * RTCRayN_dir_x(args->ray, n, i) +
                            RTCHitN_Ng_y(args->hit, n, i) * RTCRayN_dir_y(args->ray, n, i) +
                            RTCHitN_Ng_z(args->hit, n, i) * RTCRayN_dir_z(args->ray, n, i);
        if (along > 0) args->valid[i] = 0;
    }
}

/// The transmittance along the eight rays of `transmitted`; null if panes are hit like other surfaces.
thread_local Color* passed = nullptr;
/// The distance at which each of these rays last passed through the edge of a triangle.
thread_local float edge_passed[8];

/// Returns whether a ray hits an edge at the point where it passed through the edge of the adjacent triangle. Both
/// triangles report the hit, but it is one surface.
bool passed_by_neighbor(unsigned ray, float t, float u, float v) {
    constexpr float on_edge = 1e-6f;  // in barycentric weights and in units of the distance: a few roundings
    if (std::min({u, v, 1 - u - v}) > on_edge) return false;
    if (std::abs(edge_passed[ray] - t) <= on_edge * t) return true;
    edge_passed[ray] = t;
    return false;
}

template <unsigned kind>
void reject_transparent(const RTCFilterFunctionNArguments* args) {
    const auto& impl = *static_cast<const Intersector::Impl*>(args->geometryUserPtr);
    if (kind & 2) reject_backs(args);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] != -1) continue;
        const unsigned primitive = RTCHitN_primID(args->hit, args->N, i);
        const float u = RTCHitN_u(args->hit, args->N, i), v = RTCHitN_v(args->hit, args->N, i);
        const float opacity = impl.opacity(impl.to_triangle[kind][primitive], u, v);
        if (opacity >= 1) continue;
        const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
        const uint32_t key =
            hash(hash(bits(RTCRayN_dir_x(args->ray, args->N, i)), bits(RTCRayN_dir_y(args->ray, args->N, i)),
                      bits(RTCRayN_org_x(args->ray, args->N, i))),
                 bits(RTCRayN_org_y(args->ray, args->N, i)), primitive);
        if (opacity <= 0 || to_unit_float(key) >= opacity) args->valid[i] = 0;
    }
}

/// Applies the tests of a kind to rays that look for the closest hit.
template <unsigned kind>
void reject_unseen(const RTCFilterFunctionNArguments* args) {
    if (kind & 8) {
        for (unsigned i = 0; i < args->N; ++i)
            if (RTCRayN_flags(args->ray, args->N, i) & comes_from_camera) args->valid[i] = 0;
    }
    if (kind & 1)
        reject_transparent<kind>(args);
    else if (kind & 2)
        reject_backs(args);
}

/// The filters of kind `id`, for closest hits and for shadow rays; null where a kind needs none.
struct Filters {
    RTCFilterFunctionN meeting, hiding;
};

template <unsigned kind>
void pass_light(const RTCFilterFunctionNArguments* args);

template <unsigned kind>
constexpr Filters filters_of() {
    constexpr bool sees_all = (kind & 11) == 0, blocks_all = (kind & 7) == 0, sided = (kind & 7) == 2;
    return {sees_all ? nullptr : reject_unseen<kind>, blocks_all ? nullptr : sided ? reject_backs : pass_light<kind>};
}

template <unsigned... kind>
constexpr std::array<Filters, sizeof...(kind)> all_filters(std::integer_sequence<unsigned, kind...>) {
    return {filters_of<kind>()...};
}

/// Candidates come in any order and each once, so panes, and surfaces that are there in part, multiply what passes as they are
/// found: a sun through half a surface is half a sun at every point, and not all of it at half of the points.
template <unsigned kind>
void pass_light(const RTCFilterFunctionNArguments* args) {
    if (kind & 2) reject_backs(args);
    if (passed == nullptr) {
        if (kind & 1) reject_transparent<kind>(args);
        return;
    }
    const auto& impl = *static_cast<const Intersector::Impl*>(args->geometryUserPtr);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] != -1) continue;
        const uint32_t triangle = impl.to_triangle[kind][RTCHitN_primID(args->hit, args->N, i)];
        const float u = RTCHitN_u(args->hit, args->N, i), v = RTCHitN_v(args->hit, args->N, i);
        const Vec3 w{RTCRayN_dir_x(args->ray, args->N, i), RTCRayN_dir_y(args->ray, args->N, i),
                     RTCRayN_dir_z(args->ray, args->N, i)};
        const float opacity = impl.opacity(triangle, u, v);
        Color through(1 - opacity);
        if (kind & 4) through += impl.pane(triangle, u, v, w) * opacity;
        if (is_black(through)) continue;
        const unsigned ray = RTCRayN_id(args->ray, args->N, i);
        if (!passed_by_neighbor(ray, RTCRayN_tfar(args->ray, args->N, i), u, v)) passed[ray] *= through;
        args->valid[i] = 0;
    }
}

void add_geometry(Intersector::Impl& impl, std::span<const Vec3> vertices, unsigned id) {
    const auto& indices = impl.indices[id];
    if (indices.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(impl.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices.data(), 0, sizeof(Vec3),
                               vertices.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0,
                               sizeof(Intersector::Triangle), indices.size());
    if (id > 0) {
        constexpr auto filters = all_filters(std::make_integer_sequence<unsigned, Intersector::Impl::kinds>());
        rtcSetGeometryUserData(geometry, &impl);
        rtcSetGeometryIntersectFilterFunction(geometry, filters[id].meeting);
        rtcSetGeometryOccludedFilterFunction(geometry, filters[id].hiding);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(impl.scene, geometry, id);
    rtcReleaseGeometry(geometry);
}

/// The data that are the same for all packets.
void prepare(RTCRay8& packet, int* valid, Backs backs, bool from_camera = false) {
    for (size_t i = 0; i < 8; ++i) {
        valid[i] = -1;
        packet.time[i] = 0;
        packet.mask[i] = ~0u;
        packet.id[i] = static_cast<unsigned>(i);
        packet.flags[i] = (backs == Backs::met ? meets_backs : 0) | (from_camera ? comes_from_camera : 0);
    }
}

/// Returns whether Embree can trace the ray. For components that are NaN or beyond 1.844e18, Embree stops the process
/// or, if it was built without checks, returns wrong hits. Such rays occur in scenes that extend to 1e18 m.
bool is_sound(const Ray& ray) {
    constexpr float most = 1.8e18f;
    const auto within = [](Vec3 v) { return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most; };
    return within(ray.origin) && within(ray.direction) && !std::isnan(ray.t_min) && !std::isnan(ray.t_max);
}

/// The first eight of `rays`; lanes beyond them, and of rays that are not sound, are not valid and meet nothing.
void fill(RTCRay8& packet, std::span<const Ray> rays, int* valid) {
    const size_t live = std::min<size_t>(8, rays.size());
    for (size_t i = live; i < 8; ++i) valid[i] = 0;
    for (size_t i = 0; i < live; ++i) {
        const Ray& ray = rays[i];
        valid[i] = is_sound(ray) ? -1 : 0;
        packet.org_x[i] = ray.origin.x;
        packet.org_y[i] = ray.origin.y;
        packet.org_z[i] = ray.origin.z;
        packet.dir_x[i] = ray.direction.x;
        packet.dir_y[i] = ray.direction.y;
        packet.dir_z[i] = ray.direction.z;
        packet.tnear[i] = ray.t_min;
        packet.tfar[i] = ray.t_max;
    }
}

#if RTC_VERSION_MAJOR >= 4
void query(const int* valid, RTCScene scene, RTCRayHit8* packet, RTCRayQueryFlags flags) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = flags;
    rtcIntersect8(valid, scene, packet, &arguments);
}
void query(const int* valid, RTCScene scene, RTCRay8* packet) { rtcOccluded8(valid, scene, packet); }
constexpr auto coherent = RTC_RAY_QUERY_FLAG_COHERENT, incoherent = RTC_RAY_QUERY_FLAG_INCOHERENT;
using QueryFlags = RTCRayQueryFlags;
#else
void query(const int* valid, RTCScene scene, RTCRayHit8* packet, RTCIntersectContextFlags flags) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    rtcIntersect8(valid, scene, &context, packet);
}
void query(const int* valid, RTCScene scene, RTCRay8* packet) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid, scene, &context, packet);
}
constexpr auto coherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT, incoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
using QueryFlags = RTCIntersectContextFlags;
#endif

#ifdef ECLAT_EMBREE_OPTIONS
/// A core for one instruction set has Embree use the same set, so that its bits do not depend on what else the machine
/// can do.
constexpr const char* device_options = ECLAT_EMBREE_OPTIONS;
#else
constexpr const char* device_options = nullptr;
#endif

RTCDevice new_device() {
    const RTCDevice device = rtcNewDevice(device_options);
    require(device != nullptr, "the ray tracer (Embree) could not start on this machine");
    return device;
}

}  // namespace

std::string ray_tracer_version() {
    const RTCDevice device = new_device();
    std::string version = std::to_string(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR));
    for (const auto part : {RTC_DEVICE_PROPERTY_VERSION_MINOR, RTC_DEVICE_PROPERTY_VERSION_PATCH})
        version.append(".").append(std::to_string(rtcGetDeviceProperty(device, part)));
    rtcReleaseDevice(device);
    return version;
}

Intersector::Intersector(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                         std::span<const Sieve> sieves, OpacityFunction opacity, PaneFunction pane)
    : impl_(std::make_unique<Impl>()) {
    impl_->opacity = std::move(opacity);
    impl_->pane = std::move(pane);
    impl_->device = new_device();
    impl_->scene = rtcNewScene(impl_->device);
    // Robust: no ray slips through the edge between two triangles. Medium quality builds are deterministic, high ones
    // (with spatial splits) are not.
    rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_MEDIUM);
    for (uint32_t i = 0; i < triangles.size(); ++i) {
        const unsigned kind = Impl::kind_of(sieves[i]);
        impl_->to_triangle[kind].push_back(i);
        impl_->indices[kind].push_back(triangles[i]);
    }
    for (unsigned id = 0; id < Impl::kinds; ++id) add_geometry(*impl_, vertices, id);
    rtcCommitScene(impl_->scene);
    require(rtcGetDeviceError(impl_->device) == RTC_ERROR_NONE, "the ray tracer (Embree) could not build its tree");
}

Intersector::~Intersector() = default;

bool Intersector::culls_backs() const {
    for (unsigned kind = 0; kind < Impl::kinds; ++kind)
        if ((kind & 2) && !impl_->indices[kind].empty()) return true;
    return false;
}

void Intersector::intersect(std::span<const Ray> rays, std::span<Hit> hits, Coherence coherence, Backs backs) const {
    const QueryFlags flags = coherence == Coherence::camera ? coherent : incoherent;
    alignas(32) RTCRayHit8 packet{};
    alignas(32) int valid[8];
    prepare(packet.ray, valid, backs, coherence == Coherence::camera);
    for (size_t begin = 0; begin < rays.size(); begin += 8) {
        const auto some = rays.subspan(begin, std::min<size_t>(8, rays.size() - begin));
        fill(packet.ray, some, valid);
        for (int i = 0; i < 8; ++i) packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        query(valid, impl_->scene, &packet, flags);
        for (size_t i = 0; i < some.size(); ++i) {
            const unsigned geometry = packet.hit.geomID[i];
            hits[begin + i] = geometry == RTC_INVALID_GEOMETRY_ID
                                  ? Hit{}
                                  : Hit{impl_->to_triangle[geometry][packet.hit.primID[i]], packet.ray.tfar[i],
                                        packet.hit.u[i], packet.hit.v[i]};
        }
    }
}

void Intersector::occluded(std::span<const Ray> rays, std::span<uint8_t> out, Backs backs) const {
    alignas(32) RTCRay8 packet{};
    alignas(32) int valid[8];
    prepare(packet, valid, backs);
    for (size_t begin = 0; begin < rays.size(); begin += 8) {
        const auto some = rays.subspan(begin, std::min<size_t>(8, rays.size() - begin));
        fill(packet, some, valid);
        query(valid, impl_->scene, &packet);
        for (size_t i = 0; i < some.size(); ++i) out[begin + i] = valid[i] == 0 || packet.tfar[i] < 0;
    }
}

void Intersector::transmitted(std::span<const Ray> rays, std::span<Color> out, Backs backs) const {
    alignas(32) RTCRay8 packet{};
    alignas(32) int valid[8];
    prepare(packet, valid, backs);
    Color through[8];
    for (size_t begin = 0; begin < rays.size(); begin += 8) {
        const auto some = rays.subspan(begin, std::min<size_t>(8, rays.size() - begin));
        fill(packet, some, valid);
        std::fill(std::begin(through), std::end(through), Color(1));
        std::fill(std::begin(edge_passed), std::end(edge_passed), -infinity);
        passed = through;
        query(valid, impl_->scene, &packet);
        passed = nullptr;
        for (size_t i = 0; i < some.size(); ++i)
            out[begin + i] = valid[i] == 0 || packet.tfar[i] < 0 ? Color() : through[i];
    }
}

}  // namespace eclat

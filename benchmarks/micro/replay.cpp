// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "micro/replay.h"

#include <chrono>
#include <span>

#include "base/error.h"
#include "base/parallel.h"

namespace eclat {

namespace {

constexpr size_t block = 4096;  // rays a task

#if RTC_VERSION_MAJOR >= 4
NearestSettings nearest_settings(bool coherent) {
    NearestSettings settings;
    rtcInitIntersectArguments(&settings);
    settings.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    return settings;
}
ShadowSettings shadow_settings(bool coherent) {
    ShadowSettings settings;
    rtcInitOccludedArguments(&settings);
    settings.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    return settings;
}
#define ECLAT_ORDERED(settings, rays) rays, settings
#else
NearestSettings nearest_settings(bool coherent) {
    NearestSettings settings;
    rtcInitIntersectContext(&settings);
    settings.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return settings;
}
ShadowSettings shadow_settings(bool coherent) { return nearest_settings(coherent); }
#define ECLAT_ORDERED(settings, rays) settings, rays
#endif

void set_lane(RTCRay& out, int, const Ray& ray) {
    out = {ray.origin.x,
           ray.origin.y,
           ray.origin.z,
           ray.t_min,
           ray.direction.x,
           ray.direction.y,
           ray.direction.z,
           0,
           ray.t_max,
           ~0u,
           0,
           0};
}
template <class Packet>
void set_lane(Packet& p, int i, const Ray& ray) {
    p.org_x[i] = ray.origin.x;
    p.org_y[i] = ray.origin.y;
    p.org_z[i] = ray.origin.z;
    p.tnear[i] = ray.t_min;
    p.dir_x[i] = ray.direction.x;
    p.dir_y[i] = ray.direction.y;
    p.dir_z[i] = ray.direction.z;
    p.time[i] = 0;
    p.tfar[i] = ray.t_max;
    p.mask[i] = ~0u;
    p.id[i] = static_cast<unsigned>(i);
    p.flags[i] = 0;
}

void clear_hit(RTCRayHit& rays, int) { rays.hit.geomID = RTC_INVALID_GEOMETRY_ID; }
template <class Packet>
void clear_hit(Packet& rays, int i) {
    rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
}

/// Fills packets of `width` rays, in order, and passes each with its lanes' validity to `query`.
template <int width, class Packet, class SetLane, class Query>
void in_packets(std::span<const Ray> rays, SetLane&& set, Query&& query) {
    for (size_t begin = 0; begin < rays.size(); begin += width) {
        alignas(64) Packet packet;
        alignas(64) int valid[width];
        for (int i = 0; i < width; ++i) {
            const bool live = begin + i < rays.size();
            valid[i] = live ? -1 : 0;
            set(packet, i, rays[live ? begin + i : begin]);
        }
        query(valid, packet);
    }
}

template <int width, class NearestPacket, class ShadowPacket, class Nearest, class Shadow>
void trace(std::span<const Ray> nearest, std::span<const Ray> shadow, Nearest&& find_nearest, Shadow&& find_shadow) {
    in_packets<width, NearestPacket>(
        nearest,
        [](NearestPacket& p, int i, const Ray& ray) {
            set_lane(p.ray, i, ray);
            clear_hit(p, i);
        },
        find_nearest);
    in_packets<width, ShadowPacket>(
        shadow, [](ShadowPacket& p, int i, const Ray& ray) { set_lane(p, i, ray); }, find_shadow);
}

void trace_block(RTCScene scene, std::span<const Ray> nearest, std::span<const Ray> shadow,
                 const ReplayOptions& options) {
    NearestSettings n = nearest_settings(options.coherent);
    ShadowSettings s = shadow_settings(options.coherent);
    if (options.width == 1)
        trace<1, RTCRayHit, RTCRay>(
            nearest, shadow, [&](const int*, RTCRayHit& p) { __real_rtcIntersect1(scene, ECLAT_ORDERED(&n, &p)); },
            [&](const int*, RTCRay& p) { __real_rtcOccluded1(scene, ECLAT_ORDERED(&s, &p)); });
    else if (options.width == 8)
        trace<8, RTCRayHit8, RTCRay8>(
            nearest, shadow,
            [&](const int* v, RTCRayHit8& p) { __real_rtcIntersect8(v, scene, ECLAT_ORDERED(&n, &p)); },
            [&](const int* v, RTCRay8& p) { __real_rtcOccluded8(v, scene, ECLAT_ORDERED(&s, &p)); });
    else
        trace<16, RTCRayHit16, RTCRay16>(
            nearest, shadow,
            [&](const int* v, RTCRayHit16& p) { __real_rtcIntersect16(v, scene, ECLAT_ORDERED(&n, &p)); },
            [&](const int* v, RTCRay16& p) { __real_rtcOccluded16(v, scene, ECLAT_ORDERED(&s, &p)); });
}

std::span<const Ray> part(const std::vector<Ray>& rays, size_t begin) {
    const size_t first = std::min(begin, rays.size());
    return std::span(rays).subspan(first, std::min(block, rays.size() - first));
}

}  // namespace

double replay(const RayRecording& recording, const ReplayOptions& options) {
    require(options.width == 1 || options.width == 8 || options.width == 16,
            "width: expected 1, 8 or 16, got " + std::to_string(options.width));
    const auto before = std::chrono::steady_clock::now();
    parallel_blocks(
        std::max(recording.nearest.size(), recording.shadow.size()), block, options.threads, [&](size_t begin, size_t) {
            trace_block(recording.scene, part(recording.nearest, begin), part(recording.shadow, begin), options);
        });
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
}

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "micro/ray_probe.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>

namespace eclat {

namespace {

enum class Watch : uint8_t { nothing, time, rays };
using Clock = std::chrono::steady_clock;

struct ThreadLog {
    uint64_t ticks = 0, rays = 0;
    RayRecording recording;
};

std::atomic<Watch> watch{Watch::nothing};
std::mutex logs_mutex;
std::vector<std::unique_ptr<ThreadLog>> logs;  // outlive their threads
uint64_t first_tick;
Clock::time_point first_time;

ThreadLog& this_thread() {
    thread_local ThreadLog* log = nullptr;
    if (!log) {
        const std::lock_guard lock(logs_mutex);
        log = logs.emplace_back(std::make_unique<ThreadLog>()).get();
    }
    return *log;
}

uint64_t ticks() {
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();
#else
    return static_cast<uint64_t>(Clock::now().time_since_epoch().count());
#endif
}

void begin(Watch what) {
    const std::lock_guard lock(logs_mutex);
    for (auto& log : logs) *log = {};
    first_tick = ticks();
    first_time = Clock::now();
    watch = what;
}

// A packet's rays are arrays of lanes, a single ray is one lane.
Ray lane(const RTCRay& r, int) { return {{r.org_x, r.org_y, r.org_z}, r.tnear, {r.dir_x, r.dir_y, r.dir_z}, r.tfar}; }
template <class Packet>
Ray lane(const Packet& p, int i) {
    return {{p.org_x[i], p.org_y[i], p.org_z[i]}, p.tnear[i], {p.dir_x[i], p.dir_y[i], p.dir_z[i]}, p.tfar[i]};
}

template <class Rays, class Query>
void probed(RTCScene scene, const int* valid, int width, const Rays& rays, std::vector<Ray> RayRecording::* kind,
            Query&& query) {
    const Watch what = watch.load(std::memory_order_relaxed);
    if (what == Watch::nothing) return query();
    ThreadLog& log = this_thread();
    if (what == Watch::rays) {
        log.recording.scene = scene;
        for (int i = 0; i < width; ++i)
            if (!valid || valid[i] == -1) (log.recording.*kind).push_back(lane(rays, i));
        return query();
    }
    for (int i = 0; i < width; ++i) log.rays += !valid || valid[i] == -1;
    const uint64_t before = ticks();
    query();
    log.ticks += ticks() - before;
}

}  // namespace

void start_timing() { begin(Watch::time); }
void start_recording() { begin(Watch::rays); }

TimeInside stop_timing() {
    watch = Watch::nothing;
    const double seconds_per_tick =
        std::chrono::duration<double>(Clock::now() - first_time).count() / static_cast<double>(ticks() - first_tick);
    const std::lock_guard lock(logs_mutex);
    TimeInside out;
    for (const auto& log : logs) {
        out.seconds += static_cast<double>(log->ticks) * seconds_per_tick;
        out.rays += log->rays;
    }
    return out;
}

RayRecording stop_recording() {
    watch = Watch::nothing;
    const std::lock_guard lock(logs_mutex);
    RayRecording out;
    for (auto& log : logs) {
        RayRecording& some = log->recording;
        if (some.scene) out.scene = some.scene;
        out.nearest.insert(out.nearest.end(), some.nearest.begin(), some.nearest.end());
        out.shadow.insert(out.shadow.end(), some.shadow.begin(), some.shadow.end());
        some = {};
    }
    return out;
}

}  // namespace eclat

using eclat::RayRecording;

extern "C" {

void __wrap_rtcIntersect1(ECLAT_QUERY(NearestSettings, RTCRayHit)) {
    eclat::probed(scene, nullptr, 1, rays->ray, &RayRecording::nearest,
                  [&] { __real_rtcIntersect1(ECLAT_QUERY_ARGUMENTS); });
}
void __wrap_rtcOccluded1(ECLAT_QUERY(ShadowSettings, RTCRay)) {
    eclat::probed(scene, nullptr, 1, *rays, &RayRecording::shadow, [&] { __real_rtcOccluded1(ECLAT_QUERY_ARGUMENTS); });
}

#define ECLAT_WRAP(width)                                                                               \
    void __wrap_rtcIntersect##width(const int* valid, ECLAT_QUERY(NearestSettings, RTCRayHit##width)) { \
        eclat::probed(scene, valid, width, rays->ray, &RayRecording::nearest,                           \
                      [&] { __real_rtcIntersect##width(valid, ECLAT_QUERY_ARGUMENTS); });               \
    }                                                                                                   \
    void __wrap_rtcOccluded##width(const int* valid, ECLAT_QUERY(ShadowSettings, RTCRay##width)) {      \
        eclat::probed(scene, valid, width, *rays, &RayRecording::shadow,                                \
                      [&] { __real_rtcOccluded##width(valid, ECLAT_QUERY_ARGUMENTS); });                \
    }
ECLAT_WRAP(4)
ECLAT_WRAP(8)
ECLAT_WRAP(16)
#undef ECLAT_WRAP
}

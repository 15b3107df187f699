// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Embree's own query functions, behind the wrappers that ray_probe.cpp puts in their place (linker option --wrap), in
// one order of arguments for 3.x and 4.x.

#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#if RTC_VERSION_MAJOR >= 4
using NearestSettings = RTCIntersectArguments;
using ShadowSettings = RTCOccludedArguments;
#define ECLAT_QUERY(Settings, Rays) RTCScene scene, Rays *rays, Settings *settings
#define ECLAT_QUERY_ARGUMENTS scene, rays, settings
#else
using NearestSettings = RTCIntersectContext;
using ShadowSettings = RTCIntersectContext;
#define ECLAT_QUERY(Settings, Rays) RTCScene scene, Settings *settings, Rays *rays
#define ECLAT_QUERY_ARGUMENTS scene, settings, rays
#endif

extern "C" {
void __real_rtcIntersect1(ECLAT_QUERY(NearestSettings, RTCRayHit));
void __real_rtcOccluded1(ECLAT_QUERY(ShadowSettings, RTCRay));
void __real_rtcIntersect4(const int* valid, ECLAT_QUERY(NearestSettings, RTCRayHit4));
void __real_rtcOccluded4(const int* valid, ECLAT_QUERY(ShadowSettings, RTCRay4));
void __real_rtcIntersect8(const int* valid, ECLAT_QUERY(NearestSettings, RTCRayHit8));
void __real_rtcOccluded8(const int* valid, ECLAT_QUERY(ShadowSettings, RTCRay8));
void __real_rtcIntersect16(const int* valid, ECLAT_QUERY(NearestSettings, RTCRayHit16));
void __real_rtcOccluded16(const int* valid, ECLAT_QUERY(ShadowSettings, RTCRay16));
}

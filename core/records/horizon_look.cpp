// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A low object beside a point, or an object close below the ceiling that the point is on, fills so little of the hemisphere that
// a gather hits it only by chance, yet it blocks light. Rays along the horizon search for such objects in all directions.
//
// Held to     tests/core/records/test_record_passes.cpp

#include "records/horizon_look.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "hemisphere/hemisphere.h"

namespace eclat {

namespace {

class HorizonLook {
  public:
    HorizonLook(const World& world, const Candidate& candidate, Progress& progress)
        : world_(world), candidate_(candidate), frame_(Frame::around(candidate.normal)), progress_(progress) {}

    /// Lowers the record's clearances; returns the least distance to an object that is separate from the surface.
    float look(IrradianceRecord& record) const {
        float nearest = infinity;
        std::vector<Look> looks;
        for (float elevation : {lowest, highest})
            for (int turn = 0; turn < turns; ++turn) looks.push_back({elevation, turn});
        const auto found = trace(looks);
        // An object that faces the surface, such as a panel below a ceiling, begins closer than the point at which a
        // low ray hits it. Its edge is between the highest ray that hits it and the lowest ray that passes it.
        std::vector<Edge> edges;
        for (int turn = 0; turn < turns; ++turn) {
            const Met &low = found[size_t(turn)], &high = found[size_t(turn + turns)];
            if (high.faces)
                edges.push_back({turn, highest, above_highest});
            else if (low.faces)
                edges.push_back({turn, lowest, highest});
        }
        nearest = std::min(nearest, tell(looks, found, record));
        tell_between(looks, found, record);
        for (int halving = 0; halving < halvings && !edges.empty(); ++halving) {
            looks.clear();
            for (const Edge& e : edges) looks.push_back({std::sqrt(e.met * e.passed), e.turn});
            const auto closer = trace(looks);
            for (size_t i = 0; i < edges.size(); ++i)
                (closer[i].faces ? edges[i].met : edges[i].passed) = looks[i].elevation;
            nearest = std::min(nearest, tell(looks, closer, record));
        }
        return nearest;
    }

  private:
    // The lowest of the 14 rows of a usual gather is below 15.5° (sin² = 1/14) and has 44 rays, which are uniform in
    // sin². An object that rises to 5° on all sides is hit by five of them (sin² 5° · 14 = 0.11), and one that rises to
    // 1.5° by less than one ray in two gathers (0.01). The rays along the horizon therefore search where gathers do
    // not. The elevation of 1.5° was chosen by judgement, because lower rays hit more of the unevenness of the surface
    // itself. The test for panels below ceilings is in tests/core/records/test_record_passes.cpp.
    static constexpr float degree = pi / 180;
    static constexpr float lowest = 1.5f * degree, highest = 5 * degree;
    static constexpr float above_highest = 45 * degree;  // greatest elevation at which an edge is searched
    static constexpr int turns = 24;                     // number of azimuths, two for each sector of clearance
    // The tangent of the elevation is inversely proportional to the distance, and from 5° to 45° it increases by a
    // factor of 11. Four bisections of its logarithm leave a factor of 11^{1/16} = 1.16, so the distance of an edge is
    // known within a sixth.
    static constexpr int halvings = 4;
    // This is the least cosine of the angle between the surface and an object that faces it, which is tilted by at most
    // 45° (0.7 ≈ 1 / √2), so that walls do not count.
    static constexpr float facing = -0.7f;

    struct Look {
        float elevation;
        int turn;
    };
    struct Met {
        float distance = infinity;  // distance to an object separate from the surface
        bool faces = false;         // whether the object faces the surface
        Vec3 normal{};              // geometric normal of the object
    };
    struct Edge {
        int turn;
        float met, passed;  // elevations of a ray that hits the object and of one that passes it
    };

    Vec3 direction(const Look& look) const {
        const float phi = 2 * pi * (static_cast<float>(look.turn) + 0.5f) / turns;
        return frame_.u * (std::cos(look.elevation) * std::cos(phi)) +
               frame_.v * (std::cos(look.elevation) * std::sin(phi)) + frame_.n * std::sin(look.elevation);
    }

    std::vector<Met> trace(std::span<const Look> looks) const {
        std::vector<Ray> rays;
        for (const Look& look : looks) rays.push_back(candidate_.ray(direction(look)));
        std::vector<Hit> hits(rays.size());
        world_.geometry.rays().intersect(rays, hits);
        progress_.count_rays(rays.size());
        std::vector<Met> out(rays.size());
        for (size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].missed()) continue;
            const SurfacePoint met = world_.geometry.surface_point(hits[i], -rays[i].direction);
            if (stands_apart(candidate_.shading_normal, rays[i].direction, met.frame.n))
                out[i] = {hits[i].t, dot(met.frame.n, frame_.n) < facing, met.normal};
        }
        return out;
    }

    /// Lowers the clearances to the distances of the hits; returns the least distance.
    float tell(std::span<const Look> looks, std::span<const Met> found, IrradianceRecord& record) const {
        float nearest = infinity;
        for (size_t i = 0; i < looks.size(); ++i) {
            // A wall continues between two rays and may be nearest at the border of a sector, so the adjacent sectors
            // are lowered too.
            for (int heard : {looks[i].turn, looks[i].turn + 1, looks[i].turn - 1}) {
                float& clearance = record.clearance[clearance_sector(frame_, direction({looks[i].elevation, heard}))];
                clearance = std::min(clearance, found[i].distance * std::cos(looks[i].elevation));
            }
            nearest = std::min(nearest, found[i].distance);
        }
        return nearest;
    }

    /// Lowers the clearances to the distances of corners between neighbouring rays of the same elevation. A wide record in a
    /// garden would else be read on the floor behind the corner of a thin-walled house.
    void tell_between(std::span<const Look> looks, std::span<const Met> found, IrradianceRecord& record) const {
        for (size_t i = 0; i < looks.size(); ++i) {
            const size_t next = looks[i].turn + 1 < turns ? i + 1 : i + 1 - turns;
            const float distance = between({direction(looks[i]), found[i]}, {direction(looks[next]), found[next]});
            for (size_t beside : {i, next}) {
                float& clearance = record.clearance[clearance_sector(frame_, direction(looks[beside]))];
                clearance = std::min(clearance, distance * std::cos(looks[i].elevation));
            }
        }
    }

    /// A ray and what it met, which continues as a plane.
    struct Side {
        Vec3 direction;
        Met met;

        float height() const { return dot(met.normal, direction) * met.distance; }
        /// Returns the distance of the plane in another direction.
        float distance(Vec3 along) const {
            const float rise = dot(met.normal, along);
            return rise * height() > 0 ? height() / rise : infinity;
        }
    };

    /// Returns how close something can be between two rays: where the planes of both meet, if that is between the rays, or
    /// where the nearer plane, which the other ray passes, ends at the latest.
    static float between(const Side& a, const Side& b) {
        if (a.met.distance < infinity && b.met.distance < infinity) {
            const float aa = dot(a.met.normal, a.direction), ab = dot(a.met.normal, b.direction);
            const float ba = dot(b.met.normal, a.direction), bb = dot(b.met.normal, b.direction);
            const float det = aa * bb - ab * ba;
            const float along_a = (a.height() * bb - b.height() * ab) / det;
            const float along_b = (b.height() * aa - a.height() * ba) / det;
            if (along_a > 0 && along_b > 0) return length(a.direction * along_a + b.direction * along_b);
        }
        float nearest = infinity;
        for (const auto& [here, there] : {std::pair{a, b}, std::pair{b, a}}) {
            if (here.met.distance == infinity) continue;
            const float end = here.distance(there.direction);
            if (end < there.met.distance) nearest = std::min(nearest, end);
        }
        return nearest;
    }

    const World& world_;
    const Candidate& candidate_;
    Frame frame_;
    Progress& progress_;
};

}  // namespace

float look_along_horizon(const World& world, const Candidate& candidate, Progress& progress, IrradianceRecord& record) {
    return HorizonLook(world, candidate, progress).look(record);
}

}  // namespace eclat

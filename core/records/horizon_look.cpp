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

    /// Lowers the record's clearances; returns the least distance to what stands apart.
    float look(IrradianceRecord& record) const {
        float nearest = infinity;
        std::vector<Look> looks;
        for (float elevation : {lowest, highest})
            for (int turn = 0; turn < turns; ++turn) looks.push_back({elevation, turn});
        const auto found = trace(looks);
        // What faces the surface, as the back of a panel does, begins nearer than where a low ray meets it: between the
        // highest ray that meets it and the lowest that passes below.
        std::vector<Edge> edges;
        for (int turn = 0; turn < turns; ++turn) {
            const Met &low = found[size_t(turn)], &high = found[size_t(turn + turns)];
            if (high.faces)
                edges.push_back({turn, highest, above_highest});
            else if (low.faces)
                edges.push_back({turn, lowest, highest});
        }
        nearest = std::min(nearest, tell(looks, found, record));
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
    // The last of the 14 rows of a usual gather lies below 15.5° (sin² = 1/14) and has 44 rays, uniform in sin². What stands
    // up to 5° all around is met by five of them (sin² 5° · 14 = 0.11), up to 1.5° by less than one in two gathers (0.01):
    // so the looks go where gathers do not. 1.5° and not less is judgement: lower rays meet more of the unevenness of the
    // surface itself. Panels that hang under ceilings are held to in tests/core/records/test_record_passes.cpp.
    static constexpr float degree = pi / 180;
    static constexpr float lowest = 1.5f * degree, highest = 5 * degree;
    static constexpr float above_highest = 45 * degree;  // where an edge is looked for at most
    static constexpr int turns = 24;                     // two to each sector of clearance
    // In tan of the elevation, which goes with one over the distance, 5° … 45° are a factor of 11: halved four times in
    // logarithms, 11^{1/16} = 1.16 is left, so that an edge is known within a sixth of its distance.
    static constexpr int halvings = 4;
    // Cosine between the surface and what faces it: tilted by at most 45° (0.7 ≈ 1 / √2), so that walls do not count.
    static constexpr float facing = -0.7f;

    struct Look {
        float elevation;
        int turn;
    };
    struct Met {
        float distance = infinity;  // to what stands apart
        bool faces = false;         // the surface
    };
    struct Edge {
        int turn;
        float met, passed;  // elevations
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
            const Vec3 there = world_.geometry.surface_point(hits[i], -rays[i].direction).frame.n;
            if (stands_apart(candidate_.shading_normal, rays[i].direction, there))
                out[i] = {hits[i].t, dot(there, frame_.n) < facing};
        }
        return out;
    }

    /// Lowers clearances by what was met; returns the least distance.
    float tell(std::span<const Look> looks, std::span<const Met> found, IrradianceRecord& record) const {
        float nearest = infinity;
        for (size_t i = 0; i < looks.size(); ++i) {
            // A wall goes on between two rays, and is nearest at one side of a sector: its neighbours' sectors hear too.
            for (int heard : {looks[i].turn, looks[i].turn + 1, looks[i].turn - 1}) {
                float& clearance = record.clearance[clearance_sector(frame_, direction({looks[i].elevation, heard}))];
                clearance = std::min(clearance, found[i].distance * std::cos(looks[i].elevation));
            }
            nearest = std::min(nearest, found[i].distance);
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

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// References   [Jensen95] directions by what was seen before, [Vorba14] what guides learn, [Ruppert20] parallax
//
// Symbol   name here            meaning
//   L_c    luminance            what paths found in cell c of the hemisphere
//   w_c    weights              √(mean of L_c²), the density of least variance [Vorba14 §3]
//   p      CosineGuide          cosine / π times a factor in proportion to w_c, smoothed, and a share that is even
//
// Held to      tests/core/transport/test_path_guide.cpp, tests/methods/test_final_gather.py

#include "transport/path_guide.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "sampling/rng.h"

namespace eclat {

namespace {

constexpr uint32_t side = CosineGuide::side, cells = CosineGuide::cells;
using Cells = std::array<float, cells>;

// These are tuned in three scenes; the docs have the measurements (docs/algorithms/irradiance_cache.md, "Guiding").
constexpr size_t shared_places = 25;    // places from which each learns, itself included
constexpr float uniform_share = 0.25f;  // of all directions, so that no weight exceeds 4 times the albedo

// The distance, in usual distances between places, beyond which a place says nothing. Without a limit, points on surfaces of a
// rare orientation would look through all places.
constexpr float reach = 32;

constexpr float brightest = 1e15f;  // its square, summed over all cells, is still a float

/// Returns the mean of each cell and those around it, where it counts four times.
Cells smoothed(const Cells& of) {
    constexpr int n = side;
    Cells out{};
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            float sum = 0, all = 0;
            for (int v = std::max(0, y - 1); v <= std::min(n - 1, y + 1); ++v)
                for (int u = std::max(0, x - 1); u <= std::min(n - 1, x + 1); ++u) {
                    const float share = u == x && v == y ? 4 : 1;
                    sum += share * of[static_cast<size_t>(v * n + u)];
                    all += share;
                }
            out[static_cast<size_t>(y * n + x)] = sum / all;
        }
    return out;
}

}  // namespace

PathGuide::PathGuide(const World& world, std::span<const PointNormal> places, const PathOptions& options, int threads,
                     Progress& progress) {
    std::vector<Vec3> positions;
    for (const PointNormal& place : places) positions.push_back(place.position);
    tree_ = KdTree(positions, threads);
    for (const uint32_t i : tree_.order())
        places_.push_back({places[i].position, Frame::around(places[i].normal), CosineGuide()});
    width_ = usual_width(threads, progress);
    progress.begin(places_.size());
    const auto seen = parallel_map<std::vector<Seen>>(places_.size(), threads, [&](size_t i) {
        progress.check();
        progress.advance();
        return look_around(world, static_cast<uint32_t>(i), options, progress);
    });
    parallel_for(places_.size(), threads, [&](size_t i) {
        progress.check();
        places_[i].guide = learnt_at(static_cast<uint32_t>(i), seen);
    });
}

/// Traces a path in each cell of the hemisphere.
std::vector<PathGuide::Seen> PathGuide::look_around(const World& world, uint32_t place, const PathOptions& options,
                                                    Progress& progress) const {
    const Frame& frame = places_[place].frame;
    const SurfacePoint from = bare_point(world, {places_[place].position, frame.n});
    std::vector<PathRay> rays;
    for (uint32_t cell = 0; cell < cells; ++cell) {
        Sampler sampler(stream_seed(0, Stream::path_guides), place, cell);  // the same guide for pictures of all seeds
        const Vec2 u = sampler.next_2d();
        const Vec3 w = square_to_cosine_hemisphere(
            {(static_cast<float>(cell % side) + u.x) / side, (static_cast<float>(cell / side) + u.y) / side});
        rays.push_back({from.ray(frame.to_world(w)), sampler, cosine_hemisphere_pdf_solid_angle(w)});
    }
    std::vector<PathResult> results(rays.size());
    trace_paths(world, rays, options, results, progress);
    std::vector<Seen> seen;
    for (size_t i = 0; i < rays.size(); ++i) {
        const float found = luminance(results[i].radiance);
        seen.push_back({rays[i].ray.direction, results[i].distance, found > 0 ? std::min(found, brightest) : 0});
    }
    return seen;
}

/// What the paths of the places around found is moved to where it is seen from this place, with its parallax [Ruppert20].
CosineGuide PathGuide::learnt_at(uint32_t place, std::span<const std::vector<Seen>> seen) const {
    const Vec3 position = places_[place].position;
    const Frame& frame = places_[place].frame;
    std::vector<Neighbor> around;
    nearest({position, frame.n}, shared_places, around);
    Cells squares{}, counts{};
    for (const Neighbor& other : around) {
        const Vec3 shift = places_[other.index].position - position;
        for (const Seen& s : seen[other.index]) {
            const bool moves = other.index != place && s.distance < infinity;
            const Vec3 w = frame.to_local(moves ? normalize(shift + s.direction * s.distance) : s.direction);
            if (!(w.z > 0)) continue;
            const uint32_t cell = CosineGuide::cell_of(w);
            squares[cell] += sqr(s.luminance);
            counts[cell] += 1;
        }
    }
    Cells weights{};
    for (uint32_t i = 0; i < cells; ++i)
        if (counts[i] > 0) weights[i] = std::sqrt(squares[i] / counts[i]);
    weights = smoothed(weights);
    const float mean = std::accumulate(weights.begin(), weights.end(), 0.0f) / cells;
    for (float& w : weights) w = uniform_share * mean + (1 - uniform_share) * w;
    return CosineGuide(weights);
}

float PathGuide::nearest(const Disc& disc, size_t count, std::vector<Neighbor>& found) const {
    return tree_.nearest(disc, count, found, [&](uint32_t i) { return disc.same_side(places_[i].frame.n); });
}

/// Returns the median distance between a place and the nearest of the others, or 1 m if there are no others.
float PathGuide::usual_width(int threads, const Progress& progress) const {
    auto widths = parallel_map<float>(places_.size(), threads, [&](size_t i) {
        std::vector<Neighbor> found;
        progress.check();
        return nearest({places_[i].position, places_[i].frame.n}, 1, found);
    });
    std::erase_if(widths, [](float width) { return !(width > 0 && width < infinity); });
    if (widths.empty()) return 1;
    const auto middle = widths.begin() + static_cast<ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    return *middle;
}

PathGuide::Region PathGuide::region_of(Vec3 position, Vec3 normal) const {
    // Coordinates that no int holds are as far away as any others.
    constexpr float most = 1e9f;
    Region region;
    for (int i = 0; i < 3; ++i) {
        region.cell[size_t(i)] = static_cast<int32_t>(std::floor(clamp(position[i] / width_, -most, most)));
        region.normal[size_t(i)] = static_cast<int32_t>(std::lround(normal[i] * 8));
    }
    return region;
}

PathGuide::Around PathGuide::around(const Region& region) const {
    const auto vector = [](const std::array<int32_t, 3>& a) {
        return Vec3{static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
    };
    thread_local std::vector<Neighbor> found;
    Around out;
    const Vec3 middle = (vector(region.cell) + Vec3{0.5f, 0.5f, 0.5f}) * width_;
    out.radius = nearest({middle, normalize(vector(region.normal)), reach * width_}, out.places.size(), found);
    std::sort(found.begin(), found.end());
    for (const Neighbor& place : found) out.places[out.count++] = place.index;
    return out;
}

void PathGuide::aim(std::span<SurfacePoint* const> points) const {
    // Paths of a batch begin close to each other, so that most of them are in few regions.
    struct Known {
        Region region;
        std::optional<Around> around;
    };
    constexpr size_t most = 256;
    thread_local std::vector<Known> known;
    known.assign(most, {});
    for (SurfacePoint* point : points) {
        const Region region = region_of(point->position, point->normal_towards_shading());
        uint32_t key = 0;
        for (size_t i = 0; i < 3; ++i)
            key = hash(key, static_cast<uint32_t>(region.cell[i]), static_cast<uint32_t>(region.normal[i]));
        Known& of = known[key % most];
        if (!of.around || of.region != region) of = {region, around(region)};
        aim(*point, *of.around);
    }
}

void PathGuide::aim(SurfacePoint& point, const Around& around) const {
    if (around.count == 0) return;
    // The farther a place is, the more rarely it is chosen, because pixels beside each other would show where the noise changes.
    std::array<float, choices> shares{};
    float sum = 0;
    if (around.radius < infinity)
        for (uint32_t i = 0; i < around.count; ++i)
            sum += shares[i] =
                std::max(0.0f, around.radius - length(places_[around.places[i]].position - point.position));
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
    float left = sum * to_unit_float(hash(bits(point.position.x), bits(point.position.y), bits(point.position.z)));
    uint32_t chosen = 0;
    if (sum > 0)
        while (chosen + 1 < around.count && left >= shares[chosen]) left -= shares[chosen++];
    const Place& place = places_[around.places[chosen]];
    const Vec2 along{dot(place.frame.u, point.frame.u), dot(place.frame.u, point.frame.v)};
    const float across = std::sqrt(along.x * along.x + along.y * along.y);
    // Where the shading normal lies along the guide's x axis, no turn is better than another.
    point.bsdf.aim_diffuse(place.guide, across > 1e-3f ? Vec2{along.x / across, along.y / across} : Vec2{1, 0});
}

}  // namespace eclat

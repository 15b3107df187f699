// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// 1. Sides are cut into patches of one size, and joined into clusters.
// 2. Links are refined where they carry much light, and light is gathered over them, in turns: what is bright by the light of
//    one turn is linked more finely in the next [Hanrahan91].
// 3. Patches are divided where the light of neighbours differs much: at shadows' edges and in corners; then 2. again.
// 4. Exchanges are balanced so that form factors sum to what each patch sees of others, and the equation is solved.

#include "methods/radiosity/solve_radiosity.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/kd_tree.h"
#include "methods/radiosity/links.h"
#include "methods/radiosity/patch_importance.h"
#include "methods/radiosity/patch_sizes.h"
#include "methods/radiosity/patch_surfaces.h"
#include "methods/radiosity/radiosity_system.h"

namespace eclat {

namespace {

constexpr int most_turns = 4;           // greatest number of alternations of refinement and gathering
constexpr float few_new_links = 0.02f;  // share of new links below which another turn would change little
constexpr float coarse_residual = 1e-3f;

// This is the greatest number of links per patch or face cluster; if more are needed, the tolerance is increased. The
// Cornell box needs 10 with 500 000 patches and 50 with 20 000.
constexpr size_t links_per_end = 40, least_budget = 2'000'000;

// Each takes a kilobyte and its links.
constexpr size_t most_patches = 5'000'000;

// Every sender counts as at least this share of the mean, so that the sums of form factors are accurate enough to be
// balanced.
constexpr float least_sender = 0.25f;

// Relative contrast of neighbouring patches below which a smooth reconstruction hides it.
constexpr float least_contrast = 0.03f;
constexpr size_t neighbors = 8;

// When links are refined, black patches that are lit count as sending a little light. Form factors are scaled to the
// closure, so the form factors of black surfaces must be accurate too, or the light that they absorb would be wrong.
constexpr float least_albedo = 0.05f;

// The light of the two sides is treated as unrelated.
constexpr float cut_contrast = 2;

class Solver {
  public:
    Solver(const World& world, const RadiosityOptions& options, Progress& progress)
        : world_(world),
          options_(options),
          progress_(progress),
          scales_(options.patch_size > 0 ? std::vector<float>{} : patch_scales(world.geometry, options.seed)),
          face_size_(face_size(world.geometry, options, scales_)),
          tree_(world.geometry, first_size(world.geometry, options, scales_), face_size_, scales_),
          links_(first_links(tree_)) {}

    SolvedRadiosity run() {
        SolvedRadiosity out;
        if (tree_.nodes().empty()) return out;
        measure(tree_.leaves());
        link();
        for (int i = 0; i < options_.refinements; ++i) {
            const std::vector<uint32_t> chosen = choose_patches(options_.refinements - i);
            if (chosen.empty()) break;
            const size_t before = tree_.nodes().size();
            tree_.divide(chosen);
            std::vector<uint32_t> fresh;
            for (uint32_t n = static_cast<uint32_t>(before); n < tree_.nodes().size(); ++n)
                if (tree_[n].is_leaf()) fresh.push_back(n);
            measure(fresh);
            link();
        }
        finish(out);
        return out;
    }

  private:
    static float first_size(const Geometry& geometry, const RadiosityOptions& o, std::span<const float> scales) {
        const size_t most = count_sides(geometry) + most_patches;
        if (o.patch_size > 0) {
            require(count_patches(geometry, o.patch_size, most) < most,
                    "radiosity: patch_size would make more than 5 million patches; expected a larger one");
            return o.patch_size;
        }
        require(o.patches <= most_patches, "radiosity: expected at most 5 million patches");
        // These patches are in addition to one for each side, because the large sides of a scene of many small ones
        // would otherwise not be divided.
        return patch_size_for(geometry, count_sides(geometry) + (o.refinements > 0 ? o.patches / 2 : o.patches),
                              scales);
    }

    /// Returns about the size that patches would have if all surfaces were one piece.
    static float face_size(const Geometry& geometry, const RadiosityOptions& o, std::span<const float> scales) {
        if (o.patch_size > 0) return o.patch_size;
        // The size is slightly more than the diameter of a disc with the area of a patch: 1.4 times the root of its
        // area.
        return 1.4f * static_cast<float>(std::sqrt(total_area(geometry, scales) / static_cast<double>(o.patches)));
    }

    void measure(const std::vector<uint32_t>& patches) {
        surfaces_.resize(tree_.nodes().size());
        measure_surfaces(world_, tree_, patches, {.seed = options_.seed, .threads = options_.threads}, surfaces_,
                         progress_);
    }

    /// Refines the links for the current light, and then computes `light_` with them.
    void link() {
        size_t before = 0;
        for (int turn = 0; turn < most_turns; ++turn) {
            refine();
            const Exchanges exchanges(tree_, links_);
            const RadiositySystem system(tree_, surfaces_, exchanges, options_.threads);
            light_ = solve_by_gathering(system, {coarse_residual, sweeps()}, progress_);
            const auto now = static_cast<double>(links_.size());
            if (now - static_cast<double>(before) < few_new_links * now) break;
            before = links_.size();
        }
    }

    int sweeps() const { return options_.bounces < 0 ? SolveLimits{}.sweeps : options_.bounces; }

    void refine() {
        std::vector<Color> radiosity(tree_.nodes().size());
        light_.total.resize(radiosity.size());
        std::vector<Color> arriving(tree_.nodes().size());
        for (const uint32_t i : tree_.leaves()) arriving[i] = max(inherited(i), surfaces_[i].lights);
        const Exchanges none(tree_, {});
        const RadiositySystem system(tree_, surfaces_, none, options_.threads);
        for (const uint32_t i : tree_.leaves()) {
            const PatchSurface& s = surfaces_[i];
            radiosity[i] =
                s.emitted + max(s.albedo, Color(least_albedo)) * arriving[i] + system.let_through(i, arriving);
        }
        const std::vector<Color> sent = system.pull(radiosity);
        std::vector<float> brightness(sent.size());
        for (size_t i = 0; i < sent.size(); ++i) brightness[i] = max_component(sent[i]);
        const float reference = scales_.empty() ? mean(sent[0]) : usual_mean(radiosity);
        if (!(reference > 0)) return;
        const LinkOptions options{options_.tolerance * reference, least_sender * reference, most_links(), options_.seed,
                                  options_.threads};
        tolerance_ = refine_links(world_, tree_, surfaces_, brightness, options, links_, progress_) / reference;
    }

    /// Returns the mean of patches over the area that counts: a wide dark ground does not change what is usual here.
    float usual_mean(std::span<const Color> light) const {
        double sum = 0, area = 0;
        for (const uint32_t i : tree_.leaves()) {
            const PatchNode& patch = tree_[i];
            const double counts = patch.area / sqr(double(scale_of(scales_, 2 * size_t(patch.triangle) + patch.back)));
            sum += counts * mean(light[i]);
            area += counts;
        }
        return static_cast<float>(sum / area);
    }

    size_t most_links() const {
        const auto ends = [this](const PatchNode& n) {
            return n.ends_links && (n.parent == no_node || !tree_[n.parent].ends_links);
        };
        const auto count = std::count_if(tree_.nodes().begin(), tree_.nodes().end(), ends);
        return std::max(least_budget, links_per_end * static_cast<size_t>(count));
    }

    /// Returns the irradiance of a patch, or of the patch of which it was a part when the light was last computed.
    Color inherited(uint32_t node) const {
        while (node != no_node && !tree_[node].is_cluster()) {
            if (!is_black(light_.total[node])) return light_.total[node];
            node = tree_[node].parent;
        }
        return {};
    }

    /// Returns the patches whose light differs most from that of their neighbours, as many as the wanted number of
    /// patches allows in each of `rounds`.
    std::vector<uint32_t> choose_patches(int rounds) const {
        const auto& leaves = tree_.leaves();
        const size_t wanted =
            options_.patch_size > 0 ? 2 * leaves.size() : count_sides(world_.geometry) + options_.patches;
        if (wanted <= leaves.size()) return {};
        const size_t budget = (wanted - leaves.size()) / (3 * static_cast<size_t>(rounds));
        const std::vector<float> contrast = contrasts();
        std::vector<uint32_t> order(leaves.size());
        std::iota(order.begin(), order.end(), 0u);
        std::erase_if(order, [&](uint32_t l) { return !(contrast[l] > least_contrast); });
        const auto matters = [&](uint32_t l) {
            const PatchNode& patch = tree_[leaves[l]];
            return contrast[l] * patch.area / sqr(scale_of(scales_, 2 * size_t(patch.triangle) + patch.back));
        };
        std::sort(order.begin(), order.end(),
                  [&](uint32_t a, uint32_t b) { return matters(a) != matters(b) ? matters(a) > matters(b) : a < b; });
        if (order.size() > budget) order.resize(budget);
        std::sort(order.begin(), order.end());
        for (uint32_t& l : order) l = leaves[l];
        return order;
    }

    /// Returns for each leaf the largest relative difference from the irradiance of a neighbour.
    std::vector<float> contrasts() const {
        const auto& leaves = tree_.leaves();
        std::vector<Vec3> centers;
        for (const uint32_t i : leaves) centers.push_back(tree_[i].center);
        const float floor = 0.1f * usual_mean(light_.total);
        const KdTree near(centers, options_.threads);
        std::vector<float> out(leaves.size(), 0);
        constexpr size_t block = 256;
        parallel_blocks(leaves.size(), block, options_.threads, [&](size_t begin, size_t end) {
            progress_.check();
            std::vector<Neighbor> found;
            for (size_t l = begin; l < end; ++l) {
                const PatchNode& patch = tree_[leaves[l]];
                if (surfaces_[leaves[l]].unknown()) continue;
                if (surfaces_[leaves[l]].cut) {
                    // A smaller distance leaves out less.
                    out[l] = cut_contrast;
                    continue;
                }
                const Disc disc{patch.center, patch.normal, 4 * patch.radius};
                near.nearest(disc, neighbors, found, [&](uint32_t i) {
                    const uint32_t other = leaves[near.order()[i]];
                    return !surfaces_[other].unknown() && disc.same_sheet(tree_[other].center, tree_[other].normal);
                });
                const float own = mean(light_.total[leaves[l]]);
                for (const Neighbor& n : found) {
                    const float other = mean(light_.total[leaves[near.order()[n.index]]]);
                    out[l] = std::max(out[l], std::fabs(own - other) / (0.5f * (own + other) + floor));
                }
            }
        });
        return out;
    }

    void finish(SolvedRadiosity& out) {
        const Exchanges exchanges(tree_, links_);
        RadiositySystem system(tree_, surfaces_, exchanges, options_.threads);
        const std::vector<float> sums = system.row_sums();
        double error = 0, power = 0;
        for (const uint32_t i : tree_.leaves()) {
            const double arrives = double(tree_[i].area) * mean(light_.total[i]);
            error += arrives * std::fabs(sums[i] - surfaces_[i].closure);
            power += arrives;
        }
        out.closure_error = power > 0 ? static_cast<float>(error / power) : 0;
        system.balance(1e-3f, 50, progress_);
        const bool shoot = options_.solver == RadiositySolver::shooting && options_.bounces < 0;
        light_ = shoot ? solve_by_shooting(system, {}, progress_)
                       : solve_by_gathering(system, {SolveLimits{}.residual, sweeps()}, progress_);
        if (options_.bounces < 0) refine_locally(system, light_, progress_);
        out.links = links_.size();
        out.tolerance = tolerance_;
        out.sweeps = static_cast<uint64_t>(light_.sweeps);
        out.residual = light_.residual;
        for (const uint32_t i : tree_.leaves()) {
            const PatchSurface& s = surfaces_[i];
            out.patches.push_back({tree_.name(i), light_.direct[i], light_.total[i], s.albedo, s.emitted,
                                   system.let_through(i, light_.total), s.unknown() || s.cut});
        }
        std::sort(out.patches.begin(), out.patches.end(), [](const SolvedPatch& a, const SolvedPatch& b) {
            if (a.name.triangle != b.name.triangle) return a.name.triangle < b.name.triangle;
            if (a.name.back != b.name.back) return b.name.back;
            return a.name.path < b.name.path;
        });
    }

    const World& world_;
    const RadiosityOptions& options_;
    Progress& progress_;
    float tolerance_ = 0;        // in effect for the present links
    std::vector<float> scales_;  // by how much the patches of each side may be longer
    float face_size_;            // width of clusters at which links end
    PatchTree tree_;
    std::vector<PatchSurface> surfaces_;  // surface of each node
    std::vector<Link> links_;
    PatchLight light_;
};

}  // namespace

std::vector<std::array<Vec3, 3>> patch_corners(const Geometry& geometry, std::span<const SolvedPatch> patches) {
    std::vector<PatchName> names;
    names.reserve(patches.size());
    for (const SolvedPatch& p : patches) names.push_back(p.name);
    const PatchTree tree(geometry, names);
    std::vector<std::array<Vec3, 3>> corners;
    corners.reserve(names.size());
    for (const PatchName& name : names) corners.push_back(std::to_array(tree[tree.find(name)].corner));
    return corners;
}

SolvedRadiosity solve_radiosity(const World& world, const RadiosityOptions& options, Progress& progress) {
    return Solver(world, options, progress).run();
}

}  // namespace eclat

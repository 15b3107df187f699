// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Refinement of links by the light that they carry [Hanrahan91]: a link is accurate enough if radiosity times form
// factor (BF) times the uncertainty is small, whatever the sizes of the nodes. The uncertainty consists of the
// variation of the exchange over the two nodes, and of partial occlusion between them.
//
// Symbol     name here          meaning                                                                  unit
//   B        radiosity_         radiosity of a node                                                      W m⁻²
//   F        form_factor        share of the sender's radiosity that arrives, at the best angles         1
//   B F      pair.carried       irradiance that may be carried, the greater of both ways                 W m⁻²
//   u        pair.uncertain     relative variation of the exchange over both nodes, at most 1            1
//   v        partly_hidden      the same of what is hidden, 0 where all or nothing is                    1
//   ε        tolerance          irradiance that may be wrong by one link                                 W m⁻²
//   s        spread             area of the receiver over the area that counts, see patch_importance.h   1
//   T                           transmittance along a ray: 1, 0, or that of panes                        1
//   P        stopped            share of light that a pane stops, relative to its mean; 1 for others     1
//   V        link.visibility    mean of T P_a P_b over rays: share of the exchange that arrives          1
//   A F V    link.exchange      what is exchanged, per radiosity                                         m²
// There is one rule: a link is divided if B F s (u + v) > ε: the patches of a ground that reaches to the horizon are wide, so
// little irradiance of theirs is much light that others would lose. It is applied three times: before rays are traced, with v =
// 0; after the rays, if they found the link partly occluded; and in later calls for links that were kept, since B has
// changed. If two clusters overlap, F cannot be computed from the distance of their centres, because a single distant
// part moves a centre away from all others. In this case F is computed from the end points of the rays, whether these
// are occluded or not.
//
// References   [Hanrahan91] links, BF refinement; [Smits94] clusters above the surfaces that a scene is given as
//
// Departures   A link is one number for both directions. Clusters take part as if they were patches of their mean normal;
//              how far their normals spread counts as uncertainty, so that light that matters is linked to flat parts.
//              Links go straight through panes. The pane itself takes part as a surface that is there with probability P, and
//              reflects diffusely what it mirrors.
// Held to      tests/core/methods/radiosity/test_links.cpp

#include "methods/radiosity/links.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/precision.h"
#include "methods/radiosity/form_factor.h"
#include "sampling/rng.h"

namespace eclat {

namespace {

// This is the number of links whose rays form one batch; results do not depend on it.
constexpr size_t block = 1024;

// This is the uncertainty of a partly occluded link, relative to the unoccluded one: about the standard deviation of a
// share that is uniformly distributed in 0..1.
constexpr float partly_hidden = 0.3f;

// A node whose light is below this share of the weakest sender's counts as dark.
constexpr float unlit = 1e-5f;

// These are the numbers of visibility rays: links that carry little light have few.
constexpr uint32_t least_rays = 2, usual_rays = 4, most_rays = 16;

// If hardly any pair of points of two patches face each other, because most of one patch lies below the horizon of the
// other, up to this many pairs are tried. The rest may be near and exchange much light.
constexpr uint32_t most_tries = 128;

struct Pair {
    float near;       // size of both nodes relative to their distance, 0 … 1
    float uncertain;  // relative variation of the exchange
    float carried;    // irradiance that may be carried, the larger of both directions
    float power;      // power of the brighter node, W
    bool mixed;       // whether the nodes are overlapping clusters

    /// Does the same if the exchange per area of both nodes, `kernel` in m⁻², is known.
    float carried_by(float kernel) const { return std::max(carried, power * kernel); }
};

class Refiner {
  public:
    Refiner(const World& world, const PatchTree& tree, std::span<const PatchSurface> surfaces,
            const ExposedParts& exposed, std::span<const float> radiosity, const LinkOptions& options,
            Progress& progress)
        : world_(world),
          tree_(tree),
          surfaces_(surfaces),
          exposed_(exposed),
          radiosity_(radiosity),
          options_(options),
          progress_(progress) {}

    struct Decided {
        std::vector<Link> kept, next;
    };

    Decided decide(std::span<const Link> links) {
        Decided out;
        for (const Link& link : links) {
            if (link.a == link.b) {
                divide_self(link.a, out.next);
                continue;
            }
            if (!exposed_.any(link.a) || !exposed_.any(link.b) || !may_see(tree_[link.a], tree_[link.b])) continue;
            const Pair pair = look_at(link);
            const float weight = pair.carried_by(link.kernel) / options_.tolerance;
            if (link.visibility < 0) {
                ask_or_divide(link, pair, weight, out.next);
                continue;
            }
            const float unsure = pair.uncertain + (link.in_part ? partly_hidden : 0);
            if (!(weight * unsure > 1 && divide(link, out.next))) out.kept.push_back(link);
        }
        trace(out);
        return out;
    }

  private:
    /// Traces two sets of `rays` for a link: one decides whether it is partly occluded, and the other measures its
    /// visibility. If both were the same, links whose few rays are all occluded would be kept as occluded, and links
    /// with a visible ray would be replaced by more accurate ones, so that nearly all light through keyholes would be
    /// lost.
    struct Asked {
        Link link;
        Pair pair;
        size_t first_ray, first_measuring, rays;
    };

    void ask_or_divide(const Link& link, const Pair& pair, float weight, std::vector<Link>& next) {
        const bool ends = tree_[link.a].ends_links && tree_[link.b].ends_links;
        // A link that carries less than half of the tolerance is never divided, because u + v ≤ 1.3, so two rays
        // suffice. The visibility measured by n rays has a standard deviation of at most 1 / (2 √n), a quarter for the
        // usual four rays. For links that carry more than four times the tolerance, this error would exceed the
        // tolerance, so more rays are needed if the link cannot be divided.
        const bool most = pair.mixed || (ends && weight > 4);
        const uint32_t rays = most ? most_rays : weight < 0.5f ? least_rays : usual_rays;
        if (weight * pair.uncertain > 1 && divide(link, next)) return;
        ask(link, pair, rays);
    }

    void divide_self(uint32_t node, std::vector<Link>& next) const {
        if (tree_[node].ends_links || !tree_[node].is_cluster()) return;  // flat, or about
        const uint32_t child = tree_[node].child;
        next.push_back({child, child});
        next.push_back({child, child + 1});
        next.push_back({child + 1, child + 1});
    }

    /// Divides a link into links of the halves of the larger node, or of the other node if the larger one has no
    /// halves.
    bool divide(const Link& link, std::vector<Link>& next) const {
        const PatchNode &a = tree_[link.a], &b = tree_[link.b];
        if (a.ends_links && b.ends_links) return false;
        const bool at_a = b.ends_links || (!a.ends_links && a.radius >= b.radius);
        for (const uint32_t half : {0u, 1u})
            next.push_back(at_a ? Link{a.child + half, link.b} : Link{link.a, b.child + half});
        return true;
    }

    Pair look_at(const Link& link) const {
        const PatchNode &a = tree_[link.a], &b = tree_[link.b];
        const Vec3 between = b.center - a.center;
        const float d2 = length_squared(between), reach = a.radius + b.radius;
        float cos_a = 1, cos_b = 1;
        if (d2 > sqr(reach)) {
            const float d = std::sqrt(d2), slack = std::asin(reach / d);
            cos_a = best_cosine(dot(a.normal, between) / d, a.cone + slack);
            cos_b = best_cosine(-dot(b.normal, between) / d, b.cone + slack);
        }
        Pair pair;
        pair.near = d2 > 0 ? std::min(1.0f, reach / std::sqrt(d2)) : 1;
        // A cosine varies by at most as much as its angle. Half of each cone is used by judgement, because normals are
        // distributed around their mean.
        pair.uncertain = std::min(1.0f, pair.near + 0.5f * (a.cone + b.cone));
        // If neither node has light, as inside solids, the link needs no accuracy.
        const bool dark = std::max(radiosity_[link.a], radiosity_[link.b]) < unlit * options_.least_sender;
        const float least = dark ? 0 : options_.least_sender;
        const auto sent = [&](uint32_t from, const PatchNode& sender, const PatchNode& receiver) {
            const float form_factor = cos_a * cos_b * sender.area / (pi * d2 + sender.area);
            return std::max(radiosity_[from], least) * form_factor * receiver.spread;
        };
        pair.carried = std::max(sent(link.a, a, b), sent(link.b, b, a));
        pair.power = std::max(std::max(radiosity_[link.a], least) * a.area * b.spread,
                              std::max(radiosity_[link.b], least) * b.area * a.spread);
        pair.mixed = d2 <= sqr(reach) && (a.is_cluster() || b.is_cluster());
        return pair;
    }

    /// Returns the cosine of an angle that is reduced by `slack`.
    static float best_cosine(float cosine, float slack) {
        return std::cos(std::max(0.0f, std::acos(clamp(cosine, -1, 1)) - slack));
    }

    void ask(const Link& link, const Pair& pair, uint32_t count) {
        // If points of the two nodes may be close to each other, single pairs would have too much weight, so the smooth
        // kernel is used, which has no peaks. At distances above ten times the extent of both nodes, distances vary by
        // at most a tenth and the kernel by a fifth.
        const bool near_clusters = pair.near > 0.1f && (tree_[link.a].is_cluster() || tree_[link.b].is_cluster());
        // The exchange of clusters is a mean over a number of pairs, which must not depend on what they find.
        const bool patches = !tree_[link.a].is_cluster() && !tree_[link.b].is_cluster();
        const auto send = [&](uint32_t seed) {
            const size_t before = rays_.size();
            const auto goes_on = [&](uint32_t i) {
                return i < count || (patches && i < most_tries && rays_.size() < before + least_rays);
            };
            for (uint32_t i = 0; goes_on(i); ++i) {
                const PointPair points = exposed_.sample_pair(link.a, link.b, seed, i, count);
                const float kernel = near_clusters ? points.smooth_kernel() : points.kernel();
                if (!(kernel > 0)) continue;
                rays_.push_back(ray_between(points));
                kernels_.push_back(kernel);
                const Vec3 along = rays_.back().direction;
                stopped_.push_back(stopped_at(points.on_x, points.x, along) * stopped_at(points.on_y, points.y, along));
            }
        };
        const size_t first = rays_.size();
        send(stream_seed(options_.seed, Stream::link_decisions));
        const size_t measuring = rays_.size();
        send(options_.seed);
        asked_.push_back({link, pair, first, measuring, count});
    }

    Ray ray_between(const PointPair& p) const {
        const Vec3 from = p.x + p.normal_x * world_.geometry.ray_offset(p.on_x->triangle);
        const Vec3 to = p.y + p.normal_y * world_.geometry.ray_offset(p.on_y->triangle) - from;
        const float distance = length(to);
        return {from, 0, to / distance, distance * shadow_shortening};
    }

    float stopped_at(const PatchNode* patch, Vec3 position, Vec3 direction) const {
        const float stops = surfaces_.empty() ? 1 : surfaces_[size_t(patch - tree_.nodes().data())].stops;
        return stopped(world_.geometry, patch->triangle, stops, position, direction);
    }

    void trace(Decided& out) {
        passed_.resize(rays_.size());
        // Light is exchanged in both directions, so the backs of surfaces occlude even if they are culled.
        world_.geometry.rays().transmitted(rays_, passed_, Backs::met);
        progress_.count_rays(rays_.size());
        for (size_t i = 0; i < asked_.size(); ++i) {
            Asked& asked = asked_[i];
            const size_t end = i + 1 < asked_.size() ? asked_[i + 1].first_ray : rays_.size();
            Link& link = asked.link;
            link.in_part = hidden_in_part(asked);
            measure(asked, end);
            if (asked.pair.mixed) link.kernel = mean_kernel(asked);
            const float unsure = asked.pair.uncertain + (link.in_part ? partly_hidden : 0);
            const bool known_better = link.in_part || asked.pair.mixed;
            if (known_better && asked.pair.carried_by(link.kernel) * unsure > options_.tolerance &&
                divide(link, out.next))
                continue;
            out.kept.push_back(link);
        }
        asked_.clear();
        rays_.clear();
        kernels_.clear();
        stopped_.clear();
    }

    /// Returns whether the deciding rays find much less light at some places than at others. Panes take a few hundredths,
    /// for which links beside their frames need not be divided.
    bool hidden_in_part(const Asked& asked) const {
        float least = infinity, most = 0;
        for (size_t r = asked.first_ray; r < asked.first_measuring; ++r) {
            least = std::min(least, mean(passed_[r]));
            most = std::max(most, mean(passed_[r]));
        }
        return least < 0.5f * most;
    }

    /// Returns the mean over the pairs of points that decide whether a link is divided.
    float mean_kernel(const Asked& asked) const {
        float sum = 0;
        for (size_t r = asked.first_ray; r < asked.first_measuring; ++r) sum += kernels_[r];
        return sum / static_cast<float>(asked.rays);
    }

    /// Computes the exchange and the visibility of a link from its measuring rays, which end at `end`.
    void measure(Asked& asked, size_t end) const {
        Link& link = asked.link;
        const PatchNode &a = tree_[link.a], &b = tree_[link.b];
        float all = 0, seen = 0;
        Color arrives;
        for (size_t r = asked.first_measuring; r < end; ++r) {
            all += kernels_[r];
            if (is_black(passed_[r])) continue;
            const float weight = kernels_[r] * stopped_[r];
            seen += weight * mean(passed_[r]);
            arrives += weight * passed_[r];
        }
        link.tint = seen > 0 ? arrives / seen : Color(1);
        link.visibility = all > 0 ? seen / all : 0;
        if (!a.is_cluster() && !b.is_cluster()) {
            link.exchange = patch_exchange(a, b, asked.pair.near) * link.visibility;
        } else {
            const float mean = seen / static_cast<float>(asked.rays);
            link.exchange = std::min(a.area * b.area * mean, std::min(a.area, b.area));
        }
    }

    const World& world_;
    const PatchTree& tree_;
    std::span<const PatchSurface> surfaces_;
    const ExposedParts& exposed_;
    std::span<const float> radiosity_;
    const LinkOptions& options_;
    Progress& progress_;
    std::vector<Asked> asked_;
    std::vector<Ray> rays_;
    std::vector<float> kernels_;  // kernel of each ray
    std::vector<float> stopped_;  // share of each ray's light that panes at its ends stop, relative to their means
    std::vector<Color> passed_;   // transmittance along each ray
};

}  // namespace

std::vector<Link> first_links(const PatchTree& tree) {
    return tree.nodes().empty() ? std::vector<Link>{} : std::vector<Link>{{0, 0}};
}

float refine_links(const World& world, const PatchTree& tree, std::span<const PatchSurface> surfaces,
                   std::span<const float> radiosity, const LinkOptions& options, std::vector<Link>& links,
                   Progress& progress) {
    LinkOptions now = options;
    const ExposedParts exposed(tree, surfaces);
    std::vector<Link> kept, pending = std::move(links);
    while (!pending.empty()) {
        // The cube is chosen by judgement: a lower power leaves too many links, and a higher one too few.
        const double crowd = static_cast<double>(kept.size() + pending.size()) / static_cast<double>(options.most);
        if (crowd > 1)
            now.tolerance = std::max(now.tolerance, options.tolerance * static_cast<float>(crowd * crowd * crowd));
        const size_t blocks = (pending.size() + block - 1) / block;
        progress.begin(blocks);
        const auto decided = parallel_map<Refiner::Decided>(blocks, options.threads, [&](size_t i) {
            progress.check();
            const size_t begin = i * block;
            const std::span<const Link> some(pending.data() + begin, std::min(block, pending.size() - begin));
            auto out = Refiner(world, tree, surfaces, exposed, radiosity, now, progress).decide(some);
            progress.advance();
            return out;
        });
        pending.clear();
        for (const auto& d : decided) {
            kept.insert(kept.end(), d.kept.begin(), d.kept.end());
            pending.insert(pending.end(), d.next.begin(), d.next.end());
        }
    }
    links = std::move(kept);
    return now.tolerance;
}

Exchanges::Exchanges(const PatchTree& tree, std::span<const Link> links) : first_(tree.nodes().size() + 1, 0) {
    for (const Link& link : links) {
        if (!(link.exchange > 0)) continue;
        ++first_[link.a + 1];
        ++first_[link.b + 1];
    }
    for (size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    senders_.resize(first_.back());
    std::vector<size_t> next(first_.begin(), first_.end() - 1);
    for (const Link& link : links) {
        if (!(link.exchange > 0)) continue;
        senders_[next[link.a]++] = {link.b, link.exchange / tree[link.a].area, link.visibility, link.tint};
        senders_[next[link.b]++] = {link.a, link.exchange / tree[link.b].area, link.visibility, link.tint};
    }
}

}  // namespace eclat

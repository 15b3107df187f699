// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light that comes straight from lights. It is found in two ways: a vertex samples the lights, and rays that continue the path
// hit them. Multiple importance sampling weights the two so that together they count all light once [Veach97 §9].

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "transport/vertex.h"

namespace eclat {

/// Shadow rays, and the contributions of those that are not occluded.
class Shadows {
  public:
    /// Adds a shadow ray. `index` identifies the receiver of the contribution; `direct` tells that the light arrives
    /// straight at the first vertex.
    void push(const Ray& ray, Color contribution, uint32_t index, bool direct);
    /// Traces all rays and calls `add(index, contribution, direct)` for each ray that is not fully occluded, in the
    /// order in which they were added; panes reduce the contribution. The rays are then removed. Counts rays in
    /// `progress`.
    template <class Add>
    void resolve(const World& world, Progress& progress, const Add& add) {
        passed_.resize(rays_.size());
        world.geometry.rays().transmitted(rays_, passed_);
        progress.count_rays(rays_.size());
        for (size_t i = 0; i < waiting_.size(); ++i)
            if (!is_black(passed_[i]))
                add(waiting_[i].index, waiting_[i].contribution * passed_[i], waiting_[i].direct);
        rays_.clear();
        waiting_.clear();
    }

  private:
    struct Waiting {
        Color contribution;
        uint32_t index;
        bool direct;
    };
    std::vector<Ray> rays_;
    std::vector<Waiting> waiting_;  // pending contribution of each ray
    std::vector<Color> passed_;
};

/// The lobes by which a vertex reflects light samples.
struct LitLobes {
    LobeSet alone;           // lobes for which light is found only by light samples
    LobeSet shared;          // lobes for which continued rays also find light, so that both are weighted
    bool has_shared = true;  // false if the light that the shared lobes reflect is counted elsewhere
    int paths = 1;           // number of paths that continue
    int light_samples = 1;   // number of light samples of this vertex
};

/// A light sample that a vertex asks for. The path and the vertex are those of the caller, as they are when it is taken.
struct WantedLight {
    const PathState* path;
    const Vertex* vertex;
    Sampler sampler;
    LitLobes lobes;
    bool direct;              // whether the light arrives straight at the first vertex
    bool all_lights = false;  // whether it is a sample of all lights, whatever the paths leave out
};

/// The lights as paths find them. Only this class decides which lights are sampled.
class DirectLight {
  public:
    DirectLight(const World& world, LightSet set) : world_(world), set_(set) {}

    /// Sets the light that arrives at the vertex straight from a light, without the share that light samples count.
    void arrive(const PathState& path, Vertex& vertex) const;

    /// Takes light samples, multiplies them by the throughputs of their paths, and adds their shadow rays to `shadows`
    /// in the same order.
    void sample(std::span<const WantedLight> wanted, Shadows& shadows) const;

  private:
    void reflect(const WantedLight& wanted, const LightSample& light, Shadows& shadows) const;
    Color from_behind_everything(const PathState& path, Vec3 w) const;
    Color from_surface(const PathState& path, const Vertex& vertex) const;
    LightSet set(bool all_lights) const { return all_lights ? LightSet::all : set_; }

    const World& world_;
    LightSet set_;
};

/// The number of dimensions of a path's sampler that the light samples of a vertex use.
constexpr uint32_t light_sample_dimensions = 2;

/// Radiance times cosine divided by density, for one light sample at a point, before its shadow ray.
struct ShadowRay {
    Ray ray;
    Color contribution;
};
/// Takes a light sample at a point with normal `n`; returns nothing if no light can arrive.
std::optional<ShadowRay> sample_irradiance(const World& world, const SurfacePoint& point, Vec3 n, LightSet set,
                                           Sampler& sampler);

}  // namespace eclat

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

/// Rays towards lights, and what they bring where nothing is in between.
class Shadows {
  public:
    /// `index` names who gets the contribution; `direct` says that the light went straight to the first vertex.
    void push(const Ray& ray, Color contribution, uint32_t index, bool direct);
    /// `add(index, contribution, direct)` for each of which something arrives, through panes less than all, in the order in
    /// which they came, and forgets all.
    /// Counts rays in `progress`.
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
    std::vector<Waiting> waiting_;  // for each ray
    std::vector<Color> passed_;
};

/// By which lobes a vertex reflects light samples.
struct LitLobes {
    LobeSet alone;           // light samples are the only way in which they find lights
    LobeSet shared;          // so do directions that the path goes on in, and both are weighted
    bool has_shared = true;  // false: what the shared lobes reflect is counted elsewhere
    int paths = 1;           // that go on
    int light_samples = 1;   // of this vertex
};

/// The lights as paths find them. The only place that knows which lights are sampled.
class DirectLight {
  public:
    DirectLight(const World& world, LightSet set) : world_(world), set_(set) {}

    /// Sets what arrives at the vertex straight from a light, in so far as light samples have not counted it.
    void arrive(const PathState& path, Vertex& vertex) const;

    /// A light sample of `vertex`, times the path's throughput, with its shadow ray in `shadows`.
    void sample(const PathState& path, Sampler sampler, const Vertex& vertex, const LitLobes& lobes, bool direct,
                Shadows& shadows) const;

  private:
    Color from_behind_everything(const PathState& path, Vec3 w) const;
    Color from_surface(const PathState& path, const Vertex& vertex) const;

    const World& world_;
    LightSet set_;
};

/// Dimensions of a path's sampler that light samples of a vertex use.
constexpr uint32_t light_sample_dimensions = 2;

/// Radiance times cosine over density from one light sample at a point, before its shadow ray.
struct ShadowRay {
    Ray ray;
    Color contribution;
};
/// For a point with normal `n`; nothing where no light can arrive.
std::optional<ShadowRay> sample_irradiance(const World& world, const SurfacePoint& point, Vec3 n, LightSet set,
                                           Sampler& sampler);

}  // namespace eclat

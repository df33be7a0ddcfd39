// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Inflow: the hyperchaotic traffic of the paper's appendix, or a recorded trace.
///
/// Makes the vehicles that come, second by second and approach by approach. It knows no junction, no queue and no
/// controller. Double precision; one integrator step of 0.01 is one simulated second.
///
/// x' = a(y - x) - e w,  y' = x z - h y,  z' = b - x y - c z,  w' = k y - d w  (paper, appendix)

#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace elmopp {

using State = std::array<double, 4>;

enum class Integrator { rk4, euler };
enum class Mapping { abs, shift };
enum class Scope { per_inroad, total };

constexpr double time_step = 0.01;
constexpr std::size_t training_points = 8000;    ///< points before the simulated second 0
constexpr std::size_t simulated_points = 2000;   ///< over which the vehicles are normalised
constexpr std::size_t trajectory_points = 10150; ///< the oracle looks up to 150 s beyond the end

/// SplitMix64 (Steele, Lea and Flood 2014): std distributions are not portable, this is.
class SplitMix64 {
  public:
    explicit SplitMix64(std::uint64_t state) : state_(state) {}
    std::uint64_t next();
    /// Uniform in [0, 1): the upper 53 bits.
    double uniform();

  private:
    std::uint64_t state_;
};

/// The printed system's parameters.
namespace parameters {
constexpr double a = 5.0, b = 20.0, c = 1.0, d = 0.1, e = 20.6, h = 1.0, k = 0.1;
}

/// s + step * slope.
State along(const State &s, const State &slope, double step);

/// Right-hand side of the printed system.
State derivative(const State &s);

/// One step of time_step.
State advance(Integrator integrator, const State &s);

/// A trial's trajectories: one for every four approaches, from one stream; points[0] is the drawn state.
struct Trajectory {
    std::vector<std::vector<State>> parts;
    unsigned random_vehicles; ///< 200..1000, from the draw that follows
};

/// Draws the trial's initial states from seed * 2^32 + trial; a trajectory that leaves |s| <= 1e6 is drawn again.
Trajectory draw_trajectory(Integrator integrator, std::uint64_t seed, std::uint64_t trial, std::size_t approaches);

/// Vehicles per second and approach if one vehicle came to each approach in the simulated seconds: [approach][point].
/// `abs`: |s_i|; `shift`: s_i minus its minimum over the trajectory. Divided by the sum over the simulated points.
using Series = std::vector<std::vector<double>>;
Series unit_inflow(const Trajectory &trajectory, Mapping mapping, std::size_t approaches);

/// Vehicles that come to one approach when the point of the grid is `vehicles`.
double vehicles_per_approach(Scope scope, double vehicles, std::size_t approaches);

/// Reads `t_s,NAME,...` with one row a second from 0 on. Throws BadRequest naming line, column and value.
Series read_trace(const std::filesystem::path &file, const std::vector<std::string> &approaches);

} // namespace elmopp

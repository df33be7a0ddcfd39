// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "inflow.hpp"

#include "csv.hpp"
#include "error.hpp"

#include <algorithm>
#include <cmath>

namespace elmopp {
namespace {

constexpr double escape = 1e6;
constexpr double most_vehicles_per_s = 10000.0;

bool bounded(const State &s) {
    // A NaN fails the comparison too.
    return std::all_of(s.begin(), s.end(), [](double value) { return std::abs(value) <= escape; });
}

bool integrate(Integrator integrator, State state, std::vector<State> &points) {
    for (auto &point : points) {
        if (!bounded(state)) {
            return false;
        }
        point = state;
        state = advance(integrator, state);
    }
    return true;
}

double mapped(Mapping mapping, double value, double lowest) {
    return mapping == Mapping::abs ? std::abs(value) : value - lowest;
}

} // namespace

std::uint64_t SplitMix64::next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
}

double SplitMix64::uniform() {
    return static_cast<double>(next() >> 11U) * 0x1.0p-53;
}

State along(const State &s, const State &slope, double step) {
    return {s[0] + step * slope[0], s[1] + step * slope[1], s[2] + step * slope[2], s[3] + step * slope[3]};
}

State derivative(const State &s) {
    using namespace parameters;
    const auto [x, y, z, w] = s;
    return {a * (y - x) - e * w, x * z - h * y, b - x * y - c * z, k * y - d * w};
}

State advance(Integrator integrator, const State &s) {
    const State k1 = derivative(s);
    if (integrator == Integrator::euler) {
        return along(s, k1, time_step);
    }
    const State k2 = derivative(along(s, k1, time_step / 2));
    const State k3 = derivative(along(s, k2, time_step / 2));
    const State k4 = derivative(along(s, k3, time_step));
    State next = s;
    for (std::size_t i = 0; i < next.size(); ++i) {
        next[i] += time_step / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    return next;
}

Trajectory draw_trajectory(Integrator integrator, std::uint64_t seed, std::uint64_t trial, std::size_t approaches) {
    SplitMix64 random((seed << 32U) + trial);
    Trajectory trajectory{};
    for (std::size_t part = 0; part < (approaches + 3) / 4; ++part) {
        std::vector<State> points(trajectory_points);
        State start{};
        do {
            std::generate(start.begin(), start.end(), [&random] { return random.uniform(); });
        } while (!integrate(integrator, start, points));
        trajectory.parts.push_back(std::move(points));
    }
    trajectory.random_vehicles = 200U + static_cast<unsigned>(random.uniform() * 801.0);
    return trajectory;
}

Series unit_inflow(const Trajectory &trajectory, Mapping mapping, std::size_t approaches) {
    Series series(approaches, std::vector<double>(trajectory_points));
    for (std::size_t i = 0; i < approaches; ++i) {
        const auto &points = trajectory.parts[i / 4];
        const std::size_t component = i % 4;
        const auto less = [component](const State &a, const State &b) { return a[component] < b[component]; };
        const double lowest = (*std::min_element(points.begin(), points.end(), less))[component];
        double sum = 0.0;
        for (std::size_t t = 0; t < trajectory_points; ++t) {
            series[i][t] = mapped(mapping, points[t][component], lowest);
            sum += t >= training_points && t < training_points + simulated_points ? series[i][t] : 0.0;
        }
        for (double &value : series[i]) {
            value /= sum;
        }
    }
    return series;
}

double vehicles_per_approach(Scope scope, double vehicles, std::size_t approaches) {
    return scope == Scope::per_inroad ? vehicles : vehicles / static_cast<double>(approaches);
}

Series read_trace(const std::filesystem::path &file, const std::vector<std::string> &approaches) {
    const CsvTable table = read_csv(file);
    std::vector<std::string> wanted{"t_s"};
    wanted.insert(wanted.end(), approaches.begin(), approaches.end());
    if (table.header == std::vector<std::string>{"t", "x", "y", "z", "w"}) {
        throw BadRequest(file.string() + ": columns t,x,y,z,w are a raw trajectory, not traffic; make a trace with "
                                         "host_sim inflow --mapping abs");
    }
    if (table.header != wanted) {
        throw BadRequest(file.string() + ": columns " + join(table.header) + " do not fit the site; right would be " +
                         join(wanted));
    }
    Series series(approaches.size());
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        if (table.number(row, 0) != static_cast<double>(row)) {
            throw BadRequest(table.place(row, 0) + ": \"" + table.rows[row][0] + "\"; right would be " +
                             std::to_string(row) + ", the seconds count from 0 without a gap");
        }
        for (std::size_t i = 0; i < approaches.size(); ++i) {
            const double value = table.number(row, i + 1);
            if (value < 0.0 || value > most_vehicles_per_s) {
                throw BadRequest(table.place(row, i + 1) + ": \"" + table.rows[row][i + 1] +
                                 "\"; right would be a number of vehicles from 0 to 10000");
            }
            series[i].push_back(value);
        }
    }
    if (table.rows.empty()) {
        throw BadRequest(file.string() + ": no rows; right would be one row a second");
    }
    return series;
}

} // namespace elmopp

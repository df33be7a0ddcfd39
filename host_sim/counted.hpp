// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Counted: what there is to count at one junction after a second, by movement, whatever the traffic is made of.
///
/// It is all that a controller's counts, a log and the metrics know of a world.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace elmopp {

class Counted {
  public:
    /// Vehicles inside the counted reach.
    [[nodiscard]] const std::vector<double> &queue_veh() const {
        return queue_veh_;
    }
    /// Vehicles for which there is no room yet.
    [[nodiscard]] const std::vector<double> &outside_veh() const {
        return outside_veh_;
    }
    /// In the last second.
    [[nodiscard]] const std::vector<double> &arrived_veh() const {
        return arrived_veh_;
    }
    /// In the last second.
    [[nodiscard]] const std::vector<double> &left_veh() const {
        return left_veh_;
    }

    /// Whether a vehicle stands inside the junction, as its camera would see it. Nothing where vehicles have no place
    /// there, as a fluid has none: what is not known is not sent to anybody.
    [[nodiscard]] std::optional<bool> junction_occupied() const {
        return junction_occupied_;
    }

  protected:
    explicit Counted(std::size_t movements)
        : queue_veh_(movements), outside_veh_(movements), arrived_veh_(movements), left_veh_(movements) {}
    Counted(const Counted &) = default;
    Counted(Counted &&) = default;
    Counted &operator=(const Counted &) = default;
    Counted &operator=(Counted &&) = default;
    ~Counted() = default;

    std::vector<double> queue_veh_;
    std::vector<double> outside_veh_;
    std::vector<double> arrived_veh_;
    std::vector<double> left_veh_;
    std::optional<bool> junction_occupied_;
};

} // namespace elmopp

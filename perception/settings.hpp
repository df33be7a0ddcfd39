// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The defaults that decide most, in one place, so that they can be chosen anew: tools/score-counter --leave-one-out
/// tries others (elmopp-camera --try NAME=VALUE). One set for all cameras; a lane file cannot change them.

#pragma once

#include <string>

namespace elmopp {

struct Settings {
    double texture = 0.07; ///< high-pass of the logarithm of picture over road from which a pixel is an edge
    double density = 0.2;  ///< share of edges around a pixel that makes it one of a vehicle
    double covered = 0.5;  ///< share of the rows at the line, and of 0.12 s, that makes a column covered
    double neck = 0.74;    ///< a saddle below this share of the lower hill parts two vehicles
    double joined = 1.6;   ///< parts in line that are shorter together, in typical vehicles, are one
    double fragment = 0.5; ///< a part smaller than this share of its neighbour belongs to it
};

/// The setting of that name, or nullptr.
inline double *setting_named(Settings &settings, const std::string &name) {
    return name == "texture"    ? &settings.texture
           : name == "density"  ? &settings.density
           : name == "covered"  ? &settings.covered
           : name == "neck"     ? &settings.neck
           : name == "joined"   ? &settings.joined
           : name == "fragment" ? &settings.fragment
                                : nullptr;
}

} // namespace elmopp

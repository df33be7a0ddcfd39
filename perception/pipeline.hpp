// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Whether a description of a GStreamer pipeline is one, before anything of it runs.
///
/// OpenCV only says that a pipeline does not open, be it that the camera is away or that an element does not exist.
/// Asked is the GStreamer that OpenCV has loaded; where it has none nothing is wrong with a pipeline, it never opens.

#pragma once

#include <string>

namespace elmopp {

/// What is wrong with it; empty: nothing that is known before it runs.
std::string pipeline_fault(const std::string &pipeline);

} // namespace elmopp

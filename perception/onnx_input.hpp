// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The size of the picture that an ONNX model wants, read from its file: OpenCV's importer keeps it to itself.
///
/// Walks the protobuf as far as the shape of the first input (ModelProto.graph.input.type.tensor_type.shape) and checks
/// nothing else. Pure.

#pragma once

#include <optional>
#include <string>
#include <vector>

namespace elmopp {

/// The sides of the first input; -1 for one that is not fixed. None: this is no model, or it has no input.
std::optional<std::vector<int>> onnx_input_shape(const std::string &model);

} // namespace elmopp

// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "onnx_input.hpp"

#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace elmopp {
namespace {

constexpr int wire_varint = 0;
constexpr int wire_fixed64 = 1;
constexpr int wire_bytes = 2;
constexpr int wire_fixed32 = 5;

/// One protobuf message, field after field.
class Message {
  public:
    explicit Message(std::string_view whole) : rest_(whole) {}

    /// The next field; false at the end, or where the bytes are none.
    bool next() {
        const std::optional<std::uint64_t> key = varint();
        if (!key) {
            return false;
        }
        constexpr unsigned wire_bits = 3;
        field = static_cast<int>(*key >> wire_bits);
        const auto wire = static_cast<int>(*key & 7U);
        if (wire == wire_varint) {
            const std::optional<std::uint64_t> read = varint();
            number = read.value_or(0);
            return read.has_value();
        }
        const std::uint64_t size = wire == wire_bytes     ? varint().value_or(rest_.size() + 1)
                                   : wire == wire_fixed64 ? 8
                                   : wire == wire_fixed32 ? 4
                                                          : rest_.size() + 1;
        if (size > rest_.size()) {
            return false;
        }
        bytes = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return true;
    }

    int field = 0;
    std::uint64_t number = 0;
    std::string_view bytes;

  private:
    std::optional<std::uint64_t> varint() {
        constexpr unsigned most_bits = 64;
        std::uint64_t value = 0;
        for (unsigned shift = 0; shift < most_bits && !rest_.empty(); shift += 7) {
            const auto byte = static_cast<unsigned char>(rest_.front());
            rest_.remove_prefix(1);
            value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
            if ((byte & 0x80U) == 0) {
                return value;
            }
        }
        return std::nullopt;
    }

    std::string_view rest_;
};

/// The first part that these fields lead to, one inside of the other.
std::optional<std::string_view> part_at(std::string_view bytes, std::initializer_list<int> path) {
    for (const int field : path) {
        Message message(bytes);
        bool found = false;
        while (!found && message.next()) {
            found = message.field == field && !message.bytes.empty();
        }
        if (!found) {
            return std::nullopt;
        }
        bytes = message.bytes;
    }
    return bytes;
}

} // namespace

std::optional<std::vector<int>> onnx_input_shape(const std::string &model) {
    constexpr std::uint64_t most = 1U << 20U;
    const auto shape = part_at(model, {7, 11, 2, 1, 2}); // graph, input, type, tensor_type, shape
    if (!shape) {
        return std::nullopt;
    }
    std::vector<int> sides;
    Message dims(*shape);
    while (dims.next()) {
        Message dim(dims.bytes);
        int side = -1;
        while (dim.next()) {
            side = dim.field == 1 && dim.number <= most ? static_cast<int>(dim.number) : side;
        }
        sides.push_back(side);
    }
    return sides;
}

} // namespace elmopp

// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "networks.hpp"

#include "error.hpp"
#include "learning.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <vector>

extern "C" {
#include "elmopp_weights.h"
}

namespace elmopp {

const elmopp_weights_t *shipped_weights(const std::string &forecast) {
    const std::string network = network_of(forecast);
    if (network == "lstm" || network == "lstm-q15" || network == "ann" || network == "gcn") {
        return &elmopp_weights_lstm;
    }
    return network == "nlstm" || network == "nlstm-q15" ? &elmopp_weights_nlstm : nullptr;
}

elmopp_weights_t weights_of_image(const std::uint8_t *image, std::size_t length) {
    elmopp_weights_t weights{};
    const auto fault = elmopp_weights_load(image, static_cast<std::uint32_t>(length), &weights);
    if (fault != ELMOPP_WEIGHTS_OK) {
        throw BadRequest(std::string(elmopp_weights_fault_name(fault)) +
                         "; right would be an image made by tools/weights");
    }
    return weights;
}

elmopp_weights_t read_weights(const std::filesystem::path &file) {
    const std::string option = "--weights " + file.string() + ": ";
    std::error_code ignored;
    std::ifstream stream(std::filesystem::is_regular_file(file, ignored) ? file : std::filesystem::path(),
                         std::ios::binary);
    if (!stream) {
        throw BadRequest(option + "cannot be read; right would be an ELMW image made by tools/weights");
    }
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    const std::vector<std::uint8_t> image(bytes.begin(), bytes.end());
    try {
        return weights_of_image(image.data(), image.size());
    } catch (const BadRequest &error) {
        throw BadRequest(option + error.what());
    }
}

std::vector<std::string> network_names(const elmopp_weights_t &weights) {
    const std::string recurrent = weights.lstm.levels == 1 ? "lstm" : "nlstm";
    std::vector<std::string> names{recurrent};
    if (elmopp_forecast_quantized(&weights).made) {
        names.push_back(recurrent + "-q15");
    }
    names.insert(names.end(), {"ann", "gcn"});
    return names;
}

bool can_forecast(const elmopp_weights_t &weights, const std::string &forecast) {
    const auto names = network_names(weights);
    return std::find(names.begin(), names.end(), network_of(forecast)) != names.end();
}

std::string networks_in(const elmopp_weights_t &weights) {
    const auto names = network_names(weights);
    std::string text = names.front();
    for (std::size_t k = 1; k < names.size(); ++k) {
        text += (k + 1 < names.size() ? ", " : " or ") + names[k];
    }
    return text;
}

std::string overflow_of(const elmopp_weights_t &weights) {
    const elmopp_lstm_quantized_t found = elmopp_forecast_quantized(&weights);
    if (found.made) {
        return "";
    }
    const std::string gate = std::string("ifog").substr(found.column / ELMOPP_LSTM_UNITS, 1);
    std::ostringstream text;
    text << "level " << found.level << ", gate " << gate << " of unit " << found.column % ELMOPP_LSTM_UNITS
         << " could reach " << found.reach << ", in whole numbers less than " << ELMOPP_LSTM_QUANTIZE_REACH_MAX;
    return text.str();
}

} // namespace elmopp

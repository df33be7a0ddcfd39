// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "csv.hpp"

#include "error.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string_view>

namespace elmopp {

double CsvTable::number(std::size_t row, std::size_t column) const {
    double value = 0.0;
    if (!parse_number(rows[row][column], value)) {
        throw BadRequest(place(row, column) + ": \"" + rows[row][column] + "\"; right would be a finite number");
    }
    return value;
}

std::string CsvTable::place(std::size_t row, std::size_t column) const {
    return file.string() + ":" + std::to_string(row + 2) + ", column " + header[column];
}

std::size_t CsvTable::column(const std::string &name) const {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) {
        throw BadRequest(file.string() + ": no column " + name + "; it has " + join(header));
    }
    return static_cast<std::size_t>(found - header.begin());
}

CsvTable read_csv(const std::filesystem::path &file) {
    std::ifstream stream(file);
    std::string line;
    if (!stream || !std::getline(stream, line)) {
        throw BadRequest(file.string() + ": cannot be read or is empty; right would be a CSV file with a header line");
    }
    const auto without_return = [](std::string text) {
        if (!text.empty() && text.back() == '\r') {
            text.pop_back();
        }
        return text;
    };
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (line.rfind(byte_order_mark, 0) == 0) {
        line.erase(0, byte_order_mark.size());
    }
    CsvTable table{file, split(without_return(line), ','), {}};
    while (std::getline(stream, line)) {
        const std::string text = without_return(line);
        if (text.empty() && stream.peek() == std::ifstream::traits_type::eof()) {
            break; // a blank line at the end
        }
        auto cells = split(text, ',');
        if (cells.size() != table.header.size()) {
            throw BadRequest(file.string() + ":" + std::to_string(table.rows.size() + 2) + ": " +
                             std::to_string(cells.size()) + " values; right would be " +
                             std::to_string(table.header.size()) + " as in the header");
        }
        table.rows.push_back(std::move(cells));
    }
    return table;
}

std::vector<std::string> split(const std::string &text, char separator) {
    std::vector<std::string> words;
    std::size_t begin = 0;
    for (std::size_t end = text.find(separator); end != std::string::npos; end = text.find(separator, begin)) {
        words.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    words.push_back(text.substr(begin));
    return words;
}

std::string join(const std::vector<std::string> &words, const std::string &separator) {
    std::string text;
    for (const auto &word : words) {
        text += (text.empty() ? "" : separator) + word;
    }
    return text;
}

bool parse_number(const std::string &text, double &value) {
    const char *const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && rest == end && std::isfinite(value);
}

std::string format_number(double value, int digits) {
    std::array<char, 40> text{};
    const int length = std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    return {text.data(), static_cast<std::size_t>(length)};
}

} // namespace elmopp

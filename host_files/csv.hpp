// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Reading of the comma-separated files that host_sim itself writes: no quoting, one header line.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace elmopp {

struct CsvTable {
    std::filesystem::path file;
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows; ///< each as long as the header

    /// The finite number in a cell. Throws BadRequest naming the place and the value.
    [[nodiscard]] double number(std::size_t row, std::size_t column) const;
    /// "FILE:LINE, column NAME", for messages.
    [[nodiscard]] std::string place(std::size_t row, std::size_t column) const;
    /// Index of a column. Throws BadRequest naming it and the columns there are.
    [[nodiscard]] std::size_t column(const std::string &name) const;
};

/// Throws BadRequest if the file cannot be read, is empty or has a row of another length.
CsvTable read_csv(const std::filesystem::path &file);

std::vector<std::string> split(const std::string &text, char separator);
std::string join(const std::vector<std::string> &words, const std::string &separator = ",");

/// The whole text as a finite number; false otherwise.
bool parse_number(const std::string &text, double &value);

/// Shortest form that keeps `digits` significant digits (printf %g): the same bytes on every machine.
std::string format_number(double value, int digits);

} // namespace elmopp

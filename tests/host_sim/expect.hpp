// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What the C++ tests of host_sim expect, in the words of Unity.

#pragma once

#include "unity.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>

/// |actual - expected| <= tolerance * |expected|.
inline void expect_relative(double expected, double actual, double tolerance, const std::string &what = "") {
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(tolerance * std::abs(expected), expected, actual, what.c_str());
}

/// The message of the expected exception; fails if another or none is thrown.
template <typename Error, typename Work> std::string message_of(const Work &work, const std::string &what = "") {
    try {
        work();
    } catch (const Error &error) {
        return error.what();
    } catch (const std::exception &error) {
        TEST_FAIL_MESSAGE((what + ": another exception: " + error.what()).c_str());
    }
    TEST_FAIL_MESSAGE((what + ": no exception").c_str());
    return "";
}

/// Every word is in the text.
inline void expect_words(const std::string &text, std::initializer_list<std::string> words) {
    for (const auto &word : words) {
        const std::string wanted = "\"" + text + "\" lacks \"" + word + "\"";
        TEST_ASSERT_TRUE_MESSAGE(text.find(word) != std::string::npos, wanted.c_str());
    }
}

/// A file with this text that goes when the test ends.
class TextFile {
  public:
    explicit TextFile(const std::string &text) {
        std::string pattern = (std::filesystem::temp_directory_path() / "elmopp-test-XXXXXX").string();
        const int descriptor = mkstemp(pattern.data());
        TEST_ASSERT_TRUE(descriptor >= 0);
        path_ = pattern;
        std::ofstream(path_) << text;
    }
    ~TextFile() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    TextFile(const TextFile &) = delete;
    TextFile &operator=(const TextFile &) = delete;
    TextFile(TextFile &&) = delete;
    TextFile &operator=(TextFile &&) = delete;

    [[nodiscard]] const std::filesystem::path &path() const {
        return path_;
    }

  private:
    std::filesystem::path path_;
};

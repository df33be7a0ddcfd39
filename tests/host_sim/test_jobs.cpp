// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Independent work on several threads: each index once, results in fixed places, the first exception comes out.

#include "expect.hpp"
#include "jobs.hpp"

#include <atomic>
#include <stdexcept>
#include <vector>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

constexpr std::size_t count = 1000;

void test_each_index_once() {
    for (const unsigned jobs : {1U, 2U, 7U, 64U}) {
        std::vector<std::atomic<unsigned>> calls(count);
        run_jobs(count, jobs, [&](std::size_t i) { ++calls[i]; }, {});
        for (const auto &number : calls) {
            TEST_ASSERT_EQUAL_UINT(1, number.load());
        }
    }
}

void test_number_of_jobs_changes_no_result() {
    const auto results = [](unsigned jobs) {
        std::vector<double> values(count);
        run_jobs(count, jobs, [&](std::size_t i) { values[i] = std::sin(static_cast<double>(i)); }, {});
        return values;
    };
    const auto alone = results(1);
    TEST_ASSERT_TRUE(alone == results(2));
    TEST_ASSERT_TRUE(alone == results(16));
}

void test_no_work_and_more_jobs_than_work() {
    run_jobs(0, 4, [](std::size_t) { TEST_FAIL_MESSAGE("there is no work"); }, {});
    std::atomic<unsigned> calls{0};
    run_jobs(2, 16, [&](std::size_t) { ++calls; }, {});
    TEST_ASSERT_EQUAL_UINT(2, calls.load());
}

void test_progress_is_told_one_by_one() {
    std::vector<std::size_t> told;
    run_jobs(count, 4, [](std::size_t) {}, [&](std::size_t done) { told.push_back(done); });
    TEST_ASSERT_EQUAL_UINT(count, told.size());
    for (std::size_t i = 0; i < count; ++i) {
        TEST_ASSERT_EQUAL_UINT(i + 1, told[i]);
    }
}

void test_exception_comes_out_and_stops_the_rest() {
    for (const unsigned jobs : {1U, 4U}) {
        std::atomic<unsigned> calls{0};
        const auto work = [&](std::size_t i) {
            ++calls;
            if (i == 10) {
                throw std::runtime_error("number 10");
            }
        };
        const auto message = message_of<std::runtime_error>([&] { run_jobs(1000000, jobs, work, {}); });
        TEST_ASSERT_EQUAL_STRING("number 10", message.c_str());
        TEST_ASSERT_TRUE(calls.load() < 1000000);
        TEST_ASSERT_TRUE(jobs > 1 || calls.load() == 11);
    }
}

void test_one_exception_of_many_comes_out() {
    const auto work = [](std::size_t i) { throw std::runtime_error("number " + std::to_string(i)); };
    const auto message = message_of<std::runtime_error>([&] { run_jobs(100, 4, work, {}); });
    expect_words(message, {"number "});
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_each_index_once);
    RUN_TEST(test_number_of_jobs_changes_no_result);
    RUN_TEST(test_no_work_and_more_jobs_than_work);
    RUN_TEST(test_progress_is_told_one_by_one);
    RUN_TEST(test_exception_comes_out_and_stops_the_rest);
    RUN_TEST(test_one_exception_of_many_comes_out);
    return UNITY_END();
}

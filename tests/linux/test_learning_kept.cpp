// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

// A station in a street, from frame to file: it learns on, what it learnt is kept by itself, and after a restart it
// says what it would have said; whatever happens to the file meanwhile, it has something to go on with.

#include "file_store.hpp"
#include "temporary_folder.hpp"

extern "C" {
#include "bench.h"
#include "elmopp/keeper.h"
#include "elmopp/station.h"
#include "elmopp_can.h"
#include "elmopp_weights.h"
#include "unity.h"
}

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <thread>
#include <vector>

void setUp(void) {}
void tearDown(void) {}

namespace {

namespace fs = std::filesystem;
using elmopp::FileCalls;
using elmopp::FileStore;
using elmopp::TemporaryFolder;

constexpr std::uint32_t save_min_s = 60;
constexpr unsigned learning_s = 1500;
constexpr unsigned listened_s = 240;
constexpr unsigned decision_ticks = ELMOPP_LAMP_TICKS_PER_S;

std::uint32_t image_bytes() {
    return ELMOPP_IMAGE_HEADER + elmopp_weights_kind()->body_bytes;
}

/// No disk is waited for.
const FileCalls quick_calls{elmopp::system_file_calls.open, elmopp::system_file_calls.write, [](int) { return 0; }};

struct Room {
    elmopp_learning_t learning{};
    elmopp_trainer_inner_memory_t inner{};
};

/// What a forecast says in a second.
using Rows = std::array<std::array<float, ELMOPP_HORIZON_MAX>, ELMOPP_APPROACH_MAX>;

/// A controller as elmopp-controller has it, on a bench instead of a bus.
class Street {
  public:
    explicit Street(const fs::path &folder, const FileCalls &calls = quick_calls)
        : files_(folder, "weights", image_bytes(), calls) {
        site_ = bench_cross(4);
        site_.chooser = ELMOPP_CHOOSER_CUMULATIVE;
        site_.forecast = ELMOPP_FORECAST_LSTM;
        site_.learning = 1;
        elmopp_keeper_config_t config{};
        config.save_min_s = save_min_s;
        config.weights = files_.medium();
        elmopp_keeper_init(&keeper_, &config);
        begin(elmopp_station_weights(&site_, &elmopp_weights_lstm, elmopp_keeper_weights(&keeper_)));
    }
    Street(const Street &) = delete;
    Street &operator=(const Street &) = delete;
    ~Street() = default;

    void begin(const elmopp_station_weights_t &weights) {
        const elmopp_station_room_t room{&room_->learning, &room_->inner};
        bench_start(&bench_, &site_);
        elmopp_station_init(&station_, &site_, &elmopp_weights_lstm.ar8, &weights, &room);
        bench_.controller = station_.controller;
    }

    void tick() {
        if (ticks_ % decision_ticks == 0) {
            come();
        }
        bench_tick(&bench_);
        ++ticks_;
        std::array<elmopp_frame_t, ELMOPP_KEEPER_FRAMES> out{};
        std::uint32_t count = 0;
        (void)elmopp_keeper_tick(&keeper_, &bench_.controller, out.data(), &count);
        work();
    }

    void seconds(unsigned count) {
        for (unsigned k = 0; k < count * decision_ticks; ++k) {
            tick();
        }
    }

    /// Until what was learnt begins to be written; what that is.
    elmopp_lstm_f32_weights_t until_stored() {
        for (unsigned k = 0; k < learning_s * decision_ticks && keeper_.lessons == 0; ++k) {
            tick();
        }
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(1, keeper_.lessons, "nothing was worth keeping");
        elmopp_lstm_f32_weights_t learnt{};
        elmopp_learner_copy(&room_->learning.learner, &learnt);
        return learnt;
    }

    void until_kept() {
        for (unsigned k = 0; k < 100 && keeper_.told.state == ELMOPP_TRANSFER_STORING; ++k) {
            tick();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }

    [[nodiscard]] Rows rows() const {
        Rows rows{};
        for (std::size_t i = 0; i < site_.approach_count; ++i) {
            std::copy(std::begin(bench_.controller.pilot.forecast.row_veh[i]),
                      std::end(bench_.controller.pilot.forecast.row_veh[i]), rows.at(i).begin());
        }
        return rows;
    }

    [[nodiscard]] std::vector<Rows> listened() {
        std::vector<Rows> said;
        for (unsigned t = 0; t < listened_s; ++t) {
            seconds(1);
            said.push_back(rows());
        }
        return said;
    }

    void on_frame(void (*heard)(const elmopp_frame_t *frame)) {
        bench_.heard = heard;
    }
    [[nodiscard]] elmopp_keeper_t &keeper() {
        return keeper_;
    }
    [[nodiscard]] const elmopp_controller_t &controller() const {
        return bench_.controller;
    }
    [[nodiscard]] const elmopp_learner_t &learner() const {
        return room_->learning.learner;
    }

    void work() {
        elmopp_transfer_kind_t kind = ELMOPP_TRANSFER_NOTHING;
        elmopp_store_order_t order{};
        for (unsigned k = 0; k < 1024 && elmopp_keeper_next(&keeper_, &kind, &order); ++k) {
            const elmopp_store_answer_t answer = files_.carry_out(order);
            elmopp_keeper_answer(&keeper_, kind, answer);
            if (answer == ELMOPP_STORE_LATER) {
                std::this_thread::sleep_for(std::chrono::microseconds(50));
            }
        }
    }

  private:
    /// Much and little by turns, a hundred seconds each: the shipped network expects it to swing, the mean is never
    /// right.
    void come() {
        constexpr unsigned turn_s = 100;
        constexpr unsigned later_s = 37;
        const unsigned t_s = ticks_ / decision_ticks;
        for (unsigned j = 0; j < site_.movement_count; ++j) {
            const bool much = ((t_s + later_s * j) / turn_s) % 2 == 0;
            bench_.arrived_veh[j] += much ? 3U : 1U;
            bench_.present_veh[j] = 3;
        }
    }

    FileStore files_;
    elmopp_junction_t site_{};
    elmopp_keeper_t keeper_{};
    elmopp_station_t station_{};
    std::unique_ptr<Room> room_ = std::make_unique<Room>();
    bench_t bench_{};
    unsigned ticks_ = 0;
};

std::unique_ptr<Street> open(const fs::path &folder, const FileCalls &calls = quick_calls) {
    return std::make_unique<Street>(folder, calls);
}

void expect_same_rows(const std::vector<Rows> &one, const std::vector<Rows> &other) {
    for (std::size_t t = 0; t < one.size(); ++t) {
        TEST_ASSERT_EQUAL_MEMORY(one[t].data(), other[t].data(), sizeof(Rows));
    }
}

/// Learns once for all tests: a folder in which it is kept, and what it is.
struct Learnt {
    TemporaryFolder folder;
    elmopp_weights_t weights = elmopp_weights_lstm;
};

Learnt &learnt() {
    static Learnt once;
    return once;
}

void test_what_a_station_learns_is_kept_by_itself() {
    const auto street = open(learnt().folder.path());
    learnt().weights.lstm = street->until_stored();
    street->until_kept();
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_KEPT, street->keeper().told.state);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, street->controller().fault);
}

void copy_folder(const fs::path &to) {
    fs::copy(learnt().folder.path(), to, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

void test_after_a_restart_it_says_what_it_would_have_said_bit_for_bit() {
    const auto again = open(learnt().folder.path());
    TEST_ASSERT_FALSE(elmopp_keeper_is_damaged(&again->keeper(), ELMOPP_TRANSFER_WEIGHTS));
    const elmopp_weights_t *kept = elmopp_keeper_weights(&again->keeper());
    TEST_ASSERT_NOT_NULL(kept);
    TEST_ASSERT_EQUAL_MEMORY(&learnt().weights, kept, sizeof *kept);
    TEST_ASSERT_TRUE(std::memcmp(&elmopp_weights_lstm, kept, sizeof *kept) != 0);
    const std::vector<Rows> said = again->listened();
    TEST_ASSERT_TRUE(elmopp_forecast_is_learnt(&again->controller().pilot.forecast));

    const TemporaryFolder empty;
    const auto told = open(empty.path());
    told->begin({&elmopp_weights_lstm, &learnt().weights}); // what was in its memory when it was kept
    expect_same_rows(told->listened(), said);

    const auto shipped = open(empty.path());
    const std::vector<Rows> other = shipped->listened();
    TEST_ASSERT_TRUE(other != said);
}

void test_after_a_restart_the_guard_falls_back_to_the_shipped_weights() {
    const auto again = open(learnt().folder.path());
    TEST_ASSERT_EQUAL_PTR(&elmopp_weights_lstm, again->learner().shipped);
    TEST_ASSERT_EQUAL_PTR(&elmopp_weights_lstm, again->controller().pilot.forecast.config.weights);
}

/// A forecast's frame says whose weights it is by.
std::array<unsigned, 16> models{};

void hear_model(const elmopp_frame_t *frame) {
    elmopp_can_forecast_t forecast{};
    if (frame->id >= ELMOPP_CAN_FORECAST_FRAME_ID && frame->id < ELMOPP_CAN_FORECAST_FRAME_ID + ELMOPP_APPROACH_MAX) {
        (void)elmopp_can_forecast_unpack(&forecast, std::begin(frame->data), ELMOPP_LINK_BYTES);
        models.at(forecast.model) += 1U;
    }
}

void test_the_bus_says_whose_weights_a_forecast_is_by() {
    const auto again = open(learnt().folder.path());
    models = {};
    again->on_frame(hear_model);
    again->seconds(ELMOPP_FORECAST_COLD_S + 20);
    TEST_ASSERT_TRUE(models.at(ELMOPP_MODEL_LEARNT) > 0);
    TEST_ASSERT_EQUAL_UINT(0U, models.at(ELMOPP_FORECAST_LSTM));
    const TemporaryFolder empty;
    const auto shipped = open(empty.path());
    models = {};
    shipped->on_frame(hear_model);
    shipped->seconds(ELMOPP_FORECAST_COLD_S + 20);
    TEST_ASSERT_EQUAL_UINT(0U, models.at(ELMOPP_MODEL_LEARNT));
    TEST_ASSERT_TRUE(models.at(ELMOPP_FORECAST_LSTM) > 0);
}

void test_it_is_kept_again_after_a_while_and_not_before() {
    const TemporaryFolder folder;
    copy_folder(folder.path());
    const auto street = open(folder.path());
    (void)street->until_stored();
    street->until_kept();
    TEST_ASSERT_EQUAL_UINT16(1, street->keeper().saved);
    street->seconds(save_min_s - 12);
    TEST_ASSERT_EQUAL_UINT16(1, street->keeper().lessons);
    street->seconds(40);
    TEST_ASSERT_EQUAL_UINT16(2, street->keeper().lessons);
}

/// Call number `failing` and all that follow fail: the power has gone.
int calls = 0;
int failing = -1;

bool fails() {
    const bool now = failing >= 0 && calls >= failing;
    calls++;
    errno = EIO;
    return now;
}

const FileCalls cut_calls{[](const char *path, int flags, mode_t mode) {
                              return fails() ? -1 : elmopp::system_file_calls.open(path, flags, mode);
                          },
                          [](int descriptor, const void *bytes, std::size_t length) {
                              return fails() ? ssize_t{-1}
                                             : elmopp::system_file_calls.write(descriptor, bytes,
                                                                               std::min<std::size_t>(length, 3000));
                          },
                          [](int) { return fails() ? -1 : 0; }};

/// The power goes at each call of a second store: the weights before or those, and nobody speaks of damage.
void test_a_loss_of_power_at_each_write_leaves_what_was_kept_before_or_after() {
    elmopp_weights_t next = learnt().weights;
    next.lstm.head_bias[0] += 0.125F;
    std::array<unsigned, 2> found{};
    bool reached = true;
    for (int at = 0; reached; ++at) {
        const TemporaryFolder folder;
        copy_folder(folder.path());
        {
            failing = -1;
            const auto street = open(folder.path(), cut_calls);
            street->seconds(save_min_s);
            calls = 0;
            failing = at;
            TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_NO_REASON,
                                  elmopp_keeper_save(&street->keeper(), &street->controller(), &next));
            street->until_kept();
            reached = calls > at;
            TEST_ASSERT_EQUAL_INT(reached ? ELMOPP_TRANSFER_REFUSED : ELMOPP_TRANSFER_KEPT,
                                  street->keeper().told.state);
        }
        const auto again = open(folder.path());
        const elmopp_weights_t *kept = elmopp_keeper_weights(&again->keeper());
        TEST_ASSERT_NOT_NULL(kept);
        const bool old = std::memcmp(kept, &learnt().weights, sizeof *kept) == 0;
        TEST_ASSERT_TRUE(old || std::memcmp(kept, &next, sizeof *kept) == 0);
        TEST_ASSERT_FALSE(elmopp_keeper_is_damaged(&again->keeper(), ELMOPP_TRANSFER_WEIGHTS));
        TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&again->learner()));
        found.at(old ? 0 : 1)++;
    }
    TEST_ASSERT_TRUE(found[0] > 10 && found[1] > 1);
}

void flip(const fs::path &file, std::streamoff at) {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekg(at);
    const int byte = stream.get();
    stream.seekp(at);
    stream.put(static_cast<char>(static_cast<unsigned>(byte) ^ 0x10U));
}

void test_weights_that_were_damaged_where_they_lay_are_told_and_the_shipped_ones_run() {
    const fs::path newest = learnt().folder.path() / "weights.0";
    TEST_ASSERT_TRUE(fs::exists(newest));
    const auto length = static_cast<std::streamoff>(fs::file_size(newest));
    for (const std::streamoff at : {std::streamoff{16}, std::streamoff{24}, length / 2, length - 5}) {
        const TemporaryFolder folder;
        copy_folder(folder.path());
        flip(folder.path() / "weights.0", at);
        const auto street = open(folder.path());
        TEST_ASSERT_TRUE(elmopp_keeper_is_damaged(&street->keeper(), ELMOPP_TRANSFER_WEIGHTS));
        TEST_ASSERT_FALSE(elmopp_keeper_is_damaged(&street->keeper(), ELMOPP_TRANSFER_SITE));
        TEST_ASSERT_NULL(elmopp_keeper_weights(&street->keeper()));
        TEST_ASSERT_FALSE(elmopp_learner_is_in_use(&street->learner()));
        TEST_ASSERT_EQUAL_PTR(&elmopp_weights_lstm, street->learner().shipped);
    }
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_what_a_station_learns_is_kept_by_itself);
    RUN_TEST(test_after_a_restart_it_says_what_it_would_have_said_bit_for_bit);
    RUN_TEST(test_after_a_restart_the_guard_falls_back_to_the_shipped_weights);
    RUN_TEST(test_the_bus_says_whose_weights_a_forecast_is_by);
    RUN_TEST(test_it_is_kept_again_after_a_while_and_not_before);
    RUN_TEST(test_a_loss_of_power_at_each_write_leaves_what_was_kept_before_or_after);
    RUN_TEST(test_weights_that_were_damaged_where_they_lay_are_told_and_the_shipped_ones_run);
    return UNITY_END();
}

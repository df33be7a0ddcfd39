// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The simulator's side of SLCAN: against rubbish, pieces of any length, and adaptors that refuse, are slow or are
/// gone.

#include "error.hpp"
#include "expect.hpp"
#include "slcan_wire.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <random>
#include <string>
#include <thread>
#include <vector>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

constexpr std::uint32_t soon_ms = 300;      ///< where nobody will answer
constexpr std::uint32_t patient_ms = 30000; ///< where somebody will, on a machine that is busy

std::deque<SlcanEvent> events_of(SlcanLines &lines, const std::string &text, std::size_t piece = 1000) {
    std::deque<SlcanEvent> events;
    for (std::size_t k = 0; k < text.size(); k += piece) {
        lines.take(text.data() + k, std::min(piece, text.size() - k), events);
    }
    return events;
}

void expect_answer(const SlcanEvent &event, bool good) {
    const auto *answer = std::get_if<SlcanAnswer>(&event);
    TEST_ASSERT_TRUE(answer != nullptr && answer->good == good);
}

void expect_frame(const SlcanEvent &event, unsigned id, unsigned length, unsigned first) {
    const auto *frame = std::get_if<elmopp_frame_t>(&event);
    TEST_ASSERT_TRUE(frame != nullptr);
    TEST_ASSERT_EQUAL_UINT(id, frame->id);
    TEST_ASSERT_EQUAL_UINT(length, frame->length);
    TEST_ASSERT_EQUAL_UINT(first, frame->data[0]);
}

void test_lines_are_the_same_in_pieces_of_any_length() {
    const std::string text = "\rz\rt08081122334455667788\r\aZ\rt7E10\r";
    for (std::size_t piece = 1; piece <= text.size(); ++piece) {
        SlcanLines lines;
        const auto events = events_of(lines, text, piece);
        TEST_ASSERT_EQUAL_UINT(6, events.size());
        expect_answer(events[0], true);
        expect_answer(events[1], true);
        expect_frame(events[2], 0x080, 8, 0x11);
        expect_answer(events[3], false);
        expect_answer(events[4], true);
        expect_frame(events[5], 0x7E1, 0, 0);
        TEST_ASSERT_EQUAL_UINT(0, lines.rubbish());
    }
}

void test_what_is_no_line_is_left_out_and_counted() {
    for (const std::string rubbish :
         {"t080811\r", "tXYZ0\r", "hello\r", "t0809112233445566778899\r", "zz\r", " \r", "t\r"}) {
        SlcanLines lines;
        const auto events = events_of(lines, rubbish + "t0801AA\r");
        TEST_ASSERT_EQUAL_UINT(1, events.size());
        expect_frame(events[0], 0x080, 1, 0xAA);
        TEST_ASSERT_EQUAL_UINT(1, lines.rubbish());
    }
}

void test_an_overlong_line_is_one_piece_of_rubbish() {
    SlcanLines lines;
    const auto events = events_of(lines, "t0801AA" + std::string(100000, '0') + "\rt0801BB\r", 7);
    TEST_ASSERT_EQUAL_UINT(1, events.size());
    expect_frame(events[0], 0x080, 1, 0xBB);
    TEST_ASSERT_EQUAL_UINT(1, lines.rubbish());
}

void test_a_refusal_ends_what_stood_before_it() {
    SlcanLines lines;
    const auto events = events_of(lines, "t08\at0801CC\r");
    TEST_ASSERT_EQUAL_UINT(2, events.size());
    expect_answer(events[0], false);
    expect_frame(events[1], 0x080, 1, 0xCC);
    TEST_ASSERT_EQUAL_UINT(1, lines.rubbish());
}

void test_what_an_adaptor_says_besides_is_no_rubbish() {
    SlcanLines lines;
    const auto events = events_of(lines, "V1013\rNE386\rF0A\rT000001230\rr1230\r");
    TEST_ASSERT_EQUAL_UINT(5, events.size());
    TEST_ASSERT_EQUAL_STRING("V1013", std::get<SlcanOther>(events[0]).line.c_str());
    TEST_ASSERT_EQUAL_UINT(0, lines.rubbish());
}

void test_random_characters_make_no_frame() {
    std::mt19937 random(1);
    SlcanLines lines;
    std::string text(200000, '\0');
    for (char &character : text) {
        character = static_cast<char>(random() % 256);
    }
    for (const SlcanEvent &event : events_of(lines, text, 13)) {
        TEST_ASSERT_FALSE(std::holds_alternative<elmopp_frame_t>(event));
    }
    TEST_ASSERT_TRUE(lines.rubbish() > 100);
}

/// The board's side in a thread of its own: the firmware's adaptor, and what a test makes it do.
class Board {
  public:
    enum class Manner { good, silent, refuses, says_before, gone };

    explicit Board(Manner manner) : manner_(manner) {
        int ends[2];
        TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, &ends[0]));
        far_ = ends[0];
        near_ = ends[1];
        elmopp_slcan_init(&adaptor_);
        if (manner_ == Manner::gone) {
            (void)shutdown(near_, SHUT_RDWR);
        }
        thread_ = std::thread([this] { run(); });
    }
    ~Board() {
        stop_ = true;
        thread_.join();
        (void)close(near_);
    }
    Board(const Board &) = delete;
    Board &operator=(const Board &) = delete;
    Board(Board &&) = delete;
    Board &operator=(Board &&) = delete;

    [[nodiscard]] int far_end() const {
        return far_;
    }
    [[nodiscard]] unsigned frames() const {
        return frames_;
    }
    [[nodiscard]] bool is_open() const {
        return open_;
    }
    void say(const std::string &text) const {
        (void)::send(near_, text.data(), text.size(), MSG_NOSIGNAL); // the other end closes when it has seen enough
    }

  private:
    void run() {
        while (!stop_) {
            pollfd source{near_, POLLIN, 0};
            (void)poll(&source, 1, 10);
            char character = 0;
            while (manner_ != Manner::silent && ::read(near_, &character, 1) == 1) {
                take(character);
            }
        }
    }
    void take(char character) {
        elmopp_slcan_event_t event{};
        elmopp_slcan_take(&adaptor_, character, &event);
        open_ = adaptor_.open;
        std::string answer(&event.answer[0], event.answer_length);
        if (event.has_frame) {
            ++frames_;
            answer = manner_ == Manner::refuses ? "\a" : answer;
            answer = manner_ == Manner::says_before ? "t0801AA\r" + answer + "t0801BB\r" : answer;
        }
        if (!answer.empty()) {
            say(answer);
        }
    }

    Manner manner_;
    int far_ = -1;
    int near_ = -1;
    elmopp_slcan_t adaptor_{};
    std::thread thread_;
    std::atomic<bool> stop_{false};
    std::atomic<bool> open_{false};
    std::atomic<unsigned> frames_{0};
};

constexpr elmopp_frame_t some_frame{0x100, 8, {1, 2, 3, 4, 5, 6, 7, 8}};

void test_a_thousand_frames_arrive_and_none_is_lost() {
    Board board(Board::Manner::good);
    SlcanWire wire("unix:test", board.far_end(), patient_ms);
    TEST_ASSERT_TRUE(board.is_open());
    for (unsigned k = 0; k < 1000; ++k) {
        TEST_ASSERT_TRUE(wire.send_surely(some_frame));
    }
    wire.settle();
    TEST_ASSERT_EQUAL_UINT(1000, board.frames());
    TEST_ASSERT_EQUAL_UINT(0, wire.refused());
}

void test_frames_under_way_are_bounded() {
    Board board(Board::Manner::good);
    SlcanWire wire("unix:test", board.far_end(), patient_ms);
    unsigned sent = 0;
    while (sent < 10 * slcan_window && wire.send(some_frame)) {
        ++sent;
    }
    TEST_ASSERT_TRUE(sent >= slcan_window);
    wire.settle();
    TEST_ASSERT_EQUAL_UINT(sent, board.frames());
}

void test_what_came_before_the_settling_is_forgotten() {
    Board board(Board::Manner::says_before);
    SlcanWire wire("unix:test", board.far_end(), patient_ms);
    TEST_ASSERT_TRUE(wire.send_surely(some_frame));
    wire.settle();
    std::optional<elmopp_frame_t> frame;
    for (unsigned k = 0; k < 100 && !frame; ++k) {
        frame = wire.receive();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (frame) { // it may have come in the same piece as the answer
        TEST_ASSERT_EQUAL_UINT(0xBB, frame->data[0]);
    }
}

void test_a_refused_frame_is_counted() {
    Board board(Board::Manner::refuses);
    SlcanWire wire("unix:test", board.far_end(), patient_ms);
    TEST_ASSERT_TRUE(wire.send_surely(some_frame));
    wire.settle();
    TEST_ASSERT_EQUAL_UINT(1, wire.refused());
}

void test_a_channel_that_somebody_left_open_in_the_middle_of_a_line_opens_anew() {
    Board board(Board::Manner::good);
    const int second = dup(board.far_end());
    TEST_ASSERT_EQUAL_INT(9, static_cast<int>(::write(second, "S6\rO\rt080", 9)));
    {
        SlcanWire wire("unix:test", board.far_end(), patient_ms);
        TEST_ASSERT_TRUE(wire.send_surely(some_frame));
        wire.settle();
        TEST_ASSERT_EQUAL_UINT(1, board.frames());
    }
    (void)close(second);
}

void expect_failure(Board::Manner manner, const std::string &words) {
    Board board(manner);
    try {
        const SlcanWire wire("unix:test", board.far_end(), soon_ms);
        TEST_FAIL_MESSAGE("nobody is there, and nobody says so");
    } catch (const Failure &failure) {
        TEST_ASSERT_TRUE_MESSAGE(std::string(failure.what()).find(words) != std::string::npos, failure.what());
    }
}

void test_who_does_not_answer_or_is_gone_is_named() {
    expect_failure(Board::Manner::silent, "--link slcan:unix:test: no answer within");
    expect_failure(Board::Manner::gone, "--link slcan:unix:test: the line was closed");
}

void expect_bad_request(const std::string &place, const std::string &words) {
    try {
        (void)make_slcan_wire(place);
        TEST_FAIL_MESSAGE("there is nothing, and nobody says so");
    } catch (const BadRequest &refusal) {
        TEST_ASSERT_TRUE_MESSAGE(std::string(refusal.what()).find(words) != std::string::npos, refusal.what());
    }
}

void test_a_place_where_nothing_is_is_a_bad_request() {
    expect_bad_request("unix:/nowhere/mcu.sock", "--link slcan:unix:/nowhere/mcu.sock: No such file");
    expect_bad_request("unix:/" + std::string(200, 'x'), "the path is too long; right would be at most 107");
    expect_bad_request("tty:/nowhere/tty", "No such file");
    expect_bad_request("tty:/dev/null", "is no serial device");
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_lines_are_the_same_in_pieces_of_any_length);
    RUN_TEST(test_what_is_no_line_is_left_out_and_counted);
    RUN_TEST(test_an_overlong_line_is_one_piece_of_rubbish);
    RUN_TEST(test_a_refusal_ends_what_stood_before_it);
    RUN_TEST(test_what_an_adaptor_says_besides_is_no_rubbish);
    RUN_TEST(test_random_characters_make_no_frame);
    RUN_TEST(test_a_thousand_frames_arrive_and_none_is_lost);
    RUN_TEST(test_frames_under_way_are_bounded);
    RUN_TEST(test_what_came_before_the_settling_is_forgotten);
    RUN_TEST(test_a_refused_frame_is_counted);
    RUN_TEST(test_a_channel_that_somebody_left_open_in_the_middle_of_a_line_opens_anew);
    RUN_TEST(test_who_does_not_answer_or_is_gone_is_named);
    RUN_TEST(test_a_place_where_nothing_is_is_a_bad_request);
    return UNITY_END();
}

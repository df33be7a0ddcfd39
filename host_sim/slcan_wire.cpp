// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "slcan_wire.hpp"

#include "error.hpp"
#include "jobs.hpp"
#include "wakeups.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace elmopp {
namespace {

constexpr std::uint32_t slcan_answer_ms = 5000;
constexpr std::uint32_t room_ms = 1000;
constexpr int look_ms = 100; ///< how often a wait looks whether somebody wants it to end
constexpr std::size_t piece_bytes = 4096;

[[noreturn]] void refuse_place(const std::string &place, const std::string &why) {
    throw BadRequest("--link slcan:" + place + ": " + why);
}

int open_socket(const std::string &place, const std::string &path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) {
        refuse_place(place, "the path is too long; right would be at most " +
                                std::to_string(sizeof address.sun_path - 1) + " characters");
    }
    std::memcpy(&address.sun_path[0], path.data(), path.size());
    const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (descriptor < 0 || connect(descriptor, reinterpret_cast<const sockaddr *>(&address), sizeof address) != 0) {
        const std::string why = std::strerror(errno);
        if (descriptor >= 0) {
            (void)close(descriptor);
        }
        refuse_place(place, why + "; right would be the socket of a running emulator's UART");
    }
    return descriptor;
}

/// Characters as they are; the speed is left as it was set (stty).
int open_serial(const std::string &place, const std::string &path) {
    const int descriptor = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) {
        refuse_place(place,
                     std::string(std::strerror(errno)) + "; right would be a serial device, such as /dev/ttyACM0");
    }
    termios settings{};
    if (tcgetattr(descriptor, &settings) != 0) {
        (void)close(descriptor);
        refuse_place(place, "is no serial device; right would be one, such as /dev/ttyACM0");
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    (void)tcsetattr(descriptor, TCSANOW, &settings);
    return descriptor;
}

/// A socket whose other end is gone must not end the program.
ssize_t put(int descriptor, const char *text, std::size_t length) {
    const ssize_t sent = ::send(descriptor, text, length, MSG_NOSIGNAL);
    return sent < 0 && errno == ENOTSOCK ? ::write(descriptor, text, length) : sent;
}

} // namespace

SlcanWire::SlcanWire(std::string place, int descriptor, std::uint32_t answer_ms)
    : place_(std::move(place)), descriptor_(descriptor), answer_ms_(answer_ms) {
    try {
        begin_anew();
        if (!command("S6") || !command("O")) {
            fail("does not open its channel at 500 kbit/s");
        }
    } catch (...) {
        (void)close(descriptor_);
        throw;
    }
    events_.clear();
}

SlcanWire::~SlcanWire() {
    (void)put(descriptor_, "C\r", 2);
    (void)close(descriptor_);
}

std::string SlcanWire::name() const {
    return "slcan:" + place_;
}

std::string SlcanWire::peer() const {
    return "a running elmopp-mps2 with the same site";
}

void SlcanWire::fail(const std::string &what) const {
    throw Failure("--link " + name() + ": " + what + "; right would be " + peer());
}

void SlcanWire::wait(int ms) const {
    pollfd source{descriptor_, POLLIN, 0};
    (void)poll(&source, 1, ms);
    check_interrupt();
}

void SlcanWire::read() {
    std::array<char, piece_bytes> piece{};
    ssize_t length = 0;
    while ((length = ::read(descriptor_, piece.data(), piece.size())) > 0) {
        lines_.take(piece.data(), static_cast<std::size_t>(length), events_);
    }
    if (length == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
        fail("the line was closed");
    }
}

/// Answers are counted, frames are kept.
void SlcanWire::sort() {
    read();
    for (const SlcanEvent &event : events_) {
        if (const auto *frame = std::get_if<elmopp_frame_t>(&event)) {
            frames_.push_back(*frame);
        } else if (const auto *answer = std::get_if<SlcanAnswer>(&event)) {
            under_way_ -= under_way_ > 0 ? 1U : 0U;
            refused_ += answer->good ? 0U : 1U;
        }
    }
    events_.clear();
}

void SlcanWire::write(const std::string &text) {
    std::size_t done = 0;
    const std::uint32_t begun_ms = monotonic_ms();
    while (done < text.size()) {
        const ssize_t length = put(descriptor_, text.data() + done, text.size() - done);
        if (length > 0) {
            done += static_cast<std::size_t>(length);
        } else if (length < 0 && errno != EAGAIN && errno != EINTR) {
            fail("the line was closed");
        } else if (monotonic_ms() - begun_ms > answer_ms_) {
            fail("nobody reads the line");
        } else {
            pollfd source{descriptor_, POLLOUT, 0};
            (void)poll(&source, 1, look_ms);
            check_interrupt();
        }
    }
}

/// The next thing that is said, or Failure.
SlcanEvent SlcanWire::next() {
    const std::uint32_t begun_ms = monotonic_ms();
    read();
    while (events_.empty()) {
        if (monotonic_ms() - begun_ms > answer_ms_) {
            fail("no answer within " + std::to_string(answer_ms_ / 1000) + " s");
        }
        wait(look_ms);
        read();
    }
    SlcanEvent event = events_.front();
    events_.pop_front();
    return event;
}

/// Ends what somebody else may have begun, and shuts the channel. Only the version is an answer that nothing else gets:
/// when it comes, nothing of before is left.
void SlcanWire::begin_anew() {
    write("\r\r\rC\rV\r");
    bool told = false;
    while (!told) {
        const SlcanEvent event = next();
        const auto *other = std::get_if<SlcanOther>(&event);
        told = other != nullptr && other->line[0] == 'V';
    }
}

bool SlcanWire::command(const std::string &text) {
    write(text + "\r");
    for (;;) {
        const SlcanEvent event = next();
        if (const auto *answer = std::get_if<SlcanAnswer>(&event)) {
            return answer->good;
        }
    }
}

std::optional<elmopp_frame_t> SlcanWire::receive() {
    if (frames_.empty()) {
        sort();
    }
    if (frames_.empty()) {
        return std::nullopt;
    }
    const elmopp_frame_t frame = frames_.front();
    frames_.pop_front();
    return frame;
}

/// True if another frame may be under way. Who has not answered for so long never does.
bool SlcanWire::have_room(std::uint32_t limit_ms) {
    const std::uint32_t begun_ms = monotonic_ms();
    while (under_way_ >= slcan_window) {
        sort();
        if (under_way_ >= slcan_window && monotonic_ms() - begun_ms >= limit_ms) {
            return false;
        }
        if (under_way_ >= slcan_window) {
            wait(look_ms);
        }
    }
    return true;
}

bool SlcanWire::send(const elmopp_frame_t &frame) {
    if (!have_room(0)) {
        return false;
    }
    std::array<char, ELMOPP_SLCAN_TEXT_MAX> text{};
    const std::uint32_t length = elmopp_slcan_write(&frame, text.data());
    write(std::string(text.data(), length) + "\r");
    ++under_way_;
    return true;
}

bool SlcanWire::send_surely(const elmopp_frame_t &frame) {
    if (!have_room(room_ms)) {
        under_way_ = 0;
    }
    return send(frame);
}

void SlcanWire::settle() {
    const std::uint32_t begun_ms = monotonic_ms();
    sort();
    while (under_way_ > 0 && monotonic_ms() - begun_ms < answer_ms_) {
        wait(look_ms);
        sort();
    }
    frames_.clear();
}

std::unique_ptr<Wire> make_slcan_wire(const std::string &place) {
    const std::string path = place.substr(place.find(':') + 1);
    const int descriptor = place.rfind("unix:", 0) == 0 ? open_socket(place, path) : open_serial(place, path);
    return std::make_unique<SlcanWire>(place, descriptor, slcan_answer_ms);
}

} // namespace elmopp

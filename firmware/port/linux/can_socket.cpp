// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "can_socket.hpp"

#include "error.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace elmopp {
namespace {

constexpr int send_room_ms = 1000;
constexpr int receive_room_bytes = 1048576; ///< some thousand frames: a flood is to be counted, not to push ours out

std::time_t monotonic_s() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec;
}

std::string reason_of(int error, const std::string &interface) {
    switch (error) {
    case ENODEV:
    case ENXIO:
        return "there is no such interface; right would be one of those that `ip -br link` lists as can0, vcan0, ...";
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
        return "this kernel has no CAN; right would be one with can, can-raw and a driver (modprobe can-raw)";
    case EPERM:
    case EACCES:
        return "no permission to open a raw CAN socket; right would be a user, or a service, that may";
    case EINVAL:
        return "\"" + interface + "\" is no CAN interface; right would be can0, vcan0, ...";
    default:
        return std::strerror(error);
    }
}

} // namespace

CanSocket::CanSocket(std::string interface, std::vector<std::uint16_t> ids)
    : interface_(std::move(interface)), ids_(std::move(ids)) {
    open(true);
}

CanSocket::~CanSocket() {
    close();
}

void CanSocket::close() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
        descriptor_ = -1;
    }
}

void CanSocket::open(bool at_start) {
    const auto give_up = [&](int error) {
        close();
        if (at_start) {
            throw BadRequest("--can " + interface_ + ": " + reason_of(error, interface_));
        }
    };
    descriptor_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (descriptor_ < 0) {
        give_up(errno);
        return;
    }
    const can_err_mask_t errors = CAN_ERR_MASK;
    const int room = receive_room_bytes;
    const int on = 1;
    bool set = filter();
    set = set && setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) == 0;
    (void)setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    (void)setsockopt(descriptor_, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface_.c_str()));
    if (address.can_ifindex == 0) {
        give_up(ENODEV); // 0 would be every interface
        return;
    }
    if (!set || bind(descriptor_, reinterpret_cast<const sockaddr *>(&address), sizeof address) != 0) {
        // A network interface of another kind is refused as if it were none.
        give_up(errno == ENODEV ? EINVAL : errno);
    }
}

bool CanSocket::filter() const {
    std::vector<can_filter> filters;
    filters.reserve(ids_.size());
    for (const std::uint16_t id : ids_) {
        filters.push_back({id, CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG});
    }
    return filters.empty() || setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                         static_cast<socklen_t>(filters.size() * sizeof(can_filter))) == 0;
}

void CanSocket::listen_to(std::vector<std::uint16_t> ids) {
    ids_ = std::move(ids);
    if (descriptor_ >= 0 && !filter()) {
        close(); // looked for again, with the new ids
    }
}

void CanSocket::find_again() {
    const std::time_t now_s = monotonic_s();
    if (descriptor_ < 0 && now_s != tried_s_) {
        tried_s_ = now_s;
        open(false);
        troubles_.reopened += descriptor_ >= 0 ? 1U : 0U;
    }
}

void CanSocket::count_error(std::uint32_t what, std::uint32_t controller) {
    const std::uint32_t known = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_CRTL;
    constexpr std::uint32_t any_passive = CAN_ERR_CRTL_RX_PASSIVE + CAN_ERR_CRTL_TX_PASSIVE;
    constexpr std::uint32_t any_overrun = CAN_ERR_CRTL_RX_OVERFLOW + CAN_ERR_CRTL_TX_OVERFLOW;
    const bool passive = (controller & any_passive) != 0;
    const bool overrun = (controller & any_overrun) != 0;
    troubles_.bus_off += (what & CAN_ERR_BUSOFF) != 0 ? 1U : 0U;
    troubles_.restarted += (what & CAN_ERR_RESTARTED) != 0 ? 1U : 0U;
    troubles_.error_passive += (what & CAN_ERR_CRTL) != 0 && passive ? 1U : 0U;
    troubles_.overruns += (what & CAN_ERR_CRTL) != 0 && overrun ? 1U : 0U;
    troubles_.other_errors += (what & ~known & CAN_ERR_MASK) != 0 ? 1U : 0U;
}

std::optional<elmopp_frame_t> CanSocket::receive() {
    find_again();
    while (descriptor_ >= 0) {
        can_frame raw{};
        std::array<char, CMSG_SPACE(sizeof(std::uint32_t))> control{};
        iovec part{&raw, sizeof raw};
        msghdr message{};
        message.msg_iov = &part;
        message.msg_iovlen = 1;
        message.msg_control = control.data();
        message.msg_controllen = control.size();
        const ssize_t got = recvmsg(descriptor_, &message, 0);
        const int error = errno;
        if (got < 0) {
            if (error == ENODEV) {
                close();
            }
            if (error == ENETDOWN || error == EINTR) {
                continue; // said once; the socket stays, and hears again when the interface is up
            }
            return std::nullopt;
        }
        for (cmsghdr *header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header)) {
            if (header->cmsg_level == SOL_SOCKET && header->cmsg_type == SO_RXQ_OVFL) {
                std::uint32_t dropped = 0;
                std::memcpy(&dropped, CMSG_DATA(header), sizeof dropped);
                troubles_.lost += dropped - dropped_;
                dropped_ = dropped;
            }
        }
        if (got != static_cast<ssize_t>(CAN_MTU)) {
            continue; // CAN FD: nobody here speaks it
        }
        if ((raw.can_id & CAN_ERR_FLAG) != 0) {
            count_error(raw.can_id, raw.data[1]);
            continue;
        }
        if ((raw.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG)) != 0) {
            continue;
        }
        elmopp_frame_t frame{};
        frame.id = static_cast<std::uint16_t>(raw.can_id & CAN_SFF_MASK);
        frame.length = std::min<std::uint8_t>(raw.can_dlc, ELMOPP_LINK_BYTES);
        std::copy_n(std::begin(raw.data), ELMOPP_LINK_BYTES, std::begin(frame.data));
        return frame;
    }
    return std::nullopt;
}

bool CanSocket::send(const elmopp_frame_t &frame) {
    find_again();
    can_frame raw{};
    raw.can_id = frame.id;
    raw.can_dlc = frame.length;
    std::copy_n(std::begin(frame.data), frame.length, std::begin(raw.data));
    const bool sent = descriptor_ >= 0 && write(descriptor_, &raw, sizeof raw) == static_cast<ssize_t>(sizeof raw);
    if (!sent && descriptor_ >= 0 && (errno == ENODEV || errno == ENXIO)) {
        close();
    }
    troubles_.unsent += sent ? 0U : 1U;
    return sent;
}

bool CanSocket::send_surely(const elmopp_frame_t &frame) {
    for (int waited_ms = 0; waited_ms < send_room_ms; ++waited_ms) {
        if (send(frame)) {
            return true;
        }
        --troubles_.unsent; // not given up yet
        (void)poll(nullptr, 0, 1);
    }
    ++troubles_.unsent;
    return false;
}

} // namespace elmopp

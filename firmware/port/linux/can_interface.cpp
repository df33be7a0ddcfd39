// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "can_interface.hpp"

#include "error.hpp"
#include "program.hpp"

#include <libmnl/libmnl.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>

#include <array>
#include <cstring>
#include <memory>
#include <vector>

namespace elmopp {
namespace {

template <typename Visit> int each(const nlattr *attribute, void *data) {
    (*static_cast<Visit *>(data))(attribute);
    return MNL_CB_OK;
}

/// Calls visit(attribute) for each attribute inside another.
template <typename Visit> void for_nested(const nlattr *nest, Visit visit) {
    mnl_attr_parse_nested(nest, each<Visit>, &visit);
}

void read_can_data(const nlattr *data, CanInterface &found) {
    for_nested(data, [&found](const nlattr *attribute) {
        if (mnl_attr_get_type(attribute) == IFLA_CAN_BITTIMING) {
            can_bittiming timing{};
            std::memcpy(&timing, mnl_attr_get_payload(attribute), sizeof timing);
            found.bit_rate = timing.bitrate;
        }
        if (mnl_attr_get_type(attribute) == IFLA_CAN_RESTART_MS) {
            found.restart_ms = mnl_attr_get_u32(attribute);
            found.has_restart = true;
        }
    });
}

void read_link_info(const nlattr *info, CanInterface &found) {
    const nlattr *data = nullptr;
    for_nested(info, [&](const nlattr *attribute) {
        if (mnl_attr_get_type(attribute) == IFLA_INFO_KIND) {
            found.kind = mnl_attr_get_str(attribute);
        }
        if (mnl_attr_get_type(attribute) == IFLA_INFO_DATA) {
            data = attribute;
        }
    });
    if (found.kind == "can" && data != nullptr) {
        read_can_data(data, found);
    }
}

int read_link(const nlmsghdr *header, void *data) {
    auto &found = *static_cast<CanInterface *>(data);
    const auto *const link = static_cast<const ifinfomsg *>(mnl_nlmsg_get_payload(header));
    found.exists = true;
    found.up = (link->ifi_flags & static_cast<unsigned>(IFF_UP)) != 0;
    auto visit = [&found](const nlattr *attribute) {
        if (mnl_attr_get_type(attribute) == IFLA_LINKINFO) {
            read_link_info(attribute, found);
        }
    };
    mnl_attr_parse(header, sizeof *link, each<decltype(visit)>, &visit);
    return MNL_CB_OK;
}

struct CloseSocket {
    void operator()(mnl_socket *socket) const {
        mnl_socket_close(socket);
    }
};

} // namespace

CanInterface look_at_can(const std::string &name) {
    CanInterface found;
    const std::unique_ptr<mnl_socket, CloseSocket> socket(mnl_socket_open(NETLINK_ROUTE));
    if (!socket || mnl_socket_bind(socket.get(), 0, MNL_SOCKET_AUTOPID) < 0) {
        throw Failure("the kernel's table of interfaces cannot be read");
    }
    std::vector<char> buffer(static_cast<std::size_t>(MNL_SOCKET_BUFFER_SIZE));
    nlmsghdr *const request = mnl_nlmsg_put_header(buffer.data());
    request->nlmsg_type = RTM_GETLINK;
    request->nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
    mnl_nlmsg_put_extra_header(request, sizeof(ifinfomsg));
    mnl_attr_put_strz(request, IFLA_IFNAME, name.substr(0, IFNAMSIZ - 1).c_str());
    if (mnl_socket_sendto(socket.get(), request, request->nlmsg_len) < 0) {
        return found;
    }
    int going_on = MNL_CB_OK;
    while (going_on > MNL_CB_STOP) {
        const ssize_t length = mnl_socket_recvfrom(socket.get(), buffer.data(), buffer.size());
        going_on = length <= 0 ? MNL_CB_ERROR
                               : mnl_cb_run(buffer.data(), static_cast<std::size_t>(length), 0,
                                            mnl_socket_get_portid(socket.get()), read_link, &found);
    }
    return found;
}

void check_can(const std::string &program, const std::string &name) {
    const CanInterface found = look_at_can(name);
    if (!found.exists) {
        throw BadRequest("--can " + name +
                         ": there is no such interface; right would be one of those that `ip -br link` lists as can0, "
                         "vcan0, ...");
    }
    if (found.bit_rate != 0 && found.bit_rate != can_bit_rate) {
        throw BadRequest("--can " + name + ": runs at " + std::to_string(found.bit_rate) + " bit/s; right would be " +
                         std::to_string(can_bit_rate) + " (ip link set " + name + " type can bitrate " +
                         std::to_string(can_bit_rate) + ")");
    }
    if (!found.up) {
        say(program, name + " is down; nothing is heard before somebody brings it up");
    } else if (found.has_restart && found.restart_ms == 0) {
        say(program,
            name + " does not come back from bus-off by itself (ip link set " + name + " type can restart-ms 100)");
    }
}

} // namespace elmopp

// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// elmopp-send: new weights or a new site for a controller, over its bus.

#include "can_interface.hpp"
#include "can_socket.hpp"
#include "error.hpp"
#include "image_sender.hpp"
#include "networks.hpp"
#include "program.hpp"
#include "sites.hpp"
#include "wakeups.hpp"

extern "C" {
#include "elmopp/image.h"
#include "elmopp_can.h"
}

#include <CLI/CLI.hpp>

#include <poll.h>

#include <cstring>
#include <iostream>
#include <string>
#include <vector>

namespace elmopp {
namespace {

const char *const program_name = "elmopp-send";

struct Request {
    std::string can;
    std::string weights;
    std::string site;
    bool until_kept = false;
};

/// The image of something that has been read and checked, whatever file it came from.
template <typename Body> std::vector<std::uint8_t> image_of(const elmopp_image_kind_t &kind, const Body &body) {
    std::vector<std::uint8_t> image(ELMOPP_IMAGE_HEADER + sizeof body);
    std::memcpy(&image[ELMOPP_IMAGE_HEADER], &body, sizeof body);
    elmopp_image_seal(&kind, image.data());
    return image;
}

std::vector<std::uint8_t> read_image(const Request &request) {
    if (request.weights.empty() == request.site.empty()) {
        throw BadRequest("right would be --weights FILE or --site FILE, one of them");
    }
    return request.site.empty() ? image_of(*elmopp_weights_kind(), read_weights(request.weights))
                                : image_of(*elmopp_site_kind(), read_street(request.site));
}

/// A millisecond at most, so that a segment's time is not missed.
void wait_for(int descriptor) {
    pollfd waiting{descriptor, POLLIN, 0};
    (void)poll(&waiting, 1, 1);
}

void send_it(CanSocket &socket, ImageSender &sender) {
    ImageSender::State told = sender.state();
    while (!sender.done()) {
        take_what_came(socket, [&sender](const elmopp_frame_t &frame) { sender.hear(frame, monotonic_ms()); });
        if (const auto frame = sender.due(monotonic_ms())) {
            if (!socket.send_surely(*frame)) {
                throw Failure("a segment could not be sent; is the interface up, and does anybody acknowledge?");
            }
        } else {
            wait_for(socket.descriptor());
        }
        if (sender.state() != told && sender.state() == ImageSender::State::running) {
            say(program_name, sender.said());
        }
        told = sender.state();
    }
}

void run(const Request &request) {
    const std::vector<std::uint8_t> image = read_image(request);
    check_can(program_name, request.can);
    CanSocket socket(request.can, {ELMOPP_CAN_TRANSFER_ACK_FRAME_ID});
    ImageSender sender(image, request.until_kept, monotonic_ms());
    send_it(socket, sender);
    if (sender.state() == ImageSender::State::failed) {
        throw Failure(sender.said());
    }
    std::cout << sender.said() << "\n";
}

void add_options(CLI::App &app, Request &request) {
    app.description("elmopp-send: sends new weights or a new site to the controller on a CAN bus.");
    app.footer(
        "The controller checks it, runs it on trial for 300 s and keeps it if there was no fault; a reset before\n"
        "that brings the old one back. A site is taken only while the local key is held and the lamps flash.\n"
        "Exit codes: 0 it is on trial (or kept), 1 refused, withdrawn or no answer, 2 the request cannot be run\n"
        "(one line says why).\n"
        "Start with: elmopp-send --can vcan0 --weights weights.bin --until-kept");
    app.add_option("--can", request.can, "CAN interface, 500 kbit/s")->type_name("IFACE")->required();
    app.add_option("--weights", request.weights, "ELMW image, made by tools/weights")->type_name("FILE");
    app.add_option("--site", request.site, "A junction, .toml or .bin")->type_name("FILE");
    app.add_flag("--until-kept", request.until_kept, "Wait for the end of the trial");
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    return elmopp::run_program(elmopp::program_name, argc, argv, elmopp::add_options, elmopp::run);
}

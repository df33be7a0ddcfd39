// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// elmopp-controller: the controller on a CAN bus of Linux. Turns arguments into a station and carries frames and time
/// to it; it decides nothing about lamps.
///
/// SIGTERM, SIGINT: all red as soon as the plan allows, then the end; the lamp nodes flash. SIGUSR1: the local reset
/// input is held, SIGUSR2: it is let go.

#include "bus_log.hpp"
#include "can_interface.hpp"
#include "can_socket.hpp"
#include "decision_log.hpp"
#include "error.hpp"
#include "file_store.hpp"
#include "networks.hpp"
#include "program.hpp"
#include "sites.hpp"
#include "transfer_words.hpp"
#include "wakeups.hpp"

extern "C" {
#include "bus_clock.h"
#include "elmopp/keeper.h"
#include "elmopp/station.h"
#include "elmopp_can.h"
#include "elmopp_weights.h"
}

#include <CLI/CLI.hpp>
#include <systemd/sd-daemon.h>

#include <sys/mman.h>

#include <array>
#include <csignal>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

namespace elmopp {
namespace {

const char *const program_name = "elmopp-controller";

struct Request {
    std::string can;
    std::string site;
    std::string weights;
    std::string store;
    std::string clock = "real";
    std::string log;
};

void say_it(const std::string &text) {
    say(program_name, text);
}

/// What the controller listens to; the kernel drops the rest.
std::vector<std::uint16_t> wanted_ids(const elmopp_junction_t &junction, bool bus_clock) {
    std::vector<std::uint16_t> ids{ELMOPP_CAN_COMMAND_FRAME_ID, ELMOPP_CAN_LAMP_COMMAND_FRAME_ID,
                                   ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID, ELMOPP_CAN_TRANSFER_FRAME_ID};
    const auto add = [&ids](unsigned first, unsigned index) {
        ids.push_back(static_cast<std::uint16_t>(first + index));
    };
    for (unsigned i = 0; i < junction.approach_count; ++i) {
        add(ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID, i);
        if (elmopp_mask_has(junction.cameras, i)) {
            add(ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID, i);
        }
    }
    if (junction.junction_wait_ds > 0) {
        add(ELMOPP_CAN_JUNCTION_OCCUPIED_FRAME_ID, 0);
    }
    const std::uint32_t nodes = elmopp_junction_nodes(&junction);
    for (unsigned n = 0; n < ELMOPP_NODE_MAX; ++n) {
        if (elmopp_mask_has(nodes, n)) {
            add(ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID, n);
        }
    }
    if (bus_clock) {
        add(ELMOPP_CAN_SIM_TIME_FRAME_ID, 0);
    }
    return ids;
}

/// The decision log of a street: what host_sim writes of a run, one line a decision.
class StreetLog {
  public:
    explicit StreetLog(const std::string &file) : wanted_(!file.empty()) {
        if (wanted_) {
            out_.open(file, std::ios::app);
            if (!out_) {
                throw BadRequest("--log " + file +
                                 ": cannot be written; right would be a file in a folder that is there");
            }
        }
    }

    /// What was decided a lamp tick ago, when the minute is foreseen, with what the lamps show now. A full disk stops
    /// no lamps: it is said once.
    void write(const elmopp_controller_t &controller) {
        if (wanted_ && out_) {
            out_ << decision_line(decision_of(controller, seconds_++)) << "}\n" << std::flush;
            if (!out_) {
                say_it("the log cannot be written any more");
            }
        }
    }

  private:
    static Decision decision_of(const elmopp_controller_t &controller, std::size_t t_s) {
        return {t_s,
                controller.told.stage,
                controller.lamps,
                controller.junction,
                controller.present_veh,
                controller.arrived_veh,
                controller.pilot.score,
                controller.pilot.foreseen_sum_veh,
                controller.fault};
    }

    bool wanted_;
    std::ofstream out_;
    std::size_t seconds_ = 0;
};

/// The shipped weights for the site's network.
const elmopp_weights_t *shipped_for(const elmopp_junction_t &junction) {
    return elmopp_forecast_is_nested(junction.forecast) ? &elmopp_weights_nlstm : &elmopp_weights_lstm;
}

/// All that learning on takes, with any network.
struct LearningRoom {
    elmopp_learning_t learning;
    elmopp_trainer_inner_memory_t inner;
};

/// What is in force: what has come over the bus or was learnt and was kept, or is on trial; otherwise what the command
/// line says.
class Kept {
  public:
    Kept(const std::string &folder, const elmopp_junction_t &site, const elmopp_weights_t *weights)
        : base_site_(site), base_weights_(weights), keeper_(std::make_unique<elmopp_keeper_t>()) {
        elmopp_keeper_config_t config{};
        config.save_min_s = save_min_s;
        if (!folder.empty()) {
            folder_.emplace(folder);
            weights_files_ = std::make_unique<FileStore>(folder, "weights", image_bytes(*elmopp_weights_kind()));
            site_files_ = std::make_unique<FileStore>(folder, "site", image_bytes(*elmopp_site_kind()));
            config.weights = weights_files_->medium();
            config.site = site_files_->medium();
        }
        elmopp_keeper_init(keeper_.get(), &config);
        if (elmopp_keeper_site(keeper_.get()) != nullptr) {
            say_it("the site is the one that came over the bus, " + std::string(site_in_force().name) + " in " +
                   folder + "/site.*, not that of --site");
        }
        if (elmopp_keeper_weights(keeper_.get()) != nullptr) {
            say_it("the weights are those that were kept in " + folder + "/weights.*");
        }
        tell_damage(ELMOPP_TRANSFER_SITE, folder + "/site.*");
        tell_damage(ELMOPP_TRANSFER_WEIGHTS, folder + "/weights.*");
    }

    [[nodiscard]] elmopp_keeper_t &keeper() {
        return *keeper_;
    }

    [[nodiscard]] const elmopp_junction_t &site_in_force() const {
        const elmopp_junction_t *kept = elmopp_keeper_site(keeper_.get());
        return kept != nullptr ? *kept : base_site_;
    }

    /// Those that the site can use: its own shipped ones, if nothing else fits. What was kept is copied: as long as
    /// they run, somebody learns from them and stores what he has learnt, where they stood in the end.
    [[nodiscard]] elmopp_station_weights_t weights_in_force() {
        const elmopp_junction_t &site = site_in_force();
        const bool given = elmopp_forecast_fits(site.forecast, base_weights_);
        const elmopp_weights_t *kept = elmopp_keeper_weights(keeper_.get());
        elmopp_station_weights_t weights =
            elmopp_station_weights(&site, given ? base_weights_ : shipped_for(site), kept);
        if (weights.base == kept) {
            *base_ = *kept;
            weights.base = base_.get();
        }
        return weights;
    }

    /// What is damaged is told as a fault, too: somebody has to look at it.
    void report_damage(elmopp_controller_t &controller) const {
        if (elmopp_keeper_is_damaged(keeper_.get(), ELMOPP_TRANSFER_SITE)) {
            elmopp_controller_report(&controller, ELMOPP_FAULT_SITE_CHANGED);
        }
        if (elmopp_keeper_is_damaged(keeper_.get(), ELMOPP_TRANSFER_WEIGHTS)) {
            elmopp_controller_report(&controller, ELMOPP_FAULT_WEIGHTS_CHANGED);
        }
    }

    /// Carries out what the stores want done, as long as that takes no time.
    void work() {
        elmopp_transfer_kind_t kind = ELMOPP_TRANSFER_NOTHING;
        elmopp_store_order_t order{};
        for (unsigned k = 0; k < orders_of_a_tick && elmopp_keeper_next(keeper_.get(), &kind, &order); ++k) {
            FileStore &files = kind == ELMOPP_TRANSFER_SITE ? *site_files_ : *weights_files_;
            const elmopp_store_answer_t answer = files.carry_out(order);
            if (answer == ELMOPP_STORE_FAILED) {
                say_it("not kept: " + files.trouble());
            }
            elmopp_keeper_answer(keeper_.get(), kind, answer);
            if (answer == ELMOPP_STORE_LATER) {
                return;
            }
        }
    }

    /// Says once what has become of an image.
    void tell() {
        const elmopp_transfer_report_t &now = keeper_->told;
        if (now.state != told_.state || now.reason != told_.reason || now.kind != told_.kind) {
            say_it(in_words(now));
            told_ = now;
        }
    }

  private:
    static constexpr unsigned orders_of_a_tick = 1024;
    static constexpr std::uint32_t save_min_s = 3600; ///< between two stores of what was learnt: 300 MB a year

    void tell_damage(elmopp_transfer_kind_t kind, const std::string &files) const {
        if (elmopp_keeper_is_damaged(keeper_.get(), kind)) {
            say_it("what was kept last in " + files + " is damaged: older, or what is shipped, is in force");
        }
    }

    static std::uint32_t image_bytes(const elmopp_image_kind_t &kind) {
        return ELMOPP_IMAGE_HEADER + kind.body_bytes;
    }

    const elmopp_junction_t &base_site_;
    const elmopp_weights_t *base_weights_;
    std::unique_ptr<elmopp_weights_t> base_ = std::make_unique<elmopp_weights_t>();
    std::optional<StoreFolder> folder_;
    std::unique_ptr<FileStore> weights_files_; ///< null: nowhere, and the keeper asks for nothing
    std::unique_ptr<FileStore> site_files_;
    std::unique_ptr<elmopp_keeper_t> keeper_;
    elmopp_transfer_report_t told_{};
};

class Program {
  public:
    Program(const Request &request, Kept &kept)
        : bus_clock_(request.clock == "bus"), kept_(kept), log_(request.log),
          socket_(request.can, wanted_ids(kept_.site_in_force(), bus_clock_)),
          wakeups_(bus_clock_ ? 0 : ELMOPP_CONTROLLER_TICK_MS, {SIGTERM, SIGINT, SIGUSR1, SIGUSR2}),
          station_(std::make_unique<elmopp_station_t>()), room_(std::make_unique<LearningRoom>()),
          reporter_(program_name, request.can) {
        begin();
    }

    void run() {
        while (!done_) {
            wakeups_.wait(socket_.descriptor());
            obey_signals();
            take_frames();
            if (const std::uint64_t due = wakeups_.ticks(); due > 0) {
                missed_ += due - 1;
                tick(monotonic_ms());
            }
        }
        (void)sd_notify(0, "STOPPING=1");
    }

    [[nodiscard]] std::uint64_t missed() const {
        return missed_;
    }

  private:
    [[nodiscard]] elmopp_controller_t &controller() {
        return station_->controller;
    }

    void begin() {
        const elmopp_station_weights_t weights = kept_.weights_in_force();
        const elmopp_station_room_t room{&room_->learning, &room_->inner};
        elmopp_station_init(station_.get(), &kept_.site_in_force(), &elmopp_weights_lstm.ar8, &weights, &room);
        kept_.report_damage(controller());
        elmopp_controller_hold_reset(&controller(), reset_held_);
        elmopp_link_init(&time_link_);
        trace_counter_ = 0;
        stopping_ = false;
    }

    void obey_signals() {
        while (const auto signal = wakeups_.signal()) {
            if (*signal == SIGUSR1 || *signal == SIGUSR2) {
                reset_held_ = *signal == SIGUSR1;
                elmopp_controller_hold_reset(&controller(), reset_held_);
                say_it(*signal == SIGUSR1 ? "the local reset is held" : "the local reset is let go");
            } else {
                say_it("asked to stop: all red first");
                stopping_ = true;
                elmopp_controller_stop(&controller());
                done_ = bus_clock_ || elmopp_controller_has_stopped(&controller());
            }
        }
    }

    void take_frames() {
        take_what_came(socket_, [this](const elmopp_frame_t &frame) {
            if (bus_clock_ && frame.id == ELMOPP_CAN_SIM_TIME_FRAME_ID) {
                take_time(frame);
            } else if (!elmopp_keeper_take(&kept_.keeper(), &controller(), &frame)) {
                (void)elmopp_controller_take(&controller(), &frame);
            }
        });
    }

    void take_time(const elmopp_frame_t &frame) {
        const bool anew = elmopp_bus_clock_time(&frame) == 0;
        elmopp_link_t link = time_link_;
        if (anew) {
            elmopp_link_init(&link);
        }
        if (elmopp_link_take(&link, &frame, ELMOPP_CAN_SIM_TIME_FRAME_ID, 0) != ELMOPP_LINK_OK) {
            return;
        }
        if (anew) {
            begin();
        } else {
            tick(elmopp_bus_clock_time(&frame));
        }
        time_link_ = link;
    }

    /// In lockstep nothing may be lost, and the LampCommand, first of a tick's frames, goes last: whoever waits for it
    /// has then heard everything, the exact values after the rounded ones of Forecast.
    void answer(const elmopp_frame_t *frames, std::uint32_t count, bool decided) {
        std::array<elmopp_frame_t, ELMOPP_TRACE_MAX> trace{};
        const std::uint32_t values =
            decided ? elmopp_bus_clock_trace(&controller(), &trace_counter_, trace.data()) : 0U;
        for (std::uint32_t k = 1; k < count; ++k) {
            (void)socket_.send_surely(frames[k]);
        }
        for (std::uint32_t k = 0; k < values; ++k) {
            (void)socket_.send_surely(trace.at(k));
        }
        if (count > 0) {
            (void)socket_.send_surely(frames[0]);
        }
    }

    /// As begin(), but whoever gives the time goes on, and who has been asked to stop still is.
    void begin_with_other_site() {
        const elmopp_link_t time_link = time_link_;
        const bool stopping = stopping_;
        socket_.listen_to(wanted_ids(kept_.site_in_force(), bus_clock_));
        begin();
        time_link_ = time_link;
        stopping_ = stopping;
        if (stopping_) {
            elmopp_controller_stop(&controller());
        }
    }

    /// What the keeper says, and what is new from now on.
    void keep() {
        std::array<elmopp_frame_t, ELMOPP_KEEPER_FRAMES> out{};
        std::uint32_t count = 0;
        const elmopp_keeper_change_t change = elmopp_keeper_tick(&kept_.keeper(), &controller(), out.data(), &count);
        for (std::uint32_t k = 0; k < count; ++k) {
            (void)(bus_clock_ ? socket_.send_surely(out.at(k)) : socket_.send(out.at(k)));
        }
        kept_.tell();
        if (change == ELMOPP_KEEPER_BEGIN) {
            begin_with_other_site();
            if (kept_.keeper().fault != ELMOPP_FAULT_NONE) {
                elmopp_controller_report(&controller(), kept_.keeper().fault);
            }
        } else if (change == ELMOPP_KEEPER_USE_WEIGHTS) {
            const elmopp_station_weights_t weights = kept_.weights_in_force();
            elmopp_station_use_weights(station_.get(), &weights);
        }
        kept_.work();
    }

    void tick(elmopp_ms_t now_ms) {
        std::array<elmopp_frame_t, ELMOPP_FRAMES_PER_TICK> out{};
        const std::uint32_t count = elmopp_controller_tick(&controller(), now_ms, out.data());
        const bool decided = elmopp_bus_clock_decided(out.data(), count);
        if (bus_clock_) {
            answer(out.data(), count, decided);
        } else {
            for (std::uint32_t k = 0; k < count; ++k) {
                (void)socket_.send(out.at(k));
            }
        }
        if (decided) {
            log_.write(controller());
        }
        if (count > 0) {
            tell_service();
            keep();
        }
        done_ = done_ || (stopping_ && elmopp_controller_has_stopped(&controller()));
    }

    void tell_service() {
        const bool news = reporter_.look(controller().mode, controller().fault, socket_.troubles());
        (void)sd_notify(0, ready_ ? "WATCHDOG=1" : "READY=1\nWATCHDOG=1");
        ready_ = true;
        if (news) {
            (void)sd_notify(0, ("STATUS=" + reporter_.status()).c_str());
        }
    }

    bool bus_clock_;
    Kept &kept_;
    StreetLog log_;
    CanSocket socket_;
    Wakeups wakeups_;
    std::unique_ptr<elmopp_station_t> station_;
    std::unique_ptr<LearningRoom> room_;
    BusLog reporter_;
    elmopp_link_t time_link_{};
    std::uint8_t trace_counter_ = 0;
    std::uint64_t missed_ = 0;
    bool ready_ = false;
    bool reset_held_ = false;
    bool stopping_ = false;
    bool done_ = false;
};

void check_clock(const Request &request) {
    if (request.clock != "real" && request.clock != "bus") {
        throw BadRequest("--clock \"" + request.clock + "\": right would be real or bus");
    }
}

void check_weights(const Request &request, const elmopp_junction_t &junction, const elmopp_weights_t &weights) {
    const bool nested = elmopp_forecast_is_nested(junction.forecast);
    if (!elmopp_forecast_fits(junction.forecast, &weights)) {
        if (elmopp_forecast_is_network(junction.forecast) && nested == (weights.lstm.levels > 1)) {
            throw BadRequest("--weights " + request.weights + ": " + overflow_of(weights) +
                             "; right would be arithmetic = \"float\" in the site");
        }
        const std::string wanted = nested ? "nlstm" : "lstm";
        throw BadRequest(
            "--weights " + request.weights + ": " + std::to_string(weights.lstm.levels) + " level(s); right would be " +
            (elmopp_forecast_is_network(junction.forecast) ? "a network of forecast " + wanted
                                                           : std::string("none: the site forecasts without")));
    }
}

void run(const Request &request) {
    const elmopp_junction_t junction = read_street(request.site);
    check_clock(request);
    std::unique_ptr<elmopp_weights_t> given;
    if (!request.weights.empty()) {
        given = std::make_unique<elmopp_weights_t>(read_weights(request.weights));
        check_weights(request, junction, *given);
    }
    Kept kept(request.store, junction, given.get());
    check_can(program_name, request.can);
    Program program(request, kept);
    (void)mlockall(MCL_CURRENT | MCL_FUTURE); // a page fault may be late; without the right to lock it goes on
    program.run();
    say_it("stopped; " + std::to_string(program.missed()) + " lamp ticks were missed");
}

void add_options(CLI::App &app, Request &request) {
    app.description("elmopp-controller: runs the signals of one junction over a CAN bus.");
    app.footer("SIGTERM: all red, then the end. SIGUSR1 and SIGUSR2: the local reset input is held, and let go.\n"
               "Exit codes: 0 stopped as asked, 1 it ran and failed, 2 the request cannot be run (one line says why).\n"
               "Start with: elmopp-controller --can vcan0 --site sites/four_way.toml");
    add_bus_options(app, request.can, request.site);
    app.add_option("--weights", request.weights, "ELMW image instead of the shipped network")->type_name("FILE");
    app.add_option("--store", request.store,
                   "Folder for weights and a site that come over the bus, and for what a site with learning = true has "
                   "learnt; what is kept there is in force")
        ->type_name("FOLDER");
    app.add_option("--clock", request.clock, "real, or bus: a simulator's SimTime frames are the lamp ticks")
        ->type_name("NAME")
        ->capture_default_str();
    app.add_option("--log", request.log, "Decision log to append to, JSON lines")->type_name("FILE");
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    return elmopp::run_program(elmopp::program_name, argc, argv, elmopp::add_options, elmopp::run);
}

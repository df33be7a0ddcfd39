// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "bus.hpp"

#include "csv.hpp"
#include "error.hpp"

extern "C" {
#include "elmopp_can.h"
}

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

namespace elmopp {
namespace {

constexpr double bus_ticks_per_s = 10.0;
constexpr std::uint32_t node_step_ms = 20;
constexpr double for_ever_s = 1e9;
const std::set<std::string> camera_troubles{"black", "freeze", "turn", "gone"};

[[noreturn]] void refuse_trouble(const std::string &word, const std::string &right) {
    throw BadRequest("--faults \"" + word + "\": right would be " + right);
}

bool is_counts(const elmopp_frame_t &frame) {
    return frame.id - ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID < ELMOPP_APPROACH_MAX;
}

std::uint16_t both(std::uint32_t one, std::uint32_t other) {
    return static_cast<std::uint16_t>(one | other);
}

double seconds_of(const std::string &word, const std::string &text) {
    double value = 0.0;
    if (!parse_number(text, value) || value < 0.0) {
        refuse_trouble(word, "KIND:WHO@FROM-TO with seconds from 0 on");
    }
    return value;
}

void check_who(const std::string &word, const Trouble &trouble, const elmopp_junction_t &site) {
    if (trouble.kind == "reset") {
        if (!trouble.who.empty()) {
            refuse_trouble(word, "reset@FROM or reset@FROM-TO");
        }
        return;
    }
    if (trouble.kind == "lose") {
        double percent = 0.0;
        if (!parse_number(trouble.who, percent) || percent < 0.0 || percent > 100.0) {
            refuse_trouble(word, "lose:PERCENT@FROM-TO with 0 to 100");
        }
        return;
    }
    if (camera_troubles.count(trouble.kind) == 0) {
        refuse_trouble(word, "one of black, freeze, turn, gone, lose, reset");
    }
    std::string names = "all";
    bool known = trouble.who == "all";
    for (std::size_t i = 0; i < site.approach_count; ++i) {
        names += std::string(", ") + std::begin(site.approach_name[i]);
        known = known || trouble.who == std::begin(site.approach_name[i]);
    }
    if (!known) {
        refuse_trouble(word, trouble.kind + ":WHO with one of " + names);
    }
}

} // namespace

std::vector<Trouble> parse_troubles(const std::string &text, const elmopp_junction_t &site) {
    std::vector<Trouble> troubles;
    std::istringstream words(text);
    for (std::string word; std::getline(words, word, ',');) {
        const std::size_t at = word.find('@');
        if (at == std::string::npos) {
            refuse_trouble(word, "KIND:WHO@FROM-TO");
        }
        const std::string what = word.substr(0, at);
        const std::string when = word.substr(at + 1);
        const std::size_t colon = what.find(':');
        const std::size_t dash = when.find('-');
        Trouble trouble{what.substr(0, colon), colon == std::string::npos ? "" : what.substr(colon + 1),
                        seconds_of(word, when.substr(0, dash)), for_ever_s};
        if (dash != std::string::npos) {
            trouble.to_s = seconds_of(word, when.substr(dash + 1));
        }
        if (trouble.to_s <= trouble.from_s) {
            refuse_trouble(word, "an end after the beginning");
        }
        check_who(word, trouble, site);
        troubles.push_back(trouble);
    }
    return troubles;
}

StreetBus::StreetBus(const elmopp_junction_t &site, ControllerMaker maker, Reset reset, std::vector<Film *> films,
                     const std::vector<Place> &places, std::vector<Trouble> troubles, std::uint64_t seed)
    : site_(site), maker_(std::move(maker)), reset_(std::move(reset)), controller_(maker_()), films_(std::move(films)),
      places_(places), troubles_(std::move(troubles)), chance_(seed), witness_(site) {
    for (const Film *film : films_) {
        cameras_.emplace_back(film->lanes());
    }
    for (std::uint32_t n = 0; n < ELMOPP_NODE_MAX; ++n) {
        if (elmopp_mask_has(elmopp_junction_nodes(&site_), n)) {
            elmopp_lamp_node_init(&nodes_.emplace_back(), &site_, n);
        }
    }
}

void StreetBus::begin() {
    begun_ticks_ = ticks_;
    for (Film *film : films_) {
        film->begin();
    }
    second_ = {};
}

double StreetBus::run_s() const {
    return begun_ticks_ < 0 ? -1.0 : static_cast<double>(ticks_ - begun_ticks_) / bus_ticks_per_s;
}

const Trouble *StreetBus::trouble_now(const std::string &kind, const std::string &who) const {
    const double now_s = run_s();
    const auto found = std::find_if(troubles_.begin(), troubles_.end(), [&](const Trouble &trouble) {
        const bool meant = who.empty() || trouble.who == who || trouble.who == "all";
        return trouble.kind == kind && meant && now_s >= trouble.from_s && now_s < trouble.to_s;
    });
    return found == troubles_.end() ? nullptr : &*found;
}

CameraTrouble StreetBus::trouble_of(std::size_t approach) const {
    const std::string who = std::begin(site_.approach_name[approach]);
    static const std::vector<std::pair<std::string, CameraTrouble>> kinds{{"gone", CameraTrouble::gone},
                                                                          {"black", CameraTrouble::black},
                                                                          {"freeze", CameraTrouble::freeze},
                                                                          {"turn", CameraTrouble::turn}};
    for (const auto &[kind, trouble] : kinds) {
        if (trouble_now(kind, who) != nullptr) {
            return trouble;
        }
    }
    return CameraTrouble::none;
}

void StreetBus::look() {
    const double t_s = static_cast<double>(ticks_) / bus_ticks_per_s;
    for (Film *film : films_) {
        film->look(places_, shown_, trouble_of(film->approach()), t_s);
    }
    if (looked) {
        looked(t_s);
    }
}

/// What the counters say, in place of what the simulator knows.
void StreetBus::tell(std::vector<elmopp_frame_t> &frames) {
    const auto kept = std::remove_if(frames.begin(), frames.end(), is_counts);
    if (kept == frames.end()) {
        return;
    }
    frames.erase(kept, frames.end());
    second_.records.clear();
    for (std::size_t c = 0; c < films_.size(); ++c) {
        const Record record = films_[c]->record();
        const auto counts = cameras_[c].counts(record);
        frames.insert(frames.end(), counts.begin(), counts.end());
        second_.records.push_back(record);
    }
}

/// Each reset of the list once.
void StreetBus::pull_or_put_plug() {
    const auto due = std::find_if(troubles_.begin(), troubles_.end(), [this](const Trouble &trouble) {
        return trouble.kind == "reset" && run_s() >= trouble.from_s;
    });
    if (controller_ && (std::uint32_t{shown_.green} & ~std::uint32_t{shown_.flash}) != 0U && due != troubles_.end()) {
        const double out_s = due->to_s < for_ever_s ? due->to_s - due->from_s : 0.0;
        back_ticks_ = ticks_ + std::lround(out_s * bus_ticks_per_s);
        troubles_.erase(due);
        controller_.reset();
        reset_();
        second_.reset = true;
    }
    if (!controller_ && ticks_ >= back_ticks_) {
        controller_ = maker_();
    }
    second_.silent = !controller_;
}

std::vector<elmopp_frame_t> StreetBus::carried(const std::vector<elmopp_frame_t> &frames) {
    const Trouble *const trouble = trouble_now("lose", "");
    if (trouble == nullptr) {
        return frames;
    }
    double percent = 0.0;
    (void)parse_number(trouble->who, percent);
    std::vector<elmopp_frame_t> kept;
    for (const elmopp_frame_t &frame : frames) {
        if (chance_.uniform() * 100.0 < percent) {
            ++second_.lost;
        } else {
            kept.push_back(frame);
        }
    }
    return kept;
}

void StreetBus::light(const std::vector<elmopp_frame_t> &frames) {
    shown_ = {};
    for (elmopp_lamp_node_t &node : nodes_) {
        for (const elmopp_frame_t &frame : frames) {
            (void)elmopp_lamp_node_take(&node, &frame);
        }
        for (std::uint32_t passed = 0; passed < ELMOPP_CONTROLLER_TICK_MS; passed += node_step_ms) {
            elmopp_lamp_node_pass(&node, node_step_ms);
        }
        shown_.red = both(shown_.red, node.lamps.red);
        shown_.amber = both(shown_.amber, node.lamps.amber);
        shown_.green = both(shown_.green, node.lamps.green);
        shown_.flash = both(shown_.flash, node.lamps.flash);
    }
    witness_.see(shown_);
    second_.shown.push_back(shown_);
}

std::vector<elmopp_frame_t> StreetBus::tick(const std::vector<elmopp_frame_t> &frames, elmopp_ms_t now_ms) {
    pull_or_put_plug();
    std::vector<elmopp_frame_t> sent = frames;
    if (!films_.empty()) {
        look();
        tell(sent);
    }
    for (elmopp_lamp_node_t &node : nodes_) {
        elmopp_lamps_t measured = node.lamps;
        measured.flash = 0; // a lamp that goes on and off is on or off when it is looked at
        sent.push_back(elmopp_lamp_node_feedback(&node, &measured, false));
    }
    const auto heard = carried(sent);
    const auto answers = controller_ ? carried(controller_->tick(heard, now_ms)) : std::vector<elmopp_frame_t>();
    light(answers);
    ++ticks_;
    return answers;
}

BusSecond StreetBus::take_second() {
    BusSecond taken;
    std::swap(taken, second_);
    second_.records = taken.records; // until the next ones
    return taken;
}

} // namespace elmopp

// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "transfer_words.hpp"

#include "core.hpp"

extern "C" {
#include "elmopp/fault.h"
#include "elmopp/site.h"
}

namespace elmopp {
namespace {

std::string state_of(const elmopp_transfer_report_t &report) {
    switch (report.state) {
    case ELMOPP_TRANSFER_IDLE:
        return "nothing has come";
    case ELMOPP_TRANSFER_RECEIVING:
        return "being received";
    case ELMOPP_TRANSFER_ON_TRIAL:
        return "on trial, " + std::to_string(report.left_s) + " s to go; a reset brings the old one back";
    case ELMOPP_TRANSFER_STORING:
        return "has run without a fault and is being written";
    case ELMOPP_TRANSFER_KEPT:
        return "kept: it outlives a reset";
    case ELMOPP_TRANSFER_REFUSED:
        return "refused";
    case ELMOPP_TRANSFER_WITHDRAWN:
        return "withdrawn, the old one runs again";
    }
    return "in no state";
}

/// What is wrong inside of an image that came whole. A controller of another version may name what this one does not
/// know.
std::string content_of(const elmopp_transfer_report_t &report) {
    if (report.kind != ELMOPP_TRANSFER_SITE) {
        return report.first < ELMOPP_WEIGHTS_FAULT_COUNT
                   ? elmopp_weights_fault_name(static_cast<elmopp_weights_fault_t>(report.first))
                   : "a rule that this program does not know";
    }
    if (report.first >= ELMOPP_SITE_FAULT_COUNT) {
        return "rule " + std::to_string(report.first) + ", which this program does not know";
    }
    return std::string(elmopp_site_fault_name(static_cast<elmopp_site_fault_t>(report.first))) + ": number " +
           std::to_string(report.second) + " of it, counted from 0";
}

std::string fault_of(const elmopp_transfer_report_t &report) {
    const char *const name =
        report.first < ELMOPP_FAULT_COUNT ? elmopp_fault_name(static_cast<elmopp_fault_t>(report.first)) : "unknown";
    return std::string("there is a fault: ") + name + ", group " + std::to_string(report.second);
}

std::string reason_of(const elmopp_transfer_report_t &report) {
    switch (report.reason) {
    case ELMOPP_TRANSFER_NO_REASON:
        return "";
    case ELMOPP_TRANSFER_BUSY:
        return "another one is being received, on trial or being written";
    case ELMOPP_TRANSFER_LENGTH:
        return "this controller reads nothing of this length";
    case ELMOPP_TRANSFER_ORDER:
        return "a segment was lost, repeated or out of order";
    case ELMOPP_TRANSFER_SILENCE:
        return "the sender stopped in the middle";
    case ELMOPP_TRANSFER_BY_HAND:
        return "somebody has put one into the board by hand, and that is in force";
    case ELMOPP_TRANSFER_NOT_SAFE:
        return "a site is taken only while the local key is held and the lamps flash or are dark";
    case ELMOPP_TRANSFER_FULL:
        return "there is no room to keep it until the next start, or no store at all";
    case ELMOPP_TRANSFER_MAGIC:
        return "it is no such image";
    case ELMOPP_TRANSFER_VERSION:
        return "its layout is another version";
    case ELMOPP_TRANSFER_CHECKSUM:
        return "the checksum does not fit the bytes";
    case ELMOPP_TRANSFER_CONTENT:
        return content_of(report);
    case ELMOPP_TRANSFER_NETWORK:
        return "the site has no use for this network";
    case ELMOPP_TRANSFER_SIMULATION:
        return "it is simulation_only and never drives lamps";
    case ELMOPP_TRANSFER_FAULT:
        return fault_of(report);
    case ELMOPP_TRANSFER_DISTRUSTED:
        return "its forecast was no better than the mean";
    case ELMOPP_TRANSFER_MEDIUM:
        return "it could not be written";
    case ELMOPP_TRANSFER_TOO_SOON:
        return "the last one was stored only just now";
    }
    return "";
}

} // namespace

std::string in_words(const elmopp_transfer_report_t &report) {
    const std::string what = report.kind == ELMOPP_TRANSFER_WEIGHTS ? "weights"
                             : report.kind == ELMOPP_TRANSFER_SITE  ? "site"
                                                                    : "image";
    const std::string reason = reason_of(report);
    return what + ": " + state_of(report) + (reason.empty() ? "" : ", " + reason);
}

} // namespace elmopp

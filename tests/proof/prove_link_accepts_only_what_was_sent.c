/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Whatever frame comes, in whatever state the receiver is: what is believed has the id, eight bytes, the checksum that
/// a sender's seal would have given it, and a counter that is next; what is not believed changes nothing.

#include "claims.h"

#include "elmopp/link.h"

elmopp_link_t nondet_link(void);
elmopp_frame_t nondet_frame(void);

void harness(void) {
    elmopp_link_t link = nondet_link();
    const elmopp_link_t before = link;
    const elmopp_frame_t frame = nondet_frame();
    const uint16_t id = nondet_u16();
    const uint16_t timeout_ds = nondet_u16();
    ASSUME(before.counter < ELMOPP_LINK_COUNTERS);

    if (elmopp_link_take(&link, &frame, id, timeout_ds) == ELMOPP_LINK_OK) {
        uint8_t counter = (uint8_t)(frame.data[0] & 0x0FU);
        const uint32_t ahead = (counter + ELMOPP_LINK_COUNTERS - before.counter) % ELMOPP_LINK_COUNTERS;
        CLAIM((frame.id == id) && (frame.length == ELMOPP_LINK_BYTES), "it is for us and whole");
        CLAIM(counter < ELMOPP_LINK_COUNTERS, "its counter exists");
        CLAIM((!before.started) || (before.age_ds >= timeout_ds) || ((ahead >= 1U) && (ahead <= ELMOPP_LINK_LOST_MAX)),
              "its counter is next");
        elmopp_frame_t sent = frame;
        elmopp_link_seal(&sent, &counter);
        CLAIM((sent.data[0] == frame.data[0]) && (sent.data[7] == frame.data[7]), "a sender would have sealed it so");
        CLAIM(link.started && (link.age_ds == 0U) && (link.counter == (frame.data[0] & 0x0FU)), "it is remembered");
    } else {
        CLAIM((link.started == before.started) && (link.age_ds == before.age_ds) && (link.counter == before.counter),
              "what is not believed changes nothing");
    }
    REACHABLE();
}

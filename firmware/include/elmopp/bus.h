/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Bus: whom the controller hears, what they last said, and whether it still counts.
///
/// Keeps a receiver for every sender that the site names: a camera an approach, the lamp nodes, the junction camera,
/// the neighbours and the one who commands. It says which frames are believed (link.h) and keeps what lamp nodes,
/// junction camera and neighbours said; a camera's counts and a command are handed on to whoever keeps those.
///
/// Silence. What was heard counts for three of its cycle times (the DBC's), a node's feedback for two ticks more.
/// A junction camera that has fallen silent has nobody standing in the junction; a neighbour that has, says nothing.
///
/// It moves no lamp, raises no fault, obeys no command and sends nothing. One owner, the controller.

#ifndef ELMOPP_BUS_H
#define ELMOPP_BUS_H

#include "elmopp/junction.h"
#include "elmopp/lamps.h"
#include "elmopp/link.h"
#include "elmopp/outflow.h"

/// Read it; nobody but this room writes it.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_link_t camera[ELMOPP_APPROACH_MAX];
    elmopp_link_t neighbour[ELMOPP_APPROACH_MAX];
    elmopp_link_t node[ELMOPP_NODE_MAX];
    elmopp_link_t junction_camera;
    elmopp_link_t command;
    elmopp_outflow_t outflow[ELMOPP_APPROACH_MAX]; ///< what neighbours have said, as of the last second
    elmopp_lamps_t measured;                       ///< all nodes together
    uint8_t used_nodes;                            ///< mask
    uint8_t unwell_nodes;                          ///< mask: a lamp fault, or flashing by themselves
    uint8_t refused;                               ///< frames and commands, modulo 256
    bool occupied; ///< the junction camera knows that somebody stands in the junction, as last heard
} elmopp_bus_t;

/// What a frame was.
typedef enum {
    ELMOPP_NEWS_NOT_OURS = 0, ///< nobody listens to that id here
    ELMOPP_NEWS_REFUSED,      ///< repeated, out of order or corrupt; counted, and nothing else has changed
    ELMOPP_NEWS_KEPT,         ///< what it said is in the state
    ELMOPP_NEWS_COUNTS,       ///< believed: a camera's counts of `approach`
    ELMOPP_NEWS_COMMAND,      ///< believed: a command
    ELMOPP_NEWS_SECOND        ///< a controller's own words, from somebody else
} elmopp_news_kind_t;

typedef struct {
    elmopp_news_kind_t kind;
    uint32_t approach; ///< of ELMOPP_NEWS_COUNTS
} elmopp_news_t;

/// Nothing heard yet. The junction has passed elmopp_site_check() and outlives it.
void elmopp_bus_init(elmopp_bus_t *self, const elmopp_junction_t *junction);

/// Offers one received frame.
elmopp_news_t elmopp_bus_hear(elmopp_bus_t *self, const elmopp_frame_t *frame);

/// So many more frames or commands were refused elsewhere.
void elmopp_bus_refuse(elmopp_bus_t *self, uint32_t count);

/// A lamp tick passes.
void elmopp_bus_tick(elmopp_bus_t *self);

/// A second passes: what neighbours said gets older, and is nothing once they have fallen silent.
void elmopp_bus_second(elmopp_bus_t *self);

/// Mask of the signal groups whose node still counts.
uint16_t elmopp_bus_fresh_groups(const elmopp_bus_t *self);

/// True if somebody is known to stand in the junction now.
bool elmopp_bus_is_occupied(const elmopp_bus_t *self);

#endif

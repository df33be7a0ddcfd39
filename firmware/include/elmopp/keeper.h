/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Keeper: which weights and which site are in force, how new ones come, and what outlives a reset.
///
/// Images come over the bus (transfer.h) into the keeper's one buffer, or from whoever has learned. What has come is
/// checked as a whole before anybody uses it: checksum, weights_check or site_check, and whether it fits. Then it runs
/// from the buffer, on trial. When it has run for ELMOPP_KEEPER_TRIAL_DS with lamps under the plan and without a fault
/// it is written into its store (store.h), and only then does it outlive a reset. Until then the old one is what a
/// reset brings back, and what a fault brings back at once.
///
/// Nothing is received while a fault is latched, or while something is being received, on trial or being written.
/// *Weights* are received at any other time: they can change what a chooser wishes and no more. *A site* is received,
/// and put to use, only while the local key is held and the lamps flash or are dark: nobody on the bus alone can change
/// intergreens. It is put to use by beginning anew, through Starting. At the end of their trial weights must not be
/// distrusted by their own account.
///
/// What is learnt on (learner.h) is stored by itself when that is worth it by the learner's own account, the forecast
/// is its own and trusted, and no fault is latched: at most once in `save_min_s`, of which as much must have passed
/// since the start. A medium that is only erased before lamps are driven has room for a sector of slots after a start,
/// and the last of them is left to whoever sends something: so learning takes one slot less, and after the first the
/// next one follows ELMOPP_KEEPER_LATER times as late. It happens in a tick in which nobody decides or learns.
///
/// An image that was complete once and is none any more is damage, and is named: whoever starts with what is left
/// should say so (elmopp_keeper_is_damaged()).
///
/// It decides nothing about lamps and touches no medium: it gives orders to whoever owns that (store.h), and tells the
/// main what to use. A call does what one frame or one lamp tick asks for and is bounded.
///
/// No allocation; the one buffer has room for the larger of the two images. Not thread-safe; one owner, the main. Not
/// movable: what it lends points into it.

#ifndef ELMOPP_KEEPER_H
#define ELMOPP_KEEPER_H

#include "elmopp/controller.h"
#include "elmopp/store.h"
#include "elmopp/transfer.h"
#include "elmopp/weights.h"

/// Five minutes: as long as the account of a forecast looks back (account.h).
#define ELMOPP_KEEPER_TRIAL_DS 3000U

/// So much later is what is learnt stored a second time, and so on, where slots cannot be had again before a start.
#define ELMOPP_KEEPER_LATER 30U

/// Ticks after a decision in which what was learnt is stored: neither the decision's nor the one of learning (pilot.h).
#define ELMOPP_KEEPER_SAVE_DS 8U

/// Frames that one tick writes at most: flow control, a report, and one to a second sender.
#define ELMOPP_KEEPER_FRAMES 3U

/// Orders that tidying up at the start takes at most, of all sectors there may be.
#define ELMOPP_KEEPER_TIDY_ORDERS_MAX 64U

#define ELMOPP_KEEPER_IMAGE_MAX (ELMOPP_IMAGE_HEADER + (uint32_t)sizeof(elmopp_weights_t))
#define ELMOPP_KEEPER_STORES 2U

/// What a keeper is made of.
typedef struct {
    elmopp_store_medium_t weights; ///< where weights are kept; without bytes: nowhere
    elmopp_store_medium_t site;
    bool weights_by_hand; ///< somebody has put weights into the board, which are in force: none are received
    bool site_by_hand;
    uint32_t save_min_s; ///< between two stores of what was learnt, and before the first: wear
} elmopp_keeper_config_t;

/// What the main has to do after a tick.
typedef enum {
    ELMOPP_KEEPER_GO_ON = 0,
    ELMOPP_KEEPER_USE_WEIGHTS, ///< others are in force: elmopp_controller_use_weights()
    ELMOPP_KEEPER_BEGIN        ///< another site is in force: begin anew, and report `fault` if there is one
} elmopp_keeper_change_t;

/// State. Set up by elmopp_keeper_init(); read `told` for people, write nothing.
typedef struct {
    elmopp_keeper_config_t config;
    elmopp_store_t store[ELMOPP_KEEPER_STORES]; ///< weights, site
    elmopp_transfer_t transfer;
    elmopp_transfer_report_t told; ///< how it stands, as in the next report
    elmopp_fault_t fault;          ///< that ended a site's trial
    elmopp_junction_t site;        ///< in force, if `has_site`
    const uint8_t *weights_image;  ///< in force; null: none of this keeper's
    uint32_t buffer[ELMOPP_KEEPER_IMAGE_MAX / ELMOPP_STORE_WORD];
    uint32_t quiet_ds;                  ///< since the start or the last save; saturates
    uint16_t trial_ds;                  ///< so far
    uint16_t failed;                    ///< of the store, when writing began
    uint16_t told_ds;                   ///< age of the last report
    uint16_t refused;                   ///< frames and images since the last tick
    uint16_t saved;                     ///< images written since the start; saturates
    uint16_t lessons;                   ///< stores of what was learnt that have begun since the start; saturates
    bool damaged[ELMOPP_KEEPER_STORES]; ///< at the start
    bool has_site;
    bool learned; ///< what is being written was learnt here
    bool whole;   ///< everything has come and is yet to be checked
    bool news;    ///< a report is due
    bool second;  ///< somebody else wants to send
} elmopp_keeper_t;

/// Finds what is stored. Orders may follow at once (elmopp_keeper_next()), to tidy up: they are carried out before
/// lamps are driven.
void elmopp_keeper_init(elmopp_keeper_t *self, const elmopp_keeper_config_t *config);

/// What is in force, of what has come over the bus or been learned; null: nothing, use what is compiled in. A site has
/// passed its check and may drive lamps. Whether the weights fit the site is for the caller to ask.
const elmopp_junction_t *elmopp_keeper_site(const elmopp_keeper_t *self);
const elmopp_weights_t *elmopp_keeper_weights(const elmopp_keeper_t *self);

/// Whether what was stored last had been damaged when the keeper began: what it has instead is older, or nothing.
bool elmopp_keeper_is_damaged(const elmopp_keeper_t *self, elmopp_transfer_kind_t kind);

/// Offers a received frame. True if it was one of Transfer, whatever became of it.
bool elmopp_keeper_take(elmopp_keeper_t *self, const elmopp_controller_t *controller, const elmopp_frame_t *frame);

/// After each elmopp_controller_tick() that was due. Writes the frames to send; refused frames are counted with the
/// controller's. On ELMOPP_KEEPER_BEGIN the controller must begin anew before its next tick: its site has changed.
elmopp_keeper_change_t elmopp_keeper_tick(elmopp_keeper_t *self, elmopp_controller_t *controller,
                                          elmopp_frame_t out[ELMOPP_KEEPER_FRAMES], uint32_t *count);

/// Begins to store weights that have been learned and are in use: they are copied, so that they may go on changing. The
/// tick does so by itself for a forecast with a learner. ELMOPP_TRANSFER_NO_REASON if it has begun; otherwise why not,
/// and nothing is changed: ELMOPP_TRANSFER_CONTENT,
/// _NETWORK, _FAULT, _BUSY, _BY_HAND, _FULL or _TOO_SOON. When `told` is ELMOPP_TRANSFER_KEPT they outlive a reset;
/// what runs is not touched.
elmopp_transfer_reason_t elmopp_keeper_save(elmopp_keeper_t *self, const elmopp_controller_t *controller,
                                            const elmopp_weights_t *weights);

/// The next order to the medium of this kind, and what became of it (store.h). False: nothing is to be done.
bool elmopp_keeper_next(const elmopp_keeper_t *self, elmopp_transfer_kind_t *kind, elmopp_store_order_t *order);
void elmopp_keeper_answer(elmopp_keeper_t *self, elmopp_transfer_kind_t kind, elmopp_store_answer_t answer);

#endif

/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The keeper beside a whole controller on its bench: new weights and a new site run on trial, are kept when they have
/// run well and outlive a reset then; whatever else may happen to them is refused by its name and leaves the old ones.

#include "elmopp/keeper.h"
#include "elmopp/site.h"

#include "elmopp_weights.h"
#include "image_writer.h"
#include "keeper_bench.h"
#include "segments.h"
#include "sites.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define WEIGHTS_BYTES KEEPER_BENCH_WEIGHTS_BYTES
#define SITE_BYTES KEEPER_BENCH_SITE_BYTES
#define SAVE_MIN_S 100U
#define SEGMENTS_MAX 5000U

static keeper_bench_t board;
static uint8_t image[WEIGHTS_BYTES];

/* The sender. */
static const uint8_t *bytes;
static uint32_t length;
static uint32_t index_to_send;
static uint32_t lost; /* index of a frame that nobody hears */

static void send_what_may_be(void) {
    for (; (board.may_send > 0U) && (index_to_send < segments_count(length)); board.may_send--) {
        const elmopp_frame_t frame = segments_frame(bytes, length, index_to_send);
        if (index_to_send != lost) {
            TEST_ASSERT_TRUE(elmopp_keeper_take(&board.keeper, &board.bench.controller, &frame));
        }
        index_to_send++;
    }
}

static void tick(void) {
    send_what_may_be();
    keeper_bench_tick(&board);
}

static void ticks(uint32_t count) {
    for (uint32_t k = 0U; k < count; k++) {
        tick();
    }
}

static void until_mode(elmopp_mode_t mode) {
    for (uint32_t k = 0U; (board.bench.controller.mode != mode) && (k < 2000U); k++) {
        tick();
    }
    TEST_ASSERT_EQUAL_INT(mode, board.bench.controller.mode);
}

static void until_state(elmopp_transfer_state_t state, uint32_t limit) {
    for (uint32_t k = 0U; (board.report.state != state) && (k < limit); k++) {
        tick();
    }
    TEST_ASSERT_EQUAL_INT(state, board.report.state);
}

/* --- what is sent --- */

static void make_weights(const elmopp_weights_t *weights) {
    (void)memcpy(&image[16], weights, sizeof *weights);
    image_seal(image, "ELMW", ELMOPP_WEIGHTS_VERSION_NOW, (uint32_t)sizeof *weights);
}

/* Good weights that are not those compiled in; `which` tells them apart. */
static void make_other_weights(uint32_t which) {
    static elmopp_weights_t other;
    other = elmopp_weights_lstm;
    other.gcn.head[0] += 0.001F * (float)(which + 1U);
    make_weights(&other);
}

static void make_site(const elmopp_junction_t *site) {
    (void)memcpy(&image[16], site, sizeof *site);
    image_seal(image, "ELMS", ELMOPP_SITE_IMAGE_VERSION_NOW, (uint32_t)sizeof *site);
}

static void make_other_site(void) {
    elmopp_junction_t other = board.first_site;
    other.intergreen_ds[0][1] = (uint16_t)(other.intergreen_ds[0][1] + 7U);
    make_site(&other);
}

static uint16_t id_of(const uint8_t *of) {
    return (uint16_t)(~image_checksum(&of[16], (uint32_t)sizeof(elmopp_weights_t)) & 0xFFFU);
}

static void offer(uint32_t size) {
    bytes = image;
    length = size;
    index_to_send = 0U;
    board.may_send = 1U;
    lost = KEEPER_BENCH_NEVER;
    board.report = (elmopp_transfer_report_t){.state = ELMOPP_TRANSFER_IDLE};
    board.reports = 0U;
    board.busy_reports = 0U;
}

static void offer_weights(uint32_t which) {
    make_other_weights(which);
    offer(WEIGHTS_BYTES);
}

static void expect(elmopp_transfer_kind_t kind, elmopp_transfer_state_t state, elmopp_transfer_reason_t reason) {
    until_state(state, 400U);
    TEST_ASSERT_EQUAL_INT(reason, board.report.reason);
    TEST_ASSERT_EQUAL_INT(kind, board.report.kind);
}

static void expect_refused(elmopp_transfer_kind_t kind, elmopp_transfer_reason_t reason) {
    const uint8_t before = board.bench.controller.bus.refused;
    const uint16_t id = board.bench.controller.weights_id;
    const uint32_t begun = board.begins;
    expect(kind, ELMOPP_TRANSFER_REFUSED, reason);
    TEST_ASSERT_TRUE(board.bench.controller.bus.refused != before);
    TEST_ASSERT_EQUAL_UINT16(id, board.bench.controller.weights_id);
    TEST_ASSERT_EQUAL_UINT32(begun, board.begins);
}

static void start(uint32_t groups) {
    elmopp_junction_t site = bench_cross(groups);
    site.forecast = ELMOPP_FORECAST_LSTM;
    length = 0U;
    index_to_send = 0U;
    keeper_bench_start(&board, &site, &elmopp_weights_lstm, SAVE_MIN_S);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    board.erases = 0U;
    board.begins = 0U;
}

void setUp(void) {
    start(4U);
}

void tearDown(void) {
    bench_expect_good_street(&board.bench);
}

/* --- weights --- */

static void test_new_weights_run_on_trial_are_kept_and_outlive_a_reset(void) {
    const uint16_t shipped = board.bench.controller.weights_id;
    offer_weights(0U);
    const uint32_t from = board.bench.ticks;
    expect(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_ON_TRIAL, ELMOPP_TRANSFER_NO_REASON);
    TEST_ASSERT_UINT32_WITHIN(10U, SEGMENTS_MAX / ELMOPP_TRANSFER_BLOCK, board.bench.ticks - from); /* a block a tick */
    const uint16_t sent = id_of(image);
    TEST_ASSERT_NOT_EQUAL_UINT16(shipped, sent);
    TEST_ASSERT_EQUAL_UINT16(sent, board.bench.controller.weights_id);
    TEST_ASSERT_EQUAL_UINT16(300U, board.report.left_s);
    ticks(ELMOPP_KEEPER_TRIAL_DS - 100U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_ON_TRIAL, board.report.state);
    TEST_ASSERT_UINT16_WITHIN(1U, 10U, board.report.left_s);
    until_state(ELMOPP_TRANSFER_STORING, 110U);
    until_state(ELMOPP_TRANSFER_KEPT, 200U);
    TEST_ASSERT_EQUAL_UINT8(1U, board.report.saved);
    TEST_ASSERT_EQUAL_UINT16(sent, board.bench.controller.weights_id);
    TEST_ASSERT_EQUAL_UINT32(0U, board.erases);
    (void)memset(board.keeper.buffer, 0, sizeof board.keeper.buffer); /* nobody uses it any more */
    ticks(700U);                                                      /* longer than the watch over the weights takes */
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, board.bench.controller.fault);
    keeper_bench_power_up(&board);
    TEST_ASSERT_EQUAL_UINT16(sent, board.bench.controller.weights_id);
    TEST_ASSERT_EQUAL_MEMORY(&image[16], elmopp_keeper_weights(&board.keeper), sizeof(elmopp_weights_t));
}

static void test_a_reset_in_the_trial_or_while_they_are_written_brings_the_old_weights_back(void) {
    const uint16_t shipped = board.bench.controller.weights_id;
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 400U);
    ticks(1000U);
    keeper_bench_power_up(&board);
    TEST_ASSERT_EQUAL_UINT16(shipped, board.bench.controller.weights_id);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    offer_weights(1U);
    until_state(ELMOPP_TRANSFER_STORING, 4000U);
    ticks(20U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_STORING, board.keeper.told.state);
    keeper_bench_power_up(&board);
    TEST_ASSERT_EQUAL_UINT16(shipped, board.bench.controller.weights_id);
}

static void test_a_fault_in_the_trial_brings_the_old_weights_back_at_once_and_stays_latched(void) {
    const uint16_t shipped = board.bench.controller.weights_id;
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 400U);
    ticks(100U);
    board.bench.lamp_fault = true;
    until_mode(ELMOPP_MODE_FAIL_SAFE);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_WITHDRAWN, board.report.state);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_FAULT, board.report.reason);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_LAMP_NODE, board.report.first);
    TEST_ASSERT_EQUAL_UINT16(shipped, board.bench.controller.weights_id);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_LAMP_NODE, board.bench.controller.fault);
    offer_weights(0U);
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_FAULT);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_LAMP_NODE, board.report.first);
}

static void test_the_trial_counts_only_while_lamps_are_under_the_plan(void) {
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 400U);
    TEST_ASSERT_TRUE(bench_command(&board.bench, ELMOPP_REQUEST_FLASHING, 0U));
    until_mode(ELMOPP_MODE_FLASHING);
    ticks(20U);
    const uint16_t left = board.report.left_s;
    ticks(ELMOPP_KEEPER_TRIAL_DS);
    TEST_ASSERT_EQUAL_UINT16(left, board.report.left_s);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_ON_TRIAL, board.report.state);
}

static void test_weights_that_are_distrusted_at_the_end_of_their_trial_are_withdrawn(void) {
    const uint16_t shipped = board.bench.controller.weights_id;
    elmopp_weights_t bad = elmopp_weights_lstm;
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        bad.lstm.head_bias[k] = 900.0F; /* they say that everybody comes at once */
    }
    make_weights(&bad);
    offer(WEIGHTS_BYTES);
    for (uint32_t k = 0U; (board.report.state != ELMOPP_TRANSFER_WITHDRAWN) && (k < 4000U); k++) {
        board.bench.arrived_veh[k % 4U] += (k % 7U) / 6U;
        tick();
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_WITHDRAWN, board.report.state);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_DISTRUSTED, board.report.reason);
    TEST_ASSERT_EQUAL_UINT16(shipped, board.bench.controller.weights_id);
    keeper_bench_power_up(&board);
    TEST_ASSERT_EQUAL_UINT16(shipped, board.bench.controller.weights_id);
}

/* --- what is refused --- */

static void test_a_segment_that_is_lost_ends_the_transfer_and_another_try_succeeds(void) {
    offer_weights(0U);
    lost = 3000U;
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_ORDER);
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 400U);
}

static void test_a_sender_that_stops_in_the_middle_is_waited_for_a_second_and_another_try_succeeds(void) {
    offer_weights(0U);
    ticks(50U);
    length = 0U; /* he is dead */
    const uint32_t from = board.bench.ticks;
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_SILENCE);
    TEST_ASSERT_UINT32_WITHIN(2U, 10U, board.bench.ticks - from);
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 400U);
}

static void test_a_length_that_nothing_has_is_refused_at_once(void) {
    static const uint32_t others[] = {WEIGHTS_BYTES - 4U, WEIGHTS_BYTES - 256U, SITE_BYTES + 4U, SITE_BYTES - 1U, 100U};
    for (uint32_t i = 0U; i < (sizeof others / sizeof others[0]); i++) {
        offer(others[i]);
        expect_refused(ELMOPP_TRANSFER_NOTHING, ELMOPP_TRANSFER_LENGTH);
        TEST_ASSERT_EQUAL_UINT32(1U, index_to_send); /* nobody let him go on */
    }
    const elmopp_frame_t huge = {SEGMENTS_TRANSFER, 8U, {0x10U, 0U, 0xFFU, 0xFFU, 0xFFU, 0xFFU, 0x45U, 0x4CU}};
    offer(0U);
    board.may_send = 0U;
    TEST_ASSERT_TRUE(elmopp_keeper_take(&board.keeper, &board.bench.controller, &huge));
    expect_refused(ELMOPP_TRANSFER_NOTHING, ELMOPP_TRANSFER_LENGTH);
}

static void offer_changed(uint32_t at, bool sealed) {
    make_other_weights(0U);
    image[at] ^= 0x40U;
    if (sealed) {
        image_put_word(&image[12], image_checksum(&image[16], (uint32_t)sizeof(elmopp_weights_t)));
    }
    offer(WEIGHTS_BYTES);
}

static void test_weights_that_are_spoilt_are_refused_by_what_is_wrong_with_them(void) {
    static const struct {
        uint32_t at;
        elmopp_transfer_reason_t reason;
    } spoilt[] = {{0U, ELMOPP_TRANSFER_MAGIC},        {4U, ELMOPP_TRANSFER_VERSION},
                  {8U, ELMOPP_TRANSFER_LENGTH},       {12U, ELMOPP_TRANSFER_CHECKSUM},
                  {20000U, ELMOPP_TRANSFER_CHECKSUM}, {WEIGHTS_BYTES - 1U, ELMOPP_TRANSFER_CHECKSUM}};
    for (uint32_t i = 0U; i < (sizeof spoilt / sizeof spoilt[0]); i++) {
        offer_changed(spoilt[i].at, false);
        expect_refused(ELMOPP_TRANSFER_WEIGHTS, spoilt[i].reason);
    }
    elmopp_weights_t bad = elmopp_weights_lstm;
    bad.lstm.head_bias[0] = NAN;
    make_weights(&bad);
    offer(WEIGHTS_BYTES);
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_CONTENT);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_WEIGHTS_VALUE, board.report.first);
    make_weights(&elmopp_weights_nlstm); /* of another shape: three levels */
    offer(WEIGHTS_BYTES);
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_NETWORK);
}

static void test_a_site_that_forecasts_without_a_network_wants_no_weights(void) {
    board.first_site.forecast = ELMOPP_FORECAST_MEAN;
    keeper_bench_power_up(&board);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    offer_weights(0U);
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_NETWORK);
}

static void test_a_second_sender_is_told_that_somebody_else_sends_and_the_first_goes_on(void) {
    offer_weights(0U);
    ticks(30U);
    const elmopp_frame_t second = segments_frame(image, WEIGHTS_BYTES, 0U);
    for (uint32_t k = 0U; k < 5U; k++) {
        TEST_ASSERT_TRUE(elmopp_keeper_take(&board.keeper, &board.bench.controller, &second));
        tick();
    }
    TEST_ASSERT_EQUAL_UINT32(5U, board.busy_reports);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 400U);
    TEST_ASSERT_TRUE(elmopp_keeper_take(&board.keeper, &board.bench.controller, &second));
    ticks(2U);
    TEST_ASSERT_EQUAL_UINT32(6U, board.busy_reports);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_ON_TRIAL, board.report.state);
}

static void test_segments_of_two_senders_mixed_are_refused(void) {
    offer_weights(0U);
    ticks(30U);
    const elmopp_frame_t other = segments_frame(image, WEIGHTS_BYTES, index_to_send + 5U);
    TEST_ASSERT_TRUE(elmopp_keeper_take(&board.keeper, &board.bench.controller, &other));
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_ORDER);
}

static void test_a_flood_of_segments_is_counted_and_answered_with_a_report_a_tick_at_most(void) {
    make_other_weights(0U);
    offer(0U);
    board.may_send = 0U;
    const uint8_t before = board.bench.controller.bus.refused;
    for (uint32_t k = 0U; k < 100U; k++) {
        for (uint32_t n = 0U; n < 64U; n++) {
            const elmopp_frame_t frame = segments_frame(image, WEIGHTS_BYTES, 1U + (n % 40U));
            TEST_ASSERT_TRUE(elmopp_keeper_take(&board.keeper, &board.bench.controller, &frame));
        }
        tick();
    }
    TEST_ASSERT_EQUAL_UINT32(0U, board.reports);
    TEST_ASSERT_EQUAL_UINT8((uint8_t)(before + 6400U), board.bench.controller.bus.refused);
    for (uint32_t k = 0U; k < 100U; k++) {
        const elmopp_frame_t frame = segments_frame(image, 100U, 0U);
        for (uint32_t n = 0U; n < 64U; n++) {
            TEST_ASSERT_TRUE(elmopp_keeper_take(&board.keeper, &board.bench.controller, &frame));
        }
        tick();
    }
    TEST_ASSERT_EQUAL_UINT32(100U, board.reports);
    TEST_ASSERT_EQUAL_UINT32(100U, board.busy_reports); /* for all the others of a tick */
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_AUTOMATIC, board.bench.controller.mode);
}

static void test_what_somebody_put_in_by_hand_is_not_replaced_over_the_bus(void) {
    board.config.weights_by_hand = true;
    board.config.site_by_hand = true;
    keeper_bench_power_up(&board);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    offer_weights(0U);
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_BY_HAND);
    make_other_site();
    offer(SITE_BYTES);
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_BY_HAND);
}

static void test_without_room_nothing_is_received(void) {
    board.config.weights.bytes = NULL;
    board.config.site.bytes = NULL;
    keeper_bench_power_up(&board);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    offer_weights(0U);
    expect_refused(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_FULL);
}

static void test_a_medium_that_fails_brings_the_old_weights_back_and_the_next_try_has_another_slot(void) {
    const uint16_t shipped = board.bench.controller.weights_id;
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 400U);
    board.medium_fails = 700U;
    until_state(ELMOPP_TRANSFER_WITHDRAWN, 4000U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_MEDIUM, board.report.reason);
    TEST_ASSERT_EQUAL_UINT16(shipped, board.bench.controller.weights_id);
    board.medium_fails = KEEPER_BENCH_NEVER;
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_KEPT, 4000U);
    TEST_ASSERT_EQUAL_UINT16(id_of(image), board.bench.controller.weights_id);
}

/* --- sites --- */

static void flash_with_key(void) {
    elmopp_controller_hold_reset(&board.bench.controller, true);
    TEST_ASSERT_TRUE(bench_command(&board.bench, ELMOPP_REQUEST_FLASHING, 0U));
    until_mode(ELMOPP_MODE_FLASHING);
}

static void test_a_site_comes_only_with_the_key_held_while_lamps_flash_or_are_dark(void) {
    make_other_site();
    offer(SITE_BYTES);
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_NOT_SAFE);
    elmopp_controller_hold_reset(&board.bench.controller, true); /* the key alone */
    offer(SITE_BYTES);
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_NOT_SAFE);
    flash_with_key();
    elmopp_controller_hold_reset(&board.bench.controller, false); /* flashing alone */
    offer(SITE_BYTES);
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_NOT_SAFE);
    elmopp_controller_hold_reset(&board.bench.controller, true);
    offer(SITE_BYTES);
    ticks(5U);
    elmopp_controller_hold_reset(&board.bench.controller, false); /* let go before it has come */
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_NOT_SAFE);
    elmopp_controller_hold_reset(&board.bench.controller, true);
    TEST_ASSERT_TRUE(bench_command(&board.bench, ELMOPP_REQUEST_DARK, 0U));
    until_mode(ELMOPP_MODE_DARK);
    offer(SITE_BYTES);
    expect(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_ON_TRIAL, ELMOPP_TRANSFER_NO_REASON);
    TEST_ASSERT_EQUAL_UINT32(1U, board.begins);
}

static void test_a_new_site_begins_anew_runs_on_trial_is_kept_and_outlives_a_reset(void) {
    const uint16_t was_ds = board.first_site.intergreen_ds[0][1];
    flash_with_key();
    make_other_site();
    offer(SITE_BYTES);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 100U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_STARTING, board.bench.controller.mode);
    TEST_ASSERT_EQUAL_UINT16(was_ds + 7U, board.bench.controller.junction->intergreen_ds[0][1]);
    elmopp_controller_hold_reset(&board.bench.controller, false);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    until_state(ELMOPP_TRANSFER_KEPT, 4000U);
    TEST_ASSERT_EQUAL_UINT32(1U, board.begins);
    keeper_bench_power_up(&board);
    TEST_ASSERT_EQUAL_UINT16(was_ds + 7U, board.bench.controller.junction->intergreen_ds[0][1]);
}

static void test_a_reset_in_its_trial_brings_the_old_site_back(void) {
    const uint16_t was_ds = board.first_site.intergreen_ds[0][1];
    flash_with_key();
    make_other_site();
    offer(SITE_BYTES);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 100U);
    elmopp_controller_hold_reset(&board.bench.controller, false);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    ticks(500U);
    keeper_bench_power_up(&board);
    TEST_ASSERT_EQUAL_UINT16(was_ds, board.bench.controller.junction->intergreen_ds[0][1]);
    TEST_ASSERT_NULL(elmopp_keeper_site(&board.keeper));
}

static void test_a_fault_in_its_trial_brings_the_old_site_back_with_the_fault_latched(void) {
    const uint16_t was_ds = board.first_site.intergreen_ds[0][1];
    flash_with_key();
    make_other_site();
    offer(SITE_BYTES);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 100U);
    elmopp_controller_hold_reset(&board.bench.controller, false);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    board.bench.broken.red = 0xFU;
    until_state(ELMOPP_TRANSFER_WITHDRAWN, 200U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_FAULT, board.report.reason);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_FEEDBACK_DIFFERS, board.report.first);
    TEST_ASSERT_EQUAL_UINT16(was_ds, board.bench.controller.junction->intergreen_ds[0][1]);
    TEST_ASSERT_EQUAL_UINT32(2U, board.begins);
    board.bench.broken.red = 0U;
    ticks(300U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FAIL_SAFE, board.bench.controller.mode);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_FEEDBACK_DIFFERS, board.bench.controller.fault);
}

static void test_a_site_that_breaks_a_rule_or_is_only_for_simulation_is_refused_and_touches_nothing(void) {
    flash_with_key();
    elmopp_junction_t bad = board.first_site;
    bad.intergreen_ds[0][1] = 1U;
    make_site(&bad);
    offer(SITE_BYTES);
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_CONTENT);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_SITE_INTERGREEN, board.report.first);
    bad = board.first_site;
    bad.simulation_only = 1U;
    make_site(&bad);
    offer(SITE_BYTES);
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_SIMULATION);
    make_other_site();
    image[100] ^= 1U;
    offer(SITE_BYTES);
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_CHECKSUM);
    TEST_ASSERT_NULL(elmopp_keeper_site(&board.keeper));
}

static void test_while_a_fault_is_latched_no_site_comes_so_that_no_site_clears_a_fault(void) {
    board.bench.lamp_fault = true;
    until_mode(ELMOPP_MODE_FAIL_SAFE);
    elmopp_controller_hold_reset(&board.bench.controller, true);
    make_other_site();
    offer(SITE_BYTES);
    expect_refused(ELMOPP_TRANSFER_SITE, ELMOPP_TRANSFER_FAULT);
}

static void test_weights_that_no_longer_fit_a_new_site_stay_stored_and_are_not_used(void) {
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_KEPT, 4000U);
    const uint16_t kept = board.bench.controller.weights_id;
    flash_with_key();
    elmopp_junction_t other = board.first_site;
    other.forecast = ELMOPP_FORECAST_MEAN;
    make_site(&other);
    offer(SITE_BYTES);
    until_state(ELMOPP_TRANSFER_ON_TRIAL, 100U);
    keeper_bench_power_up(&board); /* the old site again */
    TEST_ASSERT_EQUAL_UINT16(kept, board.bench.controller.weights_id);
}

/* --- what was learned --- */

static void test_learned_weights_are_stored_while_they_go_on_changing_and_outlive_a_reset(void) {
    static elmopp_weights_t learned;
    learned = elmopp_weights_lstm;
    learned.gcn.head[1] += 0.5F;
    make_weights(&learned);
    const uint16_t stored = id_of(image);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_TOO_SOON,
                          elmopp_keeper_save(&board.keeper, &board.bench.controller, &learned));
    ticks(10U * SAVE_MIN_S);
    const uint32_t begun = board.begins;
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_NO_REASON,
                          elmopp_keeper_save(&board.keeper, &board.bench.controller, &learned));
    learned.gcn.head[1] += 0.5F; /* it learns on */
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_BUSY, elmopp_keeper_save(&board.keeper, &board.bench.controller, &learned));
    board.report.state = ELMOPP_TRANSFER_IDLE;
    until_state(ELMOPP_TRANSFER_KEPT, 200U);
    TEST_ASSERT_EQUAL_UINT32(begun, board.begins);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_TOO_SOON,
                          elmopp_keeper_save(&board.keeper, &board.bench.controller, &learned));
    keeper_bench_power_up(&board);
    TEST_ASSERT_EQUAL_UINT16(stored, board.bench.controller.weights_id);
}

static void test_learned_weights_that_nobody_could_use_are_not_stored(void) {
    static elmopp_weights_t learned;
    ticks(10U * SAVE_MIN_S);
    learned = elmopp_weights_lstm;
    learned.lstm.head_bias[0] = INFINITY;
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_CONTENT,
                          elmopp_keeper_save(&board.keeper, &board.bench.controller, &learned));
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_NETWORK,
                          elmopp_keeper_save(&board.keeper, &board.bench.controller, &elmopp_weights_nlstm));
    board.medium_fails = 100U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_NO_REASON,
                          elmopp_keeper_save(&board.keeper, &board.bench.controller, &elmopp_weights_lstm));
    board.report.state = ELMOPP_TRANSFER_IDLE;
    until_state(ELMOPP_TRANSFER_REFUSED, 200U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_MEDIUM, board.report.reason);
}

/* Six slots; then there is no room until a start. No flash is erased while lamps run. */
static void test_wear_is_bounded_by_the_time_between_saves_and_by_the_slots(void) {
    static elmopp_weights_t learned;
    learned = elmopp_weights_lstm;
    for (uint32_t k = 0U; k < 6U; k++) {
        learned.gcn.head[1] += 0.01F;
        ticks(10U * SAVE_MIN_S);
        TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_NO_REASON,
                              elmopp_keeper_save(&board.keeper, &board.bench.controller, &learned));
    }
    ticks(10U * SAVE_MIN_S);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_FULL, elmopp_keeper_save(&board.keeper, &board.bench.controller, &learned));
    TEST_ASSERT_EQUAL_UINT16(6U, board.keeper.saved);
    TEST_ASSERT_EQUAL_UINT32(0U, board.erases);
    keeper_bench_power_up(&board);
    TEST_ASSERT_EQUAL_UINT32(1U, board.erases);
}

/* --- what is learnt on the street --- */

static elmopp_learner_t learner;
static elmopp_trainer_memory_t trainer;

/* A learner whose weights are others than the shipped ones. */
static void teach(void) {
    elmopp_forecast_t *forecast = &board.bench.controller.pilot.forecast;
    elmopp_learner_init(&learner, &trainer, NULL, forecast->config.weights, ELMOPP_LEARNER_CAREFUL, 4U);
    trainer.weight.head_bias[0] += 0.125F;
    forecast->config.learner = &learner;
}

/* Ticks in which it is the better one, and the forecast trusted or not. */
static void praised_ticks(uint32_t count, uint32_t judged, float mean_error) {
    for (uint32_t k = 0U; k < count; k++) {
        learner.in_use = true;
        learner.error = (elmopp_learner_error_t){.shipped = 1.0F, .learnt = 0.5F, .judged = judged};
        board.bench.controller.pilot.forecast.account.error = (elmopp_account_error_t){0.5F, 0.5F, mean_error, 500U};
        tick();
    }
}

static void learn_for(uint32_t seconds) {
    praised_ticks(seconds * 10U, ELMOPP_LEARNER_JUDGED_WINDOW, 1.0F);
}

static void test_what_was_learnt_is_stored_by_itself_in_its_time_and_outlives_a_reset(void) {
    teach();
    learn_for(SAVE_MIN_S - (board.keeper.quiet_ds / 10U) - 1U);
    TEST_ASSERT_EQUAL_UINT16(0U, board.keeper.lessons);
    learn_for(3U);
    TEST_ASSERT_EQUAL_UINT16(1U, board.keeper.lessons);
    learn_for(60U);
    TEST_ASSERT_EQUAL_UINT16(1U, board.keeper.saved);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, board.bench.controller.fault);
    TEST_ASSERT_TRUE(board.bench.controller.pilot.forecast.config.learner == &learner); /* what runs is not touched */
    keeper_bench_power_up(&board);
    const elmopp_weights_t *kept = elmopp_keeper_weights(&board.keeper);
    TEST_ASSERT_FLOAT_WITHIN(0.01F, elmopp_weights_lstm.lstm.head_bias[0] + 0.125F, kept->lstm.head_bias[0]);
    TEST_ASSERT_TRUE(elmopp_weights_are_learnt_from(kept, &elmopp_weights_lstm));
}

/* A start leaves a sector of slots; the last one is for whoever sends something. */
static void test_learning_takes_all_slots_but_one_and_the_second_much_later(void) {
    board.config.save_min_s = 10U;
    keeper_bench_power_up(&board);
    until_mode(ELMOPP_MODE_AUTOMATIC);
    teach();
    learn_for(ELMOPP_FORECAST_COLD_S + 10U);
    TEST_ASSERT_EQUAL_UINT16(1U, board.keeper.lessons);
    learn_for((ELMOPP_KEEPER_LATER * 10U) - 20U);
    TEST_ASSERT_EQUAL_UINT16(1U, board.keeper.lessons);
    learn_for(30U);
    TEST_ASSERT_EQUAL_UINT16(KEEPER_BENCH_SECTOR_SLOTS - 1U, board.keeper.lessons);
    learn_for((ELMOPP_KEEPER_LATER * 10U) + 30U);
    TEST_ASSERT_EQUAL_UINT16(KEEPER_BENCH_SECTOR_SLOTS - 1U, board.keeper.lessons);
    TEST_ASSERT_EQUAL_UINT32(0U, board.erases);
    offer_weights(0U);
    expect(ELMOPP_TRANSFER_WEIGHTS, ELMOPP_TRANSFER_ON_TRIAL, ELMOPP_TRANSFER_NO_REASON);
}

static void expect_not_stored(void) {
    TEST_ASSERT_EQUAL_UINT16(0U, board.keeper.lessons);
    TEST_ASSERT_EQUAL_UINT16(0U, board.keeper.saved);
}

static void test_what_is_not_surely_better_or_not_trusted_is_not_stored(void) {
    teach();
    praised_ticks(10U * SAVE_MIN_S, ELMOPP_LEARNER_JUDGED_WINDOW - 1U, 1.0F);
    expect_not_stored();
    praised_ticks(10U, 0U, 0.25F); /* until the next decision */
    praised_ticks(100U, ELMOPP_LEARNER_JUDGED_WINDOW, 0.25F);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_DISTRUSTED, board.bench.controller.pilot.foresight);
    expect_not_stored();
    learn_for(2U);
    TEST_ASSERT_EQUAL_UINT16(1U, board.keeper.lessons);
}

static void test_with_a_fault_or_with_weights_by_hand_or_nowhere_to_keep_them_nothing_learnt_is_stored(void) {
    board.config.weights_by_hand = true;
    keeper_bench_power_up(&board);
    teach();
    learn_for(SAVE_MIN_S + 10U);
    expect_not_stored();
    board.config.weights_by_hand = false;
    board.config.weights.bytes = NULL;
    keeper_bench_power_up(&board);
    teach();
    learn_for(SAVE_MIN_S + 10U);
    expect_not_stored();
    start(4U);
    teach();
    board.bench.lamp_fault = true;
    learn_for(SAVE_MIN_S + 10U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_LAMP_NODE, board.bench.controller.fault);
    expect_not_stored();
}

static void test_what_was_changed_where_it_lay_is_told_and_what_there_was_before_is_in_force(void) {
    offer_weights(0U);
    until_state(ELMOPP_TRANSFER_KEPT, 4000U);
    keeper_bench_power_up(&board);
    TEST_ASSERT_FALSE(elmopp_keeper_is_damaged(&board.keeper, ELMOPP_TRANSFER_WEIGHTS));
    board.weights_medium[16U + 16U + 5000U] ^= 1U;
    keeper_bench_power_up(&board);
    TEST_ASSERT_TRUE(elmopp_keeper_is_damaged(&board.keeper, ELMOPP_TRANSFER_WEIGHTS));
    TEST_ASSERT_FALSE(elmopp_keeper_is_damaged(&board.keeper, ELMOPP_TRANSFER_SITE));
    TEST_ASSERT_NULL(elmopp_keeper_weights(&board.keeper));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_new_weights_run_on_trial_are_kept_and_outlive_a_reset);
    RUN_TEST(test_a_reset_in_the_trial_or_while_they_are_written_brings_the_old_weights_back);
    RUN_TEST(test_a_fault_in_the_trial_brings_the_old_weights_back_at_once_and_stays_latched);
    RUN_TEST(test_the_trial_counts_only_while_lamps_are_under_the_plan);
    RUN_TEST(test_weights_that_are_distrusted_at_the_end_of_their_trial_are_withdrawn);
    RUN_TEST(test_a_segment_that_is_lost_ends_the_transfer_and_another_try_succeeds);
    RUN_TEST(test_a_sender_that_stops_in_the_middle_is_waited_for_a_second_and_another_try_succeeds);
    RUN_TEST(test_a_length_that_nothing_has_is_refused_at_once);
    RUN_TEST(test_weights_that_are_spoilt_are_refused_by_what_is_wrong_with_them);
    RUN_TEST(test_a_site_that_forecasts_without_a_network_wants_no_weights);
    RUN_TEST(test_a_second_sender_is_told_that_somebody_else_sends_and_the_first_goes_on);
    RUN_TEST(test_segments_of_two_senders_mixed_are_refused);
    RUN_TEST(test_a_flood_of_segments_is_counted_and_answered_with_a_report_a_tick_at_most);
    RUN_TEST(test_what_somebody_put_in_by_hand_is_not_replaced_over_the_bus);
    RUN_TEST(test_without_room_nothing_is_received);
    RUN_TEST(test_a_medium_that_fails_brings_the_old_weights_back_and_the_next_try_has_another_slot);
    RUN_TEST(test_a_site_comes_only_with_the_key_held_while_lamps_flash_or_are_dark);
    RUN_TEST(test_a_new_site_begins_anew_runs_on_trial_is_kept_and_outlives_a_reset);
    RUN_TEST(test_a_reset_in_its_trial_brings_the_old_site_back);
    RUN_TEST(test_a_fault_in_its_trial_brings_the_old_site_back_with_the_fault_latched);
    RUN_TEST(test_a_site_that_breaks_a_rule_or_is_only_for_simulation_is_refused_and_touches_nothing);
    RUN_TEST(test_while_a_fault_is_latched_no_site_comes_so_that_no_site_clears_a_fault);
    RUN_TEST(test_weights_that_no_longer_fit_a_new_site_stay_stored_and_are_not_used);
    RUN_TEST(test_learned_weights_are_stored_while_they_go_on_changing_and_outlive_a_reset);
    RUN_TEST(test_learned_weights_that_nobody_could_use_are_not_stored);
    RUN_TEST(test_wear_is_bounded_by_the_time_between_saves_and_by_the_slots);
    RUN_TEST(test_what_was_learnt_is_stored_by_itself_in_its_time_and_outlives_a_reset);
    RUN_TEST(test_learning_takes_all_slots_but_one_and_the_second_much_later);
    RUN_TEST(test_what_is_not_surely_better_or_not_trusted_is_not_stored);
    RUN_TEST(test_with_a_fault_or_with_weights_by_hand_or_nowhere_to_keep_them_nothing_learnt_is_stored);
    RUN_TEST(test_what_was_changed_where_it_lay_is_told_and_what_there_was_before_is_in_force);
    return UNITY_END();
}

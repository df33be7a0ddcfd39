/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Any frames of a transfer at any time. First byte even: the receiver alone, into a buffer that is exactly as long as
/// the first frame says, beside a model of its own of what has come. Odd: a keeper and its whole controller, who are
/// sent weights or a site by somebody who can do it right, and a board on which everything may fail.
///
/// Nothing is written beyond an image; what a trial begins with is whole by a checksum of its own and passes its check;
/// nothing is written to the medium that has not run on trial, all of it, and what a reset brings back is what was kept
/// last, or what was being written. When everybody is silent the receiver is idle after a second, and the keeper comes
/// to an end of whatever was under way: after a fault at once, else after its trial and the writing.

#include "elmopp/site.h"
#include "elmopp/transfer.h"
#include "elmopp_weights.h"
#include "fuzz_input.h"
#include "image_writer.h"
#include "keeper_bench.h"
#include "segments.h"
#include "sites.h"

#include <string.h>

#define LONGEST 6000U
#define SAVE_MIN_S 5U
#define TICKS_MAX 1500U
#define TICKS_OF_A_FAULT 50U
#define TICKS_TO_THE_END 9000U /* a site may start slowly; then its trial */
#define WEIGHTS_BYTES KEEPER_BENCH_WEIGHTS_BYTES
#define SITE_BYTES KEEPER_BENCH_SITE_BYTES

/* --- the receiver alone --- */

/* What has come, as ISO 15765-2 says it: payload after payload, numbers from 1 on, modulo 16. */
typedef struct {
    uint8_t bytes[LONGEST + 8U];
    uint32_t got;
    uint32_t length;
    uint32_t number;
} model_t;

static void any_frame(fuzz_input_t *input, elmopp_frame_t *frame) {
    const uint8_t how = fuzz_byte(input);
    frame->id = ((how & 1U) == 0U) ? SEGMENTS_TRANSFER : fuzz_two_bytes(input);
    frame->length = ((how & 2U) == 0U) ? 8U : fuzz_byte(input);
    for (uint32_t i = 0U; i < ELMOPP_LINK_BYTES; i++) {
        frame->data[i] = fuzz_byte(input);
    }
}

static void note(model_t *model, const elmopp_frame_t *frame, uint32_t head) {
    (void)memcpy(&model->bytes[model->got], &frame->data[head], 8U - head);
    model->got += 8U - head;
}

static void check_taken(elmopp_transfer_t *transfer, model_t *model, const elmopp_frame_t *frame,
                        elmopp_transfer_verdict_t verdict) {
    if ((verdict == ELMOPP_TRANSFER_TAKEN) || (verdict == ELMOPP_TRANSFER_WHOLE)) {
        model->number = (model->number + 1U) % 16U;
        FUZZ_CHECK(frame->data[0] == (0x20U | model->number));
        note(model, frame, 1U);
        const uint32_t real = (model->got < model->length) ? model->got : model->length;
        FUZZ_CHECK(transfer->got == real);
        FUZZ_CHECK(memcmp(transfer->bytes, model->bytes, real) == 0);
        FUZZ_CHECK((verdict == ELMOPP_TRANSFER_WHOLE) == (model->got >= model->length));
    }
    FUZZ_CHECK(transfer->receiving || (verdict != ELMOPP_TRANSFER_TAKEN));
    FUZZ_CHECK((!transfer->receiving) || ((verdict != ELMOPP_TRANSFER_WHOLE) && (verdict != ELMOPP_TRANSFER_BROKEN)));
}

static void receive(fuzz_input_t *input, elmopp_transfer_t *transfer, model_t *model) {
    elmopp_frame_t frame;
    const uint8_t what = fuzz_byte(input);
    if ((what % 4U) == 0U) {
        (void)elmopp_transfer_tick(transfer);
    } else if ((what % 4U) == 1U) {
        any_frame(input, &frame);
        check_taken(transfer, model, &frame, elmopp_transfer_take(transfer, &frame));
    } else { /* as many right ones as the byte says */
        for (uint32_t k = 0U; k < (what / 4U); k++) {
            (void)elmopp_transfer_flow(transfer, &frame);
            frame = (elmopp_frame_t){.id = SEGMENTS_TRANSFER, .length = 8U};
            (void)memset(frame.data, (int)what, sizeof frame.data);
            frame.data[0] = (uint8_t)(0x20U | ((model->number + 1U) % 16U));
            check_taken(transfer, model, &frame, elmopp_transfer_take(transfer, &frame));
        }
    }
}

static void try_receiver(fuzz_input_t *input) {
    static model_t model;
    elmopp_transfer_t transfer;
    elmopp_frame_t first;
    elmopp_transfer_init(&transfer);
    any_frame(input, &first);
    const uint32_t length = elmopp_transfer_announced(&first);
    if ((length == 0U) || (length > LONGEST)) {
        return;
    }
    uint8_t *exact = malloc(length);
    if (exact == NULL) {
        return;
    }
    model = (model_t){.length = length};
    note(&model, &first, (length > 4095U) ? 6U : 2U);
    elmopp_transfer_begin(&transfer, &first, exact);
    while (input->left > 0U) {
        receive(input, &transfer, &model);
    }
    for (uint32_t k = 0U; k < ELMOPP_TRANSFER_TIMEOUT_DS; k++) {
        (void)elmopp_transfer_tick(&transfer);
    }
    FUZZ_CHECK(!transfer.receiving);
    free(exact);
}

/* --- the keeper --- */

static keeper_bench_t board;

/* Who sends, and what an observer knows of what has become of it. */
static struct {
    uint8_t image[WEIGHTS_BYTES];
    uint32_t length;
    uint32_t index;
    uint8_t tried[WEIGHTS_BYTES];                      /* on trial, or being written */
    uint8_t kept[ELMOPP_KEEPER_STORES][WEIGHTS_BYTES]; /* the last weights, the last site */
    bool has_kept[ELMOPP_KEEPER_STORES];
    elmopp_transfer_state_t state; /* in the last tick */
    uint32_t trial_ticks;
} sender;

static elmopp_transfer_kind_t sent_kind(void) {
    return (sender.length == SITE_BYTES) ? ELMOPP_TRANSFER_SITE : ELMOPP_TRANSFER_WEIGHTS;
}

static void seal(void) {
    if (sent_kind() == ELMOPP_TRANSFER_SITE) {
        image_seal(sender.image, "ELMS", ELMOPP_SITE_IMAGE_VERSION_NOW, sizeof(elmopp_junction_t));
    } else {
        image_seal(sender.image, "ELMW", ELMOPP_WEIGHTS_VERSION_NOW, sizeof(elmopp_weights_t));
    }
}

static void prepare(bool site) {
    (void)memset(&sender, 0, sizeof sender);
    sender.length = site ? SITE_BYTES : WEIGHTS_BYTES;
    if (site) {
        elmopp_junction_t other = board.first_site;
        other.intergreen_ds[0][1] = (uint16_t)(other.intergreen_ds[0][1] + 7U);
        (void)memcpy(&sender.image[16], &other, sizeof other);
    } else {
        static elmopp_weights_t other;
        other = elmopp_weights_lstm;
        other.gcn.head[0] += 0.001F;
        (void)memcpy(&sender.image[16], &other, sizeof other);
    }
    seal();
}

static bool is_busy(void) {
    const elmopp_transfer_state_t state = board.keeper.told.state;
    return (state == ELMOPP_TRANSFER_RECEIVING) || (state == ELMOPP_TRANSFER_ON_TRIAL) ||
           (state == ELMOPP_TRANSFER_STORING);
}

static void check_receiver(void) {
    const elmopp_transfer_t *transfer = &board.keeper.transfer;
    FUZZ_CHECK((!transfer->receiving) || (transfer->bytes == (const uint8_t *)board.keeper.buffer));
    FUZZ_CHECK((!transfer->receiving) || (transfer->length <= sizeof board.keeper.buffer));
    FUZZ_CHECK((!transfer->receiving) || (transfer->got < transfer->length));
    FUZZ_CHECK(transfer->receiving == ((board.keeper.told.state == ELMOPP_TRANSFER_RECEIVING) && !board.keeper.whole));
}

/* Of what begins its trial. */
static void check_image(void) {
    const uint8_t *image = (const uint8_t *)board.keeper.buffer;
    const bool site = board.keeper.told.kind == ELMOPP_TRANSFER_SITE;
    const uint32_t body = site ? (uint32_t)sizeof(elmopp_junction_t) : (uint32_t)sizeof(elmopp_weights_t);
    uint8_t envelope[16];
    (void)memcpy(envelope, site ? "ELMS" : "ELMW", 4U);
    image_put_word(&envelope[4], site ? ELMOPP_SITE_IMAGE_VERSION_NOW : ELMOPP_WEIGHTS_VERSION_NOW);
    image_put_word(&envelope[8], body);
    image_put_word(&envelope[12], image_checksum(&image[16], body));
    FUZZ_CHECK(memcmp(image, envelope, sizeof envelope) == 0);
    if (site) {
        elmopp_junction_t junction;
        (void)memcpy(&junction, &image[16], sizeof junction);
        FUZZ_CHECK(elmopp_site_check(&junction).fault == ELMOPP_SITE_OK);
        FUZZ_CHECK(junction.simulation_only == 0U);
        FUZZ_CHECK(memcmp(&junction, elmopp_keeper_site(&board.keeper), sizeof junction) == 0);
    }
    (void)memcpy(sender.tried, image, 16U + body);
}

static uint32_t bytes_of(bool site) {
    return site ? SITE_BYTES : WEIGHTS_BYTES;
}

static void note_kept(bool site) {
    (void)memcpy(sender.kept[site], sender.tried, bytes_of(site));
    sender.has_kept[site] = true;
}

/* Of what has been written: it is what was tried. */
static void check_kept(void) {
    const bool site = board.keeper.told.kind == ELMOPP_TRANSFER_SITE;
    const uint8_t *stored = elmopp_store_newest(&board.keeper.store[site]);
    FUZZ_CHECK(stored != NULL);
    FUZZ_CHECK(memcmp(stored, sender.tried, bytes_of(site)) == 0);
    note_kept(site);
}

static void watch(void) {
    const elmopp_transfer_state_t state = board.keeper.told.state;
    check_receiver();
    if (state != sender.state) {
        FUZZ_CHECK((state != ELMOPP_TRANSFER_ON_TRIAL) || (sender.state == ELMOPP_TRANSFER_RECEIVING));
        FUZZ_CHECK((state != ELMOPP_TRANSFER_KEPT) || (sender.state == ELMOPP_TRANSFER_STORING));
        if (state == ELMOPP_TRANSFER_ON_TRIAL) {
            check_image();
            sender.trial_ticks = 0U;
        } else if ((state == ELMOPP_TRANSFER_STORING) && !board.keeper.learned) {
            FUZZ_CHECK(sender.state == ELMOPP_TRANSFER_ON_TRIAL);
            FUZZ_CHECK(sender.trial_ticks >= (ELMOPP_KEEPER_TRIAL_DS - 1U));
            FUZZ_CHECK(board.bench.controller.fault == ELMOPP_FAULT_NONE);
        } else if (state == ELMOPP_TRANSFER_KEPT) {
            check_kept();
        } else {
            /* nothing has come to anything */
        }
    }
    sender.trial_ticks++;
    sender.state = state;
}

static void tick(void) {
    keeper_bench_tick(&board);
    watch();
}

static void ticks(uint32_t count) {
    for (uint32_t k = 0U; k < count; k++) {
        tick();
    }
}

static void offer(const elmopp_frame_t *frame) {
    const bool mine = frame->id == SEGMENTS_TRANSFER;
    FUZZ_CHECK(elmopp_keeper_take(&board.keeper, &board.bench.controller, frame) == mine);
    check_receiver();
}

/* The sender's own next frame. */
static void send(const elmopp_frame_t *frame) {
    board.may_send -= (board.may_send > 0U) ? 1U : 0U;
    sender.index++;
    offer(frame);
}

/* The next segments, a tick wherever the receiver has to be heard first; `heeds` not: all of them at once. */
static void go_on(uint32_t count, bool heeds) {
    for (uint32_t k = 0U; (k < count) && (sender.index < segments_count(sender.length)); k++) {
        if (heeds && (board.may_send == 0U)) {
            tick();
        }
        const elmopp_frame_t frame = segments_frame(sender.image, sender.length, sender.index);
        send(&frame);
    }
}

static void offer_spoilt(fuzz_input_t *input) {
    elmopp_frame_t frame = segments_frame(sender.image, sender.length, sender.index % segments_count(sender.length));
    const uint8_t place = fuzz_byte(input);
    frame.data[place % 8U] ^= fuzz_byte(input);
    frame.length = (place < 128U) ? frame.length : (uint8_t)(place - 128U);
    send(&frame);
}

/* Another image, under a right envelope. What is under way stays as it was. */
static void change_image(fuzz_input_t *input) {
    const uint32_t place = fuzz_two_bytes(input) % (sender.length - 16U);
    const uint8_t value = fuzz_byte(input);
    if (!is_busy()) {
        sender.image[16U + place] = value;
        seal();
    }
}

/* What a start has found: what was kept last, if anything was; if it was being written, the new one is as good. */
static void check_found(bool site, const void *found, bool was_written) {
    const uint32_t body = bytes_of(site) - 16U;
    const bool is_old = sender.has_kept[site] ? ((found != NULL) && (memcmp(found, &sender.kept[site][16], body) == 0))
                                              : (found == NULL);
    const bool is_new = was_written && (found != NULL) && (memcmp(found, &sender.tried[16], body) == 0);
    FUZZ_CHECK(is_old || is_new);
    if (is_new) {
        note_kept(site);
    }
}

static void cut_power(void) {
    const bool writes = sender.state == ELMOPP_TRANSFER_STORING;
    const bool site = board.keeper.told.kind == ELMOPP_TRANSFER_SITE;
    keeper_bench_power_up(&board);
    check_found(true, elmopp_keeper_site(&board.keeper), writes && site);
    check_found(false, elmopp_keeper_weights(&board.keeper), writes && !site);
    FUZZ_CHECK(board.keeper.told.state == ELMOPP_TRANSFER_IDLE);
    sender.state = ELMOPP_TRANSFER_IDLE;
    board.may_send = 0U;
}

static void ask(uint8_t what) {
    static const elmopp_request_t requests[] = {ELMOPP_REQUEST_FLASHING, ELMOPP_REQUEST_RUN, ELMOPP_REQUEST_DARK,
                                                ELMOPP_REQUEST_ALL_RED};
    elmopp_controller_hold_reset(&board.bench.controller, (what & 4U) == 0U);
    (void)bench_command(&board.bench, requests[what % 4U], 0U);
}

static void learn(void) {
    static elmopp_weights_t learned;
    learned = elmopp_weights_lstm;
    learned.gcn.head[1] += 0.01F * (float)(1U + board.keeper.saved);
    if (elmopp_keeper_save(&board.keeper, &board.bench.controller, &learned) == ELMOPP_TRANSFER_NO_REASON) {
        (void)memcpy(&sender.tried[16], &learned, sizeof learned);
        image_seal(sender.tried, "ELMW", ELMOPP_WEIGHTS_VERSION_NOW, sizeof learned);
        sender.state = ELMOPP_TRANSFER_STORING;
    }
}

static void trouble(uint8_t what) {
    switch (what % 4U) {
    case 0U:
        cut_power();
        break;
    case 1U:
        board.bench.lamp_fault = true;
        break;
    case 2U:
        board.medium_fails = what / 4U;
        break;
    default:
        board.medium_fails = KEEPER_BENCH_NEVER;
        break;
    }
}

static void step(fuzz_input_t *input) {
    elmopp_frame_t frame;
    switch (fuzz_byte(input) % 11U) {
    case 0U:
        any_frame(input, &frame);
        offer(&frame);
        break;
    case 1U:
        sender.index = 0U;
        go_on(1U, false);
        break;
    case 2U:
        go_on(16U * (1U + fuzz_byte(input)), true);
        break;
    case 3U:
        go_on(fuzz_byte(input), false);
        break;
    case 4U:
        sender.index = (sender.index + fuzz_byte(input)) % segments_count(sender.length);
        break;
    case 5U:
        offer_spoilt(input);
        break;
    case 6U:
        ticks(1U + fuzz_byte(input));
        break;
    case 7U:
        change_image(input);
        break;
    case 8U:
        ask(fuzz_byte(input));
        break;
    case 9U:
        trouble(fuzz_byte(input));
        break;
    default:
        learn();
        break;
    }
}

/* A lamp that never reads back is a fault of the start only when the self-test's time is over. */
static uint32_t ticks_of_a_fault(void) {
    const bool starts = board.bench.controller.mode == ELMOPP_MODE_STARTING;
    return TICKS_OF_A_FAULT + (starts ? ELMOPP_CONTROLLER_SELF_TEST_DS : 0U);
}

static void expect_an_end(bool by_fault) {
    ticks(ELMOPP_TRANSFER_TIMEOUT_DS + 1U);
    FUZZ_CHECK(board.keeper.told.state != ELMOPP_TRANSFER_RECEIVING);
    if (by_fault && (board.keeper.told.state == ELMOPP_TRANSFER_ON_TRIAL)) {
        board.bench.lamp_fault = true;
    } else if (board.keeper.told.state == ELMOPP_TRANSFER_ON_TRIAL) {
        ask(1U);
    } else {
        /* what is being written needs nothing */
    }
    const uint32_t limit = by_fault ? ticks_of_a_fault() : TICKS_TO_THE_END;
    const uint32_t most = (board.keeper.told.state == ELMOPP_TRANSFER_STORING) ? TICKS_TO_THE_END : limit;
    for (uint32_t k = 0U; is_busy() && (k < most); k++) {
        tick();
    }
    FUZZ_CHECK(!is_busy());
}

static void try_keeper(fuzz_input_t *input, uint8_t how) {
    elmopp_junction_t site = bench_cross(2U + (how % 3U));
    site.forecast = ELMOPP_FORECAST_LSTM;
    keeper_bench_start(&board, &site, &elmopp_weights_lstm, SAVE_MIN_S);
    prepare((how & 2U) == 0U);
    (void)bench_until(&board.bench, ELMOPP_MODE_AUTOMATIC, TICKS_MAX);
    if (sent_kind() == ELMOPP_TRANSFER_SITE) {
        ask(0U);
        (void)bench_until(&board.bench, ELMOPP_MODE_FLASHING, TICKS_MAX);
    }
    while ((input->left > 0U) && (board.bench.ticks < TICKS_MAX)) {
        step(input);
    }
    expect_an_end((how & 4U) == 0U);
    cut_power();
    bench_expect_good_street(&board.bench);
}

void fuzz_try(fuzz_input_t *input) {
    const uint8_t how = fuzz_byte(input);
    if ((how % 2U) == 0U) {
        try_receiver(input);
    } else {
        try_keeper(input, how);
    }
}

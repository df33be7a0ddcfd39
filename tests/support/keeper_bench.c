/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "keeper_bench.h"

#include "image_writer.h"
#include "unity.h"

#include <string.h>

#define ORDERS_A_TICK 64U

static const elmopp_weights_t *weights_in_force(const keeper_bench_t *self) {
    const elmopp_weights_t *kept = elmopp_keeper_weights(&self->keeper);
    const bool fits = elmopp_forecast_fits(self->bench.forecast.kind, kept);
    return fits ? kept : self->shipped;
}

static elmopp_store_answer_t carry_out(keeper_bench_t *self, elmopp_transfer_kind_t kind,
                                       const elmopp_store_order_t *order) {
    const bool is_site = kind == ELMOPP_TRANSFER_SITE;
    uint8_t *medium = is_site ? self->site_medium : self->weights_medium;
    if (self->medium_fails == 0U) {
        return ELMOPP_STORE_FAILED;
    }
    self->medium_fails -= (self->medium_fails == KEEPER_BENCH_NEVER) ? 0U : 1U;
    if (order->action == ELMOPP_STORE_ERASE) {
        self->erases++;
        (void)memset(&medium[order->at], 0xFF, is_site ? KEEPER_BENCH_SITE_SECTOR : KEEPER_BENCH_WEIGHTS_SECTOR);
    } else {
        image_put_word(&medium[order->at], order->word);
    }
    return ELMOPP_STORE_DONE;
}

static void work(keeper_bench_t *self, uint32_t orders) {
    elmopp_transfer_kind_t kind;
    elmopp_store_order_t order;
    for (uint32_t k = 0U; (k < orders) && elmopp_keeper_next(&self->keeper, &kind, &order); k++) {
        elmopp_keeper_answer(&self->keeper, kind, carry_out(self, kind, &order));
    }
}

static void begin(keeper_bench_t *self) {
    bench_t *bench = &self->bench;
    const elmopp_junction_t *site = elmopp_keeper_site(&self->keeper);
    const bool held = bench->controller.reset_held;
    bench->junction = (site == NULL) ? self->first_site : *site;
    bench->forecast = (elmopp_forecast_config_t){.kind = bench->junction.forecast};
    bench->forecast.weights = weights_in_force(self);
    bench_power_cut(bench);
    elmopp_controller_hold_reset(&bench->controller, held);
    self->begins++;
}

void keeper_bench_power_up(keeper_bench_t *self) {
    elmopp_keeper_init(&self->keeper, &self->config);
    work(self, ELMOPP_KEEPER_TIDY_ORDERS_MAX);
    begin(self);
}

static void hear(keeper_bench_t *self, const elmopp_frame_t *frame) {
    elmopp_transfer_report_t heard;
    if (elmopp_transfer_read_report(frame, &heard)) {
        const bool busy = (heard.state == ELMOPP_TRANSFER_REFUSED) && (heard.reason == ELMOPP_TRANSFER_BUSY);
        self->busy_reports += busy ? 1U : 0U;
        self->reports += busy ? 0U : 1U;
        self->report = busy ? self->report : heard;
    } else {
        TEST_ASSERT_EQUAL_HEX8(0x30U, frame->data[0]);
        self->may_send = frame->data[1];
    }
}

void keeper_bench_tick(keeper_bench_t *self) {
    elmopp_frame_t out[ELMOPP_KEEPER_FRAMES];
    uint32_t count = 0U;
    bench_tick(&self->bench);
    const elmopp_keeper_change_t change = elmopp_keeper_tick(&self->keeper, &self->bench.controller, out, &count);
    TEST_ASSERT_TRUE(count <= ELMOPP_KEEPER_FRAMES);
    if (change == ELMOPP_KEEPER_BEGIN) {
        begin(self);
        if (self->keeper.fault != ELMOPP_FAULT_NONE) {
            elmopp_controller_report(&self->bench.controller, self->keeper.fault);
        }
    } else if (change == ELMOPP_KEEPER_USE_WEIGHTS) {
        elmopp_controller_use_weights(&self->bench.controller, weights_in_force(self));
    } else {
        TEST_ASSERT_EQUAL_INT(ELMOPP_KEEPER_GO_ON, change);
    }
    for (uint32_t k = 0U; k < count; k++) {
        hear(self, &out[k]);
    }
    work(self, ORDERS_A_TICK);
}

void keeper_bench_start(keeper_bench_t *self, const elmopp_junction_t *site, const elmopp_weights_t *shipped,
                        uint32_t save_min_s) {
    self->shipped = shipped;
    self->first_site = *site;
    self->config =
        (elmopp_keeper_config_t){.weights = {self->weights_medium, KEEPER_BENCH_SECTORS, KEEPER_BENCH_WEIGHTS_SECTOR,
                                             KEEPER_BENCH_SECTOR_SLOTS, KEEPER_BENCH_WEIGHTS_SLOT, false},
                                 .site = {self->site_medium, KEEPER_BENCH_SECTORS, KEEPER_BENCH_SITE_SECTOR,
                                          KEEPER_BENCH_SECTOR_SLOTS, KEEPER_BENCH_SITE_SLOT, false},
                                 .save_min_s = save_min_s};
    (void)memset(self->weights_medium, 0xFF, sizeof self->weights_medium);
    (void)memset(self->site_medium, 0xFF, sizeof self->site_medium);
    self->medium_fails = KEEPER_BENCH_NEVER;
    self->erases = 0U;
    self->begins = 0U;
    self->may_send = 0U;
    bench_start(&self->bench, site);
    keeper_bench_power_up(self);
    bench_fill(&self->bench);
}

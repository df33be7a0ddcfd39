/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Any bytes as a site image. First byte even: the rest is the image. Odd: the rest are changes of a good site, which
/// get a right envelope, so that the check of the data is reached.
///
/// Nothing beyond the image is read, a refused one leaves the caller's copy alone, and one that is loaded can be
/// driven: under changing wishes the monitor has nothing to say against the plan.

#include "elmopp/monitor.h"
#include "elmopp/plan.h"
#include "elmopp/site.h"
#include "fuzz_input.h"
#include "image_writer.h"
#include "sites.h"

#include <string.h>

#define CANARY 0xA5
#define TICKS 400U
#define TICKS_OF_A_WISH 37U
#define VERSION 4U

static void drive(const elmopp_junction_t *junction) {
    elmopp_plan_t plan;
    elmopp_monitor_t monitor;
    elmopp_plan_init(&plan, junction);
    elmopp_monitor_init(&monitor, junction);
    for (uint32_t i = 0U; i < TICKS; i++) {
        const uint32_t turn = (i / TICKS_OF_A_WISH) % junction->stage_count;
        const elmopp_stage_t wanted = (i == 0U) ? (elmopp_stage_t)ELMOPP_STAGE_RED : (elmopp_stage_t)turn;
        const elmopp_monitor_input_t input = {.command = elmopp_plan_step(&plan, wanted, UINT32_MAX, (i % 2U) == 0U),
                                              .measured = monitor.last,
                                              .fresh = UINT16_MAX,
                                              .mode = ELMOPP_MODE_AUTOMATIC};
        FUZZ_CHECK(elmopp_monitor_check(&monitor, &input) == ELMOPP_FAULT_NONE);
    }
}

static void load(const uint8_t *image, uint32_t length) {
    elmopp_junction_t canary;
    elmopp_junction_t out;
    (void)memset(&canary, CANARY, sizeof canary);
    (void)memset(&out, CANARY, sizeof out);
    const elmopp_site_verdict_t verdict = elmopp_site_load(image, length, &out);
    if (verdict.fault == ELMOPP_SITE_OK) {
        drive(&out);
    } else {
        FUZZ_CHECK(memcmp(&out, &canary, sizeof out) == 0);
    }
}

void fuzz_try(fuzz_input_t *input) {
    const uint8_t how = fuzz_byte(input);
    if ((how % 2U) == 0U) {
        uint8_t *exact = malloc(input->left); /* so that a byte too far is seen */
        if (exact != NULL) {
            (void)memcpy(exact, input->at, input->left);
            load(exact, (uint32_t)input->left);
        }
        free(exact);
    } else {
        static uint8_t image[16U + sizeof(elmopp_junction_t)];
        (void)memcpy(&image[16], test_sites[(how / 2U) % TEST_SITE_COUNT], sizeof(elmopp_junction_t));
        fuzz_change(input, &image[16], sizeof(elmopp_junction_t));
        image_seal(image, "ELMS", VERSION, sizeof(elmopp_junction_t));
        load(image, sizeof image);
    }
}

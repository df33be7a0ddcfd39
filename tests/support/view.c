/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "view.h"

#include "random.h"
#include "unity.h"

#include <string.h>

#define GARBAGE 12345.0F

void test_view_init(test_view_t *self, const elmopp_junction_t *junction) {
    *self = (test_view_t){.view = {.junction = junction, .stage = ELMOPP_STAGE_NONE, .target = ELMOPP_STAGE_NONE}};
    self->view.queue_veh = self->queue_veh;
    self->view.arrivals_veh = self->arrivals_veh;
    self->view.share = self->share;
    self->view.red_ds = self->red_ds;
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        self->share[j] = 1.0F;
    }
}

void test_view_show(test_view_t *self, elmopp_stage_t stage, uint32_t elapsed_ds) {
    self->view.stage = stage;
    self->view.target = stage;
    self->view.elapsed_ds = (uint16_t)elapsed_ds;
    self->view.going = elmopp_junction_served(self->view.junction, self->view.junction->stage_groups[stage]);
}

void test_view_clear_to(test_view_t *self, elmopp_stage_t target) {
    self->view.stage = ELMOPP_STAGE_NONE;
    self->view.target = target;
    self->view.elapsed_ds = 0U;
    self->view.going = 0U;
}

void test_view_show_any(test_view_t *self, uint64_t *random) {
    const elmopp_stage_t stage = (elmopp_stage_t)random_below(random, self->view.junction->stage_count);
    if (random_below(random, 8U) == 0U) {
        test_view_clear_to(self, stage);
    } else {
        test_view_show(self, stage, random_below(random, 900U));
    }
}

float test_view_any_count(uint64_t *random) {
    static const float most_veh[4] = {0.0F, 3.0F, 40.0F, 1.0e6F};
    const float most = most_veh[random_below(random, 4U)];
    return most * ((float)random_below(random, 1001U) / 1000.0F);
}

elmopp_stage_t test_view_ask(test_view_t *self, const elmopp_chooser_t *chooser) {
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        self->score[s] = GARBAGE;
    }
    self->beyond_score = GARBAGE;
    const elmopp_stage_t wanted = chooser->choose(chooser->state, &self->view, self->score);
    TEST_ASSERT_EQUAL_FLOAT_MESSAGE(GARBAGE, self->beyond_score, "written beyond the scores");
    TEST_ASSERT_LESS_THAN_UINT8_MESSAGE(self->view.junction->stage_count, wanted, "no such stage");
    return wanted;
}

elmopp_stage_t test_view_ask_both(test_view_t *self, const elmopp_chooser_t *one, const elmopp_chooser_t *other) {
    float score[ELMOPP_STAGE_MAX];
    const elmopp_stage_t wanted = test_view_ask(self, one);
    (void)memcpy(score, self->score, sizeof score);
    TEST_ASSERT_EQUAL_UINT8(wanted, test_view_ask(self, other));
    TEST_ASSERT_EQUAL_MEMORY(score, self->score, sizeof score);
    return wanted;
}

/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Whatever bytes are taken for a site: elmopp_site_check_counts() reads nothing beyond it and passes no count beyond
/// its bound; of a site with such counts the other parts of elmopp_site_check() read nothing beyond it either, at every
/// index, and no assert of the core breaks. One proof for each PART. Of a programme its steps and the search for a
/// movement in them, not the loop over both. prove_image_reads_no_further says the same of the envelope.

#include "site.c"

#include "arbitrary.h"

#define PART_COUNTS 10

static void judge_step(const elmopp_junction_t *site, uint32_t i, uint32_t j) {
    ASSUME((i < site->program_count) && (j < ELMOPP_STEP_MAX));
    const elmopp_step_t *step = &site->program[i].step[j];
    CLAIM((!is_step(site, step)) || (step->stage < site->stage_count), "a step that passes has a stage");
}

static void judge_in_program(const elmopp_junction_t *site, uint32_t i, uint32_t j) {
    ASSUME((i < site->program_count) && (j < site->movement_count));
    const elmopp_program_t program = site->program[i];
    ASSUME(program.step_count <= ELMOPP_STEP_MAX);
    for (uint32_t k = 0U; k < ELMOPP_STEP_MAX; k++) {
        ASSUME(program.step[k].stage < site->stage_count);
    }
    (void)is_in_program(site, &program, j);
}

static void judge_part(const elmopp_junction_t *site) {
    const uint32_t i = nondet_u8();
    const uint32_t j = nondet_u8();
    switch (PART) {
    case 0:
        ASSUME(i < site->approach_count);
        (void)elmopp_site_check_approach(site, i);
        break;
    case 1:
        ASSUME(i < site->movement_count);
        (void)elmopp_site_check_movement(site, i);
        break;
    case 2:
        ASSUME(i < site->movement_count);
        (void)elmopp_site_check_rescue(site, i);
        break;
    case 3:
        ASSUME(i < site->group_count);
        (void)elmopp_site_check_group(site, i);
        break;
    case 4:
        ASSUME((i < site->group_count) && (j < site->group_count));
        (void)elmopp_site_check_pair(site, i, j);
        break;
    case 5:
        ASSUME(i < site->stage_count);
        (void)elmopp_site_check_stage(site, i);
        break;
    case 6:
        (void)elmopp_site_check_red_bound(site);
        break;
    case 7:
        judge_step(site, i, j);
        break;
    case 8:
        ASSUME(i < site->schedule_count);
        (void)elmopp_site_check_schedule(site, i);
        break;
    case 9:
        judge_in_program(site, i, j);
        break;
    case 11:
        ASSUME(i < site->movement_count);
        (void)elmopp_site_check_gives_way(site, i);
        break;
    default:
        ASSUME(i < site->special_day_count);
        (void)elmopp_site_check_special_day(site, i);
        break;
    }
}

static bool counts_are_bounded(const elmopp_junction_t *site) {
    return (site->approach_count >= 1U) && (site->approach_count <= ELMOPP_APPROACH_MAX) &&
           (site->movement_count >= 1U) && (site->movement_count <= ELMOPP_MOVEMENT_MAX) && (site->group_count >= 1U) &&
           (site->group_count <= ELMOPP_GROUP_MAX) && (site->stage_count >= 1U) &&
           (site->stage_count <= ELMOPP_STAGE_MAX) && (site->program_count <= ELMOPP_PROGRAM_MAX) &&
           (site->schedule_count <= ELMOPP_SCHEDULE_MAX) && (site->special_day_count <= ELMOPP_SPECIAL_DAY_MAX);
}

void harness(void) {
    const elmopp_junction_t site = nondet_junction();
    if (PART == PART_COUNTS) {
        const bool passed = elmopp_site_check_counts(&site).fault == ELMOPP_SITE_OK;
        CLAIM((!passed) || counts_are_bounded(&site), "no count is beyond its bound");
    } else {
        ASSUME(counts_are_bounded(&site));
        judge_part(&site);
    }
    REACHABLE();
}

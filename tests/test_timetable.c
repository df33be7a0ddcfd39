/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The timetable: hours, weekdays, special days, and the steps of a programme.

#include "elmopp/timetable.h"
#include "sites.h"
#include "unity.h"

#define MINUTE 60U
#define HOUR 3600U
#define DAY 86400U
#define WEEK (7U * DAY)
#define MONDAY_2000_01_03 (2U * DAY)
#define FLASH ELMOPP_SCHEDULE_FLASH

static elmopp_junction_t junction;
static elmopp_timetable_t timetable;

static void line(uint32_t i, uint8_t weekdays, uint16_t from_min, uint8_t program) {
    junction.schedule[i] = (elmopp_schedule_t){.from_min = from_min, .weekdays = weekdays, .program = program};
    junction.schedule_count = (uint8_t)(i + 1U);
}

/* Working days from 6:00 programme 1, from 22:30 flashing but not on Friday; Saturday from 8:00 programme 2. */
void setUp(void) {
    junction = test_cross(3U);
    junction.program_count = 3U;
    junction.program[1] = junction.program[0];
    junction.program[2] = junction.program[0];
    line(0U, 0x0FU, 22U * 60U + 30U, FLASH);
    line(1U, 0x1FU, 6U * 60U, 1U);
    line(2U, 0x20U, 8U * 60U, 2U);
    timetable = (elmopp_timetable_t){0U, 0U};
}
void tearDown(void) {}

static uint8_t program_at(uint32_t weekday, uint32_t hour, uint32_t minute) {
    /* Any week will do; this one is far from the start. */
    return elmopp_timetable_program(&junction, MONDAY_2000_01_03 + (500U * WEEK) + (weekday * DAY) + (hour * HOUR) +
                                                   (minute * MINUTE));
}

/* --- hours --- */

static void test_a_line_begins_in_its_minute(void) {
    TEST_ASSERT_EQUAL_UINT8(FLASH, program_at(1U, 5U, 59U));
    TEST_ASSERT_EQUAL_UINT8(1U, program_at(1U, 6U, 0U));
    TEST_ASSERT_EQUAL_UINT8(1U, program_at(1U, 22U, 29U));
    TEST_ASSERT_EQUAL_UINT8(FLASH, program_at(1U, 22U, 30U));
}

static void test_the_last_second_of_a_minute_belongs_to_it(void) {
    const uint32_t monday = MONDAY_2000_01_03 + WEEK;
    TEST_ASSERT_EQUAL_UINT8(2U, elmopp_timetable_program(&junction, monday + (6U * HOUR) - 1U));
    TEST_ASSERT_EQUAL_UINT8(1U, elmopp_timetable_program(&junction, monday + (6U * HOUR)));
}

static void test_a_line_holds_over_midnight_and_the_weekend(void) {
    TEST_ASSERT_EQUAL_UINT8(1U, program_at(4U, 23U, 0U));
    TEST_ASSERT_EQUAL_UINT8(1U, program_at(5U, 7U, 59U));
    TEST_ASSERT_EQUAL_UINT8(2U, program_at(5U, 8U, 0U));
    TEST_ASSERT_EQUAL_UINT8(2U, program_at(6U, 12U, 0U));
    TEST_ASSERT_EQUAL_UINT8(2U, program_at(0U, 5U, 59U));
}

/* An independent answer: walk back minute by minute until a line begins. */
static uint8_t walk_back(uint32_t minute_of_week) {
    for (uint32_t back = 0U; back <= (7U * 1440U); back++) {
        const uint32_t minute = (minute_of_week + (7U * 1440U) - back) % (7U * 1440U);
        for (uint32_t i = junction.schedule_count; i > 0U; i--) {
            const elmopp_schedule_t *entry = &junction.schedule[i - 1U];
            if ((((uint32_t)entry->weekdays >> (minute / 1440U)) & 1U) && (entry->from_min == (minute % 1440U))) {
                return entry->program;
            }
        }
    }
    return 0U;
}

static void test_every_minute_of_a_week_is_as_walking_back_says(void) {
    line(3U, 0x44U, 0U, 0U);
    line(4U, 0x44U, 0U, 2U);
    line(5U, 0x01U, 1439U, 0U);
    for (uint32_t minute = 0U; minute < (7U * 1440U); minute++) {
        TEST_ASSERT_EQUAL_UINT8(walk_back(minute), program_at(minute / 1440U, 0U, minute % 1440U));
    }
}

static void test_one_line_a_week_holds_the_whole_week(void) {
    junction.schedule_count = 0U;
    line(0U, 0x08U, 600U, 2U);
    for (uint32_t hour = 0U; hour < 168U; hour++) {
        TEST_ASSERT_EQUAL_UINT8(2U, program_at(0U, hour, 0U));
    }
}

static void test_without_a_schedule_and_before_its_first_line_it_is_programme_0(void) {
    junction.schedule_count = 0U;
    TEST_ASSERT_EQUAL_UINT8(0U, program_at(3U, 12U, 0U));
    setUp();
    TEST_ASSERT_EQUAL_UINT8(0U, elmopp_timetable_program(&junction, 0U));
    TEST_ASSERT_EQUAL_UINT8(2U, elmopp_timetable_program(&junction, 8U * HOUR));
}

static void test_known_dates_fall_on_their_weekdays(void) {
    static const struct {
        uint32_t day;
        uint32_t weekday;
    } dates[] = {{0U, 5U}, {59U, 1U} /* 2000-02-29 */, {8825U, 3U} /* 2024-02-29 */, {9855U, 4U} /* 2026-12-25 */};
    for (uint32_t i = 0U; i < 4U; i++) {
        junction.schedule_count = 0U;
        line(0U, 0x7FU, 0U, 1U);
        line(1U, (uint8_t)(1U << dates[i].weekday), 0U, 2U);
        TEST_ASSERT_EQUAL_UINT8(2U, elmopp_timetable_program(&junction, dates[i].day * DAY));
    }
}

static void test_a_special_day_follows_another_weekday_and_its_evening_reaches_into_the_next(void) {
    const uint32_t tuesday = 2U + 1U + (7U * 100U);
    junction.special_day_count = 1U;
    junction.special_day[0] = (elmopp_special_day_t){.day = (uint16_t)tuesday, .weekday = 5U};
    TEST_ASSERT_EQUAL_UINT8(FLASH, elmopp_timetable_program(&junction, (tuesday * DAY) + (7U * HOUR)));
    TEST_ASSERT_EQUAL_UINT8(2U, elmopp_timetable_program(&junction, (tuesday * DAY) + (8U * HOUR)));
    TEST_ASSERT_EQUAL_UINT8(2U, elmopp_timetable_program(&junction, (tuesday * DAY) + (23U * HOUR)));
    TEST_ASSERT_EQUAL_UINT8(2U, elmopp_timetable_program(&junction, ((tuesday + 1U) * DAY) + (5U * HOUR)));
    TEST_ASSERT_EQUAL_UINT8(1U, elmopp_timetable_program(&junction, ((tuesday + 1U) * DAY) + (6U * HOUR)));
    TEST_ASSERT_EQUAL_UINT8(1U, elmopp_timetable_program(&junction, ((tuesday + 7U) * DAY) + (8U * HOUR)));
}

static void test_the_last_second_of_all_is_answered(void) {
    const uint8_t program = elmopp_timetable_program(&junction, UINT32_MAX);
    TEST_ASSERT_TRUE((program < 3U) || (program == FLASH));
}

/* --- steps --- */

static elmopp_stage_t wish(uint8_t program, elmopp_stage_t stage, uint32_t elapsed_ds) {
    return elmopp_timetable_wish(&timetable, &junction, program, stage, (uint16_t)elapsed_ds);
}

static void test_a_step_ends_when_its_stage_has_had_its_green(void) {
    TEST_ASSERT_EQUAL_UINT8(0U, wish(0U, ELMOPP_STAGE_NONE, 0U));
    TEST_ASSERT_EQUAL_UINT8(0U, wish(0U, 0U, CROSS_PROGRAM_GREEN_DS - 1U));
    TEST_ASSERT_EQUAL_UINT8(1U, wish(0U, 0U, CROSS_PROGRAM_GREEN_DS));
    TEST_ASSERT_EQUAL_UINT8(1U, wish(0U, ELMOPP_STAGE_NONE, 0U));
    TEST_ASSERT_EQUAL_UINT8(2U, wish(0U, 1U, CROSS_PROGRAM_GREEN_DS));
    TEST_ASSERT_EQUAL_UINT8(0U, wish(0U, 2U, CROSS_PROGRAM_GREEN_DS));
}

static void test_a_stage_that_somebody_else_brought_up_ends_no_step(void) {
    TEST_ASSERT_EQUAL_UINT8(0U, wish(0U, 2U, 5000U));
    TEST_ASSERT_EQUAL_UINT8(0U, timetable.step);
}

static void test_another_programme_begins_when_the_step_is_over(void) {
    (void)wish(0U, 0U, CROSS_PROGRAM_GREEN_DS);
    TEST_ASSERT_EQUAL_UINT8(1U, wish(1U, 1U, CROSS_PROGRAM_GREEN_DS - 1U));
    TEST_ASSERT_EQUAL_UINT8(0U, timetable.program);
    TEST_ASSERT_EQUAL_UINT8(0U, wish(1U, 1U, CROSS_PROGRAM_GREEN_DS));
    TEST_ASSERT_EQUAL_UINT8(1U, timetable.program);
    TEST_ASSERT_EQUAL_UINT8(0U, timetable.step);
}

static void test_a_programme_that_the_site_lacks_is_the_first(void) {
    (void)wish(FLASH, 0U, CROSS_PROGRAM_GREEN_DS);
    TEST_ASSERT_EQUAL_UINT8(0U, timetable.program);
    TEST_ASSERT_EQUAL_UINT8(1U, timetable.step);
    (void)wish(3U, 1U, CROSS_PROGRAM_GREEN_DS);
    TEST_ASSERT_EQUAL_UINT8(0U, timetable.program);
}

static void test_a_site_without_programmes_wishes_nothing(void) {
    junction.program_count = 0U;
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, wish(0U, 0U, 5000U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_line_begins_in_its_minute);
    RUN_TEST(test_the_last_second_of_a_minute_belongs_to_it);
    RUN_TEST(test_a_line_holds_over_midnight_and_the_weekend);
    RUN_TEST(test_every_minute_of_a_week_is_as_walking_back_says);
    RUN_TEST(test_one_line_a_week_holds_the_whole_week);
    RUN_TEST(test_without_a_schedule_and_before_its_first_line_it_is_programme_0);
    RUN_TEST(test_known_dates_fall_on_their_weekdays);
    RUN_TEST(test_a_special_day_follows_another_weekday_and_its_evening_reaches_into_the_next);
    RUN_TEST(test_the_last_second_of_all_is_answered);
    RUN_TEST(test_a_step_ends_when_its_stage_has_had_its_green);
    RUN_TEST(test_a_stage_that_somebody_else_brought_up_ends_no_step);
    RUN_TEST(test_another_programme_begins_when_the_step_is_over);
    RUN_TEST(test_a_programme_that_the_site_lacks_is_the_first);
    RUN_TEST(test_a_site_without_programmes_wishes_nothing);
    return UNITY_END();
}

/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/gaps.h"
#include "unity.h"

#include <math.h>

#define TRIED 60001 /* opposing flows up to 2 vehicles a second */
#define TRIED_MAX 2.0

void setUp(void) {}
void tearDown(void) {}

static float tried(int index) {
    return (float)((TRIED_MAX * index) / (TRIED - 1));
}

/* By the sum over gaps: one vehicle for each t_f by which a gap is longer than t_c (tests/python/test_gaps.py works it
   out in Python, and by drawing gaps). */
static double by_sum(double q) {
    double sum = 0.0;
    for (int n = 0; n < 4000; n++) {
        sum += q * exp(-q * (4.5 + (2.5 * n)));
    }
    return sum;
}

static void test_flows_are_those_of_the_formula(void) {
    static const struct {
        float opposing;
        float flow;
    } known[] = {{0.1F, 0.28826F}, {0.2F, 0.20666F}, {0.3F, 0.14740F}, {0.5F, 0.07386F}, {1.0F, 0.01210F}};
    for (unsigned i = 0U; i < (sizeof known / sizeof known[0]); i++) {
        TEST_ASSERT_FLOAT_WITHIN(0.0005F, known[i].flow, elmopp_gaps_flow(known[i].opposing));
        TEST_ASSERT_TRUE(fabs(by_sum((double)known[i].opposing) - (double)known[i].flow) < 1.0e-5);
    }
    for (int i = TRIED / 500; i < TRIED; i += 97) {
        const float q = tried(i);
        const double bound = (q < ELMOPP_GAPS_OPPOSING_MAX_VEH_PER_S) ? 0.0005 : 0.0018;
        TEST_ASSERT_TRUE(fabs(by_sum((double)q) - (double)elmopp_gaps_flow(q)) <= bound);
    }
}

static void test_where_nobody_comes_they_follow_one_another(void) {
    TEST_ASSERT_EQUAL_FLOAT(1.0F / ELMOPP_GAPS_FOLLOW_UP_S, elmopp_gaps_flow(0.0F));
    TEST_ASSERT_EQUAL_FLOAT(1.0F / ELMOPP_GAPS_FOLLOW_UP_S, elmopp_gaps_flow(-1.0F));
}

static void test_no_more_get_through_where_more_come(void) {
    for (int i = 1; i < TRIED; i++) {
        TEST_ASSERT_TRUE(elmopp_gaps_flow(tried(i)) <= elmopp_gaps_flow(tried(i - 1)));
        TEST_ASSERT_TRUE(elmopp_gaps_flow(tried(i)) >= 0.0F);
    }
}

static void test_beyond_the_bound_and_for_no_number_nobody_gets_through(void) {
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_gaps_flow(ELMOPP_GAPS_OPPOSING_MAX_VEH_PER_S));
    TEST_ASSERT_TRUE(elmopp_gaps_flow(nextafterf(ELMOPP_GAPS_OPPOSING_MAX_VEH_PER_S, 0.0F)) > 0.0F);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_gaps_flow(INFINITY));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_gaps_flow(NAN));
}

static void test_shared_lanes_have_the_harmonic_mean(void) {
    TEST_ASSERT_EQUAL_FLOAT(0.2F, elmopp_gaps_shared(0.5F, 0.2F, 1.0F));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F / ((0.25F / 0.2F) + (0.75F / 0.5F)), elmopp_gaps_shared(0.5F, 0.2F, 0.25F));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_gaps_shared(0.5F, 0.0F, 0.25F));
}

static void test_gaps_let_no_more_go_than_the_lanes_can(void) {
    TEST_ASSERT_EQUAL_FLOAT(0.5F, elmopp_gaps_shared(0.5F, 0.8F, 1.0F));
    TEST_ASSERT_EQUAL_FLOAT(0.5F, elmopp_gaps_shared(0.5F, 0.8F, 0.25F));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_gaps_shared(0.5F, NAN, 0.25F));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_flows_are_those_of_the_formula);
    RUN_TEST(test_where_nobody_comes_they_follow_one_another);
    RUN_TEST(test_no_more_get_through_where_more_come);
    RUN_TEST(test_beyond_the_bound_and_for_no_number_nobody_gets_through);
    RUN_TEST(test_shared_lanes_have_the_harmonic_mean);
    RUN_TEST(test_gaps_let_no_more_go_than_the_lanes_can);
    return UNITY_END();
}

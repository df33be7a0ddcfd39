/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// elmopp_gcn_f32_join() and elmopp_gcn_f32_next() against the equations of their header, worked out here in double for
/// a few weights and graphs. tests/python/test_window_reference.py does it for whole random networks,
/// tests/python/test_bit_identity.py for the bits.

#include "assert_catcher.h"
#include "elmopp/gcn_f32.h"
#include "unity.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define NODES ELMOPP_GCN_NODES_MAX
#define WINDOW ELMOPP_GCN_WINDOW_S
#define TOLERANCE 1.0e-6

static elmopp_gcn_f32_weights_t weights;
static elmopp_gcn_f32_graph_t graph;
static float past[NODES][WINDOW];
static float next[NODES];

void setUp(void) {
    (void)memset(&weights, 0, sizeof weights);
    for (uint32_t i = 0U; i < NODES; i++) {
        for (uint32_t k = 0U; k < WINDOW; k++) {
            past[i][k] = (0.25F * (float)i) + (0.03125F * (float)k);
        }
    }
}
void tearDown(void) {}

static void say(void) {
    const float *windows[NODES];
    for (uint32_t i = 0U; i < NODES; i++) {
        windows[i] = past[i];
        next[i] = -1.0F;
    }
    elmopp_gcn_f32_next(&weights, &graph, windows, next);
}

static bool is_near(double value, double right) {
    return fabs(value - right) < TOLERANCE;
}

/* A path 0 - 1 - 2 and a node 3 that nobody meets. */
static void join_path(void) {
    static const uint8_t joined[NODES] = {0x02U, 0x05U, 0x02U, 0U, 0U, 0U, 0U, 0U};
    elmopp_gcn_f32_join(&graph, 4U, joined);
}

static void join_all(uint32_t nodes) {
    uint8_t joined[NODES];
    (void)memset(joined, 0xFF, sizeof joined);
    elmopp_gcn_f32_join(&graph, nodes, joined);
}

static void test_a_graph_is_mixed_by_the_roots_of_its_degrees(void) {
    join_path();
    const double right[4][4] = {{1.0 / 2.0, 1.0 / sqrt(6.0), 0.0, 0.0},
                                {1.0 / sqrt(6.0), 1.0 / 3.0, 1.0 / sqrt(6.0), 0.0},
                                {0.0, 1.0 / sqrt(6.0), 1.0 / 2.0, 0.0},
                                {0.0, 0.0, 0.0, 1.0}};
    TEST_ASSERT_EQUAL_UINT32(4U, graph.nodes);
    for (uint32_t a = 0U; a < NODES; a++) {
        for (uint32_t b = 0U; b < NODES; b++) {
            TEST_ASSERT_TRUE(is_near((double)graph.mix[a][b], ((a < 4U) && (b < 4U)) ? right[a][b] : 0.0));
        }
    }
}

/* Every size, so every root of the table; and bits of a node itself and of nodes that do not exist change nothing. */
static void test_a_complete_graph_is_mixed_to_the_mean(void) {
    for (uint32_t nodes = 1U; nodes <= NODES; nodes++) {
        join_all(nodes);
        for (uint32_t a = 0U; a < nodes; a++) {
            for (uint32_t b = 0U; b < nodes; b++) {
                TEST_ASSERT_TRUE(is_near((double)graph.mix[a][b], 1.0 / (double)nodes));
            }
        }
    }
}

static void test_a_graph_without_nodes_or_with_too_many_is_a_bug(void) {
    static const uint8_t joined[NODES] = {0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U};
    TEST_EXPECT_ASSERT(elmopp_gcn_f32_join(&graph, 0U, joined));
    TEST_EXPECT_ASSERT(elmopp_gcn_f32_join(&graph, NODES + 1U, joined));
    graph.nodes = 0U;
    TEST_EXPECT_ASSERT(say());
    graph.nodes = NODES + 1U;
    TEST_EXPECT_ASSERT(say());
}

static void test_without_weights_it_says_persistence_for_its_nodes_alone(void) {
    join_path();
    say();
    for (uint32_t i = 0U; i < 4U; i++) {
        TEST_ASSERT_TRUE(next[i] == past[i][WINDOW - 1U]);
    }
    TEST_ASSERT_TRUE(next[4] == -1.0F);
}

/* A path 0 - 1 - 2: what a node passes on reaches its neighbours by one convolution and theirs by two. */
static void test_what_a_node_passes_on_is_mixed_in_each_convolution(void) {
    join_path();
    for (uint32_t second = 0U; second < WINDOW; second++) {
        (void)memset(&weights, 0, sizeof weights);
        weights.first_passed[second][5] = 0.5F;
        weights.first_bias[5] = 0.125F;
        weights.second_passed[5][9] = -0.75F;
        weights.second_bias[9] = 0.25F;
        weights.head[9] = 2.0F;
        weights.head_bias = 0.0625F;
        say();
        double first[3];
        for (uint32_t a = 0U; a < 3U; a++) {
            first[a] = 0.125;
            for (uint32_t b = 0U; b < 3U; b++) {
                first[a] += (double)graph.mix[a][b] * 0.5 * (double)past[b][second];
            }
            first[a] = tanh(first[a]);
        }
        for (uint32_t a = 0U; a < 3U; a++) {
            double unit = 0.25;
            for (uint32_t b = 0U; b < 3U; b++) {
                unit += (double)graph.mix[a][b] * -0.75 * first[b];
            }
            TEST_ASSERT_TRUE(is_near((double)next[a], (double)past[a][WINDOW - 1U] + 0.0625 + (2.0 * tanh(unit))));
        }
    }
}

static void test_a_nodes_own_weights_are_mixed_with_nobody(void) {
    join_path();
    for (uint32_t second = 0U; second < WINDOW; second++) {
        (void)memset(&weights, 0, sizeof weights);
        weights.first_own[second][2] = 0.5F;
        weights.second_own[2][4] = -0.75F;
        weights.head[4] = 2.0F;
        say();
        for (uint32_t a = 0U; a < 4U; a++) {
            const double unit = tanh(-0.75 * tanh(0.5 * (double)past[a][second]));
            TEST_ASSERT_TRUE(is_near((double)next[a], (double)past[a][WINDOW - 1U] + (2.0 * unit)));
        }
    }
}

/* Nodes that look alike are told alike, and the numbers of the nodes do not matter. */
static void test_nodes_share_their_weights(void) {
    join_all(3U);
    for (uint32_t r = 0U; r < ELMOPP_GCN_UNITS; r++) {
        weights.first_own[r][r] = 0.25F;
        weights.first_passed[r + 3U][r] = -0.125F;
        weights.second_own[r][r] = 0.5F;
        weights.second_passed[r][0] = 0.125F;
        weights.head[r] = 0.5F;
    }
    (void)memcpy(past[1], past[0], sizeof past[1]);
    say();
    TEST_ASSERT_TRUE(next[0] == next[1]);
    const float alone = next[2];
    TEST_ASSERT_FALSE(alone == past[2][WINDOW - 1U]);
    (void)memcpy(past[0], past[2], sizeof past[0]);
    (void)memcpy(past[2], past[1], sizeof past[2]);
    say();
    TEST_ASSERT_TRUE(is_near((double)next[0], (double)alone));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_graph_is_mixed_by_the_roots_of_its_degrees);
    RUN_TEST(test_a_complete_graph_is_mixed_to_the_mean);
    RUN_TEST(test_a_graph_without_nodes_or_with_too_many_is_a_bug);
    RUN_TEST(test_without_weights_it_says_persistence_for_its_nodes_alone);
    RUN_TEST(test_what_a_node_passes_on_is_mixed_in_each_convolution);
    RUN_TEST(test_a_nodes_own_weights_are_mixed_with_nobody);
    RUN_TEST(test_nodes_share_their_weights);
    return UNITY_END();
}

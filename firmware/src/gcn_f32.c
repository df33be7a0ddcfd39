/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/gcn_f32.h"

#include "elmopp/assert.h"
#include "elmopp/dense.h"
#include "elmopp/elementary.h"

#include <assert.h>
#include <stdbool.h>

#define GCN_UNITS ELMOPP_GCN_UNITS
#define GCN_NODES ELMOPP_GCN_NODES_MAX
#define GCN_NEWEST (ELMOPP_GCN_WINDOW_S - 1U)

static_assert(ELMOPP_GCN_UNITS == ELMOPP_DENSE_UNITS, "convolutions are dense");

static bool are_joined(const uint8_t joined[GCN_NODES], uint32_t a, uint32_t b) {
    return (a == b) || ((((uint32_t)joined[a] >> b) & 1U) != 0U);
}

void elmopp_gcn_f32_join(elmopp_gcn_f32_graph_t *graph, uint32_t nodes, const uint8_t joined[ELMOPP_GCN_NODES_MAX]) {
    ELMOPP_ASSERT((nodes >= 1U) && (nodes <= GCN_NODES));
    /* 1 / sqrt(n): the core has no square root, and no node has more neighbours than these. */
    static const float root[GCN_NODES + 1U] = {0.0F,        1.0F,        0.70710678F, 0.57735027F, 0.5F,
                                               0.44721360F, 0.40824829F, 0.37796447F, 0.35355339F};
    float scale[GCN_NODES]; /* D^-1/2 */
    for (uint32_t a = 0U; a < GCN_NODES; a++) {
        uint32_t degree = 0U;
        for (uint32_t b = 0U; b < nodes; b++) {
            degree += are_joined(joined, a, b) ? 1U : 0U;
        }
        scale[a] = root[degree];
    }
    *graph = (elmopp_gcn_f32_graph_t){.nodes = nodes};
    for (uint32_t a = 0U; a < nodes; a++) {
        for (uint32_t b = 0U; b < nodes; b++) {
            graph->mix[a][b] = are_joined(joined, a, b) ? (scale[a] * scale[b]) : 0.0F;
        }
    }
}

/* What a node has made of its own inputs: its own sum, and what it passes on. */
typedef struct {
    float own[GCN_UNITS];
    float passed[GCN_UNITS];
} gcn_sum_t;

/* M X P is the same as M (X P), and has fewer products: every node first works out its row of X P. */
static gcn_sum_t prepare(const float bias[GCN_UNITS], const float (*own)[GCN_UNITS], const float (*passed)[GCN_UNITS],
                         const float *input, uint32_t count) {
    gcn_sum_t sum;
    for (uint32_t r = 0U; r < GCN_UNITS; r++) {
        sum.own[r] = bias[r];
        sum.passed[r] = 0.0F;
    }
    elmopp_dense_add(own, input, count, sum.own);
    elmopp_dense_add(passed, input, count, sum.passed);
    return sum;
}

/* A node's units, once every node is prepared. */
static void gather(const elmopp_gcn_f32_graph_t *graph, uint32_t node, const gcn_sum_t sum[GCN_NODES],
                   float unit[GCN_UNITS]) {
    for (uint32_t r = 0U; r < GCN_UNITS; r++) {
        unit[r] = sum[node].own[r];
    }
    for (uint32_t other = 0U; other < graph->nodes; other++) {
        for (uint32_t r = 0U; r < GCN_UNITS; r++) {
            unit[r] += graph->mix[node][other] * sum[other].passed[r];
        }
    }
    elmopp_tanh_each(unit, GCN_UNITS);
}

void elmopp_gcn_f32_next(const elmopp_gcn_f32_weights_t *weights, const elmopp_gcn_f32_graph_t *graph,
                         const float *const past[ELMOPP_GCN_NODES_MAX], float next[ELMOPP_GCN_NODES_MAX]) {
    ELMOPP_ASSERT((graph->nodes >= 1U) && (graph->nodes <= GCN_NODES));
    gcn_sum_t first[GCN_NODES];
    gcn_sum_t second[GCN_NODES];
    float unit[GCN_UNITS];
    for (uint32_t node = 0U; node < graph->nodes; node++) {
        first[node] =
            prepare(weights->first_bias, weights->first_own, weights->first_passed, past[node], ELMOPP_GCN_WINDOW_S);
    }
    for (uint32_t node = 0U; node < graph->nodes; node++) {
        gather(graph, node, first, unit);
        second[node] = prepare(weights->second_bias, weights->second_own, weights->second_passed, unit, GCN_UNITS);
    }
    for (uint32_t node = 0U; node < graph->nodes; node++) {
        gather(graph, node, second, unit);
        float change = weights->head_bias;
        for (uint32_t r = 0U; r < GCN_UNITS; r++) {
            change += weights->head[r] * unit[r];
        }
        next[node] = past[node][GCN_NEWEST] + change;
    }
}

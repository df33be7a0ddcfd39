/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/gcn_f32.h"

#include "elmopp/assert.h"
#include "elmopp/dense.h"
#include "elmopp/elementary.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

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

/* A convolution's weights. */
typedef struct {
    const float *bias;
    const float (*own)[GCN_UNITS];
    const float (*passed)[GCN_UNITS];
    uint32_t inputs; /* of a node */
} gcn_layer_t;

/* M X P is the same as M (X P), and has fewer products: every node first works out its row of X P. Two nodes at a time,
   as they share the weights. */
static void prepare(const gcn_layer_t *layer, const float *const input[GCN_NODES], uint32_t nodes,
                    gcn_sum_t sum[GCN_NODES]) {
    for (uint32_t node = 0U; node < nodes; node++) {
        (void)memcpy(sum[node].own, layer->bias, sizeof sum[node].own);
        (void)memset(sum[node].passed, 0, sizeof sum[node].passed);
    }
    uint32_t done = 0U;
    for (; (done + 1U) < nodes; done += 2U) {
        const float *one = input[done];
        const float *other = input[done + 1U];
        elmopp_dense_add_twice(layer->own, one, other, layer->inputs, sum[done].own, sum[done + 1U].own);
        elmopp_dense_add_twice(layer->passed, one, other, layer->inputs, sum[done].passed, sum[done + 1U].passed);
    }
    if (done < nodes) {
        elmopp_dense_add(layer->own, input[done], layer->inputs, sum[done].own);
        elmopp_dense_add(layer->passed, input[done], layer->inputs, sum[done].passed);
    }
}

/* A node's units, once every node is prepared. */
static void gather(const elmopp_gcn_f32_graph_t *graph, uint32_t node, const gcn_sum_t sum[GCN_NODES],
                   float unit[GCN_UNITS]) {
    (void)memcpy(unit, sum[node].own, sizeof sum[node].own);
    for (uint32_t r = 0U; r < GCN_UNITS; r += ELMOPP_DENSE_AT_ONCE) {
        float a = unit[r]; /* in locals: gcc keeps an array in memory on a Cortex-M4 */
        float b = unit[r + 1U];
        float c = unit[r + 2U];
        float d = unit[r + 3U];
        for (uint32_t other = 0U; other < graph->nodes; other++) {
            const float *passed = &sum[other].passed[r];
            const float share = graph->mix[node][other];
            a += share * passed[0];
            b += share * passed[1];
            c += share * passed[2];
            d += share * passed[3];
        }
        unit[r] = a;
        unit[r + 1U] = b;
        unit[r + 2U] = c;
        unit[r + 3U] = d;
    }
    elmopp_tanh_each(unit, GCN_UNITS);
}

void elmopp_gcn_f32_next(const elmopp_gcn_f32_weights_t *weights, const elmopp_gcn_f32_graph_t *graph,
                         const float *const past[ELMOPP_GCN_NODES_MAX], float next[ELMOPP_GCN_NODES_MAX]) {
    ELMOPP_ASSERT((graph->nodes >= 1U) && (graph->nodes <= GCN_NODES));
    const gcn_layer_t first = {weights->first_bias, weights->first_own, weights->first_passed, ELMOPP_GCN_WINDOW_S};
    const gcn_layer_t second = {weights->second_bias, weights->second_own, weights->second_passed, GCN_UNITS};
    gcn_sum_t sum[GCN_NODES];
    float unit[GCN_NODES][GCN_UNITS];
    const float *input[GCN_NODES];
    prepare(&first, past, graph->nodes, sum);
    for (uint32_t node = 0U; node < GCN_NODES; node++) {
        input[node] = unit[node];
    }
    for (uint32_t node = 0U; node < graph->nodes; node++) {
        gather(graph, node, sum, unit[node]);
    }
    prepare(&second, input, graph->nodes, sum);
    for (uint32_t node = 0U; node < graph->nodes; node++) {
        gather(graph, node, sum, unit[node]);
        float change = weights->head_bias;
        for (uint32_t r = 0U; r < GCN_UNITS; r++) {
            change += weights->head[r] * unit[node][r];
        }
        next[node] = past[node][GCN_NEWEST] + change;
    }
}

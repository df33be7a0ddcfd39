/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// GCN in single precision: one second of a graph convolutional network (Kipf and Welling 2017; the paper names it for
/// further work). Nodes see their own last seconds and those of the nodes that they are joined to, and say their next.
///
///   M = D^-1/2 (A + I) D^-1/2     A: 1 where two nodes are joined; D: the row sums of A + I
///   H1 = tanh(X S1 + M X P1 + b1)   H2 = tanh(H1 S2 + M H1 P2 + b2)   next = newest + H2 w + b3
///
/// X has a row for each node: its seconds, oldest first. All nodes share the weights, so that they serve any number of
/// nodes and any graph. S are weights of a node's own, beside Kipf and Welling's P: in a complete graph every row of M
/// is the mean of all nodes, and without S all nodes would have to say the same change (measured: weights/README.md).
/// What it learns is the change from the newest second, so that a network without any weights says persistence.
///
/// It knows no traffic, no scale and no time, and keeps no state: whoever wants to look further ahead moves the windows
/// on by what it said. Every sum starts with the bias and runs over the node's own inputs, then over the nodes, each in
/// index order, products and sums rounded separately, so that gcc, clang and a Cortex-M4 give the same bits. The
/// instructions depend on the number of nodes alone. No allocation; bounded by ELMOPP_APPROACH_MAX. Weights belong to
/// the caller.

#ifndef ELMOPP_GCN_F32_H
#define ELMOPP_GCN_F32_H

#include "elmopp/bounds.h"

#include <stdint.h>

#define ELMOPP_GCN_NODES_MAX ELMOPP_APPROACH_MAX
#define ELMOPP_GCN_WINDOW_S 32U ///< seconds of each node
#define ELMOPP_GCN_UNITS 16U    ///< of each convolution

/// All weights. weights.h says whether they can be used.
typedef struct {
    float first_bias[ELMOPP_GCN_UNITS];                        ///< b1
    float first_own[ELMOPP_GCN_WINDOW_S][ELMOPP_GCN_UNITS];    ///< [second][unit] S1
    float first_passed[ELMOPP_GCN_WINDOW_S][ELMOPP_GCN_UNITS]; ///< [second][unit] P1
    float second_bias[ELMOPP_GCN_UNITS];                       ///< b2
    float second_own[ELMOPP_GCN_UNITS][ELMOPP_GCN_UNITS];      ///< [unit before][unit] S2
    float second_passed[ELMOPP_GCN_UNITS][ELMOPP_GCN_UNITS];   ///< [unit before][unit] P2
    float head_bias;                                           ///< b3
    float head[ELMOPP_GCN_UNITS];                              ///< w
} elmopp_gcn_f32_weights_t;

/// A graph, ready to be convolved over.
typedef struct {
    uint32_t nodes;                                        ///< 1..ELMOPP_GCN_NODES_MAX
    float mix[ELMOPP_GCN_NODES_MAX][ELMOPP_GCN_NODES_MAX]; ///< M
} elmopp_gcn_f32_graph_t;

/// Works M out. `joined`[node] is the mask of the nodes that it is joined to, symmetric; bits of itself and of nodes
/// that do not exist are ignored.
void elmopp_gcn_f32_join(elmopp_gcn_f32_graph_t *graph, uint32_t nodes, const uint8_t joined[ELMOPP_GCN_NODES_MAX]);

/// What comes to each node in the next second. `past`[node] points to ELMOPP_GCN_WINDOW_S finite values, oldest first.
/// The weights have passed elmopp_weights_check(). Beyond the graph's nodes `past` is not read and `next` not written.
void elmopp_gcn_f32_next(const elmopp_gcn_f32_weights_t *weights, const elmopp_gcn_f32_graph_t *graph,
                         const float *const past[ELMOPP_GCN_NODES_MAX], float next[ELMOPP_GCN_NODES_MAX]);

#endif

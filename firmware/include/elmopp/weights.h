/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Weights: everything that tools/train learns about traffic, as one struct, and the check before it is used.
///
/// Loads an "ELMW" image (image.h) whose body is the struct below, and names what is wrong with one that it refuses:
/// weights of another version, of another shape, cut, changed on the way, no numbers. It decides nothing about
/// forecasts; who is refused keeps what he has, and the forecast falls to the mean (forecast.h).
///
/// One image serves four forecasts: one recurrent network, lstm or nlstm by its levels, and the two that see a window
/// of seconds, ann and gcn, which are small enough to be in every image.
///
/// The layout is fixed: 4-byte members, no padding, little-endian. weights/elmopp_weights.c holds the shipped ones,
/// made by tools/weights from weights/forecast.safetensors. Owner: the caller; everybody else holds a const pointer.

#ifndef ELMOPP_WEIGHTS_H
#define ELMOPP_WEIGHTS_H

#include "elmopp/ann_f32.h"
#include "elmopp/ar8.h"
#include "elmopp/gcn_f32.h"
#include "elmopp/image.h"
#include "elmopp/lstm_f32.h"

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

/// The layout that this firmware reads.
#define ELMOPP_WEIGHTS_VERSION_NOW 2U

/// Largest clamp: arrivals of one second are never more than so many times the mean.
#define ELMOPP_WEIGHTS_CLAMP_MAX 1000.0F

/// No other value is larger in size: a row of weights cannot overflow a sum.
#define ELMOPP_WEIGHTS_VALUE_MAX 1000.0F

typedef struct {
    float low[ELMOPP_LSTM_INPUTS];  ///< [input] the network sees and says no less, in units of the demand scale; >= 0
    float high[ELMOPP_LSTM_INPUTS]; ///< ... and no more: the range of the training data, widened by a tenth each side
    elmopp_ar8_t ar8;               ///< the regression fitted to the same data, for any approach
    elmopp_lstm_f32_weights_t lstm;
    elmopp_ann_f32_weights_t ann; ///< in the clamp `low` to `high`
    elmopp_gcn_f32_weights_t gcn; ///< in the clamp of `ar8`, for any approach: its nodes share their weights
} elmopp_weights_t;

static_assert(sizeof(elmopp_weights_t) == 34484U, "weights must have no implicit padding");

/// What is wrong with an image, in the order in which it is looked at.
typedef enum {
    ELMOPP_WEIGHTS_OK = 0,
    ELMOPP_WEIGHTS_MAGIC,   ///< does not begin with "ELMW"
    ELMOPP_WEIGHTS_VERSION, ///< another layout
    ELMOPP_WEIGHTS_LENGTH,  ///< cut, too long, or of other shapes
    ELMOPP_WEIGHTS_CRC,     ///< changed on the way
    ELMOPP_WEIGHTS_LEVELS,  ///< the recurrent network has not 1 to ELMOPP_LSTM_LEVELS_MAX
    ELMOPP_WEIGHTS_CLAMP,   ///< not 0 <= low < high <= ELMOPP_WEIGHTS_CLAMP_MAX
    ELMOPP_WEIGHTS_VALUE,   ///< a weight is no number or larger than ELMOPP_WEIGHTS_VALUE_MAX
    ELMOPP_WEIGHTS_FAULT_COUNT
} elmopp_weights_fault_t;

/// What a fault is called, for a status line. Never null, whatever the number.
const char *elmopp_weights_fault_name(elmopp_weights_fault_t fault);

/// Whether weights may have been learnt from those that a network began with (learner.h): as many levels, and
/// everything that learning leaves alone the same.
bool elmopp_weights_are_learnt_from(const elmopp_weights_t *weights, const elmopp_weights_t *base);

/// What an image of weights is.
const elmopp_image_kind_t *elmopp_weights_kind(void);

/// First fault of the struct itself, ELMOPP_WEIGHTS_LEVELS or later; ELMOPP_WEIGHTS_OK if it can be used.
elmopp_weights_fault_t elmopp_weights_check(const elmopp_weights_t *weights);

/// First fault of an image in place; ELMOPP_WEIGHTS_OK if its body can be used where it stands.
elmopp_weights_fault_t elmopp_weights_check_image(const uint8_t *image, uint32_t length);

/// Copies a checked image into `out`. On any fault `out` is unchanged.
elmopp_weights_fault_t elmopp_weights_load(const uint8_t *image, uint32_t length, elmopp_weights_t *out);

#endif

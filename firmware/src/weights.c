/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/weights.h"

#include <stddef.h>
#include <string.h>

const char *elmopp_weights_fault_name(elmopp_weights_fault_t fault) {
    static const char *const name[ELMOPP_WEIGHTS_FAULT_COUNT] = {"good",
                                                                 "not an ELMW image",
                                                                 "an ELMW image of another version",
                                                                 "an ELMW image of another length",
                                                                 "an ELMW image whose checksum does not fit",
                                                                 "weights of another number of levels",
                                                                 "weights whose clamp is no range",
                                                                 "weights of which one is no number or out of range"};
    return (fault < ELMOPP_WEIGHTS_FAULT_COUNT) ? name[fault] : "an unknown fault";
}

/* False for a NaN too. */
static bool is_between(float value, float low, float high) {
    return (value >= low) && (value <= high);
}

static bool is_range(float low, float high) {
    return is_between(low, 0.0F, ELMOPP_WEIGHTS_CLAMP_MAX) && is_between(high, 0.0F, ELMOPP_WEIGHTS_CLAMP_MAX) &&
           (low < high);
}

/* Every word of the body as the float that it is; `levels` is none, but as one it is next to zero. */
static bool are_values(const uint8_t *body) {
    bool good = true;
    for (uint32_t at = 0U; at < (uint32_t)sizeof(elmopp_weights_t); at += (uint32_t)sizeof(float)) {
        float value;
        (void)memcpy(&value, &body[at], sizeof value);
        good = good && is_between(value, -ELMOPP_WEIGHTS_VALUE_MAX, ELMOPP_WEIGHTS_VALUE_MAX);
    }
    return good;
}

/* Judges the bytes of an elmopp_weights_t in place: a copy of the whole would be too much for a small board's stack. */
static elmopp_weights_fault_t check_body(const uint8_t *body) {
    uint32_t levels;
    (void)memcpy(&levels, &body[offsetof(elmopp_weights_t, lstm.levels)], sizeof levels);
    if ((levels < 1U) || (levels > ELMOPP_LSTM_LEVELS_MAX)) {
        return ELMOPP_WEIGHTS_LEVELS;
    }
    float low[ELMOPP_LSTM_INPUTS];
    float high[ELMOPP_LSTM_INPUTS];
    elmopp_ar8_t ar8;
    (void)memcpy(low, &body[offsetof(elmopp_weights_t, low)], sizeof low);
    (void)memcpy(high, &body[offsetof(elmopp_weights_t, high)], sizeof high);
    (void)memcpy(&ar8, &body[offsetof(elmopp_weights_t, ar8)], sizeof ar8);
    bool ranges = is_range(ar8.low, ar8.high);
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        ranges = ranges && is_range(low[k], high[k]);
    }
    if (!ranges) {
        return ELMOPP_WEIGHTS_CLAMP;
    }
    return are_values(body) ? ELMOPP_WEIGHTS_OK : ELMOPP_WEIGHTS_VALUE;
}

elmopp_weights_fault_t elmopp_weights_check(const elmopp_weights_t *weights) {
    return check_body((const uint8_t *)weights);
}

/* What lies before the recurrent network, and what lies behind it. */
bool elmopp_weights_are_learnt_from(const elmopp_weights_t *weights, const elmopp_weights_t *base) {
    const size_t before = offsetof(elmopp_weights_t, lstm);
    const size_t behind = offsetof(elmopp_weights_t, ann);
    const uint8_t *ours = (const uint8_t *)weights;
    const uint8_t *theirs = (const uint8_t *)base;
    return (weights->lstm.levels == base->lstm.levels) && (memcmp(ours, theirs, before) == 0) &&
           (memcmp(&ours[behind], &theirs[behind], sizeof *weights - behind) == 0);
}

const elmopp_image_kind_t *elmopp_weights_kind(void) {
    static const elmopp_image_kind_t kind = {
        {0x45U, 0x4CU, 0x4DU, 0x57U}, ELMOPP_WEIGHTS_VERSION_NOW, (uint32_t)sizeof(elmopp_weights_t)}; /* "ELMW" */
    return &kind;
}

static elmopp_weights_fault_t check_header(const uint8_t *image, uint32_t length) {
    switch (elmopp_image_check(elmopp_weights_kind(), image, length)) {
    case ELMOPP_IMAGE_OK:
        return ELMOPP_WEIGHTS_OK;
    case ELMOPP_IMAGE_MAGIC:
        return ELMOPP_WEIGHTS_MAGIC;
    case ELMOPP_IMAGE_VERSION:
        return ELMOPP_WEIGHTS_VERSION;
    case ELMOPP_IMAGE_LENGTH:
        return ELMOPP_WEIGHTS_LENGTH;
    case ELMOPP_IMAGE_CRC:
    default:
        return ELMOPP_WEIGHTS_CRC;
    }
}

elmopp_weights_fault_t elmopp_weights_check_image(const uint8_t *image, uint32_t length) {
    const elmopp_weights_fault_t fault = check_header(image, length);
    return (fault == ELMOPP_WEIGHTS_OK) ? check_body(&image[ELMOPP_IMAGE_HEADER]) : fault;
}

elmopp_weights_fault_t elmopp_weights_load(const uint8_t *image, uint32_t length, elmopp_weights_t *out) {
    const elmopp_weights_fault_t fault = elmopp_weights_check_image(image, length);
    if (fault == ELMOPP_WEIGHTS_OK) {
        (void)memcpy(out, &image[ELMOPP_IMAGE_HEADER], sizeof *out);
    }
    return fault;
}

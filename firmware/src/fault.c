/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/fault.h"

#include <stddef.h>
#include <stdint.h>

const char *elmopp_fault_name(elmopp_fault_t fault) {
    static const char *const names[ELMOPP_FAULT_COUNT] = {
        [ELMOPP_FAULT_NONE] = "none",
        [ELMOPP_FAULT_CONFLICT] = "conflict",
        [ELMOPP_FAULT_SHORT_INTERGREEN] = "short intergreen",
        [ELMOPP_FAULT_SHORT_AMBER] = "short amber",
        [ELMOPP_FAULT_SHORT_RED_AMBER] = "short red-amber",
        [ELMOPP_FAULT_SHORT_GREEN] = "short green",
        [ELMOPP_FAULT_SEQUENCE] = "wrong sequence",
        [ELMOPP_FAULT_TWO_COLOURS] = "two colours",
        [ELMOPP_FAULT_DARK] = "dark",
        [ELMOPP_FAULT_FLASHING] = "flashing against the mode",
        [ELMOPP_FAULT_UNKNOWN_GROUP] = "lamp of an unknown group",
        [ELMOPP_FAULT_FEEDBACK_DIFFERS] = "feedback differs",
        [ELMOPP_FAULT_FEEDBACK_LOST] = "feedback lost",
        [ELMOPP_FAULT_LAMP_NODE] = "lamp node",
        [ELMOPP_FAULT_SELF_TEST] = "self-test of the lamps",
        [ELMOPP_FAULT_SITE_CHANGED] = "site data changed",
        [ELMOPP_FAULT_WEIGHTS_CHANGED] = "weights changed",
        [ELMOPP_FAULT_CLOCK] = "clock",
        [ELMOPP_FAULT_SECOND_CONTROLLER] = "second controller",
        [ELMOPP_FAULT_MEMORY] = "memory test",
        [ELMOPP_FAULT_PROCESSOR] = "processor",
        [ELMOPP_FAULT_OSCILLATOR] = "oscillator",
        [ELMOPP_FAULT_CAN_CONTROLLER] = "CAN controller",
        [ELMOPP_FAULT_BROWN_OUT] = "brown-out reset",
    };
    const uint32_t number = (uint32_t)fault;
    const char *name = (number < (uint32_t)ELMOPP_FAULT_COUNT) ? names[number] : NULL;
    return (name != NULL) ? name : "unknown fault";
}

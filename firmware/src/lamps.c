/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lamps.h"

#include <stdbool.h>

/* The lamps of each aspect. */
static const uint8_t lamps_of_aspect[ELMOPP_ASPECT_COUNT] = {
    [ELMOPP_ASPECT_DARK] = 0U,      [ELMOPP_ASPECT_RED] = 1U,   [ELMOPP_ASPECT_RED_AMBER] = 3U,
    [ELMOPP_ASPECT_GREEN] = 4U,     [ELMOPP_ASPECT_AMBER] = 2U, [ELMOPP_ASPECT_FLASH_AMBER] = 10U,
    [ELMOPP_ASPECT_FLASH_RED] = 9U,
};

#define FLASHES 3U

static uint32_t has(uint16_t mask, uint32_t g) {
    return ((uint32_t)mask >> g) & 1U;
}

static uint16_t with(uint16_t mask, uint32_t g, uint32_t on) {
    return (uint16_t)(((uint32_t)mask & ~((uint32_t)1U << g)) | ((on & 1U) << g));
}

uint32_t elmopp_lamps_bits(const elmopp_lamps_t *lamps, uint32_t g) {
    return has(lamps->red, g) | (has(lamps->amber, g) << 1U) | (has(lamps->green, g) << 2U) |
           (has(lamps->flash, g) << 3U);
}

void elmopp_lamps_light(elmopp_lamps_t *lamps, uint32_t g, uint32_t bits) {
    lamps->red = with(lamps->red, g, bits);
    lamps->amber = with(lamps->amber, g, bits >> 1U);
    lamps->green = with(lamps->green, g, bits >> 2U);
    lamps->flash = with(lamps->flash, g, bits >> 3U);
}

elmopp_aspect_t elmopp_lamps_aspect(const elmopp_lamps_t *lamps, uint32_t g) {
    const uint32_t burning = elmopp_lamps_bits(lamps, g);
    elmopp_aspect_t found = ELMOPP_ASPECT_COUNT;
    for (uint32_t a = 0U; a < (uint32_t)ELMOPP_ASPECT_COUNT; a++) {
        found = (lamps_of_aspect[a] == burning) ? (elmopp_aspect_t)a : found;
    }
    return found;
}

void elmopp_lamps_show(elmopp_lamps_t *lamps, uint32_t g, elmopp_aspect_t aspect) {
    const bool exists = (uint32_t)aspect < (uint32_t)ELMOPP_ASPECT_COUNT;
    elmopp_lamps_light(lamps, g, exists ? lamps_of_aspect[aspect] : 0U);
}

elmopp_lamps_t elmopp_lamps_flashing(const elmopp_junction_t *junction, uint16_t groups) {
    static const elmopp_aspect_t aspects[FLASHES] = {[ELMOPP_FLASH_AMBER] = ELMOPP_ASPECT_FLASH_AMBER,
                                                     [ELMOPP_FLASH_RED] = ELMOPP_ASPECT_FLASH_RED,
                                                     [ELMOPP_FLASH_DARK] = ELMOPP_ASPECT_DARK};
    elmopp_lamps_t lamps = {0U, 0U, 0U, 0U};
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        if (has(groups, g) != 0U) {
            const uint32_t flash = junction->group[g].flash;
            elmopp_lamps_show(&lamps, g, (flash < FLASHES) ? aspects[flash] : ELMOPP_ASPECT_FLASH_AMBER);
        }
    }
    return lamps;
}

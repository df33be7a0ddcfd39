/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A board around a keeper: a whole controller on its bench, the two media, which can fail, and the bus as whoever
/// sends images hears it. What a main does (keeper.h) is done here: orders are carried out, weights put to use, and
/// begun anew with another site.
///
/// It sends nothing by itself: a test, or a fuzzer, gives the frames to elmopp_keeper_take().

#ifndef ELMOPP_TEST_KEEPER_BENCH_H
#define ELMOPP_TEST_KEEPER_BENCH_H

#include "elmopp/keeper.h"

#include "bench.h"

#define KEEPER_BENCH_WEIGHTS_BYTES (16U + (uint32_t)sizeof(elmopp_weights_t))
#define KEEPER_BENCH_SITE_BYTES (16U + (uint32_t)sizeof(elmopp_junction_t))
#define KEEPER_BENCH_SECTORS 2U
#define KEEPER_BENCH_SECTOR_SLOTS 3U
#define KEEPER_BENCH_WEIGHTS_SLOT (KEEPER_BENCH_WEIGHTS_BYTES + 28U)
#define KEEPER_BENCH_WEIGHTS_SECTOR ((KEEPER_BENCH_SECTOR_SLOTS * KEEPER_BENCH_WEIGHTS_SLOT) + 8U)
#define KEEPER_BENCH_SITE_SLOT (KEEPER_BENCH_SITE_BYTES + 20U)
#define KEEPER_BENCH_SITE_SECTOR ((KEEPER_BENCH_SECTOR_SLOTS * KEEPER_BENCH_SITE_SLOT) + 4U)
#define KEEPER_BENCH_NEVER UINT32_MAX

/// Read all of it; write only what is said to be the test's.
typedef struct {
    bench_t bench; ///< the test's
    elmopp_keeper_t keeper;
    elmopp_keeper_config_t config;   ///< the test's, from the next power-up on
    const elmopp_weights_t *shipped; ///< compiled in
    elmopp_junction_t first_site;    ///< compiled in; the test's, from the next power-up on
    uint32_t medium_fails; ///< the test's: so many orders from now on are carried out, then they fail; or _NEVER
    uint32_t erases;       ///< so far; the test may set it back, as what follows
    uint32_t begins;       ///< of the controller
    uint32_t may_send;     ///< segments, by the last flow control
    elmopp_transfer_report_t report; ///< the last that is not for a second sender
    uint32_t reports;
    uint32_t busy_reports; ///< for a second sender
    uint8_t weights_medium[KEEPER_BENCH_SECTORS * KEEPER_BENCH_WEIGHTS_SECTOR];
    uint8_t site_medium[KEEPER_BENCH_SECTORS * KEEPER_BENCH_SITE_SECTOR];
} keeper_bench_t;

/// Blank media that need erasing before the lamps, everybody waiting; then the power comes.
void keeper_bench_start(keeper_bench_t *self, const elmopp_junction_t *site, const elmopp_weights_t *shipped,
                        uint32_t save_min_s);

/// The power comes, after a cut at this moment: what is in the media has stayed.
void keeper_bench_power_up(keeper_bench_t *self);

/// A lamp tick of bench and keeper, and what this asks of a main.
void keeper_bench_tick(keeper_bench_t *self);

#endif

/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Detector: what the cameras count, and whether to believe it.
///
/// Takes the counts of an approach as often as they come and closes a second when told. Arrivals are running counters
/// modulo 64, so that a lost frame loses no vehicle; a counter that jumps further than traffic can, or comes back after
/// ELMOPP_DETECTOR_GAP_S, is taken up anew and nothing is counted for the jump.
///
/// A movement is trusted when its last ELMOPP_DETECTOR_RECOVER_S seconds were good: a frame no older than
/// ELMOPP_DETECTOR_STALE_S, marked valid, with a known presence, no impossible jump, and none of the site's three
/// diagnoses (NTCIP 1202 2.3.2.8 to 2.3.2.10): no activity, maximum presence, erratic counts. An untrusted movement is
/// on recall: somebody may wait there, and its counts are replaced by what it had on average while it was trusted.
///
/// It knows no lamp, no forecast and no CAN, and decides nothing about stages. Times are whole seconds and saturate.
/// Owner: the controller. Not thread-safe; no allocation; bounded by ELMOPP_MOVEMENT_MAX.

#ifndef ELMOPP_DETECTOR_H
#define ELMOPP_DETECTOR_H

#include "elmopp/junction.h"

#define ELMOPP_DETECTOR_UNKNOWN 511U ///< presence of a counter that does not know
#define ELMOPP_DETECTOR_MODULO 64U   ///< of the running arrivals
#define ELMOPP_DETECTOR_STALE_S 3U   ///< a frame is due every second
#define ELMOPP_DETECTOR_GAP_S 10U    ///< longer ago, the running arrivals may have gone round
#define ELMOPP_DETECTOR_RECOVER_S 5U ///< good seconds before a movement is believed (again)
#define ELMOPP_DETECTOR_RATE_VEH 4U  ///< no lane brings more vehicles a second
#define ELMOPP_DETECTOR_MEAN_S 900U  ///< memory of the average arrivals

/// Why a movement is not believed. The numbers are the reasons of DetectorCounts; a camera's own come through.
enum {
    ELMOPP_REASON_OK = 0,
    ELMOPP_REASON_NO_ACTIVITY = 9,
    ELMOPP_REASON_MAX_PRESENCE = 10,
    ELMOPP_REASON_ERRATIC = 11,
    ELMOPP_REASON_STALE = 12,
    ELMOPP_REASON_COUNT = 16
};

/// What one frame says about one movement.
typedef struct {
    uint16_t present_veh; ///< in the reach; ELMOPP_DETECTOR_UNKNOWN: not known
    uint8_t arrivals;     ///< running, modulo ELMOPP_DETECTOR_MODULO
    bool valid;
} elmopp_detector_report_t;

/// One movement. Times in seconds.
typedef struct {
    uint16_t present_veh;
    uint16_t arrived_veh; ///< since the last closed second
    uint16_t counted_veh; ///< arrivals in this minute
    uint16_t age_s;       ///< of the last frame
    uint16_t good_s;      ///< without interruption
    uint16_t silent_s;    ///< since the last arrival
    uint16_t busy_s;      ///< always somebody there
    uint8_t arrivals;     ///< as last received
    uint8_t reason;       ///< of the last frame, or what this room has found
    bool started;         ///< `arrivals` holds something
    bool valid;           ///< as last received
    bool jumped;          ///< in this second
    bool erratic;         ///< too many arrivals in the last whole minute or already in this one
    uint32_t seen_s;      ///< trusted seconds in the average
    float mean_veh_per_s; ///< arrivals while trusted
    float second_veh;     ///< arrivals of the closed second
} elmopp_detector_lane_t;

/// State. Set up by elmopp_detector_init(); nobody else writes it.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_detector_lane_t lane[ELMOPP_MOVEMENT_MAX];
    uint32_t trusted; ///< mask of movements, as of the last closed second
    uint8_t minute_s; ///< seconds into the minute of the erratic counts
} elmopp_detector_t;

/// Nothing seen, nobody trusted.
void elmopp_detector_init(elmopp_detector_t *self, const elmopp_junction_t *junction);

/// Takes one frame of an approach: the reports of its movements in site order. `reason`: the camera's own, 0 to 15.
void elmopp_detector_take(elmopp_detector_t *self, uint32_t approach,
                          const elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX], uint8_t reason);

/// Closes a second: everybody gets older, is judged, and his arrivals are those of this second.
void elmopp_detector_second(elmopp_detector_t *self);

/// Fills [movement] what is present and what arrived in the closed second; for an untrusted movement its average
/// arrivals, and as many vehicles as they bring in the time since its last green, at most its capacity and at least
/// one.
void elmopp_detector_counts(const elmopp_detector_t *self, const uint16_t *red_ds, float *present_veh,
                            float *arrived_veh);

#endif

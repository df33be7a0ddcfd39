/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The sizes of everything: every loop of the core ends at one of these or at a count that a site check has held
/// against one.
///
/// A site that needs more is refused by tools/site and by elmopp_site_check(); nothing is ever cut to fit.

#ifndef ELMOPP_BOUNDS_H
#define ELMOPP_BOUNDS_H

#define ELMOPP_APPROACH_MAX 8U  ///< approaches (the paper's inroads) of one junction
#define ELMOPP_MOVEMENT_MAX 24U ///< movements (lane groups, the paper's subedges) of one junction
#define ELMOPP_GROUP_MAX 16U    ///< signal groups of one junction; a group mask is uint16_t
#define ELMOPP_STAGE_MAX 32U    ///< stages (the paper's configurations) of one junction
#define ELMOPP_HORIZON_MAX 150U ///< seconds that a forecast can look ahead

#define ELMOPP_APPROACH_MOVEMENT_MAX 3U ///< movements of one approach that its counts can carry over the bus
#define ELMOPP_NODE_MAX 8U              ///< lamp nodes of one junction
#define ELMOPP_PROGRAM_MAX 4U           ///< fixed-time programmes of one junction
#define ELMOPP_STEP_MAX 16U             ///< steps of one programme
#define ELMOPP_SCHEDULE_MAX 16U         ///< lines of the weekly schedule
#define ELMOPP_SPECIAL_DAY_MAX 16U      ///< dates that follow another weekday's schedule

#define ELMOPP_STAGE_NONE 63U ///< "no stage": before the first decision and during an intergreen
#define ELMOPP_STAGE_RED 62U  ///< a wish only: no group green

#define ELMOPP_LAMP_TICK_DS 1U      ///< the plan moves every 100 ms
#define ELMOPP_LAMP_TICKS_PER_S 10U ///< lamp ticks between two decisions

#define ELMOPP_SITE_NAME_SIZE 24U ///< bytes of a site's name with its terminating zero
#define ELMOPP_NAME_SIZE 12U      ///< bytes of an approach's, movement's or group's name with its terminating zero

#endif

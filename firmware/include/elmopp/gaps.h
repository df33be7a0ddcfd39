/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Gaps: how fast vehicles that give way get through the traffic that they cross.
///
/// Who turns on a green that others have too waits for a gap in their flow. If they come independently of each other, q
/// a second together, if he takes every gap of at least t_c, and if those behind him follow through the same gap every
/// t_f, one lane lets go
///
///     q e^(-q t_c) / (1 - e^(-q t_f))        vehicles a second, 1 / t_f where nobody comes
///
/// (Harders, Strassenbau und Strassenverkehrstechnik 76, 1968; the saturation flow of a permitted left turn after the
/// opposing queue in the Highway Capacity Manual 2016, with its t_c = 4.5 s and t_f = 2.5 s). Siegloch's
/// e^(-q (t_c - t_f / 2)) / t_f (1973) is at most 7 % above it up to half a vehicle a second.
///
/// It decides nothing, keeps no state and knows no junction: who gives way to whom is said by the site, who comes by
/// coming.h. Drivers differ: t_c was measured between 4 and 6 s, so a flow may be wrong by a third.

#ifndef ELMOPP_GAPS_H
#define ELMOPP_GAPS_H

#define ELMOPP_GAPS_CRITICAL_S 4.5F  ///< t_c: the shortest gap that is taken
#define ELMOPP_GAPS_FOLLOW_UP_S 2.5F ///< t_f: between two vehicles in the same gap

/// Beyond this flow of those who go first there are no gaps.
#define ELMOPP_GAPS_OPPOSING_MAX_VEH_PER_S 1.5F

/// The formula above, from a table, at most 0.0005 vehicles a second beside it; 0 beyond the bound, where the formula
/// is below 0.0018. Less than 0 is as 0, a NaN as too many.
float elmopp_gaps_flow(float opposing_veh_per_s);

/// Flow of lanes in which `share` of the vehicles give way and the others need not, but cannot get by: the harmonic
/// mean of the two flows, as in the formula for shared lanes of the same sources. saturation_veh_per_s above 0; of
/// through_veh_per_s, what gaps let go, no more than that counts; share above 0, at most 1. Never
/// below 0.
float elmopp_gaps_shared(float saturation_veh_per_s, float through_veh_per_s, float share);

#endif

// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The C core, seen from C++.

#pragma once

extern "C" {
#include "elmopp/age.h"
#include "elmopp/ar8.h"
#include "elmopp/chooser.h"
#include "elmopp/controller.h"
#include "elmopp/forecast.h"
#include "elmopp/image.h"
#include "elmopp/junction.h"
#include "elmopp/learner.h"
#include "elmopp/lstm_f32.h"
#include "elmopp/outflow.h"
#include "elmopp/pilot.h"
#include "elmopp/plan.h"
#include "elmopp/pressure.h"
#include "elmopp/priced.h"
#include "elmopp/rollout.h"
#include "elmopp/sight.h"
#include "elmopp/site.h"
#include "elmopp/trainer.h"
#include "elmopp/urgency.h"
#include "elmopp/weights.h"
}

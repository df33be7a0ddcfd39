/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Asserts that stay in the roadside image: a bug ends in elmopp_assert_failed(), bad data is a return value.
///
/// They do not depend on NDEBUG, which CMake's Release sets. The port (or host_sim, or a test) supplies the one
/// function below; it drives the fail-safe aspect or ends the process, and does not return.

#ifndef ELMOPP_ASSERT_H
#define ELMOPP_ASSERT_H

/// Called with the place of a broken promise inside the core. Must not return.
_Noreturn void elmopp_assert_failed(const char *file, int line);

/// Holds a promise that only a bug can break. Has no side effect of its own and is never compiled out.
#define ELMOPP_ASSERT(condition)                                                                                       \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            elmopp_assert_failed(__FILE__, __LINE__);                                                                  \
        }                                                                                                              \
    } while (0)

#endif

// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The live page as it is sent: live_page/page.html, byte for byte, compiled in.

#pragma once

namespace elmopp {

extern const char *const live_page_html;

} // namespace elmopp

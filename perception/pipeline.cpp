// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "pipeline.hpp"

#include <dlfcn.h>

#include <cstdint>

namespace elmopp {
namespace {

/// GLib's GError, a public struct of its stable interface.
struct GlibError {
    std::uint32_t domain;
    int code;
    char *message;
};

/// The few functions of GStreamer 1 that are needed. OpenCV brings the library, but no header of it.
struct Gstreamer {
    Gstreamer() : library(dlopen("libgstreamer-1.0.so.0", RTLD_NOW | RTLD_GLOBAL)) {
        find(init, "gst_init_check");
        find(parse, "gst_parse_launch_full");
        find(release, "gst_object_unref");
        find(release_error, "g_error_free");
    }

    template <typename Function> void find(Function &function, const char *name) {
        function = library == nullptr ? nullptr : reinterpret_cast<Function>(dlsym(library, name));
        complete = complete && function != nullptr;
    }

    void *library; ///< stays: it cannot be unloaded
    bool complete = true;
    int (*init)(int *, char ***, GlibError **) = nullptr;
    void *(*parse)(const char *, void *, int, GlibError **) = nullptr;
    void (*release)(void *) = nullptr;
    void (*release_error)(GlibError *) = nullptr;
};

} // namespace

std::string pipeline_fault(const std::string &pipeline) {
    constexpr int fatal_errors = 1; // GST_PARSE_FLAG_FATAL_ERRORS
    const std::size_t sink = pipeline.rfind("appsink");
    if (sink == std::string::npos || pipeline.find('!') > sink) {
        return "is no pipeline that ends with appsink";
    }
    const Gstreamer gstreamer;
    if (!gstreamer.complete || gstreamer.init(nullptr, nullptr, nullptr) == 0) {
        return "";
    }
    GlibError *error = nullptr;
    void *const parsed = gstreamer.parse(pipeline.c_str(), nullptr, fatal_errors, &error);
    std::string fault;
    if (error != nullptr) {
        fault = std::string("is no pipeline: ") + error->message;
        gstreamer.release_error(error);
    }
    if (parsed != nullptr) {
        gstreamer.release(parsed);
    }
    return fault;
}

} // namespace elmopp

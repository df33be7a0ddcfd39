// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// elmopp-camera: reads a camera or a video, counts, and says so once a second: on a CAN bus, as lines of JSON, as
/// pictures. Turns arguments into a Counter and carries frames to it; it decides nothing about what is seen.

#include "camera_bus.hpp"
#include "can_interface.hpp"
#include "can_socket.hpp"
#include "counter.hpp"
#include "detector.hpp"
#include "error.hpp"
#include "overlay.hpp"
#include "program.hpp"
#include "record_json.hpp"
#include "source.hpp"
#include "whole_file.hpp"

#include <CLI/CLI.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

namespace elmopp {
namespace {

const char *const camera_program = "elmopp-camera";

std::string size_text(const cv::Size &size) {
    return std::to_string(size.width) + " x " + std::to_string(size.height);
}

volatile std::sig_atomic_t stop_asked = 0;

struct CameraRequest {
    std::string source;
    std::string lanes;
    std::string can;
    std::string jsonl;
    std::string overlay;
    std::string crossings;
    std::string timing;
    std::vector<std::string> tries;
    std::string seconds; ///< empty: without an end
};

/// As strtod reads it; 0 if that is not all of the text.
double number_of(const std::string &text) {
    char *end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    return text.empty() || *end != '\0' || !std::isfinite(number) ? 0.0 : number;
}

/// When to end; 0: never.
double end_s(const std::string &seconds) {
    const double number = number_of(seconds);
    if (!seconds.empty() && number <= 0) {
        throw BadRequest("--seconds " + seconds + ": right would be a number above 0");
    }
    return number;
}

/// The defaults, but for those that are tried.
Settings settings_of(const CameraRequest &request) {
    Settings settings;
    for (const std::string &one : request.tries) {
        const std::size_t equals = one.find('=');
        double *const setting = setting_named(settings, one.substr(0, equals));
        const double number = equals == std::string::npos ? 0.0 : number_of(one.substr(equals + 1));
        if (setting == nullptr || number <= 0) {
            throw BadRequest("--try " + one + ": right would be NAME=VALUE with a name from perception/settings.hpp");
        }
        *setting = number;
    }
    return settings;
}

/// Lines that are written at once: somebody may be reading them. The first one that cannot be written is the last.
class Lines {
  public:
    Lines(const std::string &option, const std::string &file) : option_(option), file_(file) {
        if (file_.empty() || file_ == "-") {
            return;
        }
        stream_.open(file_);
        if (!stream_) {
            throw BadRequest(option + " " + file_ +
                             ": cannot be written; right would be a file in a folder that is there");
        }
    }

    void write(const std::string &line) {
        if (file_.empty()) {
            return;
        }
        errno = 0;
        if (!((file_ == "-" ? std::cout : stream_) << line << "\n" << std::flush)) {
            const int why = errno;
            throw Failure(option_ + " " + file_ + ": could not be written" +
                          (why != 0 ? ": " + std::generic_category().message(why) : ""));
        }
    }

  private:
    std::string option_;
    std::string file_;
    std::ofstream stream_;
};

/// What the program cost, for tools/score-counter.
class Timing {
  public:
    void begin() {
        began_ = processor_s();
    }

    void end() {
        frames_s_.add(processor_s() - began_);
    }

    /// A live frame was so old when all was done with it.
    void late(double latency_s) {
        latencies_s_.add(latency_s);
    }

    [[nodiscard]] std::string line() const {
        rusage used{};
        getrusage(RUSAGE_SELF, &used);
        const double cpu_s = processor_s();
        constexpr double kib_a_mib = 1024.0;
        constexpr double most = 1.0;
        constexpr double usual_most = 0.99;
        const auto ms = [](const std::string &name, double seconds) {
            return ", \"" + name + "\": " + std::to_string(1000 * seconds);
        };
        const bool live = latencies_s_.many() > 0;
        return "{\"frames\": " + std::to_string(frames_s_.many()) + ", \"cpu_s\": " + std::to_string(cpu_s) +
               ms("p99_ms", frames_s_.share(usual_most)) + ms("most_ms", frames_s_.share(most)) +
               (live ? ms("latency_p99_ms", latencies_s_.share(usual_most)) : "") +
               (live ? ms("latency_most_ms", latencies_s_.share(most)) : "") +
               ", \"rss_mb\": " + std::to_string(static_cast<double>(used.ru_maxrss) / kib_a_mib) + "}";
    }

  private:
    /// All of a video's frames, the last ones of a camera that runs for years.
    class Seconds {
      public:
        void add(double seconds) {
            constexpr std::size_t memory = 100000;
            if (last_.size() < memory) {
                last_.push_back(seconds);
            } else {
                last_[many_ % memory] = seconds;
            }
            ++many_;
        }

        [[nodiscard]] std::size_t many() const {
            return many_;
        }

        /// What so large a share is not above.
        [[nodiscard]] double share(double share) const {
            std::vector<double> sorted = last_;
            std::sort(sorted.begin(), sorted.end());
            return sorted.empty() ? 0.0
                                  : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
        }

      private:
        std::vector<double> last_;
        std::size_t many_ = 0;
    };

    static double processor_s() {
        timespec now{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
        return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    }

    double began_ = 0.0;
    Seconds frames_s_;
    Seconds latencies_s_;
};

class CameraProgram {
  public:
    explicit CameraProgram(const CameraRequest &request)
        : request_(request), file_(read_lane_file(request.lanes)), counter_(file_, settings_of(request)), bus_(file_),
          end_s_(end_s(request.seconds)), jsonl_("--jsonl", request.jsonl),
          crossings_("--crossings", request.crossings), timing_("--timing", request.timing) {
        for (const std::string &warning : lane_file_warnings(file_)) {
            say(camera_program, request.lanes + ": " + warning);
        }
        take_reference();
        if (!file_.model.empty()) {
            detector_ = std::make_unique<Detector>(file_.model);
            counter_.find_with([this](const cv::Mat &bgr) { return detector_->find(bgr); });
        }
        if (!request.overlay.empty()) {
            overlay_ = std::make_unique<Overlay>(request.overlay);
        }
        if (!request.can.empty()) {
            can_ = std::make_unique<CanSocket>(request.can, std::vector<std::uint16_t>{});
        }
    }

    void run() {
        if (is_live(request_.source)) {
            run_live();
        } else {
            run_file();
        }
        if (overlay_) {
            overlay_->finish();
        }
        timing_.write(clock_.line());
    }

  private:
    void take_reference() {
        if (file_.reference.empty()) {
            return;
        }
        const std::string name = request_.lanes + ": reference " + file_.reference.string();
        std::error_code ignored; // what cannot be asked about cannot be read either
        const bool there = std::filesystem::is_regular_file(file_.reference, ignored);
        const cv::Mat road = there ? cv::imread(file_.reference.string()) : cv::Mat();
        if (road.empty()) {
            throw BadRequest(name + (there ? " is no picture that can be read" : " is missing") +
                             "; right would be a picture of the empty road, in the size of the lane file");
        }
        if (road.cols != file_.width_px || road.rows != file_.height_px) {
            throw BadRequest(name + " is " + size_text(road.size()) + " and the lane file is for " +
                             size_text({file_.width_px, file_.height_px}));
        }
        counter_.reference(road);
    }

    [[nodiscard]] std::string other_size(const cv::Size &given) const {
        return "--lanes " + request_.lanes + ": is for " + size_text({file_.width_px, file_.height_px}) +
               " and the source gives " + size_text(given);
    }

    void check_size(const cv::Mat &bgr) const {
        if (bgr.size() != cv::Size(file_.width_px, file_.height_px)) {
            throw BadRequest(other_size(bgr.size()));
        }
    }

    /// A live camera may come back in another size than its first picture had: in a look of that size no lane is where
    /// the lane file has it, so that it is none, and the records say `lost` until the right size is back.
    bool has_right_size(const cv::Mat &bgr);

    void feed(const Frame &frame) {
        counter_.feed(frame.bgr, frame.t_s);
        tell_crossings();
    }

    void tell_crossings() {
        for (const Crossing &crossing : counter_.take_crossings()) {
            crossings_.write(crossing_line(crossing, file_));
        }
    }

    void draw(const Frame &frame) {
        if (overlay_ && overlay_->wants(frame.t_s)) {
            cv::Mat picture = frame.bgr.clone();
            counter_.draw(picture, last_);
            overlay_->add(picture, frame.t_s);
        }
    }

    void tell(double latency_ms, std::uint64_t dropped) {
        last_ = counter_.record();
        jsonl_.write(record_line(last_, latency_ms, dropped));
        if (can_) {
            for (const elmopp_frame_t &frame : bus_.counts(last_)) {
                can_->send(frame);
            }
        }
    }

    void tell_junction() {
        if (can_ && !file_.junction_px.empty()) {
            if (const auto frame = bus_.junction(counter_.glance())) {
                can_->send(*frame);
            }
        }
    }

    void run_file();
    void run_live();
    bool look(LiveSource &live, double until_s);

    CameraRequest request_;
    LaneFile file_;
    Counter counter_;
    CameraBus bus_;
    double end_s_;
    Lines jsonl_;
    Lines crossings_;
    Lines timing_;
    Timing clock_;
    std::unique_ptr<Detector> detector_;
    std::unique_ptr<Overlay> overlay_;
    std::unique_ptr<CanSocket> can_;
    Record last_;
    bool seen_ = false;      ///< a live picture
    bool right_size_ = true; ///< the last live picture's
    bool said_shut_ = false; ///< that nothing opens
    double worst_ms_ = 0.0;  ///< age of a live picture since the last record
};

constexpr double second_s = 1.0;
constexpr double junction_s = 0.2;

/// Every frame, and a record after the first one and after each second of the video. On a bus at the video's own pace.
void CameraProgram::run_file() {
    VideoFile video(request_.source);
    const auto start = std::chrono::steady_clock::now();
    Frame frame;
    double next_s = 0;
    double next_junction_s = 0;
    std::int64_t frames = 0;
    clock_.begin();
    while (stop_asked == 0 && video.next(frame)) {
        if (frames++ == 0) {
            check_size(frame.bgr);
            next_s = frame.t_s;
        }
        if (can_) {
            std::this_thread::sleep_until(start + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                      std::chrono::duration<double>(frame.t_s)));
        }
        feed(frame);
        if (frame.t_s >= next_junction_s) {
            tell_junction();
            next_junction_s = frame.t_s + junction_s;
        }
        constexpr double rounding_s = 1e-6;
        if (frame.t_s + rounding_s >= next_s) {
            tell(0, 0);
            next_s += second_s * (1 + std::floor(frame.t_s + rounding_s - next_s));
        }
        draw(frame);
        clock_.end();
        clock_.begin();
        if (end_s_ > 0 && frame.t_s >= end_s_) {
            break;
        }
    }
    if (frames == 0) {
        throw BadRequest("--source " + request_.source + ": holds no picture that can be read");
    }
    counter_.finish();
    tell_crossings();
    tell(0, 0);
    constexpr double whole = 0.95;
    if (stop_asked == 0 && end_s_ <= 0 && static_cast<double>(frames) < whole * static_cast<double>(video.promised())) {
        say(camera_program, request_.source + ": ends after " + std::to_string(frames) + " of " +
                                std::to_string(video.promised()) + " frames, it is damaged or cut short");
    }
}

bool CameraProgram::has_right_size(const cv::Mat &bgr) {
    if (!seen_) {
        check_size(bgr);
        seen_ = true;
    }
    const bool right = bgr.size() == cv::Size(file_.width_px, file_.height_px);
    if (right_size_ && !right) {
        say(camera_program, other_size(bgr.size()) + " now; nothing is counted until the right size is back");
    }
    right_size_ = right;
    return right;
}

/// Takes the newest frame, or none, if none of the right size comes until then.
bool CameraProgram::look(LiveSource &live, double until_s) {
    Frame frame;
    if (!live.take(frame, until_s) || !has_right_size(frame.bgr)) {
        return false;
    }
    clock_.begin();
    feed(frame);
    draw(frame);
    clock_.end();
    const double latency_s = live.now_s() - frame.t_s;
    clock_.late(latency_s);
    worst_ms_ = std::max(worst_ms_, 1000 * latency_s);
    return true;
}

/// The newest frame, and a record each second whether there are frames or not.
void CameraProgram::run_live() {
    LiveSource live(request_.source, cv::Size(file_.width_px, file_.height_px));
    double next_s = second_s;
    double next_junction_s = junction_s;
    while (stop_asked == 0) {
        if (!look(live, std::min(next_s, next_junction_s))) {
            counter_.miss(live.now_s());
        }
        if (!said_shut_ && live.opened() == 0 && live.shut() > 0) {
            say(camera_program,
                "--source " + told_source(request_.source) + ": does not open; it is tried again until it does");
            said_shut_ = true;
        }
        const double now_s = live.now_s();
        if (now_s >= next_junction_s) {
            tell_junction();
            next_junction_s = std::max(next_junction_s + junction_s, now_s);
        }
        if (now_s >= next_s) {
            tell(worst_ms_, live.dropped());
            worst_ms_ = 0;
            next_s += second_s * (1 + std::floor(now_s - next_s));
        }
        if (end_s_ > 0 && now_s >= end_s_) {
            break;
        }
    }
    counter_.finish();
    tell_crossings();
}

void describe_camera(CLI::App &app, CameraRequest &request) {
    app.description("Counts vehicles in each lane of a camera's picture.");
    app.footer("Exit codes: 0 done; 1 it ran and failed, as when a file can no longer be written; 2 the request cannot "
               "be run.\nA camera that is not there is no failure: its records say lost until it is.");
    app.add_option("--source", request.source,
                   "Video file, rtsp:// rtsps:// http:// https:// udp://, gst:PIPELINE ! appsink, v4l2:N or "
                   "/dev/videoN")
        ->required();
    app.add_option("--lanes", request.lanes, "Lane file elmopp-lanes/1 (docs/camera.md)")->required();
    app.add_option("--can", request.can, "CAN interface to send DetectorCounts and JunctionOccupied on");
    app.add_option("--jsonl", request.jsonl, "File for one record a second; - is stdout");
    app.add_option("--overlay", request.overlay,
                   "Video (.avi, .mp4) or picture (.png, .jpg: the last frame) to draw on");
    app.add_option("--crossings", request.crossings, "File for each crossing as a line of JSON; - is stdout");
    app.add_option("--timing", request.timing, "File for what the program cost, for tools/score-counter");
    app.add_option("--try", request.tries, "NAME=VALUE in place of a default, for tools/score-counter --leave-one-out");
    app.add_option("--seconds", request.seconds, "End after so long");
}

void run_camera(const CameraRequest &request) {
    cv::setNumThreads(1);
    // What the libraries think of a source is many lines, again with each try; the program's own say it.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
    std::signal(SIGINT, [](int) { stop_asked = 1; });
    std::signal(SIGTERM, [](int) { stop_asked = 1; });
    CameraProgram(request).run();
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    return elmopp::run_program<elmopp::CameraRequest>(elmopp::camera_program, argc, argv, elmopp::describe_camera,
                                                      elmopp::run_camera);
}

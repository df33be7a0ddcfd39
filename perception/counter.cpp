// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "counter.hpp"

#include "haze.hpp"
#include "health.hpp"
#include "junction_box.hpp"
#include "presence.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace elmopp {
namespace {

constexpr double learning_s = 3.0;
constexpr std::size_t learning_least = 12; ///< frames
constexpr int catch_up = 3;                ///< kept frames that are counted with each new one
constexpr double lesson_px_per_s = 400e3; ///< pixels of patches that are learnt, of the video's time: a third of a core
constexpr double longest_step_s = 0.2;    ///< ... and in one frame at most

bool vertical(const Lane &lane) {
    return lane.direction == Direction::up || lane.direction == Direction::down;
}

/// Position across the travel, for sorting.
double across(const cv::Point2d &at, const Lane &lane) {
    return vertical(lane) ? at.x : at.y;
}

Lane ordered(Lane lane) {
    if (across(lane.to_px, lane) < across(lane.from_px, lane)) {
        std::swap(lane.from_px, lane.to_px);
    }
    return lane;
}

/// Lanes side by side whose lines meet; indices into the file.
std::vector<std::vector<int>> sections_of(const std::vector<Lane> &lanes) {
    constexpr double together = 0.12;
    std::vector<int> order(lanes.size());
    std::iota(order.begin(), order.end(), 0);
    const auto lane = [&lanes](int i) { return ordered(lanes[static_cast<std::size_t>(i)]); };
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return across(lane(a).from_px, lane(a)) < across(lane(b).from_px, lane(b)); });
    std::vector<std::vector<int>> sections;
    for (const int next : order) {
        bool placed = false;
        for (auto &section : sections) {
            const Lane last = lane(section.back());
            const Lane mine = lane(next);
            const double length = std::max(cv::norm(mine.to_px - mine.from_px), cv::norm(last.to_px - last.from_px));
            if (!placed && last.direction == mine.direction &&
                cv::norm(last.to_px - mine.from_px) < together * length) {
                section.push_back(next);
                placed = true;
            }
        }
        if (!placed) {
            sections.push_back({next});
        }
    }
    return sections;
}

/// Where vehicles move: 255 about the lines and in the zones.
cv::Mat traffic_of(const LaneFile &file) {
    cv::Mat traffic = cv::Mat::zeros(file.height_px, file.width_px, CV_8U);
    for (const Lane &lane : file.lanes) {
        const double width = cv::norm(lane.to_px - lane.from_px);
        const cv::Point2d way = vertical(lane) ? cv::Point2d(0, 1.5 * width) : cv::Point2d(1.5 * width, 0);
        std::vector<cv::Point> corners;
        for (const cv::Point2d &corner : {lane.from_px - way, lane.to_px - way, lane.to_px + way, lane.from_px + way}) {
            corners.emplace_back(corner);
        }
        cv::fillConvexPoly(traffic, corners, cv::Scalar(255));
        if (!lane.zone_px.empty()) {
            const std::vector<cv::Point> zone(lane.zone_px.begin(), lane.zone_px.end());
            cv::fillPoly(traffic, std::vector<std::vector<cv::Point>>{zone}, cv::Scalar(255));
        }
    }
    return traffic;
}

constexpr double contact_share = 0.2; ///< of a box's height: there the vehicle touches the road

/// Boxes as a mask: without what leans over neighbours, and whoever is nearer stands out from whoever is behind.
cv::Mat mask_of(std::vector<cv::Rect2d> boxes, cv::Size picture) {
    constexpr double side = 0.1;
    constexpr double top = 0.25;
    constexpr double rim = 0.06;
    const auto nearer = [](const cv::Rect2d &a, const cv::Rect2d &b) { return a.br().y < b.br().y; };
    std::stable_sort(boxes.begin(), boxes.end(), nearer);
    cv::Mat mask = cv::Mat::zeros(picture, CV_8U);
    for (const cv::Rect2d &box : boxes) {
        const double rim_px = std::max(1.0, rim * box.width);
        const cv::Rect2d core(box.x + side * box.width, box.y + top * box.height, (1 - 2 * side) * box.width,
                              (1 - top) * box.height);
        const cv::Rect2d around(core.x - rim_px, core.y - rim_px, core.width + 2 * rim_px, core.height + 2 * rim_px);
        cv::rectangle(mask, cv::Rect(around), cv::Scalar(0), cv::FILLED);
        cv::rectangle(mask, cv::Rect(core), cv::Scalar(255), cv::FILLED);
    }
    return mask;
}

int middle_of(std::deque<int> values) {
    if (values.empty()) {
        return 0;
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace

const char *reason_name(Reason reason) {
    switch (reason) {
    case Reason::ok:
        return "ok";
    case Reason::learning:
        return "learning";
    case Reason::black:
        return "black";
    case Reason::white:
        return "white";
    case Reason::frozen:
        return "frozen";
    case Reason::blurred:
        return "blurred";
    case Reason::covered:
        return "covered";
    case Reason::moved:
        return "moved";
    case Reason::lost:
        break;
    }
    return "lost";
}

struct Counter::Impl {
    struct Kept {
        Background::Sample sample;
        std::int64_t frame;
        double t_s;
        double dt_s;
    };
    struct Road {
        std::unique_ptr<Section> section;
        std::vector<int> lanes; ///< index in the section to index in the file
        std::deque<Kept> kept;
    };
    struct Zone {
        std::unique_ptr<Presence> presence;
        std::size_t lane;
        std::vector<Background::Sample> kept;
        std::deque<int> boxes; ///< in the zone, of the last second, if vehicles are found by a finder
    };
    struct Box {
        std::unique_ptr<JunctionBox> junction;
        std::vector<Background::Sample> kept;
    };

    Impl(const LaneFile &lane_file, const Settings &settings);

    double step_of(double now_s);
    bool is_cut(double change);
    bool is_road_known(Registration::Result &placed, bool cut, double step_s);
    void start_over(Registration::Result &placed);
    void keep_or_count(Road &road, const Kept &kept);
    void count(Road &road, const Kept &kept);
    void collect(Road &road);
    void count_kept(Road &road);
    void interrupt();
    void close();
    void learn_anew();
    void begin_lesson();
    void learn_more(int pixels);
    void find(const cv::Mat &bgr, const cv::Point2d &shift_px);
    [[nodiscard]] Background::Sample sample_of(const Patch &patch, const cv::Mat &bgr,
                                               const Registration::Result &placed) const;
    void feed_roads(const cv::Mat &bgr, const Registration::Result &placed, double step_s);
    void feed_zones(const cv::Mat &bgr, const Registration::Result &placed, double step_s);
    [[nodiscard]] bool caught_up() const;
    void rebase();
    void pause(double step_s);
    bool moved_for_good(const Registration::Result &placed, double step_s);
    void resume();
    [[nodiscard]] Reason reason(std::size_t lane) const;

    static constexpr double forgotten_after_s = 600.0; ///< a pause after which no road is believed (counter.hpp)
    static constexpr double most_gain = 0.8;           ///< from there on the road is taken over into the present light

    LaneFile file;
    Registration registration;
    Health health;
    Haze haze;
    std::vector<Road> roads;
    std::vector<Zone> zones;
    std::optional<Box> box;
    std::vector<std::int64_t> totals;
    std::vector<std::int64_t> told;
    std::vector<double> busy_s; ///< [lane] with a vehicle on the line, since the last record
    double open_s = 0.0;        ///< counted time since the last record
    std::vector<Crossing> crossings;
    std::deque<double> steps;
    std::deque<double> changes;
    double learnt_for_s = 0.0;
    double zone_step_s = 0.0;
    double paused_s = 0.0;
    bool doubted = false; ///< whether the picture still is that of the known road
    cv::Point2d known_px; ///< where it was last: a camera that drifts goes on from there, `moved` or not
    double unfit_s = 0.0; ///< ... for how long it has been in place and not fitted
    cv::Point2d home_px;  ///< shift that is taken for right
    cv::Point2d stays_px; ///< shift of a camera that has moved
    double stays_s = 0.0; ///< ... since when
    double agreement = 1.0;
    Finder finder;      ///< none: vehicles are what differs from the road
    cv::Mat found;      ///< 255 inside of what it found in this frame
    double clear = 1.0; ///< contrast of the picture
    bool learning = true;
    bool lesson = false; ///< while learning: enough was seen, and the roads are being made of it
    std::int64_t frame = -1;
    double t_s = 0.0;
    double last_s = 0.0;
    double dt_s = 0.04;
};

Counter::Impl::Impl(const LaneFile &lane_file, const Settings &settings)
    : file(lane_file), registration(traffic_of(lane_file)), health(traffic_of(lane_file)) {
    const cv::Size picture(file.width_px, file.height_px);
    double width_px = 0;
    for (const auto &indices : sections_of(file.lanes)) {
        std::vector<Lane> lanes(indices.size());
        std::transform(indices.begin(), indices.end(), lanes.begin(),
                       [this](int i) { return ordered(file.lanes[static_cast<std::size_t>(i)]); });
        roads.push_back({std::make_unique<Section>(lanes, picture, settings), indices, {}});
        width_px = std::max(width_px, roads.back().section->patch().lane_width_px());
    }
    for (std::size_t i = 0; i < file.lanes.size(); ++i) {
        if (!file.lanes[i].zone_px.empty()) {
            zones.push_back({std::make_unique<Presence>(file.lanes[i], picture, settings), i, {}, {}});
        }
    }
    if (!file.junction_px.empty()) {
        box = Box{std::make_unique<JunctionBox>(file.junction_px, width_px, picture), {}};
    }
    totals.assign(file.lanes.size(), 0);
    told.assign(file.lanes.size(), 0);
    busy_s.assign(file.lanes.size(), 0.0);
}

/// Seconds since the last frame; the usual step where the clock has jumped.
double Counter::Impl::step_of(double now_s) {
    constexpr std::size_t memory = 25;
    constexpr double longest_s = 1.0;
    const double step = now_s - last_s;
    last_s = now_s;
    if (frame > 0 && step > 1e-4 && step < longest_s) {
        steps.push_back(step);
        if (steps.size() > memory) {
            steps.pop_front();
        }
        std::vector<double> sorted(steps.begin(), steps.end());
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
        dt_s = sorted[sorted.size() / 2];
        return step;
    }
    return dt_s;
}

bool Counter::Impl::is_cut(double change) {
    constexpr std::size_t memory = 50;
    constexpr std::size_t recent = 5;
    constexpr double large = 4.0;
    bool cut = false;
    if (changes.size() >= recent) {
        std::vector<double> sorted(changes.begin(), changes.end());
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
        const double usual = sorted[sorted.size() / 2];
        const double most = *std::max_element(changes.end() - recent, changes.end());
        cut = change > large && change > 4 * usual && change > 2 * most;
    }
    changes.push_back(change);
    if (changes.size() > memory) {
        changes.pop_front();
    }
    return cut;
}

void Counter::Impl::collect(Road &road) {
    for (Crossing crossing : road.section->take()) {
        crossing.lane = road.lanes[static_cast<std::size_t>(crossing.lane)];
        ++totals[static_cast<std::size_t>(crossing.lane)];
        crossings.push_back(crossing);
        for (Zone &zone : zones) {
            if (zone.lane == static_cast<std::size_t>(crossing.lane)) {
                zone.presence->crossed(1);
            }
        }
    }
}

void Counter::Impl::count(Road &road, const Kept &kept) {
    road.section->feed(kept.sample, kept.frame, kept.t_s, kept.dt_s);
    for (std::size_t i = 0; i < road.lanes.size(); ++i) {
        busy_s[static_cast<std::size_t>(road.lanes[i])] += road.section->covered(static_cast<int>(i)) ? kept.dt_s : 0.0;
    }
    open_s += &road == roads.data() ? kept.dt_s : 0.0;
}

void Counter::Impl::keep_or_count(Road &road, const Kept &kept) {
    if (learning || !road.kept.empty()) {
        road.kept.push_back(kept);
        for (int i = 0; i < catch_up && !learning && !road.kept.empty(); ++i) {
            const Kept next = road.kept.front();
            road.kept.pop_front();
            count(road, next);
        }
    } else {
        count(road, kept);
    }
    collect(road);
}

void Counter::Impl::count_kept(Road &road) {
    for (const Kept &kept : road.kept) {
        count(road, kept);
    }
    road.kept.clear();
}

/// Frames are missing; the road is as it was.
void Counter::Impl::interrupt() {
    for (Road &road : roads) {
        if (!learning) {
            count_kept(road);
        }
        road.section->interrupt();
        collect(road);
    }
}

/// What is still kept is counted on the road as it is, and what is on the line ends.
void Counter::Impl::close() {
    for (Road &road : roads) {
        if (!learning) {
            count_kept(road);
        }
        road.section->close();
        collect(road);
        road.kept.clear();
    }
}

/// The scene is another one.
void Counter::Impl::learn_anew() {
    close();
    for (Zone &zone : zones) {
        zone.kept.clear();
    }
    if (box) {
        box->kept.clear();
    }
    learning = true;
    lesson = false;
    learnt_for_s = 0;
}

/// What was kept up to now is what is learnt from.
void Counter::Impl::begin_lesson() {
    for (Road &road : roads) {
        std::vector<Background::Sample> samples(road.kept.size());
        std::transform(road.kept.begin(), road.kept.end(), samples.begin(),
                       [](const Kept &kept) { return kept.sample; });
        road.section->background().begin(samples);
    }
    for (Zone &zone : zones) {
        zone.presence->begin(zone.kept);
        zone.kept.clear();
    }
    if (box) {
        box->junction->background().begin(box->kept);
        box->kept.clear();
    }
    lesson = true;
}

/// Goes on with the lesson for so many pixels. When it is over, so is the learning.
void Counter::Impl::learn_more(int pixels) {
    const bool learnt =
        std::all_of(roads.begin(), roads.end(),
                    [&](Road &road) { return road.section->background().learn_more(pixels); }) &&
        std::all_of(zones.begin(), zones.end(), [&](Zone &zone) { return zone.presence->learn_more(pixels); }) &&
        (!box || box->junction->background().learn_more(pixels));
    lesson = !learnt;
    learning = !learnt;
}

/// Asks the finder, and makes what it found a mask for the lines and numbers for the zones.
void Counter::Impl::find(const cv::Mat &bgr, const cv::Point2d &shift_px) {
    constexpr double memory_s = 1.0;
    if (!finder) {
        return;
    }
    std::vector<cv::Rect2d> boxes = finder(bgr);
    found = mask_of(boxes, bgr.size());
    const auto memory = static_cast<std::size_t>(std::max(1.0, std::round(memory_s / dt_s)));
    for (Zone &zone : zones) {
        const Polygon &polygon = file.lanes[zone.lane].zone_px;
        const std::vector<cv::Point2f> corners(polygon.begin(), polygon.end());
        zone.boxes.push_back(static_cast<int>(std::count_if(boxes.begin(), boxes.end(), [&](const cv::Rect2d &one) {
            const cv::Point2d contact(one.x + one.width / 2, one.y + (1 - contact_share / 2) * one.height);
            return cv::pointPolygonTest(corners, cv::Point2f(contact - shift_px), false) >= 0;
        })));
        while (zone.boxes.size() > memory) {
            zone.boxes.pop_front();
        }
    }
}

Background::Sample Counter::Impl::sample_of(const Patch &patch, const cv::Mat &bgr,
                                            const Registration::Result &placed) const {
    constexpr double half = 127;
    Background::Sample sample{patch.sample(bgr, placed.shift_px), placed.gain, cv::Mat(), clear};
    if (!found.empty()) {
        sample.objects = patch.sample(found, placed.shift_px) > half;
    }
    return sample;
}

void Counter::Impl::feed_roads(const cv::Mat &bgr, const Registration::Result &placed, double step_s) {
    for (Road &road : roads) {
        keep_or_count(road, {sample_of(road.section->patch(), bgr, placed), frame, t_s, step_s});
    }
}

/// Zones change slowly: they are looked at a few times a second.
void Counter::Impl::feed_zones(const cv::Mat &bgr, const Registration::Result &placed, double step_s) {
    constexpr double look_s = 0.11;
    if (lesson) {
        return;
    }
    const bool first = zone_step_s <= 0;
    zone_step_s += step_s;
    if (zone_step_s < look_s && !first) {
        return;
    }
    for (Zone &zone : zones) {
        const Background::Sample sample = sample_of(zone.presence->patch(), bgr, placed);
        if (learning) {
            if (zone.kept.empty()) {
                zone.presence->assume(sample);
            }
            zone.kept.push_back(sample);
        } else {
            zone.presence->feed(sample, zone_step_s);
        }
    }
    if (box) {
        const Background::Sample sample = sample_of(box->junction->patch(), bgr, placed);
        if (learning) {
            box->kept.push_back(sample);
        } else {
            box->junction->feed(sample, zone_step_s);
        }
    }
    zone_step_s = 1e-6;
}

bool Counter::Impl::caught_up() const {
    return std::all_of(roads.begin(), roads.end(), [](const Road &road) { return road.kept.empty(); });
}

/// The day has become much lighter or darker: everybody goes on in the present light.
void Counter::Impl::rebase() {
    const double gain = registration.rebase();
    for (Road &road : roads) {
        road.section->background().rebase(gain);
    }
    for (Zone &zone : zones) {
        zone.presence->rebase(gain);
    }
    if (box) {
        box->junction->background().rebase(gain);
    }
}

/// Another scene, or one that has moved: learnt from here on, in the present light.
void Counter::Impl::start_over(Registration::Result &placed) {
    learn_anew();
    registration.release();
    placed.gain = 0;
    doubted = false;
    unfit_s = 0;
    paused_s = 0;
}

/// A cut or a long pause puts the known road in doubt: it is taken back when the picture is seen to be that of the
/// camera that stands where it stood, in light as it was. False while that is open: such a picture counts for nothing.
bool Counter::Impl::is_road_known(Registration::Result &placed, bool cut, double step_s) {
    constexpr double doubted_after_s = 60.0;
    constexpr double patience_s = 1.0; // exposure and compression settle first
    if (!doubted && !cut && paused_s <= doubted_after_s) {
        known_px = placed.sure ? placed.shift_px : known_px;
        return true;
    }
    if (learning) {
        start_over(placed);
        return true;
    }
    if (!doubted) {
        doubted = true;
        registration.hold();
    }
    const bool in_place = placed.sure && cv::norm(placed.shift_px - known_px) <= Health::moved_px;
    if (in_place && paused_s <= forgotten_after_s && registration.fits()) {
        placed.gain = registration.recover();
        doubted = false;
        unfit_s = 0;
        interrupt();
        return true;
    }
    unfit_s = in_place ? unfit_s + step_s : 0.0;
    if (in_place && (unfit_s > patience_s || paused_s > forgotten_after_s || !registration.followed())) {
        start_over(placed);
        return true;
    }
    return false;
}

void Counter::Impl::pause(double step_s) {
    paused_s += step_s;
}

/// After a pause nothing on the line is what it was.
void Counter::Impl::resume() {
    constexpr double short_s = 0.5;
    if (paused_s > short_s) {
        interrupt();
    }
    paused_s = 0;
}

/// A camera that has been moved and stays there: the lanes go along with the picture, which is their home from then on.
/// Only what was shifted; where a turned or zoomed picture has its lanes is not known.
bool Counter::Impl::moved_for_good(const Registration::Result &placed, double step_s) {
    constexpr double stays_for_s = 60.0;
    constexpr double near_px = 3.0;
    const bool stays = health.fault() == Reason::moved && placed.sure && cv::norm(placed.shift_px - stays_px) < near_px;
    stays_s = stays ? stays_s + step_s : 0.0;
    if (!stays) {
        stays_px = placed.shift_px;
    }
    if (stays_s < stays_for_s) {
        return false;
    }
    home_px = placed.shift_px;
    stays_s = 0;
    return true;
}

Reason Counter::Impl::reason(std::size_t lane) const {
    if (health.fault() != Reason::ok) {
        return health.fault();
    }
    const bool unknown = !finder && std::any_of(zones.begin(), zones.end(), [lane](const Zone &zone) {
        return zone.lane == lane && zone.presence->unknown();
    });
    return learning || doubted || unknown ? Reason::learning : Reason::ok;
}

Counter::Counter(const LaneFile &file, const Settings &settings) : impl_(std::make_unique<Impl>(file, settings)) {}
Counter::~Counter() = default;

void Counter::find_with(Finder finder) {
    impl_->finder = std::move(finder);
}

void Counter::reference(const cv::Mat &bgr) {
    Impl &my = *impl_;
    const Registration::Result placed = my.registration.follow(bgr);
    const auto sample_of = [&](const Patch &patch) {
        return std::vector<Background::Sample>{my.sample_of(patch, bgr, placed)};
    };
    for (Impl::Road &road : my.roads) {
        road.section->background().learn(sample_of(road.section->patch()));
    }
    for (Impl::Zone &zone : my.zones) {
        zone.presence->learn(sample_of(zone.presence->patch()));
        zone.presence->known();
    }
    if (my.box) {
        my.box->junction->background().learn(sample_of(my.box->junction->patch()));
    }
    my.learning = false;
}

void Counter::feed(const cv::Mat &bgr, double t_s) {
    Impl &my = *impl_;
    if (bgr.type() != CV_8UC3 || bgr.cols != my.file.width_px || bgr.rows != my.file.height_px) {
        miss(t_s);
        return;
    }
    ++my.frame;
    my.t_s = t_s;
    const double step_s = my.step_of(t_s);
    if (!my.health.look(bgr, step_s)) {
        my.pause(step_s);
        return;
    }
    Registration::Result placed = my.registration.follow(bgr);
    my.agreement = placed.agreement;
    const bool settled = my.moved_for_good(placed, step_s);
    my.health.placed(cv::norm(placed.shift_px - my.home_px), placed.sure, step_s);
    const bool cut = my.is_cut(placed.change);
    if (settled) {
        my.start_over(placed);
    } else if (!my.is_road_known(placed, cut, step_s)) {
        my.pause(step_s);
        return;
    }
    if (std::abs(placed.gain) > my.most_gain && !my.learning && my.caught_up()) {
        my.rebase();
        placed.gain = 0;
    }
    if (!placed.sure && my.health.fault() == Reason::moved) {
        my.pause(step_s);
        return;
    }
    my.resume();
    my.clear = my.haze.follow(bgr, step_s);
    my.find(bgr, placed.shift_px);
    my.feed_roads(bgr, placed, step_s);
    my.feed_zones(bgr, placed, step_s);
    my.learnt_for_s += my.learning ? step_s : 0.0;
    if (my.learning && !my.lesson && my.learnt_for_s >= learning_s && my.roads.front().kept.size() >= learning_least) {
        my.begin_lesson();
    }
    if (my.lesson) {
        my.learn_more(static_cast<int>(lesson_px_per_s * std::min(step_s, longest_step_s)));
    }
}

void Counter::miss(double t_s) {
    Impl &my = *impl_;
    my.t_s = t_s;
    my.health.nothing(t_s - my.last_s);
    my.paused_s = std::max(my.paused_s, t_s - my.last_s);
}

void Counter::finish() {
    constexpr std::size_t least = 3;
    Impl &my = *impl_;
    const bool was_learning = my.learning;
    if (my.learning && my.roads.front().kept.size() >= least) {
        if (!my.lesson) {
            my.begin_lesson();
        }
        my.learn_more(std::numeric_limits<int>::max());
    }
    my.close();
    my.learning = was_learning; // the last record is of a second in which it was so
}

std::vector<Crossing> Counter::take_crossings() {
    std::vector<Crossing> taken;
    taken.swap(impl_->crossings);
    return taken;
}

Record Counter::record() {
    Impl &my = *impl_;
    Record record = glance();
    my.told = my.totals;
    my.open_s = 0;
    my.busy_s.assign(my.busy_s.size(), 0.0);
    return record;
}

Record Counter::glance() const {
    constexpr double night_confidence = 0.7;
    const Impl &my = *impl_;
    Record record;
    record.t_s = my.t_s;
    record.frame = my.frame;
    for (std::size_t i = 0; i < my.file.lanes.size(); ++i) {
        LaneRecord lane;
        lane.name = my.file.lanes[i].name;
        lane.arrived_total = my.totals[i];
        lane.inflow = my.totals[i] - my.told[i];
        lane.occupancy = my.open_s > 0 ? std::min(1.0, my.busy_s[i] / my.open_s) : 0.0;
        lane.reason = my.frame < 0 ? Reason::lost : my.reason(i);
        lane.valid = lane.reason == Reason::ok;
        record.lanes.push_back(lane);
    }
    for (const Impl::Zone &zone : my.zones) {
        record.lanes[zone.lane].present = my.finder ? middle_of(zone.boxes) : zone.presence->present();
    }
    for (const Impl::Road &road : my.roads) {
        const double light = road.section->background().day() ? 1.0 : night_confidence;
        for (const int lane : road.lanes) {
            LaneRecord &one = record.lanes[static_cast<std::size_t>(lane)];
            one.confidence = one.valid ? light * std::min(1.0, 0.5 + my.agreement) : 0.0;
        }
    }
    if (my.box) {
        const Reason why = my.frame < 0                      ? Reason::lost
                           : my.health.fault() != Reason::ok ? my.health.fault()
                           : my.learning || my.doubted       ? Reason::learning
                                                             : Reason::ok;
        record.junction = JunctionRecord{my.box->junction->occupied(), why == Reason::ok, why};
    }
    return record;
}

namespace {

/// White on black above a point, so that it can be read on every road; the colour is a frame.
void write_on_plate(cv::Mat &bgr, const std::string &text, const cv::Point &below, const cv::Scalar &colour) {
    constexpr int margin_px = 3;
    const double size = std::max(0.35, bgr.cols / 1600.0);
    int under_px = 0;
    const cv::Size wide = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &under_px);
    const cv::Point where(below.x - wide.width / 2, below.y - under_px - 2 * margin_px);
    const cv::Rect plate(where.x - margin_px, where.y - wide.height - margin_px, wide.width + 2 * margin_px,
                         wide.height + under_px + 2 * margin_px);
    cv::rectangle(bgr, plate, cv::Scalar(20, 20, 20), cv::FILLED);
    cv::rectangle(bgr, plate, colour, 1);
    cv::putText(bgr, text, where, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
}

} // namespace

void Counter::draw(cv::Mat &bgr, const Record &record) const {
    const Impl &my = *impl_;
    const auto outline = [&bgr](const Polygon &polygon, const cv::Scalar &colour) {
        const std::vector<cv::Point> corners(polygon.begin(), polygon.end());
        cv::polylines(bgr, corners, true, colour, 1, cv::LINE_AA);
    };
    const cv::Scalar good(80, 220, 80);
    const cv::Scalar bad(60, 60, 230);
    for (std::size_t i = 0; i < my.file.lanes.size(); ++i) {
        const Lane &lane = my.file.lanes[i];
        const bool told = i < record.lanes.size();
        const cv::Scalar colour = told && record.lanes[i].valid ? good : bad;
        if (!lane.zone_px.empty()) {
            outline(lane.zone_px, colour);
        }
        cv::line(bgr, lane.from_px, lane.to_px, colour, 2, cv::LINE_AA);
        std::string text = lane.name;
        if (told) {
            const LaneRecord &one = record.lanes[i];
            text += " " + std::to_string(one.arrived_total);
            text += one.present ? " (" + std::to_string(*one.present) + ")" : "";
            text += one.valid ? "" : std::string(" ") + reason_name(one.reason);
        }
        write_on_plate(bgr, text, cv::Point((lane.from_px + lane.to_px) / 2), colour);
    }
    if (!my.file.junction_px.empty()) {
        outline(my.file.junction_px, record.junction && record.junction->occupied ? bad : good);
    }
}

} // namespace elmopp

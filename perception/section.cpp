// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "section.hpp"

#include "split.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace elmopp {
namespace {

constexpr double line_half = 0.14;    ///< rows about the line that are averaged, in lane widths
constexpr double smooth_s = 0.12;     ///< ... over this time
constexpr double vehicle_lanes = 0.8; ///< a typical vehicle is drawn so long
constexpr double least_s = 0.08;      ///< a vehicle on the line
constexpr double least_width = 0.30;  ///< lanes
constexpr double least_area = 0.10;   ///< lanes x typical vehicles
constexpr double least_hill = 0.16;   ///< lanes from the border
constexpr double outside = 0.16;      ///< lanes beyond the section that still count
constexpr std::size_t typical_of = 15;
constexpr std::size_t typical_least = 3;

double median_of(const std::deque<double> &values) {
    std::vector<double> sorted(values.begin(), values.end());
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    return sorted[sorted.size() / 2];
}

double lane_of_column(double column) {
    return (column - patch_margin) / patch_unit;
}

/// Share of these columns that is covered behind the line, less that before it: -1 to 1.
double behind_line(const cv::Mat &object, int first, int last) {
    const cv::Mat mine = object.colRange(first, last + 1);
    const int middle = object.rows / 2;
    return (cv::mean(mine.rowRange(middle, object.rows))[0] - cv::mean(mine.rowRange(0, middle))[0]) / 255;
}

} // namespace

Section::Section(const std::vector<Lane> &lanes, cv::Size picture, const Settings &settings)
    : lanes_(lanes), settings_(settings), patch_(Patch::across(lanes, picture)), background_(patch_.valid(), settings),
      odometers_(lanes.size()), covered_(lanes.size(), false) {}

bool Section::standing(int lane) const {
    return covered(lane) && odometers_[static_cast<std::size_t>(lane)].last().still;
}

double Section::progress_of(int first, int last) const {
    double sum = 0;
    double weight = 0;
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
        const int left = patch_margin + static_cast<int>(lane) * patch_unit;
        const double share = std::min(last, left + patch_unit - 1) - std::max(first, left) + 1;
        if (share > 0) {
            sum += share * odometers_[lane].last().progress;
            weight += share;
        }
    }
    return weight > 0 ? sum / weight : 1.0;
}

/// Whether somebody stands or rocks about the line in these columns.
bool Section::stands(int first, int last) const {
    constexpr double near_lanes = 0.4;
    constexpr double least_object = 0.15;
    constexpr double least_net = 0.15;
    const auto lane =
        std::clamp<int>((first + last - 2 * patch_margin) / (2 * patch_unit), 0, static_cast<int>(lanes_.size()) - 1);
    const int middle = seen_.object.rows / 2;
    const int reach = static_cast<int>(near_lanes * patch_unit);
    const cv::Mat near = seen_.object.rowRange(middle - reach, middle + reach + 1).colRange(first, last + 1);
    return odometers_[static_cast<std::size_t>(lane)].last().net < least_net &&
           cv::countNonZero(near) > least_object * static_cast<double>(near.total());
}

/// The mask at the line, averaged along and across it and over time: [1][columns] of 255 and 0. Empty: not yet.
cv::Mat Section::line_row(const cv::Mat &object, double dt_s) {
    const int middle = object.rows / 2;
    const int half = static_cast<int>(std::lround(line_half * patch_unit));
    cv::Mat mean;
    cv::reduce(object.rowRange(middle - half, middle + half + 1), mean, 0, cv::REDUCE_AVG, CV_32F);
    cv::blur(mean, mean, cv::Size(3, 1));
    const auto many = static_cast<std::size_t>(std::max(1.0, std::round(smooth_s / dt_s)));
    rows_.back().mean = mean;
    while (rows_.size() > many) {
        rows_.pop_front();
    }
    cv::Mat sum = cv::Mat::zeros(mean.size(), CV_32F);
    for (const auto &row : rows_) {
        sum += row.mean;
    }
    return sum > settings_.covered * 255.0 * static_cast<double>(rows_.size());
}

void Section::feed(const Background::Sample &sample, std::int64_t frame, double t_s, double dt_s) {
    dt_s_ = dt_s;
    seen_ = background_.look(sample);
    background_.renew(seen_, dt_s, cv::Mat(), 0.4);
    const cv::Mat change = seen_.change;
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
        const cv::Range columns(patch_margin + static_cast<int>(lane) * patch_unit,
                                patch_margin + static_cast<int>(lane + 1) * patch_unit);
        odometers_[lane].feed(change.colRange(columns), seen_.object.colRange(columns), background_.noise(), dt_s);
    }
    guess_typical();
    rows_.push_back({cv::Mat(), seen_.object, frame, t_s});
    const cv::Mat row = line_row(seen_.object, dt_s);
    grow(row, rows_[rows_.size() / 2]);
    settle(t_s);
}

void Section::grow(const cv::Mat &row, const Row &seen) {
    const int beyond = static_cast<int>(outside * patch_unit);
    const int from = patch_margin - beyond;
    const int to = row.cols - patch_margin + beyond;
    std::vector<std::pair<int, int>> runs;
    for (int c = from; c < to; ++c) {
        if (row.at<uchar>(c) != 0) {
            if (!runs.empty() && runs.back().second == c - 1) {
                runs.back().second = c;
            } else {
                runs.emplace_back(c, c);
            }
        }
    }
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
        const int left = patch_margin + static_cast<int>(lane) * patch_unit;
        const int many = cv::countNonZero(row.colRange(left, left + patch_unit));
        covered_[lane] = many > patch_unit * 2 / 5;
    }
    std::vector<std::pair<std::size_t, std::pair<int, int>>> tips;
    std::vector<bool> goes_on(blobs_.size(), false);
    std::vector<std::size_t> merged(blobs_.size());
    std::iota(merged.begin(), merged.end(), std::size_t{0});
    const auto root = [&merged](std::size_t i) {
        while (merged[i] != i) {
            i = merged[i];
        }
        return i;
    };
    for (const auto &run : runs) {
        std::size_t mine = blobs_.size();
        for (const auto &[tip, columns] : tips_) {
            if (columns.first > run.second + 1 || columns.second < run.first - 1) {
                continue;
            }
            const std::size_t other = root(tip);
            if (mine == blobs_.size()) {
                mine = other;
            } else if (other != mine) {
                // Two become one: on the same scale, as of now.
                const double offset = blobs_[mine].position - blobs_[other].position;
                for (Run &moved : blobs_[other].runs) {
                    moved.position += offset;
                    blobs_[mine].runs.push_back(moved);
                }
                blobs_[mine].moved += blobs_[other].moved;
                blobs_[mine].forwards += blobs_[other].forwards;
                blobs_[mine].backwards += blobs_[other].backwards;
                blobs_[other].runs.clear();
                merged[other] = mine;
            }
        }
        if (mine == blobs_.size()) {
            blobs_.emplace_back();
            goes_on.push_back(true);
            merged.push_back(mine);
        }
        goes_on[mine] = true;
        tips.emplace_back(mine, run);
    }
    std::vector<bool> stepped(blobs_.size(), false);
    for (auto &[tip, run] : tips) {
        tip = root(tip);
        goes_on[tip] = true;
    }
    for (const auto &[tip, run] : tips) {
        Blob &blob = blobs_[tip];
        const double progress = progress_of(run.first, run.second) * dt_s_;
        if (!stepped[tip]) {
            blob.position += progress;
            stepped[tip] = true;
        }
        blob.runs.push_back({blob.position, progress, seen.frame, seen.t_s, run.first, run.second,
                             behind_line(seen.object, run.first, run.second)});
        for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
            const int middle = patch_margin + static_cast<int>(lane) * patch_unit + patch_unit / 2;
            if (run.first <= middle && middle <= run.second && odometers_[lane].last().sure) {
                const double rows = odometers_[lane].last().rows;
                blob.moved += rows;
                blob.forwards += rows > 0 ? 1 : 0;
                blob.backwards += rows < 0 ? 1 : 0;
            }
        }
    }
    // A lane that stands keeps its blob, flicker or not.
    for (const auto &[tip, columns] : tips_) {
        const std::size_t blob = root(tip);
        if (!goes_on[blob] && stands(columns.first, columns.second)) {
            goes_on[blob] = true;
            tips.emplace_back(blob, columns);
        }
    }
    for (std::size_t i = 0; i < blobs_.size(); ++i) {
        if (root(i) == i && !goes_on[i]) {
            end(blobs_[i]);
            blobs_[i].runs.clear();
        }
    }
    // Only those that go on are kept.
    std::vector<std::size_t> number(blobs_.size(), 0);
    std::vector<Blob> kept;
    for (std::size_t i = 0; i < blobs_.size(); ++i) {
        if (root(i) == i && goes_on[i]) {
            number[i] = kept.size();
            kept.push_back(std::move(blobs_[i]));
        }
    }
    for (auto &[tip, columns] : tips) {
        tip = number[tip];
    }
    blobs_ = std::move(kept);
    tips_ = std::move(tips);
}

cv::Mat Section::draw(const Blob &blob, double scale, std::vector<const Run *> &row_runs, int &left) const {
    double low = 1e18;
    double high = -1e18;
    int first = std::numeric_limits<int>::max();
    int last = 0;
    for (const Run &run : blob.runs) {
        low = std::min(low, run.position - run.progress);
        high = std::max(high, run.position);
        first = std::min(first, run.first);
        last = std::max(last, run.last);
    }
    const int rows = std::max(1, static_cast<int>(std::ceil((high - low) * scale)));
    cv::Mat shape = cv::Mat::zeros(rows, last - first + 1, CV_8U);
    row_runs.assign(static_cast<std::size_t>(rows), nullptr);
    left = first;
    for (const Run &run : blob.runs) {
        const int from =
            std::clamp(static_cast<int>(std::floor((run.position - run.progress - low) * scale)), 0, rows - 1);
        const int to = std::clamp(static_cast<int>(std::ceil((run.position - low) * scale)) - 1, from, rows - 1);
        for (int r = from; r <= to; ++r) {
            shape.row(r).colRange(run.first - first, run.last - first + 1).setTo(255);
            if (row_runs[static_cast<std::size_t>(r)] == nullptr) {
                row_runs[static_cast<std::size_t>(r)] = &run;
            }
        }
    }
    for (std::size_t r = 1; r < row_runs.size(); ++r) {
        if (row_runs[r] == nullptr) {
            row_runs[r] = row_runs[r - 1];
        }
    }
    return shape;
}

/// What a gap in the mask has cut in two, a windscreen that looks like the road: parts of one lane, one behind the
/// other, that together are no longer than one vehicle: two that follow one another have a gap as well. Returns how
/// many labels remain.
int Section::join_short(cv::Mat &labels, int many) const {
    constexpr double same_columns = 0.6;
    constexpr double widest = 1.2; // lanes
    const int most_rows = static_cast<int>(settings_.joined * vehicle_lanes * patch_unit);
    const auto box_of = [&labels](int label) { return cv::boundingRect(labels == label); };
    for (int a = 1; a <= many; ++a) {
        for (int b = a + 1; b <= many; ++b) {
            const cv::Rect one = box_of(a);
            const cv::Rect two = box_of(b);
            const cv::Rect both = one | two;
            const int shared = std::min(one.br().x, two.br().x) - std::max(one.x, two.x);
            if (both.height > most_rows || both.width > widest * patch_unit ||
                shared < same_columns * std::min(one.width, two.width)) {
                continue;
            }
            labels.setTo(a, labels == b);
            labels.setTo(b, labels == many);
            --many;
            b = a; // the joined part may reach a third one
        }
    }
    return many;
}

/// How far what is covered went over from before the line to behind it while the blob was on the line: the slope over
/// time, by least squares, times the time. Who drives through has 0.5 to 2, against the lane -0.5 to -2; who stands or
/// rocks has about 0, and a blob of one frame has 0.
double Section::passage(const Blob &blob) {
    const auto many = static_cast<double>(blob.runs.size());
    double mean_s = 0;
    double mean = 0;
    double first_s = std::numeric_limits<double>::max();
    double last_s = std::numeric_limits<double>::lowest();
    for (const Run &run : blob.runs) {
        mean_s += run.t_s / many;
        mean += run.behind / many;
        first_s = std::min(first_s, run.t_s);
        last_s = std::max(last_s, run.t_s);
    }
    double both = 0;
    double spread = 0;
    for (const Run &run : blob.runs) {
        both += (run.t_s - mean_s) * (run.behind - mean);
        spread += (run.t_s - mean_s) * (run.t_s - mean_s);
    }
    return spread > 0 ? both / spread * (last_s - first_s) : 0.0;
}

/// Whether the blob crossed against the lane. The odometer is seldom sure of who is smooth or fast; those are told by
/// the side that they come from.
bool Section::against(const Blob &blob) {
    constexpr double least_passage = 0.3;
    // One false step may be longer than all true ones.
    const bool measured = blob.moved < -0.25 * patch_unit && blob.backwards > 1 && blob.backwards > blob.forwards;
    return measured || passage(blob) < -least_passage;
}

void Section::end(Blob &blob) {
    if (blob.runs.empty()) {
        return;
    }
    const double scale = vehicle_lanes * patch_unit / typical_s_;
    std::vector<const Run *> row_runs;
    int left = 0;
    const cv::Mat shape = draw(blob, scale, row_runs, left);
    cv::Mat labels;
    const int split = split_shape(shape, least_hill * patch_unit, settings_.neck, labels);
    const int many = join_short(labels, split);
    std::vector<Part> parts;
    for (int label = 1; label <= many; ++label) {
        parts_of(labels, label, row_runs, left, scale, parts);
    }
    if (!against(blob)) {
        for (Part &part : parts) {
            waiting_.push_back(part);
        }
    }
}

/// A part over several lanes: one vehicle for each lane that it covers for long enough, if they come one after the
/// other or fill their lanes both. A single vehicle leans into one lane only in passing. Returns false if it is one.
bool Section::side_by_side(const cv::Mat &mine, const cv::Rect &box, const std::vector<const Run *> &row_runs, int left,
                           const Part &whole, std::vector<Part> &parts) const {
    constexpr double in_row = 0.5;
    constexpr double least_length = 0.5;  // typical vehicles
    constexpr double least_offset = 0.35; // ... between their middles
    constexpr double full = 0.75;
    constexpr double both = 0.55; // of the whole part's length
    struct Share {
        int lane;
        int first;
        int last;
        double fill;
        double of_box;
    };
    std::vector<Share> shares;
    const int typical_rows = static_cast<int>(vehicle_lanes * patch_unit);
    for (int lane = 0; lane < static_cast<int>(lanes_.size()); ++lane) {
        const int from = std::clamp(patch_margin + lane * patch_unit - left, 0, mine.cols);
        const int to = std::clamp(patch_margin + (lane + 1) * patch_unit - left, 0, mine.cols);
        Share share{lane, -1, -1, 0.0, 0.0};
        int rows = 0;
        for (int r = box.y; r < box.y + box.height && from < to; ++r) {
            const double fill = cv::countNonZero(mine.row(r).colRange(from, to)) / static_cast<double>(patch_unit);
            share.of_box += fill / box.height;
            if (fill > in_row) {
                share.first = share.first < 0 ? r : share.first;
                share.last = r;
                share.fill += fill;
                ++rows;
            }
        }
        if (rows > least_length * typical_rows) {
            share.fill /= rows;
            shares.push_back(share);
        }
    }
    if (shares.size() < 2) {
        return false;
    }
    const double offset =
        std::abs(shares[0].first + shares[0].last - shares[1].first - shares[1].last) / 2.0 / typical_rows;
    const auto fills = [&](const Share &share) { return share.fill > full || share.of_box > both; };
    if (offset < least_offset && !std::all_of(shares.begin(), shares.end(), fills)) {
        return false;
    }
    for (const Share &share : shares) {
        const int middle_row = (share.first + share.last) / 2;
        const auto middle = static_cast<std::size_t>(middle_row);
        Part one = whole;
        one.lane = share.lane;
        one.left = std::max<double>(whole.left, share.lane);
        one.right = std::min<double>(whole.right, share.lane + 1);
        one.centre = share.lane + 0.5;
        one.area = whole.area / static_cast<double>(shares.size());
        one.length = static_cast<double>(share.last - share.first + 1) / typical_rows;
        one.frame = row_runs[middle]->frame;
        one.t_s = row_runs[middle]->t_s;
        one.from_s = row_runs[static_cast<std::size_t>(share.first)]->t_s;
        one.until_s = row_runs[static_cast<std::size_t>(share.last)]->t_s + dt_s_;
        parts.push_back(one);
    }
    return true;
}

void Section::parts_of(const cv::Mat &labels, int label, const std::vector<const Run *> &row_runs, int left,
                       double scale, std::vector<Part> &parts) const {
    constexpr double contact_share = 0.35;
    constexpr double leaning_weight = 0.5;
    constexpr double two_lanes = 1.3;
    const cv::Mat mine = labels == label;
    const cv::Rect box = cv::boundingRect(mine);
    const double length_s = box.height / scale;
    double sum = 0;
    double weights = 0;
    double area = 0;
    const Direction direction = lanes_.front().direction;
    for (int r = box.y; r < box.y + box.height; ++r) {
        const double along = (r - box.y + 0.5) / box.height;
        const bool contact = direction == Direction::down ? along < contact_share
                             : direction == Direction::up ? along > 1 - contact_share
                                                          : true;
        for (int c = box.x; c < box.x + box.width; ++c) {
            if (mine.at<uchar>(r, c) == 0) {
                continue;
            }
            const double weight = contact ? 1.0 : leaning_weight;
            const double lane = lane_of_column(left + c + 0.5);
            sum += weight * lane;
            weights += weight;
            area += 1;
        }
    }
    if (weights <= 0) {
        return;
    }
    Part part;
    part.centre = sum / weights;
    part.left = lane_of_column(left + box.x);
    part.right = lane_of_column(left + box.x + box.width);
    part.length = length_s / typical_s_;
    part.area = area / (patch_unit * patch_unit * vehicle_lanes);
    const int last_row = box.y + box.height - 1;
    const int middle_row = box.y + box.height / 2;
    const Run *first = row_runs[static_cast<std::size_t>(box.y)];
    const Run *last = row_runs[static_cast<std::size_t>(last_row)];
    const Run *middle = row_runs[static_cast<std::size_t>(middle_row)];
    part.frame = middle->frame;
    part.t_s = middle->t_s;
    part.from_s = first->t_s;
    part.until_s = last->t_s + dt_s_;
    if (length_s < least_s || part.right - part.left < least_width || part.area < least_area) {
        return;
    }
    part.lane = std::clamp(static_cast<int>(std::floor(part.centre)), 0, static_cast<int>(lanes_.size()) - 1);
    if (part.right - part.left > two_lanes && side_by_side(mine, box, row_runs, left, part, parts)) {
        return;
    }
    parts.push_back(part);
}

void Section::learn_typical(const Part &part, double seconds) {
    constexpr double single_width = 1.15;
    if (part.right - part.left > single_width || part.right - part.left < 0.4) {
        return;
    }
    durations_.push_back(seconds);
    areas_.push_back(part.area);
    if (durations_.size() > typical_of) {
        durations_.pop_front();
        areas_.pop_front();
    }
    constexpr double shortest_s = 0.1;
    constexpr double longest_s = 6.0;
    if (durations_.size() >= typical_least) {
        typical_s_ = std::clamp(median_of(durations_), shortest_s, longest_s);
    }
}

/// Before vehicles have been seen whole: what one of usual length takes at the speed that the odometers have seen.
void Section::guess_typical() {
    constexpr double vehicle_rows = 34;
    constexpr double fastest_s = 0.15;
    constexpr double slowest_s = 1.5;
    if (durations_.size() >= typical_least) {
        return;
    }
    for (const Odometer &odometer : odometers_) {
        if (odometer.usual_rows_per_s() > 0) {
            typical_s_ = std::clamp(vehicle_rows / odometer.usual_rows_per_s(), fastest_s, slowest_s);
        }
    }
}

/// Judges what has been waiting for its neighbours.
void Section::settle(double now_s) {
    const double fragment = settings_.fragment;
    constexpr double near_share = 0.25;
    constexpr double near_lanes = 0.3;
    std::vector<Part> left;
    std::sort(waiting_.begin(), waiting_.end(), [](const Part &a, const Part &b) { return a.t_s < b.t_s; });
    std::vector<bool> gone(waiting_.size(), false);
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
        for (std::size_t k = i + 1; k < waiting_.size(); ++k) {
            if (gone[i] || gone[k]) {
                continue;
            }
            Part &a = waiting_[i];
            Part &b = waiting_[k];
            if (std::abs(a.lane - b.lane) > 1) {
                continue;
            }
            const double longer_s = std::max(a.until_s - a.from_s, b.until_s - b.from_s);
            const double gap_s = std::max(a.from_s, b.from_s) - std::min(a.until_s, b.until_s);
            const double apart = std::max(a.left, b.left) - std::min(a.right, b.right);
            if (gap_s > near_share * longer_s || apart > near_lanes) {
                continue;
            }
            const double usual = areas_.empty() ? 0.6 : median_of(areas_);
            Part &small = a.area < b.area ? a : b;
            Part &large = a.area < b.area ? b : a;
            if (small.area < fragment * large.area && small.area < fragment * usual * 1.2) {
                gone[&small == &a ? i : k] = true;
            } else if (a.lane == b.lane && a.area + b.area < usual) {
                large.area += small.area;
                large.from_s = std::min(a.from_s, b.from_s);
                large.until_s = std::max(a.until_s, b.until_s);
                large.left = std::min(a.left, b.left);
                large.right = std::max(a.right, b.right);
                gone[&small == &a ? i : k] = true;
            }
        }
    }
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
        const Part &part = waiting_[i];
        if (gone[i]) {
            continue;
        }
        const double wait_s = 0.35 * std::clamp(part.until_s - part.from_s, typical_s_, 3 * typical_s_);
        if (now_s - part.until_s < wait_s) {
            left.push_back(part);
            continue;
        }
        done_.push_back({part.frame, part.lane, part.t_s, part.confidence});
        learn_typical(part, part.length * typical_s_);
    }
    waiting_ = std::move(left);
}

void Section::close() {
    for (Blob &blob : blobs_) {
        end(blob);
    }
    blobs_.clear();
    tips_.clear();
    rows_.clear();
    for (Odometer &odometer : odometers_) {
        odometer.forget();
    }
    settle(1e18);
}

void Section::interrupt() {
    blobs_.clear();
    tips_.clear();
    rows_.clear();
    for (Odometer &odometer : odometers_) {
        odometer.forget();
    }
}

std::vector<Crossing> Section::take() {
    std::vector<Crossing> taken;
    taken.swap(done_);
    return taken;
}

} // namespace elmopp

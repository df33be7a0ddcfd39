// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "stats.hpp"

#include <boost/math/distributions/students_t.hpp>

#include <cmath>
#include <limits>
#include <numeric>

namespace elmopp {

double sum(const std::vector<double> &values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

Summary summarize(const std::vector<double> &values) {
    Summary summary;
    summary.n = values.size();
    if (values.empty()) {
        return summary;
    }
    const auto n = static_cast<double>(values.size());
    summary.mean = sum(values) / n;
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - summary.mean) * (value - summary.mean);
    }
    summary.sd = values.size() > 1 ? std::sqrt(squares / (n - 1.0)) : 0.0;
    return summary;
}

Interval paired_interval(const std::vector<double> &a, const std::vector<double> &b) {
    std::vector<double> differences(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        differences[i] = a[i] - b.at(i);
    }
    const Summary summary = summarize(differences);
    if (summary.n < 2) {
        return {summary.mean, summary.mean};
    }
    const auto n = static_cast<double>(summary.n);
    const boost::math::students_t student(n - 1.0);
    const double half = boost::math::quantile(student, 0.975) * summary.sd / std::sqrt(n);
    return {summary.mean - half, summary.mean + half};
}

Welch welch(const std::vector<double> &a, const std::vector<double> &b) {
    const Summary sa = summarize(a);
    const Summary sb = summarize(b);
    const double difference = sa.mean - sb.mean;
    if (sa.n < 2 || sb.n < 2) {
        return {};
    }
    const double va = sa.sd * sa.sd / static_cast<double>(sa.n);
    const double vb = sb.sd * sb.sd / static_cast<double>(sb.n);
    if (va + vb <= 0.0) {
        const double sign = difference > 0.0 ? 1.0 : -1.0;
        return difference == 0.0 ? Welch{0.0, 0.0, 0.5}
                                 : Welch{sign * std::numeric_limits<double>::max(), 0.0, sign > 0.0 ? 0.0 : 1.0};
    }
    Welch result;
    result.t = difference / std::sqrt(va + vb);
    result.df =
        (va + vb) * (va + vb) / (va * va / static_cast<double>(sa.n - 1) + vb * vb / static_cast<double>(sb.n - 1));
    result.p_one_sided = boost::math::cdf(boost::math::complement(boost::math::students_t(result.df), result.t));
    return result;
}

} // namespace elmopp
